//! Exported scenes are read again, or checked as text.

use super::*;
use crate::bsdf::{Bsdf, ThinDielectric};
use crate::envmap::EnvMap;
use crate::import::{self, SceneOptions};
use crate::math::Rgb;
use crate::raster::Image;
use crate::scene::{Environment, Material, Mesh, Shape, builtin};
use glam::DVec3;
use std::sync::Arc;

fn made(name: &str) -> (Scene, Request) {
    let map = Image::from_fn(16, 8, |x, y| Rgb::new(0.2 + x as f32 / 16.0, 0.5 + y as f32 / 16.0, 1.0));
    let entry = builtin::find(name).unwrap();
    let environment = entry.map_scale().map(|scale| Environment::upright(Arc::new(EnvMap::new(map)), "test", scale));
    entry.make(environment, None).unwrap()
}

/// Exports, and reads the file as pbrt's.
fn reread(scene: &Scene, request: &Request) -> (Scene, Request) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("again.pbrt");
    let exported = write(&path, scene, request).unwrap();
    assert_eq!(exported.files.last(), Some(&path));
    assert!(exported.files.iter().all(|file| file.exists()));
    let imported = import::read_scene(&path, &SceneOptions::default()).unwrap();
    (imported.scene, imported.request)
}

fn same_camera(a: &Scene, b: &Scene) -> bool {
    [[0.1, 0.2], [0.9, 0.7]].iter().all(|&[x, y]| {
        let (a, b) = (a.camera.ray(x, y), b.camera.ray(x, y));
        a.origin.distance(b.origin) < 1e-5 && a.direction.distance(b.direction) < 1e-6
    })
}

#[test]
fn a_pbrt_file_holds_the_scene() {
    for name in ["cornell-spheres", "cornell-lambert"] {
        let (scene, request) = made(name);
        let (again, asked) = reread(&scene, &request);
        let Request { width, height, spp, max_depth, .. } = asked;
        assert_eq!((width, height, spp, max_depth), (request.width, request.height, request.spp, request.max_depth));
        assert!(same_camera(&scene, &again), "{:?}", again.camera);
        assert_eq!(scene.objects.len(), again.objects.len());
        for (a, b) in scene.objects.iter().zip(&again.objects) {
            assert_eq!(a.emission, b.emission);
            match (&a.shape, &b.shape) {
                (Shape::Sphere(a), Shape::Sphere(b)) => assert_eq!(a, b),
                (Shape::Rectangle(a), Shape::Rectangle(b)) => {
                    assert!(a.centre().distance(b.centre()) < 1e-6 && a.normal().distance(b.normal()) < 1e-6);
                    assert!((a.area() - b.area()).abs() < 1e-5);
                }
                (a, b) => panic!("{a:?} became {b:?}"),
            }
            let is_mirror = matches!(a.material, Material::Mirror { .. });
            assert!(is_mirror && matches!(b.material, Material::Conductor(_)) || a.material == b.material);
        }
    }
}

#[test]
fn thin_slabs_come_back() {
    let (mut scene, request) = made("cornell-lambert");
    let slab = Material::from(Bsdf::ThinDielectric(ThinDielectric { eta: 1.3 }));
    let number = scene.objects.iter().position(|object| matches!(object.shape, Shape::Sphere(_))).unwrap();
    scene.objects[number].material = slab.clone();
    assert_eq!(reread(&scene, &request).0.objects[number].material, slab);
}

