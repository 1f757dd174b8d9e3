//! Materials, meshes and lights, and which of the lights the camera shows.

use super::*;

#[test]
fn materials_of_every_kind() {
    let of = |contents: &str| last(&more(contents, &bound("ball", "m", "")));
    let (one, red) = (Rgb::ONE, Rgb::new(1.0, 0.5, 0.25));
    let ior = "<roughness>0</roughness><ior>1.5</ior>";
    for (children, material) in [
        ("<mirror><reflectance>1 .5 .25</reflectance></mirror>".into(), Material::Mirror { reflectance: red }),
        (
            format!("<refraction><transmittance>1 .5 .25</transmittance>{ior}</refraction>"),
            Material::Refraction { transmittance: red, eta: 1.5 },
        ),
        (
            format!("<glass><transmittance>1 1 1</transmittance><reflectance>1 .5 .25</reflectance>{ior}</glass>"),
            Material::Dielectric(Dielectric { reflectance: red, ..Dielectric::clear(1.5) }),
        ),
        (
            "<microfacet><alpha>.5</alpha><eta>1 .5 .25</eta><k>1 1 1</k></microfacet>".into(),
            Material::Conductor(Conductor::new(red, one, 0.5, Distribution::Beckmann)),
        ),
        // The last that is known counts.
        (
            "<mirror><reflectance>1 1 1</reflectance></mirror><mirror><reflectance>1 .5 .25</reflectance></mirror><fur/>".into(),
            Material::Mirror { reflectance: red },
        ),
        ("<fur/>".into(), Material::Diffuse { albedo: Rgb::splat(0.5) }),
    ] {
        let object = of(&effect("m", &children));
        assert_eq!((object.material, object.emission), (material, None), "{children}");
    }
    let emitter = of(&effect("m", "<emission><radiance>9 8 7</radiance></emission>"));
    let radiance = Rgb::new(9.0, 8.0, 7.0);
    assert_eq!(
        emitter.emission,
        Some(Emission { radiance, two_sided: true, visibility: EmitterVisibility::CameraOnly })
    );
    assert_eq!(emitter.material, Material::Diffuse { albedo: Rgb::ZERO });
    // Without the course's profile: phong's diffuse colour, and grey for all else.
    let common = |shader: &str| {
        let text = format!(
            "<effect id=\"f\"><profile_COMMON><technique sid=\"common\"><{shader}><diffuse><color>1 .5 .25 1</color></diffuse>\
             </{shader}></technique></profile_COMMON></effect><material id=\"m\"><instance_effect url=\"#f\"/></material>"
        );
        of(&text).material
    };
    assert_eq!(common("phong"), Material::Diffuse { albedo: red });
    assert_eq!(common("lambert"), Material::Diffuse { albedo: Rgb::splat(0.5) });
    let warned = |contents: &str, message: &str| {
        let warnings = read_text(&more(contents, &bound("ball", "m", ""))).unwrap().warnings;
        assert!(warnings.iter().any(|w| w.contains(message)), "{warnings:?}");
    };
    warned(&effect("m", "<fur/>"), "s.dae:3:51: <fur> is no material that is known");
    warned(
        &effect(
            "m",
            "<refraction><transmittance>1 1 1</transmittance><roughness>.1</roughness><ior>2</ior></refraction>",
        ),
        "<roughness> has no effect",
    );
    for (contents, message) in [
        (effect("m", "<mirror/>"), "s.dae:3:51: <mirror> has no reflectance"),
        (effect("m", "<mirror><reflectance>1 1 2</reflectance></mirror>"), "must be from 0 to 1, not 2"),
        (
            effect("m", "<glass><transmittance>1 1 1</transmittance><reflectance>1 1 1</reflectance></glass>"),
            "has no ior",
        ),
        (
            effect(
                "m",
                "<glass><transmittance>1 1 1</transmittance><reflectance>1 1 1</reflectance><ior>1e-30</ior></glass>",
            ),
            "<ior> must be from 0.001 to 1000",
        ),
        (effect("m", "<microfacet><alpha>0.1</alpha><eta>0 1 1</eta><k>1 1 1</k></microfacet>"), "must be above 0"),
        (effect("n", "<fur/>"), "no element has the id \"m\""),
        ("<material id=\"m\"/>".into(), "<material> has no instance_effect"),
        ("<effect id=\"m\"/>".into(), "\"m\" must be a <material>, not a <effect>"),
        ("<material id=\"m\"><instance_effect url=\"other.dae#f\"/></material>".into(), "only links within one"),
        ("<material id=\"m\"><instance_effect/></material>".into(), "<instance_effect> has no url"),
    ] {
        fails(&more(&contents, &bound("ball", "m", "")), message);
    }
}

