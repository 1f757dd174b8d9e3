//! The film itself: accumulates samples row by row, is turned into images, is merged.

use super::classes::PathClasses;
use super::fixed::{FixedRgb, UNIT};
use super::pixel::{Dropped, Pixel};
use super::row::Row;
use super::splats::Splats;
use etalon_core::error::{Error, Result};
use etalon_core::math::Rgb;
use etalon_core::memory;
use etalon_core::raster::Image;
use rayon::prelude::*;
use std::sync::Mutex;

/// All samples of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    width: usize,
    height: usize,
    /// Row by row from the top.
    pub(super) pixels: Vec<Pixel>,
    pub(super) dropped: Dropped,
    pub(super) paths: Option<Paths>,
    pub(super) splats: Option<Splats>,
}

/// The light of each pixel by the class of its path: for each pixel a sum for each class.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Paths {
    pub classes: PathClasses,
    /// All classes of a pixel side by side.
    pub sums: Vec<FixedRgb>,
}

/// The estimate of a pixel: its mean, and the standard error of the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelEstimate {
    pub mean: Rgb,
    /// Standard error of the mean.
    pub error: Rgb,
}

/// A film of more pixels than this could not be read back from a file.
const MAX_PIXELS: usize = 1 << 28;

impl Film {
    /// Memory that a film takes for each pixel, without path classes.
    pub const BYTES: usize = size_of::<Pixel>();
    /// Memory of one path class of a pixel.
    pub const BYTES_PER_CLASS: usize = size_of::<FixedRgb>();

    /// A film without samples; with `classes`, it also keeps sums by path class.
    ///
    /// # Errors
    /// [`Error::Parameter`] for no pixel and for more than 2^28, [`Error::Memory`] when they do not fit.
    pub fn new(width: usize, height: usize, classes: Option<PathClasses>) -> Result<Self> {
        Self::check(width, height)?;
        let sums = (width * height).saturating_mul(classes.map_or(0, PathClasses::count));
        let what = || {
            let layers = classes.map_or(String::new(), |c| format!(" in {} path classes", c.count()));
            format!("a film of {width}x{height} pixels{layers}")
        };
        let paths = match classes {
            Some(classes) => Some(Paths { classes, sums: memory::filled(sums, Default::default(), what)? }),
            None => None,
        };
        let pixels = memory::filled(width * height, Pixel::default(), what)?;
        Ok(Self { width, height, pixels, dropped: Dropped::default(), paths, splats: None })
    }

    /// Refuses sizes of which there is no film.
    pub fn check(width: usize, height: usize) -> Result<()> {
        let wrong = || Error::parameter("width", format!("no film for {width}x{height} pixels"));
        let is_possible = (1..=MAX_PIXELS).contains(&width.saturating_mul(height));
        is_possible.then_some(()).ok_or_else(|| wrong().with_hint("at least 1x1 and at most 2^28 pixels"))
    }

    /// The same film with sums for [`Row::splat`]: any row may splat to any
    /// other.
    ///
    /// # Errors
    /// [`Error::Memory`] when it does not fit.
    pub fn with_splats(self) -> Result<Self> {
        let splats = Splats::new([self.width, self.height], self.classes().map_or(0, PathClasses::count))?;
        Ok(Self { splats: Some(splats), ..self })
    }

    pub fn width(&self) -> usize {
        self.width
    }

    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// The path classes that have sums of their own.
    pub fn classes(&self) -> Option<PathClasses> {
        self.paths.as_ref().map(|p| p.classes)
    }