#[test]
fn environment_maps_keep_their_directions() {
    // One texel shines: it must be found in its direction, in pbrt's turned frame, with its power.
    for (x, y) in [(3, 1), (12, 4), (7, 6)] {
        let map = Image::from_fn(16, 8, |i, j| if (i, j) == (x, y) { Rgb::ONE } else { Rgb::ZERO });
        let environment = Environment::upright(Arc::new(EnvMap::new(map)), "test", 2.0);
        let direction = environment.map.geometry().direction_in_texel(x, y, 0.5, 0.5);
        let (scene, request) = builtin::sphere_env(environment);
        let (again, _) = reread(&scene, &request);
        assert!(same_camera(&scene, &again));
        let light = again.environment.unwrap();
        let geometry = light.map.geometry();
        let texels = (0..geometry.width()).flat_map(|i| (0..geometry.height()).map(move |j| (i, j)));
        let (mut power, mut mean) = (0.0, DVec3::ZERO);
        for (i, j) in texels {
            let share = f64::from(light.radiance_in_texel((i, j)).x) * geometry.solid_angle(j);
            power += share;
            mean += share * (light.to_world * geometry.direction_in_texel(i, j, 0.5, 0.5));
        }
        // A texel is 22.5 degrees wide; a wrong axis or turn moves it by at least one.
        let degrees = mean.angle_between(direction).to_degrees();
        assert!(degrees < 22.5 / 4.0, "texel {x}, {y} is found {degrees} degrees away");
        // Both maps take 16 strata of a texel.
        let expected = 2.0 * scene.environment.unwrap().map.geometry().solid_angle(y);
        assert!((power / expected - 1.0).abs() < 0.15, "{power} {expected}");
    }
}

#[test]
fn what_a_format_lacks_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let export = |name: &str, extension: &str| {
        let (scene, request) = made(name);
        let result = write(&folder.path().join(format!("{name}.{extension}")), &scene, &request);
        result.map_err(|e| e.to_string())
    };
    assert!(export("cornell-statue-au", "pbrt").unwrap_err().contains("Beckmann"));
    assert!(export("brushed-metal", "pbrt").unwrap_err().contains("one side"));
    assert!(export("sphere-env", "dae").unwrap_err().contains("extension"));
    // Nothing is left behind.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let (mut scene, request) = made("cornell-spheres");
    let quoted = write(&folder.path().join("a\"b.pbrt"), &scene, &request);
    assert!(matches!(quoted, Err(Error::Parameter(_))));
    let unwritable = write(&folder.path().join("missing.pbrt/a.xml"), &scene, &request);
    assert!(unwritable.is_ok(), "folders are made");
    scene.camera.filter = "gaussian".parse().unwrap();
    assert!(matches!(write(&folder.path().join("a.xml"), &scene, &request), Err(Error::Unsupported(_))));
}

#[test]
fn every_scene_has_an_xml_file_whose_files_exist() {
    let folder = tempfile::tempdir().unwrap();
    for entry in builtin::scenes() {
        let (scene, request) = made(&entry.name);
        let path = folder.path().join(format!("{}.xml", entry.name));
        let exported = write(&path, &scene, &request).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let scale = entry.map_scale().map(|scale| format!("the environment map times {scale} -->"));
        assert!(scale.is_none_or(|scale| text.contains(&scale)), "{text}");
        let document = roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{}: {e}", entry.name));
        let count = |tag: &str| document.descendants().filter(|node| node.has_tag_name(tag)).count();
        assert_eq!(count("shape"), scene.objects.len(), "{}", entry.name);
        let named = document.descendants().filter(|node| node.attribute("name") == Some("filename"));
        let named: Vec<PathBuf> = named.map(|node| folder.path().join(node.attribute("value").unwrap())).collect();
        assert_eq!(exported.files, [named, vec![path]].concat());
        assert_eq!(exported.notes.is_empty(), ["cornell-spheres", "cornell-lambert"].contains(&entry.name.as_str()));
    }
}

#[test]
fn meshes_come_back_from_their_files() {
    let (scene, _) = made("brushed-metal");
    let Some(Shape::Mesh(disc)) = scene.objects.iter().map(|o| &o.shape).find(|s| matches!(s, Shape::Mesh(_))) else {
        panic!("the scene has a disc")
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("disc.ply");
    std::fs::write(&path, encode_ply(disc)).unwrap();
    let again = import::mesh::read(&path, &mut Vec::new()).unwrap();
    let corners =
        |mesh: &Mesh| -> Vec<_> { mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).collect() };
    assert!(corners(disc) == corners(&again) && disc.uv == again.uv);
    let mut smooth = (**disc).clone();
    smooth.uv.clear();
    smooth.smooth();
    std::fs::write(&path, encode_ply(&smooth)).unwrap();
    let again = import::mesh::read(&path, &mut Vec::new()).unwrap();
    assert!(again.positions == smooth.positions && again.triangles == smooth.triangles);
    // Normals are made unit vectors again.
    assert!(again.normals.iter().zip(&smooth.normals).all(|(a, b)| a.distance(*b) < 1e-6));
}
