//! Scenes in pbrt's formats: what they become, what is refused and where, and that no input breaks the reader.

mod content;
mod refusals;
mod spectra;
mod textures;

use etalon::envmap::EnvMap;
use etalon::import::{Imported, SceneOptions, pbrt};
use etalon::math::Rgb;
use etalon::raster::{Image, Metadata};
use etalon::scene::builtin::{SPHERE_ENV_SCALE, sphere_env};
use etalon::scene::{
    Camera, Conductor, Dielectric, Distribution, Emission, EmitterVisibility, Environment, Falloff, Light, Material,
    Object, Projection, Request, Shape,
};
use etalon::{Error, Result};
use glam::{DVec3, Vec3};
use std::path::Path;
use std::sync::Arc;

/// Every texel of the test map has its own colour.
fn map() -> Image {
    Image::from_fn(16, 8, |x, y| Rgb::new(x as f32, y as f32, 1.0))
}

fn write_map(path: &Path, map: &Image) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    etalon::raster::write(path, map, &Metadata::default()).unwrap();
}

fn read_file(path: &Path) -> Result<Imported> {
    pbrt::read(path, &SceneOptions::default())
}

/// Reads the first of `files` from a folder that holds them all, and the test map, if it is named.
fn read_files(files: &[(&str, &[u8])]) -> Result<Imported> {
    let dir = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::create_dir_all(dir.path().join(name).parent().unwrap()).unwrap();
        std::fs::write(dir.path().join(name), bytes).unwrap();
    }
    for name in ["m.exr", "maps/m.exr"] {
        if files.iter().any(|(_, bytes)| String::from_utf8_lossy(bytes).contains(&format!("\"{name}\""))) {
            write_map(&dir.path().join(name), &map());
        }
    }
    read_file(&dir.path().join(files[0].0))
}

fn read(text: &str) -> Result<Imported> {
    read_files(&[("scene.pbrt", text.as_bytes())])
}

/// A scene with all options set, so that nothing warns; `world` stands on line 7.
fn in_world(world: &str) -> String {
    format!(
        "Camera \"perspective\"\nFilm \"image\" \"integer xresolution\" 8 \"integer yresolution\" 4\nPixelFilter \"box\"\n\
         Sampler \"random\" \"integer pixelsamples\" 3\nIntegrator \"path\" \"integer maxdepth\" 2\nWorldBegin\n{world}\n\
         WorldEnd\n"
    )
}

/// An empty world after the given options.
fn with_options(options: &str) -> Result<Imported> {
    read(&format!("Camera \"orthographic\" {options}\nWorldBegin\nWorldEnd\n"))
}

#[track_caller]
fn fails(result: Result<Imported>, message: &str) -> Error {
    let error = result.expect_err(message);
    assert!(error.to_string().contains(message), "{error}\n  does not contain\n{message}");
    error
}

/// Centres and radii of a scene of spheres.
fn spheres(scene: &Imported) -> Vec<(Vec3, f32)> {
    let sphere = |object: &Object| match &object.shape {
        Shape::Sphere(sphere) => (sphere.centre, sphere.radius),
        other => panic!("not a sphere: {other:?}"),
    };
    scene.scene.objects.iter().map(sphere).collect()
}

fn sphere(scene: &Imported) -> (Vec3, f32) {
    spheres(scene)[0]
}

const SMALL: &str = r#"
Scale -1 1 1   # left-handed
LookAt 0 0 1  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [-1 1 -1 1]
Sampler "lowdiscrepancy" "integer pixelsamples" [3]
PixelFilter "box"
Film "image" "integer xresolution" [51] "integer yresolution" [51] "string filename" "a.pfm"
SurfaceIntegrator "directlighting" "integer maxdepth" 4 "string strategy" "all"
WorldBegin
AttributeBegin
  Rotate 90 1 0 0
  LightSource "infinite" "integer nsamples" 3 "color L" [8 4 2] "string mapname" "maps/m.exr"
AttributeEnd
MakeNamedMaterial "white" "string type" "matte" "rgb Kd" [1 .5 0]
TransformBegin Translate 1 2 3 Scale 2 2 2 NamedMaterial "white" Shape "sphere" "float radius" .5 TransformEnd
WorldEnd"#;

