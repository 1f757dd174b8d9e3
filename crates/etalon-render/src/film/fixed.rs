//! Sums without rounding: fixed-point numbers of 128 bits with the unit 2^-64.
//!
//! The range of the film follows: light below 2^-64 = 5.4e-20 is 0, light from 2^-41 = 4.5e-13 to 2^63 = 9.2e18 loses no digit, and
//! between the two each sample loses less than 2^-64.
//!
//! Addition of integers is associative, addition of floats is not. With sums like these any split of the samples over
//! threads, shards and resumed runs, merged in any order, gives the same bits.

use etalon_core::math::Rgb;

/// A number from 0 to 2^64, in steps of 2^-64. Two words and not a `u128`, whose alignment would waste memory.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Fixed {
    high: u64,
    low: u64,
}

/// Values from here on are not added: a sum of two could leave the range.
pub const LIMIT: f32 = (1_u64 << 63) as f32;

/// The unit of sums: smaller values are 0.
pub const UNIT: f32 = 1.0 / (LIMIT * 2.0);

impl Fixed {
    /// What a sum stays at that would be larger: such a sum says nothing but "too large".
    pub const MAX: Self = Self { high: u64::MAX, low: u64::MAX };

    /// `v`, rounded down to a multiple of the unit (exact from 2^-41 on); `v` must lie in [0, [`LIMIT`]).
    #[inline]
    pub fn of(v: f32) -> Self {
        let (mantissa, exponent) = parts(v);
        // v = mantissa · 2^(exponent - 150), counted in units of 2^-64.
        Self::from_bits(match exponent.checked_sub(86) {
            Some(left) => u128::from(mantissa) << left,
            None => u128::from(mantissa >> (86 - exponent).min(63)),
        })
    }

    /// `a` times `b`, rounded down to a multiple of the unit (squares are exact from 2^-9 on, 0 below 2^-32); [`Fixed::MAX`]
    /// for what is too large (squares from 2^32 on).
    #[inline]
    pub fn product_of(a: f32, b: f32) -> Self {
        let ((a, exponent_a), (b, exponent_b)) = (parts(a), parts(b));
        let (product, exponent) = (a * b, exponent_a + exponent_b);
        Self::from_bits(match exponent.checked_sub(236) {
            Some(left @ 0..=80) => u128::from(product) << left,
            Some(_) => return Self::MAX,
            None => u128::from(product >> (236 - exponent).min(63)),
        })
    }

    /// The number as a count of units.
    #[inline]
    pub fn bits(self) -> u128 {
        u128::from(self.high) << 64 | u128::from(self.low)
    }

    /// The number of `bits` units.
    #[inline]
    pub fn from_bits(bits: u128) -> Self {
        Self { high: (bits >> 64) as u64, low: bits as u64 }
    }

    /// The nearest double.
    pub fn to_f64(self) -> f64 {
        self.bits() as f64 / TWO_64
    }
}

/// 2^64.
const TWO_64: f64 = (1_u128 << 64) as f64;

impl std::ops::AddAssign for Fixed {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = Self::from_bits(self.bits().saturating_add(other.bits()));
    }
}

/// A sum for each channel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FixedRgb(pub [Fixed; 3]);

impl FixedRgb {
    #[inline]
    pub fn of(value: Rgb) -> Self {
        Self(value.to_array().map(Fixed::of))
    }

    #[inline]
    pub fn product_of(a: Rgb, b: Rgb) -> Self {
        Self(std::array::from_fn(|c| Fixed::product_of(a[c], b[c])))
    }

    /// The mean of `n` values from their sum, rounded to f64 and then to f32; black without any.
    pub fn mean(self, n: f64) -> Rgb {
        if n == 0.0 { Rgb::ZERO } else { Rgb::from_array(self.0.map(|sum| (sum.to_f64() / n) as f32)) }
    }

    /// The sum over the channels.
    pub fn total(self) -> f64 {
        self.0.into_iter().map(Fixed::to_f64).sum()
    }
}

impl std::ops::AddAssign for FixedRgb {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        (0..3).for_each(|c| self.0[c] += other.0[c]);
    }
}

/// Mantissa m < 2^24 and exponent e >= 1 of `v` = m · 2^(e - 150); the sign (of a negative zero) is dropped.
#[inline]
fn parts(v: f32) -> (u64, u32) {
    let bits = v.to_bits();
    let (mantissa, exponent) = (u64::from(bits & 0x7f_ffff), bits >> 23 & 0xff);
    if exponent == 0 { (mantissa, 1) } else { (mantissa | 1 << 23, exponent) }
}

