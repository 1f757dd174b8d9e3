//! A page as PNG. Text is filled outlines of the embedded fonts; fonts of the system are not used.

use super::page::{Item, Page};
use super::rgb8::{Rgb8, palette, with_chunk};
use super::shapes::{Colour, Paint, Rect, Text};
use super::text;
use etalon_core::error::{Error, Result};
use tiny_skia::{
    FillRule, FilterQuality, IntSize, LineJoin, Path, PathBuilder, Pattern, Pixmap, SpreadMode, Stroke, StrokeDash,
    Transform,
};

/// The longest PNG side, and the largest PNG (512 MiB while it is painted).
const MAX_SIDE: f64 = 32768.0;
const MAX_PIXELS: f64 = 134_217_728.0;

impl Page {
    /// The page as a PNG file of `width * scale` by `height * scale` pixels, each rounded up.
    ///
    /// # Errors
    /// When a side is less than one pixel or more than 32768, or the area more than 2^27 pixels.
    pub fn png(&self) -> Result<Vec<u8>> {
        let (w, h) = ((self.width * self.scale).ceil(), (self.height * self.scale).ceil());
        // Also false for NaN.
        let paintable = w >= 1.0 && h >= 1.0 && w <= MAX_SIDE && h <= MAX_SIDE && w * h <= MAX_PIXELS;
        let mut page = paintable.then(|| Pixmap::new(w as u32, h as u32)).flatten().ok_or_else(|| {
            Error::parameter("figure size", format!("{w} x {h} pixels: cannot be painted"))
                .with_hint(format!("a figure may have 1 to {MAX_SIDE} pixels a side and {MAX_PIXELS} in all"))
        })?;
        let Colour { r, g, b, .. } = self.paper;
        page.fill(tiny_skia::Color::from_rgba8(r, g, b, 255));
        let to_pixels = Transform::from_scale(self.scale as f32, self.scale as f32);
        for item in &self.items {
            paint_item(&mut page, to_pixels, item);
        }
        // The paper is opaque below everything, so alpha is not needed.
        let rgb = page.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        let image = Rgb8::new(w as usize, h as usize, rgb);
        let covers = |item: &Item| matches!(item, Item::Image { rect, .. } if rect.width >= self.width);
        let file = match self.items.first() {
            _ if self.few_colours => {
                let has_shades = self.items.iter().any(|item| matches!(item, Item::Image { .. }));
                let file = indexed(&image, has_shades);
                // Shades keep their colours where a palette saves little: in images without noise, or enlarged
                let exact = has_shades.then(|| image.chart_png());
                exact.filter(|exact| 4 * exact.len() <= 5 * file.len()).unwrap_or(file)
            }
            Some(first) if covers(first) => image.png().to_vec(),
            _ => image.chart_png(),
        };
        Ok(with_resolution(&file, self.scale / self.unit))
    }
}

/// The image as a PNG file with a palette. Neighbours in it are no neighbours in colour, so that filters would only add to it.
fn indexed(image: &Rgb8, has_shades: bool) -> Vec<u8> {
    let (colours, places) = palette(image, has_shades);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width() as u32, image.height() as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(colours.concat());
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&places));
    written.expect("a sound image, written to memory");
    bytes
}

/// Page units, which are CSS pixels, per metre.
const CSS_PER_METRE: f64 = 96.0 / 0.0254;

/// A PNG file with a chunk that states its pixels per metre (pHYs), from those per CSS pixel, so that it is printed at the size of
/// the drawing.
fn with_resolution(png: &[u8], scale: f64) -> Vec<u8> {
    let density = ((scale * CSS_PER_METRE).round() as u32).to_be_bytes();
    with_chunk(png, *b"pHYs", &[&density[..], &density, &[1]].concat())
}

