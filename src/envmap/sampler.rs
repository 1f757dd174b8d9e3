//! Importance sampling of a map: directions drawn in proportion to radiance, with the density per solid angle.

use super::batch::{self, Batched, EnvSamples};
use super::latlong::EnvMap;
use crate::math::Rgb;
use crate::sampling::alias::AliasTable;
use crate::sampling::batch::Batch;
use crate::sampling::table::Table2;
use glam::DVec3;
use std::sync::Arc;

/// A direction drawn from a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvSample {
    /// Unit direction towards the light.
    pub wi: DVec3,
    /// Density per solid angle: the value that the sampler's `pdf(wi)` returns, to the last bit.
    pub pdf: f64,
    /// The map's radiance from there.
    pub radiance: Rgb,
}

/// Draws directions towards a map's light.
pub trait DirectionSampler: Send + Sync {
    /// The direction for `u` in \[0, 1)²; `None` when the map is black.
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample>;

    /// Replaces `out` by the samples for all of `u`, which are none when the map is black.
    fn sample_many(&self, u: &[[f64; 2]], out: &mut EnvSamples) {
        out.clear();
        u.iter().filter_map(|&u| self.sample(u)).for_each(|s| out.push(s));
    }

    /// Density of [`DirectionSampler::sample`] per solid angle.
    fn pdf(&self, wi: DVec3) -> f64;
}

/// Draws directions towards the light that falls on a surface, whose normal it may take into account.
pub trait SurfaceSampler: Send + Sync {
    /// The direction for `u` in \[0, 1)² and a unit normal in the map's frame; `None` when nothing was drawn.
    fn sample_for(&self, u: [f64; 2], normal: DVec3) -> Option<EnvSample>;

    /// Density of [`SurfaceSampler::sample_for`] per solid angle.
    fn pdf_for(&self, wi: DVec3, normal: DVec3) -> f64;
}

impl<T: DirectionSampler> SurfaceSampler for T {
    #[inline]
    fn sample_for(&self, u: [f64; 2], _normal: DVec3) -> Option<EnvSample> {
        self.sample(u)
    }

    #[inline]
    fn pdf_for(&self, wi: DVec3, _normal: DVec3) -> f64 {
        self.pdf(wi)
    }
}

/// A sampler whose density is positive wherever the surface receives light, so that it may be used alone.
pub trait Complete: SurfaceSampler {}

/// The report's scheme done exactly: the row by the marginal table, the column by the row's own, a uniform position
/// inside the texel. Monotone in both numbers, hence invertible and safe for stratified ones.
#[derive(Debug, Clone)]
pub struct CdfSampler {
    map: Arc<EnvMap>,
    table: Table2,
}

impl CdfSampler {
    #[must_use]
    pub fn new(map: Arc<EnvMap>) -> Self {
        let m = &map;
        let table = Table2::new(m.geometry().width(), m.geometry().height(), |x, y| m.energy(x, y));
        Self { map, table }
    }

    #[inline]
    fn texel_pdf(&self, x: usize, y: usize) -> f64 {
        self.table.probability(x, y) * self.map.geometry().inverse_solid_angle(y)
    }

    /// The `u` that [`DirectionSampler::sample`] maps to `wi`.
    #[must_use]
    pub fn invert(&self, wi: DVec3) -> [f64; 2] {
        let (x, y, fx, fy) = self.map.geometry().texel_position(wi);
        self.table.invert((x, y), (fx, fy))
    }
}

impl Batched for CdfSampler {
    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn total(&self) -> f64 {
        self.table.total()
    }

    #[inline(always)]
    fn draw_batch(&self, u: &[[f64; 2]], draws: &mut Batch) {
        self.table.draw_batch(u, self.map.image().pixels(), draws);
    }
}

impl DirectionSampler for CdfSampler {
    #[inline]
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample> {
        let draw = self.table.draw(u)?;
        let (x, y) = (draw.x.cell, draw.y.cell);
        let g = self.map.geometry();
        let wi = g.direction_in_texel(x, y, draw.x.offset, draw.y.offset);
        Some(EnvSample { wi, pdf: draw.probability() * g.inverse_solid_angle(y), radiance: self.map.texel(x, y) })
    }

    fn sample_many(&self, u: &[[f64; 2]], out: &mut EnvSamples) {
        batch::fill(self, u, out);
    }

    #[inline]
    fn pdf(&self, wi: DVec3) -> f64 {
        let (x, y) = self.map.geometry().texel(wi);
        self.texel_pdf(x, y)
    }
}

impl Complete for CdfSampler {}

