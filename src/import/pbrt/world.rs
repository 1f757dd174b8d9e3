//! What stands in the world: materials and spheres.

use super::params::Params;
use crate::error::Result;
use crate::import::transform::{self, in_range, in_size_range};
use crate::raster::Rgb;
use crate::scene::{Material, Sphere};
use glam::DMat4;

/// The material of shapes before the file sets one.
pub const DEFAULT_MATERIAL: Material = Material::Diffuse { albedo: Rgb::splat(0.5) };

/// A material.
pub fn material(mut p: Params, warnings: &mut Vec<String>) -> Result<Material> {
    let name = match p.kind.as_str() {
        "matte" => "Kd",
        "diffuse" => "reflectance",
        _ => return Err(p.unsupported_kind("matte, diffuse")),
    };
    let albedo = p.rgb(name, |x| (0.0..=1.0).contains(&x), "from 0 to 1")?;
    if p.kind == "matte" {
        p.only_float("sigma", |x| x == 0.0, "0 (Lambert's law)")?;
    }
    p.finish(&[], warnings)?;
    Ok(albedo.map_or(DEFAULT_MATERIAL, |albedo| Material::Diffuse { albedo }))
}

/// A whole sphere. Which side counts as outside does not matter to the materials above, nor does a mirror image.
pub fn sphere(mut p: Params, to_world: &DMat4, warnings: &mut Vec<String>) -> Result<Sphere> {
    if p.kind != "sphere" {
        return Err(p.unsupported_kind("sphere"));
    }
    let radius = p.float("radius", |x| x > 0.0, "positive")?.unwrap_or(1.0);
    p.only_float("zmin", |z| z <= -radius, "a whole sphere")?;
    p.only_float("zmax", |z| z >= radius, "a whole sphere")?;
    p.only_float("phimax", |phi| phi >= 360.0, "a whole sphere")?;
    let Some((_, scale)) = transform::similarity(to_world) else {
        return Err(p
            .at
            .unsupported("a sphere that its transform makes an ellipsoid is not supported")
            .with_hint("scale all three axes alike"));
    };
    let (centre, radius) = (to_world.w_axis.truncate(), radius * scale);
    if !in_range(centre) || !in_size_range(radius) {
        return Err(p.at.input(format!("a sphere of radius {radius} at {centre} is out of range")));
    }
    p.finish(&[], warnings)?;
    Ok(Sphere { centre: centre.as_vec3(), radius: radius as f32 })
}
