//! Time and noise of the ways of sampling microfacet normals, over the roughness of a metal.

use super::doubling::{Deadline, Times};
use crate::bsdf::NormalSampling;
use crate::error::Result;
use crate::raster::Metadata;
use crate::render::{Job, Settings};
use crate::sampling::stream::StreamKind;
use crate::scene::{Material, Request, Scene};
use crate::study::object_ids::{Kind, ObjectIdBuffer};
use crate::study::pixel_mean::{Mean, inside};
use etalon_stats::estimate::Estimate;

/// The ways of sampling normals, by name.
pub const NORMALS: [(&str, NormalSampling); 3] = [
    ("visible normals", NormalSampling::Vndf),
    ("all normals", NormalSampling::Ndf),
    ("hemisphere", NormalSampling::Hemisphere),
];

/// One way of sampling normals at one roughness, on the pixels that show metal.
#[derive(Debug, Clone, PartialEq)]
pub struct RoughnessLevel {
    /// Roughness α of the metals.
    pub alpha: f32,
    /// One of [`NORMALS`].
    pub normals: &'static str,
    /// Samples per pixel of each replicate.
    pub spp: u32,
    /// Renders with samples of their own.
    pub replicates: u32,
    /// Mean over the pixels of the variance of a pixel's mean, channels averaged.
    pub mse: Estimate,
    /// Of one replicate.
    pub cpu_seconds: Estimate,
    /// 1 / (MSE · processor time).
    pub efficiency: Estimate,
    /// The metal's mean radiance, over all replicates.
    pub light: Mean,
}

/// Renders a scene with its metals at each roughness, sampling normals in every way, each `replicates` times, alternating.
///
/// Random numbers are independent, so that the film's own standard errors are the errors: no reference is needed where there
/// is no bias, and replicates are ranges of samples of one render. Fewer roughnesses if the deadline comes first.
pub fn measure(
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
                light: Mean::of(&part.film, &mask),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

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
