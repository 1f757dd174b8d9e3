//! Inputs of a family in text: `fresnel:eta=0.999..1.001,cos=0x1p-3`, each a number or a range.

use super::family::Family;
use super::registry::{families, names};
use etalon_core::error::{Error, Result};
use etalon_core::import::place::number;

/// The family, and the ends of the range of each of its inputs, which are equal where one number is given. Numbers are
/// decimals or hexadecimal floats, and all inputs must be there, in any order.
///
/// # Errors
/// [`Error::Parameter`] of that `parameter` for anything else.
pub fn parse(text: &str, parameter: &'static str) -> Result<(&'static Family, Vec<[f64; 2]>)> {
    let (name, inputs) = text.split_once(':').unwrap_or((text, ""));
    let Some(family) = families().find(|family| family.name == name) else {
        let known: Vec<_> = families().map(|family| family.name).collect();
        let what = if names().any(|known| known == name) { "an experiment, not a formula" } else { "no family" };
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
