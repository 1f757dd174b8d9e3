//! What passes from stage to stage: rays, interactions, and shadow rays.

use crate::film::PathClass;
use crate::geometry::Surface;
use crate::lanes::{Ray, at, lanes, plain_items};
use crate::light_tracing::projected;
use crate::prepared::PreparedScene;
use crate::previous::PreviousVertex;
use crate::ray_samples::RaySamples;
use crate::shaders::is_sound;
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::math::{Frame, Rgb};
use glam::{Vec2, Vec3};

plain_items! { PathClass = PathClass::DIRECT, Surface = Surface::NONE }

lanes! {
    /// Camera paths in flight: the ray of each, and what it carries.
    pub struct PathRays of PathRay {
        ray: Ray,
        /// Product of BSDF times cosine over pdf so far.
        beta: Rgb,
        /// Product of η² of the refractions so far: `beta` times it is the throughput without the scale 1/η² of radiance in a medium.
        eta_scale: f32,
        /// The vertex that the ray has left.
        previous: PreviousVertex,
        /// The camera sample.
        slot: u32,
        path_class: PathClass,
    }
}

lanes! {
    /// Points where rays have hit surfaces of one material.
    pub struct Interactions of Interaction {
        /// The index of the ray that has hit it.
        ray: u32,
        /// The camera sample, or the slot of a light path.
        slot: u32,
        /// Unit normal of the surface.
        n: Vec3,
        /// Unit normal for shading, on the side of the ray's origin except at surfaces that transmit.
        ns: Vec3,
        /// Where rays to the side of the ray's origin start; in light paths the point itself.
        origin: Vec3,
        /// Throughput of the path; at diffuse surfaces times the albedo.
        beta: Rgb,
        /// The class of the path if it is scattered here, not by a delta lobe.
        path_class: PathClass,
        /// [`PreviousVertex::q`] of the path up to here; at diffuse surfaces with the factor of the direction to the viewer.
        q: f32,
    }
}

lanes! {
    /// What surfaces that are not diffuse need besides.
    pub struct ShadingFrames of ShadingFrame {
        surface: Surface,
        /// Tangents of the shading frame, whose z axis is the normal for shading.
        x: Vec3,
        y: Vec3,
        /// Direction to the viewer.
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

/// Vertices of paths at surfaces of one material.
#[derive(Default)]
pub struct Vertices {
    pub interactions: Interactions,
    /// In the same order, unless the surfaces are diffuse.
    pub frames: ShadingFrames,
}

impl Vertices {
    #[inline(always)]
    pub fn surface(&self, i: usize) -> &Surface {
        &self.frames.surface[i]
    }

    /// The shading frame.
    #[inline(always)]
    pub fn frame(&self, i: usize) -> Frame {
        Frame { x: at(&self.frames.x, i), y: at(&self.frames.y, i), z: at(&self.interactions.ns, i) }
    }

    #[inline(always)]
    fn normals(&self, i: usize) -> [Vec3; 2] {
        [self.surface(i).normal, self.surface(i).shading]
    }

    /// The pdf per projected solid angle of a direction.
    #[inline(always)]
    pub fn projected(&self, i: usize, w: Vec3, pdf: f32) -> f32 {
        projected(self.normals(i), w, pdf)
    }

    /// See [`is_sound`].
    #[inline(always)]
    pub fn is_sound(&self, i: usize, w: Vec3) -> bool {
        is_sound(self.normals(i), w)
    }
}

/// What every stage of a depth reads.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    pub scene: &'a PreparedScene<'a>,
    pub samples: RaySamples<'a>,
    /// Scatterings before this one.
    pub depth: u32,
}

impl Step<'_> {
    /// Whether MIS weights need the pdfs of reverse directions: for light tracing, which reaches the first vertex otherwise and
    /// does not scatter at a BSDF that is not reciprocal.
    pub fn needs_reverse_pdf(&self, bsdf: &Bsdf) -> bool {
        self.scene.light_tracing.is_some() && self.depth > 0 && bsdf.is_reciprocal()
    }
}
