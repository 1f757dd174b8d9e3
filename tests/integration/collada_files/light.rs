//! Lights, and which of them the camera shows.

use super::*;

/// A scene with a light of the given technique and a node for it.
fn with_light(technique: &str, transforms: &str) -> String {
    let light = format!("<light id=\"lamp\">{technique}</light>");
    more(&light, &format!("<node>{transforms}<instance_light url=\"#lamp\"/></node>"))
}

#[test]
fn lights_of_every_kind() {
    let lights =
        |technique: &str, transforms: &str| read_text(&with_light(technique, transforms)).unwrap().scene.lights;
    let point =
        Light::Point { position: Vec3::new(1.0, 2.0, 3.0), intensity: Rgb::new(5.0, 4.0, 3.0), falloff: Falloff::None };
    let place = "<translate>1 2 3</translate>";
    assert_eq!(lights(&common("point", "5 4 3"), place), [point]);
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
    assert_eq!(lights(&extra("blender"), place), [point]);
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
