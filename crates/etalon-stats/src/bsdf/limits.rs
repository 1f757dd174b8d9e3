//! Limits: pairs of BSDFs that must agree, such as a rough surface of vanishing roughness and a mirror.

use super::contract::{BatchBsdf, Direction, Pair, Spectrum};
use super::subject::{Comparison, Subject, channel_of, place};
use crate::error::Result;
use crate::examine::Protocol;
use crate::outcome::Outcome;
use crate::stream::{Sobol, Stream};

/// Samples of each BSDF: points of a (0,2)-sequence.
const SAMPLES: u32 = 1 << 12;

/// Whether two BSDFs have the same values and pdfs, to a few last places: a lobe of weight 0 and none.
///
/// # Errors
/// [`Error::External`](crate::Error::External) from a BSDF.
pub fn same_values(a: &dyn BatchBsdf, b: &dyn BatchBsdf, wo: Direction, protocol: &Protocol) -> Result<Outcome> {
    let a = Subject::new(a, wo, protocol, 0)?;
    let mut found = Comparison::default();
    let samples = a.samples()?;
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    let directions: Vec<Direction> = sampled.chain(a.directions()?).collect();
    let pairs = a.pairs(&directions);
    let mut compare = |[one, other]: [Vec<f64>; 2], value: &dyn Fn(&[Pair]) -> Result<Vec<f64>>, what: &str| {
        let numbers: Vec<[f64; 2]> = one.into_iter().zip(other).map(|(f, g)| [g, f]).collect();
        let rounding = |far: &[usize]| {
            let (f, pairs): (Vec<f64>, Vec<Pair>) = far.iter().map(|&i| (numbers[i][1], pairs[i])).unzip();
            a.rounding(&f, &pairs, value)
        };
        found.equal(
            &numbers,
            |i| a.last_places(numbers[i][1]),
            rounding,
            |i| (Some(directions[i]), format!("{} ({what})", a.at(directions[i]))),
        )
    };
    let (f, g) = (a.bsdf.eval(&pairs, &[])?, b.eval(&pairs, &[])?);
    for channel in 0..a.properties.channels {
        let eval = |pairs: &[Pair]| Ok(channel_of(&a.bsdf.eval(pairs, &[])?, channel));
        compare([channel_of(&f, channel), channel_of(&g, channel)], &eval, "values")?;
    }
    compare([a.bsdf.pdf(&pairs)?, b.pdf(&pairs)?], &|pairs| a.bsdf.pdf(pairs), "pdfs")?;
    Ok(found.outcome("having the same values").unwrap_or_default())
}

/// Whether two BSDFs do the same to smooth light, to `tolerance` of white light: to light that is uniform, or grows along an
/// axis, above and below the surface. It says nothing about features smaller than that.
///
/// # Errors
/// [`Error::External`](crate::Error::External) from a BSDF.
pub fn same_light(
    a: &dyn BatchBsdf,
    b: &dyn BatchBsdf,
    wo: Direction,
    tolerance: f64,
    protocol: &Protocol,
) -> Result<Outcome> {
    let (one, other) = (moments(a, wo, protocol.seed)?, moments(b, wo, protocol.seed)?);
    let mut found = Comparison::default();
    let lights = ["uniform light", "light from +x", "light from +y", "light from +z"];
    for (side, name) in ["above", "below"].into_iter().enumerate() {
        for (k, light) in lights.into_iter().enumerate() {
            for channel in 0..a.properties().channels {
                let both = [one[side][k][channel], other[side][k][channel]];
                found.near(&[both], |_| tolerance, |_| (None, format!("wo {}, {light} {name}", place(wo))))?;
            }
        }
    }
    let outcome = found.outcome("doing the same to smooth light").unwrap_or_default();
    Ok(Outcome { detectable: Some(tolerance), samples: 2 * u64::from(SAMPLES), ..outcome })
}

/// The mean of weights, and of weights times each coordinate of wi; above the surface and below.
fn moments(bsdf: &dyn BatchBsdf, wo: Direction, seed: u64) -> Result<[[Spectrum; 4]; 2]> {
    let dimension = bsdf.properties().dimension;
    let of_sample = |i: u32| {
        let stream = Sobol::new(seed, 0, i);
        // Later numbers first: those that a lobe maps to directions are in one pair.
        let mut u: Vec<f64> = (0..dimension.div_ceil(2)).flat_map(|pair| stream.pair(pair as u32)).collect();
        u.reverse();
        u.truncate(dimension);
        u
    };
    let u: Vec<f64> = (0..SAMPLES).flat_map(of_sample).collect();
    let mut sums = [[[0.0; 3]; 4]; 2];
    for sample in bsdf.sample(&vec![wo; SAMPLES as usize], &u)?.into_iter().flatten() {
        let [x, y, z] = sample.wi;
        let side = &mut sums[usize::from(z < 0.0)];
        for (sums, factor) in side.iter_mut().zip([1.0, x, y, z]) {
            for (sum, weight) in sums.iter_mut().zip(sample.weight) {
                *sum += factor * weight / f64::from(SAMPLES);
            }
        }
    }
    Ok(sums)
}
