//! Scenes in the course's COLLADA dialect: what they become, what is refused and where, and that no input breaks the
//! reader.

use etalon::import::Imported;
use etalon::import::collada::{ColladaOptions, read};

use etalon::raster::Rgb;
use etalon::scene::{
    Conductor, Distribution, Emission, Falloff, Light, Material, Object, Projection, Rectangle, Request, Role, Shape,
};
use etalon::{Error, Result};
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};

fn asset(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: there is no {}", path.display());
    None
}

/// Horizontal and vertical field of view in degrees.
fn fields(imported: &Imported) -> [f64; 2] {
    match imported.scene.camera.projection {
        Projection::Perspective { tan_half_width, tan_half_height } => {
            [tan_half_width, tan_half_height].map(|t| 2.0 * t.atan().to_degrees())
        }
        Projection::Orthographic { .. } => panic!("not a perspective camera"),
    }
}

fn sized(path: &Path, resolution: [usize; 2]) -> Imported {
    read(path, &ColladaOptions { resolution: Some(resolution), settings: None }).unwrap()
}

fn counts(imported: &Imported) -> [usize; 3] {
    let count = |kind: fn(&Shape) -> bool| imported.scene.objects.iter().filter(|o| kind(&o.shape)).count();
    [
        count(|s| matches!(s, Shape::Sphere(_))),
        count(|s| matches!(s, Shape::Rectangle(_))),
        count(|s| matches!(s, Shape::Mesh(_))),
    ]
}

#[test]
fn the_courses_boxes_have_their_known_cameras() {
    for name in ["CBspheres", "CBspheres_lambertian", "CBempty", "CBdragon_microfacet_au", "CBbunny_microfacet_cu"] {
        let Some(path) = asset(&format!("scenes/{name}.dae")) else { return };
        for (resolution, degrees) in [
            ([800, 600], [49.134, 37.849]),
            ([480, 360], [30.676, 23.249]),
            ([640, 480], [40.176, 30.676]),
            ([960, 720], [57.496, 44.727]),
        ] {
            let imported = sized(&path, resolution);
            let found = fields(&imported);
            assert!((0..2).all(|i| (found[i] - degrees[i]).abs() < 1e-3), "{name} {resolution:?}: {found:?}");
            let camera = imported.scene.camera;
            let z = if name.contains("bunny") { -4.80234 } else { 4.80234 };
            assert!(camera.position.abs_diff_eq(DVec3::new(0.0, 0.75, z), 2e-3), "{name}: {}", camera.position);
            let distance = camera.position.distance(DVec3::new(0.0, 0.75, 0.0));
            assert!((distance - 4.80234).abs() < 2e-3, "{name}: {distance}");
            let request =
                Request { width: resolution[0], height: resolution[1], spp: 1, light_samples: 1, max_depth: 1 };
            assert_eq!(imported.request, request);
        }
        let imported = read(&path, &ColladaOptions::default()).unwrap();
        assert_eq!((imported.request.width, imported.request.height), (800, 600));
        assert_eq!(imported.warnings, [""; 0], "{name}");
    }
}