    /// Calls `fill` for every row, in parallel, to add samples. Which thread adds what, in which order, and in how many
    /// calls does not matter.
    pub fn accumulate(&mut self, fill: impl Fn(&mut Row<'_>) + Sync) {
        let classes = self.classes().map_or(0, PathClasses::count);
        let mut sums = self.paths.as_mut().map_or(&mut [][..], |p| &mut p.sums);
        let splats = self.splats.as_mut().map(Mutex::new);
        let mut rows = Vec::with_capacity(self.height);
        for (y, pixels) in self.pixels.chunks_exact_mut(self.width).enumerate() {
            let (paths, rest) = std::mem::take(&mut sums).split_at_mut(self.width * classes);
            sums = rest;
            rows.push(Row::new(y, pixels, paths).with_splats(splats.as_ref()));
        }
        let dropped = rows.into_par_iter().with_max_len(1).map(|mut row| {
            fill(&mut row);
            row.flush();
            row.dropped
        });
        self.dropped = self.dropped.merge(dropped.reduce(Dropped::default, Dropped::merge));
    }

    /// The mean of the samples of every pixel, and the light splatted to it; black without samples.
    pub fn image(&self) -> Image {
        self.image_of(|estimate| estimate.mean)
    }

    /// The standard error of every pixel and channel, see [`Pixel::standard_error`].
    pub fn standard_error(&self) -> Image {
        self.image_of(|estimate| estimate.error)
    }

    fn image_of(&self, value: impl Fn(PixelEstimate) -> Rgb + Sync + Send) -> Image {
        let paths = self.paths_per_pixel();
        let values = (0..self.pixels.len()).into_par_iter().map(|i| value(self.estimate(i, paths)));
        Image::from_pixels(self.width, self.height, values.collect())
    }

    /// The mean and its standard error of every pixel, row by row from the top.
    pub fn estimates(&self) -> impl Iterator<Item = PixelEstimate> {
        let paths = self.paths_per_pixel();
        (0..self.pixels.len()).map(move |i| self.estimate(i, paths))
    }

    /// How many light paths there were for each pixel: as many as samples, on average over all pixels.
    pub(super) fn paths_per_pixel(&self) -> f64 {
        let samples: u64 = self.pixels.iter().map(|pixel| u64::from(pixel.n)).sum();
        samples as f64 / self.pixels.len() as f64
    }

    fn estimate(&self, i: usize, paths: f64) -> PixelEstimate {
        let pixel = &self.pixels[i];
        let (mean, error) = (pixel.mean(), pixel.standard_error());
        let Some(splats) = self.splats.as_ref().filter(|_| paths > 0.0) else { return PixelEstimate { mean, error } };
        let received = &splats.pixels[i];
        let variance = received.variance(paths, self.pixels.len() as f64);
        let error = std::array::from_fn(|c| f64::from(error[c]).powi(2) + variance[c]);
        PixelEstimate { mean: mean + received.sum.mean(paths), error: Rgb::from_array(error.map(|v| v.sqrt() as f32)) }
    }

    /// An upper bound of the share of the light that rounding to the film's unit has taken: 2^-64 of each camera path and channel,
    /// and of light that is too faint for it. 0 where all is black.
    pub fn lost_to_rounding(&self) -> f64 {
        let paths: f64 = self.pixels.iter().map(|pixel| f64::from(pixel.camera_paths)).sum();
        let received = self.splats.iter().flat_map(|splats| &splats.pixels).map(|pixel| pixel.sum);
        let light: f64 = self.pixels.iter().map(|pixel| pixel.sum).chain(received).map(FixedRgb::total).sum();
        let lost = 3.0 * paths * f64::from(UNIT);
        match () {
            _ if light > 0.0 => (lost / light).min(1.0),
            _ if self.dropped.faint > 0 => 1.0,
            _ => 0.0,
        }
    }

    /// Adds the samples of `other`; the result is the same as if one film had accumulated them all.
    ///
    /// # Errors
    /// [`Error::Parameter`] when the sizes or the path classes differ.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        let shape = |film: &Self| (film.width, film.height, film.classes());
        if shape(self) != shape(other) {
            return Err(Error::parameter("films", "their sizes or their path classes differ"));
        }
        match (&mut self.splats, &other.splats) {
            (Some(mine), Some(theirs)) => mine.merge(theirs),
            (mine @ None, Some(theirs)) => *mine = Some(theirs.clone()),
            (_, None) => {}
        }
        self.pixels.par_iter_mut().zip(&other.pixels).for_each(|(mine, theirs)| mine.merge(theirs));
        if let (Some(mine), Some(theirs)) = (&mut self.paths, &other.paths) {
            mine.sums.par_iter_mut().zip(&theirs.sums).for_each(|(mine, theirs)| *mine += *theirs);
        }
        self.dropped = self.dropped.merge(other.dropped);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Splat;
    use crate::tests::on_threads;
    use etalon_core::sampling::stream::{Independent, Stream};

    const SIZE: (usize, usize) = (7, 5);
    const SPP: u32 = 40;

    /// Sample `s` of a pixel, by path class: over a wide range, sometimes impossible.
    fn light(x: usize, y: usize, s: u32) -> [Rgb; 4] {
        std::array::from_fn(|class| {
            let [u, v] = Independent::new(5, (10 * y + x) as u64, s).pair(class as u32);
            match (x, y, s) {
                (3, 2, 9) => Rgb::NAN,
                (1, 4, 0 | 31) => -Rgb::ONE,
                _ => Rgb::new(u as f32, (v * 1e-9) as f32, (40.0 * u - 20.0).exp() as f32),
            }
        })
    }

    /// A film with the samples for which `here` says so, each of which brings light to some other pixel, too.
    fn film(here: impl Fn(usize, usize, u32) -> bool + Sync) -> Film {
        let mut film = without_splats().with_splats().unwrap();
        accumulate(&mut film, here);
        film
    }

    fn without_splats() -> Film {
        Film::new(SIZE.0, SIZE.1, Some(PathClasses::up_to(1))).unwrap()
    }

    fn accumulate(film: &mut Film, here: impl Fn(usize, usize, u32) -> bool + Sync) {
        film.accumulate(|row| {
            for (x, s) in (0..SIZE.0).flat_map(|x| (0..SPP).map(move |s| (x, s))) {
                if here(x, row.y(), s) {
                    let paths = light(x, row.y(), s);
                    row.add(x, paths.iter().sum(), &paths);
                    let pixel = [(3 * x as u32 + s) % SIZE.0 as u32, (row.y() as u32 + s) % SIZE.1 as u32];
                    row.splat(&[Splat { path: 0, pixel, class: s as usize % 4, value: paths[0], spared: 0.0 }]);
                }
            }
        });
    }

    #[test]
    fn any_split_and_any_order_give_the_same_bits() {
        let whole = film(|_, _, _| true);
        assert_eq!(whole.dropped(), Dropped { nonfinite: 2, negative: 4, faint: 0, first_pixel: Some((6, 0)) });
        for round in 0..20 {
            let count = 2 + round % 5;
            let random = |pixel: usize, s: u32| Independent::new(u64::from(round), pixel as u64, s).pair(9)[0];
            let of = |x: usize, y: usize, s: u32| (random(10 * y + x, s) * f64::from(count)) as u32;
            let mut parts: Vec<Film> = (0..count).map(|part| film(|x, y, s| of(x, y, s) == part)).collect();
            // Pairs at random, until one is left.
            for step in 0.. {
                let mut take = |dimension| {
                    let place = Independent::new(7, round.into(), step).pair(dimension)[0];
                    parts.swap_remove((place * parts.len() as f64) as usize)
                };
                let (mut a, b) = (take(0), take(1));
                a.merge(&b).unwrap();
                if parts.is_empty() {
                    assert!(a == whole, "round {round}");
                    break;
                }
                parts.push(a);
            }
        }
    }

    /// A million samples in two films, which are merged as parts of a render are.
    #[test]
    fn sums_are_exact_and_means_are_rounded_once() {
        const PAIRS: u32 = 500_000;
        /// The samples of a channel: these two, alternating.
        const CHANNELS: [[f32; 2]; 3] = [[0.1, 0.1], [1e6, 1e-6], [1.0, 3e-8]];
        let samples = [0, 1].map(|i| Rgb::from_array(CHANNELS.map(|values| values[i])));
        let half = || {
            let mut film = Film::new(1, 1, None).unwrap();
            film.accumulate(|row| {
                for _ in 0..PAIRS / 2 {
                    samples.iter().for_each(|&sample| row.add(0, sample, &[]));
                }
            });
            film
        };
        let mut film = half();
        film.merge(&half()).unwrap();
        let exact = CHANNELS.map(|[a, b]| (0.5 * (f64::from(a) + f64::from(b))) as f32);
        assert_eq!(film.image().get(0, 0).to_array(), exact);
        // A running sum in f32 loses digits
        let plain = |[a, b]: [f32; 2]| (0..PAIRS).fold(0.0, |sum, _| sum + a + b) / (2 * PAIRS) as f32;
        assert!((plain(CHANNELS[0]) / exact[0] - 1.0).abs() > 1e-3);
    }

    #[test]
    fn threads_change_no_bit() {
        let on = |threads| on_threads(threads, || film(|_, _, _| true));
        assert!(on(1) == on(3));
    }

    #[test]
    fn impossible_samples_are_black_counted_and_located() {
        let mut film = Film::new(3, 2, None).unwrap();
        film.accumulate(|row| {
            for (x, s) in (0..3).rev().flat_map(|x| (0..4).map(move |s| (x, s))) {
                let value = match (x, row.y(), s) {
                    (1, 0, 2) => Rgb::new(f32::NAN, 1.0, 1.0),
                    (2, 0, 0) => Rgb::new(1.0, 1.0, 9.3e18),
                    (2, 0, 1) => Rgb::new(1.0, f32::NEG_INFINITY, 1.0),
                    (0, 1, _) => Rgb::new(1.0, -1e30, 1.0),
                    _ => Rgb::new(1.0, 1.0, 1.0),
                };
                row.add(x, value, &[]);
            }
        });
        assert_eq!(film.dropped(), Dropped { nonfinite: 3, negative: 4, faint: 0, first_pixel: Some((1, 0)) });
        let image = film.image();
        assert_eq!([image.get(0, 0), image.get(1, 0), image.get(0, 1)], [1.0, 0.75, 0.0].map(Rgb::splat));
        assert!(film.pixels().iter().all(|p| p.samples() == 4));
        assert_eq!(film.standard_error().get(0, 1), Rgb::ZERO);
    }

    #[test]
    fn path_layers_leave_the_picture_alone() {
        let [mut with, mut without] = [without_splats(), Film::new(SIZE.0, SIZE.1, None).unwrap()];
        accumulate(&mut with, |_, _, _| true);
        accumulate(&mut without, |_, _, _| true);
        assert_eq!(with.image(), without.image());
        assert!(without.merge(&with).is_err());
    }

    #[test]
    fn light_from_elsewhere_is_in_the_picture_its_error_and_its_layers() {
        // Two pixels of n samples each; light comes to the first one with every other sample of the second.
        let (n, value) = (1000, Rgb::new(0.5, 2.0, 0.0));
        let mut film = Film::new(2, 1, Some(PathClasses::up_to(1))).unwrap().with_splats().unwrap();
        film.accumulate(|row| {
            for s in 0..n {
                row.add(0, Rgb::ONE, &[Rgb::ONE, Rgb::ZERO, Rgb::ZERO, Rgb::ZERO]);
                row.add(1, Rgb::ONE, &[Rgb::ONE, Rgb::ZERO, Rgb::ZERO, Rgb::ZERO]);
                if s % 2 == 0 {
                    row.splat(&[Splat { path: 0, pixel: [0, 0], class: 2, value, spared: 0.0 }]);
                }
            }
        });
        let first = film.estimates().next().unwrap();
        assert_eq!(first.mean, Rgb::ONE + 0.5 * value);
        // A quarter of 2n paths bring the value: variance v² (1/4 − 1/16), and the mean is the sum over n.
        let expected = value.as_dvec3() * (2.0 * f64::from(n) * (0.25 - 0.0625)).sqrt() / f64::from(n);
        assert!((first.error.as_dvec3() - expected).abs().max_element() < 1e-6, "{:?} {expected:?}", first.error);
        assert_eq!(film.estimates().nth(1).unwrap(), PixelEstimate { mean: Rgb::ONE, error: Rgb::ZERO });
        let layers = film.path_layers();
        assert_eq!([layers[0].1.get(0, 0), layers[2].1.get(0, 0)], [Rgb::ONE, 0.5 * value]);
        // A sample that is still to come makes the pixel no darker than the light that came to it so far.
        film.accumulate(|row| row.add(1, Rgb::ONE, &[]));
        let later = film.estimates().next().unwrap().mean;
        assert!((later - first.mean).abs().max_element() < 2e-3 && later != first.mean);
    }

    #[test]
    fn impossible_films_are_refused() {
        for (width, height, classes) in
            [(0, 1, None), (1, 0, None), (1 << 15, 1 << 14, None), (usize::MAX, 2, None), (1 << 14, 1 << 14, Some(6))]
        {
            assert!(Film::new(width, height, classes.map(PathClasses::up_to)).is_err());
        }
        assert!(Film::new(2, 1, None).unwrap().merge(&Film::new(1, 2, None).unwrap()).is_err());
    }
}
