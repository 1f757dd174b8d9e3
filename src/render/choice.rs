//! Which technique, and which density of the environment map, a render chooses for its scene: by theory where it says so, or else by
//! the error and the counted work of a few pixels.

use super::film::{PathClasses, Splat};
use super::job::Job;
use super::kernel::{Buffers, LightPathBuffers, Radiance, Work, trace, trace_light_paths};
use super::lanes::{LANES, at};
use super::light_tracing::SAMPLES_PER_LIGHT_PATH;
use super::needs::lone_convex_from_outside;
use super::prepared::PreparedScene;
use super::sample_lanes::SampleLanes;
use super::settings::{Sampling, Settings};
use crate::envmap::samplers::MapSampling;
use crate::error::Result;
use crate::math::Rgb;
use crate::sampling::hash::mix64;
use crate::sampling::stream::StreamKind;
use crate::scene::{Emission, EmitterVisibility, Material, Request, Scene};
use glam::DVec3;
use rayon::prelude::*;

/// Columns and rows of the pixels on which candidates are tried, at most, and the samples of each.
const TRIAL_GRID: [usize; 2] = [20, 15];
const TRIAL: u32 = 4;
const N: f64 = TRIAL as f64;
const PER_LIGHT_PATH: f64 = SAMPLES_PER_LIGHT_PATH as f64;
/// The largest relative error of the light by which a candidate is taken: the variance of n equal events has a relative error of √(2/n), and their
/// sum one of 1/√n.
const KNOWN: f64 = 0.25;
/// Columns and rows of the blocks of the image whose pixels are taken together: the variance of a few samples is most often
/// too small.
const BLOCKS: [usize; 2] = [5, 5];
/// Costs in rays, with the shading of their hits: of the choice of a light, or of a place in the map, for a light sample; of a ray of a light path
/// with its connection to the camera. The ignored test `costs_of_operations` measures them.
const LIGHT_CHOICE: f64 = 2.0;
const LIGHT_PATH_RAY: f64 = 4.0;

impl Settings {
    /// The settings with the first candidate for a scene, if they leave the choice to the render, and all candidates.
    pub(super) fn with_first_candidate(&self, scene: &Scene) -> (Self, &'static [(Sampling, MapSampling)]) {
        let candidates = if self.choose { Self::candidates(scene) } else { &[] };
        let fixed = Self { choose: false, ..*self };
        (candidates.first().map_or(fixed, |&first| fixed.with(first)), candidates)
    }

    /// The settings with a candidate.
    fn with(self, (sampling, density): (Sampling, MapSampling)) -> Self {
        Self { sampling, density: Some(density), ..self }
    }

    /// The techniques and densities of the map among which a render of a scene chooses.
    ///
    /// Theory says where no more is needed, and which is the first, which has to be right for every scene of its kind:
    /// - Lights that no ray can hit are found by light samples alone.
    /// - At a diffuse surface that sees the whole map, radiance times cosine is the integrand: light samples in proportion to it are all
    ///   that it needs. BSDF samples help where cosines vary within a block of the map or a cell of normals.
    /// - Among several objects the brightest light may be occluded; BSDF samples then find the rest, and light samples leave to
    ///   them what is dimmer than the mean of the map. Where most of the light is occluded, light samples are in vain.
    /// - Surfaces that are not diffuse need BSDF samples, and may cast caustics.
    #[must_use]
    pub fn candidates(scene: &Scene) -> &'static [(Sampling, MapSampling)] {
        const LIGHT: (Sampling, MapSampling) = (Sampling::Light, MapSampling::COSINE);
        const BSDF: (Sampling, MapSampling) = (Sampling::Bsdf, MapSampling::MAP);
        const MIS: (Sampling, MapSampling) = (Sampling::Mis, MapSampling::COSINE);
        const COMPENSATED: (Sampling, MapSampling) = (Sampling::Mis, MapSampling::COSINE_COMPENSATED);
        const CAUSTICS: (Sampling, MapSampling) = (Sampling::MisLt, MapSampling::COSINE_COMPENSATED);
        let is_diffuse = scene.objects.iter().all(|object| matches!(object.material, Material::Diffuse { .. }));
        match &scene.environment {
            None if !scene.objects.iter().any(|object| object.emission.is_some_and(can_be_hit)) => &[LIGHT],
            None if is_diffuse => &[MIS, LIGHT, BSDF],
            None => &[CAUSTICS, LIGHT, BSDF],
            Some(_) if lone_convex_from_outside(scene) => &[LIGHT, MIS],
            Some(_) if is_diffuse => &[LIGHT, MIS, COMPENSATED, BSDF],
            Some(_) => &[CAUSTICS, BSDF],
        }
    }
}

