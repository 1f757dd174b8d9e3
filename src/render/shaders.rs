//! What each object does to light, made ready: scene materials become BSDFs under the settings of the render.

use super::lights::Sampled;
use super::settings::Settings;
use crate::bsdf::{Bsdf, Scatter};
use crate::math::Rgb;
use crate::scene::{Emission, Material, Scene};

/// What an object does to light.
pub struct SurfaceShader {
    pub kind: Kind,
    /// Whether the material reflects alike on both sides: its normal then shaders the viewer.
    pub two_sided: bool,
    pub emission: Option<Emission>,
    /// The number of the light that samples this object.
    pub light: Option<usize>,
}

/// How a hit is dealt with.
pub enum Kind {
    /// All light is absorbed.
    Black,
    /// Together with other diffuse hits.
    Diffuse {
        albedo: Rgb,
    },
    /// In one of finitely many directions, which no light sample can find.
    Delta(Bsdf),
    Rough(Bsdf),
}

impl SurfaceShader {
    /// The shaders of all objects; `lights` are those that are sampled.
    pub fn all(scene: &Scene, settings: &Settings, lights: &[Sampled]) -> Vec<Self> {
        let kind = |material: &Material| match *material {
            Material::Diffuse { albedo: Rgb::ZERO } => Kind::Black,
            Material::Diffuse { albedo } => Kind::Diffuse { albedo },
            ref other => {
                let bsdf = other.bsdf(settings.model);
                if bsdf.lobes().are_delta() { Kind::Delta(bsdf) } else { Kind::Rough(bsdf) }
            }
        };
        let shader = |(i, object): (usize, &crate::scene::Object)| Self {
            kind: kind(&object.material),
            two_sided: matches!(object.material, Material::Conductor(conductor) if conductor.two_sided),
            emission: object.emission,
            light: lights.iter().position(|light| light.object == i as u32),
        };
        scene.objects.iter().enumerate().map(shader).collect()
    }
}