#[test]
fn the_courses_spheres_are_read_whole() {
    let Some(path) = asset("scenes/CBspheres.dae") else { return };
    let imported = sized(&path, [480, 360]);
    assert_eq!(counts(&imported), [2, 6, 0]);
    let [Light::Rectangle { rectangle, radiance }] = imported.scene.lights[..] else {
        panic!("{:?}", imported.scene.lights)
    };
    assert_eq!((rectangle.centre(), rectangle.normal()), (Vec3::new(0.0, 1.49, 0.0), Vec3::NEG_Y));
    assert!((rectangle.area() - 0.48).abs() < 1e-6 && radiance == Rgb::splat(10.0));
    let [x, z] = rectangle.half_sides().map(Vec3::abs);
    assert!(x.abs_diff_eq(0.3 * Vec3::X, 1e-6) && z.abs_diff_eq(0.4 * Vec3::Z, 1e-6), "{x} {z}");
    let spheres: Vec<&Object> = imported.scene.objects.iter().filter(|o| matches!(o.shape, Shape::Sphere(_))).collect();
    let glass = Material::Glass { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta: 1.45 };
    let mirror = Material::Mirror { reflectance: Rgb::ONE };
    for (object, material, centre) in
        [(spheres[0], glass, Vec3::new(0.4, 0.3, 0.3)), (spheres[1], mirror, Vec3::new(-0.4, 0.3, -0.3))]
    {
        let Shape::Sphere(sphere) = object.shape else { unreachable!() };
        assert!(sphere.centre.abs_diff_eq(centre, 1e-6) && (sphere.radius - 0.3).abs() < 1e-6, "{sphere:?}");
        assert_eq!((object.material, object.emission), (material, None));
    }
    let mut walls = Vec::new();
    for object in &imported.scene.objects {
        let Shape::Rectangle(wall) = object.shape else { continue };
        walls.push((wall.centre(), wall.normal()));
        let albedo = match (object.emission, wall.centre()) {
            (Some(emission), centre) => {
                let picture = Emission { radiance: Rgb::splat(10.0), two_sided: true, role: Role::Picture };
                assert_eq!(emission, picture);
                assert!(centre.abs_diff_eq(Vec3::new(0.0, 1.49, 0.0), 5e-3), "{centre}");
                assert!(wall.half_sides().iter().any(|s| s.abs().abs_diff_eq(0.4 * Vec3::X, 1e-4)));
                Rgb::ZERO
            }
            (None, centre) if centre.x < -0.9 => Rgb::new(0.6, 0.2, 0.2),
            (None, centre) if centre.x > 0.9 => Rgb::new(0.2, 0.2, 0.6),
            _ => Rgb::splat(0.6),
        };
        assert_eq!(object.material, Material::Diffuse { albedo });
    }
    // Ceiling, lamp, floor, left, right, back. The walls' corners run so that their fronts are outside, all of the box.
    let centres = [[0.0, 1.5, 0.0], [0.0, 1.49, 0.0], [0.0; 3], [-1.0, 0.75, 0.0], [1.0, 0.75, 0.0], [0.0, 0.75, -1.0]];
    let normals = [Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Y, Vec3::NEG_X, Vec3::X, Vec3::NEG_Z];
    for ((centre, normal), (c, n)) in walls.iter().zip(centres.into_iter().zip(normals)) {
        assert!(centre.abs_diff_eq(Vec3::from_array(c), 5e-3) && normal.abs_diff_eq(n, 1e-6), "{centre} {normal}");
    }
}

#[test]
fn the_courses_other_boxes_have_their_parts() {
    let Some(path) = asset("scenes/CBempty.dae") else { return };
    let empty = sized(&path, [480, 360]);
    assert_eq!(counts(&empty), [0, 6, 0]);
    let [Light::Point { position, intensity, falloff: Falloff::None }] = empty.scene.lights[..] else {
        panic!("{:?}", empty.scene.lights)
    };
    assert!(position.abs_diff_eq(Vec3::new(0.0, 1.49, 0.0), 5e-3) && intensity == Rgb::splat(5.0));
    let metals = [
        ("CBbunny_microfacet_cu", 28576, 0.05, [0.33228, 1.0162, 1.2474], [3.1646, 2.5785, 2.4603]),
        ("CBdragon_microfacet_au", 99891, 0.05, [0.21646, 0.42833, 1.3284], [3.2390, 2.4599, 1.8661]),
    ];
    for (name, triangles, alpha, eta, k) in metals {
        let Some(path) = asset(&format!("scenes/{name}.dae")) else { return };
        let imported = sized(&path, [480, 360]);
        assert_eq!(counts(&imported), [0, 6, 1], "{name}");
        assert!(matches!(imported.scene.lights[..], [Light::Rectangle { .. }]), "{name}");
        let (mesh, material) = imported.scene.objects.iter().find_map(mesh_of).unwrap();
        assert_eq!((mesh.triangles.len(), mesh.normals.len()), (triangles, mesh.positions.len()));
        let (eta, k) = (Rgb::from_array(eta), Rgb::from_array(k));
        let distribution = Distribution::Beckmann;
        assert_eq!(material, Material::Conductor(Conductor { eta, k, alpha, distribution }), "{name}");
        // Wound counter-clockwise seen from outside: the volume is positive.
        let volume = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| mesh.positions[i as usize].as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        assert!(mesh.triangles.iter().map(|&t| volume(t)).sum::<f64>() > 0.0, "{name}");
    }
}

