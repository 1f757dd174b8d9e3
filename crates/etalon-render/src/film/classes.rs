//! Path classes: words like `LSDE` in the notation of Heckbert.
//!
//! Source: Heckbert, "Adaptive radiosity textures for bidirectional ray tracing", SIGGRAPH 1990.

/// The scatterings of a light path from the light L to the eye E: D at a diffuse or rough surface, S in a mirror or
/// smooth glass.
///
/// The code is a one followed by a bit for each scattering, the one next to the light first: D is 0, S is 1. So codes
/// in increasing order are words by length, then by alphabet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathClass(u32);

impl PathClass {
    /// `LE`: light that reaches the camera directly. A path traced from the camera starts with it.
    pub const DIRECT: Self = Self(1);
    /// A path of more scatterings keeps the class that it has.
    const LONGEST: u32 = 30;

    /// The path with one more scattering, in a mirror or smooth glass, between the light and what there was: the next vertex on the way from
    /// the eye.
    #[inline]
    #[must_use]
    pub fn then_specular(self) -> Self {
        self.then(2)
    }

    /// The path with one more scattering, at a diffuse or rough surface.
    #[inline]
    #[must_use]
    pub fn then_diffuse(self) -> Self {
        self.then(1)
    }

    /// Moves the leading bit up by one and sets the bit below: to 0 by adding the leading bit once, to 1 by adding it twice.
    #[inline]
    fn then(self, markers: u32) -> Self {
        if self.scatterings() == Self::LONGEST {
            return self;
        }
        Self(self.0 + (markers << self.scatterings()))
    }

    /// The path the other way round: from the eye to the light, if this one was traced from the light to the eye.
    #[inline]
    #[must_use]
    pub fn reversed(self) -> Self {
        let length = self.scatterings();
        let letters = self.0 & !(1 << length);
        Self(1 << length | letters.reverse_bits().unbounded_shr(u32::BITS - length))
    }

    /// The number of letters between L and E.
    #[inline]
    pub fn scatterings(self) -> u32 {
        self.0.ilog2()
    }
}

/// Which words get a layer of their own: all up to a number of scatterings, or one layer for all of a length. The others share one,
/// the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PathClasses {
    scatterings: u32,
    by_length: bool,
}

impl PathClasses {
    /// More scatterings than these would give more layers (2^(n+1)) than are of use.
    pub const LONGEST: u32 = 6;

    /// A class for each word of at most `scatterings` letters between L and E (at most [`PathClasses::LONGEST`]), and one
    /// for the rest.
    pub fn up_to(scatterings: u32) -> Self {
        Self { scatterings: scatterings.min(Self::LONGEST), by_length: false }
    }

    /// A class for each number of scatterings, at most `scatterings` (at most [`PathClasses::LONGEST`]), and one for the rest.
    #[must_use]
    pub fn by_length(scatterings: u32) -> Self {
        Self { by_length: true, ..Self::up_to(scatterings) }
    }

    /// How many classes there are, the rest included.
    pub fn count(self) -> usize {
        if self.by_length { self.scatterings as usize + 2 } else { 2 << self.scatterings }
    }

    /// The number of a word's class: by length, then by alphabet, the rest last.
    #[inline]
    pub fn index(self, word: PathClass) -> usize {
        let index = if self.by_length { word.scatterings() } else { word.0 - 1 };
        (index as usize).min(self.count() - 1)
    }

    /// The names of all classes in their order: `LE`, `LDE`, `LSE`, `LDDE`, … `rest`, or `L0E`, `L1E`, … `rest`.
    pub fn names(self) -> impl Iterator<Item = String> {
        let word = |code: u32| -> String {
            let letters = (0..code.ilog2()).rev().map(|bit| if code >> bit & 1 == 0 { 'D' } else { 'S' });
            ['L'].into_iter().chain(letters).chain(['E']).collect()
        };
        let name = move |i: u32| if self.by_length { format!("L{i}E") } else { word(i + 1) };
        (0..self.count() as u32 - 1).map(name).chain(["rest".to_owned()])
    }

    /// The classes with these names, joined by blanks.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let all = (0..=Self::LONGEST).flat_map(|n| [Self::up_to(n), Self::by_length(n)]);
        all.into_iter().find(|c| c.names().eq(text.split(' ')))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(from_the_eye: &str) -> PathClass {
        from_the_eye.chars().fold(PathClass::DIRECT, |word, letter| {
            if letter == 'S' { word.then_specular() } else { word.then_diffuse() }
        })
    }

    #[test]
    fn words_are_ordered_by_length_then_by_alphabet() {
        let names: Vec<String> = PathClasses::up_to(2).names().collect();
        assert_eq!(names, ["LE", "LDE", "LSE", "LDDE", "LDSE", "LSDE", "LSSE", "rest"]);
        for scatterings in 0..=PathClasses::LONGEST {
            let classes = PathClasses::up_to(scatterings);
            let names: Vec<String> = classes.names().collect();
            assert_eq!(names.len(), classes.count());
            assert!(names[..names.len() - 1].is_sorted_by_key(|n| (n.len(), n.clone())));
        }
    }

    #[test]
    fn a_path_from_the_eye_finds_the_word_from_the_light() {
        let classes = PathClasses::up_to(3);
        let names: Vec<String> = classes.names().collect();
        for from_the_eye in ["", "D", "S", "DS", "SD", "SSD", "DSD", "SDD"] {
            let letters: String = from_the_eye.chars().rev().collect();
            assert_eq!(names[classes.index(word(from_the_eye))], format!("L{letters}E"));
        }
        for long in ["DDDD", "SDSD", &"S".repeat(30), &"D".repeat(99), &"SD".repeat(99)] {
            assert_eq!(names[classes.index(word(long))], "rest");
        }
        let classes = PathClasses::by_length(2);
        let names: Vec<String> = classes.names().collect();
        for (letters, name) in [("", "L0E"), ("D", "L1E"), ("SD", "L2E"), ("SS", "L2E"), ("SDD", "rest")] {
            assert_eq!(names[classes.index(word(letters))], name);
        }
    }

    #[test]
    fn a_path_from_the_light_is_the_same_the_other_way_round() {
        for letters in ["", "D", "S", "DS", "SSD", "DSDDS", &"SDD".repeat(10)] {
            let from_the_light: String = letters.chars().rev().collect();
            assert_eq!(word(&from_the_light).reversed(), word(letters), "{letters}");
        }
    }

    #[test]
    fn names_can_be_read_back() {
        for classes in (0..=PathClasses::LONGEST).flat_map(|n| [PathClasses::up_to(n), PathClasses::by_length(n)]) {
            let text = classes.names().collect::<Vec<_>>().join(" ");
            assert_eq!(PathClasses::parse(&text), Some(classes));
        }
        assert_eq!(PathClasses::parse("LE LDE rest"), None);
    }
}