/// A mesh `m` with five points, whose faces are as given.
fn mesh(faces: &str) -> String {
    format!(
        r##"<geometry id="m"><mesh><source id="s"><float_array count="15">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
{faces}</mesh></geometry>"##
    )
}

const INPUTS: &str =
    r##"<input semantic="VERTEX" source="#v" offset="1"/><input semantic="NORMAL" source="#s" offset="0"/>"##;

#[test]
fn meshes_are_cut_into_triangles_and_shaded_smoothly() {
    let faces = format!(
        "<polylist count=\"2\">{INPUTS}<vcount>4 3</vcount><p>0 0 0 1 0 2 0 3 0 <!-- --> 0 9 1 0 4</p></polylist>"
    );
    let object = last(&more(&mesh(&faces), INSTANCE));
    let Shape::Mesh(found) = &object.shape else { panic!("{object:?}") };
    assert_eq!(found.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 4]]);
    // Weighted by area: two triangles up (½ + ½), one towards -y (½).
    assert!(found.normals[0].abs_diff_eq(Vec3::new(0.0, -0.5, 1.0).normalize(), 1e-6), "{}", found.normals[0]);
    assert_eq!((found.normals[2], found.normals[4]), (Vec3::Z, Vec3::NEG_Y));
    // The same as triangles.
    let triangles = format!("<triangles count=\"3\">{INPUTS}<p>0 0 0 1 0 2 0 0 0 2 0 3 0 0 0 1 0 4</p></triangles>");
    assert_eq!(last(&more(&mesh(&triangles), INSTANCE)).shape, object.shape);
    // Further polygons are left out with a warning, and polylists come first.
    let imported = read_text(&more(&mesh(&format!("{triangles}{faces}<lines/>")), INSTANCE)).unwrap();
    assert_eq!(imported.scene.objects[1].shape, object.shape);
    let others = imported.warnings.iter().filter(|w| w.contains("only a mesh's first polygons are read")).count();
    assert_eq!(others, 2, "{:?}", imported.warnings);
    // Two triangles of a rectangle are one.
    let flat = format!("<triangles count=\"2\">{INPUTS}<p>0 0 0 2 0 1 0 0 0 3 0 2</p></triangles>");
    let object = last(&more(&mesh(&flat), INSTANCE));
    assert_eq!(
        (rectangle(&object).normal(), object.material),
        (Vec3::NEG_Z, Material::Diffuse { albedo: Rgb::splat(0.5) })
    );
}

