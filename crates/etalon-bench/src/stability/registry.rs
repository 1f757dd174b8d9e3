//! The registry of the study: all families of formulas and all experiments.

use super::experiment::Experiment;
use super::family::Family;
use super::{conductor, dielectric, geometry, microfacet, normals, paths, rough_dielectric, special, sums};

/// An entry of [`REGISTRY`].
#[derive(Clone, Copy)]
pub enum Entry {
    /// A quantity that a formula defines.
    Formula(&'static Family),
    /// A computation with exact results of another kind.
    Experiment(&'static Experiment),
}

/// All families of formulas and all experiments: each is a constant and a line here.
pub static REGISTRY: [Entry; 29] = [
    Entry::Formula(&dielectric::FRESNEL),
    Entry::Formula(&dielectric::SCHLICK),
    Entry::Formula(&conductor::FAMILY),
    Entry::Formula(&dielectric::REFRACTION),
    Entry::Formula(&microfacet::BECKMANN_D),
    Entry::Formula(&microfacet::GGX_D),
    Entry::Formula(&microfacet::BECKMANN_G1),
    Entry::Formula(&microfacet::GGX_G1),
    Entry::Formula(&microfacet::BECKMANN_G2),
    Entry::Formula(&microfacet::GGX_G2),
    Entry::Formula(&microfacet::BECKMANN_PDF),
    Entry::Formula(&microfacet::GGX_PDF),
    Entry::Formula(&normals::BECKMANN),
    Entry::Formula(&normals::GGX),
    Entry::Formula(&normals::COSINE_HEMISPHERE),
    Entry::Formula(&normals::UNIFORM_HEMISPHERE),
    Entry::Formula(&geometry::HALF_VECTOR),
    Entry::Formula(&geometry::HALF_COSINE),
    Entry::Formula(&rough_dielectric::HALF_VECTOR),
    Entry::Formula(&rough_dielectric::JACOBIAN),
    Entry::Formula(&rough_dielectric::PDF),
    Entry::Formula(&geometry::SPHERE),
    Entry::Formula(&geometry::TRIANGLE),
    Entry::Experiment(&special::EXPERIMENT),
    Entry::Experiment(&paths::OFFSETS),
    Entry::Experiment(&sums::TABLES),
    Entry::Experiment(&sums::AREAS),
    Entry::Experiment(&sums::FILM),
    Entry::Experiment(&paths::PATHS),
];

impl Entry {
    /// Its name, which is also that of its rows.
    pub fn name(self) -> &'static str {
        let (Self::Formula(Family { name, .. }) | Self::Experiment(Experiment { name, .. })) = self;
        name
    }

    /// What it is, in a line.
    pub fn about(self) -> &'static str {
        let (Self::Formula(Family { about, .. }) | Self::Experiment(Experiment { about, .. })) = self;
        about
    }

    /// Id of the figure that shows it.
    pub fn figure(self) -> &'static str {
        let (Self::Formula(Family { figure, .. }) | Self::Experiment(Experiment { figure, .. })) = self;
        figure
    }

    /// Names of the inputs of a formula.
    pub fn inputs(self) -> &'static [&'static str] {
        if let Self::Formula(family) = self { family.inputs } else { &[] }
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

/// Ids of the figures that show entries of the registry, each once.
pub fn figures() -> Vec<&'static str> {
    let mut figures = Vec::new();
    for entry in &REGISTRY {
        if !figures.contains(&entry.figure()) {
            figures.push(entry.figure());
        }
    }
    figures
}

/// Names of the entries that a figure shows.
pub fn of_figure(figure: &str) -> Vec<&'static str> {
    REGISTRY.iter().filter(|entry| entry.figure() == figure).map(|entry| entry.name()).collect()
}