#[test]
fn the_first_reports_file_is_its_built_in_scene() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets/scenes/simple_sphere.pbrt");
    if !path.exists() {
        println!("skipped: {} is missing", path.display());
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let scene = dir.path().join("simple_sphere.pbrt");
    std::fs::copy(path, &scene).unwrap();
    let file = dir.path().join("textures/grace_latlong.exr");
    write_map(&file, &map());
    let found = read_file(&scene).unwrap();
    let map = Arc::new(EnvMap::new(map()));
    let (scene, request) = sphere_env(Environment::upright(map, "", SPHERE_ENV_SCALE));
    assert_eq!(found.scene.camera, scene.camera);
    assert_eq!(found.request, Request { spp: 4, ..request });
    assert_eq!((found.scene.name.as_str(), found.scene.objects.len()), ("simple_sphere", 1));
    assert_eq!(found.scene.objects[0].shape, scene.objects[0].shape);
    assert_eq!(found.scene.objects[0].material, scene.objects[0].material);
    let environment = found.scene.environment.unwrap();
    assert_eq!((environment.source.as_str(), environment.scale), ("textures/grace_latlong.exr", Rgb::splat(8.0)));
    // The file's image is stored with the floor on top.
    for (map, world) in [
        (DVec3::Y, DVec3::NEG_Y),
        (DVec3::X, DVec3::X),
        (DVec3::Z, DVec3::Z),
        (DVec3::NEG_X, DVec3::NEG_X),
        (DVec3::NEG_Z, DVec3::NEG_Z),
    ] {
        assert_eq!(environment.to_world * map, world);
    }
    assert_eq!(found.output, Some("simple_sphere.pfm".into()));
    assert_eq!(found.warnings, [""; 0]);
}

#[test]
fn a_small_scene_is_read_whole() {
    let scene = read(SMALL).unwrap();
    assert_eq!(scene.request, Request { width: 51, height: 51, spp: 4, light_samples: 4, max_depth: 1 });
    assert_eq!(sphere(&scene), (Vec3::new(1.0, 2.0, 3.0), 1.0));
    assert_eq!(scene.scene.objects[0].material, Material::Diffuse { albedo: Rgb::new(1.0, 0.5, 0.0) });
    assert_eq!(scene.scene.environment.unwrap().scale, Rgb::new(8.0, 4.0, 2.0));
    let orthographic = Projection::Orthographic { half_width: 1.0, half_height: 1.0 };
    let camera = Camera::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, orthographic).unwrap();
    assert_eq!(scene.scene.camera, camera, "x is to the right");
    assert_eq!(scene.warnings, [""; 0]);
    // The same with a byte order mark and DOS line ends.
    let dos = format!("\u{feff}{}", SMALL.replace('\n', "\r\n"));
    assert_eq!(read(&dos).unwrap().request, scene.request);
}

#[test]
fn maps_are_loaded_or_stood_in_for() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.pbrt");
    let file = dir.path().join("m.exr");
    let load = |text: &str| {
        std::fs::write(&path, in_world(text)).unwrap();
        read_file(&path)
    };
    let v4 = "LightSource \"infinite\" \"string filename\" \"m.exr\"";
    write_map(&file, &Image::new(4, 3));
    let error = fails(load(v4), "s.pbrt:7:24: the map \"m.exr\" (4 x 3) is neither square");
    assert!(matches!(error, Error::Unsupported { .. }));
    // pbrt-v4's square maps: what lies in the middle of the square is at the light's +z.
    write_map(&file, &Image::from_fn(4, 4, |x, y| Rgb::splat(if x.min(y) >= 1 && x.max(y) <= 2 { 8.0 } else { 1.0 })));
    let square = load(v4).unwrap();
    assert!(square.warnings[0].contains("s.pbrt:7:24: this equal-area map is resampled"), "{:?}", square.warnings);
    let square = square.scene.environment.unwrap();
    assert_eq!((square.radiance(DVec3::Z).x, square.radiance(DVec3::NEG_Z).x), (8.0, 1.0));
    // A missing map is reported where the file names it, other trouble where it is.
    let light = "LightSource \"infinite\"\n\"string mapname\" \"m.exr\"";
    std::fs::write(&file, b"broken").unwrap();
    fails(load(light), "m.exr: this is a text file");
    std::fs::remove_file(&file).unwrap();
    assert!(fails(load(light), "s.pbrt:8:1: cannot read").hint().is_some());
    // A map that is given stands in for the file's, which is not opened.
    let given = Some((Arc::new(EnvMap::new(Image::new(3, 3))), "given".to_owned()));
    let options = SceneOptions { environment: given, ..SceneOptions::default() };
    let environment = pbrt::read(&path, &options).unwrap().scene.environment.unwrap();
    assert_eq!((environment.source.as_str(), environment.map.geometry().width()), ("given", 3));
    std::fs::write(&path, in_world("LightSource \"infinite\"")).unwrap();
    assert!(pbrt::read(&path, &options).unwrap().warnings[0].contains("the given environment is not used"));
    std::fs::write(&path, in_world("")).unwrap();
    assert!(pbrt::read(&path, &options).unwrap().warnings[0].contains("the given environment is not used"));
}

