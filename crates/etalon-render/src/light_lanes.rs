//! Light samples for many shading points at once: of one light for all points, or of one for each, which the light tree chooses.

use super::lanes::{BLOCK, LANES, Lane, Lane3, NONE, at, block, blocks, put, set, wide};
use super::light_sample::{LightSample, LightSampleLanes, SampleLight};
use super::light_selection::Lights;
use super::light_tree::LightTreeAt;
use super::lights::{LightKind, SampledLight};
use super::shaders::Kind;
use etalon_core::scene::Ray;
use std::array::from_mut;

/// A direction towards a light from each of the first `count` positions.
pub fn sample_one_light(
    light: &SampledLight,
    positions: &Lane3,
    count: usize,
    u: &[Lane; 2],
    out: &mut LightSampleLanes,
) {
    match &light.kind {
        // Loops without a case distinction inside, which vectorize.
        LightKind::Rectangle(rectangle) => sample_shape(rectangle, positions, count, u, out),
        LightKind::Triangle(triangle) => sample_shape(triangle, positions, count, u, out),
        LightKind::Sphere(sphere) => sample_shape(sphere, positions, count, u, out),
        LightKind::Point { .. } | LightKind::Directional { .. } | LightKind::Hemisphere { .. } => {
            sample_shape(light, positions, count, u, out);
        }
    }
}

fn sample_shape(light: &impl SampleLight, positions: &Lane3, count: usize, u: &[Lane; 2], out: &mut LightSampleLanes) {
    wide(
        #[inline(always)]
        move || {
            for number in 0..blocks(count) {
                let samples = sample_block(|_| light, &block(positions, number), &block(u, number));
                put(&mut out.wi, number, &samples.wi);
                put(&mut out.weight, number, &samples.weight);
                put(from_mut(&mut out.distance), number, &[samples.distance]);
                put(from_mut(&mut out.t_max), number, &[samples.t_max]);
                put(from_mut(&mut out.pdf), number, &[samples.pdf]);
            }
        },
    );
}

#[inline(always)]
fn sample_block<'l, L: SampleLight + 'l>(
    light: impl Fn(usize) -> &'l L,
    positions: &[[f32; BLOCK]; 3],
    u: &[[f32; BLOCK]; 2],
) -> LightSampleLanes<BLOCK> {
    let mut out = LightSampleLanes::default();
    for k in 0..BLOCK {
        let (light, point) = (light(k), at(positions, k));
        let sample = light.sample(point, [u[0][k], u[1][k]]);
        out.set(k, NONE, sample, light.t_max(Ray { origin: point, direction: sample.wi }, sample.distance));
    }
    out
}

/// For each position a direction towards the light of `all` whose number `light` has; none where that is [`NONE`].
pub fn sample_own_lights<'l>(
    all: &'l [SampledLight],
    light: &[u32],
    positions: &Lane3,
    u: &[Lane; 2],
    out: &mut LightSampleLanes,
) {
    for (i, &number) in light.iter().enumerate().take(LANES) {
        match all.get(number as usize) {
            Some(SampledLight {
                kind: LightKind::Rectangle(_) | LightKind::Triangle(_) | LightKind::Sphere(_),
                ..
            }) => {}
            Some(other) => {
                let point = at(positions, i);
                let sample = other.sample(point, [u[0][i], u[1][i]]);
                out.set(i, number, sample, other.t_max(Ray { origin: point, direction: sample.wi }, sample.distance));
            }
            None => out.set(i, NONE, LightSample::BLACK, f32::INFINITY),
        }
    }
    // Loops over one shape, which vectorize.
    let rectangle = |kind: &'l LightKind| if let LightKind::Rectangle(light) = kind { Some(light) } else { None };
    let triangle = |kind: &'l LightKind| if let LightKind::Triangle(light) = kind { Some(light) } else { None };
    let sphere = |kind: &'l LightKind| if let LightKind::Sphere(light) = kind { Some(light) } else { None };
    sample_own_lights_of(all, light, positions, u, out, rectangle);
    sample_own_lights_of(all, light, positions, u, out, triangle);
    sample_own_lights_of(all, light, positions, u, out, sphere);
}

