//! Values of flags: choices among names, environment-map samplers, and `--shard I/N`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use etalon_core::envmap::samplers::{self, Entry, MapSampling};
use etalon_core::errata::Formulas;
use etalon_core::sampling::filter::{PixelFilter, RANGE};
use std::str::FromStr;

/// Parses one of a few names; each has a help, which may be empty, and a value.
pub fn choice<T: Clone + Send + Sync + 'static>(
    choices: impl IntoIterator<Item = (&'static str, &'static str, T)>,
) -> impl TypedValueParser<Value = T> {
    let choices = Vec::from_iter(choices);
    let named = |&(name, help, _): &(&'static str, &'static str, T)| match help {
        "" => PossibleValue::new(name),
        help => PossibleValue::new(name).help(help),
    };
    PossibleValuesParser::new(choices.iter().map(named).collect::<Vec<_>>()).try_map(move |text| {
        let found = choices.iter().find(|(name, ..)| *name == text);
        found.map(|(.., value)| value.clone()).ok_or("not one of the names")
    })
}

/// Parses which formulas to use: the correct ones, or those of the first report.
pub fn model() -> impl TypedValueParser<Value = Formulas> {
    choice([
        ("exact", "The correct formulas", Formulas::Exact),
        ("report", "The first report's formulas, with their errors", Formulas::FirstReport),
    ])
}

/// Reads the name of an environment-map sampler.
pub fn map_sampling(text: &str) -> std::result::Result<MapSampling, String> {
    text.parse().map_err(|_| format!("the samplers are {}", MapSampling::names().join(", ")))
}

/// The environment-map samplers among some, each with what it does.
pub fn map_samplers(among: impl Fn(MapSampling) -> bool) -> String {
    let line = |entry: &Entry| {
        let density = if entry.density == entry.name { String::new() } else { format!(" ({})", entry.density) };
        format!("{}{density}: {}", entry.name_with_k(), entry.doc)
    };
    let some = samplers::ALL.iter().filter(|entry| among(MapSampling::new(entry)));
    some.map(|entry| line(entry)).collect::<Vec<_>>().join("; ")
}

/// Reads a pixel filter.
pub fn filter(text: &str) -> std::result::Result<PixelFilter, String> {
    let [low, high] = RANGE;
    text.parse().map_err(|_| {
        format!("box, triangle or gaussian, like gaussian:1.5,0.5, with radius and sigma from {low} to {high} pixels")
    })
}

/// An exposure in stops.
pub fn stops(text: &str) -> std::result::Result<f32, String> {
    text.parse().ok().filter(|v: &f32| v.is_finite() && v.abs() <= 100.0).ok_or("not a number within ±100".into())
}

/// Reads a share, as a fraction or in percent, between 0 and 1.
pub fn share(text: &str) -> std::result::Result<f64, String> {
    fraction(text).filter(|v| *v > 0.0 && *v < 1.0).ok_or("not a share between 0 and 1, such as 0.01 or 1%".into())
}

/// Reads a number, or a number of percent.
pub fn fraction(text: &str) -> Option<f64> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    Some(number.trim().parse::<f64>().ok()? * unit)
}

/// A parameter with its value, `NAME=VALUE`.
pub fn setting(text: &str) -> std::result::Result<(String, f64), String> {
    let parsed =
        text.split_once('=').and_then(|(name, value)| Some((name.trim().to_owned(), value.trim().parse().ok()?)));
    parsed.filter(|(_, value): &(String, f64)| value.is_finite()).ok_or("not NAME=VALUE with a number".into())
}

/// The I-th of N shares of a render.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub index: u32,
    pub count: u32,
}

impl Shard {
    /// The end of default file names.
    pub fn suffix(self) -> String {
        format!(".shard-{}-of-{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
        let parsed = text.split_once('/').and_then(|(index, count)| {
            let shard = Self { index: index.parse().ok()?, count: count.parse().ok()? };
            (1..=shard.count).contains(&shard.index).then_some(shard)
        });
        parsed.ok_or("expected I/N, for example 2/8: the second of eight")
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn shares_are_fractions_or_percent() {
        let read = |text| super::share(text).ok();
        assert_eq!([read("0.01"), read("1%"), read("0.5 %")], [Some(0.01), Some(0.01), Some(0.005)]);
        assert!(["", "0", "1", "100%", "-1%", "nan", "inf", "x"].into_iter().all(|text| read(text).is_none()));
    }
}
