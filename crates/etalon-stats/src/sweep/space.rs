//! The space of a family's parameters and of directions, and the strategies that choose configurations from it; a configuration,
//! which is values of the parameters, a direction, and a seed, as text, and from text.

use crate::bsdf::{Direction, Family, Parameter};
use crate::error::{Error, Result};
use crate::extremes::Extremes;
use crate::hash::{mix64, unit_f64};

/// How configurations are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strategy {
    /// All combinations of equally spaced values of every parameter, ends included, and angles.
    Grid,
    /// A low-discrepancy sequence, shifted at random.
    #[default]
    Random,
    /// Combinations of special values: ends of ranges, default values, 1 and both sides of it, two parameters that are equal,
    /// directions along the normal, the surface and the tangents.
    Edges,
}

/// The configurations of a family that a strategy visits.
pub struct Space {
    parameters: Vec<Parameter>,
    strategy: Strategy,
    /// 1, or 2 if light is transmitted: `wo` lies above the surface, or on either side. 0 without directions.
    sides: u64,
    /// For the grid: values of each parameter, and angles on each side.
    levels: [u64; 2],
    /// For the edges: choices of each parameter, then of the angle and of the azimuth.
    choices: Vec<Vec<Choice>>,
    len: u64,
    /// Seed of this family alone.
    seed: u64,
}

/// A value of an axis of the edges.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Choice {
    /// This one.
    Value(f64),
    /// That of the parameter before.
    Equal,
    /// Any of the range.
    Inside,
}

/// The distance of the special values 1 − 10⁻³ and 1 + 10⁻³ from 1.
const NEAR_ONE: f64 = 1e-3;
/// Angles with the normal: along it, beside it, in between, and along the surface.
const ANGLES: [Choice; 5] =
    [Choice::Value(0.0), Choice::Value(0.01), Choice::Inside, Choice::Value(89.0), Choice::Value(LARGEST_ANGLE)];
/// Azimuths: of both tangents, and between.
const AZIMUTHS: [Choice; 3] = [Choice::Value(0.0), Choice::Value(90.0), Choice::Inside];

impl Space {
    /// At most `configurations` of a family.
    ///
    /// # Errors
    /// Those of [`Family::with`].
    pub fn new(family: &dyn Family, strategy: Strategy, configurations: u64, seed: u64) -> Result<Self> {
        let parameters = family.parameters();
        let defaults: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
        let sides = if family.with(&defaults)?.properties().transmission { 2 } else { 1 };
        Ok(Self::over(family.name(), parameters, sides, strategy, configurations, seed))
    }

    /// At most `configurations` of what is called `name` and has these parameters, seen from a number of `sides`; 0 for what has no directions.
    pub(super) fn over(
        name: &str,
        parameters: Vec<Parameter>,
        sides: u64,
        strategy: Strategy,
        configurations: u64,
        seed: u64,
    ) -> Self {
        let each_side = (configurations / sides.max(1)).max(1);
        // As many values of each parameter as of the angle, and what remains for the angle.
        let axes = parameters.len() as u32 + 1;
        let values = (1..).take_while(|n: &u64| n.checked_pow(axes).is_some_and(|all| all <= each_side)).take(1 << 20);
        let values = if axes == 1 { 1 } else { values.last().unwrap_or(1) };
        let levels = [values, each_side / values.pow(axes - 1)];
        let mut choices: Vec<Vec<Choice>> = (0..parameters.len()).map(|i| special(&parameters, i)).collect();
        if sides > 0 {
            choices.extend([ANGLES.to_vec(), AZIMUTHS.to_vec()]);
        }
        let combinations = choices.iter().map(|choices| choices.len() as u64).product::<u64>() * sides.max(1);
        let len = match strategy {
            Strategy::Grid => sides.max(1) * levels[0].pow(axes - 1) * levels[1],
            Strategy::Random => configurations,
            Strategy::Edges => combinations.min(configurations),
        };
        // Families have random numbers of their own.
        let seed = name.bytes().fold(mix64(seed), |seed, byte| mix64(seed ^ u64::from(byte)));
        Self { parameters, strategy, sides, levels, choices, len, seed }
    }

    /// The number of configurations.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The configuration of that number, from 0.
    #[must_use]
    pub fn get(&self, number: u64) -> Configuration {
        let dimension = self.parameters.len() + 3;
        let shares: Vec<f64> = (0..dimension).map(|axis| self.share(number, axis, dimension)).collect();
        let (values, angles) = match self.strategy {
            Strategy::Grid => self.on_grid(number),
            Strategy::Random => {
                let values =
                    self.parameters.iter().zip(&shares).map(|(parameter, &share)| parameter.at(share)).collect();
                (values, self.angles(&shares))
            }
            Strategy::Edges => self.at_edges(number, &shares),
        };
        let [theta, azimuth, side] = angles;
        let theta = if side < 0.5 { theta } else { 180.0 - theta };
        let rounded = |(value, parameter): (f64, &Parameter)| {
            let [from, to] = parameter.range;
            if [from, to, parameter.value].contains(&value) { value } else { short(value).within(from, to) }
        };
        // Half a word for the seed: it is a part of what users type.
        let seed = mix64(self.seed ^ number) >> 32;
        let wo = [theta, azimuth].map(|angle| (100.0 * angle).round() / 100.0);
        Configuration { values: values.into_iter().zip(&self.parameters).map(rounded).collect(), wo, seed }
    }