/// The lights that the light tree has chosen for some positions, with their probabilities.
pub struct Choice {
    pub light: [u32; LANES],
    /// Before the choice its random numbers.
    pub probability: Lane,
}

/// Chooses lights for the first `count` positions, on surfaces of this kind and these normals: as many for each as there are choices.
pub fn choose(lights: &Lights, positions: &Lane3, normals: &Lane3, kind: Kind, count: usize, choices: &mut [Choice]) {
    wide(
        #[inline(always)]
        move || {
            for start in (0..count.min(LANES)).step_by(BLOCK) {
                let end = count.min(start + BLOCK).min(LANES);
                let Some(first) = lights.selection(at(positions, start), kind.one_sided(at(normals, start))) else {
                    return;
                };
                let mut selections = [first; BLOCK];
                for i in start + 1..end {
                    if let Some(selection) = lights.selection(at(positions, i), kind.one_sided(at(normals, i))) {
                        selections[i - start] = selection;
                    }
                }
                for choice in &mut *choices {
                    let (light, probability) = (&mut choice.light[start..end], &mut choice.probability[start..end]);
                    LightTreeAt::sample_each(&selections, light, probability);
                }
            }
        },
    );
}

/// A direction towards the light that was chosen for each of the first `count` positions. The pdf counts the choice; it is infinite
/// where rays cannot find the light.
pub fn sample_chosen(
    lights: &Lights,
    choice: &Choice,
    positions: &Lane3,
    count: usize,
    u: &[Lane; 2],
    out: &mut LightSampleLanes,
) {
    sample_own_lights(&lights.all, &choice.light[..count], positions, u, out);
    // Divide the samples by the probability of the choice
    wide(
        #[inline(always)]
        move || {
            for i in 0..count.min(LANES) {
                let (light, probability) = (choice.light[i], choice.probability[i]);
                let weight = at(&out.weight, i) / probability;
                set(&mut out.weight, i, weight);
                out.pdf[i] = if lights.is_found_by_rays(light) { out.pdf[i] * probability } else { f32::INFINITY };
            }
        },
    );
}

/// The loop of [`sample_own_lights`] over the lights for which `of_shape` has a shape. It gathers them a block at a time.
fn sample_own_lights_of<'l, L: SampleLight + Copy + 'l>(
    all: &'l [SampledLight],
    light: &[u32],
    positions: &Lane3,
    u: &[Lane; 2],
    out: &mut LightSampleLanes,
    of_shape: impl Fn(&'l LightKind) -> Option<&'l L>,
) {
    let of_lane = |i: usize| all.get(light[i] as usize).and_then(|light| of_shape(&light.kind));
    let (mut lanes, mut count) = ([0; LANES], 0);
    for i in 0..light.len().min(LANES) {
        lanes[count % LANES] = i;
        count += usize::from(of_lane(i).is_some());
    }
    for block in lanes[..count].chunks(BLOCK) {
        let Some(&first) = of_lane(block[0]) else { return };
        let mut lights = [first; BLOCK];
        let (mut points, mut numbers) = ([[0.0; BLOCK]; 3], [[0.0; BLOCK]; 2]);
        for (k, &i) in block.iter().enumerate() {
            if let Some(&light) = of_lane(i) {
                lights[k] = light;
            }
            set(&mut points, k, at(positions, i));
            (numbers[0][k], numbers[1][k]) = (u[0][i], u[1][i]);
        }
        let samples = wide(
            #[inline(always)]
            move || sample_block(|k| &lights[k], &points, &numbers),
        );
        for (k, &i) in block.iter().enumerate() {
            out.set(i, light[i], samples.at(k), samples.t_max[k]);
        }
    }
}
