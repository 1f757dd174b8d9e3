//! Sampling a map approximately in proportion to radiance × cosine: the directions that light a surface of a given normal.
//!
//! The map is cut into blocks of texels, the sphere of normals into cells. For each cell there is a table of all blocks, for
//! each block a table of its texels by their energies: a sample takes two look-ups, one in each.
//!
//! A table of blocks is by √E(cos²₊) × flux, with the mean of the squared clamped cosine over the block's light and the
//! cell's normals: of all pdfs that know no more than the block and the cell, this has the least variance. The mean takes
//! cosines to be uniform over an interval around their mean, as wide as their variance says. Mean and variance follow from
//! first moments: the light of flux F = ∫ I dω and first moment M = ∫ I ω dω has the mean direction m = M / F, and deviates from it
//! by (1 − |m|²)/2 along each tangent; the normals of a cell likewise.
//!
//! Its variants for MIS take what exceeds the map's mean, or half of it, in place of the radiance. Light samples then all go to bright
//! light, and none to light that BSDF samples find well. The pdf is 0 where the map is dimmer, so that it must be combined with another
//! strategy. Half the mean is right where a diffuse surface sees all of a map whose light comes from everywhere: one half of the samples
//! by max(0, 2 L/L̄ − 1) cos θ and the other by cos θ are together in proportion to L cos θ where L exceeds half the mean L̄. Where bright
//! light is occluded, the mean of what remains is lower, and BSDF samples find it well: the whole mean is better.
//!
//! After Clarberg, Jarosz, Akenine-Möller, Jensen, "Wavelet Importance Sampling", 2005 (products of the map and the cosine by
//! normal). Compensation: Karlík et al., "MIS Compensation: Optimizing Sampling Techniques in Multiple Importance Sampling", 2019.

use super::contract::{BATCH, Entry, EnvSample, Method, SurfaceSampler};
use crate::envmap::{Block, EnvMap};
use crate::sampling::prefetch;
use crate::sampling::table::{CellSample, ShortTables};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

pub const ENTRY: &Entry = &Entry {
    name: "cosine",
    density: "cosine",
    doc: "radiance times the cosine at the surface",
    complete: true,
    invertible: false,
    bytes_per_texel: ShortTables::BYTES,
    method: Method::ForNormal(|map| Box::new(CosineSampler::new(map))),
};

/// The entry in the registry of its variant for MIS.
pub const COMPENSATED: &Entry = &Entry {
    name: "cosine-compensated",
    density: "cosine-compensated",
    doc: "radiance minus its mean, times the cosine at the surface (0 where the map is dimmer: for MIS only)",
    complete: false,
    method: Method::ForNormal(|map| Box::new(CosineSampler::compensated(map))),
    ..*ENTRY
};

/// Most columns and rows of blocks.
const BLOCKS: [usize; 2] = [64, 32];

/// Cells along each side of the square that normals are mapped to; odd, so that axes are in the middle of cells.
const CELLS: usize = 23;

/// Smallest weight of a block that may be above the horizon, as a share of its flux, so that none of its light is missed.
const FLOOR: f32 = 1e-3;

/// Samples directions for a normal.
#[derive(Debug, Clone)]
pub struct CosineSampler {
    map: Arc<EnvMap>,
    /// For each cell, the blocks.
    blocks: Grids,
    /// For each block, its texels.
    texels: Grids,
    has_light: bool,
}

/// What is known of the light of a block, or of the normals of a cell.
struct Spread {
    /// First moment over flux.
    mean: DVec3,
    /// Mean of the squared deviation from it along a tangent.
    variance: f64,
    /// The middle of all directions, light or not.
    axis: DVec3,
    /// Cosine and sine of the largest angle to it.
    reach: [f64; 2],
}

impl Spread {
    fn new((axis, angle): (DVec3, f64), moment: DVec3, flux: f64) -> Self {
        let mean = moment / flux.max(f64::MIN_POSITIVE);
        Self { mean, variance: 0.5 * (1.0 - mean.length_squared()).max(0.0), axis, reach: [angle.cos(), angle.sin()] }
    }
}

/// The light of all blocks, component by component.
struct Lights {
    /// x, y and z of [`Spread::mean`] and [`Spread::axis`].
    mean: [Vec<f32>; 3],
    axis: [Vec<f32>; 3],
    variance: Vec<f32>,
    /// Cosine and sine.
    reach: [Vec<f32>; 2],
    flux: Vec<f64>,
}

