//! Time and noise of the ways of sampling microfacet normals, over the roughness of a metal: `error-time-roughness`.

use super::error_time::{LIMIT, STOPPED, small};
use crate::figure::{Axis, Drawing, Panel, Plot, Stroke, theme};
use crate::gallery::prelude::*;
use crate::view::converge::label;
use etalon_bench::converge::doubling::{Deadline, Times};
use etalon_bench::object_ids::{Kind, ObjectIdBuffer, PixelMean, inside};
use etalon_bench::table::Table;
use etalon_core::bsdf::NormalSampling;
use etalon_core::error::Result;
use etalon_core::raster::Metadata;
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::{Material, Request, Scene};
use etalon_render::{Job, Settings};
use etalon_stats::estimate::Estimate;

/// Roughnesses of a full run and of a quick one.
const ALPHAS: [f32; 6] = [0.02, 0.05, 0.1, 0.25, 0.5, 1.0];
const QUICK_ALPHAS: [f32; 3] = [0.05, 0.25, 1.0];

pub fn figures() -> Vec<Maker> {
    vec![maker("error-time-roughness", |inputs, _| content(inputs))]
}

fn content(inputs: &Inputs) -> Result<Content> {
    let effort = inputs.effort;
    let (scene, request) = small(inputs, inputs.statue("Au", 0.25)?);
    let request = Request { spp: effort.of(32, 8), ..request };
    let alphas = effort.of(&ALPHAS[..], &QUICK_ALPHAS[..]);
    let levels = measure(&scene, &request, alphas, effort.of(4, 2), inputs.seed, &Deadline::after(LIMIT))?;
    let missing = alphas.len() - levels.len() / NORMALS.len();
    let all_measured = Check::equal("roughnesses left out by the time limit", 0.0, missing as f64);
    let mut checks = vec![all_measured.unless((missing > 0).then_some(STOPPED))];
    for three in levels.chunks_exact(NORMALS.len()) {
        if let [visible, all, _] = three {
            checks.extend(visible_against_all(visible, all));
        }
    }
    Ok(Content::of_csv(roughness(&levels), csv(&levels)?, checks))
}

fn visible_against_all(visible: &RoughnessLevel, all: &RoughnessLevel) -> [Check; 2] {
    let alpha = visible.alpha;
    let z = visible.light.z(&all.light);
    let mean = format!("mean of the metal, visible minus all normals (standard errors), α = {alpha}");
    // Light sampling and light tracing find most of the light, too, so that chance may decide which is better: the ends of the
    // intervals are compared.
    let ratio = visible.mse.positive()[0] / all.mse.positive()[1];
    let noise = format!("lower end of the squared error over the upper, visible normals over all normals, α = {alpha}");
    [Check::within(mean, 0.0, z, 4.0), Check::at_most(noise, ratio, 1.0)]
}

/// The ways of sampling normals, by name.
const NORMALS: [(&str, NormalSampling); 3] = [
    ("visible normals", NormalSampling::Vndf),
    ("all normals", NormalSampling::Ndf),
    ("hemisphere", NormalSampling::Hemisphere),
];

/// One way of sampling normals at one roughness, on the pixels that show metal.
#[derive(Debug, Clone, PartialEq)]
struct RoughnessLevel {
    /// Roughness α of the metals.
    alpha: f32,
    /// One of [`NORMALS`].
    normals: &'static str,
    /// Samples per pixel of each replicate.
    spp: u32,
    /// Renders with samples of their own.
    replicates: u32,
    /// Mean over the pixels of the variance of a pixel's mean, channels averaged.
    mse: Estimate,
    /// Time of one replicate.
    cpu_seconds: Estimate,
    /// 1 / (MSE · processor time).
    efficiency: Estimate,
    /// The metal's mean radiance, over all replicates.
    light: PixelMean,
}

/// Renders a scene with its metals at each roughness, sampling normals in every way, each `replicates` times, alternating.
///
/// Random numbers are independent, so that the film's own standard errors are the errors: no reference is needed where there
/// is no bias, and replicates are ranges of samples of one render. Fewer roughnesses if the deadline comes first.
fn measure(
    scene: &Scene,
    request: &Request,
    alphas: &[f32],
    replicates: u32,
    seed: u64,
    deadline: &Deadline,
) -> Result<Vec<RoughnessLevel>> {
    let mask = ObjectIdBuffer::new(scene, request).mask(Kind::Metal);
    let each = request.spp;
    let request = Request { spp: each * replicates, ..*request };
    let mut levels = Vec::new();
    for &alpha in alphas {
        let mut scene = scene.clone();
        for object in &mut scene.objects {
            if let Material::Conductor(metal) = &mut object.material {
                metal.alpha = [alpha; 2];
            }
        }
        let job = |(_, normals): (&str, NormalSampling)| {
            let mut settings = Settings { seed, stream: StreamKind::Independent, ..Settings::default() };
            settings.model.normals = normals;
            Job::new(&scene, &request, &settings)
        };
        // A render for each way of sampling normals; replicates are ranges of its samples.
        let jobs = NORMALS.into_iter().map(job).collect::<Result<Vec<_>>>()?;
        let mut parts = jobs.iter().map(|job| job.part(Metadata::default())).collect::<Result<Vec<_>>>()?;
        let mut measured: Vec<Vec<[f64; 2]>> = vec![Vec::new(); NORMALS.len()];
        for replicate in 0..replicates {
            for ((job, whole), measured) in jobs.iter().zip(&mut parts).zip(&mut measured) {
                let mut part = job.part(Metadata::default())?;
                let mut times = Times::default();
                times.of(|| job.run(&mut part, replicate * each..(replicate + 1) * each, deadline));
                let estimates = inside(part.film.estimates(), &mask);
                let squares: Vec<f64> = estimates.map(|e| e.error.as_dvec3().length_squared() / 3.0).collect();
                // Mean variance of the pixels of metal.
                measured.push([squares.iter().sum::<f64>() / squares.len() as f64, times.cpu]);
                whole.film.merge(&part.film)?;
            }
        }
        if deadline.is_over() {
            break;
        }
        for (((normals, _), part), measured) in NORMALS.iter().zip(&parts).zip(&measured) {
            let all = |which: usize| measured.iter().map(|of_replicate| of_replicate[which]).collect::<Vec<_>>();
            levels.push(RoughnessLevel {
                alpha,
                normals,
                spp: each,
                replicates,
                mse: Estimate::mean(&all(0)),
                cpu_seconds: Estimate::mean(&all(1)),
                efficiency: efficiency(measured),
                light: PixelMean::of(part.film.estimates(), &mask),
            });
        }
    }
    Ok(levels)
}

