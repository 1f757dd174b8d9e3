//! The camera for many rays at once, and the pixels around a film position.

use super::lanes::{LANES, Lane, Rays, set, wide};
use etalon_core::sampling::filter::FilterAxis;
use etalon_core::scene::{Camera, PixelFilter, Projection};
use glam::Vec3;

/// A camera and its film, in f32.
pub struct PreparedCamera {
    position: Vec3,
    forward: Vec3,
    /// From the centre of the film to the middles of its right and upper edge, in units of the film's distance (or of
    /// length, if the rays are parallel).
    right: Vec3,
    up: Vec3,
    parallel: bool,
    /// Size of a pixel on a film from −1 to 1.
    step: [f32; 2],
    /// Columns and rows.
    size: [f32; 2],
    /// The pixel filter along x and y.
    filter: [FilterAxis; 2],
    /// How far it reaches beyond a pixel, along x and y; negative if it ends inside.
    margin: [f32; 2],
    /// Whether the filter is the box of one pixel, which random numbers sample as they are.
    is_unit_box: bool,
}

/// The projection of a point to the film.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Unit direction towards the camera.
    pub direction: Vec3,
    /// Distance to where the camera's ray to the point starts.
    pub distance: f32,
    /// Film position in pixels, from the upper left corner of the image.
    pub film: [f32; 2],
}

impl PreparedCamera {
    pub fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let (half_width, half_height, parallel) = match camera.projection {
            Projection::Orthographic { half_width, half_height } => (half_width, half_height, true),
            Projection::Perspective { tan_half_width, tan_half_height } => (tan_half_width, tan_half_height, false),
        };
        let filter = camera.filter.axes();
        Self {
            position: camera.position.as_vec3(),
            forward: camera.forward.as_vec3(),
            right: (camera.right * half_width).as_vec3(),
            up: (camera.up * half_height).as_vec3(),
            parallel,
            step: [2.0 / width as f32, 2.0 / height as f32],
            size: [width as f32, height as f32],
            margin: [filter[0].radius() - 0.5, filter[1].radius() - 0.5],
            filter,
            is_unit_box: camera.filter == PixelFilter::default(),
        }
    }

    /// The area that the whole image covers at the distance of a point, of surfaces that face the camera.
    #[inline]
    pub fn area_at(&self, point: Vec3) -> f32 {
        // The film's area, one unit of length away, times d² cos³ θ, θ the angle to the axis and d the distance.
        let film = 4.0 * self.right.length() * self.up.length();
        if self.parallel {
            return film;
        }
        let to = point - self.position;
        let depth = to.dot(self.forward).max(0.0);
        film * depth * depth * depth / to.length()
    }

    /// Projects a point to the film, if a pixel's filter reaches it, also from inside of the image; occlusion is not tested.
    #[inline]
    pub fn project(&self, point: Vec3) -> Option<View> {
        let to = point - self.position;
        let depth = to.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let (film, direction, distance) = if self.parallel {
            (to, -self.forward, depth)
        } else {
            let distance = to.length();
            (to / depth, -to / distance, distance)
        };
        let across = film.dot(self.right) / self.right.length_squared();
        let down = -film.dot(self.up) / self.up.length_squared();
        let film = [(across + 1.0) / self.step[0], (down + 1.0) / self.step[1]];
        let is_reached = |axis: usize| {
            let margin = self.margin[axis];
            film[axis] >= -margin && film[axis] < self.size[axis] + margin
        };
        (is_reached(0) && is_reached(1)).then_some(View { direction, distance, film })
    }

    /// Calls `add` with each pixel whose filter reaches a film position, and the value f of the filter there.
    #[inline]
    pub fn pixels_around(&self, film: [f32; 2], mut add: impl FnMut([u32; 2], f32)) {
        if self.is_unit_box {
            add(film.map(|x| x as u32), 1.0);
            return;
        }
        let range = |axis: usize| {
            let first = (film[axis] - self.margin[axis]).floor();
            let last = (film[axis] + self.margin[axis]).floor();
            first.max(0.0) as i32..=last.min(self.size[axis] - 1.0) as i32
        };
        let value = |axis: usize, pixel: i32| self.filter[axis].value(film[axis] - (pixel as f32 + 0.5));
        for y in range(1) {
            for x in range(0) {
                add([x as u32, y as u32], value(0, x) * value(1, y));
            }
        }
    }

    /// The rays through row `y` of the film at the given columns: `u` samples the filter of each pixel.
    pub fn rays(&self, columns: &[u32; LANES], y: u32, u: &[Lane; 2], count: usize, rays: &mut Rays) {
        let &Self { position, forward, right, up, parallel, step, .. } = self;
        let mut filtered = [[0.0; LANES]; 2];
        if !self.is_unit_box {
            for axis in 0..2 {
                for i in 0..count.min(LANES) {
                    filtered[axis][i] = 0.5 + self.filter[axis].sample(u[axis][i]);
                }
            }
        }
        // Film positions relative to the upper left corner of the pixel
        let within = if self.is_unit_box { u } else { &filtered };
        wide(
            #[inline(always)]
            move || {
                for i in 0..count.min(LANES) {
                    let across = (columns[i] as i32 as f32 + within[0][i]) * step[0] - 1.0;
                    let down = (y as i32 as f32 + within[1][i]) * step[1] - 1.0;
                    let on_film = right * across - up * down;
                    let origin = if parallel { position + on_film } else { position };
                    let direction = if parallel { forward } else { forward + on_film };
                    set(&mut rays.origin, i, origin);
                    set(&mut rays.direction, i, direction * (1.0 / direction.length()));
                }
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_point_is_seen_in_the_pixel_whose_rays_meet_it() {
        let perspective = Projection::Perspective { tan_half_width: 0.8, tan_half_height: 0.3 };
        let parallel = Projection::Orthographic { half_width: 1.5, half_height: 0.5 };
        for projection in [perspective, parallel] {
            let camera = Camera::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
            let (width, height) = (30, 20);
            let prepared = PreparedCamera::new(&camera, width, height);
            for (x, y) in (0..30).flat_map(|x| (0..20).map(move |y| (x, y))) {
                let ray = camera.ray((f64::from(x) + 0.3) / 30.0, (f64::from(y) + 0.8) / 20.0);
                let point = ray.origin + 2.5 * ray.direction;
                let view = prepared.project(point).unwrap();
                let mut pixels = Vec::new();
                prepared.pixels_around(view.film, |pixel, weight| pixels.push((pixel, weight)));
                assert_eq!(pixels, [([x as u32, y as u32], 1.0)]);
                assert!((view.distance - 2.5).abs() < 1e-5 && (view.direction + ray.direction).length() < 1e-5);
                assert!(prepared.project(ray.origin - 2.5 * ray.direction).is_none(), "behind the camera");
            }
            for (x, y) in [(-0.1, 0.5), (1.1, 0.5), (0.5, -0.1), (0.5, 1.1)] {
                let ray = camera.ray(x, y);
                assert!(prepared.project(ray.origin + ray.direction).is_none(), "beside the film");
            }
        }
    }
}
