//! A drawing as PNG, painted from its own SVG with the embedded fonts: no font of the system is ever asked for.

use super::drawing::Drawing;
use super::rgb8::Rgb8;
use super::text::Face;
use crate::error::{Error, Result};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, fontdb};
use std::sync::{Arc, LazyLock};

/// The longest PNG side, and the largest PNG (512 MiB while it is painted).
const MAX_SIDE: f64 = 32768.0;
const MAX_PIXELS: f64 = 134_217_728.0;

impl Drawing {
    /// The drawing as a PNG file of `width * scale` by `height * scale` pixels, each rounded up.
    ///
    /// # Errors
    /// When a side is less than one pixel or more than 32768, or the area more than 2^27 pixels.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.paint(&self.svg())
    }

    /// [`Self::png`] from the SVG at hand.
    pub(super) fn paint(&self, svg: &str) -> Result<Vec<u8>> {
        let (w, h) = ((self.width() * self.scale()).ceil(), (self.height() * self.scale()).ceil());
        let unpaintable = |what: String| {
            Error::parameter("figure size", format!("{w} x {h} pixels: {what}"))
                .with_hint(format!("a figure may have 1 to {MAX_SIDE} pixels a side and {MAX_PIXELS} in all"))
        };
        // Also false for NaN.
        if !(w >= 1.0 && h >= 1.0 && w <= MAX_SIDE && h <= MAX_SIDE && w * h <= MAX_PIXELS) {
            return Err(unpaintable("cannot be painted".to_owned()));
        }
        let tree = usvg::Tree::from_str(svg, &options()).map_err(|e| unpaintable(e.to_string()))?;
        let mut pixmap = Pixmap::new(w as u32, h as u32).ok_or_else(|| unpaintable("too large".to_owned()))?;
        resvg::render(&tree, Transform::from_scale(self.scale() as f32, self.scale() as f32), &mut pixmap.as_mut());
        // The page is opaque white below everything, so alpha carries nothing.
        let mut rgb = Vec::with_capacity(pixmap.data().len() / 4 * 3);
        for pixel in pixmap.data().chunks_exact(4) {
            rgb.extend_from_slice(&pixel[..3]);
        }
        Ok(Rgb8::new(w as usize, h as usize, rgb).png().to_vec())
    }
}

fn options() -> usvg::Options<'static> {
    static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
        let mut fonts = fontdb::Database::new();
        for face in Face::ALL {
            fonts.load_font_source(fontdb::Source::Binary(Arc::new(face.bytes())));
        }
        Arc::new(fonts)
    });
    usvg::Options { fontdb: FONTS.clone(), ..Default::default() }
}

#[cfg(test)]
mod tests {
    use super::super::shapes::{Colour, Rect, Text};
    use super::*;

    fn painted(drawing: &Drawing) -> image::RgbImage {
        image::load_from_memory(&drawing.png().unwrap()).unwrap().into_rgb8()
    }

    #[test]
    fn images_and_rectangles_at_scale_1_are_exact() {
        let base = Rgb8::from_fn(37, 23, |x, y| [(x * 7) as u8, (y * 11) as u8, (x * y) as u8]);
        let mut drawing = Drawing::new(37.0, 23.0, 1.0);
        drawing.image(Rect::new(0.0, 0.0, 37.0, 23.0), base.clone());
        drawing.rect(Rect::new(3.0, 5.0, 5.0, 5.0), Colour::rgb(1, 200, 3));
        let out = painted(&drawing);
        assert_eq!(out.dimensions(), (37, 23));
        for (x, y, pixel) in out.enumerate_pixels() {
            let inside = (3..8).contains(&x) && (5..10).contains(&y);
            let i = 3 * (y as usize * 37 + x as usize);
            let expected = if inside { [1, 200, 3] } else { [base.data()[i], base.data()[i + 1], base.data()[i + 2]] };
            assert_eq!(pixel.0, expected, "pixel {x}, {y}");
        }
    }

    #[test]
    fn enlarged_pixels_stay_sharp() {
        let mut drawing = Drawing::new(4.0, 4.0, 2.0);
        drawing.image(Rect::new(0.0, 0.0, 4.0, 4.0), Rgb8::new(2, 1, vec![10, 20, 30, 200, 100, 50]));
        for (x, _, pixel) in painted(&drawing).enumerate_pixels() {
            assert_eq!(pixel.0, if x < 4 { [10, 20, 30] } else { [200, 100, 50] });
        }
    }

    #[test]
    fn text_is_painted_with_the_embedded_font() {
        let mut drawing = Drawing::new(40.0, 20.0, 1.0);
        drawing.text(Text::new([2.0, 15.0], 14.0, "θ∥"));
        let dark = painted(&drawing).pixels().filter(|p| p.0[0] < 100).count();
        assert!((10..200).contains(&dark), "{dark} dark pixels");
    }

    #[test]
    fn impossible_sizes_are_errors() {
        for size in [0.0, -3.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(Drawing::new(size, 10.0, 1.0).png().is_err(), "{size}");
        }
    }
}
