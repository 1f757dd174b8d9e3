//! Replay of one input by every variant in every precision; and a search for the worst inputs within ranges, by random numbers that
//! are uniform over the floating-point numbers of each range, so that every power of two counts as much as any other. Inputs are
//! text: `fresnel:eta=0.999..1.001,cos=0x1p-3`, each a number or a range.

use super::REGISTRY;
use super::family::Family;
use super::number::Precision;
use super::special;
use super::sweep::{Exact, Flaw, Sweep, case};
use etalon_core::error::{Error, Result};
use etalon_core::import::place::number;
use etalon_core::sampling::stream::CounterRng;
use rand::RngExt;
use serde::Serialize;

/// One variant at the input.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Replayed {
    pub variant: &'static str,
    pub precision: Precision,
    /// Empty where there is no value, as for a ray that misses; one number, or the three of a vector.
    pub value: Vec<f64>,
    /// The exact value, likewise.
    pub reference: Vec<f64>,
    /// Error in units of the last place.
    pub ulp: f64,
    /// Error relative to the exact value.
    pub relative: f64,
    pub condition: f64,
    /// `not finite`, `negative`, `out of range`, or nothing.
    pub flaw: &'static str,
}

/// All variants at one input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replay {
    pub family: &'static str,
    pub inputs: Vec<(&'static str, f64)>,
    /// One for each variant and precision.
    pub lines: Vec<Replayed>,
}

/// Runs a case such as `fresnel:eta=1.5,cos=0x1p-3`: numbers are decimals or hexadecimal floats, and all inputs of the
/// family must be there, in any order.
///
/// # Errors
/// [`Error::Parameter`] for anything else.
pub fn replay(text: &str) -> Result<Replay> {
    let (family, ranges) = parse(text, "case")?;
    let inputs: Vec<f64> = ranges.iter().map(|[from, _]| *from).collect();
    if ranges.iter().any(|[from, to]| from != to) {
        return Err(Error::parameter("case", "a range of inputs").with_hint("a replay is of one input: give numbers"));
    }
    let mut lines = Vec::new();
    for precision in Precision::ALL.into_iter().filter(|p| family.runs_in(*p)) {
        let case = case(family, precision, &inputs);
        let components = |value: [f64; 3]| value[..family.range.components()].to_vec();
        let reference = Exact::at(family.reference, &case.inputs).value.map(|value| value.map(|x| x.to_f64()));
        for (variant, deviation) in family.variants.iter().zip(&case.deviations) {
            let Some(deviation) = deviation else { continue };
            lines.push(Replayed {
                variant: variant.name,
                precision,
                value: deviation.value.map_or(Vec::new(), components),
                reference: reference.map_or(Vec::new(), components),
                ulp: deviation.ulp,
                relative: deviation.relative,
                condition: case.condition,
                flaw: match deviation.flaw {
                    Some(Flaw::NonFinite) => "not finite",
                    Some(Flaw::Negative) => "negative",
                    Some(Flaw::OutOfRange) => "out of range",
                    None => "",
                },
            });
        }
    }
    Ok(Replay { family: family.name, inputs: family.inputs.iter().copied().zip(inputs).collect(), lines })
}

/// Inputs that are tried, beside the ends of all ranges; fewer where the reference takes long.
const INPUTS: u64 = 1 << 14;

/// All cases of a family at random inputs such as `fresnel:eta=0.999..1.001,cos=0.1..1`.
pub fn at_random(text: &str, seed: u64) -> Result<Sweep> {
    let (family, ranges) = parse(text, "range")?;
    let count = INPUTS / (family.coarser * family.coarser) as u64;
    let random = (0..count).map(|number| {
        let mut rng = CounterRng::new(seed, number);
        ranges.iter().map(|range| between(*range, rng.random())).collect()
    });
    let corners = (0..1usize << ranges.len())
        .map(|corner| ranges.iter().enumerate().map(|(i, range)| range[corner >> i & 1]).collect());
    let inputs: Vec<Vec<f64>> = corners.chain(random).collect();
    Ok(Sweep::of_inputs(family, &inputs))
}

/// The floating-point number at share `u` of those from `from` to `to`.
fn between([from, to]: [f64; 2], u: f64) -> f64 {
    let [first, last] = [from, to].map(|end| i128::from(ordinal(end)));
    let at = first + ((last - first + 1) as f64 * u) as i128;
    of_ordinal(at.min(last) as i64)
}

/// The number's place among all floating-point numbers; 0 for both zeros.
fn ordinal(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    if bits < 0 { i64::MIN - bits } else { bits }
}

fn of_ordinal(place: i64) -> f64 {
    f64::from_bits(if place < 0 { i64::MIN - place } else { place } as u64)
}