/// n·`squares` - `sum`², in the units of the square of a sum (2^-128), rounded once to f64; 0 if it is negative.
///
/// This difference is where the variance of nearly equal samples is lost in floating point. Here it is formed from
/// integers of 256 bits, so that equal samples give 0 and not noise.
pub fn spread(n: u32, sum: Fixed, squares: Fixed) -> f64 {
    let n = u64::from(n);
    let [low, high] = [squares.low, squares.high].map(|word| u128::from(word) * u128::from(n));
    let middle = (low >> 64) + (high & WORD);
    // n·squares in units of 2^-64 is three words; one word of zeros below turns it into units of 2^-128.
    let minuend = [0, low as u64, middle as u64, ((high >> 64) + (middle >> 64)) as u64];
    let subtrahend = square(sum);
    let mut difference = [0; 4];
    let mut borrow = false;
    for (d, (a, b)) in difference.iter_mut().zip(minuend.into_iter().zip(subtrahend)) {
        let (partial, under) = a.overflowing_sub(b);
        let (word, under_again) = partial.overflowing_sub(u64::from(borrow));
        (*d, borrow) = (word, under || under_again);
    }
    if borrow { 0.0 } else { to_f64(difference) / TWO_64 / TWO_64 }
}

const WORD: u128 = u64::MAX as u128;

/// The square of a sum: four words, the lowest first.
fn square(Fixed { high, low }: Fixed) -> [u64; 4] {
    let product = |a: u64, b: u64| u128::from(a) * u128::from(b);
    let (ll, lh, hh) = (product(low, low), product(low, high), product(high, high));
    let second = (ll >> 64) + 2 * (lh & WORD);
    let third = (second >> 64) + 2 * (lh >> 64) + (hh & WORD);
    let fourth = (third >> 64) + (hh >> 64);
    [ll as u64, second as u64, third as u64, fourth as u64]
}

/// A number of four words. Its leading words decide: at most two roundings, both far below the last bit of an f32.
fn to_f64(words: [u64; 4]) -> f64 {
    words.iter().rev().fold(0.0, |value, &word| value * TWO_64 + word as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::sampling::stream::{Independent, Stream};

    /// Floats of every exponent below the limit, with all kinds of mantissas.
    fn floats() -> impl Iterator<Item = f32> {
        (0..190_u32 << 8).map(|i| {
            let mantissa = match i & 0xff {
                0 => 0,
                1 => 0x7f_ffff,
                _ => (Independent::new(1, 0, i).pair(0)[0] * f64::from(1 << 23)) as u32,
            };
            f32::from_bits(i >> 8 << 23 | mantissa)
        })
    }

    #[test]
    fn a_float_and_its_square_are_rounded_down_to_the_unit() {
        for v in floats() {
            // Scaling by a power of two is exact in f64, and so is the floor.
            let expected = (f64::from(v) * TWO_64).floor();
            assert_eq!(Fixed::of(v).bits(), expected as u128, "{v:e}");
            assert_eq!(Fixed::of(-0.0 * v), Fixed::default());
            // 48 bits: exact in f64.
            let expected = (f64::from(v) * f64::from(v) * TWO_64).floor();
            let expected = if v >= 4_294_967_296.0 { u128::MAX } else { expected as u128 };
            assert_eq!(Fixed::product_of(v, v).bits(), expected, "{v:e}");
        }
        assert_eq!(Fixed::of(LIMIT.next_down()).bits(), ((1 << 24) - 1) << 103);
    }

    #[test]
    fn sums_saturate_in_any_order() {
        let mut sum = Fixed::of(LIMIT.next_down());
        sum += sum;
        sum += Fixed::of(LIMIT / 2.0);
        assert_eq!(sum, Fixed::MAX);
        sum += Fixed::of(1.0);
        assert_eq!(sum, Fixed::MAX);
    }

    #[test]
    fn the_spread_is_exact_where_floats_cancel() {
        let fixed = |v: f32| Fixed::of(v);
        // Two samples a and b: 2(a² + b²) - (a + b)² = (a - b)².
        for (a, b) in [(1e6_f32, 1e6_f32.next_up()), (0.1, 0.1_f32.next_down()), (3.0e9, 1.0), (2.0, 2.0)] {
            let (mut sum, mut squares) = (fixed(a), Fixed::product_of(a, a));
            sum += fixed(b);
            squares += Fixed::product_of(b, b);
            let difference = f64::from(a) - f64::from(b);
            assert_eq!(spread(2, sum, squares), difference * difference, "{a} {b}");
        }
        assert_eq!(spread(1, Fixed::MAX, Fixed::default()), 0.0);
        // n · MAX needs all words: 2^32 · 2^64, and the square of MAX: 2^128.
        assert_eq!(spread(u32::MAX, Fixed::default(), Fixed::MAX), f64::from(u32::MAX) * TWO_64);
        // A third of 2^64, less what carries: three times that is 2^64 + 2 and a bit.
        let third = Fixed { high: u64::MAX / 3, low: u64::MAX };
        assert_eq!(spread(3, Fixed::default(), third), TWO_64);
        assert_eq!(to_f64(square(Fixed::MAX)) / TWO_64 / TWO_64, TWO_64 * TWO_64);
    }
}
