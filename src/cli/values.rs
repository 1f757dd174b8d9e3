//! Values of flags that several subcommands take: formulas and environment-map samplers.

use crate::envmap::samplers::{self, Entry, MapSampling};
use clap::ValueEnum;

/// Which formulas a command uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Model {
    /// The correct ones
    Exact,
    /// The reports', errors included
    Report,
}

/// Reads the name of an environment-map sampler.
pub fn map_sampling(text: &str) -> std::result::Result<MapSampling, String> {
    text.parse().map_err(|_| format!("the samplers are {}", MapSampling::names().join(", ")))
}

/// The environment-map samplers among some, each with what it does.
pub fn map_samplers(among: impl Fn(MapSampling) -> bool) -> String {
    let line = |entry: &Entry| {
        let number = if entry.has_regions { "-K" } else { "" };
        let density = if entry.density == entry.name { String::new() } else { format!(" ({})", entry.density) };
        format!("{}{number}{density}: {}", entry.name, entry.doc)
    };
    let some = samplers::ALL.iter().filter(|entry| among(MapSampling::new(entry)));
    some.map(|entry| line(entry)).collect::<Vec<_>>().join("; ")
}
