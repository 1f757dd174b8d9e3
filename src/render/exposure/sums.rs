//! The sums of a film as channels of unsigned integers: four words of 32 bits for each number.

use super::fixed::Fixed;
use super::{Classes, Exposure};

/// One word of the film's state in every pixel.
#[derive(Debug, Clone, Copy)]
pub enum Slot {
    /// How many samples.
    Count,
    /// A word of a channel's sum; word 0 is the lowest.
    Sum(usize, usize),
    /// A word of a channel's sum of squares.
    Square(usize, usize),
    /// A word of a path class's sum in a channel.
    Path(usize, usize, usize),
}

/// All words with the names of their channels: `sums.n`, `sums.R0` … `sums.B3`, `squares.R0` …, `sums.LDE.R0` ….
#[must_use]
pub fn slots(classes: Option<Classes>) -> Vec<(String, Slot)> {
    let words = || (0..3).flat_map(|c| (0..4).map(move |k| (c, k, format!("{}{k}", ["R", "G", "B"][c]))));
    let mut slots = vec![("sums.n".to_owned(), Slot::Count)];
    slots.extend(words().map(|(c, k, word)| (format!("sums.{word}"), Slot::Sum(c, k))));
    slots.extend(words().map(|(c, k, word)| (format!("squares.{word}"), Slot::Square(c, k))));
    for (class, name) in classes.into_iter().flat_map(Classes::names).enumerate() {
        slots.extend(words().map(|(c, k, word)| (format!("sums.{name}.{word}"), Slot::Path(class, c, k))));
    }
    slots
}

impl Slot {
    /// The word in pixel number `i`.
    #[must_use]
    pub fn get(self, film: &Exposure, i: usize) -> u32 {
        let word = |number: Fixed, k: usize| (number.bits() >> (32 * k)) as u32;
        match self {
            Slot::Count => film.pixels[i].n,
            Slot::Sum(c, k) => word(film.pixels[i].sum[c], k),
            Slot::Square(c, k) => word(film.pixels[i].square[c], k),
            Slot::Path(class, c, k) => {
                film.paths.as_ref().map_or(0, |p| word(p.sums[i * p.classes.count() + class][c], k))
            }
        }
    }

    /// Puts the word into pixel number `i`, where it must have been 0.
    pub fn set(self, film: &mut Exposure, i: usize, value: u32) {
        let put = |number: &mut Fixed, k: usize| *number += Fixed::from_bits(u128::from(value) << (32 * k));
        match self {
            Slot::Count => film.pixels[i].n = value,
            Slot::Sum(c, k) => put(&mut film.pixels[i].sum[c], k),
            Slot::Square(c, k) => put(&mut film.pixels[i].square[c], k),
            Slot::Path(class, c, k) => {
                if let Some(paths) = &mut film.paths {
                    put(&mut paths.sums[i * paths.classes.count() + class][c], k);
                }
            }
        }
    }
}
