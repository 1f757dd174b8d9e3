//! The built-in environment maps: the default one, a sun, and three that find bugs.
//!
//! Lat-long images, row 0 at the zenith (+y), columns from +x (u = 0) over +z (0.25), −x (0.5) and −z (0.75). Every
//! value is a half float, so that an EXR file of halves keeps it exactly, and every machine computes the same bits:
//! elementary functions come from `libm`, sums have a fixed order. The default map, `nave`, is a file of the repository
//! that is embedded in the program; `envmaps/README.md` says where it comes from.
//!
//! `sun` is a clear sky over bare ground, and a sun of about a dozen texels. Not a model of the atmosphere, but smooth and of the
//! right order: the sky is pale at the horizon and deep blue above, brighter around the sun; the ground reflects and fades into the
//! haze of the horizon.

use crate::error::Result;
use crate::math::Rgb;
use crate::memory;
use crate::raster::{self, Image};
use etalon_envmaps::NAVE;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::path::Path;

/// Column and row of the one bright texel of `onehot`: away from the axes, the poles and the seam, without symmetry.
pub const ONE_HOT_TEXEL: (usize, usize) = (21, 11);
/// Its radiance: three different values, so that swapped channels show.
pub const ONE_HOT_RADIANCE: Rgb = Rgb::new(1000.0, 500.0, 250.0);

/// A built-in environment map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Synthetic {
    /// The inside of a Gothic church.
    Nave,
    /// A clear sky with a small sun.
    Sun,
    /// Radiance 1 everywhere.
    Constant,
    Onehot,
    /// Nothing.
    Black,
}

impl Synthetic {
    /// Every built-in map, the default one first.
    pub const ALL: [Self; 5] = [Self::Nave, Self::Sun, Self::Constant, Self::Onehot, Self::Black];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        self.texts().0
    }

    /// One line for lists.
    pub fn description(self) -> &'static str {
        self.texts().1
    }

    fn texts(self) -> (&'static str, &'static str) {
        match self {
            Self::Nave => ("nave", "the inside of a Gothic church: stained glass, candles and stone, 1024x512"),
            Self::Sun => ("sun", "a clear sky with a small sun that holds two fifths of the energy, 1024x512"),
            Self::Constant => ("constant", "radiance 1 from everywhere, 64x32"),
            Self::Onehot => ("onehot", "black but for one texel, 64x32"),
            Self::Black => ("black", "no light at all, 64x32"),
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|map| map.name() == name)
    }

    /// Asks for the memory that [`make`](Self::make) takes, which does not ask.
    ///
    /// # Errors
    /// [`Error::Memory`](crate::error::Error::Memory).
    pub fn request(self) -> Result<()> {
        // The largest map takes the image, and once more while it is decoded and rounded.
        memory::request(3 * 1024 * 512 * size_of::<Rgb>(), || format!("the map {}", self.name()))
    }

    /// Makes the map. Radiance is linear RGB.
    pub fn make(self) -> Image {
        let small = |radiance: fn((usize, usize)) -> Rgb| Image::from_fn(64, 32, |x, y| radiance((x, y)));
        let image = match self {
            Self::Nave => memory::granted(|| raster::decode_exr(Path::new("nave.exr"), NAVE))
                .expect("the embedded file is sound, and its memory not asked for"),
            Self::Sun => sun(),
            Self::Constant => small(|_| Rgb::ONE),
            Self::Onehot => small(|at| if at == ONE_HOT_TEXEL { ONE_HOT_RADIANCE } else { Rgb::ZERO }),
            Self::Black => small(|_| Rgb::ZERO),
        };
        image.map(to_half)
    }
}

fn to_half(radiance: Rgb) -> Rgb {
    Rgb::from_array(radiance.to_array().map(|v| half::f16::from_f32(v).to_f32()))
}

const WIDTH: usize = 1024;
const HEIGHT: usize = 512;

/// Height of the sun over the horizon and its turn from +x towards +z, in radians.
const ELEVATION: f64 = 0.68;
const AZIMUTH: f64 = 2.25;
/// Angular radius of the disc, in radians: over twice the real one, to cover a dozen texels.
const RADIUS: f64 = 0.0105;
/// Radiance in the middle of the disc.
const DISC: DVec3 = DVec3::new(7800.0, 7000.0, 5900.0);

const ZENITH: DVec3 = DVec3::new(0.075, 0.17, 0.42);
const HORIZON: DVec3 = DVec3::new(0.52, 0.60, 0.68);
const GROUND: DVec3 = DVec3::new(0.17, 0.14, 0.105);
const AUREOLE: DVec3 = DVec3::new(1.0, 0.90, 0.74);

