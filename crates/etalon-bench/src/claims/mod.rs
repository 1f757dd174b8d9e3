//! What the two reports claim, each claim compared with what this program measures.
//!
//! A claim has findings: numbers with standard errors, each compared with a bound. The verdict follows from them alone.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod depths;
mod formulas;
mod map;
mod seen;
mod statues;
mod texts;

pub use depths::depth_claims;
pub use formulas::{glass_claims, metal_claims};
pub use map::{MapInputs, map_claims};
pub use statues::{StatueInputs, sampling_claims, statue_claims};

use crate::depth::VISIBLE;
use etalon_stats::Extremes;

/// Standard errors that a number must be away from its bound.
const SIGMAS: f64 = 3.0;

/// What a number must be for the claim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    AtLeast(f64),
    AtMost(f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unit {
    /// As it is.
    #[default]
    Plain,
    Percent,
    Degrees,
}

/// A number that speaks for or against a claim.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    pub what: String,
    /// The number.
    pub value: f64,
    /// The standard error of its distance from the bound; 0 where no chance is involved.
    pub error: f64,
    pub unit: Unit,
    pub bound: Bound,
}

impl Finding {
    /// A number without an error of chance.
    pub fn exact(what: impl Into<String>, value: f64, bound: Bound) -> Self {
        Self::estimated(what, [value, 0.0], bound)
    }

    pub fn estimated(what: impl Into<String>, [value, error]: [f64; 2], bound: Bound) -> Self {
        Self { what: what.into(), value, error, unit: Unit::Plain, bound }
    }

    #[must_use]
    pub fn in_percent(self) -> Self {
        Self { unit: Unit::Percent, ..self }
    }

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
    pub claim: &'static str,
    /// The number that it prints, if it prints one.
    pub number: &'static str,
    pub evidence: &'static [&'static str],
    /// What the numbers mean, or why there are none.
    pub remark: &'static str,
}

impl Text {
    pub fn with(self, findings: impl Into<Vec<Finding>>) -> Claim {
        Claim { text: self, findings: findings.into(), elsewhere: String::new() }
    }

    /// The first number that it prints.
    pub fn printed(&self) -> f64 {
        self.number.parse().unwrap_or(f64::NAN)
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Claim {
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

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 {
        return "0 %".into();
    }
    let decimals = (-percent.at_least(1e-9).log10().floor()).within(0.0, 4.0) as usize + usize::from(percent < 10.0);
    format!("{percent:.decimals$} %")
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
}
