//! Spectra, units of light, flat shapes and options of pbrt-v4.

use super::*;

/// A scene of pbrt-v4 with the world on line 3.
fn v4(world: &str) -> Result<Imported> {
    read_with(world, &[])
}

fn read_with(world: &str, others: &[(&str, &[u8])]) -> Result<Imported> {
    let text =
        format!("Film \"rgb\" PixelFilter \"box\" Sampler \"random\" Integrator \"path\"\nWorldBegin\n{world}\n");
    let text = format!("Camera \"perspective\" {text}");
    read_files(&[&[("scene.pbrt", text.as_bytes())], others].concat())
}

/// The intensity of a point light with the parameters.
fn intensity(parameters: &str) -> Rgb {
    match v4(&format!("LightSource \"point\" {parameters}")).unwrap().scene.lights[0] {
        Light::Point { intensity, .. } => intensity,
        ref other => panic!("{other:?}"),
    }
}

fn material(text: &str) -> Material {
    v4(&format!("Material {text} Shape \"sphere\"")).unwrap().scene.objects[0].material.clone()
}

fn albedo(text: &str) -> Rgb {
    match material(text) {
        Material::Diffuse { albedo } => albedo,
        other => panic!("{other:?}"),
    }
}

#[track_caller]
fn close(a: Rgb, b: Rgb, tolerance: f32) {
    assert!(a.abs_diff_eq(b, tolerance), "{a} is not {b}");
}

#[test]
fn lights_have_a_luminance_of_one() {
    let luminance = Rgb::new(0.2126, 0.7152, 0.0722);
    // White, whatever the amount, by name and by samples; equal energy is a warmer white: x = y = 1/3 in linear sRGB.
    close(intensity("\"spectrum I\" \"stdillum-D65\""), Rgb::ONE, 1e-3);
    let equal = Rgb::new(1.205, 0.948, 0.909);
    close(intensity("\"spectrum I\" [300 7 900 7]"), equal, 0.02);
    close(intensity("\"spectrum I\" [300 7 900 7]"), intensity("\"spectrum I\" [300 1e-3 900 1e-3]"), 1e-6);
    for spectrum in ["\"blackbody I\" 3000", "\"spectrum I\" \"stdillum-F2\"", "\"spectrum I\" [400 0 700 1]"] {
        let rgb = intensity(spectrum);
        assert!((rgb.dot(luminance) - 1.0).abs() < 0.01 && rgb.x > 1.2 && rgb.z < 0.8, "{spectrum}: {rgb}");
    }
    // Illuminant A is a black body of 2855.5 K.
    close(intensity("\"blackbody I\" 2855.5"), intensity("\"spectrum I\" \"stdillum-A\""), 0.02);
    close(intensity("\"blackbody I\" 6500 \"float scale\" 3"), 3.0 * intensity("\"blackbody I\" 6500"), 1e-5);
}

#[test]
fn amounts_of_light_are_pbrts() {
    use std::f32::consts::PI;
    close(intensity("\"float power\" 100"), Rgb::splat(100.0 / (4.0 * PI)), 1e-5);
    close(
        intensity("\"float power\" 100 \"rgb I\" [2 0 1] \"float scale\" .5"),
        Rgb::new(1.0, 0.0, 0.5) * 25.0 / PI,
        1e-5,
    );
    close(intensity("\"float power\" 0"), Rgb::ONE, 0.0);
    let distant = v4("LightSource \"distant\" \"float illuminance\" 7 \"rgb L\" [1 2 3]").unwrap();
    assert!(
        matches!(distant.scene.lights[0], Light::Directional { irradiance, .. } if irradiance == Rgb::new(7.0, 14.0, 21.0))
    );
    // A uniform sky of radiance L illuminates with π L.
    let sky = v4("LightSource \"infinite\" \"float illuminance\" 6").unwrap().scene.environment.unwrap();
    close(sky.scale, Rgb::splat(6.0 / PI), 1e-6);
    fails(v4("LightSource \"point\" \"float power\" 1e30 \"float scale\" 1e30"), "out of range");
    fails(v4("LightSource \"point\" \"float power\" -1"), "\"float power\" must be from 0 to 1e30");
}

