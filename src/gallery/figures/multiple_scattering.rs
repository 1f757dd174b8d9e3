//! Energy that rough metals lose without multiple scattering, and have with it: `multiple-scattering`.

use crate::gallery::prelude::*;
use crate::study::multiple_scattering::{ALPHAS, AlbedoRow, Spheres, albedos, spheres};
use crate::view::multiple_scattering as view;

/// The error of the albedos: of the model's table, 10⁻³, and half of that for the sum.
const ERROR: f64 = 1.5e-3;

/// One figure with curves and spheres.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "multiple-scattering",
        title: "Energy of rough metals",
        report: Report::Neither,
        reproduces: "a white furnace for rough metals",
        shows: "A model of single scattering loses the light that meets a second facet, more of it the rougher the metal is; \
                with multiple scattering a metal that reflects everything reflects everything, and vanishes before a uniform \
                environment. Gold becomes brighter and more saturated. The spheres are of GGX, shown half a stop darker.",
        matters: "The white furnace is the sharpest test of energy: whatever a model loses or gains becomes visible against the uniform environment.",
        papers: &[papers::KULLA_CONTY, papers::TURQUIN],
        command: Some("etalon render furnace --alpha 1 --multiple-scattering --uniform".into()),
        ..Figure::by(|inputs, _| content(inputs))
    }]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let steps = inputs.effort.of(20, 10);
    let alphas: Vec<f32> = (1..=steps).map(|i| i as f32 / steps as f32).collect();
    let rows = albedos(&alphas, inputs.effort.of(1 << 16, 1 << 15));
    let spheres = spheres(inputs.effort.of(32, 16), inputs.effort.of([320, 80], [160, 40]), &inputs.settings())?;
    let worst = rows.iter().map(|row| (row.multiple - 1.0).abs()).fold(0.0, f64::max);
    let mut checks = vec![Check::at_most("largest error of the albedo with multiple scattering", worst, ERROR)];
    let pairs = rows.windows(2).filter(|pair| pair[0].alpha < pair[1].alpha && pair[0].theta_deg == 0.0);
    let rise = pairs.map(|pair| pair[1].single - pair[0].single).fold(f64::MIN, f64::max);
    checks.push(Check::at_most("largest rise of the albedo of single scattering to the next α, θ = 0°", rise, 5e-4));
    checks.extend(rows.iter().filter_map(known));
    checks.extend(spheres.iter().flat_map(furnace));
    Content::new(view::energy(&rows, &spheres), &rows, checks)
}

/// Albedos of single scattering: distribution, angle in degrees, α and value. The first is a closed form, the others are an
/// independent integration over facets in double precision.
const KNOWN: [(&str, f64, f32, f64); 4] = [
    ("GGX", 0.0, 1.0, 1.0 - std::f64::consts::LN_2),
    ("GGX", 85.0, 0.5, 0.872_024),
    ("Beckmann", 0.0, 0.5, 0.942_998),
    ("Beckmann", 60.0, 1.0, 0.766_568),
];

fn known(row: &AlbedoRow) -> Option<Check> {
    let AlbedoRow { distribution, theta_deg, alpha, single, .. } = *row;
    let is_row = |known: &&(&str, f64, f32, f64)| (known.0, known.1, known.2) == (distribution, theta_deg, alpha);
    let (.., value) = KNOWN.iter().find(is_row)?;
    let name = format!("albedo of single scattering, {distribution}, θ = {theta_deg}°, α = {alpha}");
    Some(Check::within(name, *value, single, 1e-3))
}

/// Spheres that reflect everything have radiance 1, others less; and rougher ones of single scattering are darker.
fn furnace(spheres: &Spheres) -> Vec<Check> {
    let Spheres { metal, multiple, radiance, dropped, .. } = spheres;
    let kind = if *multiple { "multiple" } else { "single" };
    let mut checks = vec![Check::equal(format!("dropped samples, {metal}, {kind} scattering"), 0.0, *dropped as f64)];
    match (*metal, multiple) {
        ("reflects everything", true) => checks.extend(ALPHAS.iter().zip(radiance).map(|(alpha, mean)| {
            let error = mean.error.into_iter().fold(0.0, f64::max);
            let name = format!("radiance of a sphere that reflects everything, α = {alpha}");
            Check::within(name, 1.0, mean.mean_rgb(), 4.0 * error + 2e-3)
        })),
        _ => checks.extend(radiance.windows(2).zip(ALPHAS.windows(2)).map(|(pair, alphas)| {
            let name = format!("radiance of {metal} by {kind} scattering, α = {} over α = {}", alphas[1], alphas[0]);
            Check::at_most(name, pair[1].mean_rgb() / pair[0].mean_rgb(), 1.0)
        })),
    }
    checks
}
