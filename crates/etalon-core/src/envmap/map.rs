//! The map itself: radiance by texel and by direction, and what had to be cleaned. The light probe of Grace Cathedral is recognised
//! by its texels: its file stores the floor in row 0.

use super::latlong::LatLong;
use crate::error::{Error, Result};
use crate::math::{Rgb, mean_rgb};
use crate::memory;
use crate::raster::Image;
use glam::DVec3;
use sha2::{Digest, Sha256};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// A lat-long map of radiance, finite and not negative.
#[derive(Debug, Clone)]
pub struct EnvMap {
    image: Image,
    geometry: LatLong,
    found: Found,
    hash: OnceLock<u64>,
}

/// The range of values in an image before it was cleaned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Smallest finite value of any channel; NaN if there is none.
    pub min: f32,
    /// Largest finite value of any channel; NaN if there is none.
    pub max: f32,
    /// Texels with a channel that is NaN or infinite; such values count as 0.
    pub nonfinite: usize,
    /// Texels with a negative channel; such values count as 0.
    pub negative: usize,
}

impl EnvMap {
    /// Takes an image (row 0 the zenith) and sets its non-finite and negative values to 0, counting them.
    pub fn new(mut image: Image) -> Self {
        let mut found = Found { min: f32::INFINITY, max: f32::NEG_INFINITY, nonfinite: 0, negative: 0 };
        for p in image.pixels_mut() {
            found.nonfinite += usize::from(!p.is_finite());
            found.negative += usize::from(p.to_array().iter().any(|c| c.is_finite() && *c < 0.0));
            *p = Rgb::from_array(p.to_array().map(|c| {
                if !c.is_finite() {
                    return 0.0;
                }
                found.min = found.min.min(c);
                found.max = found.max.max(c);
                c.max(0.0)
            }));
        }
        if found.min > found.max {
            (found.min, found.max) = (f32::NAN, f32::NAN);
        }
        let geometry = LatLong::new(image.width(), image.height());
        Self { image, geometry, found, hash: OnceLock::new() }
    }

    /// Where its texels lie on the sphere.
    #[inline]
    pub fn geometry(&self) -> &LatLong {
        &self.geometry
    }

    /// The cleaned texels.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// A hash of its texels, computed at the first call.
    pub fn hash(&self) -> u64 {
        *self.hash.get_or_init(|| self.image.hash())
    }

    /// What was found in the file and what had to be cleaned.
    pub fn found(&self) -> Found {
        self.found
    }

    /// Radiance of texel (x, y).
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> Rgb {
        self.image.get(x, y)
    }

    /// Radiance from a direction: that of its texel, without interpolation, which is what the samplers assume.
    #[inline]
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        let (x, y) = self.geometry.texel(direction);
        self.texel(x, y)
    }

    /// (R + G + B) / 3 of texel (x, y): what samplers weigh radiance by.
    #[inline]
    pub fn mean_rgb(&self, x: usize, y: usize) -> f64 {
        mean_rgb(self.texel(x, y))
    }

    /// Mean of R, G, B of texel (x, y) times its solid angle.
    #[inline]
    pub fn energy(&self, x: usize, y: usize) -> f64 {
        self.mean_rgb(x, y) * self.geometry.solid_angle(y)
    }

    /// Mean of R, G and B over the sphere.
    pub fn mean(&self) -> f64 {
        let row = |y: usize| self.image.row(y).iter().map(|p| mean_rgb(*p)).sum::<f64>() * self.geometry.solid_angle(y);
        (0..self.image.height()).map(row).sum::<f64>() / (4.0 * PI)
    }

    /// Asks for the memory of a table that takes n bytes for each texel.
    ///
    /// # Errors
    /// [`Error::Memory`](crate::Error::Memory).
    pub fn request(&self, bytes_per_texel: usize, table: &str) -> Result<()> {
        let (width, height) = (self.image.width(), self.image.height());
        memory::request(width * height * bytes_per_texel, || format!("{table} of a map of {width}x{height} texels"))
    }
}

