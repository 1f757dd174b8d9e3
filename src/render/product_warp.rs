//! Lamp samples for broad metal, sampled where on the lamp the metal shines.
//!
//! Seen from rough metal some part of a lamp is reflected and the rest is not. So the numbers that a lamp sample is made
//! of are bent first: sampled in proportion to a function w of the unit square that is linear along either axis, with
//! values at the corners that follow what the metal scatters from the corners of the lamp. The sample's weight is
//! divided by the density w / ∫w. Source: Hart et al., "Practical Product Sampling by Fitting and Composing Warps",
//! EGSR 2020.

use super::lanes::{BLOCK, LANES, Lane, Lane3, ZERO3, at, block, blocks, put, set};
use super::lights::RectangleLight;
use super::mis::power_heuristic;
use super::wide::{Wide, wide};
use super::workspace::RoughHit;
use crate::bsdf::{Bsdf, NormalSampling};
use crate::sampling::normals::SampleNormals;
use glam::Vec3;
use pulp::Arch;
use std::array::from_mut;

/// From this alpha on the corners tell enough of what is between them; a sharper image of a lamp is smaller than it.
const BROAD: f32 = 0.15;

/// How many of the metal's own directions a lamp sample counts for in multiple importance sampling, where bent: flat in
/// the reports' scenes from 2 to 4.
const TRUST: f32 = 2.0;

/// Added to the values at the corners, which add up to 1: the density is nowhere below 4 · 0.1 / 1.4.
const FLOOR: f32 = 0.1;

/// Where along its half sides the lamp's corners are looked at: a line through these values fits better than one
/// through those at the very ends.
const CORNER: f32 = 0.8;

/// [`TRUST`] for a broad metal, else 1. Any number gives the right mean if all samples of a hit's light go by the same.
pub fn trust(bsdf: &Bsdf) -> f32 {
    let (alpha, normals) = match bsdf {
        Bsdf::Beckmann(c) => (c.distribution.alpha, c.normals),
        Bsdf::Ggx(c) => (c.distribution.alpha, c.normals),
        _ => return 1.0,
    };
    if alpha >= BROAD && normals == NormalSampling::Vndf { TRUST } else { 1.0 }
}

/// Bends the numbers that a sample of a lamp is sampled with at each hit on broad metal; `density` becomes the density of
/// the new ones in the unit square. `draws` is how many samples of the lamp each hit gets.
pub fn bend(
    arch: Arch,
    bsdf: &Bsdf,
    lamp: &RectangleLight,
    hits: &[RoughHit],
    draws: u32,
    u: &mut [Lane; 2],
    density: &mut Lane,
) {
    let (mut position, mut normal, mut wo) = (ZERO3, ZERO3, ZERO3);
    for (i, hit) in hits.iter().enumerate().take(LANES) {
        set(&mut position, i, hit.surface.position);
        set(&mut normal, i, hit.frame.z);
        set(&mut wo, i, hit.frame.to_world(hit.wo));
    }
    let views = Views { count: hits.len(), position, normal, wo };
    let trust = TRUST * draws as f32;
    match bsdf {
        Bsdf::Beckmann(metal) => {
            wide(arch, Bend { facets: metal.distribution, lamp, views: &views, trust, u, density })
        }
        Bsdf::Ggx(metal) => wide(arch, Bend { facets: metal.distribution, lamp, views: &views, trust, u, density }),
        _ => density.fill(1.0),
    }
}

/// Hits and where they are seen from.
struct Views {
    count: usize,
    position: Lane3,
    normal: Lane3,
    wo: Lane3,
}

struct Bend<'a, D> {
    facets: D,
    lamp: &'a RectangleLight,
    views: &'a Views,
    trust: f32,
    u: &'a mut [Lane; 2],
    density: &'a mut Lane,
}

