//! Any BSDF, many hits at once: directions sampled by it, and its values for given ones. Rough conductors vectorize.

use crate::bsdf::{Bsdf, BsdfSample, Lobe, NormalSampling, RoughConductor, Scatter};
use crate::render::lanes::{BLOCK, LANES, Lane, Lane3, ZERO_BLOCK3, ZERO3, at, block, blocks, put, set};
use crate::render::wide::{Wide, wide};
use crate::sampling::normals::SampleNormals;
use pulp::Arch;
use std::array::from_mut;

/// For each hit a direction in its own frame, the BSDF times the cosine over the pdf (or alone), and the pdf.
pub struct Scattered {
    /// In the local frame.
    pub wi: Lane3,
    /// BSDF times cosine over pdf, or the BSDF.
    pub weight: Lane3,
    /// Per solid angle.
    pub pdf: Lane,
    /// Of the direction back, if light came from `wi`: by [`reverse_pdf_many`].
    pub reverse_pdf: Lane,
}

impl Default for Scattered {
    fn default() -> Self {
        Self { wi: ZERO3, weight: ZERO3, pdf: [0.0; LANES], reverse_pdf: [0.0; LANES] }
    }
}

impl Scattered {
    /// The sample of a hit by [`sample_many`]; `None` where it carries no light.
    pub fn sample(&self, i: usize) -> Option<BsdfSample> {
        let (wi, weight) = (at(&self.wi, i), at(&self.weight, i));
        (self.pdf[i] > 0.0).then(|| BsdfSample::reflected(wi, weight, self.pdf[i], Lobe::GlossyReflection))
    }
}

/// Samples a direction for each of the first `count` views, if there is a vectorized loop for the BSDF: returns whether
/// there is.
pub fn sample_many(arch: Arch, bsdf: &Bsdf, wo: &Lane3, u: &[Lane; 2], count: usize, out: &mut Scattered) -> bool {
    match bsdf {
        Bsdf::Beckmann(c) if c.normals == NormalSampling::Vndf => {
            wide(arch, SampleVndf { conductor: c, wo, u, count, out });
        }
        Bsdf::Ggx(c) if c.normals == NormalSampling::Vndf => wide(arch, SampleVndf { conductor: c, wo, u, count, out }),
        _ => return false,
    }
    true
}

/// Sets `out.weight` to the BSDF and `out.pdf` to its pdf for each of the first `count` pairs of directions `wo` and
/// `out.wi`.
pub fn eval_many(arch: Arch, bsdf: &Bsdf, wo: &Lane3, count: usize, out: &mut Scattered) {
    match bsdf {
        Bsdf::Beckmann(c) if c.normals == NormalSampling::Vndf => wide(arch, Eval { conductor: c, wo, count, out }),
        Bsdf::Ggx(c) if c.normals == NormalSampling::Vndf => wide(arch, Eval { conductor: c, wo, count, out }),
        other => {
            for i in 0..count {
                let (f, pdf) = other.eval_pdf(at(wo, i), at(&out.wi, i));
                set(&mut out.weight, i, f);
                out.pdf[i] = pdf;
            }
        }
    }
}

/// Sets `out.reverse_pdf` to the pdf of `wo` for light from `out.wi` for each of the first `count` pairs of directions.
pub fn reverse_pdf_many(arch: Arch, bsdf: &Bsdf, wo: &Lane3, count: usize, out: &mut Scattered) {
    match bsdf {
        Bsdf::Beckmann(c) if c.normals == NormalSampling::Vndf => {
            wide(arch, ReversePdf { conductor: c, wo, count, out })
        }
        Bsdf::Ggx(c) if c.normals == NormalSampling::Vndf => wide(arch, ReversePdf { conductor: c, wo, count, out }),
        other => {
            for i in 0..count {
                out.reverse_pdf[i] = other.pdf(at(&out.wi, i), at(wo, i));
            }
        }
    }
}

struct ReversePdf<'a, D> {
    conductor: &'a RoughConductor<D>,
    wo: &'a Lane3,
    count: usize,
    out: &'a mut Scattered,
}

impl<D: SampleNormals<f32>> Wide for ReversePdf<'_, D> {
    #[inline(always)]
    fn run(self) {
        let conductor = *self.conductor;
        for number in 0..blocks(self.count) {
            let (wo, wi) = (block(self.wo, number), block(&self.out.wi, number));
            let mut pdf = [0.0; BLOCK];
            for i in 0..BLOCK {
                (_, pdf[i]) = conductor.eval_vndf(at(&wi, i), at(&wo, i));
            }
            put(from_mut(&mut self.out.reverse_pdf), number, &[pdf]);
        }
    }
}

struct SampleVndf<'a, D> {
    conductor: &'a RoughConductor<D>,
    wo: &'a Lane3,
    u: &'a [Lane; 2],
    count: usize,
    out: &'a mut Scattered,
}

impl<D: SampleNormals<f32>> Wide for SampleVndf<'_, D> {
    #[inline(always)]
    fn run(self) {
        let conductor = *self.conductor;
        for number in 0..blocks(self.count) {
            let (wo, u) = (block(self.wo, number), block(self.u, number));
            let (mut wi, mut weight, mut pdf) = (ZERO_BLOCK3, ZERO_BLOCK3, [0.0; BLOCK]);
            for i in 0..BLOCK {
                let sample = conductor.sample_vndf(at(&wo, i), [u[0][i], u[1][i]]);
                set(&mut wi, i, sample.wi);
                set(&mut weight, i, sample.weight);
                pdf[i] = sample.pdf;
            }
            put(&mut self.out.wi, number, &wi);
            put(&mut self.out.weight, number, &weight);
            put(from_mut(&mut self.out.pdf), number, &[pdf]);
        }
    }
}

struct Eval<'a, D> {
    conductor: &'a RoughConductor<D>,
    wo: &'a Lane3,
    count: usize,
    out: &'a mut Scattered,
}

impl<D: SampleNormals<f32>> Wide for Eval<'_, D> {
    #[inline(always)]
    fn run(self) {
        let conductor = *self.conductor;
        for number in 0..blocks(self.count) {
            let (wo, wi) = (block(self.wo, number), block(&self.out.wi, number));
            let (mut weight, mut pdf) = (ZERO_BLOCK3, [0.0; BLOCK]);
            for i in 0..BLOCK {
                let (f, value) = conductor.eval_vndf(at(&wo, i), at(&wi, i));
                set(&mut weight, i, f);
                pdf[i] = value;
            }
            put(&mut self.out.weight, number, &weight);
            put(from_mut(&mut self.out.pdf), number, &[pdf]);
        }
    }
}
