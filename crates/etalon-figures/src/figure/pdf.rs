//! A page as PDF: vector shapes, selectable text, compressed images. Subsets of the embedded fonts have the glyphs
//! that the page uses, their widths, and their characters for search and copy.

use super::page::{Item, Page};
use super::rgb8::Rgb8;
use super::shapes::{Colour, Paint, Point, Text};
use super::text::{self, Face};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, LineJoinStyle, Predictor, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use std::collections::BTreeMap;
use std::io::Write;
use subsetter::GlyphRemapper;

/// A CSS pixel, 1/96 inch, in points.
const POINTS: f64 = 0.75;

impl Page {
    /// The page as a PDF document, `0.75 * unit * width` by `0.75 * unit * height` points.
    pub fn pdf(&self) -> Vec<u8> {
        let points = POINTS * self.unit;
        let mut page = Contents::new(points, self.height);
        if self.paper != Colour::WHITE {
            let paper = super::shapes::Rect::new(0.0, 0.0, self.width, self.height);
            page.item(&Item::Rect { rect: paper, paint: self.paper.into() });
        }
        for item in &self.items {
            page.item(item);
        }
        page.finish(self.width * points, self.height * points)
    }
}

/// The page's content and the resources that it uses so far.
struct Contents {
    content: Content,
    fonts: BTreeMap<Face, Subset>,
    /// Pairs of opacities, of fills and of strokes, in the order of their first use.
    opacities: Vec<[u8; 2]>,
    current: [u8; 2],
    images: Vec<Rgb8>,
}

