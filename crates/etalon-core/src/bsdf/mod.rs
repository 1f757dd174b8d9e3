//! BSDFs: the registry of all, under one contract, [`Scatter`].
//!
//! Directions are unit vectors in the local frame, the normal at +z, and point away from the surface: `wo` towards the
//! viewer, `wi` towards the light. Light is radiance.
//!
//! A new BSDF is a file that implements [`Scatter`], and an entry below.

mod coated_diffuse;
mod compensated_conductor;
mod conductor_fresnel;
mod contract;
mod dielectric;
mod diffuse;
mod energy;
mod errata_conductor;
mod mirror;
mod mixture;
mod rough_conductor;
mod rough_dielectric;

pub use coated_diffuse::CoatedDiffuse;
pub use compensated_conductor::CompensatedConductor;
pub use conductor_fresnel::ConductorFresnel;
pub use contract::{BsdfSample, Lobe, Scatter, Vectorizable};
pub use dielectric::{Dielectric, DielectricFresnel, Refraction};
pub use diffuse::Diffuse;
pub use energy::MissingEnergy;
pub use errata_conductor::{ErrataConductor, pdf_without_cosine};
pub use mirror::{Mirror, SmoothConductor};
pub use mixture::Mixture;
pub use rough_conductor::Facet;
pub use rough_conductor::{ByVisibleNormals, NormalSampling, RoughConductor};
pub use rough_dielectric::refracting_facet;
pub use rough_dielectric::{LEAST_DEVIATION, RoughDielectric};

use crate::math::Rgb;
use crate::optics::microfacet::{Beckmann, Ggx};
use glam::Vec3;

/// Makes an enum of all BSDFs, the list of their names and docs, and the dispatch of [`Scatter`].
macro_rules! bsdfs {
    ($($(#[doc = $doc:literal])+ $variant:ident($bsdf:ty) = $name:literal,)*) => {
        /// Any BSDF, its constants computed once.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Bsdf {
            $($(#[doc = $doc])+ $variant($bsdf),)*
        }

        /// The registry: every BSDF by its name, with what it is in one line.
        pub const ALL: &[(&str, &str)] = &[$(($name, concat!($($doc),+))),*];

        impl Bsdf {
            /// Its name in the registry.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $name,)*
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
    Diffuse(Diffuse) = "diffuse",
    /// A perfect mirror of a given reflectance.
    Mirror(Mirror) = "mirror",
    /// Refraction without reflection.
    Refraction(Refraction) = "refraction",
    /// A smooth dielectric boundary: reflection and refraction.
    Dielectric(Dielectric) = "dielectric",
    /// A smooth conductor.
    SmoothConductor(SmoothConductor) = "smooth-conductor",
    /// A rough conductor of Beckmann's distribution.
    Beckmann(RoughConductor<Beckmann<f32>>) = "beckmann",
    /// A rough conductor of the GGX distribution.
    Ggx(RoughConductor<Ggx<f32>>) = "ggx",
    /// A rough dielectric boundary of Beckmann's distribution.
    BeckmannDielectric(RoughDielectric<Beckmann<f32>>) = "beckmann-dielectric",
    /// A rough dielectric boundary of the GGX distribution.
    GgxDielectric(RoughDielectric<Ggx<f32>>) = "ggx-dielectric",
    /// A rough conductor of Beckmann's distribution with multiple scattering.
    CompensatedBeckmann(CompensatedConductor<Beckmann<f32>>) = "compensated-beckmann",
    /// A rough conductor of the GGX distribution with multiple scattering.
    CompensatedGgx(CompensatedConductor<Ggx<f32>>) = "compensated-ggx",
    /// A Lambertian surface under a smooth dielectric coat.
    CoatedDiffuse(CoatedDiffuse) = "coated-diffuse",
    /// A weighted sum of other BSDFs.
    Mixture(Mixture<Bsdf>) = "mixture",
    /// A rough conductor of Beckmann's distribution with errors of the second report.
    ErrataConductor(ErrataConductor) = "errata-conductor",
}

#[cfg(test)]
mod tests;
