//! `nave`: the inside of a Gothic church, seen from the middle of the nave.
//!
//! The plan, in metres (details in `plan.rs`); the apse is towards +z (u = 0.25), the west front with the rose
//! towards −z (u = 0.75), the sunny south side towards −x (u = 0.5):
//!
//! ```text
//!   x = −9.5 ┌──═══──┬──═══──┬──═══──┬──═══──┬──═══──┐          ═ windows
//!            │ aisle                                 │
//!   x = −4.5 ●───────●───────●───────●───────●───────●╲         ● piers, 6 m apart; pointed arches between
//!            ‖ nave              eye                   ╲        them, niches and the clerestory over those
//!  portal    ‖   o       o        x        o       o    ▌ apse  o chandeliers
//!  and rose  ‖                                         ╱
//!   x =  4.5 ●───────●───────●───────●───────●───────●╱
//!            │ aisle                                 │
//!   x =  9.5 └──═══──┴──═══──┴──═══──┴──═══──┴──═══──┘
//!         z = −15                                 z = 15
//! ```
//!
//! Every surface has a closed form (planes, upright cylinders, tunnels of pointed profile), so a ray costs a fraction
//! of a microsecond. Light: the sky through each window and one bounce of it are kept on a coarse grid; the sun
//! through the glass, the lamps, and the mirror image in the polished floor are worked out for every sample.

mod arch;
mod building;
mod columns;
mod film;
mod glass;
mod irradiance;
mod light;
mod plan;
mod stone;

use glam::DVec3;

use self::building::{Hit, Ray, Surface};
use self::film::{HEIGHT, Lens, Seen, WIDTH};
use self::irradiance::Irradiance;
use self::light::Lamp;
use crate::raster::{Image, Rgb};

/// Brings the map to the mean radiance of the measured cathedral that it stands in for.
const EXPOSURE: f64 = 1.0;
/// Radiance in the middle of a flame, before the lens.
const FLAME: DVec3 = DVec3::new(22.0, 13.5, 5.0);
/// The width of a pixel as an angle.
const PIXEL: f64 = std::f64::consts::PI / HEIGHT as f64;

struct Church {
    irradiance: Irradiance,
    lamps: Vec<Lamp>,
    beams: Vec<DVec3>,
}

/// Renders the map, 1024 × 512.
pub fn make() -> Image {
    let t0 = std::time::Instant::now();
    let lamps = light::lamps();
    let irradiance = Irradiance::new(|grid, hit| reflected(grid, &lamps, hit, 0.5));
    let church = Church { irradiance, lamps, beams: light::beam_tints() };
    eprintln!("vol {:?}", t0.elapsed());
    let lens = Lens::new();
    let mut image = lens.expose(|d| church.see(d));
    eprintln!("exp {:?}", t0.elapsed());
    church.add_flames(&lens, &mut image);
    eprintln!("flames {:?}", t0.elapsed());
    film::glow(&mut image);
    eprintln!("glow {:?}", t0.elapsed());
    Image::from_pixels(WIDTH, HEIGHT, image.into_iter().map(|c| Rgb::from((c * EXPOSURE).as_vec3())).collect())
}

/// Radiance of lit stone under the given grid; glass counts as black.
fn reflected(grid: &Irradiance, lamps: &[Lamp], hit: &Hit, width: f64) -> DVec3 {
    if matches!(hit.surface, Surface::Glass(..)) {
        return DVec3::ZERO;
    }
    stone_radiance(grid, lamps, hit, width)
}

fn stone_radiance(grid: &Irradiance, lamps: &[Lamp], hit: &Hit, width: f64) -> DVec3 {
    let light = grid.at(hit.p, hit.n) + light::sun(hit.p, hit.n) + light::lamplight(lamps, hit.p, hit.n);
    stone::albedo(hit, width) * light / std::f64::consts::PI
}

fn trace(ray: &Ray) -> Hit {
    let shell = building::trace(ray);
    columns::trace(ray, shell.t).unwrap_or(shell)
}

impl Church {
    fn see(&self, d: DVec3) -> Seen {
        let ray = Ray { o: plan::EYE, d };
        let hit = trace(&ray);
        let mut radiance = self.radiance(&ray, &hit, hit.t);
        if hit.surface == Surface::Floor {
            let mirrored = Ray { o: hit.p, d: DVec3::new(d.x, -d.y, d.z) };
            let image = trace(&mirrored);
            radiance += self.radiance(&mirrored, &image, hit.t + image.t) * polish(-d.y);
        }
        radiance += light::beams(&ray, hit.t, &self.beams);
        (radiance, identity(&hit))
    }

    /// What a surface sends to the ray's origin, after a way of `length` metres in all.
    fn radiance(&self, ray: &Ray, hit: &Hit, length: f64) -> DVec3 {
        if let Surface::Glass(kind, number, q) = hit.surface
            && let Some(shine) = light::window(kind, number, q, ray.d)
        {
            return shine;
        }
        let width = PIXEL * length / hit.n.dot(ray.d).abs().max(0.2).sqrt();
        stone_radiance(&self.irradiance, &self.lamps, hit, width)
    }

    fn add_flames(&self, lens: &Lens, image: &mut [DVec3]) {
        for flame in light::flames() {
            let below = DVec3::new(flame.p.x, -flame.p.y, flame.p.z);
            for (p, strength) in [(flame.p, 1.0), (below, 0.0)] {
                let way = p - plan::EYE;
                let d = way.normalize();
                let hit = trace(&Ray { o: plan::EYE, d });
                let strength = if strength > 0.0 { strength } else { polish(-d.y) };
                let seen = if p.y > 0.0 { hit.t > way.length() - 0.1 } else { hit.surface == Surface::Floor };
                if seen {
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
