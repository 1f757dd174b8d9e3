//! Samples of rectangular lights for broad metal, in proportion to what the metal scatters.
//!
//! A rough metal reflects some parts of a light more than others. So the random numbers of a light sample are warped first:
//! sampled in proportion to a function w of the unit square that is bilinear, with values at the corners that approximate
//! what the metal scatters from the corners of the light. The sample's weight is divided by the pdf w / ∫w. Source: Hart
//! et al., "Practical Product Sampling by Fitting and Composing Warps", EGSR 2020.

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

/// The least alpha for which values at the corners are enough: a smaller one reflects only a part of the light.
const BROAD: f32 = 0.15;

/// Light samples that the MIS weight assumes for each warped one. In the reports' scenes the variance hardly changes from
/// 2 to 4.
const LIGHT_COUNT: f32 = 2.0;

/// Added to the values at the corners, which add up to 1: the pdf is nowhere below 4 · 0.1 / 1.4.
const FLOOR: f32 = 0.1;

/// Where on the half sides, from 0 to 1, the corner values are taken: a line through these fits better than one through
/// the values at the ends.
const CORNER: f32 = 0.8;

/// [`LIGHT_COUNT`] for a broad metal, else 1. The estimate is unbiased for any number that all samples of a light share.
pub fn light_count_in_mis(bsdf: &Bsdf) -> f32 {
    let (alpha, normals) = match bsdf {
        Bsdf::Beckmann(c) => (c.distribution.alpha, c.normals),
        Bsdf::Ggx(c) => (c.distribution.alpha, c.normals),
        _ => return 1.0,
    };
    if alpha >= BROAD && normals == NormalSampling::Vndf { LIGHT_COUNT } else { 1.0 }
}

/// Warps the random numbers of a light sample at each hit on broad metal; `pdf` becomes their pdf in the unit square.
/// `sample_count` is the number of samples of the light at each hit.
pub fn warp(
    arch: Arch,
    bsdf: &Bsdf,
    light: &RectangleLight,
    hits: &[RoughHit],
    sample_count: u32,
    u: &mut [Lane; 2],
    pdf: &mut Lane,
) {
    let (mut position, mut normal, mut wo) = (ZERO3, ZERO3, ZERO3);
    for (i, hit) in hits.iter().enumerate().take(LANES) {
        set(&mut position, i, hit.surface.position);
        set(&mut normal, i, hit.frame.z);
        set(&mut wo, i, hit.frame.to_world(hit.wo));
    }
    let views = Views { count: hits.len(), position, normal, wo };
    let light_count = LIGHT_COUNT * sample_count as f32;
    match bsdf {
        Bsdf::Beckmann(metal) => {
            wide(arch, Warp { facets: metal.distribution, light, views: &views, light_count, u, pdf })
        }
        Bsdf::Ggx(metal) => wide(arch, Warp { facets: metal.distribution, light, views: &views, light_count, u, pdf }),
        _ => pdf.fill(1.0),
    }
}

/// Positions, normals and outgoing directions of hits.
struct Views {
    count: usize,
    position: Lane3,
    normal: Lane3,
    wo: Lane3,
}

struct Warp<'a, D> {
    facets: D,
    light: &'a RectangleLight,
    views: &'a Views,
    light_count: f32,
    u: &'a mut [Lane; 2],
    pdf: &'a mut Lane,
}

