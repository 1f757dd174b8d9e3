//! Scenes as XML of Mitsuba 3, for its RGB variants.

use super::{Aside, numbers, scaled_map, told_scale, unsupported};
use crate::bsdf::Bsdf;
use crate::error::Result;
use crate::math::Rgb;
use crate::raster::Image;
use crate::scene::{
    Camera, Conductor, Dielectric, Distribution, Environment, Material, Object, Projection, Request, SMOOTH_ALPHA,
    Scene, Shape,
};
use glam::{DMat3, DMat4, DQuat, DVec3};

/// The scene file. Mitsuba counts the segments of a path, this program those after the camera's.
pub fn text(scene: &Scene, request: &Request, aside: &mut Aside) -> Result<String> {
    let Request { width, height, spp, max_depth, .. } = request;
    let mut text = format!(
        "<!-- The scene {} of etalon{} -->\n<scene version=\"3.0.0\">\n\
         <integrator type=\"path\"><integer name=\"max_depth\" value=\"{}\"/></integrator>\n",
        scene.name,
        told_scale(scene),
        max_depth.saturating_add(1)
    );
    text += &camera(
        &scene.camera,
        &format!(
            "<film type=\"hdrfilm\"><integer name=\"width\" value=\"{width}\"/><integer name=\"height\" value=\"{height}\"/>\
             <string name=\"pixel_format\" value=\"rgb\"/><string name=\"component_format\" value=\"float32\"/>\
             <rfilter type=\"box\"/></film>\n\
             <sampler type=\"independent\"><integer name=\"sample_count\" value=\"{spp}\"/></sampler>\n"
        ),
    );
    if let Some(environment) = &scene.environment {
        text += &light(environment, aside);
    }
    for object in &scene.objects {
        let mut inside = material(scene, &object.material, aside)?;
        if let Some(emission) = object.emission {
            if emission.two_sided {
                return Err(unsupported(scene, "a light that emits on both sides"));
            }
            inside += &format!("<emitter type=\"area\">{}</emitter>\n", rgb("radiance", emission.radiance));
        }
        text += &shape(object, &inside, aside);
    }
    Ok(text + "</scene>\n")
}

fn rgb(name: &str, colour: Rgb) -> String {
    format!("<rgb name=\"{name}\" value=\"{}\"/>", numbers(colour.to_array(), ", "))
}

fn float(name: &str, value: impl std::fmt::Display) -> String {
    format!("<float name=\"{name}\" value=\"{value}\"/>")
}

/// Mitsuba writes matrices row by row.
fn transform(to_world: DMat4) -> String {
    let rows = numbers(to_world.transpose().to_cols_array(), " ");
    format!("<transform name=\"to_world\"><matrix value=\"{rows}\"/></transform>\n")
}

/// Mitsuba's camera space has x to the left. Of parallel rays the film shows ±1 across.
fn camera(camera: &Camera, inside: &str) -> String {
    let (kind, view, scale) = match camera.projection {
        Projection::Orthographic { half_width, .. } => ("orthographic", String::new(), half_width),
        Projection::Perspective { tan_half_width, tan_half_height } => {
            let fov = 2.0 * tan_half_width.min(tan_half_height).atan().to_degrees();
            ("perspective", float("fov", fov) + "<string name=\"fov_axis\" value=\"smaller\"/>", 1.0)
        }
    };
    let axes = [-camera.right * scale, camera.up * scale, camera.forward].map(|axis| axis.extend(0.0));
    let to_world = DMat4::from_cols(axes[0], axes[1], axes[2], camera.position.extend(1.0));
    // Nothing is too near: parallel rays may start on a surface.
    let near = float("near_clip", "1e-6");
    format!("<sensor type=\"{kind}\">\n{view}{near}{}{inside}</sensor>\n", transform(to_world))
}

fn light(environment: &Environment, aside: &mut Aside) -> String {
    aside.note("Mitsuba interpolates between the texels of the environment map: edges of its texels are blurred");
    let name = aside.map(interpolated(&scaled_map(environment)));
    // Column 0 of our maps looks along +x and the next ones towards +z; of Mitsuba's, along -z and towards +x.
    let turn = DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::NEG_X);
    let to_world = transform(DMat4::from_mat3(environment.to_world * turn));
    format!("<emitter type=\"envmap\"><string name=\"filename\" value=\"{name}\"/>{to_world}</emitter>\n")
}

