//! Median cut: a map divided into regions of equal energy, each standing for one light; summed-area tables.
//!
//! A power of two is reached level by level, as in the paper: at each level every region is cut in two along its longer
//! side, at the median of its energy. For any other number, and by the variance rule, regions are cut one at a time,
//! always the one with the most energy (or variance). The same fills up a power of two that its levels do not reach because
//! some regions are single texels, which cannot be cut.
//!
//! Source: Debevec, "A Median Cut Algorithm for Light Probe Sampling", 2005; the variance rule after Viriyothai &
//! Debevec, "Variance Minimization Light Probe Sampling", 2009.

use crate::envmap::latlong::Block;
use crate::envmap::map::EnvMap;
use crate::error::{Error, Result};
use crate::interrupt;
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::PI;

/// How the place of a cut is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Split {
    /// Across the longer side, where the energy halves.
    #[default]
    Energy,
    /// Where the larger variance of the two halves is smallest, either way across. The variance of a region is
    /// M₀ − |M₁|²/M₀ with M₀ = Σ E and M₁ = Σ E ω over its texels, in closed form from summed-area tables; it is
    /// taken on the sphere, where the map has neither seam nor poles.
    Variance,
}

impl Split {
    /// All rules, in the order in which they are listed.
    pub const ALL: [Self; 2] = [Self::Energy, Self::Variance];

    /// Its name at the command line and in names of test cases.
    pub fn name(self) -> &'static str {
        match self {
            Self::Energy => "energy",
            Self::Variance => "variance",
        }
    }

    /// How it chooses the place, in a few words.
    pub fn about(self) -> &'static str {
        match self {
            Self::Energy => "across the longer side, where the energy halves",
            Self::Variance => "where the larger variance of the halves is smallest",
        }
    }

    /// Whether it needs the first moments of the energy.
    const fn needs_moments(self) -> bool {
        match self {
            Self::Energy => false,
            Self::Variance => true,
        }
    }
}

/// How the sides of a region are measured, of which the longer one is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SideRule {
    /// In texels of the map, as in Debevec's paper.
    #[default]
    Texels,
    /// On the sphere: the width counts sin θ of the region's middle row, as Debevec advises for lat-long maps.
    Sphere,
}

/// A region and the light that stands for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    pub block: Block,
    /// Energy centroid, continuous texel coordinates.
    pub centroid: (f64, f64),
    /// The column and the row at which the region's energy halves, continuous texel coordinates (the first report's
    /// "median pixel").
    pub median: (f64, f64),
    /// ∫ L dω over the region.
    pub flux: DVec3,
    /// ∫ (R+G+B)/3 dω over the region.
    pub energy: f64,
}

/// A region to be split. The order is by priority, then by solid angle, then by place, the earlier one first.
type Candidate = (Ordered, Ordered, Reverse<(usize, usize)>, Block);

/// A number in its total order ([`f64::total_cmp`]), as an integer.
type Ordered = i64;

fn ordered(x: f64) -> Ordered {
    let bits = x.to_bits().cast_signed();
    // Negative numbers with larger bits are smaller.
    bits ^ ((bits >> 63).cast_unsigned() >> 1).cast_signed()
}

/// The summed-area tables of a map, from which any number of cuts can be made.
pub struct MedianCut<'a> {
    map: &'a EnvMap,
    energy: SummedArea,
    /// First moments Σ E ω, one table per axis, if the rule needs them.
    moments: Option<[SummedArea; 3]>,
    split: Split,
    /// Used by the energy rule; the variance rule tries cuts along both sides.
    sides: SideRule,
}

impl<'a> MedianCut<'a> {
    /// Memory that the tables take for each texel.
    pub const fn bytes(split: Split) -> usize {
        size_of::<f64>() * if split.needs_moments() { 4 } else { 1 }
    }

    /// Tabulates the energies of `map`, and their first moments if the rule needs them.
    pub fn new(map: &'a EnvMap, split: Split, sides: SideRule) -> Self {
        let g = map.geometry();
        let table = |value: &(dyn Fn(usize, usize) -> f64 + Sync)| SummedArea::new(g.width(), g.height(), value);
        let energy_of = |x: usize, y: usize| map.energy(x, y);
        let moments = split
            .needs_moments()
            .then(|| [0, 1, 2].map(|axis| table(&|x, y| energy_of(x, y) * g.direction_in_texel(x, y, 0.5, 0.5)[axis])));
        Self { map, energy: table(&energy_of), moments, split, sides }
    }