#[test]
fn wrong_meshes_are_refused_with_their_place() {
    let whole = format!("<polylist count=\"1\">{INPUTS}<vcount>3</vcount><p>0 0 0 1 0 2</p></polylist>");
    assert!(read_text(&more(&mesh(&whole), INSTANCE)).is_ok());
    for (old, new, message) in [
        ("<p>0 0 0 1 0 2</p>", "<p>0 0 0 1 0 5</p>", "vertex 5 of 5, counted from 0, does not exist"),
        ("<p>0 0 0 1 0 2</p>", "<p>0 0 0 1 0 -2</p>", "\"-2\" is not a whole number from 0 on"),
        ("<p>0 0 0 1 0 2</p>", "<p>0 0 0 1 0 4294967296</p>", "is not a whole number"),
        ("<p>0 0 0 1 0 2</p>", "<p>0 0 0 1 0</p>", "<p> has 5 numbers, which are not 2 for each corner"),
        ("<p>0 0 0 1 0 2</p>", "", "<polylist> has no p"),
        ("<vcount>3", "<vcount>4294967295", "which are not 2 for each corner"),
        ("<vcount>3", "<vcount>2", "a face of 2 corners"),
        ("<vcount>3", "<vcount>3 3", "s.dae:5:1: count=\"1\", but there are 2 faces"),
        ("<vcount>3</vcount>", "", "<polylist> has no vcount"),
        ("polylist count=\"1\"", "polylist count=\"99999999999999999999\"", "but there are 1 faces"),
        ("count=\"15\"", "count=\"4000000000\"", "count=\"4000000000\", but there are 15 numbers"),
        ("count=\"15\">0 0 0", "count=\"14\">0 0", "14 numbers are no points of 3 each"),
        (">0 0 0 1", ">0 0 inf 1", "s.dae:3:67: \"inf\" is not a finite number"),
        (">0 0 0 1", ">0 0 1e30 1", "is out of range"),
        ("offset=\"1\"", "offset=\"64\"", "<input> needs an offset"),
        ("offset=\"1\"", "", "<input> needs an offset"),
        ("VERTEX", "VERTICES", "no <input> with the semantic VERTEX"),
        ("POSITION", "NORMAL", "no <input> with the semantic POSITION"),
        ("#v\" offset", "#s\" offset", "\"s\" must be a <vertices>, not a <source>"),
        ("polylist", "polygons", "a mesh without <polylist> or <triangles>"),
        (
            "</float_array>",
            "</float_array><technique_common><accessor stride=\"4\"/></technique_common>",
            "3 numbers each",
        ),
        ("<mesh>", "<brep>", "s.dae:"),
    ] {
        let text = mesh(&whole).replacen(old, new, if old == "polylist" { 2 } else { 1 });
        assert_ne!(text, mesh(&whole), "{old}");
        fails(&more(&text, INSTANCE), message);
    }
    fails(&more("", INSTANCE), "no element has the id \"m\"");
    fails(&more("<geometry id=\"m\"/>", INSTANCE), "<geometry> has no mesh");
    let radius =
        |radius: &str| more("", QUAD).replace("<radius>2", &format!("<radius>{radius}")).replace("#quad", "#ball");
    fails(&radius("0"), "<radius> must be positive, not 0");
    fails(&radius("1e30"), "is out of range");
    fails(&radius("1 2"), "<radius> needs 1 number, not 2");
    let squashed = "<node><scale>1 2 1</scale><instance_geometry url=\"#ball\"/></node>";
    fails(&more("", squashed), "an ellipsoid");
}

/// A scene with a light of the given technique and a node for it.
fn with_light(technique: &str, transforms: &str) -> String {
    let light = format!("<light id=\"lamp\">{technique}</light>");
    more(&light, &format!("<node>{transforms}<instance_light url=\"#lamp\"/></node>"))
}

