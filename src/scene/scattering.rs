//! A material's scattering functions, its constants computed once.

use super::material::{Conductor, Material};
use crate::bsdf::report_model::{ReportConductor, ReportConventions, ReportGlass};
use crate::bsdf::{
    self, Bsdf, DielectricFresnel, Diffuse, Glass, MetalFresnel, Mirror, Normals, Refraction, SmoothConductor,
};
use crate::optics::microfacet::{Beckmann, Distribution, Ggx};

/// Which of several models and sampling strategies to use for the materials of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ScatterModel {
    /// How rough conductors are sampled.
    pub normals: Normals,
    /// What glass reflects.
    pub dielectric: DielectricFresnel,
    /// The reports' conventions, which where they apply take precedence over the above.
    pub report: ReportConventions,
}

impl Material {
    /// The scattering functions of the material.
    #[must_use]
    pub fn bsdf(&self, model: ScatterModel) -> Bsdf {
        match *self {
            Self::Diffuse { albedo } => Bsdf::Diffuse(Diffuse::new(albedo)),
            Self::Mirror { reflectance } => Bsdf::Mirror(Mirror { reflectance }),
            Self::Refraction { transmittance, eta } => Bsdf::Refraction(Refraction { transmittance, eta }),
            Self::Glass { reflectance, transmittance, eta } if model.report.single_cosine_schlick => {
                Bsdf::ReportGlass(ReportGlass { reflectance, transmittance, eta })
            }
            Self::Glass { reflectance, transmittance, eta } => {
                Bsdf::Glass(Glass { reflectance, transmittance, eta, fresnel: model.dielectric })
            }
            Self::Conductor(conductor) => conductor.bsdf(model),
        }
    }
}

impl Conductor {
    /// The reports know Beckmann's distribution only; their conventions leave the others alone.
    fn bsdf(&self, model: ScatterModel) -> Bsdf {
        let fresnel = MetalFresnel::new(self.eta, self.k);
        let normals = model.normals;
        if self.alpha < Self::SMOOTH_ALPHA {
            return Bsdf::SmoothConductor(SmoothConductor { fresnel });
        }
        match self.distribution {
            Distribution::Beckmann => {
                let distribution = Beckmann::new(self.alpha);
                if model.report.change_metal() {
                    return Bsdf::ReportConductor(ReportConductor { distribution, fresnel, conventions: model.report });
                }
                Bsdf::Beckmann(bsdf::Conductor { distribution, fresnel, normals })
            }
            Distribution::Ggx => Bsdf::Ggx(bsdf::Conductor { distribution: Ggx::new(self.alpha), fresnel, normals }),
        }
    }
}
