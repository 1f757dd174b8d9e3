//! Materials, where a geometry's binding is followed to its effect; lights, and which of them become visible objects.

use super::super::place::{ANY, DIELECTRIC_INDEX, FRACTION, LIGHT, Rule};
use super::super::transform::in_range;
use super::document::{Document, Element, course_profile, elements, find, is};
use crate::error::{Error, Result};
use crate::math::Rgb;
use crate::scene::{
    Conductor, Dielectric, Distribution, Emission, EmitterVisibility, Falloff, Light, Material, Object, Rectangle,
    Shape,
};
use glam::{DMat4, DVec3, Vec3};

pub type Surface = (Material, Option<Emission>);

const GREY: Surface = (Material::Diffuse { albedo: Rgb::splat(0.5) }, None);

/// The surface of an `<instance_geometry>`: one material for the whole of it, whatever symbol its faces name.
pub fn surface<'a>(document: &Document<'a>, instance: Element<'a>) -> Result<Surface> {
    let Some(binding) = find(instance, "bind_material/technique_common/instance_material") else {
        document.warn(instance, "no material: grey (0.5) is taken");
        return Ok(GREY);
    };
    if binding.next_sibling_element().is_some() {
        document.warn(binding, "several materials for one mesh: the first is taken for all of it");
    }
    let material = document.follow(binding, "target", "material")?;
    let effect = document.follow(document.require(material, "instance_effect")?, "url", "effect")?;
    if let Some(profile) = course_profile(effect) {
        return course_material(document, profile);
    }
    let common = find(effect, "profile_COMMON").and_then(|profile| {
        elements(profile).find(|child| is(*child, "technique") && child.attribute("sid") == Some("common"))
    });
    let Some(colour) = common.and_then(|technique| find(technique, "phong/diffuse/color")) else {
        document.warn(effect, "no phong/diffuse/color: grey (0.5) is taken");
        return Ok(GREY);
    };
    Ok((Material::Diffuse { albedo: document.colour(colour, &FRACTION)? }, None))
}

/// The course's own elements; the last one that is known counts.
fn course_material<'a>(document: &Document<'a>, profile: Element<'a>) -> Result<Surface> {
    let mut found = None;
    for node in elements(profile) {
        let colour = |name| document.colour(document.require(node, name)?, &FRACTION);
        let indices = |name| document.colour(document.require(node, name)?, &INDEX);
        let dielectric = |name| {
            let [eta] = document.exactly(document.require(node, name)?, &DIELECTRIC_INDEX)?;
            Ok::<_, Error>(eta as f32)
        };
        let material = match node.tag_name().name() {
            "emission" => {
                let node = document.require(node, "radiance")?;
                let radiance = document.colour(node, &LIGHT)?;
                // Visible only: in this dialect only lights illuminate.
                let emission = Emission { radiance, two_sided: true, visibility: EmitterVisibility::CameraOnly };
                found = Some((Material::Diffuse { albedo: Rgb::ZERO }, Some(emission)));
                continue;
            }
            "mirror" => Material::Mirror { reflectance: colour("reflectance")? },
            "refraction" => Material::Refraction { transmittance: colour("transmittance")?, eta: dielectric("ior")? },
            "glass" => Material::Dielectric(Dielectric {
                reflectance: colour("reflectance")?,
                transmittance: colour("transmittance")?,
                ..Dielectric::clear(dielectric("ior")?)
            }),
            "microfacet" => {
                let alpha = document.exactly(document.require(node, "alpha")?, &FRACTION)?;
                let (eta, k, [alpha]) = (indices("eta")?, indices("k")?, alpha.map(|alpha| alpha as f32));
                let distribution = Distribution::Beckmann;
                Material::Conductor(Conductor::new(eta, k, alpha, distribution))
            }
            other => {
                document.warn(node, &format!("<{other}> is no material that is known: left out"));
                continue;
            }
        };
        if let Some(roughness) = find(node, "roughness")
            && document.exactly(roughness, &ANY)? != [0.0]
        {
            document.warn(roughness, "<roughness> has no effect: this surface is smooth, as in the reference");
        }
        found = Some((material, None));
    }
    Ok(found.unwrap_or_else(|| {
        document.warn(profile, "no material that is known: grey (0.5) is taken");
        GREY
    }))
}

