//! The sums of a film as channels of unsigned integers: four words of 32 bits for each number.

use super::accumulate::Film;
use super::classes::PathClasses;
use super::fixed::Fixed;

/// One word of the film's state in every pixel.
#[derive(Debug, Clone, Copy)]
pub enum Slot {
    /// How many samples.
    Count,
    /// How many camera paths.
    CameraPaths,
    /// A word of a channel's sum; word 0 is the lowest.
    Sum(usize, usize),
    /// A word of a channel's sum of squares.
    Square(usize, usize),
    /// A word of a path class's sum in a channel.
    Path(usize, usize, usize),
    /// The same three of the contributions of light paths.
    SplatSum(usize, usize),
    SplatSquare(usize, usize),
    SplatPath(usize, usize, usize),
}

/// All words with the names of their channels: `sums.n`, `sums.cameraPaths`, `sums.R0` … `sums.B3`, `squares.R0` …, `sums.LDE.R0` …; with
/// `splats`, also `splats.sums.R0` and so on.
#[must_use]
pub fn slots(classes: Option<PathClasses>, splats: bool) -> Vec<(String, Slot)> {
    type Kinds = (fn(usize, usize) -> Slot, fn(usize, usize) -> Slot, fn(usize, usize, usize) -> Slot);
    let own: Kinds = (Slot::Sum, Slot::Square, Slot::Path);
    let others: Kinds = (Slot::SplatSum, Slot::SplatSquare, Slot::SplatPath);
    let words = || (0..3).flat_map(|c| (0..4).map(move |k| (c, k, format!("{}{k}", ["R", "G", "B"][c]))));
    let mut slots = vec![("sums.n".to_owned(), Slot::Count), ("sums.cameraPaths".to_owned(), Slot::CameraPaths)];
    for (prefix, (sum, square, path)) in [("", own), ("splats.", others)].into_iter().take(1 + usize::from(splats)) {
        slots.extend(words().map(|(c, k, word)| (format!("{prefix}sums.{word}"), sum(c, k))));
        slots.extend(words().map(|(c, k, word)| (format!("{prefix}squares.{word}"), square(c, k))));
        for (class, name) in classes.into_iter().flat_map(PathClasses::names).enumerate() {
            slots.extend(words().map(|(c, k, word)| (format!("{prefix}sums.{name}.{word}"), path(class, c, k))));
        }
    }
    slots
}

impl Slot {
    /// The word in pixel number `i`.
    #[must_use]
    pub fn get(self, film: &Film, i: usize) -> u32 {
        let of = |number: Option<&Fixed>, k: usize| number.map_or(0, |number| (number.bits() >> (32 * k)) as u32);
        let splats = film.splats.as_ref();
        match self {
            Slot::Count => film.pixels[i].n,
            Slot::CameraPaths => film.pixels[i].camera_paths,
            Slot::Sum(c, k) => of(Some(&film.pixels[i].sum.0[c]), k),
            Slot::Square(c, k) => of(Some(&film.pixels[i].square.0[c]), k),
            Slot::Path(class, c, k) => of(film.paths.as_ref().map(|p| &p.sums[i * p.classes.count() + class].0[c]), k),
            Slot::SplatSum(c, k) => of(splats.map(|s| &s.pixels[i].sum.0[c]), k),
            Slot::SplatSquare(c, k) => of(splats.map(|s| &s.pixels[i].square.0[c]), k),
            Slot::SplatPath(class, c, k) => {
                of(splats.map(|s| &s.classes[i * film.classes().map_or(0, PathClasses::count) + class].0[c]), k)
            }
        }
    }

    /// Puts the word into pixel number `i`, where it must have been 0.
    pub fn set(self, film: &mut Film, i: usize, value: u32) {
        let classes = film.classes().map_or(0, PathClasses::count);
        let put = |number: Option<&mut Fixed>, k: usize| {
            if let Some(number) = number {
                *number += Fixed::from_bits(u128::from(value) << (32 * k));
            }
        };
        let splats = film.splats.as_mut();
        match self {
            Slot::Count => film.pixels[i].n = value,
            Slot::CameraPaths => film.pixels[i].camera_paths = value,
            Slot::Sum(c, k) => put(Some(&mut film.pixels[i].sum.0[c]), k),
            Slot::Square(c, k) => put(Some(&mut film.pixels[i].square.0[c]), k),
            Slot::Path(class, c, k) => {
                put(film.paths.as_mut().map(|p| &mut p.sums[i * classes + class].0[c]), k);
            }
            Slot::SplatSum(c, k) => put(splats.map(|s| &mut s.pixels[i].sum.0[c]), k),
            Slot::SplatSquare(c, k) => put(splats.map(|s| &mut s.pixels[i].square.0[c]), k),
            Slot::SplatPath(class, c, k) => put(splats.map(|s| &mut s.classes[i * classes + class].0[c]), k),
        }
    }
}
