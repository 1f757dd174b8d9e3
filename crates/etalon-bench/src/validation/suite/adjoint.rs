//! Test cases: camera paths and light paths through one vertex transport the same light.
//!
//! For radiance L from one side and a sensitivity W to the other, ∫∫ W(v) f(v, l) L(l) |v·n| |l·ns| dl dv is estimated
//! from the camera's side (v uniform by projected solid angle, l sampled by the BSDF) and from the light's (l uniform by
//! projected solid angle, v sampled by the adjoint BSDF, times the factor of shading normals). The means must be equal.

use super::super::case::Case;
use super::{boundary, bsdf, metal, short};
use etalon_core::bsdf::{Bsdf, BsdfSample, Scatter, families};
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_core::sampling::stream::{Independent, Stream};
use etalon_core::sampling::warp;
use etalon_render::probe::{Surface, adjoint_factor, is_sound};
use etalon_stats::welch::{self, ImageComparison, Mean};
use etalon_stats::{Outcome, SampleCount};
use glam::Vec3;
use std::f32::consts::PI;
use std::time::Instant;

/// An estimator: of random numbers, pair by pair.
pub type Estimator = Box<dyn Fn([[f64; 2]; 3]) -> f64 + Send + Sync>;

#[derive(Clone, Copy)]
pub struct LightPaths {
    /// Samples the direction in which a light path continues.
    pub sample: fn(&Bsdf, Vec3, f32, [f32; 2]) -> Option<BsdfSample>,
    /// The factor of shading normals.
    pub factor: fn(&Surface, Vec3, Vec3) -> f32,
}

/// As the kernel does it.
pub const KERNEL: LightPaths = LightPaths { sample: Bsdf::sample_adjoint, factor: adjoint_factor };

/// Glass, seen from outside.
pub fn glass() -> Bsdf {
    bsdf("dielectric", &[1.5])
}

pub fn cases() -> Vec<Case> {
    let mut bsdfs = vec![
        ("diffuse", bsdf("diffuse", &[0.5])),
        ("beckmann", metal("beckmann", [0.3; 2])),
        ("ggx", metal("ggx", [0.3; 2])),
        ("glass", glass()),
        ("rough-glass", boundary("ggx", [0.3; 2], 1.5)),
        ("coated-diffuse", bsdf("coated-diffuse", &[0.5, 1.5])),
    ];
    // Every other BSDF of the list that light paths may use.
    for family in families() {
        let bsdf = family.with(&family.defaults());
        if bsdf.is_reciprocal() && bsdfs.iter().all(|(_, other)| other.name() != bsdf.name()) {
            bsdfs.push((family.name, bsdf));
        }
    }
    let case = |(name, bsdf): (&str, Bsdf)| {
        [("flat", 0.0), ("smooth", 25.0)].map(|(normals, degrees)| {
            adjoint(format!("light-path/adjoint/{name}/{normals}"), bsdf.clone(), degrees, KERNEL)
        })
    };
    bsdfs.into_iter().flat_map(case).collect()
}

/// Both estimators at a surface whose shading normal is that many degrees from its normal.
pub fn adjoint(name: String, bsdf: Bsdf, degrees: f32, light_paths: LightPaths) -> Case {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let surface = Surface { position: Vec3::ZERO, normal: Vec3::Z, shading: Vec3::new(sin, 0.0, cos), offset: 0.0 };
    // Light comes from outside; the sensitivities of the sides differ.
    let radiance = |l: Vec3| if l.z > 0.0 { 1.0 + l.x } else { 0.0 };
    let sensitivity = |v: Vec3| if v.z > 0.0 { 1.0 + v.y } else { 3.0 + v.x };
    // Starts a path by projected solid angle on either side, continues it, and returns both directions with the weight.
    let path = move |[place, choice, u]: [[f64; 2]; 3],
                     sample: fn(&Bsdf, Vec3, f32, [f32; 2]) -> Option<BsdfSample>| {
        let up = warp::cosine_hemisphere(place).as_vec3();
        let wo = if choice[1] < 0.5 { up } else { -up };
        let frame = surface.frame(wo);
        let sample = sample(&bsdf, frame.to_local(wo), short(choice[0]), u.map(short))?;
        let wi = frame.to_world(sample.wi);
        let normals = [surface.normal, surface.shading];
        // The kernel's rules: the normals agree on the side, and about the cosine.
        let agree = surface.normal.dot(wi) * frame.z.dot(wi) > 0.0;
        (agree && is_sound(normals, wo) && is_sound(normals, wi)).then_some((wo, wi, 2.0 * PI * sample.weight.x))
    };
    let camera_path = path.clone();
    let camera = move |u| {
        camera_path(u, Bsdf::sample).map_or(0.0, |(v, l, weight)| f64::from(sensitivity(v) * weight * radiance(l)))
    };
    let light = move |u| {
        path(u, light_paths.sample).map_or(0.0, |(l, v, weight)| {
            f64::from(radiance(l) * weight * (light_paths.factor)(&surface, l, v) * sensitivity(v))
        })
    };
    equal_means(name, [Box::new(camera), Box::new(light)])
}

/// The test whether two estimators have the same mean.
pub fn equal_means(name: String, estimators: [Estimator; 2]) -> Case {
    /// Samples of the pilot run, and most samples.
    const RANGE: [u64; 2] = [1 << 14, 1 << 24];
    Case::new(name, move |protocol, round| -> Result<Outcome> {
        protocol.check()?;
        let start = Instant::now();
        let compare = |samples: u64, pass: u64| -> Result<ImageComparison> {
            let mean = |k: usize| -> Result<Mean> {
                let (mut sum, mut square) = (0.0, 0.0);
                for i in 0..samples {
                    if i % (1 << 16) == 0 {
                        interrupt::check()?;
                    }
                    let stream = Independent::new(protocol.seed, 4 * round + 2 * pass + k as u64, i as u32);
                    let value = estimators[k]([0, 1, 2].map(|dimension| stream.pair(dimension)));
                    (sum, square) = (sum + value, square + value * value);
                }
                let (n, value) = (samples as f64, sum / samples as f64);
                let variance = (square / n - value * value).max(0.0) / (n - 1.0);
                Ok(Mean::of_samples(samples as u32, value, variance.sqrt()))
            };
            let pair = [mean(0)?, mean(1)?];
            // Directions in f32.
            Ok(welch::compare(&[pair], 2e-6 * pair[0].value))
        };
        let level = protocol.own_level();
        let samples = match protocol.samples {
            SampleCount::Fixed(n) => n,
            SampleCount::Detect(w) => {
                let found = compare(RANGE[0], 0)?.detectable(level).unwrap_or(w);
                (RANGE[0] as f64 * (found / w).powi(2)) as u64
            }
        };
        let samples = samples.clamp(RANGE[0], RANGE[1]);
        let found = compare(samples, 1)?;
        Ok(Outcome {
            statistic: found.statistic,
            dof: found.dof,
            p: Some(found.p),
            detectable: found.detectable(level),
            seconds: start.elapsed().as_secs_f64(),
            cells: 1,
            pooled: found.dof,
            ..Outcome::open(2 * samples)
        })
    })
}