fn mesh_of(object: &Object) -> Option<(&etalon::scene::Mesh, Material)> {
    match &object.shape {
        Shape::Mesh(mesh) => Some((mesh, object.material)),
        _ => None,
    }
}

#[test]
fn a_file_cut_off_in_its_numbers_says_so() {
    let Some(path) = asset("hostile/other/dragon_TRUNCATED_midarray.dae") else { return };
    let error = read(&path, &ColladaOptions::default()).unwrap_err();
    assert!(matches!(error, Error::Input { .. }) && error.hint().is_some(), "{error:?}");
    assert!(error.to_string().contains("the file ends in the middle"), "{error}");
}

/// Reads text as a scene for the default resolution.
fn read_text(text: &str) -> Result<Imported> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.dae");
    std::fs::write(&path, text).unwrap();
    read(&path, &ColladaOptions::default())
}

#[track_caller]
fn fails(text: &str, message: &str) -> Error {
    let error = read_text(text).expect_err(message);
    assert!(error.to_string().contains(message), "{error}\n  does not contain\n{message}");
    error
}

/// A scene that holds these libraries' contents (from line 3 on) and nodes. There is a camera on +z, a rectangle `quad`
/// of 2 × 1 in the plane z = 0 that faces +z, and a sphere `ball` of radius 2.
fn scene(up: &str, contents: &str, nodes: &str) -> String {
    format!(
        r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>{up}</up_axis></asset>
<library_all>
{contents}
<camera id="camera"><optics><technique_common><perspective><xfov>60</xfov><aspect_ratio>1.3333333333333333</aspect_ratio>
</perspective></technique_common></optics></camera>
<geometry id="quad"><mesh>
<source id="corners"><float_array count="12">-1 0 0  1 0 0  1 1 0  -1 1 0</float_array></source>
<vertices id="points"><input semantic="POSITION" source="#corners"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#points" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
</mesh></geometry>
<geometry id="ball"><extra><technique profile="CGL"><sphere><radius>2</radius></sphere></technique></extra></geometry>
</library_all>
<visual_scene id="scene">
{nodes}
</visual_scene>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>
"##
    )
}

const CAMERA: &str = r##"<node><translate>0 0 3</translate><instance_camera url="#camera"/></node>"##;
const QUAD: &str = r##"<node><instance_geometry url="#quad"/></node>"##;

/// A scene, y up, of the quad, the camera and more.
fn more(contents: &str, nodes: &str) -> String {
    scene("Y_UP", contents, &format!("{CAMERA}{QUAD}{nodes}"))
}

/// The scene's last object.
fn last(text: &str) -> Object {
    read_text(text).unwrap_or_else(|e| panic!("{e}")).scene.objects.pop().unwrap()
}

fn rectangle(object: &Object) -> Rectangle {
    match object.shape {
        Shape::Rectangle(rectangle) => rectangle,
        ref other => panic!("not a rectangle: {other:?}"),
    }
}

#[test]
fn up_axes_turn_the_world() {
    // The corner (1, 1, 0) beside (-1, 0, 0): the centre (0, ½, 0) and the normal +z.
    for (up, centre, normal) in [
        ("Y_UP", Vec3::new(0.0, 0.5, 0.0), Vec3::Z),
        ("Z_UP", Vec3::new(0.0, 0.0, 0.5), Vec3::Y),
        (" X_UP\n", Vec3::new(0.5, 0.0, 0.0), Vec3::NEG_Z),
    ] {
        let camera = r##"<node><translate>1 2 3</translate><instance_camera url="#camera"/></node>"##;
        let quad = rectangle(&last(&scene(up, "", &format!("{camera}{QUAD}"))));
        assert_eq!((quad.centre(), quad.normal(), quad.area()), (centre, normal, 2.0), "{up}");
    }
    fails(&more("", "").replace("Y_UP", "W_UP"), "s.dae:1:86: the up axis is X_UP, Y_UP or Z_UP, not \"W_UP\"");
    fails(&more("", "").replace("up_axis", "up"), "s.dae:1:1: <COLLADA> has no asset/up_axis");
}

