//! A program that tests a sampler of its own: `cargo run --release --example own_sampler`.
//!
//! The sampler returns directions around the normal with the pdf (n + 1) cosⁿ θ / 2π, the lobe of Phong's reflection model.

use etalon_stats::prelude::*;
use std::f64::consts::TAU;

const EXPONENT: f64 = 40.0;

fn pdf(w: [f64; 3]) -> f64 {
    (EXPONENT + 1.0) / TAU * w[2].max(0.0).powf(EXPONENT)
}

/// cos θ = (1 − u)^power, where `power` is 1/(n + 1) for the pdf above.
fn lobe(u: &[f64], power: f64) -> [f64; 3] {
    let cos = (1.0 - u[0]).powf(power);
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    let sin = (1.0 - cos * cos).sqrt();
    [sin * cos_phi, sin * sin_phi, cos]
}

fn main() -> Result<(), etalon_stats::Error> {
    let hemisphere = Directions::hemisphere(Pole::Z);
    let protocol = Protocol::default();
    for (name, power) in [("right", 1.0 / (EXPONENT + 1.0)), ("wrong by one", 1.0 / EXPONENT)] {
        let lobe = sampler(2, |u| {
            let w = lobe(u, power);
            Some(Sample::with_pdf(w, pdf(w)))
        });
        let outcome = validate(&hemisphere, &lobe, &density(pdf), &protocol)?;
        println!("{name}: {}", explain(&hemisphere, &outcome, &protocol));
    }
    Ok(())
}
