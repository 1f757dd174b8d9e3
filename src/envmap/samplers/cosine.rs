//! Sampling a map in proportion to radiance × cosine: the directions that light a surface of a given normal.
//!
//! The map is a pyramid of blocks. Each block stores its flux F = ∫ I dω and its first moment M = ∫ I ω dω. The light that
//! it sends to a surface of normal n is exactly n·M if it is wholly above the horizon, 0 if it is wholly below, and close to
//! F r (1 + x)²/4 with x = n·M / (F r) if the horizon cuts it (r the sine of its angular radius; exact if cosines are uniform
//! over ±r). A sample descends from the whole map to a block of the finest level, choosing at each step between two halves
//! twice, and takes a texel of that block by its flux. For a diffuse surface that sees the whole map nearly every sample
//! then has the same weight, the irradiance itself.
//!
//! Its variant for MIS takes what exceeds the map's mean in place of the radiance. Light samples then all go to bright light,
//! and none to light that BSDF samples find well.
//!
//! After Clarberg, Jarosz, Akenine-Möller, Jensen, "Wavelet Importance Sampling", 2005 (hierarchical warping); block
//! moments in place of wavelet products are new here. Compensation: Karlík et al., "MIS Compensation", 2019.

use super::contract::{Entry, EnvSample, Method, SurfaceSampler};
use crate::envmap::{Block, EnvMap};
use crate::sampling::table::inside;
use glam::{DVec3, DVec4, Vec3, Vec4};
use rayon::prelude::*;
use std::sync::Arc;

/// Its entry in the registry.
pub const ENTRY: &Entry = &Entry {
    name: "cosine",
    density: "cosine",
    doc: "radiance times the cosine at the surface",
    has_regions: false,
    complete: true,
    invertible: false,
    bytes_per_texel: 0,
    method: Method::ForNormal(|map, _| Ok(Box::new(CosineSampler::new(map)))),
};

/// The entry in the registry of its variant for MIS.
pub const COMPENSATED: &Entry = &Entry {
    name: "cosine-compensated",
    density: "cosine-compensated",
    doc: "radiance minus its mean, times the cosine at the surface (0 where the map is dimmer: for MIS only)",
    complete: false,
    method: Method::ForNormal(|map, _| Ok(Box::new(CosineSampler::compensated(map)))),
    ..*ENTRY
};

/// The finest level has at most so many blocks; in larger maps they are of several texels.
const FINEST: usize = 1 << 19;

/// Smallest weight of a block on the horizon, as a share of F r, so that no light above the horizon is missed.
const FLOOR: f32 = 1e-3;

/// Most quads of the coarsest level. Larger blocks extend so far around the sphere that their light on a surface is poorly
/// estimated, and samples would be lost below the horizon.
const ROOT: usize = 8;

/// Samples directions for a normal.
#[derive(Debug, Clone)]
pub struct CosineSampler {
    map: Arc<EnvMap>,
    /// Radiance that is left out.
    threshold: f64,
    /// Side of a block of the finest level, in texels.
    side: usize,
    /// The energies of these blocks, if they are of several texels.
    energies: Vec<f64>,
    /// From the coarsest, of at most [`ROOT`] quads, to the finest.
    levels: Vec<Level>,
}

/// The four children of a block, component by component, so that their weights are computed together: upper left, upper right,
/// lower left, lower right. A child beyond the map's edge is dark.
#[derive(Debug, Clone, Copy, Default)]
struct Quad {
    /// First moments of the children, one vector per axis.
    moment: [Vec4; 3],
    flux: Vec4,
}

/// All blocks of one size.
#[derive(Debug, Clone)]
struct Level {
    /// Number of quads in a row.
    width: usize,
    quads: Vec<Quad>,
    /// Cosines and sines of the middle φ of each pair of columns: \[left, right, left, right\].
    columns: Vec<[Vec4; 2]>,
    /// Sines and cosines of the middle θ and sines of the angular radius of each pair of rows:
    /// \[upper, upper, lower, lower\].
    rows: Vec<[Vec4; 3]>,
}

