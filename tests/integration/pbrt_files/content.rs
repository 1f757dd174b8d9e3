//! What stands in the world: shapes, materials and lights.

use super::*;
use etalon::bsdf::{Bsdf, CoatedDiffuse};
use glam::Vec2;

#[test]
fn lights_lie_as_pbrt_lays_them() {
    let light = |transform: &str| {
        let text = in_world(&format!("{transform} LightSource \"infinite\" \"string mapname\" \"m.exr\""));
        read(&text).unwrap().scene.environment.unwrap()
    };
    // pbrt's light space: row 0 at +z, u = 0 at +x, u = 1/4 at +y.
    let plain = light("");
    for (u, v, world) in [(0.0, 4.0, DVec3::X), (4.0, 4.0, DVec3::Y), (8.0, 4.0, DVec3::NEG_X), (0.0, 0.0, DVec3::Z)] {
        assert!((plain.to_world * plain.map.geometry().direction(u, v)).abs_diff_eq(world, 1e-15));
    }
    // Turned as in the first report's file: row 0 looks down, u = 0 along +x and u = 1/4 along +z.
    let turned = light("Rotate 90 1 0 0");
    assert_eq!(turned.radiance(DVec3::new(0.1, -1.0, 0.05)).y, 0.0);
    assert_eq!(turned.radiance(DVec3::new(1.0, 0.1, 0.1)).x, 0.0);
    assert_eq!(turned.radiance(DVec3::new(-0.1, 0.1, 1.0)).x, 4.0);
    // Uniform scale does not matter; a mirror image does.
    assert!(light("Scale 3 3 3 Rotate 90 1 0 0").to_world.abs_diff_eq(turned.to_world, 1e-15));
    assert!((light("Scale 1 1 -1").to_world * DVec3::Y).abs_diff_eq(DVec3::NEG_Z, 1e-15));
    fails(
        read(&in_world("Scale 1 2 1 LightSource \"infinite\"")),
        "scene.pbrt:7:13: a light that its transform distorts",
    );
}

