//! The state of many paths side by side, component by component, and what every stage reads while all of them scatter once.

use crate::departure::Departure;
use crate::film::{PathClass, PathClasses};
use crate::geometry::Surface;
use crate::lanes::{LANES, Lane, Lane3, Rays, ZERO3, set};
use crate::prepared::PreparedScene;
use crate::sample_lanes::SampleLanes;
use etalon_core::bsdf::{Bsdf, Scatter};
use etalon_core::math::{Frame, Rgb};
use glam::{Vec2, Vec3};

/// Camera paths in flight.
pub struct Paths {
    pub count: usize,
    pub rays: Rays,
    /// Product of BSDF times cosine over pdf so far.
    pub throughput: Lane3,
    /// Product of η² of the refractions so far, by which radiance is lower than outside of the medium.
    pub eta_scale: Lane,
    /// How they left their last vertices.
    pub departure: [Departure; LANES],
    /// The camera sample of each.
    pub slot: [u32; LANES],
    pub path_class: [PathClass; LANES],
}

/// Points on diffuse surfaces, with the throughput of their paths.
pub struct Points {
    pub count: usize,
    /// Offset from the surface to the side of the viewer, against self-intersection.
    pub position: Lane3,
    /// Unit normal for shading, on the side of the viewer.
    pub normal: Lane3,
    /// Unit normal of the surface, on the side of the viewer.
    pub geometric: Lane3,
    /// Throughput of the path times the surface's albedo.
    pub weight: Lane3,
    pub eta_scale: Lane,
    /// `Departure::light_tracing` of the paths, with the factor of the direction to the viewer.
    pub light_tracing: Lane,
    pub slot: [u32; LANES],
    pub path_class: [PathClass; LANES],
}

/// A point on a surface with any other BSDF that is not a delta distribution.
#[derive(Clone, Copy)]
pub struct Vertex {
    pub surface: Surface,
    pub frame: Frame,
    /// Direction to the viewer, in the shading frame.
    pub wo: Vec3,
    /// Texture coordinates, if the material has textures.
    pub uv: Vec2,
    pub throughput: Rgb,
    pub eta_scale: f32,
    /// [`Departure::light_tracing`] of the path up to here.
    pub light_tracing: f32,
    pub slot: u32,
    pub path_class: PathClass,
    pub object: u32,
}

/// Rays towards light samples, and the radiance that each adds to its sample if it is not occluded.
pub struct Shadows {
    pub count: usize,
    pub rays: Rays,
    /// Distance of the light.
    pub limit: Lane,
    /// Radiance times throughput.
    pub value: Lane3,
    pub slot: [u32; LANES],
    pub path_class: [PathClass; LANES],
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

impl Default for Paths {
    fn default() -> Self {
        Self {
            count: 0,
            rays: Rays::default(),
            throughput: ZERO3,
            eta_scale: [1.0; LANES],
            departure: [Departure::CAMERA; LANES],
            slot: [0; LANES],
            path_class: [PathClass::DIRECT; LANES],
        }
    }
}

impl Default for Points {
    fn default() -> Self {
        Self {
            count: 0,
            position: ZERO3,
            normal: ZERO3,
            geometric: ZERO3,
            weight: ZERO3,
            eta_scale: [1.0; LANES],
            light_tracing: [0.0; LANES],
            slot: [0; LANES],
            path_class: [PathClass::DIRECT; LANES],
        }
    }
}

impl Default for Shadows {
    fn default() -> Self {
        Self {
            count: 0,
            rays: Rays::default(),
            limit: [0.0; LANES],
            value: ZERO3,
            slot: [0; LANES],
            path_class: [PathClass::DIRECT; LANES],
        }
    }
}

impl Paths {
    #[inline(always)]
    pub fn push(
        &mut self,
        [origin, direction]: [Vec3; 2],
        throughput: Rgb,
        eta_scale: f32,
        departure: Departure,
        slot: u32,
        path_class: PathClass,
    ) {
        let i = self.count;
        set(&mut self.rays.origin, i, origin);
        set(&mut self.rays.direction, i, direction);
        set(&mut self.throughput, i, throughput);
        self.eta_scale[i] = eta_scale;
        self.departure[i] = departure;
        self.slot[i] = slot;
        self.path_class[i] = path_class;
        self.count += 1;
    }

    /// Removes the paths for which `keep` is false.
    pub fn retain(&mut self, mut keep: impl FnMut(&mut Self, usize) -> bool) {
        let count = std::mem::take(&mut self.count);
        for i in 0..count {
            if keep(self, i) {
                let j = self.count;
                if i != j {
                    let Self { rays, throughput, eta_scale, .. } = self;
                    let vectors = rays.origin.iter_mut().chain(&mut rays.direction).chain(throughput);
                    vectors.chain([eta_scale]).for_each(|lane| lane[j] = lane[i]);
                    self.departure[j] = self.departure[i];
                    (self.slot[j], self.path_class[j]) = (self.slot[i], self.path_class[i]);
                }
                self.count += 1;
            }
        }
    }
}

impl Shadows {
    #[inline(always)]
    pub fn push(&mut self, [origin, direction]: [Vec3; 2], limit: f32, value: Rgb, slot: u32, path_class: PathClass) {
        let i = self.count;
        set(&mut self.rays.origin, i, origin);
        set(&mut self.rays.direction, i, direction);
        set(&mut self.value, i, value);
        self.limit[i] = limit;
        self.slot[i] = slot;
        self.path_class[i] = path_class;
        self.count += 1;
    }
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

/// What every stage of a step reads.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    /// What is rendered.
    pub scene: &'a PreparedScene<'a>,
    /// Random numbers by slot.
    pub numbers: &'a SampleLanes,
    /// Scatterings before this one.
    pub scatterings: u32,
}

impl Step<'_> {
    /// Whether MIS weights need the pdfs of reverse directions: for light tracing, which reaches the first vertex otherwise and
    /// does not scatter at a BSDF that is not reciprocal.
    pub fn needs_reverse_pdf(&self, bsdf: &Bsdf) -> bool {
        self.scene.light_tracing.is_some() && self.scatterings > 0 && bsdf.is_reciprocal()
    }
}
