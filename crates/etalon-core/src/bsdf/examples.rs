//! The one list of BSDFs with parameters: unit tests, the suite of `validate`, furnace tests, sweeps, benchmarks and the book take theirs
//! from it.
//!
//! The file of a BSDF has its families, and its line in `bsdfs!` names them.

use super::{Bsdf, ConductorFresnel, families};
use crate::math::Rgb;
use etalon_stats::bsdf::Energy;

/// Name, default value and range of a parameter.
pub type Parameter = (&'static str, f64, [f64; 2]);

/// BSDFs of one kind over their parameters.
pub struct Family {
    pub name: &'static str,
    pub parameters: &'static [Parameter],
    /// The share of the light that is scattered, for all values of the parameters.
    pub energy: Energy,
    pub bsdf: fn(&[f32]) -> Bsdf,
    /// The BSDFs that the suite tests as a whole.
    pub examples: fn(&Self) -> Vec<Example>,
}

/// A BSDF with a name of its own.
pub struct Example {
    pub name: String,
    pub energy: Energy,
    /// Makes the BSDF. Some compute tables.
    pub bsdf: Box<dyn Fn() -> Bsdf + Send + Sync>,
    /// Whether tests also integrate over its directions and sample them, which takes long, or only compare numbers.
    pub is_integrated: bool,
}

impl Family {
    pub fn named(name: &str) -> Option<&'static Self> {
        families().find(|family| family.name == name)
    }

    pub fn with(&self, values: &[f64]) -> Bsdf {
        (self.bsdf)(&values.iter().map(|&value| value as f32).collect::<Vec<f32>>())
    }

    /// The default values of the parameters.
    pub fn defaults(&self) -> Vec<f64> {
        self.parameters.iter().map(|&(_, value, _)| value).collect()
    }

    pub(super) fn example<const N: usize>(&self, name: impl Into<String>, values: [f32; N]) -> Example {
        let bsdf = self.bsdf;
        Example { energy: self.energy, ..Example::new(name, move || bsdf(&values)) }
    }
}

impl Example {
    pub(super) fn new(name: impl Into<String>, bsdf: impl Fn() -> Bsdf + Send + Sync + 'static) -> Self {
        Self { name: name.into(), energy: Energy::AtMostOne, bsdf: Box::new(bsdf), is_integrated: true }
    }
}

pub fn examples() -> Vec<Example> {
    families().flat_map(|family| (family.examples)(family)).collect()
}

pub(super) const SHARE: [f64; 2] = [0.0, 1.0];
pub(super) const ALBEDO: Parameter = ("albedo", 0.8, SHARE);
pub(super) const ALPHA: Parameter = ("alpha", 0.3, [1e-4, 1.0]);
pub(super) const ALPHA_X: Parameter = ("alpha_x", 0.3, [1e-4, 1.0]);
pub(super) const ALPHA_Y: Parameter = ("alpha_y", 0.3, [1e-4, 1.0]);
pub(super) const GLASS: Parameter = ("eta", 1.5, [1.0 / 2.4, 2.4]);
/// Complex index of a metal without colour.
pub(super) const ETA: Parameter = ("eta", 0.5, [0.1, 4.0]);
pub(super) const K: Parameter = ("k", 2.5, [0.0, 10.0]);

/// Widths of the microfacets of examples.
pub(super) const ALPHAS: [f32; 6] = [1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0];
/// An albedo, a reflectance and a transmittance of examples.
pub(super) const COLOUR: Rgb = Rgb::new(0.2, 0.5, 1.0);
pub(super) const REFLECTANCE: Rgb = Rgb::splat(0.9);
pub(super) const TRANSMITTANCE: Rgb = Rgb::splat(0.8);

/// The reflectance of a metal without colour: channels that are equal are integrated once.
pub(super) fn grey(eta: f32, k: f32) -> ConductorFresnel {
    ConductorFresnel::new(Rgb::splat(eta), Rgb::splat(k))
}

pub(super) fn gold() -> ConductorFresnel {
    let gold = crate::optics::metals::GOLD;
    ConductorFresnel::new(gold.eta_rgb(), gold.k_rgb())
}
