//! One record per object with its BSDF and emission: scene materials become BSDFs under the settings of the render.

use super::lights::Sampled;
use super::settings::Settings;
use crate::bsdf::{Bsdf, Scatter};
use crate::math::Rgb;
use crate::scene::{Emission, Material, Scene};

/// The BSDF and the emission of an object's surface.
pub struct SurfaceShader {
    /// How the surface scatters.
    pub kind: Kind,
    /// Whether the material is the same on both sides: its normal is then turned towards the viewer.
    pub two_sided: bool,
    /// Emitted radiance.
    pub emission: Option<Emission>,
    /// The number of the light that samples this object.
    pub light: Option<usize>,
}

/// Classes of BSDFs that the integrator treats differently.
pub enum Kind {
    /// All light is absorbed.
    Black,
    /// Lambertian reflection.
    Diffuse {
        /// Reflected share, per channel.
        albedo: Rgb,
    },
    /// Scatters into finitely many directions, which light samples cannot find.
    Delta(Bsdf),
    /// Any other BSDF.
    Rough(Bsdf),
}

impl SurfaceShader {
    /// The records of all objects; `lights` are those that are sampled.
    pub fn all(scene: &Scene, settings: &Settings, lights: &[Sampled]) -> Vec<Self> {
        let kind = |material: &Material| match *material {
            Material::Diffuse { albedo: Rgb::ZERO } => Kind::Black,
            Material::Diffuse { albedo } => Kind::Diffuse { albedo },
            ref other => {
                let bsdf = other.bsdf(settings.model);
                if bsdf.is_delta() { Kind::Delta(bsdf) } else { Kind::Rough(bsdf) }
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