    /// Divides the map into exactly `n` regions, in reading order of their corners.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless 1 ≤ `n` ≤ number of texels; [`Error::Interrupted`] after Ctrl-C.
    pub fn regions(&self, n: usize) -> Result<Vec<Region>> {
        let (width, height) = (self.map.geometry().width(), self.map.geometry().height());
        if n == 0 || n > width * height {
            return Err(Error::parameter("n", format!("{n} regions out of {width}x{height} texels"))
                .with_hint("ask for at least 1 and at most one region per texel"));
        }
        // Cut level by level where the number allows that, single texels staying whole, then the region of highest priority until there are `n`.
        let whole = Block { x0: 0, y0: 0, x1: width, y1: height };
        let level_by_level = self.split == Split::Energy && n.is_power_of_two();
        let halves = |block| self.cut(block).map_or(vec![block], Vec::from);
        let blocks = (0..if level_by_level { n.ilog2() } else { 0 })
            .fold(vec![whole], |blocks, _| blocks.into_iter().flat_map(halves).collect());
        let mut done = Vec::new();
        let mut heap: BinaryHeap<Candidate> = blocks.into_iter().map(|block| self.candidate(block)).collect();
        while done.len() + heap.len() < n {
            interrupt::check()?;
            let Some((.., block)) = heap.pop() else { break };
            match self.cut(block) {
                Some(halves) => heap.extend(halves.map(|r| self.candidate(r))),
                None => done.push(block),
            }
        }
        done.extend(heap.into_iter().map(|(.., block)| block));
        done.sort_by_key(|r| (r.y0, r.x0));
        Ok(done.into_iter().map(|block| self.region(block)).collect())
    }

    fn candidate(&self, block: Block) -> Candidate {
        let g = self.map.geometry();
        let column: f64 = (block.y0..block.y1).map(|y| g.solid_angle(y)).sum();
        let priority = match self.split {
            Split::Energy => self.energy.sum(block),
            Split::Variance => self.variance(block),
        };
        let solid_angle = column * (block.x1 - block.x0) as f64;
        (ordered(priority), ordered(solid_angle), Reverse((block.y0, block.x0)), block)
    }

    /// The two halves of a region; `None` for a single texel.
    fn cut(&self, block: Block) -> Option<[Block; 2]> {
        match self.split {
            Split::Energy => self.cut_by_energy(block, self.sides),
            Split::Variance => self.cut_by_variance(block),
        }
    }

    fn cut_by_energy(&self, block: Block, sides: SideRule) -> Option<[Block; 2]> {
        let axes = [self.longer_side(block, sides), Axis::X, Axis::Y];
        let axis = axes.into_iter().find(|axis| !axis.candidates(block).is_empty())?;
        let places = axis.candidates(block);
        let (first, last) = (places.start, places.end - 1);
        // Without light cut in the middle.
        let total = self.energy.sum(block);
        if total <= 0.0 {
            return Some(axis.split(block, (first + last).div_ceil(2)));
        }
        // The first cut with at least half of the energy before it, or the one before that if it is closer to half.
        let before = |at: usize| self.energy.sum(axis.split(block, at)[0]);
        let (mut low, mut high) = (first, last);
        while low < high {
            let middle = low + (high - low) / 2;
            if before(middle) * 2.0 >= total { high = middle } else { low = middle + 1 }
        }
        let imbalance = |at: usize| (before(at) * 2.0 - total).abs();
        let at = if low > first && imbalance(low - 1) <= imbalance(low) { low - 1 } else { low };
        Some(axis.split(block, at))
    }

    fn cut_by_variance(&self, block: Block) -> Option<[Block; 2]> {
        let worse = |halves: &[Block; 2]| self.variance(halves[0]).max(self.variance(halves[1]));
        let best = [Axis::X, Axis::Y]
            .into_iter()
            .flat_map(|axis| axis.candidates(block).map(move |at| axis.split(block, at)))
            .min_by(|a, b| worse(a).total_cmp(&worse(b)))?;
        // Without light all cuts are equal: take the middle.
        if self.energy.sum(block) <= 0.0 { self.cut_by_energy(block, SideRule::Sphere) } else { Some(best) }
    }

