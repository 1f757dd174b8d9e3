//! A material's scattering functions, its constants computed once.

use super::material::{Conductor, Dielectric, Material, SMOOTH_ALPHA};
use crate::bsdf::{
    self, Bsdf, ConductorFresnel, DielectricFresnel, Diffuse, ErrataConductor, Mirror, NormalSampling, Refraction,
    SmoothConductor,
};
use crate::errata::Conventions;
use crate::optics::microfacet::{Beckmann, Distribution, Ggx};

/// Which of several models and sampling strategies to use for the materials of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ScatterModel {
    /// How rough conductors are sampled.
    pub normals: NormalSampling,
    /// What glass reflects.
    pub dielectric: DielectricFresnel,
    /// The conventions, which where they differ from the correct ones take precedence over the above.
    pub conventions: Conventions,
}

impl Material {
    /// The scattering functions of the material.
    #[must_use]
    pub fn bsdf(&self, model: ScatterModel) -> Bsdf {
        match self {
            &Self::Diffuse { albedo } => Bsdf::Diffuse(Diffuse::new(albedo)),
            &Self::Mirror { reflectance } => Bsdf::Mirror(Mirror { reflectance }),
            &Self::Refraction { transmittance, eta } => Bsdf::Refraction(Refraction { transmittance, eta }),
            Self::Dielectric(dielectric) => dielectric.bsdf(model),
            Self::Conductor(conductor) => conductor.bsdf(model),
            &Self::CoatedDiffuse { albedo, .. } => Bsdf::Diffuse(Diffuse::new(albedo)),
            Self::Mixture(parts) => parts[0].1.bsdf(model),
        }
    }
}

impl Dielectric {
    /// Other conventions are of smooth boundaries only.
    fn bsdf(&self, model: ScatterModel) -> Bsdf {
        let &Self { reflectance, transmittance, eta, .. } = self;
        let fresnel = if model.conventions.single_cosine_schlick {
            DielectricFresnel::SingleCosineSchlick
        } else {
            model.dielectric
        };
        Bsdf::Dielectric(bsdf::Dielectric { reflectance, transmittance, eta, fresnel })
    }
}

impl Conductor {
    /// Other conventions are of Beckmann's distribution only; they leave GGX alone.
    fn bsdf(&self, model: ScatterModel) -> Bsdf {
        let fresnel = ConductorFresnel::new(self.eta, self.k);
        let normals = model.normals;
        if self.alpha[0].min(self.alpha[1]) < SMOOTH_ALPHA {
            return Bsdf::SmoothConductor(SmoothConductor { fresnel });
        }
        match self.distribution {
            Distribution::Beckmann => {
                let distribution = Beckmann::new(self.alpha[0]);
                if model.conventions.change_metal() {
                    return Bsdf::ErrataConductor(ErrataConductor {
                        distribution,
                        fresnel,
                        conventions: model.conventions,
                    });
                }
                Bsdf::Beckmann(bsdf::RoughConductor { distribution, fresnel, normals })
            }
            Distribution::Ggx => {
                Bsdf::Ggx(bsdf::RoughConductor { distribution: Ggx::new(self.alpha[0]), fresnel, normals })
            }
        }
    }
}
