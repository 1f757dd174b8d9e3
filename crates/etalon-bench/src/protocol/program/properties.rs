//! The greeting: a program describes what it has by keys with values, and lines below them; what a BSDF declares of itself by keys.

use super::connection::{Connection, protocol_error};
use super::sampler::DIMENSIONS;
use etalon_core::error::{Error, Result};
use etalon_core::import::place::{quote, real};
use etalon_stats::bsdf::{Energy, Kind, PdfKind, Properties, Reciprocity};

const VERSION: &str = "1";
/// Most lines below the first.
const LINES: usize = 4096;

/// Keys with values, in a line of a program's answer.
#[derive(Debug, Default)]
pub struct Greeting {
    /// The program's name in messages.
    pub program: String,
    first: String,
    /// Its keys and their values.
    pub keys: Vec<(String, String)>,
    pub lines: Vec<String>,
}

impl Greeting {
    /// Sends the request and parses the response.
    pub fn of(connection: &mut dyn Connection) -> Result<Self> {
        let answer = connection.ask(format!("etalon {VERSION}\n"), 1 + LINES)?;
        // Some programs begin whatever they write with a byte order mark.
        let mut lines = answer.strip_prefix('\u{feff}').unwrap_or(&answer).lines();
        let first = lines.next().unwrap_or_default();
        let greeting = Self { program: connection.name().to_owned(), first: first.to_owned(), ..Self::default() };
        let mut words = first.split_ascii_whitespace();
        if [words.next(), words.next()] != [Some("etalon"), Some(VERSION)] {
            return Err(greeting.wrong(&format!("does not begin with \"etalon {VERSION}\"")));
        }
        Self { lines: lines.map(str::to_owned).collect(), ..greeting }.with_keys(words)
    }

    /// The keys of `line`, an answer of the program to another request.
    pub fn of_line(program: &str, line: &str) -> Result<Self> {
        let greeting = Self { program: program.to_owned(), first: line.to_owned(), ..Self::default() };
        greeting.with_keys(line.split_ascii_whitespace())
    }

    fn with_keys<'a>(mut self, words: impl Iterator<Item = &'a str>) -> Result<Self> {
        for word in words {
            let (key, value) =
                word.split_once('=').ok_or_else(|| self.wrong(&format!("has {}, not KEY=VALUE", quote(word))))?;
            if self.keys.iter().any(|(known, _)| known == key) {
                return Err(self.wrong(&format!("has the key {} twice", quote(key))));
            }
            self.keys.push((key.to_owned(), value.to_owned()));
        }
        Ok(self)
    }

    /// The value of `key`, which is left out from then on.
    pub fn take(&mut self, key: &str) -> Option<String> {
        let at = self.keys.iter().position(|(known, _)| known == key)?;
        Some(self.keys.remove(at).1)
    }

    pub fn wrong(&self, message: &str) -> Error {
        protocol_error(&self.program, format!("its greeting {} {message}", quote(&self.first)))
    }

    /// The error for a key, or a value of it, that does not exist.
    pub fn meaningless(&self, key: &str, value: &str) -> Error {
        let error = self.wrong(&format!("has {}, which has no meaning", quote(&format!("{key}={value}"))));
        match key {
            "numbers" => error.with_hint("write hexadecimal floats (C's %a, Python's float.hex): they are exact"),
            _ => error,
        }
    }
}

/// What is known of a kind of subject by its name; `None` if it has no meaning.
pub fn of_kind(kind: &str) -> Option<Properties> {
    match kind {
        "bsdf" => Some(Properties { map: None, ..Properties::default() }),
        "phase" => Some(Properties::phase()),
        "light" => Some(Properties::light()),
        _ => None,
    }
}

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
pub fn has_sound_map(properties: &Properties) -> bool {
    let in_range = |axis: usize| axis < properties.dimension;
    properties.map.is_none_or(|[a, b]| a != b && in_range(a) && in_range(b))
}

/// Declares a property by its key; `None` where key or value has no meaning.
pub fn declare(properties: &mut Properties, key: &str, value: &str) -> Option<()> {
    let yes = || match value {
        "yes" => Some(true),
        "no" => Some(false),
        _ => None,
    };
    let coordinates = || -> Option<Vec<[f64; 3]>> {
        let numbers: Vec<f64> = value.split(',').map(real).collect::<Option<_>>()?;
        let is_sound = numbers.len().is_multiple_of(3) && numbers.iter().all(|x| x.is_finite());
        is_sound.then(|| numbers.as_chunks::<3>().0.to_vec())
    };
    match (&mut properties.kind, key) {
        (Kind::Phase { wo_points_away, .. }, "wo") => {
            *wo_points_away = match value {
                "away" => true,
                "along" => false,
                _ => return None,
            };
            return Some(());
        }
        (Kind::Phase { mean_cosine, .. }, "mean_cosine") => {
            *mean_cosine = Some(real(value).filter(|g| (-1.0..=1.0).contains(g))?);
            return Some(());
        }
        (Kind::Light { hits, .. }, "hits") => {
            *hits = yes()?;
            return Some(());
        }
        (Kind::Light { one_sided, .. }, "one_sided") => {
            *one_sided = yes()?;
            return Some(());
        }
        (Kind::Light { points, .. }, "reference_points") => {
            *points = coordinates()?;
            return Some(());
        }
        (Kind::Light { points, .. }, "reference_box") => {
            /// Shares of three edges, by the golden ratio's generalization.
            const SHARES: [f64; 3] = [0.819_172_513, 0.671_043_606, 0.549_700_478];
            let [low, high] = coordinates()?.try_into().ok()?;
            let inside = |i: usize| {
                [0, 1, 2].map(|axis| low[axis] + (high[axis] - low[axis]) * (SHARES[axis] * i as f64).fract())
            };
            *points = (1..=6).map(inside).collect();
            return Some(());
        }
        (Kind::Light { .. }, "scatters" | "eta" | "reciprocal" | "energy")
        | (Kind::Phase { .. }, "scatters" | "eta") => {
            return None;
        }
        _ => {}
    }
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
