//! The trait that textbook formulas are generic over: `f32`, `f64`, and the arbitrary precision of the reference.

use crate::math::Real;
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
