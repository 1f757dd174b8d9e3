//! A program that tests a BSDF of its own: `cargo run --release --example own_bsdf`.
//!
//! The BSDF is Phong's lobe around the mirror direction, normalized: right, and without the cosine in its weights, a
//! frequent mistake.

use etalon_stats::bsdf::{Bsdf, BsdfSample, Density, Direction, Energy, Properties, Reciprocity, Spectrum, test};
use etalon_stats::prelude::*;
use std::f64::consts::TAU;

/// f = (n + 2)/2π cosⁿ α, α the angle with the mirror direction.
struct Phong {
    exponent: f64,
    /// Whether the weight has the cosine of wi.
    has_cosine: bool,
}

/// The cosine with the mirror direction of `wo`.
fn cos_alpha(wo: Direction, wi: Direction) -> f64 {
    (wo[2] * wi[2] - wo[0] * wi[0] - wo[1] * wi[1]).max(0.0)
}

impl Bsdf for Phong {
    fn properties(&self) -> Properties {
        Properties {
            reciprocity: Reciprocity::Reciprocal,
            energy: Energy::AtMostOne,
            // Both random numbers of a sample are mapped to directions one to one.
            dimension: 2,
            map: Some([0, 1]),
            ..Properties::default()
        }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        let above = wo[2] > 0.0 && wi[2] > 0.0;
        [if above { (self.exponent + 2.0) / TAU * cos_alpha(wo, wi).powf(self.exponent) } else { 0.0 }; 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        let above = wo[2] > 0.0 && wi[2] > 0.0;
        if above { (self.exponent + 1.0) / TAU * cos_alpha(wo, wi).powf(self.exponent) } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        // A lobe around +z, turned so that +z becomes the mirror direction of wo.
        let cos = (1.0 - u[0]).powf(1.0 / (self.exponent + 1.0));
        let sin = (1.0 - cos * cos).sqrt();
        let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
        let axis = [-wo[0], -wo[1], wo[2]];
        let flat = axis[0].hypot(axis[1]);
        let s = if flat > 0.0 { [-axis[1] / flat, axis[0] / flat, 0.0] } else { [1.0, 0.0, 0.0] };
        let t = [axis[1] * s[2] - axis[2] * s[1], axis[2] * s[0] - axis[0] * s[2], axis[0] * s[1] - axis[1] * s[0]];
        let wi = [0, 1, 2].map(|i| sin * (cos_phi * s[i] + sin_phi * t[i]) + cos * axis[i]);
        let pdf = self.pdf(wo, wi);
        let weight = (self.exponent + 2.0) / (self.exponent + 1.0) * if self.has_cosine { wi[2] } else { 1.0 };
        (pdf > 0.0).then(|| BsdfSample::new(wi, [weight; 3], Density::Pdf(pdf)))
    }
}

fn main() -> Result<(), etalon_stats::Error> {
    let wos = [20f64, 60.0].map(|degrees| [degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()]);
    for (name, has_cosine) in [("right", true), ("without the cosine in weights", false)] {
        let report = test(name, &Phong { exponent: 20.0, has_cosine }, &wos, &Protocol::default())?;
        println!("{report}");
    }
    Ok(())
}
