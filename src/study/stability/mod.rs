//! Numerical stability: the code that renders, in f32 and f64, against exact results, over stiff and extreme inputs.
//!
//! A [`Family`] is a quantity with a defining formula. That formula, evaluated with 256 bits at the very input that the
//! code gets, is the reference. Beside every error stands the condition number: how much rounding of the input alone
//! would change the result. An [`Experiment`] is a computation that no formula describes (sums, tables, paths): its exact
//! result comes from integers or by construction. Each has [`Bound`]s on its errors.

mod areas;
mod bound;
mod bound_check;
mod case;
mod conductor;
mod cuts;
mod density;
mod deviation;
mod directions;
mod distribution;
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
mod precision;
mod refraction;
mod registry;
mod replay;
mod row;
mod shadowing;
mod sphere;
mod sweep;
mod tables;
mod triangle;
mod variant;

pub use bound::Bound;
pub use bound_check::BoundCheck;
pub use case::Case;
pub use experiment::{Experiment, Workload};
pub use family::{Family, Scale, Section};
pub use precision::Precision;
pub use registry::{Entry, REGISTRY, families, figures, names, of_figure};
pub use replay::{Replay, Replayed, replay};
pub use row::ErrorRow;
pub use sweep::Sweep;
pub use variant::{REPORT, STABLE, TEXTBOOK, Variant};

use crate::error::{Error, Result};
use crate::interrupt;

/// The results of a run.
pub struct Stability {
    /// A row for each family or experiment, variant and precision.
    pub rows: Vec<ErrorRow>,
    /// Whether the bounds on errors hold.
    pub bounds: Vec<BoundCheck>,
    /// All cases of the families, for maps of their errors.
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
    workload: &Workload,
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
                let sweep = Sweep::new(family, workload.side);
                rows.extend(sweep.rows());
                bounds.extend(BoundCheck::of_sweep(&sweep));
                sweeps.push(sweep);
            }
            Entry::Experiment(experiment) => match (experiment.run)(workload, seed) {
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