/// A map of constant texels for bilinear interpolation whose first and last rows are at the poles: twice the resolution,
/// with every other row on the edge between two texels. The irradiance is the same to second order.
fn interpolated(map: &Image) -> Image {
    let (width, height) = (map.width(), map.height());
    Image::from_fn(2 * width, 2 * height + 1, |x, y| {
        let row = |y: usize| map.get(x / 2, y.min(height - 1));
        // Row 2y is the upper edge of texel y.
        if y % 2 == 1 { row(y / 2) } else { 0.5 * (row((y / 2).saturating_sub(1)) + row(y / 2)) }
    })
}

fn material(scene: &Scene, material: &Material, aside: &mut Aside) -> Result<String> {
    let refuse = |what| Err(unsupported(scene, what));
    let two_sided = |bsdf: String| format!("<bsdf type=\"twosided\">{bsdf}</bsdf>\n");
    Ok(match material {
        Material::Diffuse { albedo } => {
            two_sided(format!("<bsdf type=\"diffuse\">{}</bsdf>", rgb("reflectance", *albedo)))
        }
        Material::Mirror { reflectance } => two_sided(format!(
            "<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/>{}</bsdf>",
            rgb("specular_reflectance", *reflectance)
        )),
        Material::Dielectric(glass) if *glass == Dielectric::clear(glass.eta) => {
            format!("<bsdf type=\"dielectric\">{}{}</bsdf>\n", float("int_ior", glass.eta), float("ext_ior", 1))
        }
        Material::Dielectric(_) => return refuse("glass that is rough or coloured"),
        Material::Conductor(metal) => {
            let Conductor { eta, k, alpha: [u, v], distribution, two_sided: both, multiple_scattering } = *metal;
            if multiple_scattering {
                return refuse("metal with multiple scattering");
            }
            let indices = rgb("eta", eta) + &rgb("k", k);
            let bsdf = if u.min(v) < SMOOTH_ALPHA {
                format!("<bsdf type=\"conductor\">{indices}</bsdf>\n")
            } else {
                aside.note(
                    "Mitsuba's rough conductor has separable masking and shadowing, not height-correlated: it is darker at \
                     grazing angles",
                );
                let name = match distribution {
                    Distribution::Ggx => "ggx",
                    Distribution::Beckmann => "beckmann",
                };
                let alpha = float("alpha_u", u) + &float("alpha_v", v);
                format!(
                    "<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"{name}\"/>{alpha}{indices}</bsdf>\n"
                )
            };
            if both { two_sided(bsdf) } else { bsdf }
        }
        Material::Refraction { .. } => return refuse("a surface that refracts without reflecting"),
        Material::Bsdf(bsdf) => match &**bsdf {
            Bsdf::ThinDielectric(slab) => {
                format!("<bsdf type=\"thindielectric\">{}{}</bsdf>\n", float("int_ior", slab.eta), float("ext_ior", 1))
            }
            other => return refuse(&format!("the material {}", other.name())),
        },
        Material::Mixture(_) => return refuse("a mixture of materials"),
        Material::Textured(_) => return refuse("a textured material"),
    })
}

fn shape(object: &Object, inside: &str, aside: &mut Aside) -> String {
    match &object.shape {
        Shape::Sphere(sphere) => {
            let turn = DQuat::from_rotation_arc(DVec3::Z, object.axis.as_dvec3());
            let to_world = transform(DMat4::from_rotation_translation(turn, sphere.centre.as_dvec3()));
            format!("<shape type=\"sphere\">{}{to_world}{inside}</shape>\n", float("radius", sphere.radius))
        }
        Shape::Rectangle(rectangle) => {
            // Mitsuba's rectangle is the square from -1 to 1.
            let [x, y] = rectangle.half_sides().map(|side| side.as_dvec3().extend(0.0));
            let normal = rectangle.normal().as_dvec3().extend(0.0);
            let to_world = DMat4::from_cols(x, y, normal, rectangle.centre().as_dvec3().extend(1.0));
            format!("<shape type=\"rectangle\">{}{inside}</shape>\n", transform(to_world))
        }
        Shape::Mesh(mesh) => {
            let (name, flat) = (aside.mesh(mesh), mesh.normals.is_empty());
            format!(
                "<shape type=\"ply\"><string name=\"filename\" value=\"{name}\"/>\
                 <boolean name=\"face_normals\" value=\"{flat}\"/>\n{inside}</shape>\n"
            )
        }
    }
}
