//! Error of the sphere by sampling strategy: `sphere-error`.

use super::sphere::ExactImage;
use crate::gallery::map::MapInfo;
use crate::gallery::prelude::*;
use crate::study::sphere::{self, AtNormal, Series};
use crate::view::sphere as view;

/// Samples per pixel of the report's renders.
const SPP: [u32; 4] = [8, 16, 32, 64];

/// One figure.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "sphere-error",
        title: "Error of the sphere against samples and time",
        report: Report::First,
        reproduces: "Figures 12 to 15, measured",
        shows: "Error of four strategies that choose directions towards the light, over samples per pixel and over time.",
        beside: None,
        command: None,
        make: Box::new(content),
    }]
}

fn content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    // A quarter of the pixels is enough to measure errors.
    let exact = studies.get(ExactImage(inputs.effort.of(255, 127)), inputs)?;
    let series = sphere::compare(&inputs.map, &SPP, &exact, &inputs.settings())?;
    let grace = studies.get(MapInfo, inputs)?.is_grace();
    let mut checks: Vec<Check> = series.iter().map(slope).collect();
    if grace {
        checks.extend(sphere::against_pbrt(&inputs.map.map).iter().flat_map(radiance));
    }
    Content::new(view::errors(&series, grace), &view::rows(&series), checks)
}

/// Independent random numbers have a slope of −1/2; scrambled Sobol' points must not be worse.
fn slope(series: &Series) -> Check {
    let name = format!("slope of the error (−1/2 + 3 standard errors), {}", series.label.strategy);
    Check::at_most(name, series.slope.value, -0.5 + 3.0 * series.slope.standard_error)
}

fn radiance(at: &AtNormal) -> [Check; 3] {
    let [x, y, z] = at.normal;
    [(0, "R"), (1, "G"), (2, "B")].map(|(c, channel)| {
        let name = format!("radiance at n = ({x:.3} {y:.3} {z:.3}) as PBRT renders it, {channel}");
        Check::within(name, at.pbrt[c], at.exact[c], 0.01 * at.pbrt[c])
    })
}
