//! Mistakes in sampling environment maps, and in sampling the regions of a median cut as strata.

use super::super::case::direction_density;
use super::super::suite::maps::{ENERGY, Share, strata};
use super::fault::PlantedFault;
use etalon_core::envmap::cut::Split;
use etalon_core::envmap::{EnvMap, LatLong};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::sampling::table::Table2;
use etalon_stats::{Density, Directions, Pole, Sample, Sampler, sampler};
use glam::DVec3;
use std::f64::consts::PI;

/// Sampling of a map by a table over its texels; each mistake replaces one part.
pub struct Scheme {
    pub map: EnvMap,
    /// What a texel is sampled in proportion to.
    pub weight: fn(&EnvMap, usize, usize) -> f64,
    /// The direction at a place inside a texel.
    pub place: fn(&LatLong, usize, usize, f64, f64) -> DVec3,
    /// The solid angle that the pdf spreads a texel's probability over.
    pub solid_angle: fn(&LatLong, usize) -> f64,
    /// Where the pdf looks a direction up.
    pub look_up: fn(DVec3) -> DVec3,
}

impl Scheme {
    fn right() -> Self {
        let value = |x: usize, y: usize| Rgb::splat(0.25 + ((7 * x + 3 * y) % 5) as f32);
        Self {
            map: EnvMap::new(Image::from_fn(20, 8, value)),
            weight: EnvMap::energy,
            place: LatLong::direction_in_texel,
            solid_angle: LatLong::solid_angle,
            look_up: |w| w,
        }
    }

    /// The sampler, and the pdf by the map's energies.
    fn build(self) -> (impl Sampler, impl Density) {
        let Self { map, weight, place, solid_angle, look_up } = self;
        let g = map.geometry().clone();
        let (width, height) = (g.width(), g.height());
        // The sampler's table, and that of the pdf.
        let sampled = Table2::new(width, height, |x, y| weight(&map, x, y));
        let claimed = Table2::new(width, height, |x, y| map.energy(x, y));
        let steps = g.edges();
        let geometry = g.clone();
        let draw = move |u: &[f64]| {
            let draw = sampled.sample([u[0], u[1]])?;
            Some(Sample::new(place(&geometry, draw.x.cell, draw.y.cell, draw.x.offset, draw.y.offset).to_array()))
        };
        let pdf = move |w: DVec3| {
            // Probability of the texel over its solid angle.
            let (x, y) = g.texel(look_up(w));
            let solid_angle = solid_angle(&g, y);
            if solid_angle > 0.0 { claimed.probability(x, y) / solid_angle } else { 0.0 }
        };
        (sampler(2, draw), direction_density(pdf).with_steps(steps))
    }
}

/// The solid angle of a texel by its row's sine, at a height inside the row (0 its upper edge).
fn by_sine(g: &LatLong, y: f64) -> f64 {
    let (width, height) = (g.width() as f64, g.height() as f64);
    2.0 * PI * PI / (width * height) * (PI * y / height).sin()
}

pub fn planted(name: &'static str, spoil: fn(&mut Scheme)) -> PlantedFault {
    PlantedFault::of(name, Directions::sphere(Pole::Y), move |faulty| {
        let mut scheme = Scheme::right();
        if faulty {
            spoil(&mut scheme);
        }
        scheme.build()
    })
}

pub fn maps() -> Vec<PlantedFault> {
    vec![
        planted("map/half-texel", |scheme| {
            scheme.place = |g, x, y, fx, fy| {
                g.direction_in_texel((x + g.width() - usize::from(fx < 0.5)) % g.width(), y, (fx + 0.5).fract(), fy)
            }
        })
        .mistake("texel centres taken for their left edges: all directions have an error of half a texel"),
        planted("map/corners", |scheme| {
            scheme.place = |g, x, y, _, _| g.direction(x as f64, y as f64);
        })
        .mistake("the corner of the sampled texel taken for all of it, as the course's renderer does"),
        planted("map/mirrored", |scheme| scheme.look_up = |w| DVec3::new(w.x, w.y, -w.z))
            .mistake("φ running the other way in the pdf than in the sampler: maps from another program"),
        planted("map/upside-down", |scheme| {
            scheme.look_up = |w| DVec3::new(w.x, -w.y, w.z);
        })
        .mistake("row 0 taken for the nadir in the pdf"),
        planted("map/without-sine", |scheme| scheme.weight = |map, x, y| map.mean_rgb(x, y))
            .mistake("texels sampled by radiance alone, as if those at the poles were as large as the others"),
        planted("map/sine-at-the-edge", |scheme| scheme.solid_angle = |g, y| by_sine(g, y as f64))
            .mistake("the solid angle of a row by the sine at its upper edge: 0 for the first row"),
        planted("map/sine-at-the-centre", |scheme| scheme.solid_angle = |g, y| by_sine(g, y as f64 + 0.5))
            .mistake("the solid angle of a row by the sine at its centre instead of the difference of cosines"),
        planted("map/pole-rows", |scheme| {
            scheme.weight = |map, x, y| {
                let last = map.geometry().height() - 1;
                let inside = y > 0 && y < last;
                if inside { map.mean_rgb(x, y) * (PI * y as f64 / last as f64).sin() } else { 0.0 }
            };
        })
        .mistake("rows weighted by sin(hπ/(H−1)), which is 0 at both poles: the first report"),
        planted("map/dropped-columns", |scheme| {
            scheme.weight = |map, x, y| if x < map.geometry().width() / 8 * 8 { map.energy(x, y) } else { 0.0 };
        })
        .mistake(
            "a table of blocks of eight columns, by whole division: what is left over on the right is never sampled",
        ),
    ]
}

pub fn cuts() -> Vec<PlantedFault> {
    let name = "strata/equal-shares";
    let equal: Share = |_| 1.0;
    let [faulty, sound] = [("planted", equal), ("sound", ENERGY)]
        .map(|(kind, share)| strata(format!("{kind}/{name}"), Split::Energy, 16, share));
    let mistake = "regions of a median cut drawn with equal probabilities: texels are not divided, so that cuts halve the energy only nearly";
    vec![PlantedFault { name, mistake, faulty, sound }]
}
