//! An image to draw on: marks are placed by the image's own pixels, and the PNG has exactly its size.

use super::drawing::Drawing;
use super::rgb8::Rgb8;
use super::shapes::Rect;

/// A drawing of the image's size in units, filled by the image; pixel (x, y) covers `[x, x + 1] x [y, y + 1]`.
#[must_use]
pub fn overlay(base: Rgb8) -> Drawing {
    let (width, height) = (base.width() as f64, base.height() as f64);
    let mut drawing = Drawing::new(width, height, 1.0);
    drawing.image(Rect::new(0.0, 0.0, width, height), base);
    drawing
}

#[cfg(test)]
mod tests {
    use super::super::shapes::Colour;
    use super::*;

    #[test]
    fn only_the_marked_pixels_change() {
        let base = Rgb8::from_fn(64, 32, |x, y| [x as u8 * 4, y as u8 * 8, 77]);
        let mut drawing = overlay(base.clone());
        drawing.rect(Rect::new(62.0, 30.0, 5.0, 5.0), Colour::WHITE);
        let png = image::load_from_memory(&drawing.png().unwrap()).unwrap().into_rgb8();
        assert_eq!(png.dimensions(), (64, 32));
        let changed = png.as_raw().chunks(3).zip(base.data().chunks(3)).filter(|(a, b)| a != b).count();
        assert_eq!(changed, 4, "the mark is cut at the edge of the image");
    }
}
