//! Limits: pairs of BSDFs that must agree, such as a rough surface of vanishing roughness and a mirror.

use super::contract::{Bsdf, Direction, Spectrum};
use super::subject::{Comparison, Subject};
use super::vector::place;
use crate::examine::Protocol;
use crate::outcome::Outcome;
use crate::stream::{Sobol, Stream};

/// Samples of each BSDF: points of a (0,2)-sequence.
const SAMPLES: u32 = 1 << 12;

/// Whether two BSDFs have the same values and pdfs, to a few last places: a lobe of weight 0 and none.
pub fn same_values(a: &dyn Bsdf, b: &dyn Bsdf, wo: Direction, protocol: &Protocol) -> Outcome {
    let [a, b] = [a, b].map(|bsdf| Subject::new(bsdf, wo, protocol, 0));
    let mut found = Comparison::default();
    let samples = a.samples();
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    for wi in sampled.chain(a.directions()) {
        let (f, g) = (a.eval(wi), b.eval(wi));
        for channel in 0..a.properties.channels {
            let rounding = || a.rounding(f[channel], [wo, wi], |o, i| a.bsdf.eval(o, i, &[])[channel]);
            let message = || format!("{} (values)", a.at(wi));
            found.equal([f[channel], g[channel]], a.last_places(f[channel]), rounding, message);
        }
        let (p, q) = (a.bsdf.pdf(wo, wi), b.bsdf.pdf(wo, wi));
        let rounding = || a.rounding(p, [wo, wi], |o, i| a.bsdf.pdf(o, i));
        found.equal([p, q], a.last_places(p), rounding, || format!("{} (pdfs)", a.at(wi)));
    }
    found.outcome("having the same values").unwrap_or_default()
}

/// Whether two BSDFs do the same to smooth light, to `tolerance` of white light: to light that is uniform, or grows along an
/// axis, above and below the surface. It says nothing about features smaller than that.
pub fn same_light(a: &dyn Bsdf, b: &dyn Bsdf, wo: Direction, tolerance: f64, protocol: &Protocol) -> Outcome {
    let [one, other] = [a, b].map(|bsdf| moments(bsdf, wo, protocol.seed));
    let mut found = Comparison::default();
    let lights = ["uniform light", "light from +x", "light from +y", "light from +z"];
    for (side, name) in ["above", "below"].into_iter().enumerate() {
        for (k, light) in lights.into_iter().enumerate() {
            for channel in 0..a.properties().channels {
                let both = [one[side][k][channel], other[side][k][channel]];
                let message = || format!("wo {}, {light} {name}", place(wo));
                found.equal(both, tolerance, || tolerance, message);
            }
        }
    }
    let outcome = found.outcome("doing the same to smooth light").unwrap_or_default();
    Outcome { detectable: Some(tolerance), samples: 2 * u64::from(SAMPLES), ..outcome }
}

/// The mean of weights, and of weights times each coordinate of wi; above the surface and below.
fn moments(bsdf: &dyn Bsdf, wo: Direction, seed: u64) -> [[Spectrum; 4]; 2] {
    let dimension = bsdf.properties().dimension;
    let mut sums = [[[0.0; 3]; 4]; 2];
    for i in 0..SAMPLES {
        let stream = Sobol::new(seed, 0, i);
        // Later numbers first: those that a lobe maps to directions are in one pair.
        let mut u: Vec<f64> = (0..dimension.div_ceil(2)).flat_map(|pair| stream.pair(pair as u32)).collect();
        u.reverse();
        u.truncate(dimension);
        let Some(sample) = bsdf.sample(wo, &u) else { continue };
        let [x, y, z] = sample.wi;
        let side = &mut sums[usize::from(z < 0.0)];
        for (sums, factor) in side.iter_mut().zip([1.0, x, y, z]) {
            for (sum, weight) in sums.iter_mut().zip(sample.weight) {
                *sum += factor * weight / f64::from(SAMPLES);
            }
        }
    }
    sums
}