    /// A coordinate of the low-discrepancy sequence: number · φ⁻ᵃ plus a random shift, modulo 1, with φ the root of
    /// φᵈ⁺¹ = φ + 1.
    ///
    /// Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.
    fn share(&self, number: u64, axis: usize, dimension: usize) -> f64 {
        let root = (0..64).fold(1.5f64, |root, _| (1.0 + root).powf(1.0 / (dimension as f64 + 1.0)));
        let shift = unit_f64(mix64(self.seed.wrapping_add(axis as u64 + 1)));
        (shift + number as f64 * root.powi(-(axis as i32 + 1))).fract()
    }

    /// Angle, azimuth and side by the last three coordinates.
    fn angles(&self, shares: &[f64]) -> [f64; 3] {
        let [.., theta, azimuth, side] = shares else { return [0.0; 3] };
        [LARGEST_ANGLE * theta, 360.0 * azimuth, if self.sides > 1 { *side } else { 0.0 }]
    }

    /// The angle is the fastest index. The azimuth turns by the golden angle from each to the next.
    fn on_grid(&self, number: u64) -> (Vec<f64>, [f64; 3]) {
        let [values, angles] = self.levels;
        let mut rest = number;
        let mut digit = |base: u64| {
            let digit = rest % base;
            rest /= base;
            digit
        };
        let of = |level: u64, levels: u64| level as f64 / (levels - 1) as f64;
        let level = digit(angles);
        let theta = if angles > 1 { LARGEST_ANGLE * of(level, angles) } else { 45.0 };
        let side = digit(self.sides.max(1)) as f64;
        let value = |parameter: &Parameter| {
            let level = digit(values);
            if values > 1 { parameter.at(of(level, values)) } else { parameter.value }
        };
        let values = self.parameters.iter().map(value).collect();
        (values, [theta, 360.0 * (number as f64 * 0.618_033_988_749_895).fract(), side])
    }

    /// All combinations; where they are too many, some that a golden stride spreads over all.
    fn at_edges(&self, number: u64, shares: &[f64]) -> (Vec<f64>, [f64; 3]) {
        let combinations = self.choices.iter().map(|choices| choices.len() as u64).product::<u64>() * self.sides.max(1);
        let stride = coprime((combinations as f64 * 0.618_033_988_749_895) as u64, combinations);
        let spread = u128::from(number) * u128::from(stride) % u128::from(combinations);
        let mut rest = if self.len < combinations { spread as u64 } else { number };
        let side = (rest % self.sides.max(1)) as f64;
        rest /= self.sides.max(1);
        let [.., theta, azimuth, _] = self.angles(shares)[..] else { return (Vec::new(), [0.0; 3]) };
        let inside: Vec<f64> =
            self.parameters.iter().zip(shares).map(|(parameter, &share)| parameter.at(share)).collect();
        let mut chosen: Vec<f64> = Vec::new();
        for (choices, inside) in self.choices.iter().zip(inside.into_iter().chain([theta, azimuth])) {
            let choice = choices[(rest % choices.len() as u64) as usize];
            rest /= choices.len() as u64;
            chosen.push(match choice {
                Choice::Value(value) => value,
                Choice::Equal => chosen.last().copied().unwrap_or(inside),
                Choice::Inside => inside,
            });
        }
        let directions = chosen.split_off(self.parameters.len());
        (chosen, [directions.first().copied().unwrap_or(theta), directions.get(1).copied().unwrap_or(azimuth), side])
    }
}

/// The choices of a parameter.
fn special(parameters: &[Parameter], index: usize) -> Vec<Choice> {
    let Parameter { value, range: [from, to], .. } = parameters[index];
    let mut values = vec![value, from, to];
    if from < 1.0 - NEAR_ONE && to > 1.0 + NEAR_ONE {
        values.extend([1.0, 1.0 - NEAR_ONE, 1.0 + NEAR_ONE]);
    }
    let mut choices: Vec<Choice> = Vec::new();
    for value in values {
        if !choices.contains(&Choice::Value(value)) {
            choices.push(Choice::Value(value));
        }
    }
    // Two widths of one surface, for example.
    if index > 0 && parameters[index - 1].range == [from, to] {
        choices.push(Choice::Equal);
    }
    choices.push(Choice::Inside);
    choices
}

/// The next number from `n` that has no divisor with `of` in common.
fn coprime(n: u64, of: u64) -> u64 {
    let divisor = |mut a: u64, mut b: u64| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    (n.max(1)..).find(|&n| divisor(n, of) == 1).unwrap_or(1)
}

/// A value with four digits.
fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

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
const LARGEST_ANGLE: f64 = 89.99;
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