#[test]
fn cameras_of_every_shape() {
    let camera = |text: &str, film: &str| {
        let film = format!("Film \"image\" {film}");
        read(&format!("{text} {film} WorldBegin WorldEnd")).map(|imported| imported.scene.camera)
    };
    let wide = "\"integer xresolution\" 200 \"integer yresolution\" 100";
    let tall = "\"integer xresolution\" 100 \"integer yresolution\" 200";
    #[track_caller]
    fn close(projection: Projection, perspective: bool, w: f64, h: f64) {
        let (is_perspective, x, y) = match projection {
            Projection::Orthographic { half_width, half_height } => (false, half_width, half_height),
            Projection::Perspective { tan_half_width, tan_half_height } => (true, tan_half_width, tan_half_height),
        };
        assert!(is_perspective == perspective && (x - w).abs() < 1e-12 && (y - h).abs() < 1e-12, "{x} {y}");
    }
    let perspective = |options: &str, film| camera(&format!("Camera \"perspective\" {options}"), film).unwrap();
    close(perspective("", wide).projection, true, 2.0, 1.0);
    close(perspective("", tall).projection, true, 1.0, 2.0);
    let third = 30f64.to_radians().tan();
    close(perspective("\"float fov\" 60", wide).projection, true, 2.0 * third, third);
    close(perspective("\"float halffov\" 30", wide).projection, true, 2.0 * third, third);
    close(perspective("\"float frameaspectratio\" 4", wide).projection, true, 4.0, 1.0);
    close(perspective("\"float screenwindow\" [-1 1 -3 3]", wide).projection, true, 1.0, 3.0);
    // A camera without transform: pbrt's x is to the right, y up, z ahead.
    let plain = perspective("", wide);
    assert_eq!((plain.right, plain.up, plain.forward), (DVec3::X, DVec3::Y, DVec3::Z));
    // Scales of the camera's frame change the window of parallel rays, and the angles of others only if they differ.
    let scaled = camera("Scale .5 .5 .5 Camera \"orthographic\"", wide).unwrap();
    close(scaled.projection, false, 4.0, 2.0);
    close(camera("Scale .5 .5 .5 Camera \"perspective\"", wide).unwrap().projection, true, 2.0, 1.0);
    close(camera("Scale 1 .5 1 Camera \"perspective\"", wide).unwrap().projection, true, 2.0, 2.0);
    // A window off the centre moves parallel rays.
    let moved = camera("Translate 0 0 -5 Camera \"orthographic\" \"float screenwindow\" [0 4 -3 1]", wide).unwrap();
    close(moved.projection, false, 2.0, 2.0);
    assert_eq!(moved.position, DVec3::new(2.0, -1.0, 5.0));
    let off = camera("Camera \"perspective\" \"float screenwindow\" [0 4 -3 1]", wide);
    assert!(off.unwrap_err().to_string().contains(":1:1: a perspective screenwindow must be symmetric"));
    let sheared = "ConcatTransform [1 0 0 0 1 1 0 0 0 0 1 0 0 0 0 1] Camera \"perspective\"";
    assert!(camera(sheared, wide).unwrap_err().to_string().contains("sheared"));
    assert!(camera("Translate 1e20 0 0 Camera \"perspective\"", wide).is_err());
}

