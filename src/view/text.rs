//! Numbers in sentences.

/// A count with its noun: "1 test", "2 tests".
#[must_use]
pub fn counted(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_has_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "check")), ["0 checks", "1 check", "2 checks"]);
    }
}
