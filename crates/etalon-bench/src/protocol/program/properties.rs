//! What a BSDF in another program declares of itself, by keys.

use super::greeting::Greeting;
use super::sampler::DIMENSIONS;
use etalon_core::error::Result;
use etalon_core::import::place::real;
use etalon_stats::bsdf::{Energy, PdfKind, Properties, Reciprocity};

/// `known` with those that `greeting` has keys for in their place.
pub fn declared(known: Properties, greeting: &Greeting) -> Result<Properties> {
    let mut properties = known;
    for (key, value) in &greeting.keys {
        declare(&mut properties, key, value).ok_or_else(|| greeting.meaningless(key, value))?;
    }
    if has_sound_map(&properties) {
        Ok(properties)
    } else {
        Err(greeting.wrong("has a map that is not of two different random numbers of a sample"))
    }
}

/// Whether the map, if there is one, is of two different random numbers of a sample.
#[must_use]
pub fn has_sound_map(properties: &Properties) -> bool {
    let in_range = |axis: usize| axis < properties.dimension;
    properties.map.is_none_or(|[a, b]| a != b && in_range(a) && in_range(b))
}

/// Declares a property by its key; `None` where key or value has no meaning.
#[must_use]
pub fn declare(properties: &mut Properties, key: &str, value: &str) -> Option<()> {
    let yes = || match value {
        "yes" => Some(true),
        "no" => Some(false),
        _ => None,
    };
    let count = |least: usize| value.parse().ok().filter(|n| (least..=DIMENSIONS).contains(n));
    match key {
        "channels" => properties.channels = value.parse().ok().filter(|n| [1, 3].contains(n))?,
        "scatters" => {
            (properties.reflection, properties.transmission) = match value {
                "reflection" => (true, false),
                "transmission" => (false, true),
                "both" => (true, true),
                _ => return None,
            }
        }
        "delta" => properties.delta = yes()?,
        "eta" => properties.eta = real(value).filter(|eta| *eta > 0.0 && eta.is_finite())?,
        "reciprocal" => {
            let reason = Reciprocity::Not("the program says so");
            properties.reciprocity = if yes()? { Reciprocity::Reciprocal } else { reason };
        }
        "energy" => {
            properties.energy = match value.split_once(':').unwrap_or((value, "0")) {
                ("at-most-1", "0") => Energy::AtMostOne,
                ("any", "0") => Energy::MayExceedOne("the program says so"),
                ("conserved", error) => {
                    Energy::Conserved(real(error).filter(|error| *error >= 0.0 && error.is_finite())?)
                }
                _ => return None,
            }
        }
        "pdf" => {
            properties.pdf = match value {
                "exact" => PdfKind::Exact,
                "approximate" => PdfKind::Approximate,
                "none" => PdfKind::None,
                _ => return None,
            }
        }
        "dimension" => properties.dimension = count(1)?,
        "map" => {
            let (a, b) = value.split_once(',')?;
            properties.map = Some([a.parse().ok()?, b.parse().ok()?]);
        }
        "stochastic" => properties.eval_dimension = count(0)?,
        "precision" => {
            properties.precision = match value {
                "single" => f64::from(f32::EPSILON),
                "double" => f64::EPSILON,
                _ => return None,
            }
        }
        _ => return None,
    }
    Some(())
}
