//! Materials: a geometry's binding is followed to its effect.

use super::document::{Document, Element, course_profile, elements, find, is};
use crate::error::{Error, Result};
use crate::import::number::{ANY, DIELECTRIC_INDEX, FRACTION, LIGHT, Rule};
use crate::math::Rgb;
use crate::scene::{Conductor, Dielectric, Distribution, Emission, EmitterVisibility, Material};

/// The material of a surface, and its emission.
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
