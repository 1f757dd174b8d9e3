//! BSDFs for many hits at once: directions sampled by one, and its values for given ones. Rough surfaces vectorize.

use super::lanes::{BLOCK, LANES, Lane, Lane3, at, block, blocks, fill, put, set, wide};
use super::shaders::SurfaceShader;
use etalon_core::bsdf::{Bsdf, BsdfSample, Lobe, Scatter, Vectorizable, VectorizedLoop};
use etalon_core::math::circular::Circular;
use etalon_core::math::{Frame, Rgb, map_array};
use glam::{Vec2, Vec3};
use std::array::from_mut;

/// What a path carries. The two differ where light is refracted, which changes radiance by 1/η².
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransportMode {
    /// Radiance: `wo` points to the camera, from which the path was traced.
    Radiance,
    /// Importance: `wo` points to the light, from which the path was traced, and the adjoint BSDF is sampled.
    Importance,
}

/// The BSDFs of hits on one object: one for all or, with textures, one for each.
#[derive(Clone, Copy)]
pub enum Bsdfs<'a> {
    Same(&'a Bsdf),
    /// In the order of the hits.
    Each(&'a [Bsdf]),
}

impl<'a> Bsdfs<'a> {
    /// Those of an object where the hits have these texture coordinates; `varying` has room for them.
    pub fn of(shader: &'a SurfaceShader, uv: &[Vec2], varying: &'a mut Vec<Bsdf>) -> Self {
        let Some(bsdf) = &shader.varying else { return Self::Same(&shader.bsdf) };
        varying.clear();
        varying.extend(uv.iter().map(|&uv| bsdf.at(uv)));
        Self::Each(varying)
    }

    #[inline]
    pub fn at(self, i: usize) -> &'a Bsdf {
        match self {
            Self::Same(bsdf) => bsdf,
            Self::Each(bsdfs) => &bsdfs[i],
        }
    }
}

/// For each hit, or each of a block, a direction in its own frame, the BSDF times the cosine over the pdf (or alone), and the pdf.
pub struct Scattered<const N: usize = LANES> {
    /// In the local frame.
    pub wi: [[f32; N]; 3],
    /// BSDF times cosine over pdf, or the BSDF.
    pub weight: [[f32; N]; 3],
    /// Per solid angle.
    pub pdf: [f32; N],
    /// For samples, the lobe, the probability with which it was chosen, and the ratio of the indices of refraction.
    lobe: [Lobe; N],
    probability: [f32; N],
    eta: [f32; N],
    /// Pdf of the direction back, if light came from `wi`: by [`reverse_pdf_many`].
    pub reverse_pdf: [f32; N],
}

impl<const N: usize> Default for Scattered<N> {
    #[inline(always)]
    fn default() -> Self {
        let (zeros, zeros3, lobe) = ([0.0; N], [[0.0; N]; 3], [Lobe::GlossyReflection; N]);
        Self { wi: zeros3, weight: zeros3, pdf: zeros, lobe, probability: zeros, eta: zeros, reverse_pdf: zeros }
    }
}

impl<const N: usize> Scattered<N> {
    /// The sample of a hit by [`sample_many`], if there is one.
    pub fn sample(&self, i: usize) -> Option<BsdfSample> {
        let (wi, weight, pdf) = (at(&self.wi, i), at(&self.weight, i), self.pdf[i]);
        let (lobe, probability, eta) = (self.lobe[i], self.probability[i], self.eta[i]);
        let sample = BsdfSample { wi, weight, pdf, lobe, probability, eta };
        if sample.is_delta() { Some(sample) } else { sample.if_possible() }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, sample: BsdfSample) {
        set(&mut self.wi, i, sample.wi);
        set(&mut self.weight, i, sample.weight);
        (self.pdf[i], self.lobe[i]) = (sample.pdf, sample.lobe);
        (self.probability[i], self.eta[i]) = (sample.probability, sample.eta);
    }
}

/// Runs a loop over a BSDF if it is the same for all hits and vectorizes; returns whether it does.
fn run(bsdfs: Bsdfs, work: impl VectorizedLoop) -> bool {
    let Bsdfs::Same(bsdf) = bsdfs else { return false };
    bsdf.vectorize(work)
}

/// Samples a direction for each of the first `count` views. The first of the random numbers chooses a lobe.
pub fn sample_many(bsdfs: Bsdfs, mode: TransportMode, wo: &Lane3, u: [&Lane; 3], count: usize, out: &mut Scattered) {
    if run(bsdfs, SampleLoop { mode, wo, u, count, out }) {
        return;
    }
    let sample = match mode {
        TransportMode::Radiance => Bsdf::sample,
        TransportMode::Importance => Bsdf::sample_adjoint,
    };
    for i in 0..count {
        let found = sample(bsdfs.at(i), at(wo, i), u[0][i], [u[1][i], u[2][i]]);
        let black = || BsdfSample::reflected(Vec3::Z, Rgb::ZERO, 0.0, Lobe::GlossyReflection);
        out.set(i, found.unwrap_or_else(black));
    }
}

