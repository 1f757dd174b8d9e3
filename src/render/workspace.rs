//! What one thread works with while it follows paths: their lanes, what they have hit, and the light found so far.

use super::caustic_cones::Cone;
use super::film::{PathClass, PathClasses, Splat};
use super::geometry::Surface;
use super::lanes::{Hits, LANES, Lane, Lane3, Paths, Points, Shadows};
use super::rough::Scattered;
use super::sample_lanes::SampleLanes;
use super::settings::Settings;
use crate::math::{Frame, Rgb};
use glam::Vec3;
use std::ops::Range;

/// What one thread works with.
pub struct Workspace {
    /// The random numbers of the camera samples in flight.
    pub numbers: SampleLanes,
    /// The pixel column of each slot.
    pub pixel: [u32; LANES],
    /// The number of each slot's sample in its pixel.
    pub sample: [u32; LANES],
    /// Light paths still to be traced: pixel and number.
    pub waiting: Vec<(u64, u32)>,
    /// The radiance found so far, by slot.
    pub radiance: Lane3,
    /// The same by path class, the classes of a slot side by side; empty without path classes.
    pub layers: Vec<Rgb>,
    classes: Option<PathClasses>,
    /// Paths of the current step.
    pub(super) paths: Box<Paths>,
    /// Paths of the next step.
    pub(super) next: Box<Paths>,
    /// Hits of the current rays.
    pub(super) hits: Hits,
    /// Hits of the rays of [`Workspace::shadows`] where emitters are looked for.
    pub(super) found: Hits,
    /// Diffuse hits.
    pub(super) points: Points,
    /// Indices of paths that hit mirrors or glass.
    pub(super) delta: Vec<u32>,
    /// Hits of light paths on diffuse surfaces.
    pub(super) arrived: Vec<u32>,
    /// Hits on rough metal.
    pub(super) rough: Vec<RoughHit>,
    /// Shadow rays.
    pub(super) shadows: Shadows,
    /// Samples and values of rough BSDFs.
    pub(super) scattered: Scattered,
    /// Nonzero for occluded shadow rays.
    pub(super) blocked: [u32; LANES],
    /// Random numbers of the current dimension.
    pub(super) u: [Lane; 2],
    /// Caustic cones.
    pub(super) cones: Vec<Cone>,
    /// Power with which a light path started, by slot.
    pub(super) power: Lane3,
    /// Contributions of light paths to pixels.
    pub splats: Vec<Splat>,
}

/// A hit on a rough surface.
#[derive(Clone, Copy)]
pub struct RoughHit {
    /// Position and normals.
    pub surface: Surface,
    /// The shading frame.
    pub frame: Frame,
    /// Direction to the viewer, in the shading frame.
    pub wo: Vec3,
    /// Of the path up to here.
    pub throughput: Rgb,
    /// The camera sample of the path.
    pub slot: u32,
    /// Scatterings so far.
    pub path_class: PathClass,
    /// Number of the object.
    pub object: u32,
    /// Whether light tracing contributes the light here, except in directions where the normals disagree.
    pub caustic: bool,
}

impl RoughHit {
    /// Whether light tracing contributes the light here in all directions.
    pub fn is_light_traced(&self) -> bool {
        self.caustic && self.surface.is_flat()
    }
}

impl Workspace {
    /// Empty buffers.
    pub(super) fn new(settings: &Settings, cones: Vec<Cone>) -> Self {
        let classes = settings.paths.map(PathClasses::up_to);
        Self {
            numbers: SampleLanes::new(settings.stream, settings.seed),
            pixel: [0; LANES],
            sample: [0; LANES],
            waiting: Vec::new(),
            radiance: [[0.0; LANES]; 3],
            layers: vec![Rgb::ZERO; LANES * classes.map_or(0, PathClasses::count)],
            classes,
            paths: Box::default(),
            next: Box::default(),
            hits: Hits::default(),
            found: Hits::default(),
            points: Points::default(),
            delta: Vec::with_capacity(LANES),
            arrived: Vec::with_capacity(LANES),
            rough: Vec::with_capacity(LANES),
            shadows: Shadows::default(),
            scattered: Scattered::default(),
            blocked: [0; LANES],
            u: [[0.0; LANES]; 2],
            cones,
            power: [[0.0; LANES]; 3],
            splats: Vec::new(),
        }
    }

    /// Sorts the rough hits by object and by [`RoughHit::is_light_traced`], and returns the range of each group.
    pub(super) fn rough_groups(&mut self) -> Vec<Range<usize>> {
        let key = |hit: &RoughHit| (hit.object, hit.is_light_traced());
        self.rough.sort_by_key(key);
        let sizes = self.rough.chunk_by(|a, b| key(a) == key(b)).map(<[RoughHit]>::len);
        let ends = sizes.scan(0, |end, size| {
            *end += size;
            Some(*end - size..*end)
        });
        ends.collect()
    }

    /// Adds radiance found by a path of `path_class` has found.
    #[inline(always)]
    pub(super) fn add(&mut self, slot: u32, path_class: PathClass, value: Rgb) {
        let slot = slot as usize % LANES;
        self.radiance[0][slot] += value.x;
        self.radiance[1][slot] += value.y;
        self.radiance[2][slot] += value.z;
        if let Some(classes) = self.classes {
            self.layers[slot * classes.count() + classes.index(path_class)] += value;
        }
    }
}

/// Dimensions (pairs of random numbers) of each scattering; dimension 0 is the position on the film.
#[derive(Clone, Copy)]
pub struct Dimensions {
    /// Its first dimension.
    pub(super) first: u32,
}

impl Dimensions {
    /// Dimensions of a scattering besides one per light.
    pub(super) const OTHERS: u32 = 4;

    /// The dimensions of light paths after so many scatterings, 0 for their start: far from those of camera paths.
    pub(super) fn of_light_paths(scatterings: u32) -> Self {
        Self { first: (1 << 31) + scatterings * Self::OTHERS }
    }

    /// The direction in which the path continues.
    pub fn bsdf(self) -> u32 {
        self.first
    }

    /// The choice of a lobe, and Russian roulette.
    pub fn choice(self) -> u32 {
        self.first + 1
    }

    /// BSDF or hemisphere samples of direct light.
    pub fn bsdf_direct(self) -> u32 {
        self.first + 2
    }

    /// Light samples of the environment.
    pub fn environment(self) -> u32 {
        self.first + 3
    }

    /// Samples of a light.
    pub fn light(self, number: usize) -> u32 {
        self.first + Self::OTHERS + number as u32
    }
}