/// Whether a ray that hits the emitter counts its light.
fn can_be_hit(emission: Emission) -> bool {
    emission.visibility == EmitterVisibility::Sampled
}

/// What a few samples of a candidate say.
#[derive(Default)]
struct Trial {
    /// The light that surfaces scatter, of a sample of each pixel.
    light: Moments,
    blocks: [Block; BLOCKS[0] * BLOCKS[1]],
    /// The cost of the camera samples, and of the light paths that come with them.
    cost: [f64; 2],
}

/// The sum of the channels, and that of their variances.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    mean: f64,
    variance: f64,
}

impl Moments {
    /// Of the samples of a pixel.
    fn of(values: impl Iterator<Item = DVec3> + Clone) -> Self {
        let mean = values.clone().sum::<DVec3>() / N;
        let variance = values.map(|v| (v - mean).length_squared()).sum::<f64>() / (N - 1.0);
        Self { mean: mean.element_sum(), variance }
    }

    fn plus(self, other: Self) -> Self {
        Self { mean: self.mean + other.mean, variance: self.variance + other.variance }
    }
}

/// Pixels of a trial.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    /// Their number.
    pixels: f64,
    /// The sum of their variances, for one camera sample.
    variance: f64,
    /// What light paths add to it, and what camera paths would add that find the same light.
    light_paths: f64,
    replaced: f64,
}

/// How good a candidate is.
struct Score {
    /// The logarithm of error times cost.
    log_product: f64,
    /// The share of each block in the noise, and to which power the sum of the noise is the error.
    shares: Vec<f64>,
    power: f64,
}

impl Job<'_> {
    /// Chooses the candidate with the least error times cost in a few pixels; the scene is prepared for the first. The image does not
    /// contain their paths, so that it is unbiased.
    pub(super) fn choose(&mut self, candidates: &[(Sampling, MapSampling)]) -> Result<()> {
        let Some((_, others)) = candidates.split_first().filter(|(_, others)| !others.is_empty()) else {
            return Ok(());
        };
        let adaptive = self.settings.adaptive;
        let first = self.trial(&self.scene);
        let mut best = first.score(&first, |block| block.light_paths, first.cost[0] + first.cost[1], adaptive);
        if self.scene.light_tracing.is_some() {
            let without = first.score(&first, |block| block.replaced, first.cost[0], adaptive);
            if without.is_better_than(&best) {
                best = without;
                self.settings.sampling = Sampling::Mis;
                (self.scene.sampling, self.scene.light_tracing) = (Sampling::Mis, None);
            }
        }
        let mut chosen = None;
        for &candidate in others {
            let settings = self.settings.with(candidate);
            let scene = self.scene.with(&settings)?;
            let trial = self.trial(&scene);
            // Its camera paths do not find the light of light paths better than those of MIS.
            let score = trial.score(&first, |block| block.replaced, trial.cost[0], adaptive);
            if !trial.may_miss_light_of(&first) && score.is_better_than(&best) {
                best = score;
                chosen = Some((settings, scene));
            }
        }
        if let Some(chosen) = chosen {
            (self.settings, self.scene) = chosen;
        }
        Ok(())
    }

    /// Traces a few samples of pixels on a grid over the image, and as many light paths.
    fn trial(&self, scene: &PreparedScene) -> Trial {
        let Request { width, height, .. } = scene.request;
        let [column, row] = [width.div_ceil(TRIAL_GRID[0]), height.div_ceil(TRIAL_GRID[1])];
        let columns: Vec<usize> = (column / 2..width).step_by(column).collect();
        let rows: Vec<usize> = (row / 2..height).step_by(row).collect();
        let block = |x: usize, y: usize| y * BLOCKS[1] / height * BLOCKS[0] + x * BLOCKS[0] / width;
        let mut trial = Trial::default();
        let traced: Vec<_> = rows.par_iter().map(|&y| self.trace_some(scene, &columns, y)).collect();
        for (traced, y) in traced.iter().zip(rows) {
            for (values, &x) in traced.values.chunks(TRIAL as usize).zip(&columns) {
                let [all, scattered] = [0, 1].map(|i| Moments::of(values.iter().map(|value| value[i])));
                trial.light = trial.light.plus(scattered);
                let block = &mut trial.blocks[block(x, y)];
                block.pixels += 1.0;
                block.variance += all.variance;
            }
            for splat in &traced.splats {
                // There are more light paths than with as many samples of an image.
                let value = splat.value.as_dvec3();
                let [light, square] = [value.element_sum(), value.length_squared()].map(|v| v / (N * PER_LIGHT_PATH));
                trial.light.mean += light;
                let [x, y] = splat.pixel.map(|at| at as usize);
                let block = &mut trial.blocks[block(x, y)];
                block.light_paths += square;
                block.replaced += square * (1.0 + 1.0 / f64::from(splat.others));
            }
            trial.cost[0] += traced.work.rays as f64 + LIGHT_CHOICE * traced.work.choices as f64;
            trial.cost[1] += LIGHT_PATH_RAY * traced.light_path_rays as f64 / PER_LIGHT_PATH;
        }
        trial
    }

    /// Traces the samples of pixels of a row, and a light path for each.
    fn trace_some(&self, scene: &PreparedScene, columns: &[usize], y: usize) -> Traced {
        // Samples that are well distributed together say too little of the variance of one.
        let mut numbers = SampleLanes::new(StreamKind::Independent, mix64(!self.settings.seed));
        let (mut column, mut count) = ([0; LANES], 0);
        for (&x, sample) in columns.iter().flat_map(|x| (0..TRIAL).map(move |sample| (x, sample))) {
            numbers.assign(count, (y * scene.request.width + x) as u64, sample);
            column[count] = x as u32;
            count += 1;
        }
        let mut radiance = Radiance::new(Some(PathClasses::up_to(0)));
        trace(scene, &self.lens, (&column, y as u32, count), &numbers, &mut Buffers::default(), &mut radiance);
        let (mut light_paths, mut splats) = (LightPathBuffers::default(), Vec::new());
        trace_light_paths(scene, &self.lens, (&numbers, count), &mut light_paths, &mut splats);
        let seen = |slot| [at(&radiance.sum, slot), radiance.by_class(slot)[0]].map(Rgb::as_dvec3);
        let values = (0..count).map(seen).map(|[all, direct]| [all, all - direct]).collect();
        Traced { values, work: radiance.work, splats, light_path_rays: light_paths.traced }
    }
}

