//! A BSDF of which only the values are asked: its directions are uniform on the hemisphere, or on the sphere if it transmits. Delta lobes, which
//! have no values, are sampled as they are declared, one of all with probability ½.

use etalon_core::sampling::warp::{UNIFORM_HEMISPHERE_PDF, UNIFORM_SPHERE_PDF, uniform_hemisphere, uniform_sphere};
use etalon_stats::Result;
use etalon_stats::bsdf::{BatchBsdf, BsdfSample, DeltaLobe, Density, Direction, Pair, PdfKind, Properties, Spectrum};

pub struct ByValue<'a> {
    bsdf: &'a dyn BatchBsdf,
    properties: Properties,
}

/// Random numbers of a direction: two, and one that chooses a delta lobe.
const OF_DIRECTION: usize = 3;

impl<'a> ByValue<'a> {
    pub fn new(bsdf: &'a dyn BatchBsdf) -> Self {
        let of_bsdf = bsdf.properties();
        let dimension = OF_DIRECTION + of_bsdf.eval_dimension;
        Self { bsdf, properties: Properties { dimension, pdf: PdfKind::Exact, ..of_bsdf } }
    }

    /// The probability of a direction that is not that of a delta lobe.
    fn spread(&self) -> f64 {
        if self.properties.delta { 0.5 } else { 1.0 }
    }

    fn uniform_pdf(&self) -> f64 {
        self.spread() * if self.properties.transmission { UNIFORM_SPHERE_PDF } else { UNIFORM_HEMISPHERE_PDF }
    }

    fn is_met(&self, [wo, wi]: &Pair) -> bool {
        self.properties.transmission || wo[2] * wi[2] > 0.0
    }
}

impl BatchBsdf for ByValue<'_> {
    fn properties(&self) -> Properties {
        self.properties.clone()
    }

    fn eval(&self, pairs: &[Pair], u: &[f64]) -> Result<Vec<Spectrum>> {
        self.bsdf.eval(pairs, u)
    }

    fn pdf(&self, pairs: &[Pair]) -> Result<Vec<f64>> {
        Ok(pairs.iter().map(|pair| if self.is_met(pair) { self.uniform_pdf() } else { 0.0 }).collect())
    }

    fn sample(&self, wos: &[Direction], u: &[f64]) -> Result<Vec<Option<BsdfSample>>> {
        let numbers = || u.chunks_exact(self.properties.dimension);
        let direction = |(wo, u): (&Direction, &[f64])| {
            let u = [u[0], u[1]];
            let [x, y, z] =
                if self.properties.transmission { uniform_sphere(u) } else { uniform_hemisphere(u) }.to_array();
            [*wo, [x, y, if wo[2] < 0.0 { -z } else { z }]]
        };
        let pairs: Vec<Pair> = wos.iter().zip(numbers()).map(direction).collect();
        let rest: Vec<f64> = numbers().flat_map(|u| &u[OF_DIRECTION..]).copied().collect();
        let (values, lobes) = (self.bsdf.eval(&pairs, &rest)?, self.bsdf.delta_lobes(wos)?);
        let sample = |(i, u): (usize, &[f64])| {
            let ([_, wi], f, lobes) = (&pairs[i], values[i], &lobes[i]);
            let pdf = self.uniform_pdf();
            if u[2] < self.spread() {
                return Some(BsdfSample::new(*wi, f.map(|f| f * wi[2].abs() / pdf), Density::Pdf(pdf)));
            }
            let probability = (1.0 - self.spread()) / lobes.len() as f64;
            let lobe = lobes.get(((u[2] - self.spread()) / probability) as usize)?;
            let weight = lobe.throughput.map(|throughput| throughput / probability);
            Some(BsdfSample::new(lobe.wi, weight, Density::Delta(probability)))
        };
        Ok(numbers().enumerate().map(sample).collect())
    }

    fn delta_lobes(&self, wos: &[Direction]) -> Result<Vec<Vec<DeltaLobe>>> {
        self.bsdf.delta_lobes(wos)
    }
}
