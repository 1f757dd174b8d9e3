//! Textures: colours and numbers that vary over a surface with its texture coordinates (u, v).

use crate::math::Rgb;
use crate::raster::Image;
use glam::{DVec2, Vec2};
use std::fmt;
use std::sync::Arc;

/// A colour at each point (u, v) of a surface. A number is a colour of three equal channels.
#[derive(Debug, Clone, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    Image(ImageTexture),
    /// Squares of side 1 in (s, t), alternating between the first and the second texture; the one from (0, 0) to (1, 1) is of the first.
    Checkerboard {
        /// From (u, v) to (s, t).
        mapping: UvMapping,
        /// Textures of the squares.
        textures: Arc<[Texture; 2]>,
    },
    /// The product of two textures.
    Scale(Arc<[Texture; 2]>),
    /// (1 − amount) · first + amount · second, the amount being the third.
    Mix(Arc<[Texture; 3]>),
    /// The width α of a distribution of normals, by a texture of roughness.
    Alpha(RoughnessScale, Arc<Texture>),
}

/// What makes a width α of a distribution of normals of a roughness from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RoughnessScale {
    /// α is the roughness.
    Alpha,
    /// α = √roughness, as in pbrt-v4.
    SquareRoot,
    /// A polynomial in the logarithm of the roughness, as in pbrt-v3.
    Logarithmic,
}

impl RoughnessScale {
    /// The width α for a roughness.
    pub fn alpha(self, roughness: f64) -> f64 {
        match self {
            Self::Alpha => roughness,
            Self::SquareRoot => roughness.sqrt(),
            Self::Logarithmic => {
                let x = roughness.max(1e-3).ln();
                1.62142 + x * (0.819_955 + x * (0.1734 + x * (0.017_120_1 + x * 0.000_640_711)))
            }
        }
    }
}

/// (s, t) = scale · (u, v) + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvMapping {
    /// Factors on u and v.
    pub scale: DVec2,
    pub offset: DVec2,
}

impl UvMapping {
    /// (s, t) = (u, v).
    pub const IDENTITY: Self = Self { scale: DVec2::ONE, offset: DVec2::ZERO };

    fn st(&self, uv: Vec2) -> DVec2 {
        self.scale * uv.as_dvec2() + self.offset
    }
}

/// The texels of an image outside of \[0, 1\]².
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    Repeat,
    Black,
    /// The nearest texel of the image.
    Clamp,
}

/// An image over a surface, its left edge at s = 0 and its lower edge at t = 0. Between the centres of texels it is bilinear;
/// there are no smaller versions of it (mip maps), so that where it shrinks the samples of a pixel filter it.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageTexture {
    pub texels: Arc<Texels>,
    /// From (u, v) to (s, t).
    pub mapping: UvMapping,
    pub wrap: Wrap,
    /// Factor on the texels, at least 0.
    pub scale: f32,
    /// Whether the value is 1 minus that of the image, at least 0.
    pub invert: bool,
}

#[derive(Clone, PartialEq)]
pub struct Texels {
    image: Image,
    /// Least and largest channel.
    range: [f32; 2],
    /// A hash of all values.
    hash: u64,
}

impl Texels {
    /// The texels of an image of finite values.
    pub fn new(image: Image) -> Self {
        let (mut range, hash) = ([f32::INFINITY, f32::NEG_INFINITY], image.hash());
        for texel in image.pixels() {
            range = [range[0].min(texel.min_element()), range[1].max(texel.max_element())];
        }
        Self { image, range, hash }
    }

    /// A texel by column and row, counted from the upper left, of the wrapped image.
    fn get(&self, x: i64, y: i64, wrap: Wrap) -> Rgb {
        let (width, height) = (self.image.width() as i64, self.image.height() as i64);
        let (x, y) = match wrap {
            Wrap::Repeat => (x.rem_euclid(width), y.rem_euclid(height)),
            Wrap::Clamp => (x.clamp(0, width - 1), y.clamp(0, height - 1)),
            Wrap::Black if (0..width).contains(&x) && (0..height).contains(&y) => (x, y),
            Wrap::Black => return Rgb::ZERO,
        };
        self.image.get(x as usize, y as usize)
    }

