//! One configuration of a sweep: values of the parameters, a direction, and a seed; as text, and from text.

use crate::bsdf::{Direction, Family};
use crate::error::{Error, Result};

/// A BSDF of a family seen from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// Values of the parameters, in their order.
    pub values: Vec<f64>,
    /// The angle of `wo` with the normal and its azimuth, in degrees.
    pub wo: [f64; 2],
    /// The seed of its random numbers.
    pub seed: u64,
}

/// The largest angle of `wo` with the normal, in degrees: directions along the surface are not tested, as nothing is
/// scattered to them.
pub(super) const LARGEST_ANGLE: f64 = 89.99;
/// The angle of directions along the surface with the normal, in degrees.
const HORIZON: f64 = 90.0;

impl Configuration {
    /// The default values, seen from 45°.
    #[must_use]
    pub fn default_of(family: &dyn Family) -> Self {
        let values = family.parameters().iter().map(|parameter| parameter.value).collect();
        Self { values, wo: [45.0, 0.0], seed: 1 }
    }

    /// The direction, in the precision of a BSDF that computes with this machine epsilon.
    #[must_use]
    pub fn direction(&self, precision: f64) -> Direction {
        let [theta, phi] = self.wo.map(f64::to_radians);
        let (sin, cos) = libm::sincos(theta);
        let (y, x) = libm::sincos(phi);
        // Multiples of 90° are exact.
        let clean = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
        let w = [clean(sin * x), clean(sin * y), cos];
        if precision < f64::from(f32::EPSILON) { w } else { w.map(|x| f64::from(x as f32)) }
    }

    /// As [`parse`](Self::parse) reads it, to the last bit: `ggx alpha=0.3 wo=45,0 seed=1`.
    #[must_use]
    pub fn text(&self, family: &dyn Family) -> String {
        let parameters = family.parameters();
        let values: String =
            parameters.iter().zip(&self.values).map(|(p, value)| format!(" {}={value}", p.name)).collect();
        format!("{}{values} wo={},{} seed={}", family.name(), self.wo[0], self.wo[1], self.seed)
    }

    /// Reads the part of a text after the name of the family. Parameters that are left out have their default values, `wo`
    /// is at 45°, the seed 1. The second result is the name after `check=`, if there is one.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the name `replay`.
    pub fn parse(family: &dyn Family, text: &str) -> Result<(Self, Option<String>)> {
        let parameters = family.parameters();
        let (mut found, mut check) = (Self::default_of(family), None);
        let refuse = |message: String, hint: &'static str| Err(Error::parameter("replay", message, hint));
        let mut seen = Vec::new();
        for word in text.split_whitespace() {
            let Some((name, value)) = word.split_once('=') else {
                return refuse(format!("\"{word}\" is not NAME=VALUE"), "as in alpha=0.3 wo=75,0 seed=1");
            };
            if seen.contains(&name) {
                return refuse(format!("{name} is given twice"), "give each name once");
            }
            seen.push(name);
            let number = || value.parse::<f64>().ok().filter(|number| number.is_finite());
            let unreadable = || format!("{name}={value} cannot be read");
            match name {
                "check" => check = Some(value.to_owned()),
                "seed" => match value.parse() {
                    Ok(seed) => found.seed = seed,
                    Err(_) => return refuse(unreadable(), "a seed is a whole number"),
                },
                "wo" => {
                    let (theta, phi) = value.split_once(',').unwrap_or((value, "0"));
                    let angles = [theta, phi].map(|angle| angle.parse::<f64>().ok().filter(|angle| angle.is_finite()));
                    let [Some(theta), Some(phi)] = angles else {
                        return refuse(unreadable(), "the angle to the normal and the azimuth in degrees: wo=75,0");
                    };
                    if !(0.0..=180.0).contains(&theta) || (theta - HORIZON).abs() < HORIZON - LARGEST_ANGLE - 1e-9 {
                        return refuse(unreadable(), "angles to the normal are 0 to 89.99 and 90.01 to 180 degrees");
                    }
                    found.wo = [theta, phi];
                }
                _ => {
                    let Some(index) = parameters.iter().position(|parameter| parameter.name == name) else {
                        let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
                        let message = format!("{} has no parameter {name}, but {}", family.name(), names.join(", "));
                        return refuse(message, "besides there are wo, seed and check");
                    };
                    let Some(number) = number() else { return refuse(unreadable(), "a value is a number") };
                    let [from, to] = parameters[index].range;
                    if !(from..=to).contains(&number) {
                        return refuse(
                            format!("{name}={value} is not from {from} to {to}"),
                            "sweeps stay in this range",
                        );
                    }
                    found.values[index] = number;
                }
            }
        }
        Ok((found, check))
    }
}
