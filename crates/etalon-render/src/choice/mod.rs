//! Which technique, and which density of the environment map, a render chooses for its scene: by theory where it says so, or else by
//! the error and the counted work of a few pixels.

use super::adaptive::allocate;
use super::film::Splat;
use super::job::Job;
use super::kernel::{Buffers, Pixels, trace, trace_light_paths};
use super::lanes::{LANES, at};
use super::light_tracing::SAMPLES_PER_LIGHT_PATH;
use super::prepared::PreparedScene;
use super::prepared::lone_convex_from_outside;
use super::radiance::{Radiance, Work};
use super::ray_samples::Streams;
use super::settings::{Sampling, Settings};
use super::shaders::plain;
use etalon_core::envmap::samplers::MapSampling;
use etalon_core::error::Result;
use etalon_core::sampling::hash::mix64;
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::{Emission, EmitterVisibility, Material, Object, Request, Scene};
use glam::DVec3;
use rayon::prelude::*;

/// Columns and rows of the pixels on which candidates are tried, at most, and the samples of each.
const GRID: [usize; 2] = [20, 15];
const SAMPLES: u32 = 4;
const N: f64 = SAMPLES as f64;
/// Columns and rows of blocks of the image. Variances are averaged over a block: a few samples of a pixel mostly understate its variance.
const BLOCKS: usize = 5;
/// Costs in rays, with the shading of their hits: of the choice of a light, or of a place in the map, for a light sample; of a ray of a light path
/// or from it to the camera. The ignored test `costs_of_operations` measures them.
const LIGHT_CHOICE: f64 = 2.0;
const LIGHT_PATH_RAY: f64 = 4.0;

/// A technique, and the density of the map for its light samples.
type Candidate = (Sampling, MapSampling);

impl Settings {
    /// The settings with the first candidate for a scene, if they leave the choice to the render, and all candidates.
    pub(super) fn with_first_candidate(&self, scene: &Scene) -> (Self, &'static [Candidate]) {
        let candidates = if self.choose { Self::candidates(scene) } else { &[] };
        let fixed = Self { choose: false, ..*self };
        (candidates.first().map_or(fixed, |&first| fixed.with(first)), candidates)
    }

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
    /// - Surfaces that are not diffuse need BSDF samples, and may cast caustics. Light samples alone rarely meet the peak of a glossy BSDF, which
    ///   a trial may not show.
    pub fn candidates(scene: &Scene) -> &'static [Candidate] {
        const LIGHT: Candidate = (Sampling::Light, MapSampling::COSINE);
        const BSDF: Candidate = (Sampling::Bsdf, MapSampling::MAP);
        const MIS: Candidate = (Sampling::Mis, MapSampling::COSINE);
        const COMPENSATED: Candidate = (Sampling::Mis, MapSampling::COSINE_COMPENSATED);
        const MIS_LT: Candidate = (Sampling::MisLt, MapSampling::COSINE_COMPENSATED);
        let is_diffuse = |object: &Object| matches!(plain(&object.material), Material::Diffuse { .. });
        let is_diffuse = scene.objects.iter().all(is_diffuse);
        match &scene.environment {
            None if !scene.objects.iter().any(|object| object.emission.is_some_and(can_be_hit)) => &[LIGHT],
            None if is_diffuse => &[MIS, LIGHT, BSDF],
            None => &[MIS_LT, COMPENSATED, BSDF],
            Some(_) if lone_convex_from_outside(scene) => &[LIGHT, MIS],
            Some(_) if is_diffuse => &[LIGHT, MIS, COMPENSATED, BSDF],
            Some(_) => &[MIS_LT, COMPENSATED, BSDF],
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
    blocks: [Block; BLOCKS * BLOCKS],
    /// The costs of the camera samples, and of the light paths that come with them.
    cost: f64,
    cost_of_light_paths: f64,
}

/// Pixels of a trial: sums over them, for one camera sample and the light paths that come with it.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    pixels: f64,
    /// The variance of camera samples.
    variance: f64,
    /// The variance that light paths add.
    of_light_paths: f64,
    /// The variance that camera samples would have besides, without light paths.
    spared: f64,
}

/// How good a candidate is.
struct Score {
    /// The logarithm of error times cost.
    log_product: f64,
    /// By how much it would change, to the first order, without each of the blocks.
    shares: Vec<f64>,
}