impl Lights {
    fn new(lights: &[(Spread, f64)]) -> Self {
        let of =
            |component: &dyn Fn(&Spread) -> f64| lights.iter().map(|(spread, _)| component(spread) as f32).collect();
        Self {
            mean: [0, 1, 2].map(|i| of(&|spread| spread.mean[i])),
            axis: [0, 1, 2].map(|i| of(&|spread| spread.axis[i])),
            variance: of(&|spread| spread.variance),
            reach: [0, 1].map(|i| of(&|spread| spread.reach[i])),
            flux: lights.iter().map(|(_, flux)| *flux).collect(),
        }
    }
}

/// The weights of a row of blocks for the normals of a cell: flux times the root of the mean squared clamped cosine, at least
/// [`FLOOR`] where any cosine may be positive.
struct Weights<'a> {
    lights: &'a Lights,
    blocks: Range<usize>,
    normals: &'a Spread,
    out: &'a mut [f64],
}

impl pulp::WithSimd for Weights<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<Simd: pulp::Simd>(self, _: Simd) {
        let Self { lights, blocks, normals: n, out } = self;
        let [mx, my, mz] = lights.mean.each_ref().map(|values| &values[blocks.clone()]);
        let [ax, ay, az] = lights.axis.each_ref().map(|values| &values[blocks.clone()]);
        let [cos, sin] = lights.reach.each_ref().map(|values| &values[blocks.clone()]);
        let (variance, flux) = (&lights.variance[blocks.clone()], &lights.flux[blocks.clone()]);
        let (n_mean, n_axis, n_variance) = (n.mean.as_vec3(), n.axis.as_vec3(), n.variance as f32);
        let [n_cos, n_sin] = n.reach.map(|value| value as f32);
        for i in 0..out.len() {
            // No cosine is positive where the axes are farther apart than a quarter turn and both angles, by more than is rounded.
            let apart = -(sin[i] * n_cos + cos[i] * n_sin) - 1e-5;
            let below =
                (cos[i] * n_cos > sin[i] * n_sin) & (ax[i] * n_axis.x + ay[i] * n_axis.y + az[i] * n_axis.z < apart);
            // Uniform over mean ± half, where deviations from the mean direction count by the sine.
            let mean = mx[i] * n_mean.x + my[i] * n_mean.y + mz[i] * n_mean.z;
            let half = (3.0 * (1.0 - mean * mean).max(0.0) * (variance[i] + n_variance)).sqrt().max(1e-3);
            let [low, high] = [(mean - half).max(0.0), (mean + half).max(0.0)];
            let mean_square = (high * high * high - low * low * low) / (6.0 * half);
            out[i] = flux[i] * f64::from(if below { 0.0 } else { mean_square.sqrt().max(FLOOR) });
        }
    }
}

/// Distributions over grids of one size, each by rows, then by columns of the row.
#[derive(Debug, Clone)]
struct Grids {
    /// Columns and rows.
    size: [usize; 2],
    rows: ShortTables,
    columns: ShortTables,
}

impl Grids {
    /// From weights by row, written by `weights(y, grid, row)`.
    fn new(size: [usize; 2], count: usize, weights: impl Fn(usize, usize, &mut [f64]) + Sync) -> Self {
        let [width, height] = size;
        let of_row = |row: usize, out: &mut [f64]| weights(row % height, row / height, out);
        let (columns, sums) = ShortTables::new(width, height * count, of_row);
        let (rows, _) =
            ShortTables::new(height, count, |grid, out| out.copy_from_slice(&sums[grid * height..][..height]));
        Self { size, rows, columns }
    }

    #[inline(always)]
    fn row(&self, grid: usize, v: f64) -> CellSample {
        self.rows.sample(grid, v)
    }

    #[inline(always)]
    fn column(&self, grid: usize, row: usize, u: f64) -> CellSample {
        self.columns.sample(grid * self.size[1] + row, u)
    }

    #[inline]
    fn probability(&self, grid: usize, [x, y]: [usize; 2]) -> f64 {
        self.rows.probability(grid, y) * self.columns.probability(grid * self.size[1] + y, x)
    }
}

impl CosineSampler {
    /// By radiance × cosine.
    pub fn new(map: Arc<EnvMap>) -> Self {
        Self::above(map, 0.0)
    }

