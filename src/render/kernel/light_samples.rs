//! Directions towards light for a batch of places, from every source that the strategy uses.

use super::step::Step;
use crate::math::{Frame, Rgb};
use crate::render::environment::BsdfOnly;
use crate::render::lanes::{LANES, Lane, Lane3, NOTHING, at};
use crate::render::light_sample::{LightSample, LightSampleLanes};
use crate::render::light_selection::{Lights, Round};
use crate::render::lights;
use crate::render::prepared::PreparedScene;
use crate::render::shaders::Kind;
use crate::render::wide::{Wide, wide};

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
    let bsdf_only = BsdfOnly::of(scene.sampling, surface.is_diffuse()).into_iter();
    rounds.chain(environment).chain(bsdf_only.map(move |strategy| (Source::BsdfOnly(strategy), count)))
}

/// Places that light samples are taken for.
pub struct Places<'a> {
    /// In the world.
    pub position: &'a Lane3,
    /// Normals for shading.
    pub normal: &'a Lane3,
    /// The camera samples.
    pub slots: &'a [u32],
    /// What they are on.
    pub surface: Kind,
}

/// Fills `out` with sample number `sub_sample.0` of `sub_sample.1` of a source for each place. The pdf is infinite where no BSDF
/// samples are combined with it.
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
    let Places { position, normal, slots, .. } = *places;
    let count = slots.len();
    let by_mis = scene.sampling.is_mis();
    match source {
        Source::Lights(number, round) => {
            let mut u = [[0.0; LANES]; 2];
            numbers.fill(scene.arch, slots, dimensions.light(number), sub_sample, &mut u);
            let Some(light) = round.light else {
                // Of the first sample: choose the lights of all.
                if sub_sample.0 == 0 {
                    choose_lights(step, round, places, choices);
                }
                let choice = &choices[sub_sample.0 as usize];
                return wide(scene.arch, SampleChosen { scene, places, choice, u: &u, by_mis, out });
            };
            let sampled = &scene.lights.all[light as usize];
            lights::sample_many(scene.arch, sampled, position, count, &u, out);
            out.light[..count].fill(light);
            if !by_mis || !scene.lights.is_found_by_rays(light) {
                out.pdf[..count].fill(f32::INFINITY);
            }
            wide(scene.arch, Limits { scene, places, object: sampled.object, out });
        }
        Source::Environment => {
            let Some(environment) = &scene.environment else { return };
            let mut u = [[0.0; LANES]; 2];
            numbers.fill(scene.arch, slots, dimensions.environment(), sub_sample, &mut u);
            environment.sample_many(&u, normal, count, out);
            if !by_mis {
                out.pdf[..count].fill(f32::INFINITY);
            }
        }
        Source::BsdfOnly(strategy) => {
            for i in 0..count {
                let local = strategy.sample(numbers.pair(slots[i], dimensions.bsdf_direct(), sub_sample));
                let wi = Frame::from_normal(at(normal, i)).to_world(local.as_vec3());
                let weight = Rgb::splat(1.0 / strategy.pdf(local.z) as f32);
                out.set(i, NOTHING, LightSample { wi, distance: f32::INFINITY, weight, pdf: f32::INFINITY });
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
        let Self { lights, places, choices } = self;
        for i in 0..places.slots.len().min(LANES) {
            let normal = (places.surface != Kind::Transmitting).then_some(at(places.normal, i));
            let Some(selection) = lights.selection(at(places.position, i), normal) else { return };
            for choice in &mut *choices {
                let chosen = selection.sample(choice.probability[i]);
                (choice.light[i], choice.probability[i]) = chosen.unwrap_or((NOTHING, 1.0));
            }
        }
    }
}

/// The loop that samples the lights that were chosen.
struct SampleChosen<'a> {
    scene: &'a PreparedScene<'a>,
    places: &'a Places<'a>,
    choice: &'a Choice,
    u: &'a [Lane; 2],
    by_mis: bool,
    out: &'a mut LightSampleLanes,
}

impl Wide for SampleChosen<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { scene, places, choice, u, by_mis, out } = self;
        let lights = &scene.lights;
        for i in 0..places.slots.len().min(LANES) {
            let light = choice.light[i];
            let sample = if light == NOTHING {
                LightSample::BLACK
            } else {
                lights.sample(light, choice.probability[i], at(places.position, i), [u[0][i], u[1][i]])
            };
            out.set(i, light, sample);
            if !by_mis || !lights.is_found_by_rays(light) {
                out.pdf[i] = f32::INFINITY;
            }
            let object = lights.all.get(light as usize).map_or(NOTHING, |light| light.object);
            out.limit[i] = scene.shadow_limit(object, [at(places.position, i), sample.wi], sample.distance);
        }
    }
}

/// The loop that computes the lengths of shadow rays to a light.
struct Limits<'a> {
    scene: &'a PreparedScene<'a>,
    places: &'a Places<'a>,
    object: u32,
    out: &'a mut LightSampleLanes,
}

impl Wide for Limits<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { scene, places, object, out } = self;
        for i in 0..places.slots.len().min(LANES) {
            out.limit[i] = scene.shadow_limit(object, [at(places.position, i), at(&out.wi, i)], out.distance[i]);
        }
    }
}
