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
    pub numbers: SampleLanes,
    /// The pixel column of each slot, and which sample of the pixel.
    pub pixel: [u32; LANES],
    pub sample: [u32; LANES],
    /// Paths from the lamps that are still to be followed: pixel and number.
    pub waiting: Vec<(u64, u32)>,
    /// The light found so far, by slot.
    pub radiance: Lane3,
    /// The same by path class, all classes of a slot side by side; empty if they are not kept apart.
    pub layers: Vec<Rgb>,
    classes: Option<PathClasses>,
    pub(super) paths: Box<Paths>,
    pub(super) next: Box<Paths>,
    pub(super) hits: Hits,
    /// What rays in search of light have hit.
    pub(super) found: Hits,
    pub(super) points: Points,
    pub(super) delta: Vec<u32>,
    /// Hits of paths from the lamps on diffuse surfaces.
    pub(super) arrived: Vec<u32>,
    pub(super) rough: Vec<RoughHit>,
    pub(super) shadows: Shadows,
    pub(super) scattered: Scattered,
    pub(super) blocked: [u32; LANES],
    pub(super) u: [Lane; 2],
    pub(super) cones: Vec<Cone>,
    /// Power with which the path from a lamp started, by slot.
    pub(super) power: Lane3,
    /// Light that paths from the lamps brought to pixels.
    pub splats: Vec<Splat>,
}

/// A hit on a rough surface, in its own frame.
#[derive(Clone, Copy)]
pub struct RoughHit {
    pub surface: Surface,
    pub frame: Frame,
    pub wo: Vec3,
    pub throughput: Rgb,
    pub slot: u32,
    pub path_class: PathClass,
    pub object: u32,
    /// Whether paths from the lamps bring their light to here, apart from directions where the normals disagree.
    pub caustic: bool,
}

impl RoughHit {
    /// Whether paths from the lamps bring all their light to here.
    pub fn lit(&self) -> bool {
        self.caustic && self.surface.is_flat()
    }
}

impl Workspace {
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

    /// Sorts the rough hits by object, and those to which paths from the lamps bring all their light from the others.
    pub(super) fn rough_groups(&mut self) -> Vec<Range<usize>> {
        let key = |hit: &RoughHit| (hit.object, hit.lit());
        self.rough.sort_by_key(key);
        let sizes = self.rough.chunk_by(|a, b| key(a) == key(b)).map(<[RoughHit]>::len);
        let ends = sizes.scan(0, |end, size| {
            *end += size;
            Some(*end - size..*end)
        });
        ends.collect()
    }

    /// Light that a path of `path_class` has found.
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

/// Pairs of random numbers that each scattering draws from, after the one for the film position.
#[derive(Clone, Copy)]
pub struct Dimensions {
    pub(super) first: u32,
}

impl Dimensions {
    pub(super) const OTHERS: u32 = 4;

    /// Of paths from the lamps, where they start and after so many scatterings: far from those of camera paths.
    pub(super) fn of_light_paths(scatterings: u32) -> Self {
        Self { first: (1 << 31) + scatterings * Self::OTHERS }
    }

    /// Where the path goes on.
    pub fn bsdf(self) -> u32 {
        self.first
    }

    /// Which of its lobes the material chooses, and Russian roulette.
    pub fn choice(self) -> u32 {
        self.first + 1
    }

    /// Where light is looked for without regard to where it is.
    pub fn bsdf_direct(self) -> u32 {
        self.first + 2
    }

    pub fn environment(self) -> u32 {
        self.first + 3
    }

    pub fn light(self, number: usize) -> u32 {
        self.first + Self::OTHERS + number as u32
    }
}
