//! Lights: environment maps, directional, point and area lights.

use super::params::Params;
use super::reader::Reader;
use super::setup::MAX_SAMPLES;
use crate::envmap::{EnvMap, MAX_RADIANCE, check_range, equal_area};
use crate::error::Result;
use crate::import::place::{ANY, At, LIGHT, quote};
use crate::import::transform::{self, in_range};
use crate::math::Rgb;
use crate::memory;
use crate::raster::{Image, ReadOptions, read_lat_long, read_with_notes};
use crate::scene::{Emission, EmitterVisibility, Environment, Falloff, Light};
use glam::{DMat3, DMat4, DVec3};
use std::sync::Arc;

/// Takes directions of an upright map (row 0 at +y) to pbrt's light space, where row 0 is at +z and u runs from +x to
/// +y: (sin θ cos φ, cos θ, sin θ sin φ) → (sin θ cos φ, sin θ sin φ, cos θ).
const MAP_TO_LIGHT: DMat3 = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);

impl Reader<'_> {
    pub(super) fn light(&mut self, p: &Params) -> Result<()> {
        let light = match p.kind.as_str() {
            "infinite" => return self.infinite(p),
            "distant" => distant(p, &self.state.transform)?,
            "point" => point(p, &self.state.transform)?,
            _ => return Err(p.unsupported_kind("infinite, distant, point")),
        };
        memory::push(&mut self.lights, light, || p.at.to_string())?;
        p.finish(&["nsamples", "samples"], &mut self.warnings)
    }

    /// `AreaLightSource`: the emission of shapes.
    pub(super) fn area_light(&mut self, p: &Params) -> Result<()> {
        // pbrt-v2 also calls it "area".
        if p.kind != "diffuse" && p.kind != "area" {
            return Err(p.unsupported_kind("diffuse"));
        }
        let (radiance, two_sided) = (scaled(p, "L", 1.0)?, p.flag("twosided")?.unwrap_or(false));
        self.state.emission = Some(Emission { radiance, two_sided, visibility: EmitterVisibility::Sampled });
        self.ask_for_samples(p)?;
        p.finish(&[], &mut self.warnings)
    }

    fn infinite(&mut self, p: &Params) -> Result<()> {
        if self.environment.is_some() {
            return Err(p.at.unsupported(format!("{}: a second light from infinity is not supported", p.owner)));
        }
        let Some((rotation, _)) = transform::similarity(&self.state.transform) else {
            return Err(p.at.unsupported("a light that its transform distorts is not supported"));
        };
        let scale = scaled(p, "L", times(p, "illuminance", std::f64::consts::PI)?)?;
        self.ask_for_samples(p)?;
        let map_name = map_name(p)?;
        if map_name.is_some() && p.has_type("illuminance", "float") {
            let message = format!("{}: the illuminance of a light with a map is not supported", p.owner);
            return Err(p.place("illuminance").unsupported(message));
        }
        let (map, source) = match (map_name, &self.options.environment) {
            (Some(_), Some((map, source))) => (map.clone(), source.clone()),
            (Some((parameter, name)), None) => {
                (Arc::new(EnvMap::new(self.map(name, parameter, p.place(parameter))?)), name.into())
            }
            (None, given) => {
                if given.is_some() {
                    self.warnings.push(p.at.warning("this light has no map: the given environment is not used"));
                }
                (Arc::new(EnvMap::new(Image::from_pixels(1, 1, vec![Rgb::ONE]))), "constant".into())
            }
        };
        let largest = map.found().max * scale.max_element();
        if largest > MAX_RADIANCE {
            return Err(p
                .at
                .input(format!("L times scale and the map reaches {largest:e}, more than {MAX_RADIANCE:e}")));
        }
        self.environment = Some(Environment { map, source, scale, to_world: rotation * MAP_TO_LIGHT });
        p.finish(&[], &mut self.warnings)
    }

    /// The map that `parameter` names.
    fn map(&mut self, name: &str, parameter: &str, at: &At) -> Result<Image> {
        let path = self.folder.join(name);
        let reader = if parameter == EQUAL_AREA { read_with_notes } else { read_lat_long };
        let read = reader(&path, ReadOptions { allow_ldr: self.options.allow_ldr, ..ReadOptions::default() });
        let (mut image, notes) =
            read.map_err(|e| at.cannot_read(e).with_hint("`environment` stands in for the map that the scene names"))?;
        self.warnings.extend(notes);
        check_range(&path, &image)?;
        if parameter == EQUAL_AREA {
            let (width, height) = (image.width(), image.height());
            if width == height {
                self.warnings.push(at.warning("this equal-area map is resampled to a lat-long map"));
                image = equal_area::to_lat_long(&image);
            } else if width == 2 * height {
                self.warnings.push(at.warning("this map is twice as wide as high: taken as lat-long, not equal-area"));
            } else {
                let what = format!("the map {} ({width} x {height}) is neither square (equal-area)", quote(name));
                return Err(at.unsupported(format!("{what} nor twice as wide as high (lat-long)")));
            }
        }
        Ok(image)
    }

    /// Notes how many samples a light asks for ("samples" is pbrt-v3's word): all lights get as many as the one that asks
    /// for most.
    fn ask_for_samples(&mut self, p: &Params) -> Result<()> {
        let older = p.integer("nsamples", 1..=MAX_SAMPLES)?;
        let samples = p.integer("samples", 1..=MAX_SAMPLES)?.or(older).unwrap_or(1);
        let before = self.light_samples.unwrap_or(samples);
        let most = before.max(samples);
        if before != samples {
            self.warnings.push(p.at.warning(&format!("lights ask for {before} and {samples} samples: all get {most}")));
        }
        self.light_samples = Some(most);
        Ok(())
    }
}

