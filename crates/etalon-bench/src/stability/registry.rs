//! The registry of the study: all families of formulas.

use super::family::Family;
use super::{conductor, dielectric, geometry, microfacet, normals, rough_dielectric};

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