/// Paints one item. Items without extent make no path and are not painted.
fn paint_item(page: &mut Pixmap, to_pixels: Transform, item: &Item) {
    match item {
        Item::Path { points, closed, paint } => {
            let mut builder = PathBuilder::new();
            for (i, [x, y]) in points.iter().map(|p| p.map(|v| v as f32)).enumerate() {
                if i == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
            }
            if *closed {
                builder.close();
            }
            paint_path(page, to_pixels, builder.finish(), paint);
        }
        Item::Rect { rect, paint } => paint_path(page, to_pixels, sides(rect).map(PathBuilder::from_rect), paint),
        Item::Circle { centre: [x, y], radius, paint } => {
            paint_path(page, to_pixels, PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32), paint);
        }
        Item::Text(text) => paint_path(page, to_pixels.pre_concat(placed(text)), outlines(text), &text.colour.into()),
        Item::Image { rect, image } => paint_image(page, to_pixels, rect, image),
    }
}

fn sides(rect: &Rect) -> Option<tiny_skia::Rect> {
    tiny_skia::Rect::from_xywh(rect.x as f32, rect.y as f32, rect.width as f32, rect.height as f32)
}

fn paint_path(page: &mut Pixmap, to_pixels: Transform, path: Option<Path>, paint: &Paint) {
    let Some(path) = path else { return };
    if let Some(fill) = paint.fill {
        page.fill_path(&path, &colour(fill), FillRule::Winding, to_pixels, None);
    }
    if let Some(stroke) = paint.stroke {
        // Repeat a list of odd length, as SVG does
        let lengths = stroke.dash.iter().map(|&length| length as f32);
        let dash = lengths.clone().chain(lengths.take(stroke.dash.len() % 2 * stroke.dash.len())).collect();
        let dash = StrokeDash::new(dash, 0.0);
        let style = Stroke { width: stroke.width as f32, line_join: LineJoin::Round, dash, ..Stroke::default() };
        page.stroke_path(&path, &colour(stroke.colour), &style, to_pixels, None);
    }
}

fn colour(Colour { r, g, b, alpha }: Colour) -> tiny_skia::Paint<'static> {
    let mut paint = tiny_skia::Paint::default();
    paint.set_color_rgba8(r, g, b, alpha);
    paint
}

fn paint_image(page: &mut Pixmap, to_pixels: Transform, rect: &Rect, image: &Rgb8) {
    let coloured = |p: [u8; 3]| if image.is_clear(p) { [0; 4] } else { [p[0], p[1], p[2], 255] };
    let rgba = image.pixels().pixels().flat_map(|p| coloured(p.0)).collect();
    let size = IntSize::from_wh(image.width() as u32, image.height() as u32);
    let Some(pixels) = size.and_then(|size| Pixmap::from_vec(rgba, size)) else { return };
    let Some(sides) = sides(rect) else { return };
    let (across, down) = (rect.width / image.width() as f64, rect.height / image.height() as f64);
    // Enlarged pixels stay sharp squares.
    let quality = if across >= 1.0 && down >= 1.0 { FilterQuality::Nearest } else { FilterQuality::Bicubic };
    let to_rect = Transform::from_row(across as f32, 0.0, 0.0, down as f32, rect.x as f32, rect.y as f32);
    let shader = Pattern::new(pixels.as_ref(), SpreadMode::Pad, quality, 1.0, to_rect);
    page.fill_rect(sides, &tiny_skia::Paint { shader, ..tiny_skia::Paint::default() }, to_pixels, None);
}

/// The transform from the start of a text's baseline to the drawing.
fn placed(text: &Text) -> Transform {
    let [x, y] = text.at.map(|v| v as f32);
    let at_point = Transform::from_translate(x, y);
    let turned = if text.upwards { at_point.pre_rotate(-90.0) } else { at_point };
    turned.pre_translate(text.start() as f32, text.drop() as f32)
}

/// The letters of a text, from the start of its baseline.
fn outlines(text: &Text) -> Option<Path> {
    let (mut outlines, mut x) = (Outlines { path: PathBuilder::new(), scale: 0.0, at: [0.0; 2] }, 0.0);
    // Append the glyphs of each run at the pen's position
    for run in text::runs(&text.markup, text.size, text.bold) {
        let tables = run.face.tables();
        outlines.scale = (run.size / f64::from(tables.units_per_em())) as f32;
        for c in run.text.chars() {
            // What has no glyph shows the font's empty box, except for control characters.
            let c = if c.is_control() { ' ' } else { c };
            outlines.at = [x as f32, -run.rise as f32];
            tables.outline_glyph(tables.glyph_index(c).unwrap_or_default(), &mut outlines);
            x += run.size * run.face.advance(c);
        }
    }
    outlines.path.finish()
}