impl Level {
    /// From the blocks' moments and, in w, fluxes, `columns` in a row; each block `side` texels wide and high.
    fn new(map: &EnvMap, side: usize, columns: usize, blocks: &[Vec4]) -> Self {
        let g = map.geometry();
        let rows = blocks.len() / columns;
        let (width, height) = (columns.div_ceil(2), rows.div_ceil(2));
        let mut quads = vec![Quad::default(); width * height];
        for (i, block) in blocks.iter().enumerate() {
            let (x, y) = (i % columns, i / columns);
            let (quad, child) = (&mut quads[y / 2 * width + x / 2], x % 2 + 2 * (y % 2));
            for axis in 0..3 {
                quad.moment[axis][child] = block[axis];
            }
            quad.flux[child] = block.w;
        }
        // Directions and angular radii of the blocks, shared by all of a column or a row.
        let column = |x: usize| {
            let (x0, x1) = (x * side, ((x + 1) * side).min(g.width()));
            (std::f64::consts::PI * (x0 + x1) as f64 / g.width() as f64).sin_cos()
        };
        let row = |y: usize| {
            // The last column may be narrower; the first one's cone is wide enough for all.
            let (y0, y1) = ((y * side).min(g.height() - 1), ((y + 1) * side).min(g.height()));
            let (axis, radius) = g.cone(Block { x0: 0, y0, x1: side.min(g.width()), y1 });
            let r = if radius < std::f64::consts::FRAC_PI_2 { radius.sin() + 1e-6 } else { 2.0 };
            [axis.x.hypot(axis.z), axis.y, r]
        };
        Self {
            width,
            quads,
            columns: (0..width)
                .map(|x| {
                    let [(s0, c0), (s1, c1)] = [column(2 * x), column(2 * x + 1)];
                    [DVec4::new(c0, c1, c0, c1).as_vec4(), DVec4::new(s0, s1, s0, s1).as_vec4()]
                })
                .collect(),
            rows: (0..height)
                .map(|y| {
                    let (upper, lower) = (row(2 * y), row(2 * y + 1));
                    [0, 1, 2].map(|i| DVec4::new(upper[i], upper[i], lower[i], lower[i]).as_vec4())
                })
                .collect(),
        }
    }

    /// Estimates the light that a surface of normal `n` receives from each child; 0 only where it receives none.
    #[inline]
    fn weights(&self, x: usize, y: usize, n: Vec3) -> Vec4 {
        let Quad { moment, flux } = self.quads[y * self.width + x];
        let ([cos_phi, sin_phi], [sin_theta, cos_theta, r]) = (self.columns[x], self.rows[y]);
        // Cosine of the middle direction, light if all of the block is above the horizon, and F r.
        let height = n.y * cos_theta + sin_theta * (n.x * cos_phi + n.z * sin_phi);
        let received = n.x * moment[0] + n.y * moment[1] + n.z * moment[2];
        let reach = flux * r;
        // F r (1 + x)²/4 on the horizon, n·M above it, 0 below it.
        let t = Vec4::ONE + (received / reach.max(Vec4::splat(f32::MIN_POSITIVE))).clamp(Vec4::NEG_ONE, Vec4::ONE);
        let on_horizon = reach * (0.25 * t * t).max(Vec4::splat(FLOOR));
        let weight = Vec4::select(height.cmpge(r), received.max(Vec4::ZERO), on_horizon);
        Vec4::select(height.cmple(-r), Vec4::ZERO, weight)
    }
}

/// Samples an index in proportion to a few weights, and rescales the rest of `u` to \[0, 1). Returns the index and its
/// probability, [`share`]; `None` when all weights are 0.
#[inline]
fn pick(u: &mut f64, weights: &[f64]) -> Option<(usize, f64)> {
    let mut left = *u * weights.iter().sum::<f64>();
    let mut found = None;
    for (i, &w) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
        // Rounding may leave a remainder beyond the last weight; it belongs to that one.
        found = Some(i);
        *u = (left / w).min(1.0f64.next_down());
        if left < w {
            break;
        }
        left -= w;
    }
    found.map(|i| (i, share(weights, i)))
}

