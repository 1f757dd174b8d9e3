//! Which lights are sampled at a hit, and how many samples each gets.
//!
//! Up to [`MOST_EACH`] lights at finite distance are each sampled at every hit. Of more, a light tree chooses one for each sample by the
//! place and the normal of the hit, so that a hit costs no more. Lights at infinity always have samples of their own.

use super::lanes::{BLOCK, NONE};
use super::light_sample::{LightSample, SampleLight};
use super::light_tree::{Descent, Found, LightBounds, LightTree, LightTreeAt};
use super::lights::Sampled;
use glam::Vec3;

/// So many lights, or fewer, are each sampled at every hit. A shadow ray for each of more lights costs more time than it
/// saves noise.
pub const MOST_EACH: usize = 2;

/// The lights of a scene that are sampled.
pub struct Lights {
    pub all: Vec<Sampled>,
    rounds: Vec<Round>,
    tree: Option<Tree>,
    samples: u32,
}

/// A light tree, and the numbers of its lights among all, in both directions.
struct Tree {
    tree: LightTree,
    lights: Vec<u32>,
    /// By light, its number in the tree; [`NONE`] for lights that are not in it.
    number: Vec<u32>,
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
    pub const BYTES: usize = 2 * (size_of::<Sampled>() + size_of::<Option<LightBounds>>()) + LightTree::LIGHT_BYTES;

    /// Prepares the selection; `samples` at each hit for each light that has an extent.
    pub fn new(all: Vec<Sampled>, samples: u32) -> Self {
        let bounds: Vec<_> = all.iter().map(Sampled::bounds).collect();
        let is_finite = |light: &u32| bounds[*light as usize].is_some();
        let numbers = || 0..all.len() as u32;
        let finite: Vec<u32> = numbers().filter(is_finite).collect();
        let tree = (finite.len() > MOST_EACH).then(|| {
            let mut number = vec![NONE; all.len()];
            for (i, &light) in finite.iter().enumerate() {
                number[light as usize] = i as u32;
            }
            let tree = LightTree::new(&bounds.iter().flatten().copied().collect::<Vec<_>>());
            Tree { tree, lights: finite, number }
        });
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
    pub fn selection(&self, point: Vec3, normal: Option<Vec3>) -> Option<Selection<'_>> {
        // A closure would be compiled without wide vectors.
        let tree = self.tree.as_ref()?;
        Some(Selection { at: tree.tree.at(point, normal), lights: &tree.lights })
    }

    /// A sample of a light that was chosen with this probability.
    #[inline(always)]
    pub fn sample(&self, light: u32, probability: f32, point: Vec3, u: [f32; 2]) -> LightSample {
        let sample = self.all[light as usize].sample(point, u);
        LightSample { weight: sample.weight / probability, pdf: sample.pdf * probability, ..sample }
    }

    /// The expected number of light samples per solid angle that a hit at a point with this normal takes towards a light.
    #[inline]
    pub fn density(&self, light: u32, point: Vec3, normal: Option<Vec3>) -> f32 {
        let probability = match &self.tree {
            Some(Tree { tree, number, .. }) if number[light as usize] != NONE => {
                tree.pmf(point, normal, number[light as usize] as usize)
            }
            _ => 1.0,
        };
        self.samples as f32 * probability * self.all[light as usize].pdf(point)
    }
}

/// The selection of lights for a place.
#[derive(Clone, Copy)]
pub struct Selection<'a> {
    at: LightTreeAt<'a>,
    lights: &'a [u32],
}

impl Selection<'_> {
    /// A light, and the probability of choosing it; `None` where no light can arrive.
    #[inline(always)]
    pub fn sample(&self, u: f32) -> Option<(u32, f32)> {
        let (number, probability) = self.at.sample(u)?;
        Some((self.lights[number], probability))
    }

    /// [`sample`](Self::sample) for a block of shading points. On entry `probability` holds their random numbers, on return the
    /// probability of the chosen light; `light` is [`NONE`] where no light can contribute. All points descend the light tree
    /// together.
    #[inline(always)]
    pub fn sample_each(places: &[Self; BLOCK], light: &mut [u32], probability: &mut [f32]) {
        let mut count = light.len().min(probability.len()).min(BLOCK);
        let (mut descents, mut left) = ([Descent::new(0.0); BLOCK], [0; BLOCK]);
        for i in 0..count {
            (descents[i], left[i]) = (Descent::new(probability[i]), i);
        }
        while count > 0 {
            let mut still = 0;
            for k in 0..count {
                let i = left[k] % BLOCK;
                left[still] = i;
                match places[i].at.descend(descents[i]) {
                    Found::Light(number, p) => (light[i], probability[i]) = (places[i].lights[number], p),
                    Found::Nothing => (light[i], probability[i]) = (NONE, 1.0),
                    Found::Node(descent) => {
                        descents[i] = descent;
                        still += 1;
                    }
                }
            }
            count = still;
        }
    }
}