#[test]
fn transforms_are_those_of_the_standard() {
    let ball = |transforms: &str| {
        let text = format!("<node>{transforms}<instance_geometry url=\"#ball\"/></node>");
        match last(&more("", &text)).shape {
            Shape::Sphere(sphere) => (sphere.centre, sphere.radius),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(ball(""), (Vec3::ZERO, 2.0));
    assert_eq!(ball("<translate>1 2 3</translate><scale>.5 .5 .5</scale>"), (Vec3::new(1.0, 2.0, 3.0), 1.0));
    assert_eq!(ball("<scale>2 2 2</scale><translate>1 2 3</translate>"), (Vec3::new(2.0, 4.0, 6.0), 4.0));
    assert_eq!(ball("<rotate>0 0 1 90</rotate><translate>1 0 0</translate>"), (Vec3::Y, 2.0));
    let matrix = "<matrix sid=\"transform\">0 -2 0 4  2 0 0 5  0 0 2 6  0 0 0 1</matrix>";
    assert_eq!(ball(matrix), (Vec3::new(4.0, 5.0, 6.0), 4.0));
    assert_eq!(ball(&format!("<scale>9 9 9</scale>{matrix}<translate>1 1 1</translate>")).0, Vec3::new(4.0, 5.0, 6.0));
    // Nodes in nodes, and nodes that are instanced.
    let nested =
        format!("<node><translate>1 0 0</translate><node>{matrix}<instance_geometry url=\"#ball\"/></node></node>");
    assert!(matches!(last(&more("", &nested)).shape, Shape::Sphere(s) if s.centre == Vec3::new(5.0, 5.0, 6.0)));
    let library = "<library_nodes><node id=\"part\"><translate>1 0 0</translate><instance_geometry url=\"#ball\"/></node></library_nodes>";
    let twice = "<node><rotate>0 0 1 90</rotate><instance_node url=\"#part\"/></node><instance_node url=\"#part\"/>";
    let imported = read_text(&more(library, twice)).unwrap();
    let centres: Vec<_> = imported.scene.objects[1..].iter().map(|o| o.shape.clone()).collect();
    assert!(matches!(centres[..], [Shape::Sphere(a), Shape::Sphere(b)] if (a.centre, b.centre) == (Vec3::Y, Vec3::X)));
    // Some of the course's files lack the last number.
    let short =
        more("", "<node><matrix>1 0 0 1 0 1 0 2 0 0 1 3 0 0 0</matrix><instance_geometry url=\"#ball\"/></node>");
    let imported = read_text(&short).unwrap();
    assert!(matches!(imported.scene.objects[1].shape, Shape::Sphere(s) if s.centre == Vec3::new(1.0, 2.0, 3.0)));
    assert!(imported.warnings.iter().any(|w| w.contains("<matrix> has 15 numbers")), "{:?}", imported.warnings);
}

#[test]
fn the_camera_stands_where_the_course_puts_it() {
    let imported = read_text(&more("", "")).unwrap();
    let camera = imported.scene.camera;
    // The quad's diagonal is √5, its centre (0, ½, 0).
    assert!(camera.position.abs_diff_eq(DVec3::new(0.0, 0.5, 1.5 * 5f64.sqrt()), 1e-12), "{}", camera.position);
    assert_eq!((camera.right, camera.up, camera.forward), (DVec3::X, DVec3::Y, DVec3::NEG_Z));
    // 60° across the window of 800 x 600: a pixel is 1/800 of the film.
    let across = 30f64.to_radians().tan();
    let close = |text: &str, expected: [f64; 2]| {
        let found = fields(&read_text(text).unwrap()).map(|degrees| (degrees.to_radians() * 0.5).tan());
        assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 1e-12), "{found:?} is not {expected:?}");
    };
    close(&more("", ""), [across, across * 0.75]);
    let aspect = "<aspect_ratio>1.3333333333333333</aspect_ratio>";
    // Fields of another shape are widened to the window's.
    close(&more("", "").replace(aspect, "<aspect_ratio>2</aspect_ratio>"), [across, across * 0.75]);
    close(&more("", "").replace(aspect, "<yfov>60</yfov>"), [across / 0.75, across]);
    close(&more("", "").replace("<xfov>60</xfov>", ""), [25f64.to_radians().tan(), 25f64.to_radians().tan() * 0.75]);
    // The last camera counts; of its place only the direction from the origin to one unit ahead.
    let second = r##"<node><translate>-5 0 1</translate><instance_camera url="#camera"/></node>"##;
    let camera = read_text(&more("", second)).unwrap().scene.camera;
    assert!(camera.position.abs_diff_eq(DVec3::new(-1.5 * 5f64.sqrt(), 0.5, 0.0), 1e-12), "{}", camera.position);
    fails(&more("", "").replace(aspect, ""), "<perspective> has no aspect_ratio");
    fails(&more("", "").replace(">60<", ">180<"), "s.dae:4:60: <xfov> must be between 0 and 180, not 180");
    fails(&more("", "").replace("perspective", "orthographic"), "only <perspective> cameras");
    fails(&scene("Y_UP", "", QUAD), "the scene has no camera");
    fails(&scene("Y_UP", "", CAMERA), "the scene has nothing to look at");
    fails(&more("", &second.replace("-5 0 1", "0 5 1")), "this camera's direction is vertical");
    fails(&more("", &second.replace("-5 0 1", "0 0 1")), "this camera's direction is vertical or none");
}