    /// M₀ − |M₁|²/M₀, at least 0.
    fn variance(&self, block: Block) -> f64 {
        let Some(moments) = &self.moments else { return 0.0 };
        let m0 = self.energy.sum(block);
        if m0 <= 0.0 {
            return 0.0;
        }
        let m1 = DVec3::from_array([0, 1, 2].map(|axis: usize| moments[axis].sum(block)));
        (m0 - m1.length_squared() / m0).max(0.0)
    }

    fn longer_side(&self, block: Block, sides: SideRule) -> Axis {
        let g = self.map.geometry();
        let (w, h) = ((block.x1 - block.x0) as f64, (block.y1 - block.y0) as f64);
        let wide = match sides {
            SideRule::Texels => w >= h,
            SideRule::Sphere => {
                let theta = 0.5 * PI * (block.y0 + block.y1) as f64 / g.height() as f64;
                w * 2.0 * PI / g.width() as f64 * theta.sin() >= h * PI / g.height() as f64
            }
        };
        if wide { Axis::X } else { Axis::Y }
    }

    /// Sums a region's texels directly, so that the regions' fluxes add up to the map's.
    fn region(&self, block: Block) -> Region {
        let g = self.map.geometry();
        let mut flux = DVec3::ZERO;
        let (mut energy, mut moment_x, mut moment_y) = (0.0, 0.0, 0.0);
        let mut columns = vec![0.0; block.x1 - block.x0];
        let mut rows = vec![0.0; block.y1 - block.y0];
        for y in block.y0..block.y1 {
            let solid_angle = g.solid_angle(y);
            let mut row = DVec3::ZERO;
            for x in block.x0..block.x1 {
                row += self.map.texel(x, y).as_dvec3();
                let e = self.map.mean_rgb(x, y) * solid_angle;
                moment_x += e * (x as f64 + 0.5);
                moment_y += e * (y as f64 + 0.5);
                columns[x - block.x0] += e;
                rows[y - block.y0] += e;
                energy += e;
            }
            flux += row * solid_angle;
        }
        let middle = (0.5 * (block.x0 + block.x1) as f64, 0.5 * (block.y0 + block.y1) as f64);
        let (centroid, median) = if energy > 0.0 {
            (
                (moment_x / energy, moment_y / energy),
                (block.x0 as f64 + halving(&columns, energy), block.y0 as f64 + halving(&rows, energy)),
            )
        } else {
            (middle, middle)
        };
        Region { block, centroid, median, flux, energy }
    }
}

/// The place at which the running sum of `energies` reaches half of `total`, interpolated inside its cell.
fn halving(energies: &[f64], total: f64) -> f64 {
    let mut before = 0.0;
    for (i, &e) in energies.iter().enumerate() {
        if before + e >= 0.5 * total && e > 0.0 {
            return i as f64 + (0.5 * total - before) / e;
        }
        before += e;
    }
    energies.len() as f64 * 0.5
}

/// The direction along which a region is divided.
#[derive(Debug, Clone, Copy)]
enum Axis {
    X,
    Y,
}

impl Axis {
    /// The inner texel borders at which a region can be cut.
    fn candidates(self, r: Block) -> std::ops::Range<usize> {
        match self {
            Axis::X => r.x0 + 1..r.x1,
            Axis::Y => r.y0 + 1..r.y1,
        }
    }

    fn split(self, r: Block, at: usize) -> [Block; 2] {
        match self {
            Axis::X => [Block { x1: at, ..r }, Block { x0: at, ..r }],
            Axis::Y => [Block { y1: at, ..r }, Block { y0: at, ..r }],
        }
    }
}

#[cfg(test)]
mod tests;

/// Prefix sums in f64. In f32 the error of an 8×8 block beyond one texel of 10⁶ would be up to 2 %.
pub struct SummedArea {
    stride: usize,
    sums: Vec<f64>,
}

impl SummedArea {
    pub fn new(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let stride = width + 1;
        let mut sums = vec![0.0; stride * (height + 1)];
        for y in 0..height {
            let mut row = 0.0;
            for x in 0..width {
                row += value(x, y);
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + row;
            }
        }
        Self { stride, sums }
    }

    /// Sum over a rectangle. The error is that of f64 relative to the sum of everything above and left of it.
    #[inline]
    pub fn sum(&self, r: Block) -> f64 {
        let at = |x: usize, y: usize| self.sums[y * self.stride + x];
        (at(r.x1, r.y1) - at(r.x0, r.y1)) - (at(r.x1, r.y0) - at(r.x0, r.y0))
    }
}