/// The family, and the ends of the range of each of its inputs, which are equal where one number is given. Numbers are
/// decimals or hexadecimal floats, and all inputs must be there, in any order.
///
/// # Errors
/// [`Error::Parameter`] of that `parameter` for anything else.
pub fn parse(text: &str, parameter: &'static str) -> Result<(&'static Family, Vec<[f64; 2]>)> {
    let (name, inputs) = text.split_once(':').unwrap_or((text, ""));
    let Some(family) = REGISTRY.into_iter().find(|family| family.name == name) else {
        let known: Vec<_> = REGISTRY.iter().map(|family| family.name).collect();
        let what = if name == special::NAME { "many formulas, not one" } else { "no family" };
        return Err(Error::parameter(parameter, format!("\"{name}\" is {what}"))
            .with_hint(format!("formulas: {}", known.join(", "))));
    };
    let refuse = |message: String| {
        let usage: Vec<String> = family.inputs.iter().map(|name| format!("{name}=…")).collect();
        Error::parameter(parameter, message).with_hint(format!("give {}:{}", family.name, usage.join(",")))
    };
    let mut ranges = vec![None; family.inputs.len()];
    for part in inputs.split(',').filter(|part| !part.is_empty()) {
        let (name, value) = part.split_once('=').ok_or_else(|| refuse(format!("\"{part}\" is not NAME=NUMBER")))?;
        let Some(place) = family.inputs.iter().position(|input| *input == name.trim()) else {
            return Err(refuse(format!("{} has no input \"{name}\"", family.name)));
        };
        let (from, to) = value.split_once("..").unwrap_or((value, value));
        let end = |value: &str| {
            let number = number(value.trim()).filter(|x| x.is_finite() && (*x as f32).is_finite());
            let number = number.ok_or_else(|| refuse(format!("\"{value}\" is not a number that f32 can hold")))?;
            match family.domains.get(place) {
                Some((least, largest)) if !(*least..=*largest).contains(&number) => {
                    Err(refuse(format!("{name} = {value} is not from {least:e} to {largest:e}")))
                }
                _ => Ok(number),
            }
        };
        let range = [end(from)?, end(to)?];
        if range[0] > range[1] {
            return Err(refuse(format!("{name} = {value} is empty")));
        }
        if ranges[place].replace(range).is_some() {
            return Err(refuse(format!("\"{name}\" is given twice")));
        }
    }
    match ranges.iter().position(Option::is_none) {
        Some(place) => Err(refuse(format!("input \"{}\" is missing", family.inputs[place]))),
        None => Ok((family, ranges.into_iter().flatten().collect())),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{STABLE, Section, TEXTBOOK};
    use super::*;

    #[test]
    fn the_grids_and_edges_lie_in_the_domains() {
        for family in REGISTRY {
            let corners = |s: &Section| [s.x.from, s.x.to].map(|x| [s.y.from, s.y.to].map(|y| (s.at)(x, y)));
            let grid = family.sections.iter().flat_map(|s| corners(s).into_iter().flatten());
            for inputs in grid.chain(family.edges.iter().map(|edge| edge.to_vec())) {
                for ((least, largest), x) in family.domains.iter().zip(&inputs) {
                    assert!((least..=largest).contains(&x), "{}: {inputs:?}", family.name);
                }
            }
        }
    }

    #[test]
    fn variants_are_finite_to_the_ends_of_the_domain_of_indices() {
        for (eta, cos) in [("1e18", "0.5"), ("1e18", "0"), ("1e-18", "1"), ("1e-18", "0.5"), ("1e18", "1e-18")] {
            for line in super::replay(&format!("fresnel:eta={eta},cos={cos}")).unwrap().lines {
                assert!(line.variant != STABLE || line.relative < 1e-6, "{eta} {cos}: {line:?}");
            }
        }
    }

    #[test]
    fn a_case_is_run_in_all_variants_and_bad_ones_are_refused() {
        let replay = super::replay("fresnel:cos=0x1p-1,eta=1.5").unwrap();
        assert_eq!(replay.inputs, [("eta", 1.5), ("cos", 0.5)]);
        assert_eq!(replay.lines.len(), 6);
        assert!(replay.lines[0].relative < 1e-6 && replay.lines[0].value.len() == 1);
        let bad = "glass:eta=1.5 special-directions:eta=1.5 fresnel fresnel:eta=1.5 fresnel:eta=1.5,cos=NaN \
                   fresnel:eta=1.5,cos=inf fresnel:eta=1.5,cos=1e300 fresnel:eta=1.5,cos=0.5,eta=2 \
                   fresnel:eta=1.5,cos=0.5,k=2 fresnel:eta fresnel:eta=0,cos=0.5 fresnel:eta=-1,cos=0.5 \
                   fresnel:eta=1e20,cos=0.5 fresnel:eta=1.5,cos=1.5 refraction:eta=-1.5,x=0,y=0,z=1 \
                   conductor:eta=0.2,k=-3,cos=0.5 ggx-d:alpha=0,x=0,y=0,z=1";
        for text in bad.split(' ').chain([""]) {
            assert!(super::replay(text).unwrap_err().hint().is_some(), "{text}");
        }
    }

    #[test]
    fn ordinals_follow_each_other_and_lead_back() {
        let ascending = [f64::MIN, -1.0, -f64::from_bits(1), 0.0, f64::from_bits(1), 0.5, 1.0, 2.0, f64::MAX];
        assert!(ascending.windows(2).all(|pair| ordinal(pair[0]) < ordinal(pair[1])));
        assert!(ascending.iter().all(|&x| of_ordinal(ordinal(x)) == x));
        assert_eq!(ordinal(-0.0), 0);
        assert_eq!((between([-2.0, 3.0], 0.0), between([-2.0, 3.0], 1.0), between([7.0, 7.0], 0.5)), (-2.0, 3.0, 7.0));
    }

    #[test]
    fn the_worst_input_is_at_least_as_bad_as_a_known_one() {
        let rows = at_random("fresnel:eta=1.0001..1.001,cos=0.1..1", 1).unwrap().rows();
        let textbook = rows.iter().find(|row| row.variant == TEXTBOOK).unwrap();
        // The textbook's error at η = 1.0003 and cos θ = 1/8 is 1.5·10⁻⁴.
        assert!(textbook.max_relative > 1e-4 && textbook.worst.starts_with("fresnel:eta=1.000"), "{textbook:?}");
    }

    #[test]
    fn ranges_that_are_none_are_refused() {
        for bad in [
            "fresnel",
            "special-directions:eta=1..2",
            "fresnel:eta=2..1,cos=1",
            "fresnel:eta=1..,cos=1",
            "fresnel:eta=0..1,cos=1",
        ] {
            assert!(at_random(bad, 1).is_err(), "{bad}");
        }
    }
}
