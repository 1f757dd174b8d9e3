//! Test cases: pixel filters. Camera rays sample film positions around a pixel, and light paths are weighted with the pdf.

use super::super::case::Case;
use super::inputs::in_lanes;
use etalon_core::scene::{Camera, PixelFilter, Projection};
use etalon_render::probe::{Lane, PreparedCamera, Rays, at};
use etalon_stats::{Sample, Square, density};
use glam::DVec3;
use pulp::Arch;

/// Columns and rows of the film.
const FILM: [u16; 2] = [7, 3];
/// A pixel on the left edge of the image: half of the film positions that its filter reaches are outside.
const PIXEL: [u32; 2] = [0, 1];

/// The pdf of a film position relative to the pixel's centre, per pixel.
pub type Pdf = fn(&PreparedCamera, [f32; 2]) -> f64;

/// What the contribution of a light path at a film position is multiplied with.
pub const KERNEL: Pdf = |prepared, [x, y]| {
    let mut weight = 0.0;
    prepared.pixels_around([x + PIXEL[0] as f32 + 0.5, y + PIXEL[1] as f32 + 0.5], |pixel, value| {
        if pixel == PIXEL {
            weight = f64::from(value);
        }
    });
    weight
};

/// The filters of the suite.
pub fn cases() -> Vec<Case> {
    let filters = ["box:1.25", "triangle:2", "gaussian:1.5,0.5", "gaussian:2x1,0.7", "gaussian:0.4,2"];
    filters.map(|name| positions(format!("filter/{name}"), name, KERNEL)).into()
}

/// The film positions of camera rays through the pixel.
pub fn positions(name: String, filter: &'static str, pdf: Pdf) -> Case {
    Case::of(name, Square, move || {
        let filter: PixelFilter = filter.parse().expect("a filter");
        // A unit of length is a pixel.
        let [half_width, half_height] = FILM.map(|side| f64::from(side) / 2.0);
        let projection = Projection::Orthographic { half_width, half_height };
        let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection).expect("it does not look up");
        let camera = Camera { filter, ..camera };
        let prepared = move || PreparedCamera::new(&camera, FILM[0].into(), FILM[1].into());
        let (sampled, weighted) = (prepared(), prepared());
        let [rx, ry] = filter.radius();
        let draw = move |[u]: &[[Lane; 2]; 1], count| {
            let mut rays = Rays::default();
            sampled.rays(Arch::new(), &[PIXEL[0]; _], PIXEL[1], u, count, &mut rays);
            let place = |i: usize| {
                let view = sampled.project(at(&rays.origin, i) + at(&rays.direction, i))?;
                let from_centre = [0, 1].map(|axis| f64::from(view.film[axis]) - f64::from(PIXEL[axis]) - 0.5);
                let place = [from_centre[0] / rx, from_centre[1] / ry];
                Some(Sample::new(place.map(|x| (0.5 + 0.5 * x).clamp(0.0, 1.0))))
            };
            (0..count).map(place).collect()
        };
        let pdf = move |[u, v]: [f64; 2]| {
            4.0 * rx * ry * pdf(&weighted, [((2.0 * u - 1.0) * rx) as f32, ((2.0 * v - 1.0) * ry) as f32])
        };
        (in_lanes(draw), density(pdf))
    })
}