#[test]
fn reflectances_are_seen_in_daylight() {
    // A constant is grey, from numbers and from a file; a long-pass filter is red.
    close(albedo("\"diffuse\" \"spectrum reflectance\" [300 .25 900 .25]"), Rgb::splat(0.25), 1e-6);
    let files: &[(&str, &[u8])] = &[("s/grey.spd", b"# nm  value\n300 .5 # ultraviolet\n\n 900 .5\n")];
    let scene =
        read_with("Material \"diffuse\" \"spectrum reflectance\" \"s/grey.spd\" Shape \"sphere\"", files).unwrap();
    assert_eq!(scene.scene.objects[0].material, Material::Diffuse { albedo: Rgb::splat(0.5) });
    let red = albedo("\"diffuse\" \"spectrum reflectance\" [580 0 581 1 900 1]");
    assert!(red.x == 1.0 && red.y < 0.3 && red.z < 0.01, "{red}");
    let red = v4("Material \"diffuse\" \"spectrum reflectance\" [580 0 581 1 900 1]").unwrap();
    assert!(red.warnings.iter().any(|warning| warning.contains("outside of sRGB: clamped")), "{:?}", red.warnings);
}

#[test]
fn indices_are_taken_at_their_wavelengths() {
    let eta = |text: &str| match material(text) {
        Material::Dielectric(dielectric) => dielectric.eta,
        other => panic!("{other:?}"),
    };
    assert!((eta("\"dielectric\" \"spectrum eta\" \"glass-BK7\"") - 1.5168).abs() < 1e-5);
    assert!((eta("\"dielectric\" \"spectrum eta\" [500 1.5 600 1.6]") - 1.587_561_8).abs() < 1e-6);
    let warnings = |eta: &str| v4(&format!("Material \"dielectric\" \"spectrum eta\" {eta}")).unwrap().warnings;
    assert!(warnings("\"glass-F11\"").last().unwrap().contains("587.5618 nm, without dispersion"));
    assert!(!warnings("[300 1.5 900 1.5]").iter().any(|warning| warning.contains("dispersion")));
    let metal = "\"conductor\" \"spectrum eta\" [466 3 549 2 614 1] \"spectrum k\" \"metal-Ag-k\"";
    match material(metal) {
        Material::Conductor(metal) => assert_eq!((metal.eta, metal.k.x), (Rgb::new(1.0, 2.0, 3.0), 4.1283)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn damaged_spectra_are_refused_with_their_place() {
    for (spectrum, message) in [
        ("[400]", "needs pairs of wavelength and value, not 1 number"),
        ("[400 1 400 1]", "ascending wavelengths, not 400 after 400"),
        ("[400 1 300 1]", "ascending wavelengths, not 300 after 400"),
        ("[400 -1]", "from 0 to 1e30, not -1"),
        ("[400 0 700 0]", "has no visible light"),
        ("[10 1 20 1]", "has no visible light"),
        ("[\"stdillum-A\" \"stdillum-A\"]", "needs one name"),
        ("[\"stdillum-A\" 4]", "needs a name or numbers, not both"),
        ("\"bad.spd\"", "\"x\" is not a finite number"),
        ("\"nan.spd\"", "\"nan\" is not a finite number"),
        ("\"empty.spd\"", "needs pairs of wavelength and value, not 0 numbers"),
        ("\"folder\"", "\"folder\" is not known, and no file"),
        ("\"\"", "\"\" is not known, and no file"),
    ] {
        let files: &[(&str, &[u8])] =
            &[("bad.spd", b"400 x"), ("nan.spd", b"400 nan"), ("empty.spd", b""), ("folder/file", b"")];
        let error = fails(read_with(&format!("LightSource \"point\" \"spectrum I\" {spectrum}"), files), message);
        assert!(error.to_string().contains("scene.pbrt:3:21"), "{error}");
    }
    for (text, message) in [
        ("LightSource \"point\" \"blackbody I\" 0", "from 1000 to 1e9 kelvin, not 0"),
        ("LightSource \"point\" \"blackbody I\" [5000 1]", "needs 1 number, not 2"),
        ("Material \"diffuse\" \"spectrum reflectance\" [400 2]", "must be from 0 to 1, not 2 at 400 nm"),
        ("Material \"conductor\" \"spectrum k\" [500 1 700 2]", "does not cover the wavelengths 614, 549, 466 nm"),
    ] {
        fails(v4(text), message);
    }
    let huge = " 1".repeat(1 << 20);
    fails(read_with("LightSource \"point\" \"spectrum I\" \"huge\"", &[("huge", huge.as_bytes())]), "huge");
}

/// Area and mean normal of a mesh.
fn area(object: &Object) -> (f64, Vec3) {
    let Shape::Mesh(mesh) = &object.shape else { panic!("not a mesh: {:?}", object.shape) };
    let cross = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        0.5 * (b - a).cross(c - a)
    };
    let (sum, total) = mesh.triangles.iter().map(cross).fold((DVec3::ZERO, 0.0), |(s, t), n| (s + n, t + n.length()));
    (total, sum.normalize().as_vec3())
}

#[test]
fn disks_keep_their_area_and_face() {
    for (before, size, normal) in [
        ("", 4.0, Vec3::Z),
        ("Scale 1 1 -1", 4.0, Vec3::NEG_Z),
        ("Scale 2 2 2 Rotate 90 1 0 0", 16.0, Vec3::NEG_Y),
        ("ReverseOrientation", 4.0, Vec3::NEG_Z),
    ] {
        let text =
            format!("AreaLightSource \"diffuse\" {before} Shape \"disk\" \"float radius\" 2 \"float height\" .5");
        let scene = v4(&text).unwrap();
        let (area, n) = area(&scene.scene.objects[0]);
        assert!((area / (size * std::f64::consts::PI) - 1.0).abs() < 1e-6, "{before}: {area}");
        assert!(n.abs_diff_eq(normal, 1e-6), "{before}: {n}");
        let Shape::Mesh(mesh) = &scene.scene.objects[0].shape else { unreachable!() };
        if before.is_empty() {
            let radii = mesh.positions[..128].iter().map(|p| p.truncate().length());
            assert!(radii.into_iter().all(|r| (r / 2.0 - 1.0).abs() < 2.1e-4));
            assert!(mesh.positions.iter().all(|p| p.z == 0.5));
        }
        assert!(scene.warnings.iter().any(|warning| warning.contains("a polygon of 128 corners")));
    }
}

#[test]
fn planar_patches_are_their_triangles() {
    // pbrt's order of corners; its front is where u × v points.
    let square = "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 0]";
    let rectangle = |text: &str| match &v4(text).unwrap().scene.objects[0].shape {
        Shape::Rectangle(rectangle) => (rectangle.centre(), rectangle.normal(), rectangle.area()),
        other => panic!("{other:?}"),
    };
    assert_eq!(rectangle(square), (Vec3::new(1.0, 0.5, 0.0), Vec3::Z, 2.0));
    let flipped = format!("AreaLightSource \"diffuse\" ReverseOrientation {square}");
    assert_eq!(rectangle(&flipped).1, Vec3::NEG_Z);
    let two = "Shape \"bilinearmesh\" \"integer indices\" [0 1 2 3 2 3 4 5] \
               \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 0 2 1 1 2 1]";
    let (area, _) = area(&v4(two).unwrap().scene.objects[0]);
    assert!((area - 1.0 - 2f64.sqrt()).abs() < 1e-6, "{area}");
    for (indices, message) in
        [("[0 1 2 9]", "vertex 9 of 4"), ("[0 1 2]", "groups of 4"), ("[0 1 2 .5]", "vertex 0.5 of 4")]
    {
        fails(v4(&format!("{square} \"integer indices\" {indices}")), message);
    }
    fails(v4("Shape \"bilinearmesh\""), "needs \"point3 P\"");
    fails(v4("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 2 2 2]"), "needs \"integer indices\"");
}

#[test]
fn options_without_effect_are_left_out() {
    let options = "Option \"integer seed\" 4\nOption \"string rendercoordsys\" \"world\"\nOption \"bool forcediffuse\" false\n\
                   ColorSpace \"srgb\"";
    let warnings = with_options(options).unwrap().warnings;
    assert!(warnings[0].contains("scene.pbrt:1:30: Option: \"integer seed\" has no effect here"), "{warnings:?}");
    assert!(warnings[1].contains("\"string rendercoordsys\" has no effect"), "{warnings:?}");
    fails(read(&in_world("Option \"integer seed\" 4")), "Option belongs before WorldBegin");
    fails(with_options("Option"), "Option needs a parameter");
    fails(with_options("Option \"seed\""), "is not a type and a name");
}
