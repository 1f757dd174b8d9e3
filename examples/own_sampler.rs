//! How a crate tests a sampler of its own: `cargo run --release --example own_sampler`.
//!
//! The sampler draws directions around the normal with density (n + 1) cosⁿ θ / 2π, the lobe of Phong's reflection model.

use etalon::stats::{Directions, Draw, Pole, Protocol, density, sampler, validate};
use glam::DVec3;
use std::f64::consts::TAU;

const EXPONENT: f64 = 40.0;

fn pdf(w: DVec3) -> f64 {
    (EXPONENT + 1.0) / TAU * w.z.max(0.0).powf(EXPONENT)
}

/// Draws a direction; `power` is 1/(n + 1) if all is right.
fn lobe(u: &[f64], power: f64) -> DVec3 {
    let z = (1.0 - u[0]).powf(power);
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos_phi, r * sin_phi, z)
}

fn main() -> etalon::Result<()> {
    let hemisphere = Directions::hemisphere(Pole::Z);
    for (name, power) in [("right", 1.0 / (EXPONENT + 1.0)), ("wrong by one", 1.0 / EXPONENT)] {
        let lobe = sampler(2, |u| {
            let w = lobe(u, power);
            Some(Draw::with_pdf(w, pdf(w)))
        });
        println!("{name}: {}", validate(&hemisphere, &lobe, &density(pdf), &Protocol::default())?);
    }
    Ok(())
}
