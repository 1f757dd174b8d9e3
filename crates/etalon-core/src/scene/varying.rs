//! The BSDFs of a material with textures.

use super::material::{Material, Textured};
use super::scattering::ScatterModel;
use crate::bsdf::{Bsdf, Mixture};
use glam::Vec2;
use std::sync::Arc;

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
    /// The BSDFs of a material.
    #[must_use]
    pub fn new(material: &Material, model: ScatterModel) -> Self {
        match material {
            Material::Textured(textured) => Self::Textured(Arc::clone(textured), model),
            Material::Mixture(parts) => {
                Self::Mixture(parts.iter().map(|(weight, part)| (*weight, Self::new(part, model))).collect())
            }
            plain => Self::Constant(plain.bsdf(model)),
        }
    }

    /// The BSDF at a point.
    #[must_use]
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
    use super::*;
    use crate::bsdf::CoatedDiffuse;
    use crate::math::Rgb;
    use crate::scene::{Conductor, Dielectric, Distribution, SMOOTH_ALPHA, Texture};

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
        let coat = |albedo| Material::Bsdf(Bsdf::CoatedDiffuse(CoatedDiffuse::new(albedo, 1.4)));
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
