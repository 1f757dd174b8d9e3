//! The share of one part of the light in all of it, with its standard error.

/// The share of one part in both, with the standard errors of both.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    /// The share.
    pub value: f64,
    of_part: f64,
    of_rest: f64,
}

impl Share {
    /// A part and the rest, each with its standard error.
    pub fn of([part, of_part]: [f64; 2], [rest, of_rest]: [f64; 2]) -> Self {
        let whole = part + rest;
        Self { value: part / whole, of_part: of_part / whole, of_rest: of_rest / whole }
    }

    /// The standard error of part − bound · whole, over the whole, which decides on which side of the bound the share is.
    ///
    /// Source: Fieller, "Some Problems in Interval Estimation", 1954.
    pub fn error_at(&self, bound: f64) -> f64 {
        ((1.0 - bound) * self.of_part).hypot(bound * self.of_rest)
    }

    /// Its standard error.
    pub fn error(&self) -> f64 {
        self.error_at(self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_of_a_share_counts_each_part_as_much_as_it_weighs() {
        let share = Share::of([1.0, 0.3], [3.0, 2.0]);
        assert_eq!((share.value, share.error_at(0.0)), (0.25, 0.075));
        assert!((share.error() - (0.75f64 * 0.075).hypot(0.25 * 0.5)).abs() < 1e-12);
    }
}
