//! A material's scattering functions, its constants computed once.

use super::material::{Conductor, Dielectric, Material, SMOOTH_ALPHA};
use crate::bsdf::{
    self, Bsdf, CompensatedConductor, ConductorFresnel, DielectricFresnel, Diffuse, ErrataConductor, Mirror,
    MissingEnergy, Mixture, NormalSampling, Refraction, RoughConductor, RoughDielectric, SmoothConductor, is_resolved,
};
use crate::errata::microfacet::MetalErrors;
use crate::optics::microfacet::{Beckmann, Distribution, Ggx};

/// Which of several models and sampling strategies to use for the materials of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScatterModel {
    /// How rough conductors are sampled.
    pub normals: NormalSampling,
    /// What glass reflects.
    pub dielectric: DielectricFresnel,
    /// Errors of rough metal of Beckmann's distribution, whose directions are then sampled by all normals.
    pub metal: MetalErrors,
}

impl ScatterModel {
    /// The correct formulas, and the best sampling.
    pub const EXACT: Self =
        Self { normals: NormalSampling::Vndf, dielectric: DielectricFresnel::Exact, metal: MetalErrors::NONE };

    /// The formulas of the second report.
    pub const SECOND_REPORT: Self =
        Self { dielectric: DielectricFresnel::SingleCosineSchlick, metal: MetalErrors::ALL, ..Self::EXACT };
}

impl Default for ScatterModel {
    fn default() -> Self {
        Self::EXACT
    }
}

impl Material {
    /// The scattering functions of the material; with textures, those of its base: see [`super::VaryingBsdf`].
    #[must_use]
    pub fn bsdf(&self, model: ScatterModel) -> Bsdf {
        match self {
            &Self::Diffuse { albedo } => Bsdf::Diffuse(Diffuse::new(albedo)),
            &Self::Mirror { reflectance } => Bsdf::Mirror(Mirror { reflectance }),
            &Self::Refraction { transmittance, eta } => Bsdf::Refraction(Refraction { transmittance, eta }),
            Self::Dielectric(dielectric) => dielectric.bsdf(model),
            Self::Conductor(conductor) => conductor.bsdf(model),
            Self::Bsdf(bsdf) => bsdf.clone(),
            Self::Mixture(parts) => {
                Bsdf::Mixture(Mixture::new(parts.iter().map(|(weight, part)| (*weight, part.bsdf(model)))))
            }
            Self::Textured(textured) => textured.base.bsdf(model),
        }
    }
}

impl Dielectric {
    /// Whether it has no microfacets, or none that f32 directions resolve: see [`SMOOTH_ALPHA`] and [`is_resolved`].
    #[must_use]
    pub fn is_smooth(&self) -> bool {
        let alpha = self.alpha[0].min(self.alpha[1]);
        alpha < SMOOTH_ALPHA || !is_resolved(self.alpha, self.eta)
    }

    /// Other formulas of Fresnel's reflectance are of smooth boundaries only.
    fn bsdf(&self, model: ScatterModel) -> Bsdf {
        let &Self { reflectance, transmittance, eta, alpha, distribution } = self;
        if self.is_smooth() {
            return Bsdf::Dielectric(bsdf::Dielectric { reflectance, transmittance, eta, fresnel: model.dielectric });
        }
        match distribution {
            Distribution::Beckmann => {
                let facets = Beckmann::anisotropic(alpha);
                Bsdf::BeckmannDielectric(RoughDielectric::new(facets, reflectance, transmittance, eta))
            }
            Distribution::Ggx => {
                let facets = Ggx::anisotropic(alpha);
                Bsdf::GgxDielectric(RoughDielectric::new(facets, reflectance, transmittance, eta))
            }
        }
    }
}

impl Conductor {
    fn bsdf(&self, model: ScatterModel) -> Bsdf {
        let fresnel = ConductorFresnel::new(self.eta, self.k);
        let normals = model.normals;
        if self.alpha[0].min(self.alpha[1]) < SMOOTH_ALPHA {
            return Bsdf::SmoothConductor(SmoothConductor { fresnel });
        }
        match self.distribution {
            Distribution::Beckmann => {
                let distribution = Beckmann::anisotropic(self.alpha);
                if model.metal != MetalErrors::NONE {
                    return Bsdf::ErrataConductor(ErrataConductor { distribution, fresnel, errors: model.metal });
                }
                // Its visible normals are sampled as a whole.
                let normals = if normals == NormalSampling::Bounded { NormalSampling::Vndf } else { normals };
                let single = RoughConductor { distribution, fresnel, normals };
                if self.multiple_scattering {
                    let energy = MissingEnergy::new(Beckmann::anisotropic(self.alpha.map(f64::from)));
                    return Bsdf::CompensatedBeckmann(CompensatedConductor::new(single, energy));
                }
                Bsdf::Beckmann(single)
            }
            Distribution::Ggx => {
                let single = RoughConductor { distribution: Ggx::anisotropic(self.alpha), fresnel, normals };
                if self.multiple_scattering {
                    let energy = MissingEnergy::new(Ggx::anisotropic(self.alpha.map(f64::from)));
                    return Bsdf::CompensatedGgx(CompensatedConductor::new(single, energy));
                }
                Bsdf::Ggx(single)
            }
        }
    }
}