const SETTINGS: &str =
    "40 30 1.3333 0.1 100\n1 2 3 0 0 0\n1.2 0.3 3.7 0.1 10\n0 0 1 0 1 0 -1 0 0\n640 480 800\n4.7 0\n";

#[test]
fn a_settings_file_is_taken_as_it_stands() {
    let dir = tempfile::tempdir().unwrap();
    let (path, settings) = (dir.path().join("s.dae"), dir.path().join("cam.txt"));
    // No camera is needed then.
    std::fs::write(&path, scene("Y_UP", "", QUAD)).unwrap();
    let with = |text: &str, resolution| {
        std::fs::write(&settings, text).unwrap();
        read(&path, &ColladaOptions { resolution, settings: Some(&settings) })
    };
    let imported = with(SETTINGS, None).unwrap();
    let camera = imported.scene.camera;
    assert_eq!(
        (camera.position, camera.right, camera.up, camera.forward),
        (DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Z, DVec3::Y, DVec3::NEG_X,)
    );
    let degrees = fields(&imported);
    assert!((degrees[0] - 40.0).abs() < 1e-12 && (degrees[1] - 30.0).abs() < 1e-12, "{degrees:?}");
    assert_eq!((imported.request.width, imported.request.height), (640, 480));
    let other = with(&SETTINGS.replace('\n', "\r\n"), Some([100, 200])).unwrap();
    assert_eq!((other.request.width, other.request.height, other.scene.camera), (100, 200, camera));
    for (old, new, message) in [
        ("40 30", "40 x", "cam.txt:1:4: \"x\" is not a finite number"),
        ("3.7", "nan", "cam.txt:3:9: \"nan\""),
        ("4.7 0", "4.7", "camera settings are 30 numbers, not 29"),
        ("40 30", "0 30", "cam.txt: the fields of view"),
        ("0 0 1 0 1", "0 0 1 0 2", "its matrix is no rotation"),
        ("0 0 1 0 1", "0 0 -1 0 1", "its matrix is no rotation"),
        ("640 480", "640 0", "the screen's sides"),
    ] {
        let error = with(&SETTINGS.replacen(old, new, 1), None).unwrap_err();
        assert!(error.to_string().contains(message), "{error}\n  does not contain\n{message}");
    }
}

