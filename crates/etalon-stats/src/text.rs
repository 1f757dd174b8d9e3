//! Points and counts in messages.

use std::fmt::{Debug, Display};

/// A point or a list of random numbers as `(x, y, z)`; a single number as it is.
pub fn tuple(point: &impl Debug) -> String {
    format!("{point:?}").replace('[', "(").replace(']', ")")
}

/// A number with its noun, the singular for 1: `1 sample`, `2 samples`.
pub fn count<N: Display + PartialEq + From<u8>>(n: N, one: &str, many: &str) -> String {
    let noun = if n == N::from(1) { one } else { many };
    format!("{n} {noun}")
}

/// A p-value as `p = 5.46e-63`, or `p < 1e-300` where it is smaller.
pub fn p_value(p: f64) -> String {
    if p < 1e-300 { "p < 1e-300".to_owned() } else { format!("p = {p:.2e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_p_values_have_a_bound() {
        assert_eq!((p_value(5.461e-63), p_value(0.0)), ("p = 5.46e-63".to_owned(), "p < 1e-300".to_owned()));
    }

    #[test]
    fn points_are_tuples_and_nouns_agree() {
        assert_eq!((tuple(&[0.5, 1e-30, 1.0]), tuple(&0.25)), ("(0.5, 1e-30, 1.0)".to_owned(), "0.25".to_owned()));
        assert_eq!((count(1, "test", "tests"), count(2_u64, "test", "tests")), ("1 test".into(), "2 tests".into()));
    }
}
