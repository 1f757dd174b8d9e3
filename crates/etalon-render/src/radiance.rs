//! What camera samples have found while they are traced, before the film has it.

use super::film::{PathClass, PathClasses};
use super::lanes::{LANES, Lane3, ZERO3};
use etalon_core::math::Rgb;

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
