//! Test cases: camera rays, in lanes, and pixel filters.
//!
//! A film position is uniform. The points where the rays meet a wall that faces the camera then have the pdf cos θ over
//! the area that the film covers at the point, which is also what light paths are connected to the camera with. With a filter,
//! camera rays sample film positions around a pixel, and light paths are weighted with the pdf.

use super::super::case::Case;
use super::in_lanes;
use etalon_core::scene::{Camera, PixelFilter, Projection};
use etalon_render::probe::{Lane, PreparedCamera, Rays, at};
use etalon_stats::{Sample, Square, density};
use glam::{DVec3, Vec3};

/// The pdf of a film position over the area that it sees, by the factor cos θ of the direction and that area.
pub type CameraPdf = fn(f64, f64) -> f64;
/// What rays and the connection of light paths follow.
pub const CAMERA: CameraPdf = |cos, area| cos / area;

/// Columns and rows of the film.
const FILM: [usize; 2] = [7, 3];
const DEPTH: f64 = 2.0;
/// Rounding may move points that are so close to the edge of a pixel, in pixels, to the next.
const EDGE: f32 = 1e-4;

pub fn cameras() -> Vec<Case> {
    let perspective = |tan_half_width| Projection::Perspective { tan_half_width, tan_half_height: 0.5 };
    let parallel = Projection::Orthographic { half_width: 1.5, half_height: 0.5 };
    let cameras = [("narrow", perspective(0.1)), ("wide", WIDE), ("parallel", parallel)];
    cameras.map(|(name, projection)| camera(format!("camera/{name}"), projection, CAMERA)).into()
}

/// A camera of a wide angle.
pub const WIDE: Projection = Projection::Perspective { tan_half_width: 3.0, tan_half_height: 0.5 };

/// The test of a camera's rays against a pdf.
pub fn camera(name: String, projection: Projection, pdf_of: CameraPdf) -> Case {
    Case::of(name, Square, move || {
        let position = DVec3::new(1.0, 2.0, 3.0);
        let camera = Camera::look_at(position, DVec3::ZERO, DVec3::Y, projection).expect("it does not look up");
        let (prepared, prepared_too) =
            (PreparedCamera::new(&camera, FILM[0], FILM[1]), PreparedCamera::new(&camera, FILM[0], FILM[1]));
        // Half of the wall's sides, as large as the film shows it.
        let [x, y] = match projection {
            Projection::Orthographic { half_width, half_height } => [half_width, half_height],
            Projection::Perspective { tan_half_width, tan_half_height } => {
                [DEPTH * tan_half_width, DEPTH * tan_half_height]
            }
        };
        let draw = move |[pixel, within]: &[[Lane; 2]; 2], count| {
            let column = |i: usize| (pixel[0][i] * FILM[0] as f32) as u32;
            let row = |i: usize| (pixel[1][i] * FILM[1] as f32) as u32;
            let columns = std::array::from_fn(column);
            let mut samples: Vec<_> = (0..count).map(|_| None).collect();
            let mut rays = Rays::default();
            for y0 in 0..FILM[1] as u32 {
                prepared.rays(&columns, y0, within, count, &mut rays);
                for i in (0..count).filter(|&i| row(i) == y0) {
                    let [origin, direction] = [&rays.origin, &rays.direction].map(|lane| at(lane, i).as_dvec3());
                    let t = (DEPTH - (origin - position).dot(camera.forward)) / direction.dot(camera.forward);
                    let point = origin + t * direction;
                    // The projection must lead back to the pixel.
                    let inner = |u: f32| (EDGE..1.0 - EDGE).contains(&u);
                    let seen = prepared.project(point.as_vec3()).map(|view| view.film.map(|x| x as u32));
                    let is_back = seen == Some([columns[i], y0]) || !inner(within[0][i]) || !inner(within[1][i]);
                    let to = point - position;
                    let place = [0.5 + 0.5 * to.dot(camera.right) / x, 0.5 + 0.5 * to.dot(camera.up) / y];
                    samples[i] = is_back.then(|| Sample::new(place.map(|x| x.clamp(0.0, 1.0))));
                }
            }
            samples
        };
        let pdf = move |[u, v]: [f64; 2]| {
            let to = DEPTH * camera.forward + (2.0 * u - 1.0) * x * camera.right + (2.0 * v - 1.0) * y * camera.up;
            let cos = if matches!(projection, Projection::Orthographic { .. }) { 1.0 } else { DEPTH / to.length() };
            let point: Vec3 = (position + to).as_vec3();
            4.0 * x * y * pdf_of(cos, f64::from(prepared_too.area_at(point)))
        };
        (in_lanes(draw), density(pdf))
    })
}

/// Columns and rows of the film of the tests of filters.
const FILTERED: [u16; 2] = [7, 3];
/// A pixel on the left edge of the image: half of the film positions that its filter reaches are outside.
const PIXEL: [u32; 2] = [0, 1];

/// The pdf of a film position relative to the pixel's centre, per pixel.
pub type FilterPdf = fn(&PreparedCamera, [f32; 2]) -> f64;

/// What the contribution of a light path at a film position is multiplied with.
pub const FILTER: FilterPdf = |prepared, [x, y]| {
    let mut weight = 0.0;
    prepared.pixels_around([x + PIXEL[0] as f32 + 0.5, y + PIXEL[1] as f32 + 0.5], |pixel, value| {
        if pixel == PIXEL {
            weight = f64::from(value);
        }
    });
    weight
};

pub fn filters() -> Vec<Case> {
    let filters = ["box:1.25", "triangle:2", "gaussian:1.5,0.5", "gaussian:2x1,0.7", "gaussian:0.4,2"];
    filters.map(|name| positions(format!("filter/{name}"), name, FILTER)).into()
}

/// The film positions of camera rays through the pixel.
pub fn positions(name: String, filter: &'static str, pdf: FilterPdf) -> Case {
    Case::of(name, Square, move || {
        let filter: PixelFilter = filter.parse().expect("a filter");
        // A unit of length is a pixel.
        let [half_width, half_height] = FILTERED.map(|side| f64::from(side) / 2.0);
        let projection = Projection::Orthographic { half_width, half_height };
        let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, projection).expect("it does not look up");
        let camera = Camera { filter, ..camera };
        let prepared = move || PreparedCamera::new(&camera, FILTERED[0].into(), FILTERED[1].into());
        let (sampled, weighted) = (prepared(), prepared());
        let [rx, ry] = filter.radius();
        let draw = move |[u]: &[[Lane; 2]; 1], count| {
            let mut rays = Rays::default();
            sampled.rays(&[PIXEL[0]; _], PIXEL[1], u, count, &mut rays);
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
