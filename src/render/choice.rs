//! Which technique, and which density of the environment map, a render chooses for its scene: by theory where it says so, or else by
//! the variance of a few pixels.

use super::environment::EnvironmentSampling;
use super::job::{Job, Pass, Silent};
use super::needs::lone_convex_from_outside;
use super::settings::{Sampling, Settings};
use crate::envmap::samplers::MapSampling;
use crate::error::Result;
use crate::scene::{Emission, EmitterVisibility, Material, Request, Scene};
use rayon::prelude::*;

/// Columns and rows of the pixels on which candidates are tried, at most, and the samples of each.
const TRIAL_GRID: [usize; 2] = [20, 15];
const TRIAL: u32 = 4;

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

    /// The techniques and densities of the map among which a render of a scene chooses, by theory.
    ///
    /// Lights that no ray can hit are found by light samples alone. At a diffuse surface that sees the whole map, radiance times cosine is the
    /// integrand: light samples in proportion to it are all that it needs. BSDF samples help where cosines vary within a block of the map or a cell of
    /// normals. Among several objects the brightest light may be occluded; BSDF samples then find the rest, and light samples leave
    /// to them what is dimmer than the mean of the map. Surfaces that are not diffuse need BSDF samples, and may cast caustics.
    #[must_use]
    pub fn candidates(scene: &Scene) -> &'static [(Sampling, MapSampling)] {
        const LIGHT: (Sampling, MapSampling) = (Sampling::Light, MapSampling::COSINE);
        const MIS: (Sampling, MapSampling) = (Sampling::Mis, MapSampling::COSINE);
        const COMPENSATED: (Sampling, MapSampling) = (Sampling::Mis, MapSampling::COSINE_COMPENSATED);
        const CAUSTICS: (Sampling, MapSampling) = (Sampling::MisLt, MapSampling::COSINE_COMPENSATED);
        let is_diffuse = scene.objects.iter().all(|object| matches!(object.material, Material::Diffuse { .. }));
        match &scene.environment {
            None if !scene.objects.iter().any(|object| object.emission.is_some_and(can_be_hit)) => &[LIGHT],
            Some(_) if lone_convex_from_outside(scene) => &[LIGHT, MIS],
            Some(_) if is_diffuse => &[LIGHT, MIS, COMPENSATED],
            _ => &[CAUSTICS],
        }
    }
}

/// Whether a ray that hits the emitter counts its light.
fn can_be_hit(emission: Emission) -> bool {
    emission.visibility == EmitterVisibility::Sampled
}

impl Job<'_> {
    /// Chooses the candidate with the least variance in a few pixels; the scene is prepared for the first. The image does not contain
    /// their paths, so that it is unbiased.
    pub(super) fn choose(&mut self, candidates: &[(Sampling, MapSampling)]) -> Result<()> {
        if candidates.len() < 2 {
            return Ok(());
        }
        let mut least = self.variance_of_trial();
        for &candidate in &candidates[1..] {
            let settings = self.settings.with(candidate);
            // Candidates of one density share its table.
            let table = match settings.density == self.settings.density {
                true => None,
                false => EnvironmentSampling::new(self.scene.scene, &settings, &self.scene.needs)?,
            };
            let before = table.map(|table| self.scene.environment.replace(table));
            self.scene.sampling = settings.sampling;
            let variance = self.variance_of_trial();
            if variance < least {
                (least, self.settings) = (variance, settings);
            } else if let Some(before) = before {
                self.scene.environment = before;
            }
        }
        self.scene.sampling = self.settings.sampling;
        Ok(())
    }

    /// The sum of the variances of pixels on a grid over the image, from a few samples each.
    fn variance_of_trial(&self) -> f64 {
        let Request { width, height, .. } = self.scene.request;
        let [column, row] = [width.div_ceil(TRIAL_GRID[0]), height.div_ceil(TRIAL_GRID[1])];
        let of_row = |y: usize| {
            let left = |x: usize, n: u32| if x % column == column / 2 { n..TRIAL } else { 0..0 };
            let variances = self.variances(y, &left, Pass::Trial, &Silent);
            variances.into_iter().skip(column / 2).step_by(column).map(f64::from).sum::<f64>()
        };
        let rows: Vec<usize> = (row / 2..height).step_by(row).collect();
        rows.into_par_iter().map(of_row).collect::<Vec<_>>().into_iter().sum()
    }
}
