//! Radiance by inversion with given [`Conventions`], to show and test those of the first report.
//!
//! It is not in the registry: with the report's conventions it is wrong, with the correct ones slower than `cdf`.

use super::contract::{EnvSample, SurfaceSampler};
use crate::envmap::EnvMap;
use crate::errata::{Conventions, maps};
use crate::sampling::table::Table2;
use glam::DVec3;
use std::sync::Arc;

/// A row by the marginal distribution, a texel of it, and a direction in the texel. Under
/// [`Conventions::rows_without_poles`] the rows at the poles are missed.
#[derive(Debug, Clone)]
pub struct ErrataSampler {
    map: Arc<EnvMap>,
    table: Table2,
    conventions: Conventions,
}

impl ErrataSampler {
    /// The tables of a map.
    #[must_use]
    pub fn new(map: Arc<EnvMap>, conventions: Conventions) -> Self {
        let (width, height) = (map.geometry().width(), map.geometry().height());
        let weight = |x: usize, y: usize| {
            if conventions.rows_without_poles {
                map.mean_rgb(x, y) * maps::row_weight(y, height)
            } else {
                map.energy(x, y)
            }
        };
        let table = Table2::new(width, height, weight);
        Self { map, table, conventions }
    }

    /// The pdf per solid angle, as the conventions compute it.
    fn texel_pdf(&self, x: usize, y: usize) -> f64 {
        let (probability, g) = (self.table.probability(x, y), self.map.geometry());
        if self.conventions.rows_without_poles {
            maps::texel_pdf(probability, maps::row_weight(y, g.height()), [g.width(), g.height()])
        } else {
            probability * g.inverse_solid_angle(y)
        }
    }
}

impl SurfaceSampler for ErrataSampler {
    fn sample_for(&self, u: [f64; 2], _normal: DVec3) -> Option<EnvSample> {
        let at = self.table.sample(u)?;
        let (x, y) = (at.x.cell, at.y.cell);
        let wi = if self.conventions.texel_corners {
            let [fx, fy] = maps::PLACE_IN_TEXEL;
            self.map.geometry().direction(x as f64 + fx, y as f64 + fy)
        } else {
            self.map.geometry().direction_in_texel(x, y, at.x.offset, at.y.offset)
        };
        Some(EnvSample { wi, pdf: self.texel_pdf(x, y), radiance: self.map.texel(x, y) })
    }

    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn has_samples(&self) -> bool {
        self.table.total() > 0.0
    }

    fn pdf_in_texel(&self, (x, y): (usize, usize), _normal: DVec3) -> f64 {
        self.texel_pdf(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envmap::samplers::TexelSampler;
    use crate::math::Rgb;
    use crate::raster::Image;

    #[test]
    fn pole_rows_are_never_sampled_and_positions_are_corners() {
        let map = Arc::new(EnvMap::new(Image::from_fn(16, 8, |_, y| Rgb::splat(if y == 0 { 1e6 } else { 1.0 }))));
        let sampler = ErrataSampler::new(map.clone(), Conventions::FIRST_REPORT);
        for i in 0..1000 {
            let s = sampler
                .sample_for([(f64::from(i) + 0.5) / 1000.0, (f64::from(i) * 0.618_034).fract()], DVec3::Y)
                .unwrap();
            let (x, y) = map.geometry().position(s.wi);
            assert!((0.5..6.5).contains(&y), "the bright zenith is lost");
            assert!((x - x.round()).abs() < 1e-9 && (y - y.round()).abs() < 1e-9);
        }
    }

    #[test]
    fn maps_of_two_rows_have_no_samples() {
        let map = Arc::new(EnvMap::new(Image::from_fn(4, 2, |_, _| Rgb::ONE)));
        assert_eq!(ErrataSampler::new(map, Conventions::FIRST_REPORT).sample_for([0.5, 0.5], DVec3::Y), None);
    }

    #[test]
    fn correct_conventions_are_the_texel_sampler() {
        let map = Arc::new(EnvMap::new(Image::from_fn(16, 8, |x, y| Rgb::splat((x * y) as f32))));
        let (by, right) = (ErrataSampler::new(map.clone(), Conventions::CORRECT), TexelSampler::new(map));
        for i in 0..1000 {
            let u = [(f64::from(i) + 0.5) / 1000.0, (f64::from(i) * 0.618_034).fract()];
            assert_eq!(by.sample_for(u, DVec3::Y), right.sample_for(u, DVec3::Y));
        }
    }
}
