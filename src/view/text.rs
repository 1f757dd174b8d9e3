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
    if p >= 1e-300 { format!("≈ 10^{{−{:.0}}}", -p.log10()) } else { "< 10^{−300}".into() }
}

/// A p-value, with markup: "/{p} = 0.123", or the power of ten of a small one.
pub fn p_value(p: f64) -> String {
    if p >= 1e-3 { format!("/{{p}} = {p:.3}") } else { format!("/{{p}} {}", power_of_ten(p)) }
}

/// A text with its first letter in upper case.
pub fn capitalized(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_values_are_as_long_as_they_are_worth() {
        assert_eq!([0.9, 1e-17, 0.0].map(p_value), ["/{p} = 0.900", "/{p} ≈ 10^{−17}", "/{p} < 10^{−300}"]);
    }

    #[test]
    fn titles_begin_with_a_capital() {
        assert_eq!(["mirror", "", "/{R}"].map(capitalized), ["Mirror", "", "/{R}"]);
        let views = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/src/view")).unwrap();
        for path in views.map(|entry| entry.unwrap().path()) {
            let text = std::fs::read_to_string(&path).unwrap();
            for call in [".title(\"", ".title(format!(\""] {
                let small = text.split(call).skip(1).find(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase()));
                assert!(small.is_none(), "{}: {:.30}", path.display(), small.unwrap());
            }
        }
    }

    #[test]
    fn one_has_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "check")), ["0 checks", "1 check", "2 checks"]);
    }
}
