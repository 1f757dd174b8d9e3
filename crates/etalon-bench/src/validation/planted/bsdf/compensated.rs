//! Mistakes in the compensation of multiple scattering, of a lossless rough conductor.
//!
//! Source: Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017.

use super::super::fault::PlantedFault;
use super::faulty::{Change, planted};
use super::rough::{Facets, Rough};
use super::smooth::cosine;
use etalon_stats::bsdf::{Bsdf, BsdfSample, Density, Direction, Energy, Properties, Spectrum};
use std::f64::consts::FRAC_1_PI;

/// Rows of the table of albedos.
const ROWS: usize = 32;
/// What linear interpolation between the rows, and the quadrature that makes them, leave open.
const ERROR: f64 = 5e-3;

/// A rough conductor that reflects all light: half of its samples by visible normals, half by the cosine.
#[derive(Clone, Copy)]
pub struct Compensated {
    rough: Rough,
    /// Directional albedo of single scattering at cosines (i + ½)/ROWS.
    table: [f64; ROWS],
    mean: f64,
}

impl Compensated {
    pub fn new() -> Self {
        let rough = Rough { alpha: [0.8; 2], facets: Facets::Conductor(1.0) };
        // The mean of the weights G₂/G₁ over a lattice of random numbers.
        const POINTS: usize = 1 << 12;
        let albedo = |row: usize| {
            let cos = (row as f64 + 0.5) / ROWS as f64;
            let wo = [(1.0 - cos * cos).sqrt(), 0.0, cos];
            let lattice =
                |i: usize| [0.0, (i as f64 + 0.5) / POINTS as f64, (i as f64 * 0.618_033_988_749_895).fract()];
            let weights = (0..POINTS).filter_map(|i| Some(rough.sample(wo, &lattice(i))?.weight[0]));
            weights.sum::<f64>() / POINTS as f64
        };
        let table: [f64; ROWS] = std::array::from_fn(albedo);
        let cosines = |(i, e): (usize, &f64)| 2.0 * e * (i as f64 + 0.5) / (ROWS * ROWS) as f64;
        let mean = table.iter().enumerate().map(cosines).sum();
        Self { rough, table, mean }
    }

    /// The albedo of single scattering, read from the table `shift` rows away.
    fn single(&self, cos: f64, shift: f64) -> f64 {
        let at = (cos * ROWS as f64 - 0.5 + shift).clamp(0.0, (ROWS - 1) as f64);
        let row = (at as usize).min(ROWS - 2);
        let t = at - row as f64;
        (1.0 - t) * self.table[row] + t * self.table[row + 1]
    }

    /// The compensating lobe for given shares of light that single scattering loses.
    fn multiple(&self, lost_o: f64, lost_i: f64) -> f64 {
        FRAC_1_PI * lost_o * lost_i / (1.0 - self.mean)
    }

    /// f with the table read `shift` rows away.
    fn value(&self, wo: Direction, wi: Direction, shift: f64) -> f64 {
        if wo[2] <= 0.0 || wi[2] <= 0.0 {
            return 0.0;
        }
        let lost = |w: Direction| 1.0 - self.single(w[2], shift);
        self.rough.eval(wo, wi, &[])[0] + self.multiple(lost(wo), lost(wi))
    }
}

impl Bsdf for Compensated {
    fn properties(&self) -> Properties {
        Properties { energy: Energy::Conserved(ERROR), ..Properties::default() }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [self.value(wo, wi, 0.0); 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        if wo[2] > 0.0 && wi[2] > 0.0 { 0.5 * (self.rough.pdf(wo, wi) + wi[2] * FRAC_1_PI) } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let lobe = usize::from(u[0] >= 0.5);
        let wi = if lobe == 0 { self.rough.sample(wo, u)?.wi } else { cosine([u[1], u[2]]) };
        let pdf = self.pdf(wo, wi);
        let weight = self.value(wo, wi, 0.0) * wi[2] / pdf;
        (pdf > 0.0).then(|| BsdfSample::new(wi, [weight; 3], Density::Pdf(pdf)).of_lobe(lobe, 0.5))
    }

    fn lobes(&self) -> usize {
        2
    }

    fn lobe_pdf(&self, wo: Direction, wi: Direction, lobe: usize) -> Option<f64> {
        let pdf = if lobe == 0 { self.rough.pdf(wo, wi) } else { wi[2].max(0.0) * FRAC_1_PI };
        Some(if wo[2] > 0.0 { 0.5 * pdf } else { 0.0 })
    }
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::ValueAndWeight;
    let fault = |name, change, mistake| planted(name, Compensated::new, &[20.0, 75.0], change, mistake);
    vec![
        fault(
            "whole/compensated/table-off-by-a-row",
            ValueAndWeight(|m, o, i| m.value(o, i, 1.0)),
            "the table of albedos read a row too far",
        ),
        fault(
            "whole/compensated/mean-without-cosine",
            ValueAndWeight(|m, o, i| {
                let mean = m.table.iter().sum::<f64>() / ROWS as f64;
                let lost = |w: Direction| 1.0 - m.single(w[2], 0.0);
                let multiple = FRAC_1_PI * lost(o) * lost(i) / (1.0 - mean);
                if o[2] > 0.0 && i[2] > 0.0 { m.rough.eval(o, i, &[])[0] + multiple } else { 0.0 }
            }),
            "the mean albedo without 2 cos θ",
        ),
        fault(
            "whole/compensated/not-reciprocal",
            ValueAndWeight(|m, o, i| {
                let lost = 1.0 - m.single(o[2], 0.0);
                if o[2] > 0.0 && i[2] > 0.0 { m.rough.eval(o, i, &[])[0] + lost * FRAC_1_PI } else { 0.0 }
            }),
            "what is lost at wo returned as a uniform lobe: conserves energy, and is not reciprocal",
        ),
        fault(
            "whole/compensated/left-out",
            ValueAndWeight(|m, o, i| m.rough.eval(o, i, &[])[0]),
            "single scattering alone, said to conserve energy",
        ),
    ]
}
