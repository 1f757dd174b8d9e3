//! The first report's way of sampling a map, kept apart so that it can be shown and rejected.
//!
//! Row h of H gets the weight sin(hπ/(H−1)), which is 0 at both poles, so the first and the last row are never drawn
//! whatever shines there; and the sample is the texel's top left corner, half a texel off and one of finitely many
//! directions. On the built-in `nave` the pole rows' energy is lost and every other weight is off by up to 1/(2h+1).

use super::latlong::EnvMap;
use super::sampler::{DirectionSampler, EnvSample};
use crate::sampling::table::Table2;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// Sampler of the first report; not [`super::sampler::Complete`]: it misses the rows at the poles.
#[derive(Debug, Clone)]
pub struct ReportSampler {
    map: Arc<EnvMap>,
    table: Table2,
}

impl ReportSampler {
    #[must_use]
    pub fn new(map: Arc<EnvMap>) -> Self {
        let (width, height) = (map.geometry().width(), map.geometry().height());
        let table = Table2::new(width, height, |x, y| map.mean_rgb(x, y) * row_weight(y, height));
        Self { map, table }
    }

    /// The report's density: the probability over the solid angle that its own row weight implies.
    fn texel_pdf(&self, x: usize, y: usize) -> f64 {
        let (width, height) = (self.map.geometry().width() as f64, self.map.geometry().height());
        let weight = row_weight(y, height);
        if weight == 0.0 {
            return 0.0;
        }
        self.table.probability(x, y) * width * height as f64 / (2.0 * PI * PI * weight)
    }
}

/// sin(hπ/(H−1)), with the exact zero at both ends that the formula means.
fn row_weight(y: usize, height: usize) -> f64 {
    if y == 0 || y + 1 == height { 0.0 } else { (y as f64 * PI / (height - 1) as f64).sin() }
}

impl DirectionSampler for ReportSampler {
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample> {
        let draw = self.table.draw(u)?;
        let (x, y) = (draw.x.cell, draw.y.cell);
        let wi = self.map.geometry().direction(x as f64, y as f64);
        Some(EnvSample { wi, pdf: self.texel_pdf(x, y), radiance: self.map.texel(x, y) })
    }

    fn pdf(&self, wi: DVec3) -> f64 {
        let (x, y) = self.map.geometry().texel(wi);
        self.texel_pdf(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::raster::Image;

    #[test]
    fn pole_rows_are_never_drawn_and_positions_are_corners() {
        let map = Arc::new(EnvMap::new(Image::from_fn(16, 8, |_, y| Rgb::splat(if y == 0 { 1e6 } else { 1.0 }))));
        let sampler = ReportSampler::new(map.clone());
        for i in 0..1000 {
            let s = sampler.sample([(f64::from(i) + 0.5) / 1000.0, (f64::from(i) * 0.618_034).fract()]).unwrap();
            let (x, y) = map.geometry().position(s.wi);
            assert!((0.5..6.5).contains(&y), "the bright zenith is lost");
            assert!((x - x.round()).abs() < 1e-9 && (y - y.round()).abs() < 1e-9);
        }
    }

    #[test]
    fn maps_of_two_rows_have_nothing_to_draw() {
        let map = Arc::new(EnvMap::new(Image::from_fn(4, 2, |_, _| Rgb::ONE)));
        assert_eq!(ReportSampler::new(map).sample([0.5, 0.5]), None);
    }
}
