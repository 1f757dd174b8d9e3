//! Mathematics below every other module: colours, the float type of the formulas, functions of arrays and hashes of words; local
//! frames and elementary functions in files of their own.

pub mod circular;
pub mod elementary;
mod frame;

pub use frame::Frame;

use etalon_random::hash::mix64;

/// Linear RGB: radiance, reflectance or power, by context.
pub type Rgb = glam::Vec3;

/// (R + G + B) / 3, in f64: the scalar that importance sampling weighs a colour by. It keeps more of saturated light than
/// luminance does.
#[inline]
pub fn mean_rgb(rgb: Rgb) -> f64 {
    let rgb = rgb.as_dvec3();
    (rgb.x + rgb.y + rgb.z) / 3.0
}

/// `f32` or `f64`, with the few literals and functions that formulas need.
pub trait Real: num_traits::Float + num_traits::FloatConst + std::fmt::Debug + Send + Sync + 'static {
    /// Where exp(x) falls below the smallest normal number; beyond it, it loses digits and takes ten times as long.
    const LEAST_EXPONENT: Self;

    /// A literal of the formula, rounded to the type.
    fn from_f64(value: f64) -> Self;

    /// The value in f64, exactly.
    fn to_f64(self) -> f64;

    /// exp(x) for x from [`Real::LEAST_EXPONENT`] to 88; see [`elementary`].
    fn exponential(self) -> Self;

    /// ln x for normal x > 0; see [`elementary`].
    fn logarithm(self) -> Self;

    /// exp(x²) erfc(x) for x ≥ 0, to a few units of the type's last place; see [`elementary`].
    fn erfcx(self) -> Self;

    /// erf(x) for x ≥ 0, to a few units of the last place of 1.
    #[inline]
    #[must_use]
    fn error_function(self) -> Self {
        Self::one() - (-self * self).exp() * self.erfcx()
    }
}

/// Implements [`Real`] by functions of the type's own precision.
macro_rules! real {
    ($float:ty, $least_exponent:literal, $exp:path, $ln:path, $erfcx:path) => {
        impl Real for $float {
            const LEAST_EXPONENT: Self = $least_exponent;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn exponential(self) -> Self {
                $exp(self)
            }

            #[inline(always)]
            fn logarithm(self) -> Self {
                $ln(self)
            }

            #[inline(always)]
            fn erfcx(self) -> Self {
                elementary::erfcx(self, &$erfcx)
            }
        }
    };
}

real!(f32, -87.3, elementary::exp_f32, elementary::ln_f32, elementary::ERFCX_SINGLE);
real!(f64, -708.0, elementary::exp_f64, elementary::ln_f64, elementary::ERFCX_DOUBLE);

/// `f` of every element. The standard library's `map` is not guaranteed to be inlined, and then the loop that calls it does not
/// vectorize.
#[inline(always)]
pub fn map_array<A: Copy, B: Copy, const N: usize>(a: [A; N], f: impl Fn(A) -> B) -> [B; N] {
    let mut all = [f(a[0]); N];
    for i in 1..N {
        all[i] = f(a[i]);
    }
    all
}

/// A hash of words that goes on from `start`.
///
/// Words go to several hashes in turn, so that one step need not wait for the last; they are then hashed together.
pub fn hash_words(start: u64, words: impl IntoIterator<Item = u32>) -> u64 {
    let mut turns = [start; 8];
    for (i, word) in words.into_iter().enumerate() {
        let hash = &mut turns[i % 8];
        *hash = mix64(*hash ^ u64::from(word)).wrapping_add(1);
    }
    turns.into_iter().fold(start, |sum, hash| mix64(sum ^ hash).wrapping_add(1))
}
