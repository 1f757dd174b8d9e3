//! The camera for many rays at once.

use super::geometry::set;
use super::lanes::{LANES, Lane, Rays};
use super::wide::{Wide, wide};
use crate::scene::{Camera, Projection};
use glam::Vec3;
use pulp::Arch;

/// A camera and its film, in f32.
pub struct Lens {
    position: Vec3,
    forward: Vec3,
    /// From the centre of the film to the middles of its right and upper edge, in units of the film's distance (or of
    /// length, if the rays are parallel).
    right: Vec3,
    up: Vec3,
    parallel: bool,
    /// Of a pixel, on a film from −1 to 1.
    step: [f32; 2],
}

impl Lens {
    pub fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let (half_width, half_height, parallel) = match camera.projection {
            Projection::Orthographic { half_width, half_height } => (half_width, half_height, true),
            Projection::Perspective { tan_half_width, tan_half_height } => (tan_half_width, tan_half_height, false),
        };
        Self {
            position: camera.position.as_vec3(),
            forward: camera.forward.as_vec3(),
            right: (camera.right * half_width).as_vec3(),
            up: (camera.up * half_height).as_vec3(),
            parallel,
            step: [2.0 / width as f32, 2.0 / height as f32],
        }
    }

    /// The rays through row `y` of the film at the given columns, `u` inside each pixel.
    pub fn rays(&self, arch: Arch, columns: &[u32; LANES], y: u32, u: &[Lane; 2], count: usize, rays: &mut Rays) {
        wide(arch, Expose { lens: self, columns, y, u, count, rays });
    }
}

struct Expose<'a> {
    lens: &'a Lens,
    columns: &'a [u32; LANES],
    y: u32,
    u: &'a [Lane; 2],
    count: usize,
    rays: &'a mut Rays,
}

impl Wide for Expose<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { columns, y, u, count, rays, .. } = self;
        let Lens { position, forward, right, up, parallel, step } = *self.lens;
        for i in 0..count.min(LANES) {
            let across = (columns[i] as i32 as f32 + u[0][i]) * step[0] - 1.0;
            let down = (y as i32 as f32 + u[1][i]) * step[1] - 1.0;
            let on_film = right * across - up * down;
            let origin = if parallel { position + on_film } else { position };
            let direction = if parallel { forward } else { forward + on_film };
            set(&mut rays.origin, i, origin);
            set(&mut rays.direction, i, direction * (1.0 / direction.length()));
        }
    }
}