/// The map `sun`, in f32; see the module.
fn sun() -> Image {
    let (se, ce) = libm::sincos(ELEVATION);
    let (sa, ca) = libm::sincos(AZIMUTH);
    let sun = DVec3::new(ce * ca, se, ce * sa);
    let pixels: Vec<Rgb> = (0..WIDTH * HEIGHT)
        .into_par_iter()
        .map(|i| {
            let centre = direction((i % WIDTH) as f64 + 0.5, (i / WIDTH) as f64 + 0.5);
            let light = background(centre, sun) + DISC * disc(i % WIDTH, i / WIDTH, centre, sun);
            Rgb::from(light.as_vec3())
        })
        .collect();
    Image::from_pixels(WIDTH, HEIGHT, pixels)
}

/// The direction of a place in the image, in pixels from the upper left corner.
fn direction(x: f64, y: f64) -> DVec3 {
    let (sp, cp) = libm::sincos(2.0 * PI * x / WIDTH as f64);
    let (st, ct) = libm::sincos(PI * y / HEIGHT as f64);
    DVec3::new(st * cp, ct, st * sp)
}

fn background(d: DVec3, sun: DVec3) -> DVec3 {
    // The angle to the sun from the chord, which loses no digits close to it.
    let angle = 2.0 * libm::asin((0.5 * (d - sun).length()).min(1.0));
    let haze = libm::exp(-d.y.abs() / 0.16);
    if d.y > 0.0 {
        let aureole = 2.2 * libm::exp(-angle / 0.06) + 0.30 * libm::exp(-angle / 0.35);
        ZENITH.lerp(HORIZON, haze) + AUREOLE * aureole
    } else {
        // With the sun behind the eye the ground is a little brighter: its grains hide their shadows.
        let opposite = 0.5 * (1.0 - d.dot(sun));
        (GROUND * (0.8 + 0.5 * opposite)).lerp(HORIZON * 0.8, libm::exp(d.y / 0.02))
    }
}

/// The part of the pixel that the disc covers, weighted by its darkening towards the limb.
fn disc(x: usize, y: usize, centre: DVec3, sun: DVec3) -> f64 {
    const SIDE: usize = 16;
    if (centre - sun).length() > RADIUS + 2.0 * PI / HEIGHT as f64 {
        return 0.0;
    }
    let mut sum = 0.0;
    for k in 0..SIDE * SIDE {
        let at = |k: usize| (k as f64 + 0.5) / SIDE as f64;
        let d = direction(x as f64 + at(k % SIDE), y as f64 + at(k / SIDE));
        let r = (d - sun).length() / RADIUS;
        if r < 1.0 {
            sum += 1.0 - 0.6 * (1.0 - (1.0 - r * r).sqrt());
        }
    }
    sum / (SIDE * SIDE) as f64
}

#[cfg(test)]
mod tests {
    use super::super::EnvMap;
    use super::super::info::Info;
    use super::*;

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
        let map = EnvMap::new(Synthetic::Nave.make());
        let info = Info::of(&map);
        assert!(info.mean_rgb.iter().all(|mean| (0.010..0.023).contains(mean)), "mean {:?}", info.mean_rgb);
        assert!((500.0..1000.0).contains(&info.peak_to_mean), "peak is {} means", info.peak_to_mean);
        assert!(info.min.unwrap() > 1e-4, "{:?}", info.min);
        let (width, height) = (info.width, info.height);
        let mut energies: Vec<f64> = (0..width * height).map(|i| map.energy(i % width, i / width)).collect();
        energies.sort_by(|a, b| b.total_cmp(a));
        let total: f64 = energies.iter().sum();
        let top = energies[..energies.len() / 100].iter().sum::<f64>() / total;
        assert!((0.40..0.50).contains(&top), "the brightest hundredth of the texels holds {top}");
        assert!(energies[0] < 0.004 * total, "one texel holds {}", energies[0] / total);
    }

    #[test]
    fn the_sun_is_small_and_holds_two_fifths_of_the_energy() {
        let map = EnvMap::new(Synthetic::Sun.make());
        let info = Info::of(&map);
        assert!(info.peak_to_mean > 1e4 && info.min.unwrap() > 0.0, "{info:?}");
        let half_peak = 0.5 * info.max.unwrap();
        let disc = map.image().pixels().iter().filter(|p| p.x > half_peak).count();
        assert!((9..=20).contains(&disc), "{disc} texels");
        assert!((0.37..0.43).contains(&info.peak_share), "the sun holds {}", info.peak_share);
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
