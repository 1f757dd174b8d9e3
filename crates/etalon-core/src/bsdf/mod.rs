//! BSDFs: the registry of all, under one contract, [`Scatter`].
//!
//! Directions are unit vectors in the local frame, the normal at +z, and point away from the surface: `wo` towards the
//! viewer, `wi` towards the light. Light is radiance.
//!
//! A new BSDF is a file that implements [`Scatter`] and has its [`Family`], and an entry below.

mod coated_diffuse;
mod compensated_conductor;
mod conductor_fresnel;
mod contract;
mod dielectric;
mod diffuse;
mod energy;
mod errata_conductor;
mod examples;
mod mirror;
mod mixture;
mod oren_nayar;
mod rough_conductor;
mod rough_dielectric;
mod thin_dielectric;

pub use coated_diffuse::CoatedDiffuse;
pub use compensated_conductor::CompensatedConductor;
pub use conductor_fresnel::ConductorFresnel;
pub use contract::{BsdfSample, Lobe, Scatter, Vectorizable, VectorizedLoop};
pub use dielectric::{Dielectric, DielectricFresnel, Refraction};
pub use diffuse::Diffuse;
pub use energy::MissingEnergy;
pub use errata_conductor::{ErrataConductor, pdf_without_cosine};
pub use examples::{Example, Family, Parameter, examples};
pub use mirror::{Mirror, SmoothConductor};
pub use mixture::Mixture;
pub use oren_nayar::OrenNayar;
pub use rough_conductor::Facet;
pub use rough_conductor::{ByVisibleNormals, NormalSampling, RoughConductor};
pub use rough_dielectric::{LEAST_DEVIATION, RoughDielectric, is_resolved, refracting_facet};
pub use thin_dielectric::ThinDielectric;

use crate::math::Rgb;
use crate::optics::microfacet::{Beckmann, Ggx};
use glam::Vec3;

/// Makes an enum of all BSDFs, the lists of their names and docs and of their families, and the dispatch of [`Scatter`].
macro_rules! bsdfs {
    ($($(#[doc = $doc:literal])+ $variant:ident($bsdf:ty) = $families:expr,)*) => {
        /// Any BSDF, its constants computed once.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Bsdf {
            $($(#[doc = $doc])+ $variant($bsdf),)*
        }

        /// The registry: every BSDF by its name, with what it is in one line.
        pub const ALL: &[(&str, &str)] = &[$(($families[0].name, concat!($($doc),+))),*];

        /// The families of every BSDF of the registry: first that of its own name, then others.
        pub fn families() -> impl Iterator<Item = &'static Family> {
            [$($families),*].into_iter().flatten()
        }

        impl Bsdf {
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $families[0].name,)*
                }
            }
        }

        impl Scatter for Bsdf {
            fn lobes(&self) -> &[Lobe] {
                match self {
                    $(Self::$variant(bsdf) => bsdf.lobes(),)*
                }
            }

            #[inline]
            fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
                match self {
                    $(Self::$variant(bsdf) => bsdf.eval(wo, wi),)*
                }
            }

            #[inline]
            fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
                match self {
                    $(Self::$variant(bsdf) => bsdf.pdf(wo, wi),)*
                }
            }

            #[inline]
            fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
                match self {
                    $(Self::$variant(bsdf) => bsdf.eval_pdf(wo, wi),)*
                }
            }

            #[inline]
            fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
                match self {
                    $(Self::$variant(bsdf) => bsdf.sample(wo, uc, u),)*
                }
            }

            fn lobe_probability(&self, wo: Vec3, lobe: Lobe) -> f32 {
                match self {
                    $(Self::$variant(bsdf) => bsdf.lobe_probability(wo, lobe),)*
                }
            }

            fn is_reciprocal(&self) -> bool {
                match self {
                    $(Self::$variant(bsdf) => bsdf.is_reciprocal(),)*
                }
            }

            fn largest_weight(&self) -> Option<f32> {
                match self {
                    $(Self::$variant(bsdf) => bsdf.largest_weight(),)*
                }
            }

            fn is_delta(&self) -> bool {
                match self {
                    $(Self::$variant(bsdf) => bsdf.is_delta(),)*
                }
            }

            fn needs_choice(&self) -> bool {
                match self {
                    $(Self::$variant(bsdf) => bsdf.needs_choice(),)*
                }
            }

            fn with_albedo(&self, albedo: Rgb) -> Self {
                match self {
                    $(Self::$variant(bsdf) => Self::$variant(bsdf.with_albedo(albedo)),)*
                }
            }

            #[inline]
            fn vectorize(&self, work: impl VectorizedLoop) -> bool {
                match self {
                    $(Self::$variant(bsdf) => bsdf.vectorize(work),)*
                }
            }

            fn eval_adjoint(&self, wo: Vec3, wi: Vec3) -> Rgb {
                match self {
                    $(Self::$variant(bsdf) => bsdf.eval_adjoint(wo, wi),)*
                }
            }

            fn sample_adjoint(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
                match self {
                    $(Self::$variant(bsdf) => bsdf.sample_adjoint(wo, uc, u),)*
                }
            }
        }
    };
}

bsdfs! {
    /// Lambertian reflection on either side.
    Diffuse(Diffuse) = diffuse::FAMILIES,
    /// A perfect mirror of a given reflectance.
    Mirror(Mirror) = mirror::MIRROR,
    /// Refraction without reflection.
    Refraction(Refraction) = dielectric::REFRACTION,
    /// A smooth dielectric boundary: reflection and refraction.
    Dielectric(Dielectric) = dielectric::DIELECTRIC,
    /// A smooth conductor.
    SmoothConductor(SmoothConductor) = mirror::SMOOTH_CONDUCTOR,
    /// A rough conductor of Beckmann's distribution.
    Beckmann(RoughConductor<Beckmann<f32>>) = rough_conductor::BECKMANN,
    /// A rough conductor of the GGX distribution.
    Ggx(RoughConductor<Ggx<f32>>) = rough_conductor::GGX,
    /// A rough dielectric boundary of Beckmann's distribution.
    BeckmannDielectric(RoughDielectric<Beckmann<f32>>) = rough_dielectric::BECKMANN,
    /// A rough dielectric boundary of the GGX distribution.
    GgxDielectric(RoughDielectric<Ggx<f32>>) = rough_dielectric::GGX,
    /// A rough conductor of Beckmann's distribution with multiple scattering.
    CompensatedBeckmann(CompensatedConductor<Beckmann<f32>>) = compensated_conductor::BECKMANN,
    /// A rough conductor of the GGX distribution with multiple scattering.
    CompensatedGgx(CompensatedConductor<Ggx<f32>>) = compensated_conductor::GGX,
    /// A Lambertian surface under a smooth dielectric coat.
    CoatedDiffuse(CoatedDiffuse) = coated_diffuse::FAMILIES,
    /// A rough diffuse surface by Oren and Nayar's qualitative model.
    OrenNayar(OrenNayar) = oren_nayar::FAMILIES,
    /// A thin slab of a dielectric: both interfaces as one surface.
    ThinDielectric(ThinDielectric) = thin_dielectric::FAMILIES,
    /// A weighted sum of other BSDFs.
    Mixture(Mixture<Bsdf>) = mixture::FAMILIES,
    /// A rough conductor of Beckmann's distribution with errors of the second report.
    ErrataConductor(ErrataConductor) = errata_conductor::FAMILIES,
}

#[cfg(test)]
mod tests;
