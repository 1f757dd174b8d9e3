//! The course's own files, where the folder with them stands beside the repository.

use super::*;

fn asset(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: there is no {}", path.display());
    None
}

fn sized(path: &Path, resolution: [usize; 2]) -> Imported {
    read(path, &SceneOptions { resolution: Some(resolution), ..SceneOptions::default() }).unwrap()
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
        let imported = read(&path, &SceneOptions::default()).unwrap();
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
    let glass = Material::Dielectric(Dielectric::clear(1.45));
    let mirror = Material::Mirror { reflectance: Rgb::ONE };
    for (object, material, centre) in
        [(spheres[0], glass, Vec3::new(0.4, 0.3, 0.3)), (spheres[1], mirror, Vec3::new(-0.4, 0.3, -0.3))]
    {
        let Shape::Sphere(sphere) = object.shape else { unreachable!() };
        assert!(sphere.centre.abs_diff_eq(centre, 1e-6) && (sphere.radius - 0.3).abs() < 1e-6, "{sphere:?}");
        assert_eq!((object.material.clone(), object.emission), (material, None));
    }
    let mut walls = Vec::new();
    for object in &imported.scene.objects {
        let Shape::Rectangle(wall) = object.shape else { continue };
        walls.push((wall.centre(), wall.normal()));
        let albedo = match (object.emission, wall.centre()) {
            (Some(emission), centre) => {
                let camera_only =
                    Emission { radiance: Rgb::splat(10.0), two_sided: true, visibility: EmitterVisibility::CameraOnly };
                assert_eq!(emission, camera_only);
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
    // Ceiling, area light, floor, left, right, back. The walls' corners run so that their fronts are outside, all of the box.
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
        assert_eq!(material, Material::Conductor(Conductor::new(eta, k, alpha, distribution)), "{name}");
        // Wound counter-clockwise as viewed from outside: the volume is positive.
        let volume = |[a, b, c]: [u32; 3]| {
            let [a, b, c] = [a, b, c].map(|i| mesh.positions[i as usize].as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        assert!(mesh.triangles.iter().map(|&t| volume(t)).sum::<f64>() > 0.0, "{name}");
    }
}

fn mesh_of(object: &Object) -> Option<(&etalon::scene::Mesh, Material)> {
    match &object.shape {
        Shape::Mesh(mesh) => Some((mesh, object.material.clone())),
        _ => None,
    }
}

#[test]
fn a_file_cut_off_in_its_numbers_says_so() {
    let Some(path) = asset("hostile/other/dragon_TRUNCATED_midarray.dae") else { return };
    let error = read(&path, &SceneOptions::default()).unwrap_err();
    assert!(matches!(error, Error::Input { .. }) && error.hint().is_some(), "{error:?}");
    assert!(error.to_string().contains("the file ends in the middle"), "{error}");
}
