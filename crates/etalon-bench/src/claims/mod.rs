//! What the two reports claim, each claim compared with what this program measures.
//!
//! A claim has findings: numbers with standard errors, each compared with a bound. The verdict follows from them alone.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod depths;
mod formulas;
mod map;
mod paths;
mod statues;
mod texts;

pub use depths::{Agreement, DepthClaims, PlacePicture, depth_claims};
pub use formulas::{glass_claims, metal_claims};
pub use map::{MapInputs, map_claims};
pub use paths::Place;
pub use statues::{StatueInputs, sampling_claims, statue_claims};

use etalon_stats::Extremes;

/// Standard errors that a number must be away from its bound.
const SIGMAS: f64 = 3.0;

/// The smallest relative difference in brightness that an observer sees, 2 %: Weber's fraction.
///
/// Source: Hood & Finkelstein, "Sensitivity to Light", in *Handbook of Perception and Human Performance*, 1986.
const VISIBLE: f64 = 0.02;

/// What a number must be for the claim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// At least that.
    AtLeast(f64),
    /// At most that.
    AtMost(f64),
}

/// How a number is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unit {
    /// As it is.
    #[default]
    Plain,
    /// A share, in percent.
    Percent,
    /// An angle in degrees.
    Degrees,
}

/// A number that speaks for or against a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is.
    pub what: String,
    /// The number.
    pub value: f64,
    /// The standard error of its distance from the bound; 0 where no chance is involved.
    pub error: f64,
    /// How it is shown.
    pub unit: Unit,
    /// What the claim demands.
    pub bound: Bound,
}

impl Finding {
    /// A number without an error of chance.
    pub fn exact(what: impl Into<String>, value: f64, bound: Bound) -> Self {
        Self::estimated(what, [value, 0.0], bound)
    }

    /// A number and its standard error.
    pub fn estimated(what: impl Into<String>, [value, error]: [f64; 2], bound: Bound) -> Self {
        Self { what: what.into(), value, error, unit: Unit::Plain, bound }
    }

    /// The same in percent.
    #[must_use]
    pub fn in_percent(self) -> Self {
        Self { unit: Unit::Percent, ..self }
    }

    /// The same in degrees.
    #[must_use]
    pub fn in_degrees(self) -> Self {
        Self { unit: Unit::Degrees, ..self }
    }

    /// Whether it meets the demand; `None` if chance may decide.
    pub fn holds(&self) -> Option<bool> {
        let (low, high) = (self.value - SIGMAS * self.error, self.value + SIGMAS * self.error);
        match self.bound {
            Bound::AtLeast(bound) if low >= bound => Some(true),
            Bound::AtMost(bound) if high <= bound => Some(true),
            Bound::AtLeast(bound) if high < bound => Some(false),
            Bound::AtMost(bound) if low > bound => Some(false),
            _ => None,
        }
    }
}

/// What the findings say of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// All findings meet it.
    Holds,
    /// Some do.
    HoldsPartly,
    /// None does.
    DoesNotHold,
    /// There is nothing to measure, or chance may decide.
    NotTestable,
}

impl Verdict {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::HoldsPartly => "holds partly",
            Self::DoesNotHold => "does not hold",
            Self::NotTestable => "not testable",
        }
    }
}

/// What a report says, and where.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Text {
    /// In the report: a figure, a table or the text.
    pub place: &'static str,
    /// What it says.
    pub claim: &'static str,
    /// The number that it prints, if it prints one.
    pub number: &'static str,
    /// Figures that show it.
    pub evidence: &'static [&'static str],
    /// What the numbers mean, or why there are none.
    pub remark: &'static str,
}

impl Text {
    /// The claim with what was measured.
    pub fn with(self, findings: impl Into<Vec<Finding>>) -> Claim {
        Claim { text: self, findings: findings.into(), elsewhere: String::new() }
    }

    /// The first number that it prints.
    pub fn printed(&self) -> f64 {
        self.number.parse().unwrap_or(f64::NAN)
    }
}

/// A claim with its findings.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Claim {
    /// What the report says.
    pub text: Text,
    /// What is measured; without findings the claim cannot be tested.
    pub findings: Vec<Finding>,
    /// What the findings were measured on, where that is not what the report speaks of; empty where it is. Then the
    /// numbers answer no claim.
    pub elsewhere: String,
}

impl Claim {
    /// The claim with its findings measured on `input` in place of the report's map or scene, or on that if `None`.
    #[must_use]
    pub fn measured_on(self, input: Option<&str>) -> Self {
        let has_numbers = !self.findings.is_empty();
        Self { elsewhere: input.filter(|_| has_numbers).unwrap_or_default().to_owned(), ..self }
    }