/// A scene with a light of the given technique and a node for it.
fn lit(technique: &str, transforms: &str) -> String {
    let light = format!("<light id=\"lamp\">{technique}</light>");
    more(&light, &format!("<node>{transforms}<instance_light url=\"#lamp\"/></node>"))
}

fn common(kind: &str, colour: &str) -> String {
    format!("<technique_common><{kind}><color>{colour}</color></{kind}></technique_common>")
}

#[test]
fn lights_of_every_kind() {
    let lights = |technique: &str, transforms: &str| read_text(&lit(technique, transforms)).unwrap().scene.lights;
    let point =
        Light::Point { position: Vec3::new(1.0, 2.0, 3.0), intensity: Rgb::new(5.0, 4.0, 3.0), falloff: Falloff::None };
    let place = "<translate>1 2 3</translate>";
    assert_eq!(lights(&common("point", "5 4 3"), place), [point]);
    let sun = Light::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::splat(2.0) };
    assert_eq!(lights(&common("directional", "2 2 2"), &format!("{place}<rotate>1 0 0 -90</rotate>")), [sun]);
    assert_eq!(lights(&common("ambient", "1 1 1"), ""), [Light::Hemisphere { radiance: Rgb::ONE }]);
    assert_eq!(lights(&common("ambient", "0 0 0"), ""), []);
    let spot = read_text(&lit(&common("spot", "1 1 1"), "")).unwrap();
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
        fails(&lit(&technique, transforms), message);
    }
}

#[test]
fn area_lights_are_seen_once_and_light_once() {
    let area = common("area", "3 2 1");
    // Alone, the light becomes an object: 4 by 2, its front along its -z.
    let place = "<translate>0 9 0</translate><rotate>1 0 0 -90</rotate><scale>4 2 1</scale>";
    let alone = read_text(&lit(&area, place)).unwrap();
    assert_eq!(alone.scene.lights, []);
    let lamp = alone.scene.objects.last().unwrap();
    let radiance = Rgb::new(3.0, 2.0, 1.0);
    assert_eq!(lamp.emission, Some(Emission { radiance, two_sided: false, role: Role::Lamp }));
    assert_eq!(lamp.material, Material::Diffuse { albedo: Rgb::ZERO });
    let shape = rectangle(lamp);
    assert_eq!((shape.centre(), shape.normal(), shape.area()), (Vec3::new(0.0, 9.0, 0.0), Vec3::NEG_Y, 8.0));
    // It does not move the camera, which looks at objects of the file only.
    assert_eq!(alone.scene.camera, read_text(&more("", "")).unwrap().scene.camera);
    // A mirror image shines along its own -z, too.
    let mirrored = read_text(&lit(&area, &format!("{place}<scale>-1 1 1</scale>"))).unwrap();
    assert_eq!(rectangle(mirrored.scene.objects.last().unwrap()).normal(), Vec3::NEG_Y);
    // With a glowing mesh in its place, the mesh is the picture and the light stays a light.
    let glow = format!(
        "{}{}",
        effect("glow", "<emission><radiance>9 9 9</radiance></emission>"),
        format!("<light id=\"lamp\">{area}</light>")
    );
    let both = |y: f32| {
        let mesh = bound("quad", "glow", &format!("<translate>0 {y} 0</translate><rotate>1 0 0 90</rotate>"));
        let nodes = format!("{mesh}<node>{place}<instance_light url=\"#lamp\"/></node>");
        read_text(&more(&glow, &nodes)).unwrap().scene
    };
    let near = both(9.01);
    assert!(matches!(near.lights[..], [Light::Rectangle { rectangle, .. }] if rectangle == shape), "{:?}", near.lights);
    let roles = |objects: &[Object]| objects.iter().filter_map(|o| o.emission).map(|e| e.role).collect::<Vec<_>>();
    assert_eq!(roles(&near.objects), [Role::Picture]);
    let far = both(5.0);
    assert_eq!((roles(&far.objects), far.lights.len()), (vec![Role::Picture, Role::Lamp], 0));
}