    /// By the radiance above the map's mean, × cosine: MIS compensation. A map that is nowhere brighter has no samples: those of
    /// the BSDF are all that it needs.
    pub fn compensated(map: Arc<EnvMap>) -> Self {
        // In a constant map rounding leaves texels slightly above the mean; they do not count.
        let threshold = map.mean() * (1.0 + 1e-6);
        Self::above(map, threshold)
    }

    /// Builds the tables of what exceeds a radiance.
    fn above(map: Arc<EnvMap>, threshold: f64) -> Self {
        let g = map.geometry();
        let [width, height] = [g.width(), g.height()];
        let side = [width.div_ceil(BLOCKS[0]), height.div_ceil(BLOCKS[1])];
        let [columns, rows] = [width.div_ceil(side[0]), height.div_ceil(side[1])];
        let excess = |x: usize, y: usize| (map.mean_rgb(x, y) - threshold).max(0.0);
        // Sum flux and first moment of each block.
        let axes: Vec<[f64; 2]> = (0..width).map(|x| g.column_axis(x)).collect();
        let light = |i: usize| {
            let (x0, y0) = (i % columns * side[0], i / columns * side[1]);
            let block = Block { x0, y0, x1: (x0 + side[0]).min(width), y1: (y0 + side[1]).min(height) };
            let (mut moment, mut flux) = (DVec3::ZERO, 0.0);
            for y in y0..block.y1 {
                let [mut sum, mut cos, mut sin] = [0.0; 3];
                for (x, [cos_phi, sin_phi]) in (x0..).zip(&axes[x0..block.x1]) {
                    let radiance = excess(x, y);
                    sum += radiance;
                    cos += radiance * cos_phi;
                    sin += radiance * sin_phi;
                }
                let [across, along] = g.row_moment(y);
                moment += DVec3::new(across * cos, along * sum, across * sin);
                flux += sum * g.solid_angle(y);
            }
            (Spread::new(g.cone(block), moment, flux), flux)
        };
        let blocks: Vec<(Spread, f64)> = (0..columns * rows).into_par_iter().map(light).collect();
        let lights = Lights::new(&blocks);
        // The table of each cell's blocks, and of each block's texels.
        let normals: Vec<Spread> = (0..CELLS * CELLS).map(normals_of_cell).collect();
        let arch = pulp::Arch::new();
        let of_row = |y: usize, cell: usize, out: &mut [f64]| {
            let blocks = y * columns..(y + 1) * columns;
            match normals.get(cell) {
                Some(normals) => arch.dispatch(Weights { lights: &lights, blocks, normals, out }),
                None => out.copy_from_slice(&lights.flux[blocks]),
            }
        };
        let of_cells = Grids::new([columns, rows], normals.len() + 1, of_row);
        let texels = Grids::new(side, blocks.len(), |row, block, out| {
            let (x, y) = (block % columns * side[0], block / columns * side[1] + row);
            out.fill(0.0);
            if y < height {
                out.iter_mut().zip(x..width).for_each(|(weight, x)| *weight = excess(x, y) * g.solid_angle(y));
            }
        });
        let has_light = lights.flux.iter().any(|flux| *flux > 0.0);
        Self { map, blocks: of_cells, texels, has_light }
    }

    /// The number of a block in its column and row.
    #[inline(always)]
    fn block(&self, [x, y]: [usize; 2]) -> usize {
        y * self.blocks.size[0] + x
    }

    /// Column and row of a texel in a block.
    #[inline(always)]
    fn texel(&self, block: [CellSample; 2], texel: [CellSample; 2]) -> [usize; 2] {
        let [width, height] = self.texels.size;
        [block[0].cell * width + texel[0].cell, block[1].cell * height + texel[1].cell]
    }
}

/// The cell of a normal; one more for no normal, the zero vector: the flux from all directions. The cell is that of its place in a square, to which the sphere is mapped by way of an octahedron.
///
/// Source: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014.
#[inline(always)]
fn cell(normal: DVec3) -> usize {
    let n = normal.as_vec3();
    let length = n.x.abs() + n.y.abs() + n.z.abs();
    if length == 0.0 {
        return CELLS * CELLS;
    }
    let scale = 1.0 / length;
    let (x, z) = (n.x * scale, n.z * scale);
    // The lower half is folded outwards.
    let folded = |a: f32, b: f32| if n.y < 0.0 { (1.0 - b.abs()).copysign(a) } else { a };
    let along = |a: f32| (((0.5 + 0.5 * a) * CELLS as f32) as usize).min(CELLS - 1);
    along(folded(z, x)) * CELLS + along(folded(x, z))
}