#[test]
fn depths_and_samples_mean_what_each_version_means() {
    let request = |text: &str| with_options(text).unwrap().request;
    // pbrt-v2 counts the bounces between surfaces, its successors the surfaces.
    assert_eq!(request("SurfaceIntegrator \"path\" \"integer maxdepth\" 4").max_depth, 5);
    assert_eq!(request("Integrator \"path\" \"integer maxdepth\" 4").max_depth, 4);
    assert_eq!(request("Integrator \"directlighting\" \"integer maxdepth\" 4").max_depth, 1);
    let samples = |text: &str| {
        let light = "LightSource \"infinite\" \"integer nsamples\" 5";
        let request = read(&format!("Camera \"orthographic\" {text} WorldBegin {light}")).unwrap().request;
        (request.spp, request.light_samples)
    };
    let direct = "Integrator \"directlighting\"";
    assert_eq!(samples(&format!("{direct} Sampler \"lowdiscrepancy\" \"integer pixelsamples\" 17")), (32, 8));
    assert_eq!(samples(&format!("{direct} Sampler \"halton\" \"integer pixelsamples\" 17")), (17, 5));
    assert_eq!(samples(&format!("{direct} \"string strategy\" \"one\"")), (16, 1));
    assert_eq!(samples("Integrator \"path\"").1, 1);
    let stratified = "Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5 \"bool jitter\" [\"false\"]";
    assert_eq!(samples(stratified).0, 15);
}

#[test]
fn filters_have_the_defaults_of_each_version() {
    for (text, filter) in [
        ("", "box"),
        ("Film \"image\"", "box"),
        ("Film \"rgb\"", "gaussian:1.5,0.5"),
        ("Film \"rgb\" PixelFilter \"box\"", "box:0.5"),
        ("PixelFilter \"box\" \"float xwidth\" 1", "box:1x0.5"),
        ("PixelFilter \"triangle\"", "triangle:2"),
        ("PixelFilter \"triangle\" \"float xradius\" 1 \"float yradius\" 3", "triangle:1x3"),
        // Radius 1.5 in pbrt-v4 and 2 before it, in whichever order filter and film come.
        ("PixelFilter \"gaussian\"", "gaussian:2,0.5"),
        ("PixelFilter \"gaussian\" Film \"rgb\"", "gaussian:1.5,0.5"),
        ("Film \"image\" PixelFilter \"gaussian\" \"float alpha\" .5", "gaussian:2,1"),
        ("PixelFilter \"gaussian\" \"float sigma\" 1", "gaussian:1.5,1"),
        ("Film \"rgb\" PixelFilter \"gaussian\" \"float ywidth\" 1", "gaussian:2x1,0.5"),
    ] {
        let camera = with_options(text).unwrap().scene.camera;
        assert_eq!(camera.filter, filter.parse().unwrap(), "{text}");
    }
}

#[test]
fn what_a_file_leaves_open_is_said() {
    let warnings = with_options("").unwrap().warnings;
    assert_eq!(warnings.len(), 3, "film, sampler, integrator: {warnings:?}");
    let warned = |text: &str, message: &str| {
        let warnings = with_options(text).unwrap().warnings;
        assert!(warnings.iter().any(|w| w.contains(message)), "{warnings:?}");
    };
    warned("Accelerator \"kdtree\" \"integer intersectcost\" 80", "Accelerator \"kdtree\" cannot change this image");
    warned("\nSampler \"halton\"", "scene.pbrt:2:1: Sampler \"halton\" sets no number of samples: 16 per pixel");
    warned("Film \"rgb\"", "no PixelFilter: gaussian:1.5,0.5, as in pbrt-v4");
    warned("Integrator \"bdpt\" \"integer maxdepth\" 7", "Integrator \"bdpt\": read as \"path\"");
    assert_eq!(with_options("Integrator \"sppm\" \"integer maxdepth\" 7").unwrap().request.max_depth, 7);
    assert!(
        with_options("Film \"rgb\" \"string sensor\" \"cie1931\" \"float iso\" 50 \"float exposuretime\" 2").is_ok()
    );
    let medium =
        "MediumInterface \"\" \"\" MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1]";
    warned(medium, "MakeNamedMedium \"fog\": refused where it is used");
    warned("\"float shutteropen\" 0", "has no effect here");
    assert!(with_options("ColorSpace \"srgb\"").is_ok());
}

#[test]
fn instances_are_copies_in_the_current_coordinate_system() {
    let part = "Translate 1 0 0 Material \"mirror\" Shape \"sphere\" \"float radius\" 2";
    let object = format!("Translate 0 1 0 ObjectBegin \"a\" {part} ObjectEnd Identity");
    let instances = "ObjectInstance \"a\" Scale 2 2 2 ObjectInstance \"a\" Shape \"sphere\"";
    let read = read(&in_world(&format!("{object} {instances}"))).unwrap();
    let found = read.scene.objects.iter().map(|object| match object.shape {
        Shape::Sphere(sphere) => (sphere.centre, sphere.radius, matches!(object.material, Material::Mirror { .. })),
        _ => panic!("{object:?}"),
    });
    let place = |scale: f32| scale * Vec3::new(1.0, 1.0, 0.0);
    assert_eq!(found.collect::<Vec<_>>(), [(place(1.0), 2.0, true), (place(2.0), 4.0, true), (Vec3::ZERO, 2.0, false)]);
}

