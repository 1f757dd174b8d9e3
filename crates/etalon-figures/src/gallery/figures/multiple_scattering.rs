//! The energy that rough metals lose without multiple scattering, and have with it: `multiple-scattering`. Directional albedos of a metal
//! that reflects everything, and spheres in light of radiance 1 from everywhere.

use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use crate::gallery::prelude::*;
use crate::view::depth::grid;
use etalon_bench::object_ids::{ObjectIdBuffer, PixelMean};
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::optics::metals::{self, Metal};
use etalon_core::raster::Image;
use etalon_core::scene::{Conductor, Distribution, Material, Request, ScatterModel, Scene, builtin};
use etalon_render::{Settings, Silent, render};
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;

/// The error of the albedos: of the model's table, 10⁻³, and half of that for the sum.
const ERROR: f64 = 1.5e-3;

pub fn figures() -> Vec<Maker> {
    vec![maker("multiple-scattering", |inputs, _| content(inputs))]
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
    Content::new(energy(&rows, &spheres), &rows, checks)
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

/// The directional albedo of a metal that reflects everything, for one direction.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
struct AlbedoRow {
    /// Distribution of the microfacets' normals.
    distribution: &'static str,
    /// Angle to the normal in degrees.
    theta_deg: f64,
    /// Width of the distribution.
    alpha: f32,
    /// With single scattering alone.
    single: f64,
    /// With multiple scattering.
    multiple: f64,
}

/// The distributions by name.
const DISTRIBUTIONS: [(&str, Distribution); 2] = [("GGX", Distribution::Ggx), ("Beckmann", Distribution::Beckmann)];

/// Directions of the albedos, in degrees from the normal.
const THETAS_DEG: [f64; 3] = [0.0, 60.0, 85.0];

/// The albedos for all distributions and directions over `alphas`, each by n samples.
fn albedos(alphas: &[f32], samples: u32) -> Vec<AlbedoRow> {
    let mut rows = Vec::new();
    for (distribution, kind) in DISTRIBUTIONS {
        let of_alpha = |&alpha: &f32| {
            // Preparing multiple scattering takes longer than sampling it.
            let bsdfs = [false, true].map(|multiple_scattering| {
                let metal = Conductor::new(Rgb::ZERO, Rgb::ONE, alpha, kind);
                Material::Conductor(Conductor { multiple_scattering, ..metal }).bsdf(ScatterModel::default())
            });
            THETAS_DEG.map(|theta_deg: f64| {
                let wo = Vec3::new(theta_deg.to_radians().sin() as f32, 0.0, theta_deg.to_radians().cos() as f32);
                let single = albedo(&bsdfs[0], wo, samples);
                let multiple = single + added(&bsdfs, wo, samples / 16);
                AlbedoRow { distribution, theta_deg, alpha, single, multiple }
            })
        };
        let by_alpha: Vec<_> = alphas.par_iter().map(of_alpha).collect();
        rows.extend((0..THETAS_DEG.len()).flat_map(|i| by_alpha.iter().map(move |rows| rows[i])));
    }
    rows
}

/// ∫ f cos θᵢ dωᵢ: the mean weight of samples.
fn albedo(bsdf: &Bsdf, wo: Vec3, samples: u32) -> f64 {
    let weight = |u| bsdf.sample(wo, 0.0, u).map_or(0.0, |sample| f64::from(sample.weight.x));
    points(samples).map(weight).sum::<f64>() / f64::from(samples)
}

/// The same of the second BSDF minus the first, whose difference is smooth, by directions of pdf cos θᵢ/π.
fn added(bsdfs: &[Bsdf; 2], wo: Vec3, samples: u32) -> f64 {
    let difference = |[u, v]: [f32; 2]| {
        let (sin, cos) = (std::f32::consts::TAU * v).sin_cos();
        let wi = Vec3::new(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt());
        let [first, second] = bsdfs.each_ref().map(|bsdf| f64::from(bsdf.eval(wo, wi).x));
        second - first
    };
    PI * points(samples).map(difference).sum::<f64>() / f64::from(samples)
}

/// Points of the unit square by additive recurrence with 1/g and 1/g², g³ = g + 1.
///
/// Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
fn points(count: u32) -> impl Iterator<Item = [f32; 2]> {
    const G: f64 = 1.324_717_957_244_746;
    // A number that rounds to 1 is the one before.
    let number = |i: u32, step: f64| ((0.5 + f64::from(i) * step).fract() as f32).min(1.0f32.next_down());
    (0..count).map(move |i| [number(i, 1.0 / G), number(i, 1.0 / (G * G))])
}

/// The widths of the rendered spheres, from left to right.
const ALPHAS: [f32; 4] = [0.25, 0.5, 0.75, 1.0];

/// Spheres of one metal in light of radiance 1 from everywhere.
struct Spheres {
    metal: &'static str,
    /// Whether they have multiple scattering.
    multiple: bool,
    radiance: [PixelMean; 4],
    /// Samples that were not finite or negative.
    dropped: u64,
    /// The render.
    image: Image,
}

/// Renders spheres of GGX, of a metal that reflects everything and of gold, each with single and with multiple scattering.
///
/// # Errors
/// Those of the renders.
fn spheres(spp: u32, size: [usize; 2], settings: &Settings) -> Result<Vec<Spheres>> {
    let gold: &Metal = metals::GOLD;
    let indices = [("reflects everything", Rgb::ZERO, Rgb::ONE), ("gold", gold.eta_rgb(), gold.k_rgb())];
    let mut results = Vec::new();
    for (metal, eta, k) in indices {
        for multiple_scattering in [false, true] {
            let (mut scene, request) = builtin::furnace();
            for (object, alpha) in scene.objects.iter_mut().zip(ALPHAS) {
                let conductor = Conductor::new(eta, k, alpha, Distribution::Ggx);
                object.material = Material::Conductor(Conductor { multiple_scattering, ..conductor });
            }
            let (scene, request) = scene.resized(Request { spp, ..request }, size);
            let rendered = render(&scene, &request, settings, &Silent)?;
            let radiance =
                std::array::from_fn(|i| PixelMean::of(rendered.part.film.estimates(), &shows(&scene, &request, i)));
            let dropped = rendered.dropped.total();
            results.push(Spheres { metal, multiple: multiple_scattering, radiance, dropped, image: rendered.image });
        }
    }
    Ok(results)
}

/// Which pixels show the sphere of this number.
fn shows(scene: &Scene, request: &Request, number: usize) -> Vec<bool> {
    let alone = Scene { objects: vec![scene.objects[number].clone()], ..scene.clone() };
    ObjectIdBuffer::new(&alone, request).pixels.iter().map(Option::is_some).collect()
}

/// The curves, and below them the spheres.
fn energy(rows: &[AlbedoRow], spheres: &[Spheres]) -> Drawing {
    let title = |spheres: &Spheres| {
        let kind = if spheres.multiple {
            "single and multiple scattering"
        } else {
            "single scattering, flanks darkened by neighbours"
        };
        format!("{}: {kind}", spheres.metal)
    };
    let cells: Vec<_> = spheres.iter().map(|spheres| (title(spheres), &spheres.image)).collect();
    let alphas = ALPHAS.map(|alpha| alpha.to_string()).join(", ");
    let title = format!("Spheres in light of radiance 1 from everywhere, α = {alphas}");
    // Darker, so that radiance above 1 shows, too.
    Drawing::stacked(vec![curves(rows), grid(&title, 2, -0.5, &cells)], 0.5)
}

fn curves(rows: &[AlbedoRow]) -> Drawing {
    let panel = |(name, _)| {
        let mut panel = Panel::new(
            Axis::linear("width /{α} of the distribution of normals").range(0.0, 1.0),
            Axis::linear("directional albedo").range(0.2, 1.12),
        )
        .title(format!("{name}, a metal that reflects everything"))
        .with_names_on_curves();
        // One line for all angles: they differ by less than its width.
        let multiple = Stroke { colour: theme::INK, dash: theme::DASHED, ..theme::series(0) };
        for (i, theta) in THETAS_DEG.into_iter().enumerate() {
            let of = |f: fn(&AlbedoRow) -> f64| -> Vec<Point> {
                let rows = rows.iter().filter(|row| row.distribution == name && row.theta_deg == theta);
                rows.map(|row| [f64::from(row.alpha), f(row)]).collect()
            };
            let stroke = Stroke { dash: theme::SOLID, ..theme::series(i) };
            panel = panel.line(format!("single scattering, /{{θ}} = {theta}°"), stroke, of(|row| row.single)).line(
                if i == 0 { "with multiple scattering, each /{θ}" } else { "" },
                multiple,
                of(|row| row.multiple),
            );
        }
        panel
    };
    Plot::new(DISTRIBUTIONS.map(panel)).draw()
}
