//! The trait that textbook formulas are generic over, and its numbers: `f32` and `f64` with their rounding, and those of 256 bits
//! (77 digits) of the reference, an arbitrary-precision library behind a [`Number`] that is `Copy`.

use dashu_float::round::mode::HalfEven;
use dashu_float::{Context, FBig, Repr};
use dashu_int::{IBig, Sign, UBig};
use etalon_core::math::Real;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::OnceLock;

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

type Big = FBig<HalfEven, 2>;

const BITS: usize = 256;

/// Bytes of the mantissa, with one more for the carry of sums.
const BYTES: usize = BITS / 8 + 1;

const CONTEXT: Context<HalfEven> = Context::new(BITS);

/// Below this exponent exp(x) is taken for 0, long before the library runs out of exponents.
const VANISHING: f64 = -1e7;

/// A number of [`BITS`] bits, rounded to the nearest after each operation. Undefined results (0/0, √−1) and infinities are
/// NaN, unequal to everything as in IEEE 754.
#[derive(Debug, Clone, Copy)]
pub struct Precise {
    mantissa: [u8; BYTES],
    negative: bool,
    exponent: isize,
    exists: bool,
}

impl Precise {
    pub const NAN: Self = Self { mantissa: [0; BYTES], negative: false, exponent: 0, exists: false };

    /// The nearest double; infinite beyond the range, NaN where there is no number.
    pub fn to_f64(self) -> f64 {
        if self.exists { self.big().to_f64().value() } else { f64::NAN }
    }

    pub fn power_of_two(exponent: isize) -> Self {
        Self { exponent, ..Self::of(1.0) }
    }

    fn is_zero(self) -> bool {
        self.exists && self.mantissa == [0; BYTES]
    }

    fn big(self) -> Big {
        let sign = if self.negative { Sign::Negative } else { Sign::Positive };
        let significand = IBig::from_parts(sign, UBig::from_le_bytes(&self.mantissa));
        Big::from_repr(Repr::new(significand, self.exponent), CONTEXT)
    }

    fn from_big(value: Big) -> Self {
        let repr = value.into_repr();
        if repr.is_infinite() {
            return Self::NAN;
        }
        let (significand, exponent) = repr.into_parts();
        let (sign, magnitude) = significand.into_parts();
        let bytes = magnitude.to_le_bytes();
        let mut mantissa = [0; BYTES];
        mantissa[..bytes.len()].copy_from_slice(&bytes);
        Self { mantissa, negative: sign == Sign::Negative, exponent, exists: true }
    }

    /// `f` of both numbers; NaN if one of them is.
    fn with(self, other: Self, f: impl FnOnce(Big, Big) -> Big) -> Self {
        if self.exists && other.exists { Self::from_big(f(self.big(), other.big())) } else { Self::NAN }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $operator:tt) => {
        impl $trait for Precise {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.with(other, |a, b| a $operator b)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);

impl Div for Precise {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.is_zero() { Self::NAN } else { self.with(other, |a, b| a / b) }
    }
}

impl Neg for Precise {
    type Output = Self;
    fn neg(self) -> Self {
        Self { negative: !self.negative & !self.is_zero(), ..self }
    }
}

impl PartialEq for Precise {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Precise {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        (self.exists && other.exists).then(|| self.big().cmp(&other.big()))
    }
}

impl Number for Precise {
    fn of(value: f64) -> Self {
        Big::try_from(value).map_or(Self::NAN, |big| Self::from_big(big.with_precision(BITS).value()))
    }

    fn pi() -> Self {
        static PI: OnceLock<Precise> = OnceLock::new();
        *PI.get_or_init(|| Self::from_big(CONTEXT.pi::<2>(None).value()))
    }

    fn sqrt(self) -> Self {
        if self.negative { Self::NAN } else { self.with(self, |a, _| a.sqrt()) }
    }

    fn exp(self) -> Self {
        if self < Self::of(VANISHING) { Self::of(0.0) } else { self.with(self, |a, _| a.exp()) }
    }

