//! The square maps of pbrt-v4's `infinite` light, which cover equal solid angles by equal areas, as lat-long maps.

use crate::envmap::LatLong;
use crate::math::Rgb;
use crate::raster::Image;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::FRAC_2_PI;

/// Directions in each texel of the lat-long map, along each axis.
const PER_SIDE: usize = 4;

/// The lat-long map, 2n × n, of a square map of n × n texels; both have their pole at +z of the light.
///
/// pbrt takes the nearest texel of the square in each direction. A texel of the lat-long map is the mean of that over 4 × 4
/// strata of equal solid angle, so edges of texels are blurred by up to one texel of the result, and the mean
/// of the map keeps an error of the order of what one stratum holds.
pub fn to_lat_long(square: &Image) -> Image {
    let n = square.width();
    let geometry = LatLong::new(2 * n, n);
    let strata = || (0..PER_SIDE).map(|i| (i as f64 + 0.5) / PER_SIDE as f64);
    let texel = |x: usize, y: usize| {
        let directions = strata().flat_map(|fy| strata().map(move |fx| (fx, fy)));
        let values = directions.map(|(fx, fy)| {
            let d = geometry.direction_in_texel(x, y, fx, fy);
            let nearest = position(DVec3::new(d.x, d.z, d.y)).map(|u| ((u * n as f64) as usize).min(n - 1));
            square.get(nearest[0], nearest[1])
        });
        values.sum::<Rgb>() / (PER_SIDE * PER_SIDE) as f32
    };
    let pixels = (0..2 * n * n).into_par_iter().map(|i| texel(i % (2 * n), i / (2 * n)));
    Image::from_pixels(2 * n, n, pixels.collect())
}

/// Where the unit vector `d` lies on the square [0, 1]², row 0 first: the upper hemisphere (+z) is the diamond in the
/// middle, the lower one is folded into the corners.
///
/// With r = √(1 − |z|) and φ the angle to the x axis within its quadrant, a quadrant of the diamond has
/// v = r · 2φ/π and u = r − v. Source: P. Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", Journal of
/// Graphics Tools 13(3), 2008.
fn position(d: DVec3) -> [f64; 2] {
    // 1 − |z| without cancellation.
    let r = ((d.x * d.x + d.y * d.y) / (1.0 + d.z.abs())).sqrt();
    let v = r * FRAC_2_PI * d.y.abs().atan2(d.x.abs());
    let u = r - v;
    let [u, v] = if d.z < 0.0 { [1.0 - v, 1.0 - u] } else { [u, v] };
    [u.copysign(d.x), v.copysign(d.y)].map(|w| 0.5 * (w + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_their_places() {
        for (d, expected) in [
            (DVec3::Z, [0.5, 0.5]),
            (DVec3::X, [1.0, 0.5]),
            (DVec3::Y, [0.5, 1.0]),
            (-DVec3::X, [0.0, 0.5]),
            (-DVec3::Y, [0.5, 0.0]),
            (DVec3::new(0.0, 0.0, -1.0), [1.0, 1.0]),
            (DVec3::new(1.0, 1.0, 0.0).normalize(), [0.75, 0.75]),
        ] {
            let found = position(d);
            assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 1e-12), "{d}: {found:?}");
        }
    }

    #[test]
    fn equal_areas_are_equal_solid_angles() {
        // Each cell of 8 x 8 holds 1/64 of directions that are uniform in z and φ.
        let (n, side) = (1600, 8);
        let mut counts = vec![0_u32; side * side];
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let z = 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
            let (sin, cos) = (std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(n)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let [x, y] = position(DVec3::new(r * cos, r * sin, z)).map(|u| ((u * side as f64) as usize).min(side - 1));
            counts[y * side + x] += 1;
        }
        let expected = f64::from(n * n) / (side * side) as f64;
        assert!(counts.iter().all(|&count| (f64::from(count) / expected - 1.0).abs() < 0.01), "{counts:?}");
    }

    #[test]
    fn one_hot_texel_is_seen_in_its_direction() {
        let square = Image::from_fn(16, 16, |x, y| if (x, y) == (13, 8) { Rgb::ONE } else { Rgb::ZERO });
        let map = to_lat_long(&square);
        let geometry = LatLong::new(32, 16);
        let (mut total, mut mean) = (0.0, DVec3::ZERO);
        for (x, y) in (0..32).flat_map(|x| (0..16).map(move |y| (x, y))) {
            let share = f64::from(map.get(x, y).x) * geometry.solid_angle(y);
            total += share;
            mean += share * geometry.direction_in_texel(x, y, 0.5, 0.5);
        }
        // The solid angle of a texel is 4π / 256.
        assert!((total * 256.0 / (2.0 * std::f64::consts::TAU) - 1.0).abs() < 0.15, "{total}");
        let d = mean / total;
        let wanted = [13.5 / 16.0, 8.5 / 16.0];
        let light = DVec3::new(d.x, d.z, d.y).normalize();
        let found = position(light);
        assert!((0..2).all(|i| (found[i] - wanted[i]).abs() < 0.5 / 16.0), "{light}: {found:?}");
    }
}
