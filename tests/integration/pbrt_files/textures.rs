//! `Texture`, and the parameters that name one.

use super::*;
use etalon::scene::{RoughnessScale, Texture, Textured, UvMapping, Wrap};
use glam::{DVec2, Vec2};

/// The textures of the first object.
fn textured(world: &str) -> Textured {
    match read(&in_world(world)).unwrap().scene.objects.remove(0).material {
        Material::Textured(textured) => (*textured).clone(),
        other => panic!("{other:?}"),
    }
}

/// The reflectance that a spectrum texture named "t" gives a surface.
fn reflectance(declaration: &str) -> Texture {
    let world = format!(
        "Texture \"t\" \"spectrum\" {declaration} Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""
    );
    textured(&world).reflectance.unwrap()
}

/// A scene beside an image of 2 × 1 texels, black and white, except for the code 51 of red.
fn with_image(name: &str, bytes: &[u8], world: &str) -> Result<Imported> {
    read_files(&[("scene.pbrt", in_world(world).as_bytes()), (name, bytes)])
}

fn ppm() -> Vec<u8> {
    [&b"P6 2 1 255\n"[..], &[51, 0, 0, 255, 255, 255]].concat()
}

fn image_of(imported: &Imported) -> Texture {
    match &imported.scene.objects[0].material {
        Material::Textured(textured) => textured.reflectance.clone().unwrap(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn checkerboards_products_and_mixes() {
    let board = reflectance(
        "\"checkerboard\" \"rgb tex1\" [.1 .2 .3] \"float uscale\" 4 \"float vscale\" 2 \"float udelta\" 1",
    );
    let mapping = UvMapping { scale: DVec2::new(4.0, 2.0), offset: DVec2::X };
    let squares = Arc::new([Texture::Constant(Rgb::new(0.1, 0.2, 0.3)), Texture::Constant(Rgb::ZERO)]);
    assert_eq!(board, Texture::Checkerboard { mapping, textures: squares });
    let first =
        "Texture \"a\" \"spectrum\" \"checkerboard\" Texture \"f\" \"float\" \"checkerboard\" \"float tex2\" .5";
    let of = |declaration: &str| {
        let world = format!(
            "{first} Texture \"t\" \"color\" {declaration} Material \"matte\" \"texture Kd\" \"t\" Shape \"sphere\""
        );
        textured(&world).reflectance.unwrap().at(Vec2::new(1.5, 0.5)).x
    };
    for (declaration, expected) in [
        ("\"scale\" \"texture tex\" \"a\" \"float scale\" .5", 0.0),
        ("\"scale\" \"rgb tex\" [.5 .5 .5] \"texture scale\" \"f\"", 0.25),
        ("\"scale\" \"rgb tex1\" [.5 .5 .5] \"rgb tex2\" [.5 .5 .5]", 0.25),
        ("\"mix\" \"texture tex1\" \"a\" \"rgb tex2\" [.8 .8 .8] \"float amount\" .25", 0.2),
        ("\"mix\" \"rgb tex1\" [.2 .2 .2] \"rgb tex2\" [.8 .8 .8] \"texture amount\" \"f\"", 0.5),
        ("\"constant\" \"texture value\" \"a\"", 0.0),
    ] {
        let found = of(declaration);
        assert!((found - expected).abs() < 1e-6, "{declaration}: {found}");
    }
}

#[test]
fn constant_textures_are_numbers() {
    let world = |material: &str| {
        format!(
            "Texture \"c\" \"spectrum\" \"constant\" \"rgb value\" [.25 .5 1] Texture \"r\" \"float\" \"constant\" \"float value\" .25
             Material {material} Shape \"sphere\""
        )
    };
    let material = |text: &str| read(&in_world(&world(text))).unwrap().scene.objects.remove(0).material;
    let albedo = Rgb::new(0.25, 0.5, 1.0);
    assert_eq!(material("\"diffuse\" \"texture reflectance\" \"c\""), Material::Diffuse { albedo });
    let glass = Dielectric { alpha: [0.5; 2], ..Dielectric::clear(1.5) };
    assert_eq!(material("\"dielectric\" \"texture roughness\" \"r\""), Material::Dielectric(glass));
}

#[test]
fn images_are_read_once_and_as_they_say() {
    let world = |parameters: &str| {
        format!(
            "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.ppm\" {parameters}
             Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\" Shape \"sphere\""
        )
    };
    let red = |parameters: &str| {
        let imported = with_image("t.ppm", &ppm(), &world(parameters)).unwrap();
        let Texture::Image(image) = image_of(&imported) else { panic!("not an image") };
        (Texture::Image(image.clone()).at(Vec2::new(0.25, 0.5)).x, image.wrap, imported.warnings.len())
    };
    // 0.2 by the sRGB curve is 0.0331.
    let (srgb, wrap, warnings) = red("");
    assert!((srgb - 0.033_104_8).abs() < 1e-6, "{srgb}");
    assert_eq!((wrap, warnings), (Wrap::Repeat, 0));
    for (parameters, expected) in [
        ("\"string encoding\" \"linear\"", 0.2),
        ("\"string encoding\" \"sRGB\"", srgb),
        ("\"bool gamma\" false", 0.2),
        ("\"string encoding\" \"linear\" \"float scale\" .5 \"bool invert\" true", 0.9),
    ] {
        assert_eq!(red(parameters).0, expected, "{parameters}");
    }
    // A number is the mean of the channels.
    let float = "Texture \"f\" \"float\" \"imagemap\" \"string filename\" \"t.ppm\" \"string encoding\" \"linear\"
                 Texture \"t\" \"spectrum\" \"scale\" \"rgb tex\" [1 1 1] \"texture scale\" \"f\"
                 Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"";
    let value = image_of(&with_image("t.ppm", &ppm(), float).unwrap()).at(Vec2::new(0.25, 0.5));
    assert!((value - Rgb::splat(0.2 / 3.0)).abs().max_element() < 1e-6, "{value}");
    assert_eq!(red("\"string wrap\" \"clamp\"").1, Wrap::Clamp);
    assert_eq!(red("\"string wrap\" \"black\" \"string filter\" \"trilinear\"").1, Wrap::Black);
    assert_eq!(red("\"string filter\" \"trilinear\"").2, 1, "a warning");
    let board = "Texture \"b\" \"spectrum\" \"imagemap\" \"string filename\" \"t.ppm\"";
    let imported = with_image("t.ppm", &ppm(), &format!("{board} {}", world(""))).unwrap();
    let images = imported.scene.objects.iter().map(|object| match &object.material {
        Material::Textured(textured) => textured.clone(),
        other => panic!("{other:?}"),
    });
    let [a, b] = <[_; 2]>::try_from(images.collect::<Vec<_>>()).unwrap();
    assert!(Arc::ptr_eq(&a, &b), "shapes share a material");
}

#[test]
fn images_of_every_format() {
    let tga = [&[0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 24, 0][..], &[0, 0, 51, 255, 255, 255]].concat();
    let pfm = [&b"PF\n2 1\n-1\n"[..], &[0.25f32, 0.5, 0.75, 1.0, 1.0, 1.0].map(f32::to_le_bytes).concat()].concat();
    for (name, bytes, expected) in [
        ("t.ppm", ppm(), 0.033_104_8),
        ("t.tga", tga.clone(), 0.033_104_8),
        ("t.TGA", tga, 0.033_104_8),
        ("t.pfm", pfm, 0.25),
    ] {
        let world = format!(
            "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"{name}\"
             Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""
        );
        let found = image_of(&with_image(name, &bytes, &world).unwrap()).at(Vec2::new(0.25, 0.5)).x;
        assert!((found - expected).abs() < 1e-6, "{name}: {found}");
    }
}

#[test]
fn materials_take_textures() {
    let declared =
        "Texture \"c\" \"spectrum\" \"checkerboard\" Texture \"r\" \"float\" \"checkerboard\" \"float tex2\" .25";
    let of = |material: &str| textured(&format!("{declared} Material {material} Shape \"sphere\""));
    for (material, reflects, transmits) in [
        ("\"matte\" \"texture Kd\" \"c\"", true, false),
        ("\"coateddiffuse\" \"texture reflectance\" \"c\"", true, false),
        ("\"mirror\" \"texture Kr\" \"c\"", true, false),
        ("\"glass\" \"texture Kt\" \"c\"", false, true),
        ("\"dielectric\" \"texture roughness\" \"r\"", false, false),
        ("\"conductor\" \"texture roughness\" \"r\"", false, false),
    ] {
        let textured = of(material);
        assert_eq!(
            (textured.reflectance.is_some(), textured.transmittance.is_some()),
            (reflects, transmits),
            "{material}"
        );
        assert_eq!(textured.alpha.is_some(), !reflects && !transmits, "{material}");
    }
    let alpha = |text: &str| of(text).alpha.unwrap().map(|alpha| alpha.at(Vec2::new(1.5, 0.5)).x);
    assert_eq!(alpha("\"conductor\" \"texture roughness\" \"r\""), [0.5; 2]);
    assert_eq!(alpha("\"conductor\" \"texture vroughness\" \"r\" \"float uroughness\" .01"), [0.1, 0.5]);
    assert_eq!(alpha("\"conductor\" \"texture roughness\" \"r\" \"bool remaproughness\" false"), [0.25; 2]);
    let v3 = RoughnessScale::Logarithmic.alpha(0.25) as f32;
    assert_eq!(alpha("\"metal\" \"texture roughness\" \"r\""), [v3; 2]);
    // Named materials and mixtures, too.
    let mixed = format!(
        "{declared} MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"texture reflectance\" \"c\"
         MakeNamedMaterial \"b\" \"string type\" \"mirror\" Material \"mix\" \"string materials\" [\"a\" \"b\"] Shape \"sphere\""
    );
    assert!(read(&in_world(&mixed)).unwrap().scene.objects[0].material.is_textured());
}

#[test]
fn meshes_keep_their_texture_coordinates() {
    let square = "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0]";
    let mesh = |uv: &str| {
        let world = format!(
            "Texture \"c\" \"spectrum\" \"checkerboard\" Material \"diffuse\" \"texture reflectance\" \"c\" {square} {uv}"
        );
        match &read(&in_world(&world)).unwrap().scene.objects[0].shape {
            Shape::Mesh(mesh) => (**mesh).clone(),
            other => panic!("{other:?}"),
        }
    };
    for (uv, expected) in [
        ("\"point2 uv\" [0 0 3 0 3 3 0 3]", Vec2::new(1.5, 0.75)),
        ("\"float st\" [0 0 3 0 3 3 0 3]", Vec2::new(1.5, 0.75)),
        ("", Vec2::new(0.5, 0.25)),
    ] {
        assert_eq!(mesh(uv).uv_at(0, 0.25, 0.25), expected, "{uv}");
    }
    let sphere = "Rotate 90 0 0 1 Texture \"c\" \"spectrum\" \"checkerboard\" Material \"diffuse\" Shape \"sphere\"";
    let [x, y] = read(&in_world(sphere)).unwrap().scene.objects[0].meridians;
    assert!(x.distance(Vec3::Y) < 1e-6 && y.distance(Vec3::NEG_X) < 1e-6, "{x} {y}");
}

#[test]
fn what_textures_cannot_be_is_refused_with_its_place() {
    let image = |parameters: &str| {
        format!("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.ppm\" {parameters}")
    };
    let bad = "Texture \"t\" \"float\" \"constant\" \"float value\" 2";
    for (world, message) in [
        ("Texture \"t\" \"spectrum\" \"fbm\"".into(), "Texture \"t\" \"fbm\""),
        ("Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"planar\"".into(), "the mapping \"planar\""),
        ("Texture \"t\" \"spectrum\" \"checkerboard\" \"integer dimension\" 3".into(), "only 2 dimensions"),
        ("Texture \"t\" \"point\" \"constant\"".into(), "the type \"point\""),
        (image("\"string wrap\" \"octahedralsphere\""), "wrap \"octahedralsphere\""),
        (image("\"string filter\" \"point\""), "filter \"point\""),
        (image("\"string encoding\" \"gamma 2.2\""), "encoding \"gamma 2.2\""),
        (image("\"float scale\" -1"), "\"float scale\" must be from 0"),
        (format!("{} Material \"diffuse\" \"texture reflectance\" \"t\"", image("\"float scale\" 3")), "values from 0 to 3"),
        (format!("{bad} Material \"dielectric\" \"texture roughness\" \"t\""), "values from 2 to 2"),
        (format!("{bad} Texture \"m\" \"spectrum\" \"mix\" \"texture amount\" \"t\""), "values from 2 to 2"),
        (format!("{bad} Material \"diffuse\" \"texture reflectance\" \"t\""), "no spectrum texture named \"t\""),
        ("Material \"diffuse\" \"texture reflectance\" \"none\"".into(), "no spectrum texture named \"none\""),
        ("Texture \"t\" \"spectrum\" \"imagemap\"".into(), "needs a \"string filename\""),
        ("Material \"diffuse\" \"texture displacement\" \"t\"".into(), "\"texture displacement\""),
        ("Material \"diffuse\" \"string normalmap\" \"t.png\"".into(), "\"string normalmap\""),
        ("Shape \"sphere\" \"texture alpha\" \"t\"".into(), "\"texture alpha\""),
        ("Texture \"r\" \"float\" \"checkerboard\" Material \"dielectric\" \"float eta\" 1 \"texture roughness\" \"r\"".into(), "an index apart from 1"),
    ] {
        let error = fails(with_image("t.ppm", &ppm(), &world), message).to_string();
        assert!(error.contains("scene.pbrt:7:"), "{error}");
    }
    // Each twice the one before: 2^40 look-ups.
    let doubled = (0..40).fold("Texture \"0\" \"spectrum\" \"checkerboard\"".to_owned(), |text, i| {
        format!("{text} Texture \"{}\" \"spectrum\" \"mix\" \"texture tex1\" \"{i}\" \"texture tex2\" \"{i}\"", i + 1)
    });
    fails(read(&in_world(&doubled)), "made of more than 64 textures");
}

#[test]
fn images_that_are_none_are_refused_with_their_name() {
    let header = |width: u16, height: u16| {
        let [w, h] = [width, height].map(u16::to_le_bytes);
        vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, w[0], w[1], h[0], h[1], 24, 0]
    };
    let pfm = |value: f32| [&b"PF\n1 1\n-1\n"[..], &[1.0, value, 0.0].map(f32::to_le_bytes).concat()].concat();
    for (name, bytes, message) in [
        ("huge.tga", header(65535, 65535), "65535x65535"),
        ("short.tga", header(4, 4), "short.tga"),
        ("zero.tga", header(0, 4), "zero.tga"),
        ("huge.ppm", b"P6 60000 60000 255\n".to_vec(), "60000x60000"),
        ("empty.png", Vec::new(), "the file is empty"),
        ("short.png", b"\x89PNG\r\n\x1a\n".to_vec(), "short.png"),
        ("nan.pfm", pfm(f32::NAN), "the pixel (0, 0)"),
        ("negative.pfm", pfm(-1.0), "the pixel (0, 0)"),
        ("text.jpg", b"hello".to_vec(), "text.jpg"),
    ] {
        let world = format!("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"{name}\"");
        let error = fails(with_image(name, &bytes, &world), message).to_string();
        assert!(error.contains(name), "{error}");
    }
    let missing = in_world("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"none.tga\"");
    let error = fails(read(&missing), "none.tga").to_string();
    assert!(error.contains("scene.pbrt:7:"), "{error}");
}
