//! Which lights are sampled at a hit, and how many samples each gets.
//!
//! Up to [`MOST_EACH`] lights at finite distance are each sampled at every hit. Of more, a light tree chooses one for each sample by the
//! place and the normal of the hit, so that a hit costs no more. Lights at infinity always have samples of their own.

use super::lanes::NONE;
use super::light_sample::{LightSample, SampleLight};
use super::light_tree::{LightBounds, LightTree, LightTreeAt};
use super::lights::SampledLight;
use glam::Vec3;

/// So many lights, or fewer, are each sampled at every hit. A shadow ray for each of more lights costs more time than it
/// saves noise.
pub const MOST_EACH: usize = 2;

pub struct Lights {
    pub all: Vec<SampledLight>,
    rounds: Vec<Round>,
    /// Over all lights, if there are many at finite distance.
    tree: Option<LightTree>,
    samples: u32,
}

/// Light samples that are taken together at every hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// The light; `None` for one that the tree chooses.
    pub light: Option<u32>,
    /// How many samples it gets.
    pub count: u32,
}

impl Lights {
    /// About the memory that preparing a light takes: it and its bounds, twice while their lists are made, and its part of the
    /// tree.
    pub const BYTES: usize =
        2 * (size_of::<SampledLight>() + size_of::<Option<LightBounds>>()) + LightTree::LIGHT_BYTES;

    /// Prepares the selection; `samples` at each hit for each light that has an extent.
    pub fn new(all: Vec<SampledLight>, samples: u32) -> Self {
        let bounds: Vec<_> = all.iter().map(SampledLight::bounds).collect();
        let is_finite = |light: &u32| bounds[*light as usize].is_some();
        let numbers = || 0..all.len() as u32;
        let in_tree = || bounds.iter().map(|bounds| bounds.unwrap_or(LightBounds::NONE)).collect::<Vec<_>>();
        let tree = (numbers().filter(is_finite).count() > MOST_EACH).then(|| LightTree::new(&in_tree()));
        let count = |light: u32| if all[light as usize].has_extent() { samples } else { 1 };
        let each = numbers().filter(|light| tree.is_none() || !is_finite(light));
        let mut rounds: Vec<Round> = each.map(|light| Round { light: Some(light), count: count(light) }).collect();
        rounds.extend(tree.as_ref().map(|_| Round { light: None, count: samples }));
        Self { all, rounds, tree, samples }
    }

    pub fn rounds(&self) -> &[Round] {
        &self.rounds
    }

    /// Whether rays can find a light, and not light samples alone.
    #[inline(always)]
    pub fn is_found_by_rays(&self, light: u32) -> bool {
        self.all.get(light as usize).is_some_and(|light| light.object != NONE)
    }

    /// The selection among the lights of the tree for a place, if there is a tree. Without a normal light may come from both
    /// sides.
    #[inline(always)]
    pub fn selection(&self, point: Vec3, normal: Option<Vec3>) -> Option<LightTreeAt<'_>> {
        // A closure would be compiled without wide vectors.
        let tree = self.tree.as_ref()?;
        Some(tree.at(point, normal))
    }

    /// A sample of a light that was chosen with this probability.
    #[inline(always)]
    pub fn sample(&self, light: u32, probability: f32, point: Vec3, u: [f32; 2]) -> LightSample {
        let sample = self.all[light as usize].sample(point, u);
        LightSample { weight: sample.weight / probability, pdf: sample.pdf * probability, ..sample }
    }

    /// The expected number of light samples per solid angle that a hit at a point with this normal takes towards a light; of lights at
    /// infinity the pdf is 0.
    #[inline]
    pub fn density(&self, light: u32, point: Vec3, normal: Option<Vec3>) -> f32 {
        let probability = self.tree.as_ref().map_or(1.0, |tree| tree.at(point, normal).pmf(light));
        self.samples as f32 * probability * self.all[light as usize].pdf(point)
    }
}
