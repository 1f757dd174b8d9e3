//! The light from infinity: its map, its scale, and how its frame lies in the world.

use super::PbrtOptions;
use super::params::Params;
use super::place::quote;
use super::setup::MAX_SAMPLES;
use super::transform;
use crate::envmap::EnvMap;
use crate::error::{Error, Result};
use crate::raster::{Image, Rgb};
use crate::scene::Environment;
use glam::{DMat3, DMat4, DVec3};
use std::path::Path;
use std::sync::Arc;

/// Takes directions of an upright map (row 0 at +y) to pbrt's light space, where row 0 is at +z and u runs from +x to
/// +y: (sin θ cos φ, cos θ, sin θ sin φ) → (sin θ cos φ, sin θ sin φ, cos θ).
const MAP_TO_LIGHT: DMat3 = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);

/// The light from infinity, and how many samples it asks for at each hit. A map's name is relative to `folder`.
pub fn infinite(
    mut p: Params,
    to_world: &DMat4,
    folder: &Path,
    options: &PbrtOptions,
    warnings: &mut Vec<String>,
) -> Result<(Environment, u32)> {
    if p.kind != "infinite" {
        return Err(p.unsupported_kind("infinite"));
    }
    let Some((rotation, _)) = transform::similarity(to_world) else {
        return Err(p.at.unsupported("a light that its transform distorts is not supported"));
    };
    let power = |x: f64| (0.0..=1e30).contains(&x);
    let radiance = p.rgb("L", power, "from 0 to 1e30")?.unwrap_or(Rgb::ONE);
    let scale = radiance * factor(&mut p, power)?;
    if !scale.is_finite() {
        return Err(p.at.input("L times scale is out of range"));
    }
    // pbrt-v3 calls it "samples", and takes the older name too.
    let samples = p.integer("nsamples", 1..=MAX_SAMPLES)?;
    let samples = p.integer("samples", 1..=MAX_SAMPLES)?.or(samples).unwrap_or(1);
    let (map, source) = map(&mut p, folder, options, warnings)?;
    p.finish(&[], warnings)?;
    Ok((Environment { map, source, scale, to_world: rotation * MAP_TO_LIGHT }, samples))
}

/// `scale`: a colour in pbrt-v2 and v3, a number in v4.
fn factor(p: &mut Params, valid: impl Fn(f64) -> bool) -> Result<Rgb> {
    if p.has_type("scale", "float") {
        Ok(p.float("scale", valid, "from 0 to 1e30")?.map_or(Rgb::ONE, |x| Rgb::splat(x as f32)))
    } else {
        Ok(p.rgb("scale", valid, "from 0 to 1e30")?.unwrap_or(Rgb::ONE))
    }
}

/// The map and its name: `mapname` is lat-long in every version, `filename` is pbrt-v4's own, equal-area and square.
fn map(
    p: &mut Params,
    folder: &Path,
    options: &PbrtOptions,
    warnings: &mut Vec<String>,
) -> Result<(Arc<EnvMap>, String)> {
    let (place, file_place) = (p.place("mapname"), p.place("filename"));
    let (mapname, filename) = (p.text("mapname")?, p.text("filename")?);
    if mapname.is_some() && filename.is_some() {
        return Err(file_place.input(format!("{} has both a mapname and a filename", p.owner)));
    }
    let (place, equal_area) = if filename.is_some() { (file_place, true) } else { (place, false) };
    let name = mapname.or(filename).filter(|name| !name.is_empty());
    let Some(name) = name else {
        if options.environment.is_some() {
            warnings.push(p.at.warning("this light has no map: the given environment is not used"));
        }
        return Ok((Arc::new(EnvMap::new(Image::from_pixels(1, 1, vec![Rgb::ONE]))), "constant".into()));
    };
    if let Some((map, source)) = &options.environment {
        return Ok((map.clone(), source.clone()));
    }
    let image = (options.load_map)(&folder.join(&name)).map_err(|e| match e {
        Error::Io { path, source } => place
            .input(format!("cannot read the map {}: {source}", path.display()))
            .with_hint("put the map there, or give another one in its place"),
        other => other,
    })?;
    if equal_area {
        let hint = "give a lat-long map as \"string mapname\", or in place of the file's";
        if image.width() != 2 * image.height() {
            let size = format!("{} x {}", image.width(), image.height());
            return Err(place
                .unsupported(format!(
                    "the map {} ({size}) is not lat-long: equal-area maps are not supported",
                    quote(&name)
                ))
                .with_hint(hint));
        }
        warnings.push(place.warning("this map is twice as wide as high: taken as lat-long, not equal-area"));
    }
    Ok((Arc::new(EnvMap::new(image)), name))
}
