//! Scenes as text of pbrt-v4.

use super::{Aside, numbers, scaled_map, told_scale, unsupported};
use crate::bsdf::Bsdf;
use crate::envmap::equal_area;
use crate::error::Result;
use crate::math::Rgb;
use crate::scene::{
    Camera, Conductor, Dielectric, Distribution, Environment, Material, Object, Projection, Request, SMOOTH_ALPHA,
    Scene, Shape,
};
use glam::{DMat3, DMat4, DQuat, DVec3};
use std::fmt::Write;

/// The scene file.
pub fn text(scene: &Scene, request: &Request, aside: &mut Aside) -> Result<String> {
    let Request { width, height, spp, max_depth, .. } = request;
    let mut text = format!("# The scene {} of etalon{}\n", scene.name, told_scale(scene));
    text += &camera(&scene.camera);
    text += &format!(
        "Film \"rgb\" \"integer xresolution\" {width} \"integer yresolution\" {height} \"string filename\" \"{}.exr\"\n\
         PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\n\
         Sampler \"independent\" \"integer pixelsamples\" {spp}\n\
         Integrator \"path\" \"integer maxdepth\" {max_depth}\nWorldBegin\n",
        aside.stem
    );
    if let Some(environment) = &scene.environment {
        text += &light(environment, aside);
    }
    for object in &scene.objects {
        text += "AttributeBegin\n";
        text += &material(scene, object, aside)?;
        if let Some(emission) = object.emission {
            let two_sided = emission.two_sided;
            text += &format!(
                "AreaLightSource \"diffuse\" \"rgb L\" {} \"bool twosided\" {two_sided}\n",
                rgb(emission.radiance)
            );
        }
        text += &shape(object, aside);
        text += "AttributeEnd\n";
    }
    Ok(text)
}

fn rgb(colour: Rgb) -> String {
    format!("[ {} ]", numbers(colour.to_array(), " "))
}

fn matrix(m: DMat4) -> String {
    format!("[ {} ]", numbers(m.to_cols_array(), " "))
}

/// Camera space has x to the right, y up and z ahead. The field of view is that of the shorter side.
fn camera(camera: &Camera) -> String {
    let axes = [camera.right, camera.up, camera.forward].map(|axis| axis.extend(0.0));
    let to_world = DMat4::from_cols(axes[0], axes[1], axes[2], camera.position.extend(1.0));
    let kind = match camera.projection {
        Projection::Orthographic { half_width: w, half_height: h } => {
            format!("\"orthographic\" \"float screenwindow\" [ {} ]", numbers([-w, w, -h, h], " "))
        }
        Projection::Perspective { tan_half_width, tan_half_height } => {
            format!("\"perspective\" \"float fov\" {}", 2.0 * tan_half_width.min(tan_half_height).atan().to_degrees())
        }
    };
    format!("Transform {}\nCamera {kind}\n", matrix(to_world.inverse()))
}

/// A square map of as many rows as the lat-long map has columns: its texels are about as large as those at the horizon.
fn light(environment: &Environment, aside: &mut Aside) -> String {
    let map = scaled_map(environment);
    aside.note("the environment map is resampled to a square equal-area map: edges of its texels are blurred");
    let name = aside.map(equal_area::from_lat_long(&map, map.width()));
    // Row 0 of our maps is at +y, the pole of pbrt's at +z.
    let to_world = environment.to_world * DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);
    let transform = matrix(DMat4::from_mat3(to_world));
    format!(
        "AttributeBegin\nConcatTransform {transform}\nLightSource \"infinite\" \"string filename\" \"{name}\"\nAttributeEnd\n"
    )
}

fn material(scene: &Scene, object: &Object, aside: &mut Aside) -> Result<String> {
    let refuse = |what| Err(unsupported(scene, what));
    Ok(match &object.material {
        Material::Diffuse { albedo } => format!("Material \"diffuse\" \"rgb reflectance\" {}\n", rgb(*albedo)),
        // A conductor of reflectance 1 reflects as much at every angle; at others it would not.
        Material::Mirror { reflectance } if *reflectance == Rgb::ONE => {
            aside.note("pbrt's conductor of reflectance 1, which stands for a mirror, reflects 0.9999 head-on");
            "Material \"conductor\" \"rgb reflectance\" [ 1 1 1 ]\n".to_owned()
        }
        Material::Mirror { .. } => return refuse("a mirror whose reflectance is not 1"),
        Material::Dielectric(glass) if *glass == Dielectric::clear(glass.eta) => {
            format!("Material \"dielectric\" \"float eta\" {}\n", glass.eta)
        }
        Material::Dielectric(_) => return refuse("glass that is rough or coloured"),
        Material::Conductor(metal) => {
            let Conductor { eta, k, alpha: [u, v], distribution, two_sided, multiple_scattering } = *metal;
            if multiple_scattering {
                return refuse("metal with multiple scattering");
            }
            if u.min(v) >= SMOOTH_ALPHA && distribution != Distribution::Ggx {
                return refuse("metal of Beckmann microfacets (pbrt-v4 has GGX alone)");
            }
            if !two_sided && !matches!(object.shape, Shape::Sphere(_)) {
                return refuse("metal that reflects on one side alone");
            }
            format!(
                "Material \"conductor\" \"rgb eta\" {} \"rgb k\" {} \"float uroughness\" {u} \"float vroughness\" {v} \
                 \"bool remaproughness\" false\n",
                rgb(eta),
                rgb(k)
            )
        }
        Material::Refraction { .. } => return refuse("a surface that refracts without reflecting"),
        Material::Bsdf(bsdf) => match &**bsdf {
            Bsdf::ThinDielectric(slab) => {
                format!("Material \"thindielectric\" \"float eta\" {}\n", slab.eta)
            }
            other => return refuse(&format!("the material {}", other.name())),
        },
        Material::Mixture(_) => return refuse("a mixture of materials"),
        Material::Textured(_) => return refuse("a textured material"),
    })
}

fn shape(object: &Object, aside: &mut Aside) -> String {
    match &object.shape {
        Shape::Sphere(sphere) => {
            let turn = DQuat::from_rotation_arc(DVec3::Z, object.axis.as_dvec3());
            let to_world = DMat4::from_rotation_translation(turn, sphere.centre.as_dvec3());
            format!("ConcatTransform {}\nShape \"sphere\" \"float radius\" {}\n", matrix(to_world), sphere.radius)
        }
        Shape::Rectangle(rectangle) => {
            let mut corners = String::new();
            for corner in rectangle.corners() {
                write!(corners, "{}  ", numbers(corner.to_array(), " ")).expect("strings can be written to");
            }
            format!("Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point3 P\" [ {corners}]\n")
        }
        Shape::Mesh(mesh) => format!("Shape \"plymesh\" \"string filename\" \"{}\"\n", aside.mesh(mesh)),
    }
}
