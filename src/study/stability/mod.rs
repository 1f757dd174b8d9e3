//! Numerical stability: the code that renders, in f32 and f64, against exact answers, over stiff and extreme inputs.
//!
//! A [`Family`] is a quantity with a defining formula. That formula, evaluated with 256 bits at the very input that the
//! code gets, is the reference, and beside every error stands the condition number: an input whose own rounding moves
//! the answer is not blamed on the formula. An [`Experiment`] is what no formula describes (sums, tables, paths): its
//! exact answer comes from whole numbers or by construction. The [`Promise`]s are bounds that must hold.

mod areas;
mod conductor;
mod cuts;
mod density;
mod distribution;
mod error;
mod experiment;
mod facet;
mod family;
mod film;
mod fresnel;
mod normals;
mod number;
mod offsets;
mod paths;
mod precise;
mod promise;
mod refraction;
mod replay;
mod row;
mod shadowing;
mod sphere;
mod sweep;
mod tables;
mod triangle;

pub use experiment::{Effort, Experiment};
pub use family::{Family, Form, Precision, REPORT, STABLE, Scale, Section, TEXTBOOK};
pub use promise::{Promise, promises};
pub use replay::{Line, Replay, replay};
pub use row::Row;
pub use sweep::{Case, Sweep};

use crate::error::{Error, Result};
use crate::interrupt;

/// All quantities that a formula defines.
pub static FAMILIES: [Family; 15] = [
    fresnel::FAMILY,
    conductor::FAMILY,
    refraction::FAMILY,
    distribution::BECKMANN,
    distribution::GGX,
    shadowing::BECKMANN,
    shadowing::GGX,
    density::BECKMANN,
    density::GGX,
    normals::BECKMANN,
    normals::GGX,
    facet::NORMAL,
    facet::COSINE,
    sphere::FAMILY,
    triangle::FAMILY,
];

/// All experiments.
pub static EXPERIMENTS: [Experiment; 6] =
    [offsets::EXPERIMENT, tables::EXPERIMENT, areas::EXPERIMENT, film::EXPERIMENT, paths::EXPERIMENT, cuts::EXPERIMENT];

/// Names of all families and experiments.
pub fn names() -> impl Iterator<Item = &'static str> {
    FAMILIES.iter().map(|f| f.name).chain(EXPERIMENTS.iter().map(|e| e.name))
}

/// The results of a run.
pub struct Stability {
    pub rows: Vec<Row>,
    pub promises: Vec<Promise>,
    /// Of the families, for maps of their errors.
    pub sweeps: Vec<Sweep>,
    /// Whether the process was asked to stop before all of them had been run.
    pub interrupted: bool,
}

/// Runs the families and experiments of those names (all when empty); `before` is called with each name before it is
/// run. If the process is asked to stop, the families and experiments so far are the result.
///
/// # Errors
/// [`Error::Parameter`] for an unknown name.
pub fn run<S: AsRef<str>>(
    only: &[S],
    effort: &Effort,
    seed: u64,
    before: &mut dyn FnMut(&'static str),
) -> Result<Stability> {
    if let Some(unknown) = only.iter().map(S::as_ref).find(|name| names().all(|known| known != *name)) {
        return Err(Error::parameter("families", format!("there is no family \"{unknown}\""))
            .with_hint(format!("families: {}", names().collect::<Vec<_>>().join(", "))));
    }
    let wanted = |name: &str| only.is_empty() || only.iter().any(|o| o.as_ref() == name);
    let mut sweeps = Vec::new();
    let mut rows = Vec::new();
    let mut interrupted = false;
    for family in FAMILIES.iter().filter(|family| wanted(family.name)) {
        interrupted |= interrupt::requested();
        if interrupted {
            break;
        }
        before(family.name);
        let sweep = Sweep::new(family, effort.side);
        rows.extend(Row::of_sweep(&sweep));
        sweeps.push(sweep);
    }
    for experiment in EXPERIMENTS.iter().filter(|experiment| wanted(experiment.name)) {
        interrupted |= interrupt::requested();
        if interrupted {
            break;
        }
        before(experiment.name);
        match (experiment.run)(effort, seed) {
            Err(Error::Interrupted) => interrupted = true,
            found => rows.extend(found?),
        }
    }
    Ok(Stability { promises: promises(&sweeps, &rows), rows, sweeps, interrupted })
}

#[cfg(test)]
mod tests;
