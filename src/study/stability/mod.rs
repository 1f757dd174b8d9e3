//! Numerical stability: the code that renders, in f32 and f64, against exact answers, over stiff and extreme inputs.
//!
//! A [`Family`] is a quantity with a defining formula. That formula, evaluated with 256 bits at the very input that the
//! code gets, is the reference, and beside every error stands the condition number: an input whose own rounding moves
//! the answer is not blamed on the formula. An [`Experiment`] is what no formula describes (sums, tables, paths): its
//! exact answer comes from whole numbers or by construction. Each has [`Bound`]s on its errors.

mod areas;
mod bound;
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
mod refraction;
mod replay;
mod row;
mod shadowing;
mod sphere;
mod sweep;
mod tables;
mod triangle;

pub use bound::{Bound, BoundCheck};
pub use experiment::{Effort, Experiment};
pub use family::{Family, Precision, REPORT, STABLE, Scale, Section, TEXTBOOK, Variant};

pub use replay::{Line, Replay, replay};
pub use row::Row;
pub use sweep::{Case, Sweep};

use crate::error::{Error, Result};
use crate::interrupt;

/// One thing that the study looks at.
#[derive(Clone, Copy)]
pub enum Entry {
    /// What a formula defines.
    Formula(&'static Family),
    /// What is compared with exact results of another kind.
    Experiment(&'static Experiment),
}

/// All that the study looks at: a family of formulas or an experiment is one file and one line here.
pub static REGISTRY: [Entry; 21] = [
    Entry::Formula(&fresnel::FAMILY),
    Entry::Formula(&conductor::FAMILY),
    Entry::Formula(&refraction::FAMILY),
    Entry::Formula(&distribution::BECKMANN),
    Entry::Formula(&distribution::GGX),
    Entry::Formula(&shadowing::BECKMANN),
    Entry::Formula(&shadowing::GGX),
    Entry::Formula(&density::BECKMANN),
    Entry::Formula(&density::GGX),
    Entry::Formula(&normals::BECKMANN),
    Entry::Formula(&normals::GGX),
    Entry::Formula(&facet::NORMAL),
    Entry::Formula(&facet::COSINE),
    Entry::Formula(&sphere::FAMILY),
    Entry::Formula(&triangle::FAMILY),
    Entry::Experiment(&offsets::EXPERIMENT),
    Entry::Experiment(&tables::EXPERIMENT),
    Entry::Experiment(&areas::EXPERIMENT),
    Entry::Experiment(&film::EXPERIMENT),
    Entry::Experiment(&paths::EXPERIMENT),
    Entry::Experiment(&cuts::EXPERIMENT),
];

impl Entry {
    /// Its name, which is also that of its rows.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Formula(family) => family.name,
            Self::Experiment(experiment) => experiment.name,
        }
    }

    /// What it is, in a line.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Formula(family) => family.about,
            Self::Experiment(experiment) => experiment.about,
        }
    }

    /// The figure that shows it.
    #[must_use]
    pub fn figure(self) -> &'static str {
        match self {
            Self::Formula(family) => family.figure,
            Self::Experiment(experiment) => experiment.figure,
        }
    }

    /// Names of the inputs of a formula.
    #[must_use]
    pub fn inputs(self) -> &'static [&'static str] {
        match self {
            Self::Formula(family) => family.inputs,
            Self::Experiment(_) => &[],
        }
    }
}

/// All families of formulas.
pub fn families() -> impl Iterator<Item = &'static Family> {
    REGISTRY.iter().filter_map(|entry| if let Entry::Formula(family) = entry { Some(*family) } else { None })
}

/// Names of all families and experiments.
pub fn names() -> impl Iterator<Item = &'static str> {
    REGISTRY.iter().map(|entry| entry.name())
}

/// The figures that show something of the study, each once.
#[must_use]
pub fn figures() -> Vec<&'static str> {
    let mut figures = Vec::new();
    for entry in &REGISTRY {
        if !figures.contains(&entry.figure()) {
            figures.push(entry.figure());
        }
    }
    figures
}

/// Names of what a figure shows.
#[must_use]
pub fn of_figure(figure: &str) -> Vec<&'static str> {
    REGISTRY.iter().filter(|entry| entry.figure() == figure).map(|entry| entry.name()).collect()
}

/// The results of a run.
pub struct Stability {
    /// A row for each family or experiment, variant and precision.
    pub rows: Vec<Row>,
    /// Whether the bounds on errors hold.
    pub bounds: Vec<BoundCheck>,
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
    let (mut sweeps, mut rows, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
    let mut interrupted = false;
    for entry in REGISTRY.iter().filter(|entry| wanted(entry.name())) {
        interrupted |= interrupt::requested();
        if interrupted {
            break;
        }
        before(entry.name());
        match entry {
            Entry::Formula(family) => {
                let sweep = Sweep::new(family, effort.side);
                rows.extend(Row::of_sweep(&sweep));
                bounds.extend(BoundCheck::of_sweep(&sweep));
                sweeps.push(sweep);
            }
            Entry::Experiment(experiment) => match (experiment.run)(effort, seed) {
                Err(Error::Interrupted) => interrupted = true,
                found => {
                    let found = found?;
                    bounds.extend(BoundCheck::of_rows(experiment, &found));
                    rows.extend(found);
                }
            },
        }
    }
    bounds.insert(0, BoundCheck::finite(&rows));
    Ok(Stability { bounds, rows, sweeps, interrupted })
}

#[cfg(test)]
mod tests;