    /// Up to 6 by 1 − 2x exp(−x²)/√π Σ (2x²)ⁿ/(1·3·…·(2n+1)), whose terms are positive: 200 bits remain. Beyond by the
    /// continued fraction exp(−x²)/√π / (x + ½/(x + 1/(x + 3/2/(x + …)))), whose first 80 divisions leave an error below
    /// exp(−2x √160). Source: Abramowitz & Stegun, 7.1.6 and 7.1.14.
    fn erfc(self) -> Self {
        if !self.exists {
            return self;
        }
        if self.negative {
            return Self::of(2.0) - (-self).erfc();
        }
        let gauss = (-self.square()).exp() / Self::pi().sqrt();
        if self > Self::of(6.0) {
            let tail = (1..=80).rev().fold(self, |below, n| self + Self::of(0.5 * f64::from(n)) / below);
            return gauss / tail;
        }
        let twice = (self.square() + self.square()).big();
        let (mut term, mut sum) = (Self::of(1.0).big(), Self::of(1.0).big());
        for odd in (3_u32..).step_by(2) {
            term = term * &twice / Big::from(odd);
            sum += &term;
            if Self::from_big(term.clone()) < Self::power_of_two(-260) {
                break;
            }
        }
        Self::of(1.0) - Self::of(2.0) * self * gauss * Self::from_big(sum)
    }

    fn sin_cos_turns(self) -> [Self; 2] {
        if !self.exists {
            return [self; 2];
        }
        let angle = (Self::of(2.0) * Self::pi() * self).big();
        let (sin, cos) = angle.sin_cos();
        [Self::from_big(sin), Self::from_big(cos)]
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

    fn near(a: Precise, b: Precise, bits: isize) {
        assert!(((a - b) / b).square() <= Precise::power_of_two(-2 * bits), "{} {}", a.to_f64(), b.to_f64());
    }

    #[test]
    fn machine_numbers_come_back_unchanged() {
        for x in [0.0, 1.0, -0.1, 1e-300, 5e-324, f64::MAX, 1.0 + f64::EPSILON] {
            assert_eq!(Precise::of(x).to_f64(), x);
        }
        assert_eq!(Precise::of(1e300).square().to_f64(), f64::INFINITY);
    }

    #[test]
    fn undefined_results_are_nan() {
        let (zero, one) = (Precise::of(0.0), Precise::of(1.0));
        for x in
            [one / zero, zero / zero, (-one).sqrt(), Precise::of(f64::NAN), Precise::of(f64::INFINITY), -Precise::NAN]
        {
            assert!(x.to_f64().is_nan() && (x + one).to_f64().is_nan() && x != x && x.erfc().to_f64().is_nan());
        }
        assert_eq!((-zero).sqrt().to_f64(), 0.0);
        assert_eq!(Precise::of(-1e300).exp().to_f64(), 0.0);
    }

    #[test]
    fn functions_satisfy_their_equations() {
        let third = Precise::of(1.0) / Precise::of(3.0);
        near(third.sqrt().square(), third, 250);
        near(third.exp() * (-third).exp(), Precise::of(1.0), 250);
        let [sin, cos] = third.sin_cos_turns();
        near(sin.square() + cos.square(), Precise::of(1.0), 250);
        near(cos, Precise::of(-0.5), 250);
        for x in [0.0, 1e-9, 0.5, 2.0, 5.9, 6.1, 20.0] {
            let expected = libm::erfc(x);
            assert!((Precise::of(x).erfc().to_f64() - expected).abs() <= 4.0 * f64::EPSILON * expected, "{x}");
        }
        // Series and continued fraction of erfc agree where one gives way to the other: its derivative is −2/√π exp(−x²).
        let step = Precise::power_of_two(-60);
        let (x, half) = (Precise::of(6.0), step / Precise::of(2.0));
        let slope = (x - half).erfc() - (x + half).erfc();
        near(slope / step, Precise::of(2.0) * (-x.square()).exp() / Precise::pi().sqrt(), 100);
    }
}
