//! The trait that textbook formulas are generic over, `f32`, `f64` and the arbitrary precision of the reference; and the rounding of
//! the first two.

use etalon_core::math::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a formula gives: a number (the others are 0), a vector, or nothing, such as a ray that misses.
pub type Value<T> = Option<[T; 3]>;

pub type Formula<T> = fn(&[T]) -> Value<T>;

/// The value of a formula for a number.
pub fn scalar<T: Number>(value: T) -> Value<T> {
    Some([value, T::of(0.0), T::of(0.0)])
}

/// A number that a formula can be written in once and evaluated in any precision.
pub trait Number:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A constant, exact in f64.
    fn of(value: f64) -> Self;

    fn pi() -> Self;

    /// √x; NaN below 0.
    fn sqrt(self) -> Self;

    fn exp(self) -> Self;

    /// 1 − erf(x) for x ≥ 0.
    fn erfc(self) -> Self;

    /// Sine and cosine of `self` · 2π.
    fn sin_cos_turns(self) -> [Self; 2];

    #[must_use]
    fn square(self) -> Self {
        self * self
    }
}

macro_rules! machine_number {
    ($type:ty, $erfc:path, $pi:expr) => {
        impl Number for $type {
            fn of(value: f64) -> Self {
                value as $type
            }

            fn pi() -> Self {
                $pi
            }

            fn sqrt(self) -> Self {
                self.sqrt()
            }

            fn exp(self) -> Self {
                self.exp()
            }

            fn erfc(self) -> Self {
                $erfc(self)
            }

            fn sin_cos_turns(self) -> [Self; 2] {
                let (sin, cos) = (2.0 * $pi * self).sin_cos();
                [sin, cos]
            }
        }
    };
}

machine_number!(f32, libm::erfcf, std::f32::consts::PI);
machine_number!(f64, libm::erfc, std::f64::consts::PI);

/// a · b, summed from the first component on.
pub fn dot<T: Number>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn normalized<T: Number>(v: [T; 3]) -> [T; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

pub fn cross<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

pub fn minus<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// A float of the machine: what the code that renders is generic over, also a [`Number`].
pub trait Machine: Real + Number {}

impl Machine for f32 {}
impl Machine for f64 {}

/// The precision that a variant is evaluated in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub enum Precision {
    /// `f32`.
    #[default]
    #[serde(rename = "f32")]
    Single,
    /// `f64`.
    #[serde(rename = "f64")]
    Double,
}

impl Precision {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Single, Self::Double];

    /// Its name in tables: `f32` or `f64`.
    pub fn name(self) -> &'static str {
        if self == Self::Single { "f32" } else { "f64" }
    }

    /// The nearest number of this precision.
    pub fn round(self, x: f64) -> f64 {
        if self == Self::Single { f64::from(x as f32) } else { x }
    }

    /// The smallest normal number.
    pub fn least(self) -> f64 {
        if self == Self::Single { f64::from(f32::MIN_POSITIVE) } else { f64::MIN_POSITIVE }
    }

    /// The distance from |x| to the next larger number of this precision.
    pub fn unit(self, x: f64) -> f64 {
        match self {
            Self::Single => {
                let x = (x.abs() as f32).min(f32::MAX.next_down());
                f64::from(x.next_up()) - f64::from(x)
            }
            Self::Double => {
                let x = x.abs().min(f64::MAX.next_down());
                x.next_up() - x
            }
        }
    }

    /// Half a unit of the last place of 1: the largest relative error of one rounding.
    pub fn rounding(self) -> f64 {
        self.unit(1.0) / 2.0
    }

    /// The shortest decimal that reads back as `x`.
    pub fn text(self, x: f64) -> String {
        if self == Self::Single { format!("{:?}", x as f32) } else { format!("{x:?}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_the_last_place() {
        assert_eq!(Precision::Single.unit(1.0), f64::from(f32::EPSILON));
        assert_eq!(Precision::Double.unit(-1.5), f64::EPSILON);
        assert_eq!(Precision::Double.unit(0.0), 5e-324);
        assert!(Precision::Single.unit(1e300).is_finite());
    }
}