/// 1/(MSE · time) of the means of both over the replicates, `[MSE, seconds]`.
fn efficiency(replicates: &[[f64; 2]]) -> Estimate {
    Estimate::jackknife(replicates, |some| {
        let mean = |which: usize| some.iter().map(|of| of[which]).sum::<f64>() / some.len() as f64;
        1.0 / (mean(0) * mean(1))
    })
}

/// The levels as CSV; mse is that of the metal's radiance.
fn csv(levels: &[RoughnessLevel]) -> Result<Vec<u8>> {
    Table::of(levels)
        .field("alpha", |level| level.alpha)
        .field("normals", |level| level.normals)
        .field("spp", |level| level.spp)
        .field("replicates", |level| level.replicates)
        .field("mse", |level| level.mse.value)
        .field("mse_half_width", |level| level.mse.half_width)
        .field("cpu_seconds", |level| level.cpu_seconds.value)
        .field("cpu_seconds_half_width", |level| level.cpu_seconds.half_width)
        .field("efficiency_per_second", |level| level.efficiency.value)
        .field("efficiency_half_width", |level| level.efficiency.half_width)
        .csv()
}

/// Noise and efficiency over the roughness, with 95 % intervals, a curve for each way of sampling normals.
fn roughness(levels: &[RoughnessLevel]) -> Drawing {
    let mut alphas: Vec<f64> = levels.iter().map(|l| f64::from(l.alpha)).collect();
    alphas.dedup();
    let alpha = || Axis::log("roughness /{α}").at(alphas.clone());
    let mut noise = Panel::new(alpha(), Axis::log("RMSE of the metal's radiance"));
    let mut efficiency = Panel::new(alpha(), Axis::log("1 / (MSE · processor time) (1/s)"));
    let colours = theme::strategies(&NORMALS.map(|(name, _)| name));
    for (i, (name, _)) in NORMALS.iter().enumerate() {
        let stroke = Stroke { colour: colours[i], ..theme::series(i) };
        let add = |panel: Panel, of: &dyn Fn(&RoughnessLevel) -> [f64; 3]| {
            let mine = || levels.iter().filter(|l| l.normals == *name).map(|l| (f64::from(l.alpha), of(l)));
            // Beside each other: an interval for each point
            let shift = 1.04f64.powi(i as i32 - 1);
            let interval = Stroke::solid(stroke.colour, theme::THIN);
            let line: Vec<_> = mine().map(|(x, [_, value, _])| [shift * x, value]).collect();
            let panel = mine().fold(panel, |panel, (x, [low, _, high])| {
                panel.line("", interval, [[shift * x, low], [shift * x, high]])
            });
            panel.dotted_line(label(name), stroke, line)
        };
        let with_ends = |e: Estimate| [e.positive()[0], e.value, e.positive()[1]];
        noise = add(noise, &|l| with_ends(l.mse).map(f64::sqrt));
        efficiency = add(efficiency, &|l| with_ends(l.efficiency));
    }
    let spp = levels.first().map_or(0, |l| l.spp);
    let titled = [
        noise.title(format!("Noise at {spp} samples per pixel")),
        efficiency.title("Efficiency of the way to sample directions"),
    ];
    let bars = "bars: 95 % intervals; marks of one /{α} stand side by side".to_owned();
    Plot::new(titled.map(Panel::with_names_on_curves)).draw().headed("A golden statue by its roughness", vec![bars])
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::builtin;

    #[test]
    fn efficiency_is_that_of_the_means() {
        // One replicate in four met a firefly: the mean of 1/(MSE · time) would be 0.75025.
        let replicates = [[1.0, 1.0], [1.0, 1.0], [1.0, 1.0], [997.0, 1.0]];
        let found = efficiency(&replicates);
        assert!((found.value - 1.0 / 250.0).abs() < 1e-15, "{found:?}");
        assert!(found.half_width > 0.0 && efficiency(&replicates[..1]).half_width.is_infinite());
    }

    #[test]
    fn all_ways_agree_and_one_is_best() {
        let (scene, request) = builtin::find("cornell-statue-au").unwrap().make(None, None).unwrap();
        let request = Request { width: 32, height: 24, spp: 16, light_samples: 1, ..request };
        let levels = measure(&scene, &request, &[0.05, 0.25, 1.0], 2, 1, &Deadline::after(60.0)).unwrap();
        assert_eq!(levels.len(), 3 * NORMALS.len());
        for three in levels.chunks(3) {
            let [visible, all, hemisphere] = three else { unreachable!() };
            assert!(visible.light.z(&all.light).abs() < 4.5, "{three:?}");
            assert!(visible.alpha < 0.3 || visible.mse.value < all.mse.value, "{three:?}");
            assert!(visible.alpha > 0.3 || visible.mse.value < 0.5 * hemisphere.mse.value, "{three:?}");
        }
    }
}