/// The same density through one alias table over all texels: constant time, but not monotone.
#[derive(Debug, Clone)]
pub struct AliasSampler {
    map: Arc<EnvMap>,
    table: AliasTable,
}

impl AliasSampler {
    #[must_use]
    pub fn new(map: Arc<EnvMap>) -> Self {
        let width = map.geometry().width();
        let table = AliasTable::from_fn(map.image().pixels().len(), |i| map.energy(i % width, i / width));
        Self { map, table }
    }

    #[inline]
    fn texel_pdf(&self, x: usize, y: usize) -> f64 {
        let g = self.map.geometry();
        self.table.probability(y * g.width() + x) * g.inverse_solid_angle(y)
    }
}

impl Batched for AliasSampler {
    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn total(&self) -> f64 {
        self.table.total()
    }

    #[inline(always)]
    fn draw_batch(&self, u: &[[f64; 2]], draws: &mut Batch) {
        self.table.draw_batch(u, self.map.geometry().width(), self.map.image().pixels(), draws);
    }
}

impl DirectionSampler for AliasSampler {
    #[inline]
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample> {
        let draw = self.table.draw(u[0])?;
        let g = self.map.geometry();
        let (x, y) = (draw.cell % g.width(), draw.cell / g.width());
        let wi = g.direction_in_texel(x, y, draw.offset, u[1].clamp(1e-9, 1.0 - 1e-9));
        Some(EnvSample { wi, pdf: self.texel_pdf(x, y), radiance: self.map.texel(x, y) })
    }

    fn sample_many(&self, u: &[[f64; 2]], out: &mut EnvSamples) {
        batch::fill(self, u, out);
    }

    #[inline]
    fn pdf(&self, wi: DVec3) -> f64 {
        let (x, y) = self.map.geometry().texel(wi);
        self.texel_pdf(x, y)
    }
}

impl Complete for AliasSampler {}

/// MIS compensation: the density with its solid-angle mean taken away, which leaves to BSDF sampling what BSDF
/// sampling does well. It is 0 where the map is dimmer than its mean, so it is *not* [`Complete`].
///
/// Source: Karlík et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling", 2019.
#[derive(Debug, Clone)]
pub struct CompensatedSampler(CdfSampler);

impl CompensatedSampler {
    /// A map without contrast, whose compensated density would vanish, keeps its plain one.
    #[must_use]
    pub fn new(map: Arc<EnvMap>) -> Self {
        let g = map.geometry();
        let (width, height) = (g.width(), g.height());
        let row_sum = |y: usize| (0..width).map(|x| map.mean_rgb(x, y)).sum::<f64>() * g.solid_angle(y);
        let mean = (0..height).map(row_sum).sum::<f64>() / (4.0 * std::f64::consts::PI);
        // Rounding leaves crumbs of a constant map above its mean; they are no contrast.
        let floor = mean * (1.0 + 1e-6);
        let table = Table2::new(width, height, |x, y| {
            let above = map.mean_rgb(x, y) - mean;
            if map.mean_rgb(x, y) > floor { above * g.solid_angle(y) } else { 0.0 }
        });
        if table.total() > 0.0 { Self(CdfSampler { map, table }) } else { Self(CdfSampler::new(map)) }
    }
}

impl DirectionSampler for CompensatedSampler {
    #[inline]
    fn sample(&self, u: [f64; 2]) -> Option<EnvSample> {
        self.0.sample(u)
    }

    fn sample_many(&self, u: &[[f64; 2]], out: &mut EnvSamples) {
        self.0.sample_many(u, out);
    }

