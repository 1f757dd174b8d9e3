//! Generates `envmaps/nave.exr`, the program's default environment map: the inside of a Gothic church, seen from the
//! middle of the nave.
//!
//! `cargo run --release -p generate-nave` writes the file again. Every machine computes the same bits: elementary
//! functions come from `libm`, sums have a fixed order, and the values are rounded to half floats, which the file
//! keeps exactly.
//!
//! The plan, in metres (details in `plan.rs`); the apse is towards +z (u = 0.25), the west front with the rose
//! towards −z (u = 0.75), the sunny south side towards −x (u = 0.5):
//!
//! ```text
//!   x = −11.4 ┌──═══──┬──═══──┬──═══──┬──═══──┬──═══──┐         ═ windows
//!             │ aisle                                 │
//!   x = −6    ●───────●───────●───────●───────●───────●╲        ● piers, 6 m apart; pointed arches between
//!             ‖ nave                                    ║         them, niches and the clerestory over those
//!    portal   ‖             o    eye   o                ║ apse  o chandeliers
//!   and rose  ‖                                         ║
//!   x = 6     ●───────●───────●───────●───────●───────●╱        the nave is 18.5 m high, the aisles 7.3 m
//!             │ aisle                                 │
//!   x = 11.4  └──═══──┴──═══──┴──═══──┴──═══──┴──═══──┘
//!          z = −15                                 z = 15
//! ```
//!
//! Every surface has a closed form (planes, upright cylinders, tunnels of pointed profile), so a ray costs a fraction
//! of a microsecond. Light: the sky through each window and one bounce of it are stored on a coarse grid; the sun
//! through the glass, the lamps, and the mirror image in the polished floor are computed for every sample.

mod arch;
mod building;
mod columns;
mod film;
mod glass;
mod irradiance;
mod light;
mod plan;
mod ray;
mod stone;
mod sun;
mod vault;

use self::film::{HEIGHT, Lens, Seen, WIDTH};
use self::irradiance::Irradiance;
use self::light::Lamp;
use self::ray::{Hit, Ray, Surface};
use self::sun::Sun;
use etalon::raster::{self, Image, Metadata, Precision, WriteOptions};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// Brings the map to the mean radiance of the measured cathedral that it stands in for.
const EXPOSURE: f32 = 0.70;
/// Radiance in the middle of a flame, before the lens.
const FLAME: DVec3 = DVec3::new(26.0, 17.5, 7.5);
/// The width of a pixel as an angle.
const PIXEL: f64 = std::f64::consts::PI / HEIGHT as f64;

/// All light that falls on stone.
struct Lighting {
    irradiance: Irradiance,
    lamps: Vec<Lamp>,
    sun: Sun,
}

fn main() -> etalon::Result<()> {
    let metadata = Metadata::default().with("map", "nave");
    let options = WriteOptions { precision: Precision::Half, ..WriteOptions::default() };
    raster::write_with(&file(), &make(), &metadata, options)
}

/// The file that the program embeds.
fn file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../nave.exr")
}

/// Renders the map, 1024 × 512, in radiance that half floats represent exactly.
fn make() -> Image {
    let church = Lighting::new();
    let lens = Lens::new();
    let mut image = lens.expose(|d| church.see(d));
    church.add_flames(&lens, &mut image);
    let image = film::glow(&image);
    let to_half = |v: f32| half::f16::from_f32(v * EXPOSURE).to_f32();
    Image::from_pixels(WIDTH, HEIGHT, image.into_iter().map(|c| c.to_array().map(to_half).into()).collect())
}

fn trace(ray: &Ray) -> Hit {
    let shell = building::trace(ray);
    columns::trace(ray, shell.t).unwrap_or(shell)
}

impl Lighting {
    fn new() -> Self {
        let mut lighting = Self { irradiance: Irradiance::by_windows(), lamps: light::lamps(), sun: Sun::new() };
        // Rays that carry light from stone to stone see it blurred.
        const WIDTH: f64 = 0.5;
        let bounce = lighting.irradiance.bounce(|hit| match hit.surface {
            Surface::Glass(..) => DVec3::ZERO,
            _ => lighting.stone(hit, WIDTH),
        });
        lighting.irradiance.add(&bounce);
        lighting
    }

    /// Radiance of lit stone; `width` is that of the pixel there, in metres.
    fn stone(&self, hit: &Hit, width: f64) -> DVec3 {
        let light = self.irradiance.at(hit.p, hit.n)
            + self.sun.irradiance(hit.p, hit.n)
            + light::lamplight(&self.lamps, hit.p, hit.n);
        stone::albedo(hit, width) * light / std::f64::consts::PI
    }

    fn see(&self, d: DVec3) -> Seen {
        let ray = Ray { o: plan::EYE, d };
        let hit = trace(&ray);
        let mut radiance = self.radiance(&ray, &hit, hit.t);
        if hit.surface == Surface::Floor {
            let mirrored = Ray { o: hit.p, d: DVec3::new(d.x, -d.y, d.z) };
            let image = trace(&mirrored);
            radiance += self.radiance(&mirrored, &image, hit.t + image.t) * polish(-d.y);
        }
        radiance += self.sun.beams(&ray, hit.t);
        (radiance, identity(&hit))
    }

    /// What a surface sends to the ray's origin, after a way of `length` metres in all.
    fn radiance(&self, ray: &Ray, hit: &Hit, length: f64) -> DVec3 {
        if let Surface::Glass(kind, number, q) = hit.surface
            && let Some(radiance) = light::window(kind, number, q, ray.d)
        {
            return radiance;
        }
        let width = PIXEL * length / hit.n.dot(ray.d).abs().max(0.2).sqrt();
        self.stone(hit, width)
    }

    fn add_flames(&self, lens: &Lens, image: &mut [DVec3]) {
        for flame in light::flames() {
            let below = flame.p * DVec3::new(1.0, -1.0, 1.0);
            for (p, mirrored) in [(flame.p, false), (below, true)] {
                let way = p - plan::EYE;
                let d = way / way.length();
                let hit = trace(&Ray { o: plan::EYE, d });
                let seen = if mirrored { hit.surface == Surface::Floor } else { hit.t > way.length() - 0.1 };
                if seen {
                    let strength = if mirrored { polish(-d.y) } else { 1.0 };
                    let radius = (0.035 * flame.candles.sqrt() / way.length()).max(0.8 * PIXEL);
                    lens.spot(image, d, FLAME * strength, radius);
                }
            }
        }
    }
}

/// The part of the light that the worn polish of the floor mirrors, by the cosine to its normal.
fn polish(cosine: f64) -> f64 {
    let c = 1.0 - cosine;
    0.025 + 0.30 * c * c * c * c * c
}

/// Tells surfaces apart for antialiasing.
fn identity(hit: &Hit) -> u32 {
    match hit.surface {
        Surface::Glass(kind, number, _) => 100 + 32 * kind as u32 + (number + 16) as u32,
        Surface::Floor => 1,
        Surface::Wall => 2,
        Surface::Dressed => 3,
        Surface::Vault => 4,
        Surface::AisleVault => 5,
        Surface::ApseVault => 6,
        Surface::Column => 7,
        Surface::Niche => 8,
        Surface::Door => 9,
        Surface::Iron => 10,
        Surface::Wax => 11,
        Surface::Altar => 12,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_holds_what_is_generated_to_the_last_bit() {
        let written = raster::read(&file(), raster::ReadOptions::default()).unwrap();
        assert!(make() == written, "run: cargo run --release -p generate-nave");
    }

    #[test]
    fn one_thread_makes_the_same_bits() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert!(pool.install(make) == make());
    }
}