impl<D: SampleNormals<f32>> Wide for Warp<'_, D> {
    #[inline(always)]
    fn run(self) {
        let (facets, light, light_count) = (self.facets, *self.light, self.light_count);
        let corners = [[-CORNER, -CORNER], [CORNER, -CORNER], [-CORNER, CORNER], [CORNER, CORNER]];
        for number in 0..blocks(self.views.count) {
            let Views { position, normal, wo, .. } = self.views;
            let (position, normal, wo) = (block(position, number), block(normal, number), block(wo, number));
            // Compute the ratio of the BSDF's pdf to the light's, up to the factor D.
            let mut pdf_ratio = [0.0; BLOCK];
            for i in 0..BLOCK {
                let over_d = 0.25 * facets.g1_over_cos(at_cosine(at(&normal, i).dot(at(&wo, i))));
                pdf_ratio[i] = over_d / (light_count * light.pdf_from_afar(at(&position, i)));
            }
            // Evaluate what the metal scatters from each corner.
            let mut values = [[0.0; BLOCK]; 4];
            for (value, [x, y]) in values.iter_mut().zip(corners) {
                let corner = light.place(x, y);
                for i in 0..BLOCK {
                    value[i] = scattered(facets, at(&normal, i), at(&wo, i), corner - at(&position, i), pdf_ratio[i]);
                }
            }
            // Sample the bilinear function.
            let mut u = block(self.u, number);
            let mut pdf = [0.0; BLOCK];
            for i in 0..BLOCK {
                let function = Bilinear::of([values[0][i], values[1][i], values[2][i], values[3][i]]);
                ([u[0][i], u[1][i]], pdf[i]) = function.sample([u[0][i], u[1][i]]);
            }
            put(self.u, number, &u);
            put(from_mut(self.pdf), number, &[pdf]);
        }
    }
}

/// What the metal scatters to `wo` from `to`, up to a factor, times the MIS weight of light samples: D · `pdf_ratio` is the
/// pdf of BSDF samples over that of light samples. D approximates the BSDF times the cosine.
#[inline(always)]
fn scattered<D: SampleNormals<f32>>(facets: D, normal: Vec3, wo: Vec3, to: Vec3, pdf_ratio: f32) -> f32 {
    let wi = to * (1.0 / to.length());
    let sum = wo + wi;
    let d = facets.d(at_cosine(normal.dot(sum) / sum.length()));
    let value = d * power_heuristic(1.0, d * pdf_ratio);
    // False for what is not a number.
    if (normal.dot(wi) > 0.0) & (value > 0.0) { value } else { 0.0 }
}

/// A direction with that cosine to the normal; the distribution is isotropic.
#[inline(always)]
fn at_cosine(cos: f32) -> [f32; 3] {
    [(1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos]
}

/// A positive function of the unit square, linear along either axis: its values at (0, 0), (1, 0), (0, 1) and (1, 1).
struct Bilinear([f32; 4]);

impl Bilinear {
    /// The function with values at the corners in proportion to these, plus [`FLOOR`].
    #[inline(always)]
    fn of(values: [f32; 4]) -> Self {
        let [a, b, c, d] = values;
        let scale = 1.0 / (a + b + c + d).max(f32::MIN_POSITIVE);
        Self([a * scale + FLOOR, b * scale + FLOOR, c * scale + FLOOR, d * scale + FLOOR])
    }

    /// A point of the square sampled in proportion to the function, and its pdf.
    #[inline(always)]
    fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let [a, b, c, d] = self.0;
        let y = linear(u[1], a + b, c + d);
        let (left, right) = (a + (c - a) * y, b + (d - b) * y);
        let x = linear(u[0], left, right);
        ([x, y], 4.0 * (left + (right - left) * x) / ((a + b) + (c + d)))
    }
}

/// A number in [0, 1) sampled in proportion to a line from `a` at 0 to `b` at 1: the root of a quadratic, without
/// cancellation.
#[inline(always)]
fn linear(u: f32, a: f32, b: f32) -> f32 {
    let x = u * (a + b) / (a + (a * a + u * (b * b - a * a)).sqrt());
    x.min(1.0 - f32::EPSILON / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warped_numbers_have_the_pdf_that_is_returned() {
        let squares =
            [[1.0, 0.0, 0.0, 0.0], [0.0, 3.0, 1.0, 7.0], [2.0, 2.0, 2.0, 2.0], [0.0; 4], [1e30, 1.0, 0.0, 5.0]];
        const SIDE: usize = 1024;
        let middle = |i: usize| (i as f32 + 0.5) / SIDE as f32;
        for values in squares {
            let function = Bilinear::of(values);
            // The mean of g / pdf is the integral of g, here of monomials.
            let mut sums = [0.0; 4];
            for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
                let ([x, y], pdf) = function.sample([middle(i), middle(j)]);
                assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y) && pdf > 0.28, "{values:?}");
                for (sum, g) in sums.iter_mut().zip([1.0, x, y, x * y * y]) {
                    *sum += f64::from(g / pdf) / (SIDE * SIDE) as f64;
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
