//! The test of a whole BSDF, phase function or light ([`Kind`]): what it evaluates, what it samples, and what it declares, each against
//! the others.
//!
//! Most errors of BSDFs lie between evaluation, sample weights, pdf and energy, where a test of samples against the pdf does not
//! look. Implement [`Bsdf`] (or [`BatchBsdf`], where values come in batches and may fail), and give [`assert_bsdf`] the directions
//! `wo` to test it for, or [`test()`] for a [`Report`]. Each [`Check`] says what it finds; those in [`ALL`] need one BSDF, [`same_values`] and [`same_light`] compare two.
//!
//! An exact check compares numbers that must be equal up to rounding: 64 units of the last place of the BSDF's arithmetic
//! ([`Properties::precision`]), or, where that is exceeded, the change of the number when each coordinate of the two directions
//! is moved by 16 last places. A statistical check has a p-value, and all of a report share one level ([`decide`]).

mod adjoint;
mod albedo;
mod contract;
mod furnace;
mod light;
mod limits;
mod mistakes;
mod places;
mod report;
mod sampling;
mod subject;
mod values;
mod weights;

pub use contract::{
    BatchBsdf, Bsdf, BsdfSample, DeltaLobe, Density, Direction, Energy, Family, Hit, Kind, Pair, Parameter, PdfKind,
    Properties, Reciprocity, Spectrum,
};
pub use furnace::{Albedo, Basis, RISK, directional_albedo};
pub use limits::{same_light, same_values};
pub use places::{is_edge_on, places};
pub use report::{Checked, Report, assert_bsdf, test};

use crate::error::{Result, poll};
use crate::examine::Protocol;
use crate::hash::mix64;
use crate::outcome::Outcome;
#[cfg(doc)]
use crate::outcome::decide;
use subject::Subject;

/// One check of a BSDF for one `wo`.
#[derive(Clone, Copy)]
pub struct Check {
    /// Its name.
    pub name: &'static str,
    /// What it finds, in one line.
    pub finds: &'static str,
    /// Whether it takes random numbers for an estimate and has a p-value, but where the BSDF leaves nothing to chance.
    pub is_statistical: bool,
    run: fn(&Subject) -> Result<Option<Outcome>>,
}

impl Check {
    /// Whether it may apply to a BSDF, a phase function or a light.
    #[must_use]
    pub fn is_for(&self, kind: &Kind) -> bool {
        match self.name {
            "geometry" => matches!(kind, Kind::Light { .. }),
            "mean-cosine" => matches!(kind, Kind::Phase { .. }),
            "adjoint" => *kind == Kind::Surface,
            // Integrals of a radiance that ends at edges are slow: `geometry` looks for light that is not sampled, and `formula` at weights.
            "energy" | "reciprocity" | "albedo" | "weights" => !matches!(kind, Kind::Light { .. }),
            _ => true,
        }
    }

    /// Runs it, its verdict still open; `None` where it does not apply to the BSDF. Each `round` has random numbers of its own.
    ///
    /// # Errors
    /// [`Error::Parameter`](crate::Error::Parameter) for an impossible protocol; [`Error::Cancelled`](crate::Error::Cancelled);
    /// [`Error::External`](crate::Error::External) from the BSDF.
    pub fn examine(
        &self,
        bsdf: &dyn BatchBsdf,
        wo: Direction,
        protocol: &Protocol,
        round: u64,
    ) -> Result<Option<Outcome>> {
        protocol.check()?;
        poll(protocol.cancelled)?;
        if !self.is_for(&bsdf.properties().kind) {
            return Ok(None);
        }
        let start = std::time::Instant::now();
        // Each check has random numbers of its own for each direction.
        let parts = self.name.bytes().map(u64::from).chain(wo.map(f64::to_bits));
        let seed = parts.fold(protocol.seed, |seed, part| mix64(seed ^ part));
        let protocol = Protocol { seed, ..*protocol };
        let subject = Subject::new(bsdf, wo, &protocol, round)?;
        // Behind a light nothing is sampled: `geometry` tests that no light comes from it.
        let outcome = if self.is_statistical && subject.is_dark()? { None } else { (self.run)(&subject)? };
        let seconds = start.elapsed().as_secs_f64();
        let of = Some(wo).filter(|_| subject.properties.kind == Kind::Surface);
        Ok(outcome.map(|outcome| Outcome { seconds, wo: of, ..outcome }))
    }
}

/// The registry of checks: exact ones first, which say best what is wrong.
pub const ALL: [Check; 12] = [
    Check {
        name: "values",
        finds: "NaN, infinite and negative numbers; light on an undeclared side; weights above the declared bound",
        is_statistical: false,
        run: values::values,
    },
    Check {
        name: "formula",
        finds: "weights other than f |cos| / pdf; samples that carry another pdf than `pdf` returns",
        is_statistical: false,
        run: values::formula,
    },
    Check {
        name: "reciprocity",
        finds: "f that changes when wo and wi are exchanged, apart from η²",
        is_statistical: false,
        run: adjoint::reciprocity,
    },
    Check {
        name: "adjoint",
        finds: "values and weights for importance that are not those for radiance times η²",
        is_statistical: false,
        run: adjoint::adjoint,
    },
    Check {
        name: "jacobian",
        finds: "pdfs of a lobe that are not its probability over the Jacobian of its map from random numbers to directions",
        is_statistical: false,
        run: sampling::jacobian,
    },
    Check {
        name: "partition",
        finds: "lobes whose pdfs do not sum to the pdf, so that their MIS weights do not sum to 1",
        is_statistical: false,
        run: values::partition,
    },
    Check {
        name: "geometry",
        finds: "points, distances, normals, radiance and pdfs per area of a light that contradict each other",
        is_statistical: false,
        run: places::geometry,
    },
    Check {
        name: "mean-cosine",
        finds: "mean cosines of a phase function other than declared, mean weights other than 1",
        is_statistical: true,
        run: places::mean_cosine,
    },
    Check {
        name: "energy",
        finds: "albedos above 1, or other than declared",
        is_statistical: true,
        run: albedo::energy,
    },
    Check {
        name: "albedo",
        finds: "weights whose mean is not the integral of f |cos|",
        is_statistical: true,
        run: albedo::agreement,
    },
    Check {
        name: "sampling",
        finds: "samples that do not follow the pdf; pdfs that integrate to more than 1",
        is_statistical: true,
        run: sampling::sampling,
    },
    Check {
        name: "weights",
        finds: "weights whose sum over a cell of directions is not the light that is scattered from there",
        is_statistical: true,
        run: weights::check,
    },
];

/// What none of the checks sees.
pub const UNSEEN: &str =
    "these checks cannot see an error that f, pdf and samples share: a wrong index or roughness in all three";

#[cfg(test)]
mod tests;
#[cfg(test)]
mod textbook;
