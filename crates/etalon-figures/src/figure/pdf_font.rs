//! Fonts in a PDF: the glyphs that the page uses, their widths, and their characters for search and copy.

use super::text::{self, Face};
use flate2::{Compression, write::ZlibEncoder};
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use std::collections::BTreeMap;
use std::io::Write;
use subsetter::GlyphRemapper;

/// The glyphs of a font that the page uses, with their characters and widths.
#[derive(Default)]
pub(super) struct Subset {
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
pub(super) fn name(face: Face) -> &'static str {
    match face {
        Face::Regular => "F0",
        Face::Oblique => "F1",
        Face::Bold => "F2",
    }
}

/// `bytes` as a zlib stream, which PDF calls FlateDecode.
pub(super) fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("written to memory")
}
