//! A check: a number of a figure compared with what it must be.

use serde::{Deserialize, Deserializer, Serialize};

/// How a number is compared with what is expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Kind {
    #[default]
    #[serde(rename = "equal")]
    Equal,
    /// |got − expected| ≤ tolerance.
    #[serde(rename = "within")]
    Within,
    /// got ≤ limit.
    #[serde(rename = "at most")]
    AtMost,
    /// got ≥ limit.
    #[serde(rename = "at least")]
    AtLeast,
    /// A statement: 1 where it is true, 0 where it is not.
    #[serde(rename = "true")]
    True,
}

/// A comparison with its outcome. NaN passes no check. A check that the input of a run does not allow is skipped: its number is
/// NaN. Field names are JSON keys and CSV columns.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[must_use]
pub struct Check {
    /// What is compared, with its unit.
    pub name: String,
    pub kind: Kind,
    /// The expected value, or the limit of `Kind::AtMost` and `Kind::AtLeast`.
    #[serde(deserialize_with = "number_or_nan")]
    pub expected: f64,
    #[serde(deserialize_with = "number_or_nan")]
    pub got: f64,
    pub tolerance: Option<f64>,
    /// `None` if it is skipped.
    pub pass: Option<bool>,
    /// Why it is skipped; empty if it is not.
    #[serde(default)]
    pub skipped: String,
}

/// JSON writes NaN and infinities as null.
pub(super) fn number_or_nan<'de, D: Deserializer<'de>>(source: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(source)?.unwrap_or(f64::NAN))
}

impl Check {
    fn new(name: impl Into<String>, kind: Kind, expected: f64, got: f64, pass: bool) -> Self {
        Self { name: name.into(), kind, expected, got, tolerance: None, pass: Some(pass), skipped: String::new() }
    }

    pub fn equal(name: impl Into<String>, expected: f64, got: f64) -> Self {
        Self::new(name, Kind::Equal, expected, got, got == expected)
    }

    pub fn within(name: impl Into<String>, expected: f64, got: f64, tolerance: f64) -> Self {
        let pass = (got - expected).abs() <= tolerance;
        Self { tolerance: Some(tolerance), ..Self::new(name, Kind::Within, expected, got, pass) }
    }

    pub fn at_most(name: impl Into<String>, got: f64, limit: f64) -> Self {
        Self::new(name, Kind::AtMost, limit, got, got <= limit)
    }

    pub fn at_least(name: impl Into<String>, got: f64, limit: f64) -> Self {
        Self::new(name, Kind::AtLeast, limit, got, got >= limit)
    }

    pub fn is_true(name: impl Into<String>, holds: bool) -> Self {
        Self::new(name, Kind::True, 1.0, f64::from(u8::from(holds)), holds)
    }

    /// The check, skipped if the input of the run does not allow it, which `why` says.
    pub fn unless(self, why: Option<impl Into<String>>) -> Self {
        match why {
            Some(why) => Self { got: f64::NAN, pass: None, skipped: why.into(), ..self },
            None => self,
        }
    }

    pub fn failed(&self) -> bool {
        self.pass == Some(false)
    }

    /// What the check demands: "0.500 ± 0.012", "≤ 0.05", "= 0".
    pub fn demand(&self) -> String {
        let expected = significant(self.expected);
        match self.kind {
            Kind::Equal => format!("= {expected}"),
            Kind::Within => format!("{} ± {}", self.rounded(self.expected), significant(self.tolerance.unwrap_or(0.0))),
            Kind::AtMost => format!("≤ {expected}"),
            Kind::AtLeast => format!("≥ {expected}"),
            Kind::True => "true".into(),
        }
    }

    /// What the figure has, with as many digits as the demand gives a meaning.
    pub fn measured(&self) -> String {
        if self.pass.is_none() {
            return "not measured".into();
        }
        match self.kind {
            Kind::Within => self.rounded(self.got),
            Kind::True => (self.got == 1.0).to_string(),
            Kind::Equal | Kind::AtMost | Kind::AtLeast => significant(self.got),
        }
    }

    /// `value` up to the second significant digit of the tolerance.
    fn rounded(&self, value: f64) -> String {
        let place = self.tolerance.unwrap_or(0.0).log10().floor();
        if !(-16.0..=0.0).contains(&place) {
            return significant(value);
        }
        let decimals = (1.0 - place) as usize;
        let text = format!("{value:.decimals$}");
        // A negative number that rounds to zero has no sign.
        let sign = text.bytes().any(|b| (b'1'..=b'9').contains(&b));
        if sign { text } else { text.trim_start_matches('-').to_owned() }
    }
}