/// Sets `out.weight` to the BSDF and `out.pdf` to its pdf for each of the first `count` pairs of directions `wo` and
/// `out.wi`.
pub fn eval_many(bsdfs: Bsdfs, wo: &Lane3, count: usize, out: &mut Scattered) {
    if run(bsdfs, EvalLoop { wo, count, is_reverse: false, out }) {
        return;
    }
    for i in 0..count {
        let (f, pdf) = bsdfs.at(i).eval_pdf(at(wo, i), at(&out.wi, i));
        set(&mut out.weight, i, f);
        out.pdf[i] = pdf;
    }
}

/// Sets `out.reverse_pdf` to the pdf of `wo` for light from `out.wi` for each of the first `count` pairs of directions.
pub fn reverse_pdf_many(bsdfs: Bsdfs, wo: &Lane3, count: usize, out: &mut Scattered) {
    if run(bsdfs, EvalLoop { wo, count, is_reverse: true, out }) {
        return;
    }
    for i in 0..count {
        out.reverse_pdf[i] = bsdfs.at(i).pdf(at(&out.wi, i), at(wo, i));
    }
}

/// Directions of pdf cos θ / π about the first `count` normals.
pub fn sample_cosine_hemisphere(normals: &Lane3, u: &[Lane; 2], count: usize, wi: &mut Lane3) {
    fill(
        count,
        wi.each_mut(),
        #[inline(always)]
        move |i| {
            let (sin_phi, cos_phi) = f32::sin_cos_turns(u[1][i]);
            let (r, z) = (u[0][i].sqrt(), (1.0 - u[0][i]).sqrt());
            let normal = at(normals, i);
            let Frame { x: tangent, y: bitangent, .. } = Frame::from_normal(normal);
            ((tangent * cos_phi + bitangent * sin_phi) * r + normal * z).to_array()
        },
    );
}

struct SampleLoop<'a> {
    mode: TransportMode,
    wo: &'a Lane3,
    u: [&'a Lane; 3],
    count: usize,
    out: &'a mut Scattered,
}

struct EvalLoop<'a> {
    wo: &'a Lane3,
    count: usize,
    /// Whether only the pdf of `wo` for light from `wi` is computed.
    is_reverse: bool,
    out: &'a mut Scattered,
}

impl VectorizedLoop for SampleLoop<'_> {
    fn over(self, bsdf: impl Vectorizable) {
        let Self { mode, wo, u, count, out } = self;
        wide(
            #[inline(always)]
            move || {
                for number in 0..blocks(count) {
                    let (wo, [uc, x, y]) = (block(wo, number), map_array(u, |u| u.as_chunks::<BLOCK>().0[number]));
                    let mut found = Scattered::<BLOCK>::default();
                    for i in 0..BLOCK {
                        let sample = bsdf.sample_lane(at(&wo, i), uc[i], [x[i], y[i]]);
                        let is_adjoint = mode == TransportMode::Importance;
                        found.set(i, if is_adjoint { sample.adjoint() } else { sample });
                    }
                    put(&mut out.wi, number, &found.wi);
                    put(&mut out.weight, number, &found.weight);
                    put(from_mut(&mut out.pdf), number, &[found.pdf]);
                    put(from_mut(&mut out.probability), number, &[found.probability]);
                    put(from_mut(&mut out.eta), number, &[found.eta]);
                    out.lobe.as_chunks_mut().0[number] = found.lobe;
                }
            },
        );
    }
}

impl VectorizedLoop for EvalLoop<'_> {
    fn over(self, bsdf: impl Vectorizable) {
        let Self { wo, count, is_reverse, out: Scattered { wi, weight: [r, g, b], pdf, reverse_pdf, .. } } = self;
        let wi = &*wi;
        if is_reverse {
            fill(
                count,
                [reverse_pdf],
                #[inline(always)]
                move |i| [bsdf.eval_pdf_lane(at(wi, i), at(wo, i)).1],
            );
        } else {
            fill(
                count,
                [r, g, b, pdf],
                #[inline(always)]
                move |i| {
                    let (f, pdf) = bsdf.eval_pdf_lane(at(wo, i), at(wi, i));
                    [f.x, f.y, f.z, pdf]
                },
            );
        }
    }
}