/// pbrt-v4's own parameter for a map, which is equal-area and square; `mapname` is lat-long in every version.
const EQUAL_AREA: &str = "filename";

/// The parameter that names the map of an environment light, and the name.
fn map_name(p: &Params) -> Result<Option<(&'static str, &str)>> {
    match (p.text("mapname")?, p.text(EQUAL_AREA)?) {
        (Some(_), Some(_)) => Err(p.place(EQUAL_AREA).input(format!("{} has both a mapname and a filename", p.owner))),
        (lat_long, equal_area) => {
            let named = lat_long.map(|name| ("mapname", name)).or(equal_area.map(|name| (EQUAL_AREA, name)));
            Ok(named.filter(|(_, name)| !name.is_empty()))
        }
    }
}

/// Light along `from` → `to`. What pbrt calls its radiance L is the irradiance of a surface that faces it.
fn distant(p: &Params, to_world: &DMat4) -> Result<Light> {
    let irradiance = scaled(p, "L", times(p, "illuminance", 1.0)?)?;
    let [from, to] = [corner(p, "from")?.unwrap_or(DVec3::ZERO), corner(p, "to")?.unwrap_or(DVec3::Z)];
    let direction = to_world.transform_vector3(to - from).try_normalize();
    let direction = direction.ok_or_else(|| p.at.input(format!("{} needs from and to apart", p.owner)))?;
    Ok(Light::Directional { direction: direction.as_vec3(), irradiance })
}

fn point(p: &Params, to_world: &DMat4) -> Result<Light> {
    let intensity = scaled(p, "I", times(p, "power", 4.0 * std::f64::consts::PI)?)?;
    let from = corner(p, "from")?.unwrap_or(DVec3::ZERO);
    // pbrt-v2 and v3 add the point to the transform's place in the world; v4 transforms it.
    let (added, transformed) = (to_world.w_axis.truncate() + from, to_world.transform_point3(from));
    if !added.abs_diff_eq(transformed, 1e-6 * from.length()) {
        return Err(p
            .place("from")
            .unsupported("a point that the transform turns or scales lies elsewhere in pbrt-v3 than in v4")
            .with_hint("write the place as a Translate, without from"));
    }
    if !in_range(transformed) {
        return Err(p.place("from").input(format!("a light at {transformed} is out of range")));
    }
    let position = transformed.as_vec3();
    Ok(Light::Point { position, intensity, falloff: Falloff::InverseSquare })
}

fn corner(p: &Params, name: &'static str) -> Result<Option<DVec3>> {
    Ok(p.numbers::<3>(name, &["point", "point3"], &ANY)?.map(DVec3::from_array))
}

/// What pbrt-v4's `power` or `illuminance` multiplies the light by: its amount over that of a light of radiance or intensity 1.
/// Like pbrt, it leaves L, I and scale in effect. Without it, or with a value of 0: 1.
fn times(p: &Params, name: &'static str, of_one: f64) -> Result<f32> {
    Ok(p.float(name, &LIGHT)?.filter(|&amount| amount > 0.0).map_or(1.0, |amount| (amount / of_one) as f32))
}

/// A colour of light, white unless the file says otherwise, times `scale` (a colour in pbrt-v2 and v3, a number in v4) and
/// `times`.
fn scaled(p: &Params, name: &'static str, times: f32) -> Result<Rgb> {
    let colour = p.rgb(name, &LIGHT)?.unwrap_or(Rgb::ONE);
    let scale = if p.has_type("scale", "float") {
        p.float("scale", &LIGHT)?.map(|x| Rgb::splat(x as f32))
    } else {
        p.rgb("scale", &LIGHT)?
    };
    let product = colour * scale.unwrap_or(Rgb::ONE) * times;
    if product.is_finite() { Ok(product) } else { Err(p.at.input(format!("{name} times scale is out of range"))) }
}
