//! The transforms of scene files, and what a matrix means for a light, a sphere or a camera.

use super::place::At;
use crate::error::Result;
use glam::{DMat3, DMat4, DVec3, DVec4, Vec3};

/// Tolerance of cosines between columns, and of relative differences of scales: files have about six digits.
const TOLERANCE: f64 = 1e-4;

/// A rotation about an axis through the origin, exact at quarter turns; `None` for an axis of length 0.
pub fn rotate(degrees: f64, axis: DVec3) -> Option<DMat4> {
    let axis = axis.try_normalize()?;
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    };
    let column = |v: DVec3| {
        let along = axis * axis.dot(v);
        (along + (v - along) * cos + axis.cross(v) * sin).extend(0.0)
    };
    Some(DMat4::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z), glam::DVec4::W))
}

/// World to camera: the camera at `eye` looks along +z at `target`, y up, x = up × z (left-handed, as in pbrt);
/// `None` when the three span no frame.
pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<DMat4> {
    let z = (target - eye).try_normalize()?;
    let x = up.try_normalize()?.cross(z).try_normalize()?;
    let rotation = DMat3::from_cols(x, z.cross(x), z).transpose();
    Some(DMat4::from_cols(
        rotation.x_axis.extend(0.0),
        rotation.y_axis.extend(0.0),
        rotation.z_axis.extend(0.0),
        (-(rotation * eye)).extend(1.0),
    ))
}

/// Passes a matrix that is finite and affine.
pub fn affine(matrix: DMat4, at: impl Fn() -> At) -> Result<DMat4> {
    if !matrix.is_finite() {
        return Err(at().input("the transform has left the range of numbers"));
    }
    if matrix.row(3) != glam::DVec4::W {
        return Err(at().unsupported("a projective transform").with_hint(
            "the matrix's last row must be 0 0 0 1; pbrt lists a matrix column by column, COLLADA row by row",
        ));
    }
    Ok(matrix)
}

/// Passes a matrix that is finite, affine and invertible.
pub fn checked(matrix: DMat4, at: &At) -> Result<DMat4> {
    let matrix = affine(matrix, || at.clone())?;
    let [x, y, z] = columns(&matrix).map(DVec3::normalize_or_zero);
    let volume = x.cross(y).dot(z).abs();
    // Written so that NaN fails too.
    if !(volume > 1e-12 && matrix.inverse().is_finite()) {
        return Err(at.input("this transform cannot be undone: it flattens space or leaves the range of numbers"));
    }
    Ok(matrix)
}

/// The directions of the three axes, orthonormal to rounding (a mirror image is fine), and their scales;
/// `None` when the matrix shears.
pub fn axes(matrix: &DMat4) -> Option<(DMat3, DVec3)> {
    let [x, y, z] = columns(matrix);
    let scales = DVec3::new(x.length(), y.length(), z.length());
    let [x, y, z] = [x / scales.x, y / scales.y, z / scales.z];
    if ![x.dot(y), y.dot(z), z.dot(x)].iter().all(|cosine| cosine.abs() < TOLERANCE) {
        return None;
    }
    let x = (x - z * z.dot(x)).normalize();
    let y = z.cross(x) * z.cross(x).dot(y).signum();
    Some((DMat3::from_cols(x, y, z), scales))
}

/// [`axes`] of a matrix that scales all of them alike, which keeps spheres round and maps undistorted.
pub fn similarity(matrix: &DMat4) -> Option<(DMat3, f64)> {
    let (rotation, scales) = axes(matrix)?;
    (scales.max_element() - scales.min_element() < TOLERANCE * scales.max_element()).then_some((rotation, scales.x))
}

/// The unit directions of the object's axes in the world; those of the world where a transform leaves none.
pub fn directions(to_world: &DMat4) -> [Vec3; 3] {
    let unit = |axis: DVec4, instead| axis.truncate().try_normalize().map_or(instead, DVec3::as_vec3);
    [unit(to_world.x_axis, Vec3::X), unit(to_world.y_axis, Vec3::Y), unit(to_world.z_axis, Vec3::Z)]
}

/// Coordinates must stay where their squares fit single precision.
const MAX_COORDINATE: f64 = 1e15;

