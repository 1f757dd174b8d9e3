//! A row of the film while samples are added to it: light that is not finite or negative is dropped, counted and located.

use super::fixed::{FixedRgb, LIMIT, UNIT};
use super::pixel::{Dropped, Pixel};
use super::splats::{OfPath, Splat, Splats};
use etalon_core::math::Rgb;
use std::sync::{Mutex, PoisonError};

/// A row of the film, to add samples to.
#[derive(Debug)]
pub struct Row<'a> {
    y: usize,
    pixels: &'a mut [Pixel],
    classes: usize,
    paths: &'a mut [FixedRgb],
    pub(super) dropped: Dropped,
    /// Contributions that are not on the film yet, and the sums that they are for.
    splats: Vec<OfPath>,
    film: Option<&'a Mutex<&'a mut Splats>>,
}

/// As many contributions are added to the film at a time.
const SPLATS: usize = 1 << 14;

impl<'a> Row<'a> {
    /// A row of `pixels`, with as many sums for each as there are path classes.
    pub fn new(y: usize, pixels: &'a mut [Pixel], paths: &'a mut [FixedRgb]) -> Self {
        let (classes, splats) = (paths.len() / pixels.len(), Vec::new());
        Self { y, classes, pixels, paths, dropped: Dropped::default(), splats, film: None }
    }

    /// The same row, whose contributions to any pixel go to these sums.
    pub(super) fn with_splats(self, film: Option<&'a Mutex<&'a mut Splats>>) -> Self {
        Self { film, ..self }
    }

    /// Adds the contributions to the film. The sums do not round: the order of the rows does not matter.
    pub(super) fn flush(&mut self) {
        if let Some(film) = self.film {
            film.lock().unwrap_or_else(PoisonError::into_inner).add(&self.splats, self.pixels.len());
        }
        self.splats.clear();
    }

    /// The row's number, from the top.
    pub fn y(&self) -> usize {
        self.y
    }

    /// How many samples the pixel in column `x` has had, dropped ones included.
    #[inline]
    pub fn samples(&self, x: usize) -> u32 {
        self.pixels[x].n
    }

    /// Adds a sample to the pixel in column `x`; `by_class` is the same light by path class, in the order of the classes
    /// (empty if there are none).
    ///
    /// Light that is not finite, from 2^63 on or negative counts as black: leaving it out of the mean would make the
    /// image depend on where it occurs. The image does not depend on `by_class`.
    #[inline]
    pub fn add(&mut self, x: usize, value: Rgb, by_class: &[Rgb]) {
        self.add_paths(x, [(value, by_class)]);
    }

    /// [`Row::add`] for a sample of several paths, which weigh as much as other paths of the pixel.
    #[inline]
    pub fn add_paths<'b>(&mut self, x: usize, paths: impl IntoIterator<Item = (Rgb, &'b [Rgb])>) {
        let pixel = &mut self.pixels[x];
        pixel.n += 1;
        for (value, by_class) in paths {
            if !is_light(value) {
                pixel.add_black();
                self.dropped = self.dropped.merge(Dropped::one(value, (x, self.y)));
                continue;
            }
            pixel.add(value);
            if is_faint(value) {
                self.dropped = self.dropped.merge(Dropped::FAINT);
            }
            let sums = &mut self.paths[x * self.classes..][..self.classes];
            for (sum, &light) in sums.iter_mut().zip(by_class) {
                if light != Rgb::ZERO && is_light(light) {
                    *sum += FixedRgb::of(light);
                }
            }
        }
    }

    /// Adds all contributions of light paths that were traced with samples of this row, to pixels of any row; impossible ones
    /// count as black.
    pub fn splat(&mut self, splats: &[Splat]) {
        let mut of_path = vec![Rgb::ZERO; splats.iter().map(|splat| splat.path + 1).max().unwrap_or(0)];
        for splat in splats {
            if !is_light(splat.value) {
                let [x, y] = splat.pixel.map(|at| at as usize);
                self.dropped = self.dropped.merge(Dropped::one(splat.value, (x, y)));
                continue;
            }
            if is_faint(splat.value) {
                self.dropped = self.dropped.merge(Dropped::FAINT);
            }
            of_path[splat.path] += splat.value;
        }
        let possible = splats.iter().filter(|splat| is_light(splat.value));
        self.splats.extend(possible.map(|&splat| (splat, of_path[splat.path])));
        if self.splats.len() >= SPLATS {
            self.flush();
        }
    }
}

/// Whether all components lie in [0, [`LIMIT`]); false for what is not a number.
#[inline]
fn is_light(value: Rgb) -> bool {
    value.to_array().into_iter().all(|v| (0.0..LIMIT).contains(&v))
}

/// Whether there is light, but none that the film has a digit for.
#[inline]
fn is_faint(value: Rgb) -> bool {
    let largest = value.max_element();
    largest < UNIT && largest > 0.0
}
