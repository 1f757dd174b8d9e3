//! Maps that find bugs: constant, a single texel, black.

use crate::math::Rgb;
use crate::raster::Image;

const WIDTH: usize = 64;
const HEIGHT: usize = 32;

/// Column and row of the one bright texel of `onehot`: away from the axes, the poles and the seam, without symmetry.
pub const ONE_HOT_TEXEL: (usize, usize) = (21, 11);
/// Its radiance: three different values, so that swapped channels show.
pub const ONE_HOT_RADIANCE: Rgb = Rgb::new(1000.0, 500.0, 250.0);

/// Radiance 1 from everywhere.
pub fn constant() -> Image {
    black().map(|_| Rgb::ONE)
}

/// Black but for [`ONE_HOT_TEXEL`].
pub fn one_hot() -> Image {
    let mut image = black();
    image.set(ONE_HOT_TEXEL.0, ONE_HOT_TEXEL.1, ONE_HOT_RADIANCE);
    image
}

/// No light.
pub fn black() -> Image {
    Image::new(WIDTH, HEIGHT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_texel_is_hot() {
        let image = one_hot();
        assert_eq!(image.get(21, 11), Rgb::new(1000.0, 500.0, 250.0));
        assert_eq!(image.pixels().iter().filter(|&&p| p != Rgb::ZERO).count(), 1);
        assert!(constant().pixels().iter().all(|&p| p == Rgb::ONE));
    }
}