impl Contents {
    fn new(points: f64, height: f64) -> Self {
        let mut content = Content::new();
        // From drawing units with y down to points with y up.
        content.transform([points as f32, 0.0, 0.0, -points as f32, 0.0, (height * points) as f32]);
        content.set_line_join(LineJoinStyle::RoundJoin);
        Self { content, fonts: BTreeMap::new(), opacities: Vec::new(), current: [255; 2], images: Vec::new() }
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Path { points, closed, paint } => {
                self.path(points);
                if *closed {
                    self.content.close_path();
                }
                self.paint(paint);
            }
            Item::Rect { rect, paint } => {
                self.content.rect(short(rect.x), short(rect.y), short(rect.width), short(rect.height));
                self.paint(paint);
            }
            Item::Circle { centre, radius, paint } => {
                self.circle(*centre, *radius);
                self.paint(paint);
            }
            Item::Text(text) => self.text(text),
            Item::Image { rect, image } => {
                let name = format!("I{}", self.images.len());
                self.images.push(enlarged(image, rect.width, rect.height));
                self.opacity([255; 2]);
                // Images fill the unit square, upright where y points up.
                let place = [short(rect.width), 0.0, 0.0, -short(rect.height), short(rect.x), short(rect.bottom())];
                self.content.save_state().transform(place).x_object(Name(name.as_bytes())).restore_state();
            }
        }
    }

    fn path(&mut self, points: &[Point]) {
        let mut points = points.iter().map(|p| p.map(short));
        if let Some([x, y]) = points.next() {
            self.content.move_to(x, y);
        }
        for [x, y] in points {
            self.content.line_to(x, y);
        }
    }

    /// Four Bézier quarters, with an error below 0.03 % of the radius.
    fn circle(&mut self, [x, y]: Point, radius: f64) {
        const KAPPA: f64 = 0.552_284_75;
        let at = |dx: f64, dy: f64| (short(x + radius * dx), short(y + radius * dy));
        let (start_x, start_y) = at(1.0, 0.0);
        self.content.move_to(start_x, start_y);
        for (c, s) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
            let (x1, y1) = at(c - KAPPA * s, s + KAPPA * c);
            let (x2, y2) = at(KAPPA * c - s, c + KAPPA * s);
            let (x3, y3) = at(-s, c);
            self.content.cubic_to(x1, y1, x2, y2, x3, y3);
        }
        self.content.close_path();
    }

    fn paint(&mut self, paint: &Paint) {
        let fill = paint.fill.map_or(255, |c| c.alpha);
        let stroke = paint.stroke.map_or(255, |s| s.colour.alpha);
        self.opacity([fill, stroke]);
        if let Some(Colour { r, g, b, .. }) = paint.fill {
            self.content.set_fill_rgb(unit(r), unit(g), unit(b));
        }
        if let Some(stroke) = paint.stroke {
            let Colour { r, g, b, .. } = stroke.colour;
            self.content.set_stroke_rgb(unit(r), unit(g), unit(b));
            self.content.set_line_width(short(stroke.width));
            self.content.set_dash_pattern(stroke.dash.iter().map(|&d| d as f32), 0.0);
        }
        match (paint.fill, paint.stroke) {
            (Some(_), Some(_)) => self.content.fill_nonzero_and_stroke(),
            (Some(_), None) => self.content.fill_nonzero(),
            (None, Some(_)) => self.content.stroke(),
            (None, None) => self.content.end_path(),
        };
    }

    fn opacity(&mut self, pair: [u8; 2]) {
        if pair == self.current {
            return;
        }
        self.current = pair;
        let index = self.opacities.iter().position(|&p| p == pair).unwrap_or_else(|| {
            self.opacities.push(pair);
            self.opacities.len() - 1
        });
        self.content.set_parameters(Name(format!("A{index}").as_bytes()));
    }

    fn text(&mut self, text: &Text) {
        let runs = text::runs(&text.markup, text.size, text.bold);
        let mut along = text.start();
        let Colour { r, g, b, alpha } = text.colour;
        self.opacity([alpha, 255]);
        self.content.set_fill_rgb(unit(r), unit(g), unit(b));
        self.content.begin_text();
        for run in &runs {
            let below = text.drop() - run.rise;
            let [x, y] = text.at;
            // Glyphs are drawn with y up, so their vertical axis is turned back; text that runs upwards swaps the axes.
            let matrix = if text.upwards {
                [0.0, -1.0, -1.0, 0.0, short(x + below), short(y - along)]
            } else {
                [1.0, 0.0, 0.0, -1.0, short(x + along), short(y + below)]
            };
            let codes = self.fonts.entry(run.face).or_default().encode(run.face, &run.text);
            self.content.set_text_matrix(matrix);
            self.content.set_font(Name(font_name(run.face).as_bytes()), short(run.size));
            self.content.show(Str(&codes));
            along += run.width();
        }
        self.content.end_text();
    }

    fn finish(self, width: f64, height: f64) -> Vec<u8> {
        let mut pdf = Pdf::new();
        let mut last = 0;
        let mut next = || {
            last += 1;
            Ref::new(last)
        };
        // Number the objects
        let (catalog, tree, page, content) = (next(), next(), next(), next());
        pdf.catalog(catalog).pages(tree);
        pdf.pages(tree).kids([page]).count(1);
        let fonts: Vec<(Face, Ref)> = self.fonts.keys().map(|&face| (face, next())).collect();
        let images: Vec<Ref> = self.images.iter().map(|_| next()).collect();

        // The page with its resources: fonts, images, opacities
        let mut dict = pdf.page(page);
        dict.parent(tree).contents(content);
        dict.media_box(Rect::new(0.0, 0.0, width as f32, height as f32));
        let mut resources = dict.resources();
        let mut names = resources.fonts();
        for &(face, font) in &fonts {
            names.pair(Name(font_name(face).as_bytes()), font);
        }
        names.finish();
        let mut names = resources.x_objects();
        for (i, &image) in images.iter().enumerate() {
            names.pair(Name(format!("I{i}").as_bytes()), image);
        }
        names.finish();
        let mut states = resources.ext_g_states();
        for (i, &[fill, stroke]) in self.opacities.iter().enumerate() {
            let state = states.insert(Name(format!("A{i}").as_bytes()));
            let mut state = state.start::<pdf_writer::writers::ExtGraphicsState>();
            state.non_stroking_alpha(unit(fill)).stroking_alpha(unit(stroke));
        }
        states.finish();
        resources.finish();
        dict.finish();

        // The content, the images as rows with PNG predictors, the fonts
        pdf.stream(content, &deflate(&self.content.finish())).filter(Filter::FlateDecode);
        for (image, id) in self.images.iter().zip(images) {
            let data = png_stream(image);
            let mut object = pdf.image_xobject(id, &data);
            object.width(image.width() as i32).height(image.height() as i32).filter(Filter::FlateDecode);
            let mut parameters = object.decode_parms();
            parameters.predictor(Predictor::PngOptimum).colors(3).columns(image.width() as i32);
            parameters.finish();
            object.color_space().device_rgb();
            object.bits_per_component(8);
            if image.is_on_paper() {
                object.color_mask([255; 6]);
            }
        }
        for ((face, subset), (_, id)) in self.fonts.iter().zip(fonts) {
            subset.write(&mut pdf, *face, id, [next(), next(), next(), next()]);
        }
        pdf.finish()
    }
}

