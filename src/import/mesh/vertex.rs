//! Positions and normals of vertices, as both formats check them.

use crate::import::transform::in_range;
use glam::{DVec3, Vec3};
use std::path::Path;

/// A point in single precision; `None` when it is not finite or too far away to render.
pub fn point(coordinates: [f64; 3]) -> Option<Vec3> {
    let point = DVec3::from_array(coordinates);
    in_range(point).then(|| point.as_vec3())
}

/// Normals of unit length; none, with a warning, when one of them has no direction.
pub fn unit_normals(path: &Path, normals: &[[f64; 3]], warnings: &mut Vec<String>) -> Vec<Vec3> {
    let unit: Option<Vec<Vec3>> =
        normals.iter().map(|&n| Some(DVec3::from_array(n).try_normalize()?.as_vec3())).collect();
    unit.unwrap_or_else(|| {
        warnings.push(format!("{}: a normal has no direction: all normals are left out", path.display()));
        Vec::new()
    })
}
