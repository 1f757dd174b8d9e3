//! The BSDF of this program whose values are closest to those of another.

use crate::validation::families::{self, Family};
use etalon_core::bsdf::Bsdf;
use etalon_core::error::{Error, Result};
use etalon_core::sampling::warp;
use etalon_stats::bsdf::{BatchBsdf, Family as _, Pair, Parameter};
use rayon::prelude::*;
use serde::Serialize;

/// Values that are tried of each parameter in a round.
const STEPS: usize = 16;
/// Widths of the rounds, in parts of the range of a parameter, and most rounds of each: where the effects of two parameters are alike,
/// many short steps lead along the valley.
const WIDTHS: [f64; 4] = [1.0, 0.25, 0.06, 0.015];
const ROUNDS: usize = 12;
/// A round that leaves more of the difference is the last of its width.
const PROGRESS: f64 = 0.999;
/// The model with the fewest parameters is chosen among those whose differences are larger than the least by no more than this.
const AS_CLOSE: f64 = 0.005;
/// Angles of `wo` with the normal, in degrees, and its azimuths, which tell apart the widths along x and y.
const ANGLES: [f64; 4] = [10.0, 35.0, 60.0, 80.0];
const AZIMUTHS: [[f64; 2]; 2] = [[0.96, 0.28], [-0.28, 0.96]];
/// Directions `wi` for each, along each side of a square of random numbers.
const SIDE: usize = 8;

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
    for (theta, [x, y]) in ANGLES.into_iter().flat_map(|theta| AZIMUTHS.map(|azimuth| (theta.to_radians(), azimuth))) {
        let wo = [theta.sin() * x, theta.sin() * y, theta.cos()];
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

/// The BSDF of this program whose values are closest to those of `bsdf`, and its family: the parameters of each family are fitted one after the other,
/// by ever smaller steps. Left out are the errors of the reports, BSDFs of multiple scattering, whose tables take long to compute for
/// each width, and those that transmit where `bsdf` does not, or the reverse.
///
/// # Errors
/// [`Error::Input`] for a BSDF without positive values, such as one of delta lobes alone; those of its program.
pub fn closest(name: &str, bsdf: &dyn BatchBsdf) -> Result<(Model, Family)> {
    let transmits = bsdf.properties().transmission;
    let pairs = pairs(transmits);
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
    let fitted = |family: Family| -> Result<Option<(Model, Family)>> {
        let parameters = family.parameters();
        let mut shares: Vec<f64> = parameters.iter().map(share).collect();
        let usual = at(&family, &shares);
        let is_left_out = matches!(
            family.bsdf(&usual),
            Bsdf::CompensatedBeckmann(_) | Bsdf::CompensatedGgx(_) | Bsdf::ErrataConductor(_)
        );
        if is_left_out || family.with(&usual)?.properties().transmission != transmits {
            return Ok(None);
        }
        let mut least = difference(&family, &shares)?;
        for width in WIDTHS {
            for round in 0..ROUNDS {
                let before = least;
                for (i, parameter) in parameters.iter().enumerate() {
                    let middle = shares[i].clamp(0.5 * width, 1.0 - 0.5 * width);
                    // At first both widths of a surface together
                    let stem = parameter.name.strip_suffix("_x").filter(|_| width == 1.0 && round == 0);
                    let across =
                        stem.and_then(|stem| parameters.iter().position(|other| other.name == format!("{stem}_y")));
                    for step in 0..=STEPS {
                        let mut tried = shares.clone();
                        let share = middle + width * (step as f64 / STEPS as f64 - 0.5);
                        [Some(i), across].into_iter().flatten().for_each(|k| tried[k] = share);
                        let found = difference(&family, &tried)?;
                        if found < least {
                            (shares, least) = (tried, found);
                        }
                    }
                }
                if least > PROGRESS * before {
                    break;
                }
            }
        }
        let names = parameters.into_iter().map(|parameter| parameter.name);
        let parameters = names.zip(at(&family, &shares)).collect();
        let model = Model { name: family.name().to_owned(), parameters, difference: least };
        Ok(Some((model, family)))
    };
    let models = families::all().into_par_iter().map(fitted).collect::<Result<Vec<_>>>()?;
    let models: Vec<(Model, Family)> = models.into_iter().flatten().collect();
    let least = models.iter().map(|(model, _)| model.difference).fold(f64::INFINITY, f64::min);
    let as_close = models.into_iter().filter(|(model, _)| model.difference <= least + AS_CLOSE);
    let best = as_close.min_by(|(a, _), (b, _)| {
        let parameters = a.parameters.len().cmp(&b.parameters.len());
        parameters.then(a.difference.total_cmp(&b.difference))
    });
    best.ok_or_else(|| Error::input(name.as_ref(), "there is no model to compare it with"))
}

/// Where in its range a parameter is by default, from 0 to 1: the inverse of [`Parameter::at`].
fn share(parameter: &Parameter) -> f64 {
    let [from, to] = parameter.range;
    let scaled = |x: f64| if parameter.is_logarithmic() { x.ln() } else { x };
    (scaled(parameter.value) - scaled(from)) / (scaled(to) - scaled(from))
}

/// The parameters at these shares of their ranges.
fn at(family: &Family, shares: &[f64]) -> Vec<f64> {
    family.parameters().iter().zip(shares).map(|(parameter, share)| parameter.at(*share)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// BSDFs of the program are found again.
    #[test]
    fn the_closest_model_of_a_model_is_itself() {
        let all = families::all();
        for (name, chosen) in [
            ("diffuse", &[("albedo", 0.37)][..]),
            ("oren-nayar", &[("sigma_deg", 45.0)]),
            ("ggx", &[("alpha_x", 0.2), ("alpha_y", 0.5), ("k", 10.0)]),
            ("ggx-dielectric", &[("eta", 1.3)]),
        ] {
            let family = all.iter().find(|family| family.name() == name).unwrap();
            let chosen: Vec<(String, f64)> = chosen.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
            let (found, _) =
                closest(name, &*family.with(&families::values(family, &chosen).unwrap()).unwrap()).unwrap();
            assert!(found.name == name && found.difference < 0.03, "{found:?}");
        }
    }
}