impl Job<'_> {
    /// The parts that the scene does not need and that are therefore skipped, and the techniques that the render did not choose.
    pub fn left_out(&self) -> Vec<&'static str> {
        let sampling = self.settings.sampling;
        let techniques = [
            (sampling != Sampling::Light, "BSDF sampling"),
            (sampling.by_light(), "light sampling"),
            (self.scene.light_tracing.is_some(), "light tracing"),
        ];
        let left_out = techniques.into_iter().filter(|(is_used, _)| self.chooses && !is_used);
        self.scene.needs.left_out(self.scene.scene).chain(left_out.map(|(_, name)| name)).collect()
    }

    /// Chooses the candidate with the least error times cost in a few pixels; the scene is prepared for the first. The image does not
    /// contain their paths, so that it is unbiased.
    pub(super) fn choose(&mut self, candidates: &[Candidate]) -> Result<()> {
        let Some((_, others)) = candidates.split_first().filter(|(_, others)| !others.is_empty()) else {
            return Ok(());
        };
        if self.scene.light_tracing.is_none() && self.settings.sampling == Sampling::MisLt {
            (self.settings.sampling, self.scene.sampling) = (Sampling::Mis, Sampling::Mis);
        }
        let adaptive = self.settings.adaptive;
        let first = self.trial(&self.scene);
        let (mut best, mut chosen) = (first.score(adaptive), None);
        for &candidate in others {
            let settings = self.settings.with(candidate);
            let scene = self.scene.with(&settings)?;
            // The first trial knows what the camera samples are without light paths.
            let is_first_alone = settings == Settings { sampling: Sampling::Mis, ..self.settings };
            let own = (!is_first_alone).then(|| self.trial(&scene));
            let trial = own.as_ref().unwrap_or(&first);
            let unseen = if candidate.0 == Sampling::Bsdf { trial.unseen(scene.scene) } else { 0.0 };
            let score = trial.score_alone(&first, unseen, adaptive);
            if score.is_better_than(&best) {
                (best, chosen) = (score, Some((settings, scene)));
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
        let [column, row] = [width.div_ceil(GRID[0]), height.div_ceil(GRID[1])];
        let columns: Vec<usize> = (column / 2..width).step_by(column).collect();
        let rows: Vec<usize> = (row / 2..height).step_by(row).collect();
        let block = |x: usize, y: usize| y * BLOCKS / height * BLOCKS + x * BLOCKS / width;
        let mut trial = Trial::default();
        let traced: Vec<_> = rows
            .par_iter()
            .map_init(Default::default, |buffers, &y| self.trace_row(scene, &columns, y, buffers))
            .collect();
        for (traced, y) in traced.iter().zip(rows) {
            for (values, &x) in traced.values.chunks(SAMPLES as usize).zip(&columns) {
                let block = &mut trial.blocks[block(x, y)];
                block.pixels += 1.0;
                block.variance += variance(values);
            }
            // A light path stands for as many samples of every pixel as an image has for each of its light paths.
            let share = 1.0 / (N * f64::from(SAMPLES_PER_LIGHT_PATH));
            for splat in &traced.splats {
                let [x, y] = splat.pixel.map(|at| at as usize);
                let block = &mut trial.blocks[block(x, y)];
                block.of_light_paths += share * splat.value.as_dvec3().length_squared();
                block.spared += share * f64::from(splat.spared);
            }
            trial.cost += traced.work.rays as f64 + LIGHT_CHOICE * traced.work.choices as f64;
            trial.cost_of_light_paths +=
                LIGHT_PATH_RAY * traced.light_path_rays as f64 / f64::from(SAMPLES_PER_LIGHT_PATH);
        }
        trial
    }

    /// Traces the samples of pixels of a row, and a light path for each.
    fn trace_row(&self, scene: &PreparedScene, columns: &[usize], y: usize, buffers: &mut Buffers) -> Traced {
        // Samples that are well distributed together say too little of the variance of one.
        let mut streams = Streams::new(StreamKind::Independent, mix64(!self.settings.seed));
        let (mut column, mut count) = ([0; LANES], 0);
        for (&x, sample) in columns.iter().flat_map(|x| (0..SAMPLES).map(move |sample| (x, sample))) {
            streams.assign(count, (y * scene.request.width + x) as u64, sample);
            column[count] = x as u32;
            count += 1;
        }
        let mut radiance = Radiance::new(None);
        let pixels = Pixels { columns: &column, row: y as u32, count };
        trace(scene, &self.camera, pixels, &streams, buffers, &mut radiance);
        let values = (0..count).map(|slot| at(&radiance.sum, slot).as_dvec3()).collect();
        let mut splats = Vec::new();
        let light_path_rays = trace_light_paths(scene, &self.camera, &streams, count, buffers, &mut splats);
        Traced { values, work: radiance.work, splats, light_path_rays }
    }
}

/// Samples of a row.
struct Traced {
    /// The radiance of the samples, pixel by pixel.
    values: Vec<DVec3>,
    work: Work,
    splats: Vec<Splat>,
    light_path_rays: usize,
}

/// The variance of the samples of a pixel, all channels together.
fn variance(samples: &[DVec3]) -> f64 {
    let mean = samples.iter().sum::<DVec3>() / N;
    samples.iter().map(|&v| (v - mean).length_squared()).sum::<f64>() / (N - 1.0)
}

impl Trial {
    /// The variance that BSDF samples may have at a pixel without a sign of it. What none of n samples has met has a probability below
    /// 3/n, with 95 % confidence, and brings at most the brightest light of the scene.
    fn unseen(&self, scene: &Scene) -> f64 {
        let of_objects = scene.objects.iter().filter_map(|object| object.emission).map(|emission| emission.radiance);
        let of_map = scene.environment.iter().map(|environment| environment.scale * environment.map.found().max);
        let squares = of_objects.chain(of_map).map(|radiance| radiance.as_dvec3().length_squared());
        let brightest = squares.fold(0.0, f64::max);
        let samples = N * self.blocks.iter().map(|block| block.pixels).sum::<f64>();
        3.0 / samples * brightest
    }

    /// How good the candidate is, with its light paths.
    fn score(&self, adaptive: bool) -> Score {
        Score::new(&self.blocks, [self.cost, self.cost_of_light_paths], adaptive)
    }

    /// How good its camera samples are without light paths, of which those of the first candidate spare variance: that is added, also if
    /// the trial has seen some of it by chance; and so is what a pixel may have `unseen`.
    fn score_alone(&self, first: &Self, unseen: f64, adaptive: bool) -> Score {
        let mut blocks = self.blocks;
        for (block, of_first) in blocks.iter_mut().zip(&first.blocks) {
            block.variance += of_first.spared;
            block.variance += block.pixels * unseen;
            block.of_light_paths = 0.0;
        }
        Score::new(&blocks, [self.cost, 0.0], adaptive)
    }
}

impl Score {
    /// From blocks of pixels, and the costs of camera samples and of light paths.
    fn new(blocks: &[Block], [of_camera, of_light]: [f64; 2], adaptive: bool) -> Self {
        let blocks: Vec<&Block> = blocks.iter().filter(|block| block.pixels > 0.0).collect();
        // The camera paths of a sample, as adaptive sampling would have them if it knew these variances; light paths are as many as ever.
        let variance = |block: &&Block| ((block.variance / block.pixels) as f32).min(f32::MAX);
        let variances: Vec<f32> = blocks.iter().map(variance).collect();
        let counts = if adaptive { allocate(&variances) } else { vec![1; blocks.len()] };
        let terms = blocks.iter().zip(counts).map(|(block, count)| {
            let count = f64::from(count);
            [block.variance / count + block.of_light_paths, block.pixels * (count * of_camera + of_light)]
        });
        let [error, cost] = [0, 1].map(|i| terms.clone().map(|term| term[i]).sum::<f64>());
        let share = |[a, b]: [f64; 2]| if error > 0.0 { a / error + b / cost } else { 0.0 };
        Self { log_product: (error * cost).ln(), shares: terms.map(share).collect() }
    }

    /// Whether it is better than another one by more than the standard error of the difference, by the spread of the blocks.
    fn is_better_than(&self, other: &Self) -> bool {
        let squares: f64 = self.shares.iter().zip(&other.shares).map(|(a, b)| (a - b).powi(2)).sum();
        let blocks = self.shares.len() as f64;
        self.log_product < other.log_product - (squares * blocks / (blocks - 1.0)).sqrt()
    }
}

#[cfg(test)]
mod tests;