/// The normal at a place in \[−1, 1\]², the inverse of the mapping of [`cell`].
fn normal_at(x: f64, z: f64) -> DVec3 {
    let y = 1.0 - x.abs() - z.abs();
    let folded = |a: f64, b: f64| if y < 0.0 { (1.0 - b.abs()).copysign(a) } else { a };
    DVec3::new(folded(x, z), y, folded(z, x)).normalize()
}

/// The normals of a cell, from a grid of them that includes its edges.
fn normals_of_cell(cell: usize) -> Spread {
    const STEPS: usize = 8;
    let place = |cell: usize, step: usize| 2.0 * (cell as f64 + step as f64 / STEPS as f64) / CELLS as f64 - 1.0;
    let steps = (0..=STEPS).flat_map(|j| (0..=STEPS).map(move |i| (i, j)));
    let normals: Vec<DVec3> = steps.map(|(i, j)| normal_at(place(cell % CELLS, i), place(cell / CELLS, j))).collect();
    let moment: DVec3 = normals.iter().sum();
    let axis = moment.normalize();
    let least_cos = normals.iter().map(|n| n.dot(axis)).fold(1.0, f64::min);
    Spread::new((axis, least_cos.acos() + 1e-3), moment, normals.len() as f64)
}

impl SurfaceSampler for CosineSampler {
    fn sample_for(&self, u: [f64; 2], normal: DVec3) -> Option<EnvSample> {
        let mut out = [None];
        self.sample_each(&[u], &[normal], &mut out);
        out[0]
    }

    fn sample_each(&self, u: &[[f64; 2]], normals: &[DVec3], out: &mut [Option<EnvSample>]) {
        pulp::Arch::new().dispatch(Fill { sampler: self, u, normals, out });
    }

    fn map(&self) -> &EnvMap {
        &self.map
    }

    #[inline]
    fn pdf_in_texel(&self, (x, y): (usize, usize), normal: DVec3) -> f64 {
        let g = self.map.geometry();
        let [width, height] = self.texels.size;
        let [bx, by] = [x / width, y / height];
        let of_block = self.blocks.probability(cell(normal), [bx, by]);
        let texel = [x - bx * width, y - by * height];
        of_block * self.texels.probability(self.block([bx, by]), texel) * g.inverse_solid_angle(y)
    }

    fn has_samples(&self) -> bool {
        self.has_light
    }
}

/// Samples for several normals. Each step is done for all samples before the next one, so that their look-ups overlap.
struct Fill<'a> {
    sampler: &'a CosineSampler,
    u: &'a [[f64; 2]],
    normals: &'a [DVec3],
    out: &'a mut [Option<EnvSample>],
}