/// The probability of index `i`.
#[inline]
fn share(weights: &[f64], i: usize) -> f64 {
    let total: f64 = weights.iter().sum();
    if total > 0.0 { weights[i] / total } else { 0.0 }
}

/// The weights of the coarsest level's quads, and their sums per row of quads.
struct Root {
    width: usize,
    quads: [f64; ROOT],
    rows: [f64; ROOT],
}

impl Root {
    #[inline]
    fn new(level: &Level, n: Vec3) -> Self {
        let mut root = Self { width: level.width, quads: [0.0; ROOT], rows: [0.0; ROOT] };
        for i in 0..level.quads.len() {
            let (x, y) = (i % level.width, i / level.width);
            root.quads[i] = level.weights(x, y, n).as_dvec4().element_sum();
            root.rows[y] += root.quads[i];
        }
        root
    }

    #[inline]
    fn row(&self, y: usize) -> &[f64] {
        &self.quads[y * self.width..(y + 1) * self.width]
    }
}

/// The weights of a quad's upper and lower pair, and those within the pairs.
#[inline]
fn pairs(weights: Vec4) -> ([f64; 2], [[f64; 2]; 2]) {
    let [a, b, c, d] = weights.as_dvec4().to_array();
    ([a + b, c + d], [[a, b], [c, d]])
}

impl CosineSampler {
    /// By radiance × cosine.
    #[must_use]
    pub fn new(map: Arc<EnvMap>) -> Self {
        Self::above(map, 0.0)
    }

    /// By the radiance above the map's mean, × cosine: MIS compensation, as in `compensated.rs`. A constant map has no
    /// samples: those of the BSDF are all that it needs.
    #[must_use]
    pub fn compensated(map: Arc<EnvMap>) -> Self {
        // In a constant map rounding leaves texels slightly above the mean; they do not count.
        let threshold = map.mean() * (1.0 + 1e-6);
        Self::above(map, threshold)
    }

    /// Builds the pyramid of what exceeds a radiance, from the finest level up.
    fn above(map: Arc<EnvMap>, threshold: f64) -> Self {
        let g = map.geometry();
        let mut side = 1;
        while g.width().div_ceil(side) * g.height().div_ceil(side) > FINEST {
            side *= 2;
        }
        let (mut columns, mut blocks) = (g.width().div_ceil(side), finest_blocks(&map, side, threshold));
        let mut levels = vec![Level::new(&map, side, columns, &blocks)];
        let mut block_side = side;
        while levels[levels.len() - 1].quads.len() > ROOT {
            (columns, blocks) = halved(columns, &blocks);
            block_side *= 2;
            levels.push(Level::new(&map, block_side, columns, &blocks));
        }
        levels.reverse();
        let mut sampler = Self { map, threshold, side, energies: Vec::new(), levels };
        if side > 1 {
            sampler.energies = sampler.block_energies();
        }
        sampler
    }

    /// The sums that [`CosineSampler::texels`] has, row by row.
    fn block_energies(&self) -> Vec<f64> {
        let g = self.map.geometry();
        let [columns, rows] = [g.width(), g.height()].map(|texels| texels.div_ceil(self.side));
        let energy = |i: usize| self.texels(i % columns, i / columns).map(|(_, _, energy)| energy).sum();
        (0..columns * rows).into_par_iter().map(energy).collect()
    }

    /// The texels of a block of the finest level, each with its energy.
    fn texels(&self, bx: usize, by: usize) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let g = self.map.geometry();
        let (x0, y0) = (bx * self.side, by * self.side);
        (y0..(y0 + self.side).min(g.height()))
            .flat_map(move |y| (x0..(x0 + self.side).min(g.width())).map(move |x| (x, y, self.energy(x, y))))
    }

    /// Energy of a texel above the threshold.
    #[inline]
    fn energy(&self, x: usize, y: usize) -> f64 {
        (self.map.mean_rgb(x, y) - self.threshold).max(0.0) * self.map.geometry().solid_angle(y)
    }
}

