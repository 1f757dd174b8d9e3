//! What the reports claim, and what is measured: `claims-first`, `claims-second`.

use super::{depth, envmap, roughness, sampling, sphere};
use crate::gallery::figure::{self, Report};
use crate::gallery::prelude::*;
use crate::view::text::superscript;
use etalon_bench::claims::{self, Bound, Claim, Finding, MapInputs, StatueInputs, Unit};
use etalon_bench::metal::{self, MetalTable};
use serde::Serialize;

pub fn figures() -> Vec<Maker> {
    vec![maker("claims-first", first_content), maker("claims-second", second_content)]
}

fn metals(studies: &mut Studies) -> Result<Rc<MetalTable>> {
    studies.get("claims", || metal::table(2))
}

fn first_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let exact = sphere::small(inputs, studies)?;
    let series = sphere::series(inputs, studies)?;
    let tested = envmap::proposal(inputs, studies)?;
    let map = &inputs.map.map;
    let mut claims = claims::glass_claims(&*metals(studies)?);
    let renders =
        series.last().ok_or_else(|| etalon_core::error::Error::parameter("figure", "no strategy was rendered"))?;
    let of_map = MapInputs { map, exact: &exact, renders, proposal: tested.as_ref().as_ref() };
    let other_map = inputs.other_map().map(|_| inputs.map.file_name());
    claims.extend(claims::map_claims(&of_map)?.into_iter().map(|claim| claim.measured_on(other_map)));
    content(Report::First, &claims, undecided(&claims, inputs))
}

/// A table of the second report's claims, each group on a scene of its own, which the table names.
fn second_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let ((spheres, _), depths) = (inputs.spheres(), depth::by_class(inputs, studies)?);
    let statues: Vec<_> = roughness::ALPHAS
        .iter()
        .map(|&alpha| roughness::statue(inputs, studies, "Au", alpha))
        .collect::<Result<_>>()?;
    let statues: Vec<_> = statues.iter().map(Rc::as_ref).collect();
    let (scene, request) = inputs.statue("Au", roughness::ALPHAS[0])?;
    let (sampling, metals) = (sampling::both(inputs, studies)?, metals(studies)?);
    let statues = StatueInputs { scene: &scene, request: &request, statues: &statues };
    // Each group of claims, and the scene that it is measured on in place of the report's
    let unless = |name: &str, scene: String| (!inputs.is_original(name)).then_some(scene);
    let dragon = if inputs.originals.is_some() { "another dragon" } else { &scene.name };
    let groups = [
        (claims::depth_claims(&spheres, &depths), unless("CBspheres.dae", spheres.name)),
        (claims::metal_claims(&metals), None),
        // Nobody has published the report's own dragon
        (claims::statue_claims(&statues), Some(dragon.to_owned())),
        (claims::sampling_claims(&sampling), unless("CBbunny_microfacet_cu.dae", inputs.copper()?.0.name)),
    ];
    let on = |(claims, elsewhere): (Vec<Claim>, Option<String>)| {
        claims.into_iter().map(move |claim| claim.measured_on(elsewhere.as_deref()))
    };
    let claims: Vec<Claim> = groups.into_iter().flat_map(on).collect();
    content(Report::Second, &claims, undecided(&claims, inputs))
}

fn content(report: Report, claims: &[Claim], check: Check) -> Result<Content> {
    let content = Content::of_text(&rows(claims), vec![check])?;
    let row = |claim: &Claim| figure::Claim {
        report: report.name().to_owned(),
        place: claim.text.place.to_owned(),
        claim: claim.text.claim.to_owned(),
        number: claim.text.number.to_owned(),
        measured: measured(claim),
        verdict: claim.answer(),
        evidence: claim.text.evidence.iter().map(|id| (*id).to_owned()).collect(),
    };
    Ok(Content { claims: claims.iter().map(row).collect(), ..content })
}

/// Numbers of which chance may decide on which side of their bound they are. A quick run has too few samples for some.
fn undecided(claims: &[Claim], inputs: &Inputs) -> Check {
    let findings = || claims.iter().filter(|claim| claim.is_judged()).flat_map(|claim| &claim.findings);
    let share = findings().filter(|finding| finding.holds().is_none()).count() as f64 / findings().count() as f64;
    let name = "share of the numbers within 3 standard errors of what the claim demands";
    Check::at_most(name, share, inputs.effort.of(0.0, 0.1))
}

/// One finding of one claim. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
struct ClaimRow {
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
fn rows(claims: &[Claim]) -> Vec<ClaimRow> {
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
fn measured(claim: &Claim) -> Vec<String> {
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
