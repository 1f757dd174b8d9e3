//! The built-in environment maps: the default one, a sun, and three that find bugs.
//!
//! Lat-long images, row 0 at the zenith (+y), columns from +x (u = 0) over +z (0.25), −x (0.5) and −z (0.75). Every
//! value is a half float, so that an EXR file of halves keeps it exactly, and every machine computes the same bits:
//! elementary functions come from `libm`, sums have a fixed order. The default map, `nave`, is a file of the repository
//! that is embedded in the program; the package under `envmaps/generate` generates it.

mod stress;
mod sun;

use crate::math::Rgb;
use crate::raster::{self, Image};
use std::path::Path;

pub use self::stress::{ONE_HOT_RADIANCE, ONE_HOT_TEXEL};

/// The default map, as an OpenEXR file.
const NAVE: &[u8] = include_bytes!("../../../envmaps/nave.exr");

/// A built-in environment map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Synthetic {
    /// The inside of a Gothic church.
    Nave,
    /// A clear sky with a small sun.
    Sun,
    /// Radiance 1 everywhere.
    Constant,
    /// One texel.
    Onehot,
    /// Nothing.
    Black,
}

impl Synthetic {
    /// Every built-in map, the default one first.
    pub const ALL: [Self; 5] = [Self::Nave, Self::Sun, Self::Constant, Self::Onehot, Self::Black];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Nave => "nave",
            Self::Sun => "sun",
            Self::Constant => "constant",
            Self::Onehot => "onehot",
            Self::Black => "black",
        }
    }

    /// The map of that name, if there is one.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|map| map.name() == name)
    }

    /// One line for lists.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Nave => "the inside of a Gothic church: stained glass, candles and stone, 1024x512",
            Self::Sun => "a clear sky with a small sun that holds two fifths of the energy, 1024x512",
            Self::Constant => "radiance 1 from everywhere, 64x32",
            Self::Onehot => "black but for one texel, 64x32",
            Self::Black => "no light at all, 64x32",
        }
    }

    /// Makes the map. Radiance is linear RGB.
    #[must_use]
    pub fn make(self) -> Image {
        let image = match self {
            Self::Nave => raster::decode_exr(Path::new("nave.exr"), NAVE).expect("the embedded file is sound"),
            Self::Sun => sun::make(),
            Self::Constant => stress::constant(),
            Self::Onehot => stress::one_hot(),
            Self::Black => stress::black(),
        };
        image.map(to_half)
    }
}

fn to_half(radiance: Rgb) -> Rgb {
    Rgb::from_array(radiance.to_array().map(|v| half::f16::from_f32(v).to_f32()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the tests ask of a map. Energy is radiance (mean of R, G, B) times solid angle.
    struct Statistics {
        pixel_mean: Rgb,
        /// Peak over solid-angle mean.
        contrast: f64,
        /// Parts of the energy in the strongest texel and the strongest hundredth of the texels.
        strongest: f64,
        top_percent: f64,
        min: f32,
    }

    fn statistics(image: &Image) -> Statistics {
        let (mut energies, mut sphere, mut peak) = (Vec::new(), 0.0, 0.0_f64);
        for y in 0..image.height() {
            let row = |y: usize| libm::cos(std::f64::consts::PI * y as f64 / image.height() as f64);
            let solid_angle = row(y) - row(y + 1);
            for p in image.row(y) {
                let value = f64::from(p.element_sum()) / 3.0;
                energies.push(value * solid_angle);
                sphere += solid_angle;
                peak = peak.max(value);
            }
        }
        energies.sort_by(|a, b| b.total_cmp(a));
        let total: f64 = energies.iter().sum();
        let top: f64 = energies[..energies.len() / 100].iter().sum();
        Statistics {
            pixel_mean: image.pixels().iter().sum::<Rgb>() / energies.len() as f32,
            contrast: peak / (total / sphere),
            strongest: energies[0] / total,
            top_percent: top / total,
            min: image.pixels().iter().fold(f32::INFINITY, |m, p| m.min(p.min_element())),
        }
    }

    #[test]
    fn names_round_trip() {
        for map in Synthetic::ALL {
            assert_eq!(Synthetic::from_name(map.name()), Some(map));
            assert!(!map.description().is_empty());
        }
        assert_eq!(Synthetic::from_name("Nave"), None);
    }

    #[test]
    fn every_value_is_a_finite_half_and_none_is_negative() {
        for map in Synthetic::ALL {
            let image = map.make();
            for v in image.pixels().iter().flat_map(|p| p.to_array()) {
                assert!(v.is_finite() && v >= 0.0 && half::f16::from_f32(v).to_f32() == v, "{}: {v}", map.name());
            }
        }
    }

    #[test]
    fn the_nave_has_the_statistics_of_a_measured_cathedral() {
        let s = statistics(&Synthetic::Nave.make());
        assert!(s.pixel_mean.min_element() > 0.010 && s.pixel_mean.max_element() < 0.023, "mean {}", s.pixel_mean);
        assert!(s.contrast > 500.0 && s.contrast < 1000.0, "peak is {} means", s.contrast);
        assert!(s.top_percent > 0.40 && s.top_percent < 0.50, "top 1 % holds {}", s.top_percent);
        assert!(s.strongest < 0.004, "one texel holds {}", s.strongest);
        assert!(s.min > 1e-4, "min {}", s.min);
    }

    #[test]
    fn the_sun_is_small_and_holds_two_fifths_of_the_energy() {
        let image = Synthetic::Sun.make();
        let s = statistics(&image);
        assert!(s.contrast > 1e4, "peak is {} means", s.contrast);
        assert!(s.min > 0.0);
        let half_peak = 0.5 * image.pixels().iter().fold(0.0_f32, |m, p| m.max(p.x));
        let disc = image.pixels().iter().filter(|p| p.x > half_peak).count();
        assert!((9..=20).contains(&disc), "{disc} texels");
        let energy = |sun: bool| -> f64 {
            (0..image.height())
                .map(|y| {
                    let sine = libm::sin(std::f64::consts::PI * (y as f64 + 0.5) / image.height() as f64);
                    let of = |p: &&Rgb| !sun || p.x > 0.02 * half_peak;
                    image.row(y).iter().filter(of).map(|p| f64::from(p.element_sum())).sum::<f64>() * sine
                })
                .sum()
        };
        let part = energy(true) / energy(false);
        assert!((0.37..0.43).contains(&part), "the sun holds {part}");
    }

    #[test]
    fn the_bits_do_not_depend_on_the_number_of_threads() {
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
            pool.install(|| Synthetic::Sun.make())
        });
        assert!(one == two);
    }

    /// A hash of all bits, so that a machine that computes other bits is noticed.
    #[test]
    fn the_bits_do_not_depend_on_the_machine() {
        for (map, expected) in [(Synthetic::Nave, NAVE_HASH), (Synthetic::Sun, SUN_HASH)] {
            let hash = map.make().pixels().iter().flat_map(|p| p.to_array()).fold(0_u64, |hash, v| {
                hash.wrapping_mul(0x0100_0000_01b3).wrapping_add(u64::from(half::f16::from_f32(v).to_bits()))
            });
            assert_eq!(hash, expected, "{}: {hash:#018x}", map.name());
        }
    }

    const NAVE_HASH: u64 = 0xc50d_47cc_dacf_7747;
    const SUN_HASH: u64 = 0x66b3_6398_f6c3_2192;
}
