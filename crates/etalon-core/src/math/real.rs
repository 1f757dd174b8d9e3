//! The float type that the formulas are generic over, so that the stability study runs the very code that renders.

use super::{elementary, error_function};

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

    /// exp(x²) erfc(x) for x ≥ 0, to a few units of the type's last place; see [`error_function`].
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
                error_function::erfcx(self, &$erfcx)
            }
        }
    };
}

real!(f32, -87.3, elementary::exp_f32, elementary::ln_f32, error_function::SINGLE);
real!(f64, -708.0, elementary::exp_f64, elementary::ln_f64, error_function::DOUBLE);