#[test]
fn lights_of_every_kind() {
    let lights =
        |technique: &str, transforms: &str| read_text(&with_light(technique, transforms)).unwrap().scene.lights;
    let (position, intensity) = (Vec3::new(1.0, 2.0, 3.0), Rgb::new(5.0, 4.0, 3.0));
    let point = [Light::Point { position, intensity, falloff: Falloff::None }];
    let place = "<translate>1 2 3</translate>";
    assert_eq!(lights(&common("point", "5 4 3"), place), point);
    let sun = Light::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::splat(2.0) };
    assert_eq!(lights(&common("directional", "2 2 2"), &format!("{place}<rotate>1 0 0 -90</rotate>")), [sun]);
    assert_eq!(lights(&common("ambient", "1 1 1"), ""), [Light::Hemisphere { radiance: Rgb::ONE }]);
    assert_eq!(lights(&common("ambient", "0 0 0"), ""), []);
    let spot = read_text(&with_light(&common("spot", "1 1 1"), "")).unwrap();
    assert_eq!(spot.scene.lights, []);
    assert!(spot.warnings.iter().any(|w| w.contains("s.dae:3:36: a spot light is black")), "{:?}", spot.warnings);
    // The course's profile overrides the common one; other profiles do not.
    let extra = |profile: &str| {
        let area = "<ambient><color>7 7 7</color></ambient>";
        format!("{}<extra><technique profile=\"{profile}\">{area}</technique></extra>", common("point", "5 4 3"))
    };
    assert_eq!(lights(&extra("CGL"), place), [Light::Hemisphere { radiance: Rgb::splat(7.0) }]);
    assert_eq!(lights(&extra("blender"), place), point);
    for (technique, transforms, message) in [
        (common("tube", "1 1 1"), "", "s.dae:3:36: a light of kind <tube> is not supported"),
        (common("point", "1 1"), "", "<color> needs 3 numbers, not 2"),
        (common("point", "1 1 -1"), "", "<color> must be from 0 to 1e30, not -1"),
        (common("point", "1 1 x"), "", "s.dae:3:54: \"x\" is not a finite number"),
        ("<technique_common/>".into(), "", "s.dae:3:18: this light has no kind"),
        (String::new(), "", "s.dae:3:1: <light> has no technique_common"),
        (common("point", "1 1 1"), "<translate>1e30 0 0</translate>", "is out of range"),
        (common("directional", "1 1 1"), "<scale>1 1 0</scale>", "leaves no direction"),
        (common("area", "1 1 1"), "<scale>1 0 1</scale>", "makes no rectangle"),
        (common("area", "1 1 1"), "<matrix>1 1 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>", "makes no rectangle"),
    ] {
        fails(&with_light(&technique, transforms), message);
    }
}

#[test]
fn area_lights_are_seen_once_and_light_once() {
    let area = common("area", "3 2 1");
    // Alone, the light becomes an object: 4 by 2, its front along its -z.
    let place = "<translate>0 9 0</translate><rotate>1 0 0 -90</rotate><scale>4 2 1</scale>";
    let alone = read_text(&with_light(&area, place)).unwrap();
    assert_eq!(alone.scene.lights, []);
    let light = alone.scene.objects.last().unwrap();
    let radiance = Rgb::new(3.0, 2.0, 1.0);
    assert_eq!(light.emission, Some(Emission { radiance, two_sided: false, visibility: EmitterVisibility::Sampled }));
    assert_eq!(light.material, Material::Diffuse { albedo: Rgb::ZERO });
    let shape = rectangle(light);
    assert_eq!((shape.centre(), shape.normal(), shape.area()), (Vec3::new(0.0, 9.0, 0.0), Vec3::NEG_Y, 8.0));
    // It does not move the camera, which looks at objects of the file only.
    assert_eq!(alone.scene.camera, read_text(&more("", "")).unwrap().scene.camera);
    // A mirror image shines along its own -z, too.
    let mirrored = read_text(&with_light(&area, &format!("{place}<scale>-1 1 1</scale>"))).unwrap();
    assert_eq!(rectangle(mirrored.scene.objects.last().unwrap()).normal(), Vec3::NEG_Y);
    // With an emitting mesh in its place, the camera shows the mesh, and light is still sampled from the light.
    let glow = effect("glow", "<emission><radiance>9 9 9</radiance></emission>");
    let glow = format!("{glow}<light id=\"lamp\">{area}</light>");
    let both = |y: f32| {
        let mesh = bound("quad", "glow", &format!("<translate>0 {y} 0</translate><rotate>1 0 0 90</rotate>"));
        let nodes = format!("{mesh}<node>{place}<instance_light url=\"#lamp\"/></node>");
        read_text(&more(&glow, &nodes)).unwrap().scene
    };
    let near = both(9.01);
    assert!(matches!(near.lights[..], [Light::Rectangle { rectangle, .. }] if rectangle == shape), "{:?}", near.lights);
    let roles =
        |objects: &[Object]| objects.iter().filter_map(|o| o.emission).map(|e| e.visibility).collect::<Vec<_>>();
    assert_eq!(roles(&near.objects), [EmitterVisibility::CameraOnly]);
    let far = both(5.0);
    assert_eq!(
        (roles(&far.objects), far.lights.len()),
        (vec![EmitterVisibility::CameraOnly, EmitterVisibility::Sampled], 0)
    );
}
