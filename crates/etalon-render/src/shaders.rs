//! One record per object with its BSDF and emission: scene materials become BSDFs under the settings of the render.
//!
//! Also what follows where shading normals differ from the surface's: the factor of light paths, and which paths have no density of light
//! tracing.
//!
//! Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 5.3.

use super::geometry::Surface;
use super::lights::SampledLight;
use super::settings::Settings;
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::math::{Frame, Rgb};
use etalon_core::scene::{Emission, Material, Scene, VaryingBsdf};
use glam::{Vec2, Vec3};
use std::borrow::Cow;
use std::sync::Arc;

/// The BSDF and the emission of an object's surface.
#[derive(Clone)]
pub struct SurfaceShader {
    /// How the surface scatters; with textures, a BSDF of the same lobes: see [`bsdf_at`](Self::bsdf_at).
    pub bsdf: Arc<Bsdf>,
    /// The BSDF at each point, if the material has textures.
    pub varying: Option<Arc<VaryingBsdf>>,
    pub kind: Kind,
    /// Whether the material is the same on both sides: its normal is then turned towards the viewer.
    pub two_sided: bool,
    /// Whether the BSDF depends on the surface's tangent.
    pub is_anisotropic: bool,
    pub emission: Option<Emission>,
    /// The number of the first light that samples this object: the only one, or that of the first triangle.
    pub light: Option<u32>,
}

/// Classes of BSDFs that the integrator treats differently.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// All light is absorbed.
    Black,
    Diffuse,
    /// Scatters into finitely many directions, which light samples cannot find.
    Delta,
    /// Any other reflection.
    Reflecting,
    /// Any other scattering, also to the other side.
    Transmitting,
}

impl Kind {
    #[inline]
    pub fn is_diffuse(self) -> bool {
        self == Self::Diffuse
    }

    /// The normal of a surface that scatters light on its side alone; `None` of one that transmits.
    #[inline(always)]
    pub fn one_sided(self, normal: Vec3) -> Option<Vec3> {
        if self == Self::Transmitting { None } else { Some(normal) }
    }
}

impl SurfaceShader {
    /// The memory that it takes, with a BSDF of its own.
    pub const BYTES: usize = size_of::<Self>() + size_of::<Bsdf>();

    /// The records of all objects; `lights` are those that are sampled.
    pub fn all(scene: &Scene, settings: &Settings, lights: &[SampledLight]) -> Vec<Self> {
        let mut shaders: Vec<Self> = Vec::with_capacity(scene.objects.len());
        for (i, object) in scene.objects.iter().enumerate() {
            // Neighbours of one material share its BSDF. Textures are not compared: they may be large.
            let before = i.checked_sub(1).map(|before| &scene.objects[before].material);
            let is_same = !object.material.is_textured() && before == Some(&object.material);
            let shader = match shaders.last() {
                Some(last) if is_same => last.clone(),
                _ => Self::new(&object.material, settings),
            };
            shaders.push(Self { emission: object.emission, light: None, ..shader });
        }
        for (number, light) in (0..).zip(lights) {
            if let Some(shader) = shaders.get_mut(light.object as usize) {
                shader.light.get_or_insert(number);
            }
        }
        shaders
    }

    /// The record of a surface that emits nothing.
    fn new(material: &Material, settings: &Settings) -> Self {
        let bsdf = Arc::new(material.bsdf(settings.model));
        let kind = match *plain(material) {
            Material::Diffuse { albedo: Rgb::ZERO } if !material.is_textured() => Kind::Black,
            Material::Diffuse { .. } => Kind::Diffuse,
            _ if bsdf.is_delta() => Kind::Delta,
            _ if bsdf.lobes().iter().any(|lobe| lobe.is_transmission()) => Kind::Transmitting,
            _ => Kind::Reflecting,
        };
        Self {
            bsdf,
            varying: material.is_textured().then(|| Arc::new(VaryingBsdf::new(material, settings.model))),
            kind,
            two_sided: material.is_two_sided(),
            is_anisotropic: material.is_anisotropic(),
            emission: None,
            light: None,
        }
    }

    /// The BSDF where the texture coordinates are `uv`, which only a material with textures asks for.
    #[inline]
    pub fn bsdf_at(&self, uv: impl FnOnce() -> Vec2) -> Cow<'_, Bsdf> {
        match &self.varying {
            None => Cow::Borrowed(&self.bsdf),
            Some(varying) => Cow::Owned(varying.at(uv())),
        }
    }

    /// A hit on the surface; that of a two-sided material faces `wo`.
    #[inline]
    pub fn facing(&self, surface: Surface, wo: Vec3) -> Surface {
        if self.two_sided { surface.facing(wo) } else { surface }
    }

    /// [`Surface::frame`]; its x axis is the tangent if the BSDF is anisotropic.
    #[inline]
    pub fn frame(&self, surface: &Surface, wo: Vec3, tangent: impl FnOnce() -> Vec3) -> Frame {
        if self.is_anisotropic {
            Frame::from_normal_and_tangent(surface.shading_for(wo), tangent())
        } else {
            surface.frame(wo)
        }
    }
}

/// The material, or what textures vary.
pub(super) fn plain(material: &Material) -> &Material {
    match material {
        Material::Textured(textured) => &textured.base,
        plain => plain,
    }
}

/// The factor on a light path where the shading normal ns is not the surface's normal n, so that it has the value that a
/// camera path finds: |wo·ns| |wi·n| / (|wo·n| |wi·ns|). `wo` points to the light, `wi` to the camera.
#[inline]
pub fn adjoint_factor(surface: &Surface, wo: Vec3, wi: Vec3) -> f32 {
    let normals = surface.normals();
    if surface.is_flat() { 1.0 } else { ratio(normals, wo) / ratio(normals, wi) }
}

/// The cosine to the shading normal over that to the surface's normal.
#[inline]
fn ratio([n, ns]: [Vec3; 2], w: Vec3) -> f32 {
    ns.dot(w) / n.dot(w)
}

/// Whether the surface's normal n and the shading normal agree on a direction, up to a factor of 2 in the cosine. Where only
/// one of the cosines is near 0, a light path would leave a single very bright pixel (a firefly).
#[inline]
pub fn is_sound(normals: [Vec3; 2], w: Vec3) -> bool {
    normals[0] == normals[1] || (0.5..=2.0).contains(&ratio(normals, w))
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::{Object, builtin};

    #[test]
    fn neighbours_of_one_material_share_its_bsdf_alone() {
        let (mut scene, _) = builtin::cornell_lambert();
        let count = scene.objects.len();
        let lit = scene.objects.iter().position(|object| object.emission.is_some()).unwrap();
        scene.objects.push(scene.objects[lit].clone());
        scene.objects.push(Object { emission: None, ..scene.objects[lit].clone() });
        let settings = Settings::default();
        let shaders = SurfaceShader::all(&scene, &settings, &SampledLight::all(&scene, &settings, &[]));
        let [.., one, other] = &shaders[..] else { panic!() };
        assert!(Arc::ptr_eq(&one.bsdf, &other.bsdf) && one.emission.is_some() && other.emission.is_none());
        assert_eq!((shaders[lit].light, one.light, other.light), (Some(0), Some(1), None));
        let same = |i: usize| scene.objects[i].material == scene.objects[i - 1].material;
        assert!((1..count).all(|i| Arc::ptr_eq(&shaders[i].bsdf, &shaders[i - 1].bsdf) == same(i)));
    }
}