impl<D: SampleNormals<f32>> Wide for Bend<'_, D> {
    #[inline(always)]
    fn run(self) {
        let (facets, lamp, trust) = (self.facets, *self.lamp, self.trust);
        let corners = [[-CORNER, -CORNER], [CORNER, -CORNER], [-CORNER, CORNER], [CORNER, CORNER]];
        for number in 0..blocks(self.views.count) {
            let Views { position, normal, wo, .. } = self.views;
            let (position, normal, wo) = (block(position, number), block(normal, number), block(wo, number));
            let mut rival = [0.0; BLOCK];
            for i in 0..BLOCK {
                let over_d = 0.25 * facets.g1_over_cos(leaning(at(&normal, i).dot(at(&wo, i))));
                rival[i] = over_d / (trust * lamp.pdf_from_afar(at(&position, i)));
            }
            let mut values = [[0.0; BLOCK]; 4];
            for (value, [x, y]) in values.iter_mut().zip(corners) {
                let corner = lamp.place(x, y);
                for i in 0..BLOCK {
                    value[i] = shine(facets, at(&normal, i), at(&wo, i), corner - at(&position, i), rival[i]);
                }
            }
            let mut u = block(self.u, number);
            let mut density = [0.0; BLOCK];
            for i in 0..BLOCK {
                let function = Bilinear::of([values[0][i], values[1][i], values[2][i], values[3][i]]);
                ([u[0][i], u[1][i]], density[i]) = function.sample([u[0][i], u[1][i]]);
            }
            put(self.u, number, &u);
            put(from_mut(self.density), number, &[density]);
        }
    }
}

/// What the metal scatters to `wo` of the light from `to`, up to a factor, less the share that its own directions bring:
/// D · `rival` is their density over the lamp's. The cosine times the BSDF is near enough in proportion to D.
#[inline(always)]
fn shine<D: SampleNormals<f32>>(facets: D, normal: Vec3, wo: Vec3, to: Vec3, rival: f32) -> f32 {
    let wi = to * (1.0 / to.length());
    let sum = wo + wi;
    let d = facets.d(leaning(normal.dot(sum) / sum.length()));
    let value = d * power_heuristic(1.0, d * rival);
    // False for what is not a number.
    if (normal.dot(wi) > 0.0) & (value > 0.0) { value } else { 0.0 }
}

/// A direction with that cosine: facets lie alike all round.
#[inline(always)]
fn leaning(cos: f32) -> [f32; 3] {
    [(1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos]
}

/// A positive function of the unit square, linear along either axis: its values at (0, 0), (1, 0), (0, 1) and (1, 1).
struct Bilinear([f32; 4]);

impl Bilinear {
    /// The function that has these values at the corners, in proportion, and everywhere something.
    #[inline(always)]
    fn of(values: [f32; 4]) -> Self {
        let [a, b, c, d] = values;
        let scale = 1.0 / (a + b + c + d).max(f32::MIN_POSITIVE);
        Self([a * scale + FLOOR, b * scale + FLOOR, c * scale + FLOOR, d * scale + FLOOR])
    }

    /// A point of the square sampled in proportion to the function, and its density.
    #[inline(always)]
    fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let [a, b, c, d] = self.0;
        let y = linear(u[1], a + b, c + d);
        let (left, right) = (a + (c - a) * y, b + (d - b) * y);
        let x = linear(u[0], left, right);
        ([x, y], 4.0 * (left + (right - left) * x) / ((a + b) + (c + d)))
    }
}

/// A number sampled in proportion to a line from `a` at 0 to `b` at 1: the root of a quadratic, without cancellation.
#[inline(always)]
fn linear(u: f32, a: f32, b: f32) -> f32 {
    let x = u * (a + b) / (a + (a * a + u * (b * b - a * a)).sqrt());
    x.min(1.0 - f32::EPSILON / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bent_numbers_have_the_density_that_they_say() {
        let squares =
            [[1.0, 0.0, 0.0, 0.0], [0.0, 3.0, 1.0, 7.0], [2.0, 2.0, 2.0, 2.0], [0.0; 4], [1e30, 1.0, 0.0, 5.0]];
        const SIDE: usize = 1024;
        let middle = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        for values in squares {
            let function = Bilinear::of(values);
            // The mean of g / density is the integral of g, here of monomials.
            let mut sums = [0.0; 4];
            for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
                let ([x, y], density) = function.sample([middle(i), middle(j)]);
                assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) && density > 0.28, "{values:?}");
                for (sum, g) in sums.iter_mut().zip([1.0, x, y, x * y * y]) {
                    *sum += f64::from(g / density) / (SIDE * SIDE) as f64;
                }
            }
            for (sum, expected) in sums.into_iter().zip([1.0, 1.0 / 2.0, 1.0 / 2.0, 1.0 / 6.0]) {
                assert!((sum - expected).abs() < 1e-4, "{values:?}: {sum} {expected}");
            }
        }
    }

    #[test]
    fn lines_keep_their_ends() {
        for (a, b) in [(0.1, 1.1), (1.1, 0.1), (1.0, 1.0)] {
            assert_eq!(linear(0.0, a, b), 0.0);
            let last = linear(1.0 - f32::EPSILON / 2.0, a, b);
            assert!(last < 1.0 && last > 1.0 - 1e-5, "{last}");
        }
    }
}