/// Samples of a row.
struct Traced {
    /// The radiance of the samples, pixel by pixel, and the part of it that was scattered.
    values: Vec<[DVec3; 2]>,
    work: Work,
    splats: Vec<Splat>,
    light_path_rays: usize,
}

impl Trial {
    /// Whether it may miss light that it finds rarely: it has found less light than the first candidate by two standard errors, or
    /// that error is large, so that a few samples decide.
    fn may_miss_light_of(&self, first: &Self) -> bool {
        let error = (3.0 * (first.light.variance + self.light.variance) / N).sqrt();
        first.light.mean - self.light.mean > 2.0 * error || error > KNOWN * self.light.mean
    }

    /// How good the candidate is at this cost. `other` is the variance that its camera samples lack, of each block of the `first` candidate's trial.
    fn score(&self, first: &Self, other: impl Fn(&Block) -> f64, cost: f64, adaptive: bool) -> Score {
        // Adaptive sampling gives each pixel paths in proportion to its standard deviation.
        let power = if adaptive { 0.5 } else { 1.0 };
        let noise = |(block, of_first): (&Block, &Block)| {
            block.pixels.powf(1.0 - power) * (block.variance + other(of_first)).powf(power)
        };
        let noise: Vec<f64> = self.blocks.iter().zip(&first.blocks).map(noise).collect();
        let sum: f64 = noise.iter().sum();
        let shares = noise.iter().map(|noise| if sum > 0.0 { noise / sum } else { 0.0 }).collect();
        Score { log_product: sum.ln() / power + cost.ln(), shares, power }
    }
}