/// The reasons for which checks are skipped, each with their number, in the order in which they first occur.
pub fn skipped<'a>(checks: impl Iterator<Item = &'a Check>) -> Vec<(usize, &'a str)> {
    let mut reasons: Vec<(usize, &str)> = Vec::new();
    for check in checks.filter(|check| check.pass.is_none()) {
        match reasons.iter_mut().find(|(_, why)| *why == check.skipped) {
            Some((count, _)) => *count += 1,
            None => reasons.push((1, &check.skipped)),
        }
    }
    reasons
}

/// Whole numbers in full, others with three significant digits.
fn significant(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() || (value.fract() == 0.0 && size < 1e6) {
        return value.to_string();
    }
    if !(1e-3..1e6).contains(&size) {
        let text = format!("{value:.2e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", without_zeros(mantissa));
    }
    let decimals = (2.0 - size.log10().floor()).max(0.0) as usize;
    without_zeros(&format!("{value:.decimals$}")).to_owned()
}

/// A number without the zeros at the end of its decimals.
fn without_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_fails_every_kind() {
        let checks = |x: f64| {
            [
                Check::equal("a", 1.0, x),
                Check::within("a", 1.0, x, 0.1),
                Check::at_most("a", x, 1.0),
                Check::at_least("a", x, 1.0),
            ]
        };
        assert!(checks(1.0).iter().all(|check| check.pass == Some(true)));
        assert!(checks(f64::NAN).iter().all(Check::failed));
        assert!(Check::within("a", 1.0, 1.2, 0.1).failed() && Check::equal("a", 1.0, 1.0 + 1e-15).failed());
        assert!(Check::at_most("a", 1.1, 1.0).failed() && Check::at_least("a", 0.9, 1.0).failed());
        assert!(Check::within("a", 1.0, 1.0, f64::NAN).failed());
        assert!(!Check::is_true("a", true).failed() && Check::is_true("a", false).failed());
    }

    #[test]
    fn a_skipped_check_neither_passes_nor_fails() {
        let [here, other] = [None, Some("the map is another")].map(|why| Check::at_most("a", 2.0, 1.0).unless(why));
        assert!(here.failed() && !other.failed() && other.pass.is_none() && other.got.is_nan());
        assert_eq!((other.measured().as_str(), other.demand().as_str()), ("not measured", "≤ 1"));
        let third = Check::is_true("b", true).unless(Some("no light"));
        assert_eq!(skipped([&other, &here, &third, &other].into_iter()), [(2, "the map is another"), (1, "no light")]);
    }

    #[test]
    fn digits_follow_the_tolerance() {
        let shown = |check: Check| (check.measured(), check.demand());
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert_eq!(shown(Check::within("a", -0.5, -0.498_679, 0.0075)), pair("-0.4987", "-0.5000 ± 0.0075"));
        assert_eq!(shown(Check::within("a", 0.0, 0.185_133, 4.0)), pair("0.2", "0.0 ± 4"));
        assert_eq!(shown(Check::within("a", 55.407_711_312_490_06, 55.407_711_312_490_06, 1e-11)).0, "55.407711312490");
        assert_eq!(shown(Check::at_most("a", 5.572_76e-16, 1e-9)), pair("5.57e-16", "≤ 1e-9"));
        assert_eq!(shown(Check::at_least("a", f64::NAN, 3.0)), pair("NaN", "≥ 3"));
        assert_eq!(shown(Check::within("a", 0.0, -2.7e-6, 2e-3)), pair("0.0000", "0.0000 ± 0.002"));
        assert_eq!(shown(Check::equal("a", 0.0, 2.0)), pair("2", "= 0"));
        assert_eq!(shown(Check::is_true("a", false)), pair("false", "true"));
    }

    #[test]
    fn checks_survive_json() {
        for check in [Check::within("a", 1.0, 1.05, 0.1), Check::at_most("b", 0.5, 1.0), Check::is_true("c", true)] {
            assert!(!serde_json::to_string(&check).unwrap().contains("\"pass\":null"));
            let text = serde_json::to_string(&check).unwrap();
            assert_eq!(serde_json::from_str::<Check>(&text).unwrap(), check);
        }
        let text = serde_json::to_string(&Check::at_most("a", f64::NAN, 1.0)).unwrap();
        assert!(text.contains("\"kind\":\"at most\"") && text.contains("\"got\":null"), "{text}");
        assert!(serde_json::from_str::<Check>(&text).unwrap().got.is_nan());
        let text = serde_json::to_string(&Check::at_most("a", 0.5, 1.0).unless(Some("why"))).unwrap();
        assert!(text.contains("\"pass\":null,\"skipped\":\"why\""), "{text}");
        // Records of earlier versions know no skipped checks.
        let text = text.replace(",\"skipped\":\"why\"", "").replace("null}", "true}");
        assert_eq!(serde_json::from_str::<Check>(&text).unwrap().pass, Some(true));
    }
}
