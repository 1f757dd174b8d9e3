//! A material's scattering functions: its constants computed once, or varying with its textures.

use super::material::{Conductor, Dielectric, Material, SMOOTH_ALPHA, Textured};
use crate::bsdf::{
    self, Bsdf, CompensatedConductor, ConductorFresnel, DielectricFresnel, Diffuse, ErrataConductor, Mirror,
    MissingEnergy, Mixture, NormalSampling, Refraction, RoughConductor, RoughDielectric, SmoothConductor, is_resolved,
};
use crate::errata::microfacet::MetalErrors;
use crate::optics::microfacet::{Beckmann, Distribution, Ggx};
use glam::Vec2;
use std::sync::Arc;

/// Which of several models and sampling strategies to use for the materials of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScatterModel {
    /// How rough conductors are sampled.
    pub normals: NormalSampling,
    pub dielectric: DielectricFresnel,
    /// Errors of rough metal of Beckmann's distribution, whose directions are then sampled by all normals.
    pub metal: MetalErrors,
}

impl ScatterModel {
    /// The correct formulas, and the best sampling.
    pub const EXACT: Self =
        Self { normals: NormalSampling::Vndf, dielectric: DielectricFresnel::Exact, metal: MetalErrors::NONE };

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
    pub fn bsdf(&self, model: ScatterModel) -> Bsdf {
        match self {
            &Self::Diffuse { albedo } => Bsdf::Diffuse(Diffuse::new(albedo)),
            &Self::Mirror { reflectance } => Bsdf::Mirror(Mirror { reflectance }),
            &Self::Refraction { transmittance, eta } => Bsdf::Refraction(Refraction { transmittance, eta }),
            Self::Dielectric(dielectric) => dielectric.bsdf(model),
            Self::Conductor(conductor) => conductor.bsdf(model),
            Self::Bsdf(bsdf) => Bsdf::clone(bsdf),
            Self::Mixture(parts) => {
                Bsdf::Mixture(Mixture::new(parts.iter().map(|(weight, part)| (*weight, part.bsdf(model)))))
            }
            Self::Textured(textured) => textured.base.bsdf(model),
        }
    }
}

impl Dielectric {
    /// Whether it has no microfacets, or none that f32 directions resolve: see [`SMOOTH_ALPHA`] and [`is_resolved`].
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

/// The BSDF of a material at each point of a surface.
pub enum VaryingBsdf {
    /// The same everywhere.
    Constant(Bsdf),
    /// That of a material with textures.
    Textured(Arc<Textured>, ScatterModel),
    /// A weighted sum.
    Mixture(Box<[(f32, VaryingBsdf)]>),
}

impl VaryingBsdf {
    pub fn new(material: &Material, model: ScatterModel) -> Self {
        match material {
            Material::Textured(textured) => Self::Textured(Arc::clone(textured), model),
            Material::Mixture(parts) => {
                Self::Mixture(parts.iter().map(|(weight, part)| (*weight, Self::new(part, model))).collect())
            }
            plain => Self::Constant(plain.bsdf(model)),
        }
    }

    pub fn at(&self, uv: Vec2) -> Bsdf {
        match self {
            Self::Constant(bsdf) => bsdf.clone(),
            Self::Textured(textured, model) => textured.at(uv).bsdf(*model),
            Self::Mixture(parts) => {
                Bsdf::Mixture(Mixture::new(parts.iter().map(|(weight, part)| (*weight, part.at(uv)))))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Conductor, Dielectric, Distribution, SMOOTH_ALPHA, Texture};
    use super::*;
    use crate::bsdf::CoatedDiffuse;
    use crate::math::Rgb;

    fn textured(base: Material) -> Textured {
        Textured { base, reflectance: None, transmittance: None, alpha: None }
    }

    fn bsdf(material: &Material) -> Bsdf {
        material.bsdf(ScatterModel::default())
    }

    fn varying(textured: Textured) -> Bsdf {
        VaryingBsdf::new(&Material::Textured(Arc::new(textured)), ScatterModel::default()).at(Vec2::ZERO)
    }

    #[test]
    fn a_constant_texture_is_the_plain_material() {
        let albedo = Rgb::new(0.2, 0.5, 0.9);
        let reflectance = Some(Texture::Constant(albedo));
        let coat = |albedo| Material::from(Bsdf::CoatedDiffuse(CoatedDiffuse::new(albedo, 1.4)));
        for (base, plain) in [
            (Material::Diffuse { albedo: Rgb::ONE }, Material::Diffuse { albedo }),
            (Material::Mirror { reflectance: Rgb::ONE }, Material::Mirror { reflectance: albedo }),
            (coat(Rgb::ONE), coat(albedo)),
        ] {
            assert_eq!(varying(Textured { reflectance: reflectance.clone(), ..textured(base) }), bsdf(&plain));
        }
        let glass = |transmittance| {
            Material::Dielectric(Dielectric { transmittance, ..Dielectric::rough(1.5, 0.3, Distribution::Ggx) })
        };
        let transmittance = Some(Texture::Constant(albedo));
        assert_eq!(varying(Textured { transmittance, ..textured(glass(Rgb::ONE)) }), bsdf(&glass(albedo)));
        let parts = |part| Material::Mixture(Arc::new([(0.3, part), (0.7, glass(Rgb::ONE))]));
        let diffuse = Material::Diffuse { albedo };
        let varied = Textured { reflectance, ..textured(Material::Diffuse { albedo: Rgb::ONE }) };
        let mixture = parts(Material::Textured(Arc::new(varied)));
        assert!(mixture.is_textured());
        assert_eq!(VaryingBsdf::new(&mixture, ScatterModel::default()).at(Vec2::ZERO), bsdf(&parts(diffuse)));
    }

    #[test]
    fn textures_of_roughness_keep_rough_surfaces_rough() {
        let (eta, k) = (Rgb::splat(0.2), Rgb::splat(3.0));
        for texture in [0.0, 0.3] {
            let alpha = Some([Texture::Constant(Rgb::splat(texture)), Texture::Constant(Rgb::splat(0.5))]);
            let metal = Material::Conductor(Conductor::new(eta, k, 0.5, Distribution::Ggx));
            let varied = Textured { alpha: alpha.clone(), ..textured(metal) };
            assert!(Material::Textured(Arc::new(varied.clone())).is_anisotropic());
            let Material::Conductor(found) = varied.at(Vec2::ZERO) else { panic!("{varied:?}") };
            assert_eq!(found.alpha, [texture.max(SMOOTH_ALPHA), 0.5]);
            for eta in [1.5, 0.7, 1.000_1] {
                let glass = Material::Dielectric(Dielectric::rough(eta, 0.5, Distribution::Ggx));
                let Material::Dielectric(found) = (Textured { alpha: alpha.clone(), ..textured(glass) }).at(Vec2::ZERO)
                else {
                    panic!("{eta}")
                };
                assert!(!found.is_smooth(), "{found:?}");
            }
        }
    }
}
