//! Radiance by inversion as in the first report: its weights of rows, and corners for directions.
//!
//! It is wrong, so that it is not in the registry of the samplers that render.

use super::contract::{EnvSample, SurfaceSampler};
use crate::envmap::EnvMap;
use crate::errata::images;
use crate::sampling::table::Table2;
use glam::DVec3;
use std::sync::Arc;

/// A row by [`images::row_weight`], which misses those at the poles, a texel of it, and the direction of the texel's corner.
#[derive(Debug, Clone)]
pub struct ErrataSampler {
    map: Arc<EnvMap>,
    table: Table2,
}

impl ErrataSampler {
    pub fn new(map: Arc<EnvMap>) -> Self {
        let (width, height) = (map.geometry().width(), map.geometry().height());
        let table = Table2::new(width, height, |x, y| map.mean_rgb(x, y) * images::row_weight(y, height));
        Self { map, table }
    }

    /// The pdf per solid angle, as the report computes it.
    fn texel_pdf(&self, x: usize, y: usize) -> f64 {
        let (probability, g) = (self.table.probability(x, y), self.map.geometry());
        images::texel_pdf(probability, images::row_weight(y, g.height()), [g.width(), g.height()])
    }
}

impl SurfaceSampler for ErrataSampler {
    fn sample_for(&self, u: [f64; 2], _normal: DVec3) -> Option<EnvSample> {
        let at = self.table.sample(u)?;
        let (x, y) = (at.x.cell, at.y.cell);
        let [fx, fy] = images::PLACE_IN_TEXEL;
        let wi = self.map.geometry().direction(x as f64 + fx, y as f64 + fy);
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
    use crate::math::Rgb;
    use crate::raster::Image;

    #[test]
    fn pole_rows_are_never_sampled_and_positions_are_corners() {
        let map = Arc::new(EnvMap::new(Image::from_fn(16, 8, |_, y| Rgb::splat(if y == 0 { 1e6 } else { 1.0 }))));
        let sampler = ErrataSampler::new(map.clone());
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
        assert_eq!(ErrataSampler::new(map).sample_for([0.5, 0.5], DVec3::Y), None);
    }
}