impl Score {
    /// Whether it is better than another one by more than the standard error of the difference, which the blocks tell.
    fn is_better_than(&self, other: &Self) -> bool {
        let squares = self.shares.iter().zip(&other.shares).map(|(a, b)| (a - b).powi(2));
        self.log_product < other.log_product - squares.sum::<f64>().sqrt() / self.power
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envmap::EnvMap;
    use crate::envmap::synthetic::Synthetic;
    use crate::scene::{Environment, builtin};
    use std::sync::Arc;
    use std::time::Instant;

    /// A trial whose blocks have these variances.
    fn trial(light: f64, variances: impl Fn(usize) -> f64) -> Trial {
        let mut trial =
            Trial { light: Moments { mean: light, variance: (0..25).map(&variances).sum() }, ..Trial::default() };
        for (i, block) in trial.blocks.iter_mut().enumerate() {
            *block = Block { pixels: 12.0, variance: variances(i), ..Block::default() };
        }
        trial
    }

    fn is_better(a: &Trial, cost: f64, first: &Trial) -> bool {
        !a.may_miss_light_of(first)
            && [true, false].map(|adaptive| {
                let first_score = first.score(first, |block| block.light_paths, 1.0, adaptive);
                a.score(first, |block| block.replaced, cost, adaptive).is_better_than(&first_score)
            }) == [true; 2]
    }

    #[test]
    fn a_candidate_has_to_be_better_by_more_than_chance() {
        let first = trial(100.0, |_| 1.0);
        assert!(is_better(&first, 0.9, &first) && !is_better(&first, 1.0, &first));
        assert!(is_better(&trial(100.0, |_| 0.5), 1.0, &first));
        assert!(!is_better(&trial(100.0, |_| 0.5), 2.0, &first));
        // A better sum may be luck where the blocks do not agree.
        let mixed = |better: f64| trial(100.0, move |i| if i % 2 == 0 { better } else { 1.5 });
        assert!(!is_better(&mixed(0.4), 1.0, &first) && is_better(&mixed(0.05), 1.0, &first));
    }

    #[test]
    fn a_candidate_that_misses_light_is_not_chosen() {
        let first = trial(100.0, |_| 1.0);
        assert!(is_better(&trial(99.0, |_| 0.0), 1.0, &first));
        assert!(!is_better(&trial(80.0, |_| 0.0), 1.0, &first));
        // What light paths find, the others would have to find by luck.
        let mut first = trial(100.0, |_| 1.0);
        first.blocks[7].replaced = 1e4;
        assert!(!is_better(&trial(100.0, |_| 0.1), 1.0, &first));
    }

    #[test]
    fn what_is_not_a_number_is_not_chosen() {
        let first = trial(100.0, |_| 1.0);
        for value in [f64::NAN, f64::INFINITY] {
            assert!(!is_better(&trial(100.0, |_| value), 1.0, &first));
            assert!(!is_better(&trial(value, |_| 1.0), 1.0, &first));
        }
    }

    /// Seconds of a render, the least of several, and its rays, choices of lights, and rays of light paths.
    fn measured(scene: &Scene, request: &Request, sampling: Sampling) -> [f64; 4] {
        let job = Job::new(scene, request, &Settings { sampling, ..Settings::default() }).unwrap();
        let columns: Vec<usize> = (0..request.width).collect();
        let run = || {
            let start = Instant::now();
            let rows = (0..request.height).map(|y| job.trace_some(&job.scene, &columns, y));
            let counts = rows.fold([0; 3], |[rays, choices, of_light_paths], row| {
                [rays + row.work.rays, choices + row.work.choices, of_light_paths + row.light_path_rays]
            });
            (start.elapsed().as_secs_f64(), counts.map(|count| count as f64))
        };
        let runs: Vec<_> = (0..20).map(|_| run()).collect();
        let [rays, choices, of_light_paths] = runs[0].1;
        [runs.iter().map(|run| run.0).fold(f64::INFINITY, f64::min), rays, choices, of_light_paths]
    }

    #[test]
    #[ignore = "measures times: run it alone, in a release build"]
    fn costs_of_operations() {
        let map = Arc::new(EnvMap::new(Synthetic::Nave.make()));
        let (diffuse, request) = builtin::cornell_lambert();
        let request = Request { width: 60, height: 200, light_samples: 1, ..request };
        let under_map = Scene { environment: Some(Environment::upright(map, "nave", 1.0)), ..diffuse.clone() };
        let mut many_lights = diffuse.clone();
        let light = diffuse.objects.iter().find(|object| object.emission.is_some()).unwrap();
        many_lights.objects.extend(vec![light.clone(); 15]);
        for (name, scene) in [("one light", diffuse), ("a light and a map", under_map), ("16 lights", many_lights)] {
            let [bsdf, mis] = [Sampling::Bsdf, Sampling::Mis].map(|sampling| measured(&scene, &request, sampling));
            let ray = bsdf[0] / bsdf[1];
            let choice = (mis[0] / ray - mis[1]) / mis[2];
            println!("{name}: {:.0} ns a ray; a choice of a light as long as {choice:.2} rays", 1e9 * ray);
        }
        let statue = builtin::find("cornell-statue-au").unwrap().make(None, None).unwrap();
        for (scene, request) in [builtin::cornell_spheres(), statue] {
            let request = Request { width: 60, height: 200, light_samples: 1, ..request };
            let [mis, lt] = [Sampling::Mis, Sampling::MisLt].map(|sampling| measured(&scene, &request, sampling));
            let of_light_path = (lt[0] - mis[0]) / lt[3] * mis[1] / mis[0];
            println!("{}: a ray of a light path as long as {of_light_path:.2} rays", scene.name);
        }
    }
}
