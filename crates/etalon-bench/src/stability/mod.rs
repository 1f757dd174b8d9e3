//! Numerical stability: the code that renders, in f32 and f64, against exact results, over stiff and extreme inputs.
//!
//! A [`Family`] is a quantity with a defining formula. That formula, evaluated with 256 bits at the very input that the
//! code gets, is the reference. Beside every error stands the condition number: how much rounding of the input alone
//! would change the result. Each family has [`Bound`]s on its errors. Sums, tables and paths, which no formula describes, have unit
//! tests beside their code.

mod conductor;
mod dielectric;
mod family;
mod geometry;
mod microfacet;
mod normals;
mod number;
mod replay;
mod rough_dielectric;
mod special;
mod sweep;

pub use family::{Bound, ErrorRow, Family, REPORT, STABLE, Scale, Section, TEXTBOOK, Variant};
pub use number::Precision;
pub use replay::{Replay, Replayed, replay};
pub use special::{ABOUT as ABOUT_SPECIAL, NAME as SPECIAL};
pub use sweep::{Case, Sweep};

use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use serde::Serialize;

/// All families of formulas: each is a constant and a line here.
pub static REGISTRY: [&Family; 23] = [
    &dielectric::FRESNEL,
    &dielectric::SCHLICK,
    &conductor::FAMILY,
    &dielectric::REFRACTION,
    &microfacet::BECKMANN_D,
    &microfacet::GGX_D,
    &microfacet::BECKMANN_G1,
    &microfacet::GGX_G1,
    &microfacet::BECKMANN_G2,
    &microfacet::GGX_G2,
    &microfacet::BECKMANN_PDF,
    &microfacet::GGX_PDF,
    &normals::BECKMANN,
    &normals::GGX,
    &normals::COSINE_HEMISPHERE,
    &normals::UNIFORM_HEMISPHERE,
    &geometry::HALF_VECTOR,
    &geometry::HALF_COSINE,
    &rough_dielectric::HALF_VECTOR,
    &rough_dielectric::JACOBIAN,
    &rough_dielectric::PDF,
    &geometry::SPHERE,
    &geometry::TRIANGLE,
];

/// Ids of the figures that show families, each once.
pub fn figures() -> Vec<&'static str> {
    let mut figures = Vec::new();
    for family in REGISTRY {
        if !figures.contains(&family.figure) {
            figures.push(family.figure);
        }
    }
    figures
}

/// Names of the families that a figure shows.
pub fn of_figure(figure: &str) -> Vec<&'static str> {
    REGISTRY.iter().filter(|family| family.figure == figure).map(|family| family.name).collect()
}

pub struct Stability {
    /// A row for each family or function at special directions, variant and precision.
    pub rows: Vec<ErrorRow>,
    pub bounds: Vec<BoundCheck>,
    /// All cases of the families, for maps of their errors.
    pub sweeps: Vec<Sweep>,
    /// Whether the process was asked to stop before all of them had been run.
    pub interrupted: bool,
}

/// Places along each side of the grids, at the effort of the subcommand.
pub const SIDE: usize = 33;

/// Names of all that [`run`] takes: the families, and [`SPECIAL`].
pub fn names() -> impl Iterator<Item = &'static str> {
    REGISTRY.iter().map(|family| family.name).chain([SPECIAL])
}

/// Runs the families of those names (all, and [`SPECIAL`], when empty) with `side` places along each side of their grids; `before`
/// is called with each name before it is run. If the process is asked to stop, the families so far are the result.
///
/// # Errors
/// [`Error::Parameter`] for an unknown name.
pub fn run<S: AsRef<str>>(only: &[S], side: usize, before: &mut dyn FnMut(&'static str)) -> Result<Stability> {
    if let Some(unknown) = only.iter().map(S::as_ref).find(|name| names().all(|known| known != *name)) {
        return Err(Error::parameter("families", format!("there is no family \"{unknown}\""))
            .with_hint(format!("families: {}", names().collect::<Vec<_>>().join(", "))));
    }
    let wanted = |name: &str| only.is_empty() || only.iter().any(|o| o.as_ref() == name);
    let (mut sweeps, mut rows, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
    let mut interrupted = false;
    for family in REGISTRY.into_iter().filter(|family| wanted(family.name)) {
        interrupted |= interrupt::requested();
        if interrupted {
            break;
        }
        before(family.name);
        let sweep = Sweep::new(family, side);
        rows.extend(sweep.rows());
        bounds.extend(BoundCheck::of_sweep(&sweep));
        sweeps.push(sweep);
    }
    if !interrupted && wanted(SPECIAL) {
        before(SPECIAL);
        match special::run() {
            Err(Error::Interrupted) => interrupted = true,
            found => {
                let found = found?;
                bounds.push(special::bound(&found));
                rows.extend(found);
            }
        }
    }
    bounds.insert(0, BoundCheck::finite(&rows));
    Ok(Stability { bounds, rows, sweeps, interrupted })
}

/// A bound, and the largest error that was found.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct BoundCheck {
    /// The family or `special-directions`, and which error.
    pub name: String,
    pub got: f64,
    pub limit: f64,
    pub holds: bool,
    /// The input of the largest error, as `--replay` takes it.
    pub worst: String,
}

impl BoundCheck {
    /// The largest of some errors, each with its input. NaN violates every bound.
    fn new(name: String, limit: f64, errors: impl Iterator<Item = (f64, String)>) -> Self {
        let worse = |worst: (f64, String), found: (f64, String)| {
            if found.0 > worst.0 || found.0.is_nan() { found } else { worst }
        };
        let (got, worst) = errors.fold((0.0, String::new()), worse);
        Self { name, got, limit, holds: got <= limit, worst }
    }

    /// The bounds of a formula, over the cases of the variant that renders. Cases where rounding alone decides whether
    /// there is a value are left out.
    pub fn of_sweep(sweep: &Sweep) -> Vec<Self> {
        let Family { name, bounds, .. } = sweep.family;
        let check = |bound: &Bound| {
            let cases = sweep.cases.iter().filter(|case| case.condition.is_finite());
            let errors = cases.filter_map(|case| Some(((bound.error)(case)?, case)));
            let errors = errors.filter(|(error, _)| *error > 0.0 || error.is_nan());
            let errors = errors.map(|(error, case)| (error, sweep.family.text(case)));
            Self::new(format!("{name}: {}", bound.name), bound.limit, errors)
        };
        bounds.iter().map(check).collect()
    }

    /// Whether all results of the code that renders are finite.
    pub fn finite(rows: &[ErrorRow]) -> Self {
        let lost: Vec<&ErrorRow> = rows.iter().filter(|row| row.is_rendered() && row.non_finite > 0).collect();
        let count: u64 = lost.iter().map(|row| row.non_finite).sum();
        let worst = lost.last().map_or(String::new(), |row| row.worst.clone());
        Self::new("results that are not finite".into(), 0.0, std::iter::once((count as f64, worst)))
    }
}

#[cfg(test)]
mod tests;
