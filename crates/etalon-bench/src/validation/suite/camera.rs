//! Test cases: camera rays, in lanes.
//!
//! A film position is uniform. The points where the rays meet a wall that faces the camera then have the pdf cos θ over
//! the area that the film covers at the point, which is also what light paths are connected to the camera with.

use super::super::case::Case;
use super::inputs::in_lanes;
use etalon_core::scene::{Camera, Projection};
use etalon_render::probe::{Lane, PreparedCamera, Rays, at};
use etalon_stats::{Sample, Square, density};
use glam::{DVec3, Vec3};
use pulp::Arch;

/// The pdf of a film position over the area that it sees, by the factor cos θ of the direction and that area.
pub type Pdf = fn(f64, f64) -> f64;
/// What rays and the connection of light paths follow.
pub const KERNEL: Pdf = |cos, area| cos / area;

/// Columns and rows of the film.
const FILM: [usize; 2] = [7, 3];
/// Distance of the wall.
const DEPTH: f64 = 2.0;
/// Rounding may move points that are so close to the edge of a pixel, in pixels, to the next.
const EDGE: f32 = 1e-4;

/// The cameras of the suite.
pub fn cases() -> Vec<Case> {
    let perspective = |tan_half_width| Projection::Perspective { tan_half_width, tan_half_height: 0.5 };
    let parallel = Projection::Orthographic { half_width: 1.5, half_height: 0.5 };
    let cameras = [("narrow", perspective(0.1)), ("wide", WIDE), ("parallel", parallel)];
    cameras.map(|(name, projection)| camera(format!("camera/{name}"), projection, KERNEL)).into()
}

/// A camera of a wide angle.
pub const WIDE: Projection = Projection::Perspective { tan_half_width: 3.0, tan_half_height: 0.5 };

/// The test of a camera's rays against a pdf.
pub fn camera(name: String, projection: Projection, pdf_of: Pdf) -> Case {
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
                prepared.rays(Arch::new(), &columns, y0, within, count, &mut rays);
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