impl pulp::WithSimd for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<Simd: pulp::Simd>(self, _: Simd) {
        let Self { sampler, u, normals, out } = self;
        let CosineSampler { map, blocks, texels, .. } = sampler;
        let g = map.geometry();
        for (i, out) in out.chunks_mut(BATCH).enumerate() {
            let (u, normals) = (&u[i * BATCH..][..out.len()], &normals[i * BATCH..][..out.len()]);
            let mut cells = [0; BATCH];
            let [mut bx, mut by, mut tx, mut ty] = [[CellSample::default(); BATCH]; 4];
            // Find the row of blocks and the block, then the row of its texels and the texel.
            for i in 0..out.len() {
                cells[i] = cell(normals[i]);
                by[i] = blocks.row(cells[i], u[i][1]);
            }
            for i in 0..out.len() {
                bx[i] = blocks.column(cells[i], by[i].cell, u[i][0]);
                texels.rows.prefetch(sampler.block([bx[i].cell, by[i].cell]));
            }
            for i in 0..out.len() {
                let block = sampler.block([bx[i].cell, by[i].cell]);
                ty[i] = texels.row(block, by[i].offset);
                texels.columns.prefetch(block * texels.size[1] + ty[i].cell);
            }
            for i in 0..out.len() {
                tx[i] = texels.column(sampler.block([bx[i].cell, by[i].cell]), ty[i].cell, bx[i].offset);
                let [x, y] = sampler.texel([bx[i], by[i]], [tx[i], ty[i]]);
                prefetch(map.image().pixels(), y * g.width() + x);
            }
            for i in 0..out.len() {
                let [x, y] = sampler.texel([bx[i], by[i]], [tx[i], ty[i]]);
                let wi = g.direction_in_texel(x, y, tx[i].offset, ty[i].offset);
                let probability = (by[i].probability * bx[i].probability) * (ty[i].probability * tx[i].probability);
                let pdf = probability * g.inverse_solid_angle(y);
                out[i] = (pdf > 0.0).then(|| EnvSample { wi, pdf, radiance: map.texel(x, y) });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::raster::Image;

    #[test]
    fn sample_weights_are_the_irradiance() {
        let map =
            Arc::new(EnvMap::new(Image::from_fn(256, 128, |x, y| Rgb::splat(((x / 9 + y / 7) % 4) as f32 + 0.1))));
        let sampler = CosineSampler::new(map.clone());
        for n in [DVec3::Y, DVec3::NEG_Y, DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.6, 0.64)] {
            let expected = crate::envmap::irradiance::IrradianceTree::new(&map).irradiance(n).value.x;
            let (mut sum, mut sum2) = (0.0, 0.0);
            let count = 4096;
            for i in 0..count {
                let u = [(f64::from(i) + 0.5) / f64::from(count), (f64::from(i) * 0.618_034).fract()];
                let weight =
                    sampler.sample_for(u, n).map_or(0.0, |s| f64::from(s.radiance.x) * s.wi.dot(n).max(0.0) / s.pdf);
                sum += weight;
                sum2 += weight * weight;
            }
            let (mean, mean2) = (sum / f64::from(count), sum2 / f64::from(count));
            assert!((mean / expected - 1.0).abs() < 2e-3, "{mean} against {expected}");
            // A sampler of the map alone has 1.67 for a constant map.
            assert!(mean2 / (mean * mean) - 1.0 < 0.1, "relative variance {}", mean2 / (mean * mean) - 1.0);
        }
    }

    #[test]
    fn compensation_leaves_the_dim_part_of_a_map_to_the_bsdf() {
        let is_bright = |x: usize, y: usize| (x / 4 + y / 4).is_multiple_of(5);
        let level = |x, y| Rgb::splat(if is_bright(x, y) { 10.0 } else { 0.5 });
        let map = Arc::new(EnvMap::new(Image::from_fn(64, 32, level)));
        let (sampler, g) = (CosineSampler::compensated(map.clone()), map.geometry());
        let n = DVec3::new(0.6, 0.0, 0.8);
        for (x, y) in (0..32).flat_map(|y| (0..64).map(move |x| (x, y))) {
            let wi = g.direction_in_texel(x, y, 0.5, 0.5);
            if wi.dot(n) > 0.1 {
                assert_eq!(sampler.pdf_for(wi, n) > 0.0, is_bright(x, y), "{x} {y}");
            }
        }
        // Light and BSDF samples combined by the balance heuristic have the irradiance as their mean.
        let frame = crate::math::Frame::from_normal(n.as_vec3());
        let count = 1 << 16;
        let weight = |wi: DVec3| {
            let cos = wi.dot(n).max(0.0);
            let pdf = sampler.pdf_for(wi, n) + cos / std::f64::consts::PI;
            if cos > 0.0 { f64::from(map.radiance(wi).x) * cos / pdf } else { 0.0 }
        };
        let mut sum = 0.0;
        for i in 0..count {
            let u = [(f64::from(i) + 0.5) / f64::from(count), (f64::from(i) * 0.618_034).fract()];
            sum += sampler.sample_for(u, n).map_or(0.0, |s| weight(s.wi));
            let local = crate::sampling::warp::cosine_hemisphere(u);
            sum += weight(frame.to_world(local.as_vec3()).as_dvec3());
        }
        let expected = crate::envmap::irradiance::IrradianceTree::new(&map).irradiance(n).value.x;
        let mean = sum / f64::from(count);
        assert!((mean / expected - 1.0).abs() < 5e-3, "{mean} against {expected}");
        // A constant map has nothing above its mean.
        let constant = Arc::new(EnvMap::new(Image::from_fn(33, 17, |_, _| Rgb::splat(0.3))));
        assert_eq!(CosineSampler::compensated(constant).sample_for([0.5; 2], n), None);
    }
}
