//! What passes from stage to stage: rays, interactions, and shadow rays.

use crate::bsdf_lanes::{Bsdfs, TransportMode};
use crate::camera::PreparedCamera;
use crate::film::PathClass;
use crate::geometry::Surface;
use crate::lanes::{Hits, at, lanes, plain_items};
use crate::light_tracing::{LightTracing, projected};
use crate::prepared::PreparedScene;
use crate::previous::PreviousVertex;
use crate::ray_samples::RaySamples;
use crate::shaders::{Kind, SurfaceShader, is_sound};
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::math::{Frame, Rgb};
use etalon_core::scene::Ray;
use glam::{Vec2, Vec3};

plain_items! { PathClass = PathClass::DIRECT, Surface = Surface::NONE }

lanes! {
    /// Paths in flight: the ray of each, and what it carries.
    pub struct PathRays of PathRay {
        ray: Ray,
        /// Product of BSDF times cosine over pdf so far; of light paths times the power of the light.
        beta: Rgb,
        /// Product of η² of the refractions so far: `beta` times it is the throughput without the scale 1/η² of radiance in a medium.
        eta_scale: f32,
        /// The vertex that the ray has left.
        previous: PreviousVertex,
        /// The camera sample, or the slot of the light path.
        slot: u32,
        /// The scatterings so far.
        path_class: PathClass,
    }
}

lanes! {
    /// Points where rays have hit surfaces of one material.
    pub struct Interactions of Interaction {
        /// The index of the ray that has hit it.
        ray: u32,
        slot: u32,
        /// Unit normal of the surface.
        n: Vec3,
        /// Unit normal for shading, on the side of the ray's origin except at surfaces that transmit.
        ns: Vec3,
        /// Where rays to the side of the ray's origin start.
        origin: Vec3,
        /// Throughput of the path; of camera paths at diffuse surfaces times the albedo.
        beta: Rgb,
        /// The class of the path if it is scattered here, not by a delta lobe.
        path_class: PathClass,
        /// [`PreviousVertex::q`] of the path up to here; of camera paths at diffuse surfaces with the factor of the direction to the viewer.
        q: f32,
    }
}

lanes! {
    /// The shading frames of vertices, except of camera paths at diffuse surfaces.
    pub struct ShadingFrames of ShadingFrame {
        surface: Surface,
        /// Tangents of the shading frame, whose z axis is the normal for shading.
        x: Vec3,
        y: Vec3,
        /// Direction to the viewer; in light paths to the light.
        wo: Vec3,
        /// The same in the frame.
        local_wo: Vec3,
        /// Texture coordinates, if the material has textures.
        uv: Vec2,
    }
}

lanes! {
    /// Rays towards light samples, and what each adds to its camera sample if nothing is in the way.
    pub struct ShadowRays of ShadowRay {
        ray: Ray,
        /// Its length, which ends in front of the light; 0 if the value is 0.
        t_max: f32,
        /// What the camera sample gains if nothing is in the way; of rays that look for emitters, except for their radiance.
        value: Rgb,
        slot: u32,
        path_class: PathClass,
    }
}

/// What every stage of a depth reads.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    pub scene: &'a PreparedScene<'a>,
    pub camera: &'a PreparedCamera,
    /// Radiance for camera paths, importance for light paths.
    pub mode: TransportMode,
    pub samples: RaySamples<'a>,
    /// Vertices before this one, without the camera's and with the light's.
    pub depth: u32,
}

impl Step<'_> {
    /// [`PreviousVertex::q`] where ray `i` has hit a surface; at the first hit of a camera path the camera's area there.
    #[inline(always)]
    pub fn q(&self, rays: &PathRays, hits: &Hits, i: usize) -> f32 {
        if self.depth > 0 || self.scene.light_tracing.is_none() {
            return rays.previous[i].q;
        }
        let Ray { origin, direction } = rays.ray.at(i);
        LightTracing::q_at_camera(self.camera.area_at(origin + hits.t[i] * direction))
    }
}

/// The tables of [`Vertices`].
#[derive(Default)]
pub struct VertexBuffers {
    pub interactions: Interactions,
    pub frames: ShadingFrames,
    /// The BSDFs of interactions with an object that has textures.
    pub varying: Vec<Bsdf>,
}

/// Vertices of paths at surfaces of one material.
#[derive(Clone, Copy)]
pub struct Vertices<'a> {
    pub step: Step<'a>,
    /// The surface of the first one; others that are diffuse may have another albedo.
    pub shader: &'a SurfaceShader,
    /// In the order of the interactions; not those whose throughput has the albedo.
    pub bsdfs: Bsdfs<'a>,
    /// The rays that have hit the surfaces.
    pub rays: &'a PathRays,
    pub interactions: &'a Interactions,
    /// In the same order, unless the paths are camera paths and the surfaces diffuse.
    pub frames: &'a ShadingFrames,
}

impl Vertices<'_> {
    pub fn kind(&self) -> Kind {
        self.shader.kind
    }

    #[inline(always)]
    pub fn frame(&self, i: usize) -> Frame {
        Frame { x: at(&self.frames.x, i), y: at(&self.frames.y, i), z: at(&self.interactions.ns, i) }
    }

    /// The pdf per projected solid angle of a direction.
    #[inline(always)]
    pub fn projected(&self, i: usize, w: Vec3, pdf: f32) -> f32 {
        projected(self.frames.surface[i].normals(), w, pdf)
    }

    /// See [`is_sound`].
    #[inline(always)]
    pub fn is_sound(&self, i: usize, w: Vec3) -> bool {
        is_sound(self.frames.surface[i].normals(), w)
    }

    /// Whether MIS weights need the pdfs of reverse directions. Only those beside light tracing do, which connects the first vertex to
    /// the camera without sampling, and skips BSDFs that are not reciprocal.
    pub fn needs_reverse_pdf(&self) -> bool {
        self.step.scene.light_tracing.is_some() && self.step.depth > 0 && self.shader.bsdf.is_reciprocal()
    }
}
