//! What passes from stage to stage: rays, interactions, shadow rays, and the radiance that was found.

use crate::film::{PathClass, PathClasses};
use crate::geometry::Surface;
use crate::lanes::{LANES, Lane3, Ray, ZERO3, at, lanes, plain_items};
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

/// The radiance that the camera samples have found so far, by slot.
pub struct Radiance {
    pub sum: Lane3,
    /// The same by path class, the classes of a slot side by side; empty without path classes.
    pub layers: Vec<Rgb>,
    pub work: Work,
    classes: Option<PathClasses>,
}

/// What was done for camera samples.
#[derive(Debug, Clone, Copy, Default)]
pub struct Work {
    pub rays: usize,
    /// Light samples for which a light or a place in the map was chosen.
    pub choices: usize,
}

impl Radiance {
    pub fn new(classes: Option<PathClasses>) -> Self {
        let layers = vec![Rgb::ZERO; LANES * classes.map_or(0, PathClasses::count)];
        Self { sum: ZERO3, layers, work: Work::default(), classes }
    }

    /// Sets the first `count` slots to black.
    pub fn clear(&mut self, count: usize) {
        self.work = Work::default();
        for channel in &mut self.sum {
            channel[..count].fill(0.0);
        }
        self.layers[..count * self.classes.map_or(0, PathClasses::count)].fill(Rgb::ZERO);
    }

    /// Adds light that a path of this class has found.
    #[inline(always)]
    pub fn add(&mut self, slot: u32, path_class: PathClass, value: Rgb) {
        let slot = slot as usize % LANES;
        self.sum[0][slot] += value.x;
        self.sum[1][slot] += value.y;
        self.sum[2][slot] += value.z;
        if let Some(classes) = self.classes {
            self.layers[slot * classes.count() + classes.index(path_class)] += value;
        }
    }

    pub fn by_class(&self, slot: usize) -> &[Rgb] {
        let classes = self.layers.len() / LANES;
        &self.layers[slot * classes..][..classes]
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