    /// The image at a point, (0, 0) being its lower left corner and (1, 1) its upper right one.
    fn bilinear(&self, st: DVec2, wrap: Wrap) -> Rgb {
        let size = DVec2::new(self.image.width() as f64, self.image.height() as f64);
        let place = DVec2::new(st.x, 1.0 - st.y) * size - 0.5;
        let corner = place.floor();
        let weight = (place - corner).as_vec2();
        // A float beyond the range of integers becomes the last of these.
        let (x, y) = (corner.x as i64, corner.y as i64);
        let row = |y| {
            let next = self.get(x.saturating_add(1), y, wrap);
            self.get(x, y, wrap).lerp(next, weight.x)
        };
        row(y).lerp(row(y.saturating_add(1)), weight.y)
    }
}

/// The hash stands for the values: what prints a scene to tell it from others has them all.
impl fmt::Debug for Texels {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Texels({}x{}, {:016x})", self.image.width(), self.image.height(), self.hash)
    }
}

impl ImageTexture {
    fn at(&self, uv: Vec2) -> Rgb {
        let value = self.scale * self.texels.bilinear(self.mapping.st(uv), self.wrap);
        if self.invert { (Rgb::ONE - value).max(Rgb::ZERO) } else { value }
    }

    fn range(&self) -> [f32; 2] {
        let [mut low, high] = self.texels.range;
        if self.wrap == Wrap::Black {
            low = low.min(0.0);
        }
        let [low, high] = [low, high].map(|value| self.scale * value);
        if self.invert { [1.0 - high, 1.0 - low].map(|value| value.max(0.0)) } else { [low, high] }
    }
}

impl Texture {
    /// The value at a point.
    pub fn at(&self, uv: Vec2) -> Rgb {
        match self {
            &Self::Constant(value) => value,
            Self::Image(image) => image.at(uv),
            Self::Checkerboard { mapping, textures } => {
                let square = mapping.st(uv).floor();
                let is_first = (square.x + square.y).rem_euclid(2.0) == 0.0;
                textures[usize::from(!is_first)].at(uv)
            }
            Self::Scale(factors) => factors[0].at(uv) * factors[1].at(uv),
            Self::Mix(parts) => {
                let [first, second, amount] = &**parts;
                let amount = amount.at(uv);
                first.at(uv) * (Rgb::ONE - amount) + second.at(uv) * amount
            }
            Self::Alpha(scale, roughness) => Rgb::splat(scale.alpha(f64::from(roughness.at(uv).x)) as f32),
        }
    }

    /// Bounds of the values of all channels: no less than the first, and no more than the second. Factors and amounts of
    /// textures in it must not be negative, nor amounts above 1.
    pub fn range(&self) -> [f32; 2] {
        match self {
            Self::Constant(value) => [value.min_element(), value.max_element()],
            Self::Image(image) => image.range(),
            Self::Checkerboard { textures, .. } => hull(&textures[..]),
            Self::Scale(factors) => {
                let [a, b] = [factors[0].range(), factors[1].range()];
                [a[0] * b[0], a[1] * b[1]]
            }
            Self::Mix(parts) => hull(&parts[..2]),
            Self::Alpha(scale, roughness) => {
                roughness.range().map(|roughness| scale.alpha(f64::from(roughness)) as f32)
            }
        }
    }
}

