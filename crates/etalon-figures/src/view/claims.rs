//! The reports' claims as rows of tables.

use super::text::superscript;
use etalon_bench::claims::{self, Bound, Claim, Finding, Unit};
use serde::Serialize;

/// One finding of one claim. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ClaimRow {
    place: &'static str,
    claim: &'static str,
    report: &'static str,
    verdict: String,
    finding: String,
    value: f64,
    standard_error: f64,
    must_be: &'static str,
    bound: f64,
    holds: Option<bool>,
    evidence: String,
}

/// A row for each finding, and one for each claim without any.
pub fn rows(claims: &[Claim]) -> Vec<ClaimRow> {
    let of_claim = |claim: &Claim| {
        let claims::Text { place, claim: text, number: report, evidence, remark } = claim.text;
        let (verdict, evidence, finding) = (claim.answer(), evidence.join(" "), remark.to_owned());
        let row =
            ClaimRow { place, claim: text, report, verdict, evidence, finding, value: f64::NAN, ..ClaimRow::default() };
        let of_finding = |finding: &Finding| {
            let (must_be, bound) = match finding.bound {
                Bound::AtLeast(bound) => ("at least", bound),
                Bound::AtMost(bound) => ("at most", bound),
            };
            let holds = finding.holds().filter(|_| claim.is_judged());
            let (value, standard_error) = (finding.value, finding.error);
            ClaimRow { finding: finding.what.clone(), value, standard_error, must_be, bound, holds, ..row.clone() }
        };
        if claim.findings.is_empty() { vec![row] } else { claim.findings.iter().map(of_finding).collect() }
    };
    claims.iter().flat_map(of_claim).collect()
}

/// What was measured for a claim, and the remark if there is one.
pub fn measured(claim: &Claim) -> Vec<String> {
    let remark = Some(claim.text.remark.to_owned()).filter(|remark| !remark.is_empty());
    claim.findings.iter().map(sentence).chain(remark).collect()
}

/// "share of LDSE in the light … on the mirror: 30.6 % ± 0.1 % (≥ 2 %)"; without the error where it is 0.
fn sentence(finding: &Finding) -> String {
    let Finding { what, value, error, unit, bound } = finding;
    let bound = match bound {
        Bound::AtLeast(bound) => format!("≥\u{a0}{}", number(*bound, *unit, 3)),
        Bound::AtMost(bound) => format!("≤\u{a0}{}", number(*bound, *unit, 3)),
    };
    let error = if *error > 0.0 { format!("\u{a0}±\u{a0}{}", number(*error, *unit, 1)) } else { String::new() };
    format!("{what}: {}{error} ({bound})", number(*value, *unit, 3))
}

/// A number with n significant digits.
fn number(value: f64, unit: Unit, digits: i32) -> String {
    let (value, sign) = match unit {
        Unit::Percent => (100.0 * value, "\u{a0}%"),
        Unit::Degrees => (value, "°"),
        Unit::Plain => (value, ""),
    };
    if value == 0.0 || !value.is_finite() || value.fract() == 0.0 && value.abs() < 1e6 {
        return format!("{value}{sign}").replace('-', "−");
    }
    let power = value.abs().log10().floor() as i32;
    let text = if power < -4 {
        let factor = format!("{:.0}·", value / 10f64.powi(power));
        format!("{}10{}", if factor == "1·" { "" } else { &factor }, superscript(power))
    } else {
        let text = format!("{value:.*}", (digits - 1 - power).max(0) as usize);
        // A round number is as short as it can be.
        let round = text.contains('.') && (text.parse() == Ok(value) || text.ends_with("00"));
        if round { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    format!("{text}{sign}").replace('-', "−")
}
