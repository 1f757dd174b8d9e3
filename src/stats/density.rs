//! What samples are said to follow: the claim under test.

use crate::error::Result;

/// What a density is declared to integrate to, its atoms included. What is missing to 1 is the probability of no sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mass {
    Exactly(f64),
    /// Not known beforehand, but at most 1: the integral then says how often there must be no sample.
    AtMostOne,
}

/// A point that is drawn with a probability of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atom<P> {
    pub point: P,
    pub probability: f64,
}

/// A density over a domain, with respect to its measure, plus atoms.
pub trait Density<P>: Sync {
    /// Appends the density at each of `points`; fails only where it is computed in another process.
    fn pdf(&self, points: &[P], out: &mut Vec<f64>) -> Result<()>;

    fn mass(&self) -> Mass {
        Mass::Exactly(1.0)
    }

    fn atoms(&self) -> Vec<Atom<P>> {
        Vec::new()
    }

    /// For a density that is constant between lines of the chart: those lines, ascending and strictly between 0 and 1, for
    /// each axis. Its integrals are then sums.
    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        None
    }
}

/// A [`Density`] of a function; see [`density`].
pub struct DensityFn<P, F> {
    pdf: F,
    mass: Mass,
    atoms: Vec<Atom<P>>,
    steps: Option<[Vec<f64>; 2]>,
}

/// The density that `pdf` returns, of mass 1 unless told otherwise.
pub fn density<P, F: Fn(P) -> f64 + Sync>(pdf: F) -> DensityFn<P, F> {
    DensityFn { pdf, mass: Mass::Exactly(1.0), atoms: Vec::new(), steps: None }
}

impl<P, F> DensityFn<P, F> {
    #[must_use]
    pub fn with_mass(self, mass: Mass) -> Self {
        Self { mass, ..self }
    }

    #[must_use]
    pub fn with_atoms(self, atoms: Vec<Atom<P>>) -> Self {
        Self { atoms, ..self }
    }

    #[must_use]
    pub fn with_steps(self, steps: [Vec<f64>; 2]) -> Self {
        Self { steps: Some(steps), ..self }
    }
}

impl<P: Copy + Sync, F: Fn(P) -> f64 + Sync> Density<P> for DensityFn<P, F> {
    fn pdf(&self, points: &[P], out: &mut Vec<f64>) -> Result<()> {
        out.extend(points.iter().map(|&point| (self.pdf)(point)));
        Ok(())
    }

    fn mass(&self) -> Mass {
        self.mass
    }

    fn atoms(&self) -> Vec<Atom<P>> {
        self.atoms.clone()
    }

    fn steps(&self) -> Option<[Vec<f64>; 2]> {
        self.steps.clone()
    }
}
