//! The BSDF of this program whose values are closest to those of another.

use crate::validation::families::{self, Family};
use etalon_core::error::{Error, Result};
use etalon_core::sampling::warp;
use etalon_stats::bsdf::{BatchBsdf, Energy, Family as _, Pair};
use rayon::prelude::*;
use serde::Serialize;

/// Values that are tried of each parameter in a round.
const STEPS: usize = 16;
/// Rounds over all parameters; each looks in an eighth of the range of the round before, around the best value.
const ROUNDS: i32 = 3;
const ZOOM: f64 = 8.0;
/// Angles of `wo` with the normal, in degrees.
const ANGLES: [f64; 4] = [10.0, 35.0, 60.0, 80.0];
/// Directions `wi` for each, along each side of a square of random numbers.
const SIDE: usize = 12;

/// A BSDF of this program.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Model {
    pub name: String,
    /// Names and values of its parameters.
    pub parameters: Vec<(String, f64)>,
    /// The root of the mean squared difference of f |cos θ| over that of the other's square.
    pub difference: f64,
}

/// Pairs of directions: of each `wi`, half are distributed by the cosine and half lie around the mirror direction of `wo`, where
/// glossy lobes are; where light passes, as many are on the other side.
fn pairs(transmits: bool) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for theta in ANGLES.map(f64::to_radians) {
        let wo = [theta.sin() * 0.8, theta.sin() * 0.6, theta.cos()];
        for i in 0..SIDE * SIDE {
            let u = [i % SIDE, i / SIDE].map(|k| (k as f64 + 0.5) / SIDE as f64);
            let w = warp::cosine_hemisphere(u);
            let near = (glam::DVec3::new(-wo[0], -wo[1], wo[2]) + 0.5 * u[0] * w).normalize();
            for wi in [w, near].map(|w| w.to_array()) {
                pairs.push([wo, wi]);
                if transmits {
                    pairs.push([wo, [wi[0], wi[1], -wi[2]]]);
                }
            }
        }
    }
    pairs
}

/// f |cos θ| in all channels of all pairs.
fn values(bsdf: &dyn BatchBsdf, pairs: &[Pair]) -> Result<Vec<f64>> {
    let u = vec![0.5; pairs.len() * bsdf.properties().eval_dimension];
    let values = bsdf.eval(pairs, &u)?;
    Ok(values.iter().zip(pairs).flat_map(|(f, [_, wi])| f.map(|f| f * wi[2].abs())).collect())
}

fn squares(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|x| x * x).sum()
}

/// The BSDF of this program, without those of the reports' errors, whose values are closest to those of `bsdf`: its parameters one
/// after the other, by ever smaller steps.
///
/// # Errors
/// [`Error::Input`] for a BSDF without positive values, such as one of delta lobes alone; those of its program.
pub fn closest(name: &str, bsdf: &dyn BatchBsdf) -> Result<Model> {
    let pairs = pairs(bsdf.properties().transmission);
    let wanted = values(bsdf, &pairs)?;
    let norm = squares(wanted.iter().copied());
    if !(norm > 0.0 && norm.is_finite()) {
        let message = "its values are 0 everywhere or not finite: no model is closest to it";
        return Err(Error::input(name.as_ref(), message));
    }
    let difference = |family: &Family, shares: &[f64]| -> Result<f64> {
        let found = values(&*family.with(&at(family, shares))?, &pairs)?;
        Ok((squares(found.iter().zip(&wanted).map(|(a, b)| a - b)) / norm).sqrt())
    };
    let fitted = |family: &Family| -> Result<Option<Model>> {
        if matches!(family.with(&at(family, &start(family)))?.properties().energy, Energy::MayExceedOne(_)) {
            return Ok(None);
        }
        let mut shares = start(family);
        let mut least = difference(family, &shares)?;
        for round in 0..ROUNDS {
            let width = ZOOM.powi(-round);
            for parameter in 0..shares.len() {
                let middle = shares[parameter].clamp(0.5 * width, 1.0 - 0.5 * width);
                for step in 0..=STEPS {
                    let mut tried = shares.clone();
                    tried[parameter] = middle + width * (step as f64 / STEPS as f64 - 0.5);
                    let found = difference(family, &tried)?;
                    if found < least {
                        (shares, least) = (tried, found);
                    }
                }
            }
        }
        let names = family.parameters().into_iter().map(|parameter| parameter.name);
        let parameters = names.zip(at(family, &shares)).collect();
        Ok(Some(Model { name: family.name().to_owned(), parameters, difference: least }))
    };
    let families = families::all();
    let models = families.par_iter().map(fitted).collect::<Result<Vec<_>>>()?;
    let best = models.into_iter().flatten().min_by(|a, b| a.difference.total_cmp(&b.difference));
    best.ok_or_else(|| Error::input(name.as_ref(), "there is no model to compare it with"))
}

/// The middle of all ranges, as shares of them.
fn start(family: &Family) -> Vec<f64> {
    vec![0.5; family.parameters().len()]
}

/// The parameters at these shares of their ranges.
fn at(family: &Family, shares: &[f64]) -> Vec<f64> {
    family.parameters().iter().zip(shares).map(|(parameter, share)| parameter.at(*share)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// BSDFs of the program are found again, with their parameters.
    #[test]
    fn the_closest_model_of_a_model_is_itself() {
        let all = families::all();
        for (name, chosen) in [("diffuse", 0.37), ("oren-nayar", 0.3), ("ggx", 0.2)] {
            let family = all.iter().find(|family| family.name() == name).unwrap();
            let first = family.parameters()[0].name.clone();
            let values = families::values(family, &[(first, chosen)]).unwrap();
            let found = closest(name, &*family.with(&values).unwrap()).unwrap();
            assert!(found.difference < 0.05, "{name}: {found:?}");
        }
    }
}
