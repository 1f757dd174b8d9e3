//! The range of radiance that renders can hold.

use crate::error::{Error, Result};
use crate::math::Rgb;
use crate::raster::Image;
use std::path::Path;

/// The largest radiance that a map from a file may hold. Films hold samples below 2^63, and a sample is at most 4π times
/// the largest radiance, times the scale that a scene applies (8 in sphere-env): 10^18 at this limit.
pub const MAX_RADIANCE: f32 = 1e16;

/// Refuses an image with a finite value above [`MAX_RADIANCE`]; [`EnvMap::new`](super::EnvMap::new) handles infinite ones.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