impl SurfaceSampler for CosineSampler {
    fn sample_for(&self, u: [f64; 2], normal: DVec3) -> Option<EnvSample> {
        let n = normal.as_vec3();
        let [mut u, mut v] = u;
        // Sample a quad of the coarsest level.
        let root = Root::new(&self.levels[0], n);
        let (mut y, row_probability) = pick(&mut v, &root.rows)?;
        let (mut x, quad_probability) = pick(&mut u, root.row(y))?;
        let mut probability = row_probability * quad_probability;
        // Descend: at each level choose between upper and lower pair, then between left and right.
        for level in &self.levels {
            let (vertical, horizontal) = pairs(level.weights(x, y, n));
            let (lower, p_vertical) = pick(&mut v, &vertical)?;
            let (right, p_horizontal) = pick(&mut u, &horizontal[lower])?;
            probability *= p_vertical * p_horizontal;
            (x, y) = (2 * x + right, 2 * y + lower);
        }
        // Sample a texel of the block by its energy.
        if self.side > 1 {
            let energies: Vec<f64> = self.texels(x, y).map(|(_, _, energy)| energy).collect();
            let (i, p) = pick(&mut u, &energies)?;
            probability *= p;
            (x, y, _) = self.texels(x, y).nth(i)?;
        }
        let g = self.map.geometry();
        let wi = g.direction_in_texel(x, y, inside(u), inside(v));
        Some(EnvSample { wi, pdf: probability / g.solid_angle(y), radiance: self.map.texel(x, y) })
    }

    fn pdf_for(&self, wi: DVec3, normal: DVec3) -> f64 {
        let n = normal.as_vec3();
        let g = self.map.geometry();
        let (tx, ty) = g.texel(wi);
        if self.energy(tx, ty) <= 0.0 {
            return 0.0;
        }
        let (bx, by) = (tx / self.side, ty / self.side);
        // The product of the probabilities of the choices that lead to the texel.
        let root = Root::new(&self.levels[0], n);
        let (x, y) = (bx >> self.levels.len(), by >> self.levels.len());
        let mut probability = share(&root.rows, y) * share(root.row(y), x);
        for (i, level) in self.levels.iter().enumerate() {
            let finer = self.levels.len() - 1 - i;
            let (x, y) = (bx >> finer, by >> finer);
            let (vertical, horizontal) = pairs(level.weights(x / 2, y / 2, n));
            probability *= share(&vertical, y % 2) * share(&horizontal[y % 2], x % 2);
        }
        if self.side > 1 {
            let total = self.energies[by * g.width().div_ceil(self.side) + bx];
            probability *= self.energy(tx, ty) / total;
        }
        probability / g.solid_angle(ty)
    }
}

/// Sums blocks two by two in both directions; the new number of columns and the blocks.
fn halved(columns: usize, blocks: &[Vec4]) -> (usize, Vec<Vec4>) {
    let (width, height) = (columns.div_ceil(2), (blocks.len() / columns).div_ceil(2));
    let mut sums = vec![Vec4::ZERO; width * height];
    for (i, block) in blocks.iter().enumerate() {
        sums[i / columns / 2 * width + i % columns / 2] += *block;
    }
    (width, sums)
}

/// Moments and fluxes of the blocks of the finest level.
fn finest_blocks(map: &EnvMap, side: usize, threshold: f64) -> Vec<Vec4> {
    let g = map.geometry();
    let columns = g.width().div_ceil(side);
    let mut blocks = vec![Vec4::ZERO; columns * g.height().div_ceil(side)];
    blocks.par_chunks_mut(columns).enumerate().for_each(|(by, row)| {
        for y in by * side..((by + 1) * side).min(g.height()) {
            for x in 0..g.width() {
                let radiance = (map.mean_rgb(x, y) - threshold).max(0.0);
                let moment = g.moment(x, y) * radiance;
                row[x / side] += moment.as_vec3().extend((radiance * g.solid_angle(y)) as f32);
            }
        }
    });
    blocks
}

#[cfg(test)]
mod tests;
