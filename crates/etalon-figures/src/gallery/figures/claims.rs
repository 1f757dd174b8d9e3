//! What the reports claim, and what is measured: `claims-first`, `claims-second`.

use super::{depth, proposal, roughness, sampling, sphere};
use crate::gallery::figure::{self, Report};
use crate::gallery::prelude::*;
use crate::view::claims as view;
use etalon_bench::claims::{self, Claim, MapInputs, StatueInputs};
use etalon_bench::metal::{self, MetalTable};

pub fn figures() -> Vec<Maker> {
    vec![maker("claims-first", first_content), maker("claims-second", second_content)]
}

fn metals(studies: &mut Studies) -> Result<Rc<MetalTable>> {
    studies.get("claims", || metal::table(2))
}

fn first_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let exact = sphere::small(inputs, studies)?;
    let series = sphere::series(inputs, studies)?;
    let tested = proposal::tested(inputs, studies)?;
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
    let content = Content::of_text(&view::rows(claims), vec![check])?;
    let row = |claim: &Claim| figure::Claim {
        report: report.name().to_owned(),
        place: claim.text.place.to_owned(),
        claim: claim.text.claim.to_owned(),
        number: claim.text.number.to_owned(),
        measured: view::measured(claim),
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