/// The parts of a metal's complex index.
const INDEX: Rule = Rule(|x| x > 0.0 && x <= 1000.0, "above 0 and at most 1000");

/// Largest distance between an area light and the emitting mesh that shows it, as a part of the light's diagonal.
const OVERLAP: f32 = 0.05;
/// Largest cosine between an area light's sides, or between its normal and its direction, that is no shear.
const SHEAR: f64 = 1e-4;

/// The light of a `<light>` element in a node; `None` for one that gives no light.
pub fn light<'a>(document: &Document<'a>, node: Element<'a>, to_world: &DMat4) -> Result<Option<Light>> {
    let technique = match course_profile(node) {
        Some(technique) => technique,
        None => document.require(node, "technique_common")?,
    };
    let kind = elements(technique).next().ok_or_else(|| document.at(technique).input("this light has no kind"))?;
    let colour = || document.colour(document.require(kind, "color")?, &LIGHT);
    let origin = to_world.w_axis.truncate();
    if !in_range(origin) {
        return Err(document.at(node).input(format!("a light at {origin} is out of range")));
    }
    Ok(match kind.tag_name().name() {
        "area" => {
            let rectangle = unit_square(to_world).ok_or_else(|| {
                document.at(node).unsupported("an area light that its transform makes no rectangle is not supported")
            })?;
            Some(Light::Rectangle { rectangle, radiance: colour()? })
        }
        "point" => Some(Light::Point { position: origin.as_vec3(), intensity: colour()?, falloff: Falloff::None }),
        "directional" => {
            let along = to_world.transform_vector3(DVec3::NEG_Z).try_normalize();
            let along = along.ok_or_else(|| document.at(node).input("this light's transform leaves no direction"))?;
            Some(Light::Directional { direction: along.as_vec3(), irradiance: colour()? })
        }
        // All zero in scenes that an environment map lights.
        "ambient" => Some(colour()?).filter(|&c| c != Rgb::ZERO).map(|radiance| Light::Hemisphere { radiance }),
        "spot" => {
            document.warn(kind, "a spot light is black in the reference renderer: left out");
            None
        }
        other => return Err(document.at(kind).unsupported(format!("a light of kind <{other}> is not supported"))),
    })
}

/// The square of side 1 around the origin that emits along −z, in the world.
fn unit_square(to_world: &DMat4) -> Option<Rectangle> {
    let [x, y, along] = [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z].map(|v| to_world.transform_vector3(v));
    let normal = x.cross(y).try_normalize()?;
    let cosine = normal.dot(along.try_normalize()?);
    // A mirror image emits to the opposite side of the cross product of its sides.
    let (x, y) = if cosine < 0.0 { (y, x) } else { (x, y) };
    let [centre, half_x, half_y] = [to_world.w_axis.truncate(), x * 0.5, y * 0.5].map(|v| v.as_vec3());
    Rectangle::new(centre, half_x, half_y).filter(|_| cosine.abs() > 1.0 - SHEAR)
}

/// Makes the area lights visible: one that no emitting mesh overlaps becomes an emitting object.
pub fn show_area_lights(lights: Vec<Light>, objects: &mut Vec<Object>) -> Vec<Light> {
    let emitting: Vec<[Vec3; 2]> =
        objects.iter().filter(|object| object.emission.is_some()).filter_map(|object| object.shape.bounds()).collect();
    let hidden = |light: &Light| {
        let Light::Rectangle { rectangle, radiance } = *light else { return true };
        let shape = Shape::Rectangle(rectangle);
        let Some([low, high]) = shape.bounds() else { return true };
        let near = OVERLAP * low.distance(high);
        if emitting.iter().any(|[a, b]| (low - near).cmple(*b).all() && (high + near).cmpge(*a).all()) {
            return true;
        }
        let emission = Some(Emission { radiance, two_sided: false, visibility: EmitterVisibility::Sampled });
        let material = Material::Diffuse { albedo: Rgb::ZERO };
        objects.push(Object { emission, ..Object::new(shape, material) });
        false
    };
    lights.into_iter().filter(hidden).collect()
}