/// An effect of the course's profile with a material of the same name.
fn effect(name: &str, children: &str) -> String {
    format!(
        "<effect id=\"{name}-fx\"><extra><technique profile=\"CGL\">{children}</technique></extra></effect>\
         <material id=\"{name}\"><instance_effect url=\"#{name}-fx\"/></material>"
    )
}

/// A node with a geometry of a material.
fn bound(geometry: &str, material: &str, transforms: &str) -> String {
    format!(
        "<node>{transforms}<instance_geometry url=\"#{geometry}\"><bind_material><technique_common>\
         <instance_material symbol=\"any\" target=\"#{material}\"/></technique_common></bind_material></instance_geometry></node>"
    )
}

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
            Material::Glass { reflectance: red, transmittance: one, eta: 1.5 },
        ),
        (
            "<microfacet><alpha>.5</alpha><eta>1 .5 .25</eta><k>1 1 1</k></microfacet>".into(),
            Material::Conductor(Conductor { eta: red, k: one, alpha: 0.5, distribution: Distribution::Beckmann }),
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
    let glow = of(&effect("m", "<emission><radiance>9 8 7</radiance></emission>"));
    let radiance = Rgb::new(9.0, 8.0, 7.0);
    assert_eq!(glow.emission, Some(Emission { radiance, two_sided: true, role: Role::Picture }));
    assert_eq!(glow.material, Material::Diffuse { albedo: Rgb::ZERO });
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
const INSTANCE: &str = r##"<node><instance_geometry url="#m"/></node>"##;

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

#[test]
fn nodes_hold_one_thing_and_end() {
    let crowded = "<node><instance_geometry url=\"#ball\"/><instance_geometry url=\"#quad\"/><instance_controller url=\"#x\"/></node><node/>";
    let imported = read_text(&more("", crowded)).unwrap();
    assert_eq!(imported.scene.objects.len(), 2);
    let left_out: Vec<_> = imported.warnings.iter().filter(|w| w.contains("left out")).collect();
    assert_eq!(left_out.len(), 2, "{left_out:?}");
    let camera_first = "<node><instance_geometry url=\"#ball\"/><instance_camera url=\"#camera\"/></node>";
    assert_eq!(
        read_text(&more("", &camera_first.replace("<node>", "<node><translate>1 0 0</translate>")))
            .unwrap()
            .scene
            .objects
            .len(),
        1
    );
    for (text, message) in [
        ("<node id=\"a\"><instance_node url=\"#a\"/></node>", "this node contains itself"),
        ("<node id=\"a\"><node id=\"b\"><instance_node url=\"#a\"/></node></node>", "this node contains itself"),
        (
            "<node id=\"a\"><instance_node url=\"#b\"/></node><node id=\"b\"><instance_node url=\"#a\"/></node>",
            "this node contains itself",
        ),
        ("<node><instance_node url=\"#quad\"/></node>", "\"quad\" must be a <node>"),
        ("<node><matrix>1 2 3</matrix></node>", "<matrix> needs 16 numbers, not 3"),
        ("<node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1</matrix></node>", "a projective transform"),
        ("<node><rotate>0 0 0 90</rotate></node>", "<rotate> needs an axis"),
        ("<node><lookat>0 0 0 1 1 1 0 1 0</lookat></node>", "<lookat> is not supported"),
        ("<node><scale>1e200 1 1</scale><scale>1e200 1 1</scale></node>", "left the range of numbers"),
    ] {
        fails(&more("", text), message);
    }
    let deep = |n: usize| format!("{}{}", "<node>".repeat(n), "</node>".repeat(n));
    assert!(read_text(&more("", &deep(256))).is_ok());
    fails(&more("", &deep(257)), "more than 256 nodes inside one another");
    fails(&more("", &deep(100_000)), "more than 256 nodes inside one another");
    // Each level has the next one twice.
    let tree: String = (0..40)
        .map(|i| {
            format!("<node id=\"n{i}\"><instance_node url=\"#n{0}\"/><instance_node url=\"#n{0}\"/></node>", i + 1)
        })
        .collect();
    let error = fails(&more("", &format!("<node id=\"n40\"/>{tree}")), "more than 262144 nodes");
    assert!(matches!(error, Error::Limit { .. }));
    // Few nodes, but each leads to much.
    let filler = " ".repeat(1 << 20);
    let large = format!(
        "<geometry id=\"m\">{filler}<extra><technique profile=\"CGL\"><sphere><radius>1</radius></sphere></technique></extra></geometry>"
    );
    let error = fails(&more(&large, &INSTANCE.repeat(1100)), "its instances are more than 1024 MiB");
    assert!(matches!(error, Error::Limit { .. }));
}

#[test]
fn broken_xml_is_refused_with_its_place() {
    let whole = more("", "");
    for (text, message) in [
        (whole.replacen("<mesh>", "<mesh", 1), "s.dae:7:1: broken XML"),
        (whole.replacen("</mesh>", "</mash>", 1), "s.dae:10:1: broken XML"),
        (format!("<!DOCTYPE a [<!ENTITY b \"c\">]>{whole}"), "broken XML"),
        (whole.replacen("60", "&b;", 1), "s.dae:4:"),
        (whole.split_once("60<").unwrap().0.into(), "s.dae:4:66: the file ends in the middle"),
        (String::new(), "s.dae:1:1: the file ends in the middle of its XML"),
        ("solid stl".into(), "s.dae:1:1: broken XML"),
        (
            whole.replacen("<scene>", "<scenes>", 1).replacen("</scene>", "</scenes>", 1),
            "<COLLADA> has no scene/instance",
        ),
    ] {
        fails(&text, message);
    }
    // Latin-1, a byte order mark and DOS line ends.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.dae");
    std::fs::write(&path, b"<a>\xe9</a>").unwrap();
    let error = read(&path, &ColladaOptions::default()).unwrap_err();
    assert!(error.to_string().contains("s.dae, byte 3: not UTF-8"), "{error}");
    let dos = format!("\u{feff}{}", whole.replace('\n', "\r\n"));
    assert_eq!(read_text(&dos).unwrap().scene.objects[0].shape, read_text(&whole).unwrap().scene.objects[0].shape);
    fails(&dos.replacen("1 1 0", "1 ! 0", 1), "s.dae:7:63: \"!\" is not a finite number");
    assert!(matches!(read(Path::new("no/such.dae"), &ColladaOptions::default()), Err(Error::Io { .. })));
}

#[test]
fn files_cut_or_changed_anywhere_break_nothing() {
    let light = format!("<light id=\"lamp\">{}</light>", common("area", "3 2 1"));
    let glass = effect(
        "g",
        "<glass><transmittance>1 1 1</transmittance><reflectance>1 1 1</reflectance><ior>1.5</ior></glass>",
    );
    let nodes = format!("{}<node><scale>2 2 2</scale><instance_light url=\"#lamp\"/></node>", bound("ball", "g", ""));
    let whole = more(&format!("{light}{glass}"), &nodes);
    for end in 0..whole.trim_end().len() {
        assert!(read_text(&whole[..end]).is_err(), "cut at {end}");
    }
    let mut state = 1u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let words = ["0", "-1", "1e308", "nan", "#scene", "#quad", "#lamp", "", "node", "4294967295", "\"", "<p>", "1 2"];
    let pieces: Vec<&str> = whole.split_inclusive([' ', '>', '<', '"', '#']).collect();
    let mut read = 0;
    for _ in 0..2000 {
        let mut some = pieces.clone();
        for _ in 0..1 + random(2) {
            let (at, word) = (random(some.len()), random(words.len() + pieces.len()));
            some[at] = if word < words.len() { words[word] } else { pieces[word - words.len()] };
        }
        if let Ok(imported) = read_text(&some.concat()) {
            assert!(imported.scene.camera.position.is_finite());
            read += 1;
        }
    }
    assert!(read > 10, "some mutations must leave a scene: {read}");
}