/// The largest radiance that a map from a file may hold. Films hold samples below 2^63, and a sample is at most 4π times
/// the largest radiance, times the scale that a scene applies (8 in sphere-env): 10^18 at this limit.
pub const MAX_RADIANCE: f32 = 1e16;

/// Refuses an image with a finite value above [`MAX_RADIANCE`]; [`EnvMap::new`] handles infinite ones.
///
/// # Errors
/// [`Error::Limit`] with the row and column of the first such value.
pub fn check_range(path: &Path, image: &Image) -> Result<()> {
    let excess = |p: &Rgb| p.to_array().into_iter().find(|c| c.is_finite() && *c > MAX_RADIANCE);
    let found = image.pixels().iter().enumerate().find_map(|(i, pixel)| Some((i, excess(pixel)?)));
    let Some((i, value)) = found else { return Ok(()) };
    let (row, column) = (i / image.width(), i % image.width());
    Err(Error::limit(
        path,
        format!("the texel in row {row}, column {column} holds {value:e}, more than {MAX_RADIANCE:e}"),
    )
    .with_hint("scale the map down: renders cannot hold larger values (rows and columns count from 0)"))
}

/// A map with the name under which a user knows it.
#[derive(Debug, Clone)]
pub struct NamedMap {
    pub map: Arc<EnvMap>,
    /// A path as it was given, or a built-in name.
    pub name: String,
}

impl NamedMap {
    /// The name without folders, for texts.
    pub fn file_name(&self) -> &str {
        Path::new(&self.name).file_name().and_then(|name| name.to_str()).unwrap_or(&self.name)
    }
}

/// How an image holds the light probe of Grace Cathedral.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grace {
    /// As the file that is distributed: row 0 is the floor.
    UpsideDown,
    /// Turned: row 0 is the zenith.
    Upright,
}

const GRACE_SIZE: [usize; 2] = [1024, 512];
/// SHA-256 of the texels, row by row, as red, green and blue in f32 (little-endian).
const UPSIDE_DOWN: &str = "27123b8a7e761b7db7757f6595b7a473475e008f37203f0e01764174a5e85761";
/// The same of the turned map.
const UPRIGHT: &str = "df6c2e54ba03e12296399bd75b1696ea4910e7537ccce25f51f64644c84c8961";

impl Grace {
    /// How `image` holds the probe, if it is the probe to the last bit.
    pub fn of(image: &Image) -> Option<Self> {
        if [image.width(), image.height()] != GRACE_SIZE {
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
    fn bad_values_are_counted_and_set_to_zero() {
        let pixels = vec![Rgb::new(1.0, f32::NAN, 2.0), Rgb::new(-1.0, 3.0, 0.0), Rgb::splat(f32::INFINITY), Rgb::ONE];
        let map = EnvMap::new(Image::from_pixels(2, 2, pixels));
        assert_eq!(map.found(), Found { min: -1.0, max: 3.0, nonfinite: 2, negative: 1 });
        assert_eq!(map.texel(0, 0), Rgb::new(1.0, 0.0, 2.0));
        assert_eq!(map.texel(1, 0), Rgb::new(0.0, 3.0, 0.0));
        assert_eq!(map.texel(0, 1), Rgb::ZERO);
    }

    #[test]
    fn values_beyond_the_range_are_refused_with_their_place() {
        let check = |value: f32| {
            let mut image = Image::from_fn(3, 2, |_, _| Rgb::ONE);
            image.set(1, 1, Rgb::new(0.0, value, 0.0));
            check_range(Path::new("a.pfm"), &image)
        };
        for value in [-1e38, 0.0, MAX_RADIANCE, f32::INFINITY, f32::NAN] {
            check(value).unwrap();
        }
        for value in [1.001 * MAX_RADIANCE, 1e38] {
            let error = check(value).unwrap_err().to_string();
            assert!(error.starts_with("a.pfm: the texel in row 1, column 1 "), "{error}");
        }
    }

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
