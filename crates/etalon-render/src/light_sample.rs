//! What every light offers: samples of directions towards it, their pdf, and points of its surface; and the weights of multiple
//! importance sampling.

use super::lanes::{LANES, NONE, at, set};
use super::light_tree::LightBounds;
use etalon_core::math::Rgb;
use etalon_core::scene::Ray;
use glam::Vec3;

/// A direction towards a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// To the light; infinite for lights at infinity.
    pub distance: f32,
    /// What arrives, divided by the pdf: radiance over pdf per solid angle, or irradiance where the light has
    /// no extent. Black where the light does not reach.
    pub weight: Rgb,
    /// Density per solid angle; infinite where the light has no extent.
    pub pdf: f32,
}

impl LightSample {
    pub const BLACK: Self = Self { wi: Vec3::Y, distance: f32::INFINITY, weight: Rgb::ZERO, pdf: f32::INFINITY };
}

/// Samples directions towards a light, uniformly by solid angle: the pdf depends on the point alone.
pub trait SampleLight {
    fn sample(&self, point: Vec3, u: [f32; 2]) -> LightSample;

    /// The length of a shadow ray to the light at a distance, so that rounding does not let the light occlude itself.
    fn t_max(&self, ray: Ray, distance: f32) -> f32;

    /// Density per solid angle of [`SampleLight::sample`] from a point, for a direction that meets the light; 0 of
    /// lights that no ray can hit.
    fn pdf(&self, point: Vec3) -> f32;
}

/// A light with a surface.
pub trait AreaLight: SampleLight {
    /// The radiance, and the area.
    fn emitted(&self) -> (Rgb, f32);

    /// A point, sampled uniformly by area.
    fn point(&self, u: [f32; 2]) -> LightPoint;

    /// Unit normal at a point of it, on the side that emits.
    fn normal(&self, point: Vec3) -> Vec3;

    /// How far off it rays must start near a point of it.
    fn offset(&self, point: Vec3) -> f32;

    /// Its distance along a ray, NaN, infinite or not positive where the ray does not meet it, and whether it emits towards the ray's
    /// origin.
    fn seen_along(&self, ray: Ray) -> (f32, bool);

    /// Where it is and how it emits, for selecting one of many lights.
    fn bounds(&self) -> LightBounds;
}

/// [`LightSample`]s from many points: of all paths, or of a block.
pub struct LightSampleLanes<const N: usize = LANES> {
    pub wi: [[f32; N]; 3],
    pub distance: [f32; N],
    pub weight: [[f32; N]; 3],
    /// Length of the shadow ray, which ends in front of the light.
    pub t_max: [f32; N],
    pub pdf: [f32; N],
    /// Numbers of the lights, or [`super::lanes::NONE`].
    pub light: [u32; N],
}

impl<const N: usize> LightSampleLanes<N> {
    #[inline(always)]
    pub fn at(&self, i: usize) -> LightSample {
        let (wi, weight) = (at(&self.wi, i), at(&self.weight, i));
        LightSample { wi, distance: self.distance[i], weight, pdf: self.pdf[i] }
    }

    /// Sets lane `i` to a sample of that light, or of none in the scene, and the length of its shadow ray.
    #[inline(always)]
    pub fn set(&mut self, i: usize, light: u32, sample: LightSample, t_max: f32) {
        set(&mut self.wi, i, sample.wi);
        set(&mut self.weight, i, sample.weight);
        (self.distance[i], self.t_max[i]) = (sample.distance, t_max);
        (self.pdf[i], self.light[i]) = (sample.pdf, light);
    }
}

impl<const N: usize> Default for LightSampleLanes<N> {
    #[inline(always)]
    fn default() -> Self {
        let (zeros, zeros3) = ([0.0; N], [[0.0; N]; 3]);
        Self { wi: zeros3, distance: zeros, weight: zeros3, t_max: zeros, pdf: zeros, light: [NONE; N] }
    }
}

#[derive(Debug, Clone, Copy)]
pub struct LightPoint {
    pub position: Vec3,
    /// Unit normal on the side that emits.
    pub normal: Vec3,
    /// Whether the back emits, too.
    pub two_sided: bool,
}

/// The weight of a sample from a technique of density `own` when two other techniques find the same path with the densities
/// `others`: the balance heuristic own / (own + Σ others). A density counts the samples of its technique.
///
/// Source: Veach & Guibas, "Optimally Combining Sampling Techniques", 1995, section 3.3.
#[inline(always)]
pub fn balance_heuristic(own: f32, others: [f32; 2]) -> f32 {
    1.0 / (1.0 + (others[0] + others[1]) / own)
}