    /// Whether its findings are about what the report speaks of.
    pub fn is_judged(&self) -> bool {
        self.elsewhere.is_empty()
    }

    /// The verdict, or on what the numbers were measured in place of the report's input.
    pub fn answer(&self) -> String {
        if self.is_judged() { self.verdict().name().to_owned() } else { format!("measured on {}", self.elsewhere) }
    }

    /// What the findings say of the claim.
    pub fn verdict(&self) -> Verdict {
        let decided: Option<Vec<bool>> = self.findings.iter().map(Finding::holds).collect();
        let Some(decided) = decided.filter(|all| !all.is_empty()) else { return Verdict::NotTestable };
        match decided.iter().filter(|holds| **holds).count() {
            0 => Verdict::DoesNotHold,
            n if n == decided.len() => Verdict::Holds,
            _ => Verdict::HoldsPartly,
        }
    }
}

/// A share in percent, for texts.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 {
        return "0 %".into();
    }
    let decimals = (-percent.at_least(1e-9).log10().floor()).within(0.0, 4.0) as usize + usize::from(percent < 10.0);
    format!("{percent:.decimals$} %")
}

/// The share of a part in the sum of that part and the rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Share {
    /// The share.
    pub value: f64,
    /// Covariance of the part and the rest, relative to their sum.
    covariance: [[f64; 2]; 2],
}

impl Share {
    /// A part and the rest, with the covariance of both.
    pub fn of([part, rest]: [f64; 2], covariance: [[f64; 2]; 2]) -> Self {
        let sum = part + rest;
        Self { value: part / sum, covariance: covariance.map(|row| row.map(|c| c / (sum * sum))) }
    }

    /// The standard error of part − bound · sum, over the sum, which decides on which side of the bound the share is.
    ///
    /// Source: Fieller, "Some Problems in Interval Estimation", 1954.
    pub fn error_at(&self, bound: f64) -> f64 {
        let ([a, b], [[part, both], [_, rest]]) = ([1.0 - bound, -bound], self.covariance);
        // Rounding may leave a variance of 0 below it.
        (a * a * part + 2.0 * a * b * both + b * b * rest).at_least(0.0).sqrt()
    }

    /// Its standard error.
    pub fn error(&self) -> f64 {
        self.error_at(self.value)
    }

    /// A finding that it is at least `bound`, or at most.
    pub fn finding(&self, what: impl Into<String>, bound: Bound) -> Finding {
        let (Bound::AtLeast(limit) | Bound::AtMost(limit)) = bound;
        Finding::estimated(what, [self.value, self.error_at(limit)], bound).in_percent()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_from_findings() {
        let finding = |value, error| Finding::estimated("light", [value, error], Bound::AtLeast(0.5));
        let verdict = |findings: &[Finding]| Text::default().with(findings).verdict();
        let (yes, no, unclear) = (finding(0.9, 0.1), finding(0.1, 0.1), finding(0.6, 0.1));
        assert_eq!(verdict(&[yes.clone(), yes.clone()]), Verdict::Holds);
        assert_eq!(verdict(&[yes.clone(), no.clone()]), Verdict::HoldsPartly);
        assert_eq!(verdict(std::slice::from_ref(&no)), Verdict::DoesNotHold);
        assert_eq!(verdict(&[yes, unclear]), Verdict::NotTestable);
        assert_eq!(verdict(&[finding(f64::NAN, 0.0)]), Verdict::NotTestable);
        assert_eq!(verdict(&[]), Verdict::NotTestable);
        let claim = |input| Text::default().with([no.clone()]).measured_on(input);
        assert_eq!(claim(None).answer(), "does not hold");
        assert_eq!(claim(Some("nave")).answer(), "measured on nave");
        assert_eq!(Claim::default().measured_on(Some("nave")).answer(), "not testable");
        let at_most = |value| Finding::exact("error", value, Bound::AtMost(0.0)).holds();
        assert_eq!((at_most(0.0), at_most(1e-9)), (Some(true), Some(false)));
    }

    #[test]
    fn the_bound_of_a_share_counts_each_part_as_much_as_it_weighs() {
        let share = |both: f64| Share::of([1.0, 3.0], [[0.09, both], [both, 4.0]]);
        assert_eq!((share(0.0).value, share(0.0).error_at(0.0)), (0.25, 0.075));
        assert!((share(0.0).error() - (0.75f64 * 0.075).hypot(0.25 * 0.5)).abs() < 1e-12);
        // A part that is always a quarter of the sum has no error.
        let fixed = Share::of([1.0, 3.0], [[1.0, 3.0], [3.0, 9.0]]);
        assert_eq!(fixed.error(), 0.0);
    }
}
