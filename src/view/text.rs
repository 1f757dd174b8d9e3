//! Numbers as text.

/// A count with its noun: "1 test", "2 tests".
pub fn counted(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// A time with as many digits as are worth reading.
pub fn seconds(seconds: f64) -> String {
    if seconds < 10.0 { format!("{seconds:.2}\u{a0}s") } else { format!("{seconds:.0}\u{a0}s") }
}

/// A small p-value, with markup: "≈ 10^{−17}", or "< 10^{−300}" for what f64 cannot hold.
pub fn power_of_ten(p: f64) -> String {
    if p > 0.0 { format!("≈ 10^{{−{:.0}}}", -p.log10()) } else { "< 10^{−300}".into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_has_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "check")), ["0 checks", "1 check", "2 checks"]);
    }
}
