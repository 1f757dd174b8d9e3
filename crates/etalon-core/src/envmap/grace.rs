//! The light probe of Grace Cathedral, recognised by its texels: its file stores the floor in row 0.

use crate::raster::Image;
use sha2::{Digest, Sha256};

/// How an image holds the probe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grace {
    /// As the file that is distributed: row 0 is the floor.
    UpsideDown,
    /// Turned: row 0 is the zenith.
    Upright,
}

const SIZE: [usize; 2] = [1024, 512];
/// SHA-256 of the texels, row by row, as red, green and blue in f32 (little-endian).
const UPSIDE_DOWN: &str = "27123b8a7e761b7db7757f6595b7a473475e008f37203f0e01764174a5e85761";
/// The same of the turned map.
const UPRIGHT: &str = "df6c2e54ba03e12296399bd75b1696ea4910e7537ccce25f51f64644c84c8961";

impl Grace {
    /// How `image` holds the probe, if it is the probe to the last bit.
    #[must_use]
    pub fn of(image: &Image) -> Option<Self> {
        if [image.width(), image.height()] != SIZE {
            return None;
        }
        match checksum(image).as_str() {
            UPSIDE_DOWN => Some(Self::UpsideDown),
            UPRIGHT => Some(Self::Upright),
            _ => None,
        }
    }
}

fn checksum(image: &Image) -> String {
    let mut hash = Sha256::new();
    for y in 0..image.height() {
        let row: Vec<u8> = image.row(y).iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
        hash.update(row);
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    #[test]
    fn the_checksum_covers_every_texel_and_its_place() {
        let image = Image::from_fn(3, 2, |x, y| Rgb::new(x as f32, y as f32, 0.5));
        assert_eq!(checksum(&image), "f09882cb5669f34a3e3bcd428ef333cfc4660386318b7bc2b2484b56ce658662");
        let mut other = image.clone();
        other.set(2, 1, Rgb::new(2.0, 1.0, 0.5f32.next_up()));
        assert_ne!(checksum(&image), checksum(&other));
        assert_ne!(checksum(&image), checksum(&image.clone().flipped_vertically()));
    }

    #[test]
    fn a_map_of_that_size_is_not_the_probe() {
        assert_eq!(Grace::of(&Image::new(1024, 512)), None);
        assert_eq!(Grace::of(&Image::new(64, 32)), None);
    }
}
