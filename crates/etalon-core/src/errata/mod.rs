//! Errata: formulas that the two course reports print or their renderers compute wrongly, to show what the mistakes do.
//!
//! Here are only the formulas: scalars in, scalars out, each beside what is right and the size of the error. What a render may use of
//! them is an entry of its own: a BSDF ([`crate::bsdf::ErrataConductor`]), a reflectance
//! ([`crate::bsdf::DielectricFresnel::SingleCosineSchlick`]), a sampler of maps ([`crate::envmap::samplers::ErrataSampler`]), a tone map.

pub mod images;
pub mod interface;
pub mod microfacet;

/// Whose formulas curves and samples follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Formulas {
    /// The correct ones.
    #[default]
    Exact,
    /// The first report's, with their errors.
    FirstReport,
}