/// Enlarges an image by an integer factor, because viewers blur enlarged images.
fn enlarged(image: &Rgb8, width: f64, height: f64) -> Rgb8 {
    // Three pixels per drawing unit: enough for print
    let wanted = 3.0 * (width / image.width() as f64).min(height / image.height() as f64);
    let zoom = wanted.clamp(1.0, 64.0) as usize;
    if zoom < 3 {
        return image.clone();
    }
    let larger = Rgb8::from_fn(image.width() * zoom, image.height() * zoom, |x, y| image.pixel(x / zoom, y / zoom));
    if image.is_on_paper() { larger.on_paper() } else { larger }
}

/// The compressed rows of an image as PNG stores them, which is what PDF's PNG predictors read.
fn png_stream(image: &Rgb8) -> Vec<u8> {
    let file = image.png();
    let mut stream = Vec::with_capacity(file.len());
    // Chunks follow the 8-byte signature: length, name, data, checksum.
    let mut rest = &file[8..];
    while let [a, b, c, d, name0, name1, name2, name3, tail @ ..] = rest {
        let (data, next) = tail.split_at(u32::from_be_bytes([*a, *b, *c, *d]) as usize);
        if [*name0, *name1, *name2, *name3] == *b"IDAT" {
            stream.extend_from_slice(data);
        }
        rest = &next[4..];
    }
    stream
}

/// Two decimals, as in the SVG.
fn short(value: f64) -> f32 {
    ((value * 100.0).round() / 100.0) as f32
}

