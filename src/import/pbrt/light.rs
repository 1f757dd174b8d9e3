//! Lights: environment maps, directional, point and area lights.

use super::PbrtOptions;
use super::params::Params;
use super::setup::MAX_SAMPLES;
use crate::envmap::{EnvMap, MAX_RADIANCE, check_range};
use crate::error::{Error, Result};
use crate::import::place::{At, quote};
use crate::import::transform::{self, in_range};
use crate::math::Rgb;
use crate::raster::Image;
use crate::scene::{Emission, EmitterVisibility, Environment, Falloff, Light};
use glam::{DMat3, DMat4, DVec3};
use std::path::Path;
use std::sync::Arc;

/// Takes directions of an upright map (row 0 at +y) to pbrt's light space, where row 0 is at +z and u runs from +x to
/// +y: (sin θ cos φ, cos θ, sin θ sin φ) → (sin θ cos φ, sin θ sin φ, cos θ).
const MAP_TO_LIGHT: DMat3 = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);

/// The light of a `LightSource`.
pub enum Source {
    /// An environment, and the number of light samples at each hit.
    Infinite(Environment, u32),
    /// A delta light.
    Simple(Light),
}

/// `LightSource`. A map's name is relative to `folder`.
pub fn source(
    mut p: Params,
    to_world: &DMat4,
    folder: &Path,
    options: &PbrtOptions,
    warnings: &mut Vec<String>,
) -> Result<Source> {
    let light = match p.kind.as_str() {
        "infinite" => return infinite(p, to_world, folder, options, warnings),
        "distant" => distant(&mut p, to_world)?,
        "point" => point(&mut p, to_world)?,
        _ => return Err(p.unsupported_kind("infinite, distant, point")),
    };
    p.finish(&["nsamples", "samples"], warnings)?;
    Ok(Source::Simple(light))
}

/// `AreaLightSource`: the emission of shapes, and the number of light samples at each hit.
pub fn area(mut p: Params, warnings: &mut Vec<String>) -> Result<(Emission, u32)> {
    // pbrt-v2 also calls it "area".
    if p.kind != "diffuse" && p.kind != "area" {
        return Err(p.unsupported_kind("diffuse"));
    }
    let radiance = scaled(&mut p, "L")?;
    let two_sided = p.flag("twosided")?.unwrap_or(false);
    let samples = samples(&mut p)?;
    p.finish(&[], warnings)?;
    Ok((Emission { radiance, two_sided, visibility: EmitterVisibility::Sampled }, samples))
}

/// Light along `from` → `to`. What pbrt calls its radiance L is the irradiance of a surface that faces it.
fn distant(p: &mut Params, to_world: &DMat4) -> Result<Light> {
    let irradiance = scaled(p, "L")?;
    let [from, to] = [corner(p, "from")?.unwrap_or(DVec3::ZERO), corner(p, "to")?.unwrap_or(DVec3::Z)];
    let direction = to_world.transform_vector3(to - from).try_normalize();
    let direction = direction.ok_or_else(|| p.at.input(format!("{} needs from and to apart", p.owner)))?;
    Ok(Light::Directional { direction: direction.as_vec3(), irradiance })
}

fn point(p: &mut Params, to_world: &DMat4) -> Result<Light> {
    let intensity = scaled(p, "I")?;
    let at = p.place("from");
    let from = corner(p, "from")?.unwrap_or(DVec3::ZERO);
    // pbrt-v2 and v3 add the point to the transform's place in the world; v4 transforms it.
    let (added, transformed) = (to_world.w_axis.truncate() + from, to_world.transform_point3(from));
    if !added.abs_diff_eq(transformed, 1e-6 * from.length()) {
        return Err(at
            .unsupported("a point that the transform turns or scales lies elsewhere in pbrt-v3 than in v4")
            .with_hint("write the place as a Translate, without from"));
    }
    if !in_range(transformed) {
        return Err(at.input(format!("a light at {transformed} is out of range")));
    }
    let position = transformed.as_vec3();
    Ok(Light::Point { position, intensity, falloff: Falloff::InverseSquare })
}

fn corner(p: &mut Params, name: &'static str) -> Result<Option<DVec3>> {
    Ok(p.numbers::<3>(name, &["point", "point3"], |_| true, "a number")?.map(DVec3::from_array))
}

/// A colour of light, white unless the file says otherwise, times `scale`: a colour in pbrt-v2 and v3, a number in v4.
fn scaled(p: &mut Params, name: &'static str) -> Result<Rgb> {
    let (valid, rule) = (|x: f64| (0.0..=1e30).contains(&x), "from 0 to 1e30");
    let colour = p.rgb(name, valid, rule)?.unwrap_or(Rgb::ONE);
    let scale = if p.has_type("scale", "float") {
        p.float("scale", valid, rule)?.map(|x| Rgb::splat(x as f32))
    } else {
        p.rgb("scale", valid, rule)?
    };
    let product = colour * scale.unwrap_or(Rgb::ONE);
    if product.is_finite() { Ok(product) } else { Err(p.at.input(format!("{name} times scale is out of range"))) }
}

/// pbrt-v3 calls it "samples", and takes the older name too.
fn samples(p: &mut Params) -> Result<u32> {
    let samples = p.integer("nsamples", 1..=MAX_SAMPLES)?;
    Ok(p.integer("samples", 1..=MAX_SAMPLES)?.or(samples).unwrap_or(1))
}

fn infinite(
    mut p: Params,
    to_world: &DMat4,
    folder: &Path,
    options: &PbrtOptions,
    warnings: &mut Vec<String>,
) -> Result<Source> {
    let Some((rotation, _)) = transform::similarity(to_world) else {
        return Err(p.at.unsupported("a light that its transform distorts is not supported"));
    };
    let scale = scaled(&mut p, "L")?;
    let samples = samples(&mut p)?;
    let file = MapFile::named_by(&mut p)?;
    let at = p.at.clone();
    p.finish(&[], warnings)?;
    let (map, source) = match (file, &options.environment) {
        (Some(_), Some((map, source))) => (map.clone(), source.clone()),
        (Some(file), None) => {
            let image = file.load(folder, options, warnings)?;
            check_range(&folder.join(&file.name), &image)?;
            (Arc::new(EnvMap::new(image)), file.name)
        }
        (None, given) => {
            if given.is_some() {
                warnings.push(at.warning("this light has no map: the given environment is not used"));
            }
            (Arc::new(EnvMap::new(Image::from_pixels(1, 1, vec![Rgb::ONE]))), "constant".into())
        }
    };
    let largest = map.found().max * scale.max_element();
    if largest > MAX_RADIANCE {
        return Err(at.input(format!("L times scale and the map reaches {largest:e}, more than {MAX_RADIANCE:e}")));
    }
    Ok(Source::Infinite(Environment { map, source, scale, to_world: rotation * MAP_TO_LIGHT }, samples))
}

/// The image file of an environment light.
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
