//! The registry of the study: all families of formulas and all experiments.

use super::experiment::Experiment;
use super::family::Family;
use super::{
    areas, conductor, cuts, density, distribution, facet, film, fresnel, normals, offsets, paths, refraction,
    shadowing, sphere, tables, triangle,
};

/// An entry of [`REGISTRY`].
#[derive(Clone, Copy)]
pub enum Entry {
    /// A quantity that a formula defines.
    Formula(&'static Family),
    /// A computation with exact results of another kind.
    Experiment(&'static Experiment),
}

/// All families of formulas and all experiments: each is a file and a line here.
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
        let (Self::Formula(Family { name, .. }) | Self::Experiment(Experiment { name, .. })) = self;
        name
    }

    /// What it is, in a line.
    #[must_use]
    pub fn about(self) -> &'static str {
        let (Self::Formula(Family { about, .. }) | Self::Experiment(Experiment { about, .. })) = self;
        about
    }

    /// Id of the figure that shows it.
    #[must_use]
    pub fn figure(self) -> &'static str {
        let (Self::Formula(Family { figure, .. }) | Self::Experiment(Experiment { figure, .. })) = self;
        figure
    }

    /// Names of the inputs of a formula.
    #[must_use]
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

/// Names of the entries that a figure shows.
#[must_use]
pub fn of_figure(figure: &str) -> Vec<&'static str> {
    REGISTRY.iter().filter(|entry| entry.figure() == figure).map(|entry| entry.name()).collect()
}