fn unit(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

/// The glyphs of a font that the page uses, with their characters and widths.
#[derive(Default)]
struct Subset {
    glyphs: GlyphRemapper,
    /// New glyph number to character and width in thousandths of the font size.
    used: BTreeMap<u16, (char, f32)>,
}

impl Subset {
    /// The string in the numbers of the subset's glyphs.
    pub fn encode(&mut self, face: Face, string: &str) -> Vec<u8> {
        let mut codes = Vec::with_capacity(2 * string.len());
        for c in string.chars() {
            let glyph = face.tables().glyph_index(c).unwrap_or_default();
            let code = self.glyphs.remap(glyph.0);
            self.used.entry(code).or_insert((c, (face.advance(c) * 1000.0) as f32));
            codes.extend(code.to_be_bytes());
        }
        codes
    }

    /// Writes the font as object `id`, with its parts as the four objects after it.
    pub fn write(&self, pdf: &mut Pdf, face: Face, id: Ref, [cid, descriptor, meaning, file]: [Ref; 4]) {
        const SYSTEM: SystemInfo<'static> =
            SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
        let (cut, angle) = match face {
            Face::Regular => ("DejaVuSans", 0.0),
            Face::Oblique => ("DejaVuSans-Oblique", -11.0),
            Face::Bold => ("DejaVuSans-Bold", 0.0),
        };
        // Subsets carry a tag of six capitals, here one per face.
        let base = format!("ETALO{}+{cut}", char::from(b'A' + face as u8));
        let base = Name(base.as_bytes());
        // The composite font: two-byte codes are glyph numbers of the subset
        pdf.type0_font(id)
            .base_font(base)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(meaning);

        let mut font = pdf.cid_font(cid);
        font.subtype(CidFontType::Type2).base_font(base).system_info(SYSTEM).font_descriptor(descriptor);
        font.cid_to_gid_map_predefined(Name(b"Identity"));
        let mut widths = font.widths();
        for (&glyph, &(_, width)) in &self.used {
            widths.same(glyph, glyph, width);
        }
        widths.finish();
        font.finish();

        // Its metrics, in thousandths of the font size
        let tables = face.tables();
        let thousandths = |units: i16| f32::from(units) * 1000.0 / f32::from(tables.units_per_em());
        let bounds = tables.global_bounding_box();
        pdf.font_descriptor(descriptor)
            .name(base)
            .flags(if angle == 0.0 { FontFlags::SYMBOLIC } else { FontFlags::SYMBOLIC | FontFlags::ITALIC })
            .bbox(Rect::new(
                thousandths(bounds.x_min),
                thousandths(bounds.y_min),
                thousandths(bounds.x_max),
                thousandths(bounds.y_max),
            ))
            .italic_angle(angle)
            .ascent(thousandths(tables.ascender()))
            .descent(thousandths(tables.descender()))
            .cap_height((text::CAP_HEIGHT * 1000.0) as f32)
            .stem_v(if face == Face::Bold { 160.0 } else { 90.0 })
            .font_file2(file);

        // Characters of the glyphs, for search and copy
        let mut map = UnicodeCmap::new(Name(b"Custom"), SYSTEM);
        for (&glyph, &(c, _)) in &self.used {
            map.pair(glyph, c);
        }
        pdf.cmap(meaning, &map.finish());

        // The font file with the glyphs of the page alone
        let font = subsetter::subset(face.bytes(), 0, &self.glyphs).expect("the embedded fonts are sound");
        pdf.stream(file, &deflate(&font)).filter(Filter::FlateDecode).pair(Name(b"Length1"), font.len() as i32);
    }
}

/// What the page calls a font.
fn font_name(face: Face) -> &'static str {
    match face {
        Face::Regular => "F0",
        Face::Oblique => "F1",
        Face::Bold => "F2",
    }
}

/// `bytes` as a zlib stream, which PDF calls FlateDecode.
fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("written to memory")
}

#[cfg(test)]
mod tests {
    use super::super::shapes;
    use super::*;

    #[test]
    fn fonts_are_small_subsets_that_say_what_they_mean() {
        let mut drawing = Page::new(100.0, 40.0, 1.0);
        drawing.text(Text::new([5.0, 20.0], 12.0, "θ_{B} = 55.41°"));
        let pdf = drawing.pdf();
        assert!(pdf.starts_with(b"%PDF-"));
        assert!(pdf.len() < 20_000, "{} bytes", pdf.len());
        let source = String::from_utf8_lossy(&pdf);
        // ToUnicode has the theta and the degree sign; the page is 75 pt wide.
        assert!(source.contains("<03B8>") && source.contains("<00B0>"));
        assert!(source.contains("/MediaBox [0 0 75 30]"), "{source}");
        assert!(!source.contains("Bold"), "faces that are not used are not embedded");
    }

    #[test]
    fn image_streams_hold_filtered_rows() {
        let image = Rgb8::from_fn(300, 40, |x, y| [x as u8, y as u8, (x * y) as u8]);
        let mut rows = Vec::new();
        std::io::Read::read_to_end(&mut flate2::read::ZlibDecoder::new(png_stream(&image).as_slice()), &mut rows)
            .unwrap();
        assert_eq!(rows.len(), 40 * (1 + 3 * 300), "each row has its filter's number in front");
        assert!(rows.chunks(901).all(|row| row[0] <= 4));
    }

    #[test]
    fn an_opacity_is_declared_once() {
        let mut drawing = Page::new(100.0, 40.0, 1.0);
        for _ in 0..3 {
            drawing.rect(shapes::Rect::new(0.0, 0.0, 9.0, 9.0), Colour::BLACK.faded(0.2));
            drawing.circle([5.0, 5.0], 2.0, Colour::BLACK);
        }
        let source = String::from_utf8_lossy(&drawing.pdf()).into_owned();
        assert_eq!(source.matches("/ca 0.2").count(), 1, "{source}");
    }
}
