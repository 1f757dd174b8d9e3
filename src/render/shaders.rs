//! One record per object with its BSDF and emission: scene materials become BSDFs under the settings of the render.

use super::geometry::Surface;
use super::lanes::NOTHING;
use super::lights::Sampled;
use super::settings::Settings;
use crate::bsdf::{Bsdf, Scatter};
use crate::math::Rgb;
use crate::scene::{Emission, Material, Object, Scene};
use glam::Vec3;

/// The BSDF and the emission of an object's surface.
pub struct SurfaceShader {
    /// How the surface scatters.
    pub bsdf: Bsdf,
    /// Its class.
    pub kind: Kind,
    /// Whether the material is the same on both sides: its normal is then turned towards the viewer.
    pub two_sided: bool,
    /// Emitted radiance.
    pub emission: Option<Emission>,
    /// The number of the first light that samples this object: the only one, or that of the first triangle.
    pub light: Option<u32>,
}

/// Classes of BSDFs that the integrator treats differently.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// All light is absorbed.
    Black,
    /// Lambertian reflection.
    Diffuse,
    /// Scatters into finitely many directions, which light samples cannot find.
    Delta,
    /// Any other reflection.
    Reflecting,
    /// Any other scattering, also to the other side.
    Transmitting,
}

impl Kind {
    /// Whether it is Lambertian reflection.
    #[inline]
    pub fn is_diffuse(self) -> bool {
        self == Self::Diffuse
    }
}

impl SurfaceShader {
    /// The records of all objects; `lights` are those that are sampled.
    pub fn all(scene: &Scene, settings: &Settings, lights: &[Sampled]) -> Vec<Self> {
        let kind = |material: &Material, bsdf: &Bsdf| match *material {
            Material::Diffuse { albedo: Rgb::ZERO } => Kind::Black,
            Material::Diffuse { .. } => Kind::Diffuse,
            _ if bsdf.is_delta() => Kind::Delta,
            _ if bsdf.lobes().iter().any(|lobe| lobe.is_transmission()) => Kind::Transmitting,
            _ => Kind::Reflecting,
        };
        let mut first = vec![None; scene.objects.len()];
        for (number, light) in lights.iter().enumerate().rev() {
            if light.object != NOTHING {
                first[light.object as usize] = Some(number as u32);
            }
        }
        let shader = |(i, object): (usize, &Object)| {
            let bsdf = object.material.bsdf(settings.model);
            Self {
                kind: kind(&object.material, &bsdf),
                bsdf,
                two_sided: object.material.is_two_sided(),
                emission: object.emission,
                light: first[i],
            }
        };
        scene.objects.iter().enumerate().map(shader).collect()
    }

    /// A hit on the surface; that of a two-sided material faces `wo`.
    #[inline]
    pub fn facing(&self, surface: Surface, wo: Vec3) -> Surface {
        if self.two_sided { surface.facing(wo) } else { surface }
    }

    /// The radiance that the surface emits against a ray's direction.
    #[inline]
    pub fn emitted(&self, normal: Vec3, direction: Vec3) -> Rgb {
        let emission = self.emission.filter(|emission| emission.is_emitted(normal, direction));
        emission.map_or(Rgb::ZERO, |emission| emission.radiance)
    }
}