#[test]
fn light_parameters_in_the_spelling_of_every_version() {
    let light = |parameters: &str| read(&in_world(&format!("LightSource \"infinite\" {parameters}")));
    let scale = |parameters: &str| light(parameters).unwrap().scene.environment.unwrap().scale;
    assert_eq!(scale(r#""color L" [2 4 8] "color scale" [1 .5 3]"#), Rgb::new(2.0, 2.0, 24.0));
    assert_eq!(scale(r#""rgb L" [2 4 8] "float scale" .5"#), Rgb::new(1.0, 2.0, 4.0));
    let constant = light("").unwrap().scene.environment.unwrap();
    assert_eq!((constant.map.image().pixels(), constant.scale), (&[Rgb::ONE][..], Rgb::ONE));
    let v4 = light(r#""string filename" "m.exr""#).unwrap();
    assert!(v4.warnings[0].contains("scene.pbrt:7:24: this map is twice as wide as high"), "{:?}", v4.warnings);
    fails(light(r#""string filename" "m.exr" "string mapname" "m.exr""#), "both a mapname and a filename");
}

/// The objects of a world.
fn objects(world: &str) -> Vec<Object> {
    read(&in_world(world)).unwrap().scene.objects
}

#[test]
fn meshes_have_their_outside_where_pbrt_has_it() {
    let p = "\"point P\" [0 0 0  1 0 0  1 1 0  0 1 0]";
    let quad = format!("Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] {p}");
    let front = |before: &str, after: &str| {
        let objects = objects(&format!("AreaLightSource \"diffuse\" {before} {quad} {after}"));
        match &objects[0].shape {
            Shape::Rectangle(rectangle) => rectangle.normal(),
            other => panic!("not a rectangle: {other:?}"),
        }
    };
    let (up, down) = ("\"normal N\" [0 0 1 0 0 2 0 0 1 0 0 1]", "\"normal N\" [0 0 -1 0 0 -1 0 0 -1 0 0 -1]");
    for (transform, after, normal) in [
        ("", "", Vec3::Z),
        ("ReverseOrientation", "", Vec3::NEG_Z),
        ("ReverseOrientation ReverseOrientation", "", Vec3::Z),
        // A mirror image of a shape has its outside outside.
        ("Scale 1 1 -1", "", Vec3::NEG_Z),
        ("Scale -1 1 1", "", Vec3::Z),
        ("Scale -1 1 1 ReverseOrientation", "", Vec3::NEG_Z),
        ("Rotate 90 1 0 0", "", Vec3::NEG_Y),
        ("", up, Vec3::Z),
        ("", down, Vec3::NEG_Z),
        ("Scale 1 1 -1", up, Vec3::NEG_Z),
        ("ReverseOrientation", up, Vec3::NEG_Z),
        ("AttributeBegin ReverseOrientation AttributeEnd", "", Vec3::Z),
    ] {
        assert_eq!(front(transform, after), normal, "{transform} {after}");
    }
    // The same in the words of pbrt-v4, and what is no rectangle.
    let v4 = quad.replace("point P", "point3 P");
    assert_eq!(objects(&quad)[0].shape, objects(&v4)[0].shape);
    let bent = objects(&quad.replace("0 1 0]", "0 1 1]"));
    let Shape::Mesh(mesh) = &bent[0].shape else { panic!("{bent:?}") };
    assert_eq!((mesh.positions.len(), mesh.triangles.as_slice()), (4, &[[0, 1, 2], [0, 2, 3]][..]));
    assert!(mesh.normals.is_empty(), "flat");
    let smooth = objects(&format!("Scale 1 2 1 Rotate 90 0 0 1 {quad} \"normal N\" [1 1 0 0 0 1 0 0 1 0 0 1]"));
    let Shape::Mesh(mesh) = &smooth[0].shape else { panic!("{smooth:?}") };
    // (1, 1, 0) turned to (-1, 1, 0); stretched in y, surfaces lean the other way.
    assert!(mesh.normals[0].abs_diff_eq(Vec3::new(-2.0, 1.0, 0.0).normalize(), 1e-6), "{}", mesh.normals[0]);
    assert_eq!(mesh.normals[1], Vec3::Z);
    for (turned, corners) in [("", [0, 1, 2]), ("ReverseOrientation ", [0, 2, 1])] {
        let shape = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1]";
        let one = objects(&format!("AreaLightSource \"diffuse\" {turned}{shape}"));
        let Shape::Mesh(mesh) = &one[0].shape else { panic!("{one:?}") };
        let uv = corners.map(|i| [Vec2::ZERO, Vec2::X, Vec2::Y][i as usize]);
        assert_eq!((&mesh.triangles[..], &mesh.uv[..], mesh.tangent(0)), (&[corners][..], &[uv][..], Some(Vec3::X)));
    }
}

#[test]
fn mesh_files_lie_beside_the_scene() {
    let ply = |corner: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement \
             face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n{corner}\n0 1 0\n4 0 1 2 3\n"
        )
    };
    let main = in_world("Include \"deep/a.pbrt\"");
    let a: &[u8] = b"Translate 0 0 3\nShape \"plymesh\" \"string filename\" \"deep/a.ply\"";
    let read = |corner: &str| {
        read_files(&[("m.pbrt", main.as_bytes()), ("deep/a.pbrt", a), ("deep/a.ply", ply(corner).as_bytes())])
    };
    let square = read("1 1 0").unwrap();
    let Shape::Rectangle(rectangle) = square.scene.objects[0].shape else { panic!("{square:?}") };
    assert_eq!((rectangle.centre(), rectangle.normal()), (Vec3::new(0.5, 0.5, 3.0), Vec3::Z));
    assert!(matches!(&read("1 1 1").unwrap().scene.objects[0].shape, Shape::Mesh(mesh) if mesh.positions[2].z == 4.0));
    fails(read("1 1 nan"), "a.ply:12:1: a vertex at");
}

#[test]
fn lamps_are_shapes_that_glow() {
    let emission = |parameters: &str| {
        let objects = objects(&format!("AreaLightSource \"diffuse\" {parameters} Shape \"sphere\""));
        objects[0].emission.unwrap()
    };
    let white = Emission { radiance: Rgb::ONE, two_sided: false, visibility: EmitterVisibility::Sampled };
    assert_eq!(emission(""), white);
    let bright = Emission { radiance: Rgb::new(2.0, 4.0, 8.0), two_sided: true, ..white };
    assert_eq!(emission("\"rgb L\" [4 8 16] \"float scale\" .5 \"bool twosided\" true"), bright);
    assert_eq!(emission("\"color L\" [1 1 2] \"color scale\" [2 4 4] \"bool twosided\" [\"true\"]"), bright);
    let text =
        "AttributeBegin AreaLightSource \"area\" Material \"mirror\" Shape \"sphere\" AttributeEnd Shape \"sphere\"";
    let both = objects(text);
    assert_eq!((both[0].emission, both[1].emission), (Some(white), None));
    assert_eq!(both[0].material, Material::Mirror { reflectance: Rgb::splat(0.9) });
    // The light that asks for the most samples decides.
    let direct =
        in_world("AreaLightSource \"diffuse\" \"integer nsamples\" 3\nLightSource \"infinite\" \"integer samples\" 7")
            .replace("\"path\"", "\"directlighting\"");
    let imported = read(&direct).unwrap();
    assert_eq!(imported.request.light_samples, 7);
    assert!(imported.warnings[0].contains("scene.pbrt:8:1: lights ask for 3 and 7 samples"), "{:?}", imported.warnings);
}

#[test]
fn lights_without_a_surface() {
    let lights = |text: &str| read(&in_world(text)).unwrap().scene.lights;
    let distant = "LightSource \"distant\" \"rgb L\" [1 2 3] \"point from\" [0 2 0] \"point to\" [0 0 0]";
    let down = Light::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::new(1.0, 2.0, 3.0) };
    assert_eq!(lights(distant), [down]);
    let turned = lights(&format!("Rotate 90 0 0 1 Scale 3 3 3 {distant} LightSource \"distant\" \"float scale\" 4"));
    let along = |direction, radiance: f32| Light::Directional { direction, irradiance: Rgb::splat(radiance) };
    assert_eq!(turned[0], Light::Directional { direction: Vec3::X, irradiance: Rgb::new(1.0, 2.0, 3.0) });
    assert_eq!(turned[1], along(Vec3::Z, 4.0));
    let point = |x: f32| {
        let (position, intensity) = (Vec3::new(x, 0.0, 1.0), Rgb::new(5.0, 0.0, 1.0));
        Light::Point { position, intensity, falloff: Falloff::InverseSquare }
    };
    let text = "LightSource \"point\" \"rgb I\" [5 0 1] \"point from\" [1 0 1]";
    assert_eq!(lights(&format!("{text} Translate 2 0 0 {text}")), [point(1.0), point(3.0)]);
    assert_eq!(lights("Rotate 30 0 1 0 Translate 1 2 3 LightSource \"point\"").len(), 1, "no from");
}

#[test]
fn materials_in_the_spelling_of_every_version() {
    let material = |text: &str| objects(&format!("Material {text} Shape \"sphere\""))[0].material.clone();
    assert_eq!(material("\"mirror\" \"rgb Kr\" [1 .5 0]"), Material::Mirror { reflectance: Rgb::new(1.0, 0.5, 0.0) });
    let glass = |eta| Material::Dielectric(Dielectric::clear(eta));
    for (text, eta) in [
        ("\"glass\"", 1.5),
        ("\"glass\" \"float index\" 1.25", 1.25),
        ("\"glass\" \"float eta\" 1.25 \"bool remaproughness\" false", 1.25),
        ("\"dielectric\"", 1.5),
        ("\"dielectric\" \"float eta\" 1.25 \"float roughness\" 0", 1.25),
    ] {
        assert_eq!(material(text), glass(eta), "{text}");
    }
    let (reflectance, transmittance) = (Rgb::splat(0.5), Rgb::new(1.0, 0.0, 0.0));
    let tinted = material("\"glass\" \"rgb Kr\" [.5 .5 .5] \"rgb Kt\" [1 0 0]");
    assert_eq!(tinted, Material::Dielectric(Dielectric { reflectance, transmittance, ..Dielectric::clear(1.5) }));
    let conductor = |text: &str| match material(text) {
        Material::Conductor(conductor) => conductor,
        other => panic!("{other:?}"),
    };
    let gold = conductor(
        "\"conductor\" \"rgb eta\" [.2 .4 1.3] \"rgb k\" [3 2 1] \"float roughness\" .25 \"bool remaproughness\" false \
         \"string distribution\" \"beckmann\"",
    );
    let (eta, k) = (Rgb::new(0.2, 0.4, 1.3), Rgb::new(3.0, 2.0, 1.0));
    assert_eq!(gold, Conductor { two_sided: true, ..Conductor::new(eta, k, 0.25, Distribution::Beckmann) });
    let v4 = conductor("\"conductor\" \"float uroughness\" .25 \"float vroughness\" .25");
    assert_eq!((v4.alpha, v4.distribution), ([0.5; 2], Distribution::Ggx), "the square root");
    assert_eq!(conductor("\"conductor\"").alpha, [0.0; 2]);
    let v3 = conductor("\"metal\" \"float roughness\" 1");
    assert_eq!((v3.alpha, v3.distribution), ([1.62142; 2], Distribution::Ggx), "the polynomial");
    assert!((conductor("\"metal\"").alpha[0] - 0.138_924).abs() < 1e-6, "0.01");
    // Copper where nothing is said, and metals by name; both are noted.
    let named = in_world("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\"");
    let warnings = read(&named).unwrap().warnings;
    assert!(warnings[0].contains("\"spectrum eta\" is taken at 614, 549, 466 nm"), "{warnings:?}");
    assert!(warnings[1].contains("no k: copper's"), "{warnings:?}");
    assert_eq!(conductor("\"conductor\" \"spectrum k\" \"metal-Ag-k\"").k, Rgb::new(4.1283, 3.5892, 2.8132));
}

#[test]
fn rough_surfaces_may_be_anisotropic() {
    let material = |text: &str| objects(&format!("Material {text} Shape \"sphere\""))[0].material.clone();
    let glass = |alpha| Material::Dielectric(Dielectric { alpha, ..Dielectric::clear(1.5) });
    for (text, expected) in [
        ("\"dielectric\" \"float roughness\" .25", glass([0.5; 2])),
        ("\"dielectric\" \"float uroughness\" .25 \"float roughness\" .01", glass([0.5, 0.1])),
        ("\"dielectric\" \"float vroughness\" .3 \"bool remaproughness\" false", glass([1e-4, 0.3])),
        ("\"glass\" \"float uroughness\" 1 \"float vroughness\" 1", glass([1.62142; 2])),
        ("\"glass\" \"float roughness\" 0 \"bool remaproughness\" true", glass([0.0; 2])),
    ] {
        assert_eq!(material(text), expected, "{text}");
    }
    let metal = "\"conductor\" \"float uroughness\" .25 \"float vroughness\" .04";
    let Material::Conductor(conductor) = material(metal) else { panic!("{metal}") };
    assert_eq!(conductor.alpha, [0.5, 0.2]);
    assert!(material(metal).is_anisotropic() && !material("\"conductor\"").is_anisotropic());
    // Tangents: a sphere's axis, texture coordinates, and pbrt's where there are none, also for the triangle of a mirror image.
    let axis = |turn: &str| objects(&format!("{turn} Material {metal} Shape \"sphere\""))[0].axis;
    assert_eq!((axis(""), axis("Rotate -90 1 0 0")), (Vec3::Z, Vec3::Y));
    let square = "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0]";
    let diagonal = Vec3::new(1.0, 1.0, 0.0).normalize();
    for (before, uv, tangents) in [
        ("", "", [Vec3::X, diagonal]),
        ("Scale 1 1 -1", "", [Vec3::X, diagonal]),
        ("", "\"point2 uv\" [0 0 0 1 1 1 1 0]", [Vec3::Y; 2]),
    ] {
        let made = objects(&format!("{before} Material {metal} {square} {uv}"));
        let Shape::Mesh(mesh) = &made[0].shape else { panic!("{made:?}") };
        for (triangle, expected) in tangents.into_iter().enumerate() {
            let tangent = mesh.tangent(triangle as u32).unwrap();
            assert!(tangent.distance(expected) < 1e-6, "{before} {uv}: {tangent}");
        }
    }
    assert!(matches!(objects(&format!("Material \"conductor\" {square}"))[0].shape, Shape::Rectangle(_)));
}

#[test]
fn coats_and_mixtures() {
    let coated = |albedo, eta| Material::from(Bsdf::CoatedDiffuse(CoatedDiffuse::new(albedo, eta)));
    let coat = |text: &str| {
        let imported = read(&in_world(&format!("Material \"coateddiffuse\" {text} Shape \"sphere\""))).unwrap();
        (imported.scene.objects[0].material.clone(), imported.warnings)
    };
    let (material, warnings) = coat("\"rgb reflectance\" [.25 .5 1] \"float eta\" 1.4 \"float thickness\" 0");
    assert_eq!(material, coated(Rgb::new(0.25, 0.5, 1.0), 1.4));
    assert!(!warnings.iter().any(|warning| warning.contains("coat")), "{warnings:?}");
    let (material, warnings) = coat("\"float roughness\" .1");
    assert_eq!(material, coated(Rgb::splat(0.5), 1.5));
    let about = |text: &str| warnings.iter().filter(|warning| warning.contains(text)).count();
    assert_eq!([about("taken as smooth"), about("1.98 %")], [1, 1], "{warnings:?}");

    let named =
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" \"mirror\"";
    let mixture = |amount: &str| {
        objects(&format!("{named} Material \"mix\" \"string materials\" [\"a\" \"b\"] {amount} Shape \"sphere\""))[0]
            .material
            .clone()
    };
    let (a, b) = (Material::Diffuse { albedo: Rgb::splat(0.5) }, Material::Mirror { reflectance: Rgb::splat(0.9) });
    for (amount, weight) in [("", 0.5), ("\"float amount\" .25", 0.25)] {
        assert_eq!(mixture(amount), Material::Mixture([(1.0 - weight, a.clone()), (weight, b.clone())].into()));
    }
}
