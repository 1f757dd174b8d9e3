//! Largest and smallest numbers that pass NaN on: a statistic that is not a number must not look like a small one.

/// [`f64::max`], [`f64::min`] and [`f64::clamp`] whose result is NaN if any of the numbers is.
pub trait Extremes {
    /// The larger of both.
    #[must_use]
    fn at_least(self, least: Self) -> Self;

    /// The smaller of both.
    #[must_use]
    fn at_most(self, most: Self) -> Self;

    /// Whether the number is larger than `limit`, or this cannot be said, as one of them is NaN.
    #[must_use]
    fn may_exceed(self, limit: Self) -> bool;

    /// The nearest number from `least` to `most`.
    #[must_use]
    fn within(self, least: Self, most: Self) -> Self;
}

impl Extremes for f64 {
    fn at_least(self, least: Self) -> Self {
        if self > least || self.is_nan() { self } else { least }
    }

    fn at_most(self, most: Self) -> Self {
        if self < most || self.is_nan() { self } else { most }
    }

    fn may_exceed(self, limit: Self) -> bool {
        self > limit || self.is_nan() || limit.is_nan()
    }

    fn within(self, least: Self, most: Self) -> Self {
        self.at_least(least).at_most(most)
    }
}

#[cfg(test)]
mod tests {
    use super::Extremes;

    #[test]
    fn nan_is_passed_on_from_every_place() {
        for nan in [f64::NAN.at_least(1.0), 1f64.at_least(f64::NAN), f64::NAN.at_most(1.0), 1f64.at_most(f64::NAN)] {
            assert!(nan.is_nan());
        }
        for nan in [f64::NAN.within(0.0, 1.0), 0.5.within(f64::NAN, 1.0), 0.5.within(0.0, f64::NAN)] {
            assert!(nan.is_nan());
        }
        assert_eq!([2.0.at_least(1.0), 2.0.at_most(1.0), 2.0.within(0.0, 1.0)], [2.0, 1.0, 1.0]);
        assert!(f64::NAN.may_exceed(1.0) && 1f64.may_exceed(f64::NAN) && 1.0.may_exceed(0.5) && !1.0.may_exceed(1.0));
        assert!([f64::NAN, 1.0].into_iter().fold(0.0, f64::at_least).is_nan());
    }
}