#[test]
fn transforms_nest_and_are_named() {
    let placed = |text: &str| sphere(&read(&in_world(&format!("{text} Shape \"sphere\""))).unwrap());
    assert_eq!(placed("Translate 1 2 3 Identity").0, Vec3::ZERO);
    assert_eq!(placed("Translate 1 0 0 Scale 2 2 2 Translate 1 0 0"), (Vec3::new(3.0, 0.0, 0.0), 2.0));
    let column_major = "[1 0 0 0 0 1 0 0 0 0 1 0 4 5 6 1]";
    assert_eq!(placed(&format!("Scale 9 9 9 Transform {column_major}")), (Vec3::new(4.0, 5.0, 6.0), 1.0));
    assert_eq!(placed(&format!("Scale 2 2 2 ConcatTransform {column_major}")).0, Vec3::new(8.0, 10.0, 12.0));
    assert_eq!(placed("Translate 1 0 0 CoordinateSystem \"a\" Identity CoordSysTransform \"a\"").0, Vec3::X);
    assert_eq!(placed("AttributeBegin Translate 1 0 0 AttributeEnd").0, Vec3::ZERO);
    assert_eq!(placed("Rotate 90 0 0 1 Translate 1 0 0 ReverseOrientation").0, Vec3::Y);
    assert_eq!(placed("Scale -1 1 1 Translate 1 0 0"), (Vec3::NEG_X, 1.0));
    let camera = "Translate 0 0 -7 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\" Shape \"sphere\"";
    assert_eq!(sphere(&read(camera).unwrap()).0, Vec3::new(0.0, 0.0, 7.0), "from camera to world");
    // AttributeEnd gives the material back, TransformEnd does not.
    let material = |block: &str| {
        let kd = "Material \"matte\" \"rgb Kd\" [1 1 1]";
        let text = in_world(&format!("{block}Begin {kd} {block}End Shape \"sphere\""));
        read(&text).unwrap().scene.objects[0].material.clone()
    };
    let grey = |albedo| Material::Diffuse { albedo: Rgb::splat(albedo) };
    assert_eq!((material("Attribute"), material("Transform")), (grey(0.5), grey(1.0)));
}

#[test]
fn the_scenes_for_comparisons_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/peers");
    if !folder.exists() {
        println!("skipped: there is no {}", folder.display());
        return;
    }
    for (name, spheres, rectangles, meshes) in [
        ("cornell_spheres", 2, 6, 0),
        ("cornell_microfacet_0.005", 1, 6, 0),
        ("cornell_microfacet_0.05", 1, 6, 0),
        ("cornell_microfacet_0.25", 1, 6, 0),
        ("cornell_microfacet_0.5", 1, 6, 0),
        ("cornell_knot_0.25", 0, 6, 1),
        ("diffuse_sphere_env", 1, 0, 0),
    ] {
        let imported = read_file(&folder.join(format!("{name}.pbrt"))).unwrap();
        let count = |kind: fn(&Shape) -> bool| imported.scene.objects.iter().filter(|o| kind(&o.shape)).count();
        let found = (
            count(|s| matches!(s, Shape::Sphere(_))),
            count(|s| matches!(s, Shape::Rectangle(_))),
            count(|s| matches!(s, Shape::Mesh(_))),
        );
        assert_eq!(found, (spheres, rectangles, meshes), "{name}");
        assert_eq!(imported.warnings, [""; 0], "{name}");
        let area_lights: Vec<&Object> = imported.scene.objects.iter().filter(|o| o.emission.is_some()).collect();
        assert_eq!(area_lights.len(), usize::from(rectangles > 0), "{name}");
        for light in area_lights {
            let Shape::Rectangle(rectangle) = light.shape else { panic!("{light:?}") };
            assert_eq!((rectangle.normal(), rectangle.centre()), (Vec3::NEG_Y, Vec3::new(0.0, 1.495, 0.0)), "{name}");
        }
    }
}
