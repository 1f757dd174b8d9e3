//! `sun`: a clear sky over bare ground, and a sun of about a dozen texels.
//!
//! Not a model of the atmosphere, but smooth and of the right order: the sky is pale at the horizon and deep blue
//! above, brighter around the sun; the ground reflects and fades into the haze of the horizon.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use crate::math::Rgb;
use crate::raster::Image;

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

/// The map, in f32; see the module.
pub fn make() -> Image {
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
