//! Sums of numbers between 0 and 1 that do not depend on the order of addition.

use crate::extremes::Extremes;

/// A sum of numbers from 0 to 1 in units of 2⁻²⁹, so that 2³⁵ of them fit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Share(u64);

const UNIT: f64 = (1u64 << 29) as f64;

impl Share {
    /// One number, to the nearest unit.
    #[inline]
    #[must_use]
    pub fn new(value: f64) -> Self {
        Self((value.within(0.0, 1.0) * UNIT).round() as u64)
    }

    /// The sum.
    #[inline]
    #[must_use]
    pub fn sum(self) -> f64 {
        self.0 as f64 / UNIT
    }

    /// The sum of several sums.
    pub fn total(shares: impl Iterator<Item = Self>) -> f64 {
        Self(shares.map(|share| share.0).sum()).sum()
    }

    /// Adds `other` to this sum.
    #[inline]
    pub fn add(&mut self, other: Self) {
        self.0 += other.0;
    }
}

/// Adds sums to others, one by one.
pub fn add(to: &mut [Share], other: &[Share]) {
    to.iter_mut().zip(other).for_each(|(sum, share)| sum.add(*share));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_the_order() {
        let numbers: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.618_034).fract()).collect();
        let (mut up, mut down) = (Share::default(), Share::default());
        numbers.iter().for_each(|&x| up.add(Share::new(x)));
        numbers.iter().rev().for_each(|&x| down.add(Share::new(x)));
        assert!(up == down && (up.sum() - numbers.iter().sum::<f64>()).abs() < 1e-6);
        assert_eq!((Share::new(2.0).sum(), Share::new(-1.0).sum()), (1.0, 0.0));
    }
}
