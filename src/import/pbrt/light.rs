//! The light from infinity: its map, its scale, and how its frame lies in the world.

use super::PbrtOptions;
use super::params::Params;
use super::setup::MAX_SAMPLES;
use crate::envmap::EnvMap;
use crate::error::{Error, Result};
use crate::import::place::{At, quote};
use crate::import::transform;
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
    let file = MapFile::named_by(&mut p)?;
    let at = p.at.clone();
    p.finish(&[], warnings)?;
    let (map, source) = match (file, &options.environment) {
        (Some(_), Some((map, source))) => (map.clone(), source.clone()),
        (Some(file), None) => (Arc::new(EnvMap::new(file.load(folder, options, warnings)?)), file.name),
        (None, given) => {
            if given.is_some() {
                warnings.push(at.warning("this light has no map: the given environment is not used"));
            }
            (Arc::new(EnvMap::new(Image::from_pixels(1, 1, vec![Rgb::ONE]))), "constant".into())
        }
    };
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

/// The map that a light names.
struct MapFile {
    name: String,
    /// Where it is named.
    at: At,
    /// Whether pbrt would take it as equal-area.
    equal_area: bool,
}

impl MapFile {
    /// `mapname` is lat-long in every version; `filename` is pbrt-v4's own, equal-area and square.
    fn named_by(p: &mut Params) -> Result<Option<Self>> {
        let (lat_long_at, equal_area_at) = (p.place("mapname"), p.place("filename"));
        let (lat_long, equal_area) = (p.text("mapname")?, p.text("filename")?);
        Ok(match (lat_long, equal_area) {
            (Some(_), Some(_)) => {
                return Err(equal_area_at.input(format!("{} has both a mapname and a filename", p.owner)));
            }
            (Some(name), None) if !name.is_empty() => Some(Self { name, at: lat_long_at, equal_area: false }),
            (None, Some(name)) if !name.is_empty() => Some(Self { name, at: equal_area_at, equal_area: true }),
            _ => None,
        })
    }

    fn load(&self, folder: &Path, options: &PbrtOptions, warnings: &mut Vec<String>) -> Result<Image> {
        let image = (options.load_map)(&folder.join(&self.name)).map_err(|e| match e {
            Error::Io { path, source } => self
                .at
                .input(format!("cannot read the map {}: {source}", path.display()))
                .with_hint("put the map there, or give another one in its place"),
            other => other,
        })?;
        if self.equal_area && image.width() != 2 * image.height() {
            let (name, width, height) = (quote(&self.name), image.width(), image.height());
            return Err(self
                .at
                .unsupported(format!(
                    "the map {name} ({width} x {height}) is not lat-long: equal-area is not supported"
                ))
                .with_hint("give a lat-long map as \"string mapname\", or in place of the file's"));
        }
        if self.equal_area {
            warnings.push(self.at.warning("this map is twice as wide as high: taken as lat-long, not equal-area"));
        }
        Ok(image)
    }
}
