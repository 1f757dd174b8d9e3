//! Sampling of the environment, and of directions without regard to light.

use super::lanes::{LANES, Lane3, NONE, at};
use super::light_sample::{LightSample, LightSampleLanes};
use super::prepared::Needs;
use super::settings::{Sampling, Settings};
use super::shaders::Kind;
use etalon_core::envmap::samplers::{BATCH, EnvSample, MapSampling, SurfaceSampler};
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::sampling::warp;
use etalon_core::scene::{Environment, Scene};
use glam::{DVec3, Vec3};

pub struct EnvironmentSampling<'a> {
    environment: &'a Environment,
    density: MapSampling,
    sampler: Box<dyn SurfaceSampler>,
    /// Whether the sampler looks at the surface's normal.
    needs_normal: bool,
}

impl<'a> EnvironmentSampling<'a> {
    /// Builds the sampler that the settings ask for; `None` where it is not needed, or has no samples.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a sampler that misses part of the light and is used alone; those of the sampler.
    pub fn new(scene: &'a Scene, settings: &Settings, needs: &Needs) -> Result<Option<Self>> {
        let density = settings.map_sampling();
        let Some(environment) = &scene.environment else { return Ok(None) };
        // Fixed lights are among the scene's lights.
        if !settings.sampling.by_light() || !needs.environment_table || density.has_fixed_lights() {
            return Ok(None);
        }
        if !settings.sampling.is_mis() && !density.entry().complete {
            return Err(Error::parameter("density", format!("the density {density} misses part of the light"))
                .with_hint("it is correct only together with BSDF sampling: use `sampling` mis"));
        }
        let sampler = density.sampler(environment.map.clone())?;
        let needs_normal = density.needs_normal();
        Ok(sampler.has_samples().then_some(Self { environment, density, sampler, needs_normal }))
    }

    /// Whether these are the samples that the settings ask for.
    pub fn is_for(&self, settings: &Settings) -> bool {
        settings.sampling.by_light() && settings.map_sampling() == self.density
    }

    /// Whether directions to both sides of a surface are sampled, each with probability ½ and by the normal on its side: light
    /// that arrives at the far side is scattered, too.
    #[inline]
    fn samples_both_sides(&self, surface: Kind) -> bool {
        self.needs_normal && surface == Kind::Transmitting
    }

    /// A direction towards the light that falls on a surface of this kind and normal, in the world.
    #[inline]
    pub fn sample(&self, u: [f64; 2], normal: Vec3, surface: Kind) -> Option<EnvSample> {
        let both_sides = self.samples_both_sides(surface);
        let (u, towards) = if both_sides { choose_side(u, normal) } else { (u, normal) };
        let sample = self.sampler.sample_for(u, self.environment.to_map(towards.as_dvec3()))?;
        Some(self.in_world(sample, normal, both_sides))
    }

    /// [`EnvironmentSampling::sample`] for the first `count` lanes of random numbers and normals.
    pub fn sample_many(
        &self,
        u: &[[f64; LANES]; 2],
        normals: &Lane3,
        surface: Kind,
        count: usize,
        out: &mut LightSampleLanes,
    ) {
        let both_sides = self.samples_both_sides(surface);
        for start in (0..count).step_by(BATCH) {
            let n = BATCH.min(count - start);
            let (mut numbers, mut towards, mut samples) = ([[0.0; 2]; BATCH], [DVec3::ZERO; BATCH], [None; BATCH]);
            for i in 0..n {
                let (u, normal) = ([u[0][start + i], u[1][start + i]], at(normals, start + i));
                let (u, normal) = if both_sides { choose_side(u, normal) } else { (u, normal) };
                numbers[i] = u;
                towards[i] = self.environment.to_map(normal.as_dvec3());
            }
            self.sampler.sample_each(&numbers[..n], &towards[..n], &mut samples[..n]);
            for (i, sample) in samples[..n].iter().enumerate() {
                let in_world = sample.map(|sample| self.in_world(sample, at(normals, start + i), both_sides));
                let (wi, radiance, pdf) =
                    in_world.map_or((Vec3::Y, Rgb::ZERO, 1.0), |s| (s.wi.as_vec3(), s.radiance, s.pdf as f32));
                let sample = LightSample { wi, distance: f32::INFINITY, weight: radiance / pdf, pdf };
                out.set(start + i, NONE, sample, f32::INFINITY);
            }
        }
    }

    /// A sample of the map, turned and scaled as the environment is, with the pdf for both sides where both are sampled.
    #[inline]
    fn in_world(&self, sample: EnvSample, normal: Vec3, both_sides: bool) -> EnvSample {
        let (wi, radiance) = (self.environment.to_world * sample.wi, sample.radiance * self.environment.scale);
        let pdf = if both_sides {
            self.pdf_of_both_sides(self.environment.map.geometry().texel(sample.wi), normal)
        } else {
            sample.pdf
        };
        EnvSample { wi, radiance, pdf }
    }

    /// Pdf of [`EnvironmentSampling::sample`] per solid angle.
    #[inline]
    pub fn pdf(&self, wi: Vec3, normal: Vec3, surface: Kind) -> f64 {
        self.pdf_in_texel(self.environment.texel(wi.as_dvec3()), normal, surface)
    }

    /// [`EnvironmentSampling::pdf`] of the directions in a texel of the map.
    #[inline]
    pub fn pdf_in_texel(&self, texel: (usize, usize), normal: Vec3, surface: Kind) -> f64 {
        if self.samples_both_sides(surface) {
            self.pdf_of_both_sides(texel, normal)
        } else {
            self.pdf_of_side(texel, normal)
        }
    }

    fn pdf_of_both_sides(&self, texel: (usize, usize), normal: Vec3) -> f64 {
        0.5 * (self.pdf_of_side(texel, normal) + self.pdf_of_side(texel, -normal))
    }

    #[inline]
    fn pdf_of_side(&self, texel: (usize, usize), normal: Vec3) -> f64 {
        self.sampler.pdf_in_texel(texel, self.environment.to_map(normal.as_dvec3()))
    }
}

/// Chooses a side of a surface with probability ½: the random numbers that remain, and the normal on that side.
#[inline]
fn choose_side(u: [f64; 2], normal: Vec3) -> ([f64; 2], Vec3) {
    let twice = 2.0 * u[0];
    if twice < 1.0 { ([twice, u[1]], normal) } else { ([twice - 1.0, u[1]], -normal) }
}

/// A strategy that chooses directions by the surface alone: from two random numbers a direction in the local frame, and its pdf per solid
/// angle.
pub type SurfaceSampling = fn([f64; 2]) -> (DVec3, f64);

/// The strategy that gathers direct light at surfaces of a kind that is not a delta distribution.
pub fn surface_sampling(sampling: Sampling, surface: Kind) -> Option<SurfaceSampling> {
    let strategy: SurfaceSampling = match (sampling, surface) {
        (Sampling::Bsdf, Kind::Diffuse) => |u| {
            let wi = warp::cosine_hemisphere(u);
            (wi, warp::cosine_hemisphere_pdf(wi.z))
        },
        // At a surface that scatters light to both sides
        (Sampling::Hemisphere, Kind::Transmitting) => |u| (warp::uniform_sphere(u), warp::UNIFORM_SPHERE_PDF),
        (Sampling::Hemisphere, _) => |u| (warp::uniform_hemisphere(u), warp::UNIFORM_HEMISPHERE_PDF),
        (Sampling::Bsdf | Sampling::Light | Sampling::Mis | Sampling::MisLt, _) => return None,
    };
    Some(strategy)
}