/// A path of glyphs, each scaled from font units (y up) and put in its place (y down).
struct Outlines {
    path: PathBuilder,
    scale: f32,
    at: [f32; 2],
}

impl Outlines {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        (self.at[0] + self.scale * x, self.at[1] - self.scale * y)
    }
}

impl ttf_parser::OutlineBuilder for Outlines {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.place(x1, y1), self.place(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.place(x1, y1), self.place(x2, y2), self.place(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
#[cfg(test)]
mod tests {
    use super::super::rgb8::PNG_HEADER;
    use super::*;

    fn painted(drawing: &Page) -> image::RgbImage {
        image::load_from_memory(&drawing.png().unwrap()).unwrap().into_rgb8()
    }

    #[test]
    fn images_and_rectangles_at_scale_1_are_exact() {
        let base = Rgb8::from_fn(37, 23, |x, y| [(x * 7) as u8, (y * 11) as u8, (x * y) as u8]);
        let mut drawing = Page::over(base.clone());
        drawing.rect(Rect::new(33.0, 5.0, 9.0, 5.0), Colour::rgb(1, 200, 3));
        let out = painted(&drawing);
        assert_eq!(out.dimensions(), (37, 23));
        for (x, y, pixel) in out.enumerate_pixels() {
            let inside = x >= 33 && (5..10).contains(&y);
            let expected = if inside { [1, 200, 3] } else { base.pixel(x as usize, y as usize) };
            assert_eq!(pixel.0, expected, "pixel {x}, {y}");
        }
    }

    #[test]
    fn enlarged_pixels_stay_sharp() {
        let mut drawing = Page::new(4.0, 4.0, 2.0);
        drawing.image(Rect::new(0.0, 0.0, 4.0, 4.0), Rgb8::new(2, 1, vec![10, 20, 30, 200, 100, 50]));
        for (x, _, pixel) in painted(&drawing).enumerate_pixels() {
            assert_eq!(pixel.0, if x < 4 { [10, 20, 30] } else { [200, 100, 50] });
        }
    }

    #[test]
    fn text_is_painted_with_the_embedded_font() {
        let mut drawing = Page::new(40.0, 20.0, 1.0);
        drawing.text(Text::new([2.0, 15.0], 14.0, "θ∥"));
        let dark = painted(&drawing).pixels().filter(|p| p.0[0] < 100).count();
        assert!((10..200).contains(&dark), "{dark} dark pixels");
    }

    #[test]
    fn the_file_states_its_resolution() {
        let png = Page::new(20.0, 10.0, 2.0).png().unwrap();
        assert_eq!(png[PNG_HEADER + 4..PNG_HEADER + 8], *b"pHYs");
        // 192 pixels per inch are 7559 per metre; decoders check the sum
        assert_eq!(png[PNG_HEADER + 8..PNG_HEADER + 12], 7559u32.to_be_bytes());
        assert_eq!(image::load_from_memory(&png).unwrap().width(), 40);
    }

    #[test]
    fn few_colours_are_the_same_picture_in_a_smaller_file() {
        let mut drawing = Page::new(200.0, 100.0, 2.0);
        drawing.text(Text::new([2.0, 60.0], 40.0, "θ∥ 0.25"));
        let (exact, few) = (painted(&drawing), Page { few_colours: true, ..drawing.clone() });
        assert_eq!(painted(&few), exact, "a text has few colours");
        assert!(few.png().unwrap().len() < drawing.png().unwrap().len());
    }

    #[test]
    fn impossible_sizes_are_errors() {
        for size in [0.0, -3.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(Page::new(size, 10.0, 1.0).png().is_err(), "{size}");
        }
    }
}
