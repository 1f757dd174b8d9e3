//! Renders in a grid, with captions, at one exposure.

use crate::figure::{Drawing, Rgb8, contact_sheet};
use crate::raster::{Image, ToneMap, to_rgb8};

/// Captioned images in rows of `columns`, brightened by `stops`.
pub fn grid(title: &str, columns: usize, stops: f32, images: &[(String, &Image)]) -> Drawing {
    let shown = |(caption, image): &(String, &Image)| {
        (caption.clone(), Rgb8::new(image.width(), image.height(), to_rgb8(image, &ToneMap::Srgb { stops })))
    };
    contact_sheet(title, columns, &images.iter().map(shown).collect::<Vec<_>>())
}
