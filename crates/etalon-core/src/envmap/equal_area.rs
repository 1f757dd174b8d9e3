//! Square maps that cover equal solid angles by equal areas, as pbrt-v4 has them, from lat-long maps and back.

use super::LatLong;
use crate::math::Rgb;
use crate::raster::Image;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Places in each texel, along each axis, at which the other map is looked up.
const PER_SIDE: usize = 4;

/// An image whose texels are the means of `value` at the centres of their strata, 0 to 1 along both axes.
fn from_strata(width: usize, height: usize, value: impl Fn(usize, usize, [f64; 2]) -> Rgb + Sync) -> Image {
    let centre = |i: usize| (i as f64 + 0.5) / PER_SIDE as f64;
    let texel = |i: usize| {
        let strata = (0..PER_SIDE * PER_SIDE).map(|k| [centre(k % PER_SIDE), centre(k / PER_SIDE)]);
        strata.map(|at| value(i % width, i / width, at)).sum::<Rgb>() / (PER_SIDE * PER_SIDE) as f32
    };
    Image::from_pixels(width, height, (0..width * height).into_par_iter().map(texel).collect())
}

/// The lat-long map, 2n × n, of a square map of n × n texels; both have their pole at +z of pbrt's light.
///
/// pbrt takes the nearest texel of the square in each direction. A texel of the lat-long map is the mean of that over 4 × 4
/// strata of equal solid angle, so edges of texels are blurred by up to one texel of the result, and the mean
/// of the map keeps an error of the order of what one stratum holds.
pub fn to_lat_long(square: &Image) -> Image {
    let n = square.width();
    let geometry = LatLong::new(2 * n, n);
    from_strata(2 * n, n, |x, y, [fx, fy]| {
        let d = geometry.direction_in_texel(x, y, fx, fy);
        let nearest = position(DVec3::new(d.x, d.z, d.y)).map(|u| ((u * n as f64) as usize).min(n - 1));
        square.get(nearest[0], nearest[1])
    })
}

/// The square map, n × n, of a lat-long map. A texel is the mean of the nearest texels of the lat-long map in 4 × 4 strata of
/// equal solid angle, so edges of texels are blurred by up to one texel of the result.
pub fn from_lat_long(map: &Image, n: usize) -> Image {
    let geometry = LatLong::new(map.width(), map.height());
    from_strata(n, n, |x, y, [fx, fy]| {
        let d = direction([(x as f64 + fx) / n as f64, (y as f64 + fy) / n as f64]);
        let (column, row) = geometry.texel(DVec3::new(d.x, d.z, d.y));
        map.get(column, row)
    })
}

/// The unit vector whose [`position`] is `at`.
fn direction(at: [f64; 2]) -> DVec3 {
    let signed = at.map(|w| 2.0 * w - 1.0);
    let [u, v] = signed.map(f64::abs);
    // The distance to the edge of the diamond: positive in the upper hemisphere.
    let inside = 1.0 - u - v;
    let r = 1.0 - inside.abs();
    let v = if inside < 0.0 { 1.0 - u } else { v };
    let phi = if r > 0.0 { FRAC_PI_2 * v / r } else { 0.0 };
    let (sin, cos) = phi.sin_cos();
    // The sine of the polar angle, whose cosine is 1 − r².
    let across = r * (2.0 - r * r).sqrt();
    let z = (1.0 - r * r).copysign(inside);
    DVec3::new((across * cos).copysign(signed[0]), (across * sin).copysign(signed[1]), z)
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
            assert!(direction(expected).distance(d) < 1e-7, "{d}: {}", direction(expected));
        }
    }

    #[test]
    fn directions_are_those_of_their_positions() {
        for (i, j) in (1..40).flat_map(|i| (1..40).map(move |j| (i, j))) {
            let at = [f64::from(i) / 40.3, f64::from(j) / 40.7];
            let (d, back) = (direction(at), position(direction(at)));
            assert!(
                (d.length() - 1.0).abs() < 1e-12 && (0..2).all(|i| (at[i] - back[i]).abs() < 1e-9),
                "{at:?} {back:?}"
            );
        }
    }

    #[test]
    fn a_map_comes_back_blurred_with_its_mean() {
        let map = Image::from_fn(32, 16, |x, y| Rgb::new(x as f32, y as f32, 1.0));
        let back = to_lat_long(&from_lat_long(&map, 64));
        let geometry = LatLong::new(128, 64);
        let (mut before, mut after) = (Rgb::ZERO, Rgb::ZERO);
        for (x, y) in (0..128).flat_map(|x| (0..64).map(move |y| (x, y))) {
            let weight = geometry.solid_angle(y) as f32;
            before += map.get(x / 4, y / 4) * weight;
            after += back.get(x, y) * weight;
        }
        assert!((before / after - Rgb::ONE).abs().max_element() < 2e-3, "{before} {after}");
        assert!((back.get(66, 31) - map.get(16, 7)).abs().max_element() < 1.01);
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
}
