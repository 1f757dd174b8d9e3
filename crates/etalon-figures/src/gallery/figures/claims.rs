//! What the reports claim, and what is measured: `claims-first`, `claims-second`, `claims-places`.

use super::{depth, proposal, roughness, sampling, sphere};
use crate::gallery::figure::{self, Report};
use crate::gallery::prelude::*;
use crate::view::claims as view;
use etalon_bench::claims::{self, Agreement, Claim, DepthClaims, MapInputs, StatueInputs};
use etalon_bench::metal::{self, MetalTable};

/// Standard errors by which two ways to measure a number may differ.
const SIGMAS: f64 = 4.0;

pub fn figures() -> Vec<Maker> {
    vec![
        maker("claims-first", first_content),
        maker("claims-second", second_content),
        maker("claims-places", places_content),
    ]
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
    content(Report::First, &claims, vec![undecided(&claims, inputs)])
}

fn of_depths(inputs: &Inputs, studies: &mut Studies) -> Result<Rc<DepthClaims>> {
    let depths = depth::series(inputs, studies)?;
    let (scene, _) = inputs.spheres();
    let paths = inputs.effort.of(1 << 19, 1 << 16);
    studies.get("claims", || claims::depth_claims(&scene, &depths, paths, inputs.seed))
}

/// A table of the second report's claims, each group on a scene of its own, which the table names.
fn second_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let of_depths = of_depths(inputs, studies)?;
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
        (of_depths.claims.clone(), unless("CBspheres.dae", inputs.spheres().0.name)),
        (claims::metal_claims(&metals), None),
        // Nobody has published the report's own dragon
        (claims::statue_claims(&statues), Some(dragon.to_owned())),
        (claims::sampling_claims(&sampling), unless("CBbunny_microfacet_cu.dae", inputs.copper()?.0.name)),
    ];
    let on = |(claims, elsewhere): (Vec<Claim>, Option<String>)| {
        claims.into_iter().map(move |claim| claim.measured_on(elsewhere.as_deref()))
    };
    let claims: Vec<Claim> = groups.into_iter().flat_map(on).collect();
    let agree = of_depths.agreement.iter().map(|Agreement { name, z }| agrees(name, Some(*z)));
    // Without a rectangle that emits light
    let untested = of_depths.agreement.is_empty().then(|| agrees("light", None));
    content(Report::Second, &claims, [undecided(&claims, inputs)].into_iter().chain(agree).chain(untested).collect())
}

fn places_content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let (of_depths, depths) = (of_depths(inputs, studies)?, depth::series(inputs, studies)?);
    let drawing = view::places(&of_depths.pictures, &depths);
    let name = |title: &str| format!("light in the frame, {title}");
    let seen = of_depths.pictures.iter().map(|picture| agrees(&name(picture.title), Some(picture.z)));
    let unseen = of_depths.unseen.iter().map(|title| agrees(&name(title), None));
    Content::new(drawing, &view::place_rows(&of_depths.pictures), seen.chain(unseen).collect())
}

fn content(report: Report, claims: &[Claim], checks: Vec<Check>) -> Result<Content> {
    let content = Content::of_text(&view::rows(claims), checks)?;
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

/// Light that paths measure agrees with the renderer's; skipped where no path found any.
fn agrees(name: &str, z: Option<f64>) -> Check {
    let name = format!("{name}, path by path minus the renderer (standard errors)");
    Check::within(name, 0.0, z.unwrap_or(f64::NAN), SIGMAS)
        .unless(z.is_none().then_some("no light of this class was found"))
}
