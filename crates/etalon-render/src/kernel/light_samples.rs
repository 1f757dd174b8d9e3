//! Directions towards light for a batch of places, from every source that the strategy uses.

use super::paths::Step;
use crate::environment::BsdfOnly;
use crate::lanes::{BLOCK, LANES, Lane, Lane3, NOTHING, Wide, at, set, wide};
use crate::light_lanes;
use crate::light_sample::{LightSample, LightSampleLanes};
use crate::light_selection::{Lights, Round, Selection};
use crate::prepared::PreparedScene;
use crate::shaders::Kind;
use etalon_core::math::{Frame, Rgb};

/// A source of directions towards light.
#[derive(Clone, Copy)]
pub enum Source {
    /// A round of light samples, by its number.
    Lights(usize, Round),
    /// Light samples of the environment.
    Environment,
    /// A strategy that ignores the lights: its rays find emitters.
    BsdfOnly(BsdfOnly),
}

/// The sources for surfaces of a kind, each with its number of samples.
pub fn sources<'a>(scene: &'a PreparedScene, surface: Kind) -> impl Iterator<Item = (Source, u32)> + 'a {
    let count = scene.request.light_samples;
    let rounds = scene.lights.rounds().iter().enumerate().map(|(i, &round)| (Source::Lights(i, round), round.count));
    let environment = scene.environment.iter().map(move |_| (Source::Environment, count));
    let bsdf_only = BsdfOnly::of(scene.sampling, surface).into_iter();
    rounds.chain(environment).chain(bsdf_only.map(move |strategy| (Source::BsdfOnly(strategy), count)))
}

/// Places that light samples are taken for.
pub struct Places<'a> {
    pub position: &'a Lane3,
    /// Normals for shading.
    pub normal: &'a Lane3,
    pub slots: &'a [u32],
    /// What they are on.
    pub surface: Kind,
}

/// Fills `out` with sample number `sub_sample.0` of `sub_sample.1` of a source for each place.
/// The pdf is infinite where no BSDF samples are combined with it.
pub fn sample(
    step: Step,
    source: Source,
    sub_sample: (u32, u32),
    places: &Places,
    choices: &mut Vec<Choice>,
    out: &mut LightSampleLanes,
) {
    let Step { scene, numbers, scatterings } = step;
    let dimensions = scene.dimensions(scatterings);
    let Places { position, normal, slots, surface } = *places;
    let count = slots.len();
    let by_mis = scene.sampling.is_mis();
    match source {
        Source::Lights(number, round) => {
            let mut u = [[0.0; LANES]; 2];
            numbers.fill(scene.arch, slots, dimensions.light(number), sub_sample, &mut u);
            let Some(light) = round.light else {
                // With the first sample, choose the lights of all.
                if sub_sample.0 == 0 {
                    choose_lights(step, round, places, choices);
                }
                let choice = &choices[sub_sample.0 as usize];
                light_lanes::sample_each(scene.arch, &scene.lights.all, &choice.light[..count], position, &u, out);
                return wide(scene.arch, WeighChosen { scene, count, choice, by_mis, out });
            };
            let sampled = &scene.lights.all[light as usize];
            light_lanes::sample_many(scene.arch, sampled, position, count, &u, out);
            out.light[..count].fill(light);
            if !by_mis || !scene.lights.is_found_by_rays(light) {
                out.pdf[..count].fill(f32::INFINITY);
            }
        }
        Source::Environment => {
            let Some(environment) = &scene.environment else { return };
            let mut u = [[0.0; LANES]; 2];
            numbers.fill(scene.arch, slots, dimensions.environment(), sub_sample, &mut u);
            environment.sample_many(&u, normal, surface, count, out);
            if !by_mis {
                out.pdf[..count].fill(f32::INFINITY);
            }
        }
        Source::BsdfOnly(strategy) => {
            for i in 0..count {
                let local = strategy.sample(numbers.pair(slots[i], dimensions.bsdf_direct(), sub_sample));
                let wi = Frame::from_normal(at(normal, i)).to_world(local.as_vec3());
                let weight = Rgb::splat(1.0 / strategy.pdf(local.z) as f32);
                let sample = LightSample { wi, distance: f32::INFINITY, weight, pdf: f32::INFINITY };
                out.set(i, NOTHING, sample, f32::INFINITY);
            }
        }
    }
}

/// The lights that the tree has chosen for a batch of places, with their probabilities.
pub struct Choice {
    light: [u32; LANES],
    probability: Lane,
}

/// Chooses the lights of a round for each place, all samples of a place together.
fn choose_lights(step: Step, round: Round, places: &Places, choices: &mut Vec<Choice>) {
    let dimension = step.scene.dimensions(step.scatterings).light_choice();
    choices.resize_with(round.count as usize, || Choice { light: [NOTHING; LANES], probability: [0.0; LANES] });
    for (index, choice) in (0..).zip(&mut *choices) {
        let mut u = [[0.0; LANES]; 2];
        step.numbers.fill(step.scene.arch, places.slots, dimension, (index, round.count), &mut u);
        choice.probability = u[0];
    }
    wide(step.scene.arch, Choose { lights: &step.scene.lights, places, choices });
}

/// The loop that replaces the random numbers by choices.
struct Choose<'a> {
    lights: &'a Lights,
    places: &'a Places<'a>,
    choices: &'a mut [Choice],
}

impl Wide for Choose<'_> {
    #[inline(always)]
    fn run(self) {
        let count = self.places.slots.len().min(LANES);
        for start in (0..count).step_by(BLOCK) {
            let end = count.min(start + BLOCK);
            let Some(mut selections) = self.at(start).map(|first| [first; BLOCK]) else { return };
            for i in start + 1..end {
                if let Some(selection) = self.at(i) {
                    selections[i - start] = selection;
                }
            }
            for choice in &mut *self.choices {
                let (light, probability) = (&mut choice.light[start..end], &mut choice.probability[start..end]);
                Selection::sample_each(&selections, light, probability);
            }
        }
    }
}

impl<'a> Choose<'a> {
    /// The selection for place `i`, if there is a tree.
    #[inline(always)]
    fn at(&self, i: usize) -> Option<Selection<'a>> {
        let normal = self.places.surface.one_sided(at(self.places.normal, i));
        self.lights.selection(at(self.places.position, i), normal)
    }
}

/// The loop that divides the samples of the lights that were chosen by the probability of the choice.
struct WeighChosen<'a> {
    scene: &'a PreparedScene<'a>,
    count: usize,
    choice: &'a Choice,
    by_mis: bool,
    out: &'a mut LightSampleLanes,
}

impl Wide for WeighChosen<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { scene, count, choice, by_mis, out } = self;
        for i in 0..count.min(LANES) {
            let (light, probability) = (choice.light[i], choice.probability[i]);
            let weight = at(&out.weight, i) / probability;
            set(&mut out.weight, i, weight);
            let is_weighed = by_mis && scene.lights.is_found_by_rays(light);
            out.pdf[i] = if is_weighed { out.pdf[i] * probability } else { f32::INFINITY };
        }
    }
}