    #[inline]
    fn pdf(&self, wi: DVec3) -> f64 {
        self.0.pdf(wi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::Image;

    /// A map with dark texels, strong contrast and every size of trouble.
    fn maps() -> Vec<Arc<EnvMap>> {
        let value = |x: usize, y: usize| match (x * 7 + y * 13) % 5 {
            0 => Rgb::ZERO,
            4 if x == 1 => Rgb::splat(1e5),
            k => Rgb::new(k as f32, 0.5, 0.1),
        };
        [(1, 1), (2, 1), (3, 2), (10, 10), (64, 32)]
            .map(|(w, h)| Arc::new(EnvMap::new(Image::from_fn(w, h, |x, y| value(x + usize::from(w == 1), y)))))
            .into()
    }

    fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
        (0..n * n).map(move |i| [(f64::from(i % n) + 0.5) / f64::from(n), (f64::from(i / n) + 0.5) / f64::from(n)])
    }

    #[test]
    fn samples_carry_the_pdf_of_their_direction_to_the_last_bit() {
        for map in maps() {
            let samplers: [Box<dyn DirectionSampler>; 3] = [
                Box::new(CdfSampler::new(map.clone())),
                Box::new(AliasSampler::new(map.clone())),
                Box::new(CompensatedSampler::new(map.clone())),
            ];
            for sampler in &samplers {
                for u in grid(60).chain([[0.0, 0.0], [1.0f64.next_down(); 2]]) {
                    let s = sampler.sample(u).unwrap();
                    assert_eq!(s.pdf.to_bits(), sampler.pdf(s.wi).to_bits());
                    assert!(s.pdf > 0.0 && s.pdf.is_finite());
                    assert_eq!(s.radiance, map.radiance(s.wi));
                }
            }
        }
    }

    #[test]
    fn many_samples_are_the_single_ones_to_the_last_bit() {
        for map in maps() {
            let samplers: [Box<dyn DirectionSampler>; 3] = [
                Box::new(CdfSampler::new(map.clone())),
                Box::new(AliasSampler::new(map.clone())),
                Box::new(CompensatedSampler::new(map.clone())),
            ];
            let numbers: Vec<[f64; 2]> = grid(60).chain([[0.0, 0.0], [1.0f64.next_down(); 2]]).collect();
            let mut out = EnvSamples::default();
            for sampler in &samplers {
                for n in [1, 7, 64, 65, numbers.len()] {
                    sampler.sample_many(&numbers[..n], &mut out);
                    let singly: Vec<EnvSample> = numbers[..n].iter().filter_map(|&u| sampler.sample(u)).collect();
                    assert_eq!(out.iter().collect::<Vec<_>>(), singly);
                }
            }
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        for map in maps() {
            let samplers: [Box<dyn DirectionSampler>; 3] = [
                Box::new(CdfSampler::new(map.clone())),
                Box::new(AliasSampler::new(map.clone())),
                Box::new(CompensatedSampler::new(map.clone())),
            ];
            let g = map.geometry();
            for (i, sampler) in samplers.iter().enumerate() {
                let mut mass = 0.0;
                for y in 0..g.height() {
                    for x in 0..g.width() {
                        mass += sampler.pdf(g.direction_in_texel(x, y, 0.5, 0.5)) * g.solid_angle(y);
                    }
                }
                assert!((mass - 1.0).abs() < 1e-12, "sampler {i}: {mass}");
            }
        }
    }

    #[test]
    fn sampling_can_be_inverted() {
        for map in maps() {
            let sampler = CdfSampler::new(map);
            for u in grid(40) {
                let back = sampler.invert(sampler.sample(u).unwrap().wi);
                assert!((back[0] - u[0]).abs() < 1e-8 && (back[1] - u[1]).abs() < 1e-8, "{u:?} came back {back:?}");
            }
        }
    }

    #[test]
    fn a_black_map_emits_nothing() {
        let map = Arc::new(EnvMap::new(Image::new(4, 2)));
        assert_eq!(CdfSampler::new(map.clone()).sample([0.5, 0.5]), None);
        assert_eq!(AliasSampler::new(map.clone()).sample([0.5, 0.5]), None);
        let compensated = CompensatedSampler::new(map);
        assert_eq!(compensated.sample([0.5, 0.5]), None);
        assert_eq!(compensated.pdf(DVec3::X), 0.0);
        let mut out = EnvSamples::default();
        out.push(EnvSample { wi: DVec3::X, pdf: 1.0, radiance: Rgb::ONE });
        compensated.sample_many(&[[0.5, 0.5]], &mut out);
        assert!(out.is_empty());
    }

    #[test]
    fn a_constant_map_is_sampled_all_over() {
        let map = Arc::new(EnvMap::new(Image::from_fn(32, 16, |_, _| Rgb::ONE)));
        for sampler in [&CdfSampler::new(map.clone()) as &dyn DirectionSampler, &CompensatedSampler::new(map.clone())] {
            for u in grid(20) {
                let s = sampler.sample(u).unwrap();
                assert!((s.pdf * 4.0 * std::f64::consts::PI - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn compensation_leaves_the_dim_part_to_the_bsdf() {
        let map = Arc::new(EnvMap::new(Image::from_fn(8, 4, |x, _| Rgb::splat(if x == 3 { 10.0 } else { 1.0 }))));
        let (plain, compensated) = (CdfSampler::new(map.clone()), CompensatedSampler::new(map.clone()));
        let dim = map.geometry().direction_in_texel(0, 1, 0.5, 0.5);
        assert!(plain.pdf(dim) > 0.0);
        assert_eq!(compensated.pdf(dim), 0.0);
    }
}