/// Bounds of the values of any of some textures.
fn hull(textures: &[Texture]) -> [f32; 2] {
    let empty = [f32::INFINITY, f32::NEG_INFINITY];
    textures.iter().map(Texture::range).fold(empty, |[low, high], [a, b]| [low.min(a), high.max(b)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[f32], width: usize, wrap: Wrap) -> ImageTexture {
        let image = Image::from_pixels(width, pixels.len() / width, pixels.iter().map(|&v| Rgb::splat(v)).collect());
        let texels = Arc::new(Texels::new(image));
        ImageTexture { texels, mapping: UvMapping::IDENTITY, wrap, scale: 1.0, invert: false }
    }

    fn at(texture: &ImageTexture, u: f32, v: f32) -> f32 {
        texture.at(Vec2::new(u, v)).x
    }

    #[test]
    fn the_lower_left_texel_is_at_the_origin() {
        // Rows from the top: 1 2, then 3 4.
        let texture = image(&[1.0, 2.0, 3.0, 4.0], 2, Wrap::Clamp);
        assert_eq!([at(&texture, 0.25, 0.75), at(&texture, 0.75, 0.75)], [1.0, 2.0]);
        assert_eq!([at(&texture, 0.25, 0.25), at(&texture, 0.75, 0.25)], [3.0, 4.0]);
        assert_eq!([at(&texture, 0.5, 0.5), at(&texture, 0.25, 0.5)], [2.5, 2.0]);
    }

    #[test]
    fn images_end_as_their_wrap_says() {
        let with = |wrap| image(&[1.0, 3.0], 2, wrap);
        for (u, repeat, black, clamp) in
            [(0.0, 2.0, 0.5, 1.0), (1.0, 2.0, 1.5, 3.0), (-0.25, 3.0, 0.0, 1.0), (7.25, 1.0, 0.0, 3.0)]
        {
            // In the middle of the only row: above and below are half a texel away.
            assert_eq!(at(&with(Wrap::Repeat), u, 0.5), repeat, "{u}");
            assert_eq!(at(&with(Wrap::Black), u, 0.5), black, "{u}");
            assert_eq!(at(&with(Wrap::Clamp), u, 0.5), clamp, "{u}");
        }
        // Coordinates beyond all integers.
        let far = UvMapping { scale: DVec2::splat(1e30), offset: DVec2::ZERO };
        for wrap in [Wrap::Repeat, Wrap::Black, Wrap::Clamp] {
            let texture = ImageTexture { mapping: far, ..with(wrap) };
            assert!((0.0..=3.0).contains(&at(&texture, 1e30, -1e30)), "{wrap:?}");
        }
    }

    #[test]
    fn mappings_scale_and_move() {
        let mapping = UvMapping { scale: DVec2::new(2.0, 1.0), offset: DVec2::new(0.5, 0.0) };
        let texture = ImageTexture { mapping, ..image(&[1.0, 3.0], 2, Wrap::Repeat) };
        // s = 2 u + ½: ¼ and ¾ are the centres of the texels.
        assert_eq!([at(&texture, 0.375, 0.5), at(&texture, 0.125, 0.5)], [1.0, 3.0]);
        let inverted = ImageTexture { scale: 0.25, invert: true, ..texture };
        assert_eq!([at(&inverted, 0.375, 0.5), at(&inverted, 0.125, 0.5)], [0.75, 0.25]);
        assert_eq!(inverted.range(), [0.25, 0.75]);
        let dark = ImageTexture { scale: 2.0, ..inverted };
        assert_eq!((at(&dark, 0.375, 0.5), dark.range()), (0.0, [0.0, 0.0]));
    }

    #[test]
    fn textures_of_textures() {
        let (a, b) = (Texture::Constant(Rgb::new(0.2, 0.4, 0.6)), Texture::Constant(Rgb::splat(0.5)));
        let mapping = UvMapping { scale: DVec2::splat(2.0), ..UvMapping::IDENTITY };
        let board = Texture::Checkerboard { mapping, textures: Arc::new([a.clone(), b.clone()]) };
        for (u, v, is_first) in
            [(0.1, 0.1, true), (0.6, 0.1, false), (0.6, 0.6, true), (-0.1, 0.1, false), (-0.1, -0.1, true)]
        {
            let expected = if is_first { &a } else { &b };
            assert_eq!(board.at(Vec2::new(u, v)), expected.at(Vec2::ZERO), "{u} {v}");
        }
        assert_eq!(board.range(), [0.2, 0.6]);
        let product = Texture::Scale(Arc::new([a.clone(), b.clone()]));
        assert_eq!((product.at(Vec2::ZERO), product.range()), (Rgb::new(0.1, 0.2, 0.3), [0.1, 0.3]));
        let mix = Texture::Mix(Arc::new([a, b, Texture::Constant(Rgb::splat(0.25))]));
        assert!((mix.at(Vec2::ZERO) - Rgb::new(0.275, 0.425, 0.575)).abs().max_element() < 1e-6);
        assert_eq!(mix.range(), [0.2, 0.6]);
        let alpha = Texture::Alpha(RoughnessScale::SquareRoot, Arc::new(Texture::Constant(Rgb::splat(0.25))));
        assert_eq!((alpha.at(Vec2::ZERO).x, alpha.range()), (0.5, [0.5; 2]));
    }

    #[test]
    fn the_third_versions_roughness_has_its_known_values() {
        let alpha = |roughness| RoughnessScale::Logarithmic.alpha(roughness);
        // The polynomial at 1 is its constant; below 0.001 it stays.
        assert_eq!(alpha(1.0), 1.62142);
        assert_eq!(alpha(0.0), alpha(1e-3));
        // 1.62142 − 0.819955·2.302585 + 0.1734·5.301898 − 0.0171201·12.20807 + 0.000640711·28.11012
        assert!((alpha(0.1) - 0.461_760).abs() < 1e-6, "{}", alpha(0.1));
        assert!((1..1000).all(|i| alpha(f64::from(i) / 1e3) < alpha(f64::from(i + 1) / 1e3)));
    }
}