/// Whether the coordinates of a point are small enough to render.
pub fn in_range(point: DVec3) -> bool {
    point.abs().max_element() <= MAX_COORDINATE && !point.is_nan()
}

/// Whether a length or a ratio is large and small enough to render.
pub fn in_size_range(size: f64) -> bool {
    (1.0 / MAX_COORDINATE..=MAX_COORDINATE).contains(&size)
}

fn columns(matrix: &DMat4) -> [DVec3; 3] {
    [matrix.x_axis.truncate(), matrix.y_axis.truncate(), matrix.z_axis.truncate()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use std::rc::Rc;

    #[test]
    fn quarter_turns_are_exact_and_go_the_right_way() {
        let r = |degrees, axis| rotate(degrees, axis).unwrap();
        assert_eq!(r(90.0, DVec3::X * 3.0).transform_vector3(DVec3::Y), DVec3::Z);
        assert_eq!(r(-90.0, DVec3::Y).transform_vector3(DVec3::Z), DVec3::NEG_X);
        assert_eq!(r(540.0, DVec3::Z).transform_vector3(DVec3::X), DVec3::NEG_X);
        let (angle, axis) = (33.0f64, DVec3::new(1.0, 2.0, 3.0));
        let reference = DMat4::from_axis_angle(axis.normalize(), angle.to_radians());
        assert!(r(angle, axis).abs_diff_eq(reference, 1e-15));
        assert!(rotate(1.0, DVec3::ZERO).is_none());
    }

    #[test]
    fn look_at_puts_the_target_ahead() {
        let m = look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 2.0, 7.0), DVec3::Y).unwrap();
        assert!(m.transform_point3(DVec3::new(4.0, 2.0, 7.0)).abs_diff_eq(5.0 * DVec3::Z, 1e-14));
        assert!(m.transform_vector3(DVec3::Y).abs_diff_eq(DVec3::Y, 1e-15));
        assert!((m.determinant() - 1.0).abs() < 1e-14);
        assert!(look_at(DVec3::ZERO, DVec3::Y, DVec3::Y).is_none());
        assert!(look_at(DVec3::ONE, DVec3::ONE, DVec3::Y).is_none());
        assert!(look_at(DVec3::ZERO, DVec3::Z, DVec3::ZERO).is_none());
    }

    #[test]
    fn similarities_are_recognised() {
        let turn = rotate(20.0, DVec3::new(1.0, -2.0, 0.5)).unwrap();
        let (rotation, scale) = similarity(&(turn * DMat4::from_scale(DVec3::new(-2.0, 2.0, 2.0)))).unwrap();
        assert!((scale - 2.0).abs() < 1e-14 && (rotation.determinant() + 1.0).abs() < 1e-14);
        assert!(rotation.x_axis.abs_diff_eq(-turn.x_axis.truncate(), 1e-14));
        let stretched = turn * DMat4::from_scale(DVec3::new(1.0, 1.0, 1.01));
        assert!(similarity(&stretched).is_none() && axes(&stretched).is_some());
        let sheared = DMat4::from_cols_array(&[1., 0., 0., 0., 0.1, 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]);
        assert!(axes(&sheared).is_none());
    }

    #[test]
    fn matrices_without_an_inverse_are_refused() {
        let at = At::file(Rc::from(Path::new("a")));
        let scale = |x, y, z| DMat4::from_scale(DVec3::new(x, y, z));
        for good in [scale(-1.0, 1.0, 1.0), scale(1e-20, 1e-20, 1e-20), scale(1e20, 1.0, 1e-20)] {
            assert!(checked(good, &at).is_ok(), "{good}");
        }
        let mut projective = DMat4::IDENTITY;
        projective.x_axis.w = 1.0;
        let flat = DMat4::from_cols_array(&[1., 0., 0., 0., 1., 0., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]);
        let bad = [scale(0.0, 1.0, 1.0), scale(1e-200, 1e-200, 1e-200), scale(f64::NAN, 1.0, 1.0), projective, flat];
        for bad in bad {
            assert!(checked(bad, &at).is_err(), "{bad}");
        }
    }
}
