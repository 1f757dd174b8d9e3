//! Replay of one input, text such as `fresnel:eta=1.5,cos=0x1p-3`, by every variant in every precision.

use super::REGISTRY;
use super::family::Family;
use super::number::Precision;
use super::special;
use super::sweep::{Exact, Flaw, case};
use etalon_core::error::{Error, Result};
use etalon_core::import::place::number;
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
    let (family, inputs) = parse(text)?;
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

/// The family and its inputs.
fn parse(text: &str) -> Result<(&'static Family, Vec<f64>)> {
    let (name, inputs) = text.split_once(':').unwrap_or((text, ""));
    let Some(family) = REGISTRY.into_iter().find(|family| family.name == name) else {
        let known: Vec<_> = REGISTRY.iter().map(|family| family.name).collect();
        let what = if name == special::NAME { "many formulas, not one" } else { "no family" };
        return Err(Error::parameter("case", format!("\"{name}\" is {what}"))
            .with_hint(format!("formulas: {}", known.join(", "))));
    };
    let refuse = |message: String| {
        let usage: Vec<String> = family.inputs.iter().map(|name| format!("{name}=…")).collect();
        Error::parameter("case", message).with_hint(format!("give {}:{}", family.name, usage.join(",")))
    };
    let mut values = vec![None; family.inputs.len()];
    for part in inputs.split(',').filter(|part| !part.is_empty()) {
        let (name, value) = part.split_once('=').ok_or_else(|| refuse(format!("\"{part}\" is not NAME=NUMBER")))?;
        let Some(place) = family.inputs.iter().position(|input| *input == name.trim()) else {
            return Err(refuse(format!("{} has no input \"{name}\"", family.name)));
        };
        let number = number(value.trim()).filter(|x| x.is_finite() && (*x as f32).is_finite());
        let number = number.ok_or_else(|| refuse(format!("\"{value}\" is not a number that f32 can hold")))?;
        if let Some((least, largest)) = family.domains.get(place).filter(|(a, b)| !(*a..=*b).contains(&number)) {
            return Err(refuse(format!("{name} = {value} is not from {least:e} to {largest:e}")));
        }
        if values[place].replace(number).is_some() {
            return Err(refuse(format!("\"{name}\" is given twice")));
        }
    }
    match values.iter().position(Option::is_none) {
        Some(place) => Err(refuse(format!("input \"{}\" is missing", family.inputs[place]))),
        None => Ok((family, values.into_iter().flatten().collect())),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{STABLE, Section};
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
}
