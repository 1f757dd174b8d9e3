//! Scenes in pbrt's formats: what they become, what is refused and where, and that no input breaks the reader.

use etalon::envmap::EnvMap;
use etalon::import::{Imported, pbrt};
use etalon::raster::{Image, Rgb};
use etalon::scene::builtin::{SPHERE_ENV_SCALE, sphere_env};
use etalon::scene::{
    Camera, Conductor, Distribution, Emission, Environment, Falloff, Light, Material, Object, Projection, Request,
    Role, Shape,
};
use etalon::{Error, Result};
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Every texel of the test map has its own colour.
fn stub(_: &Path) -> Result<Image> {
    Ok(Image::from_fn(16, 8, |x, y| Rgb::new(x as f32, y as f32, 1.0)))
}

fn read_file(path: &Path) -> Result<Imported> {
    pbrt::read(path, &pbrt::PbrtOptions { environment: None, load_map: &stub })
}

/// Reads the first of `files` from a folder that holds them all.
fn read_files(files: &[(&str, &[u8])]) -> Result<Imported> {
    let dir = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::create_dir_all(dir.path().join(name).parent().unwrap()).unwrap();
        std::fs::write(dir.path().join(name), bytes).unwrap();
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
    let asked = std::cell::RefCell::new(PathBuf::new());
    let load = |path: &Path| {
        *asked.borrow_mut() = path.into();
        stub(path)
    };
    let found = pbrt::read(&path, &pbrt::PbrtOptions { environment: None, load_map: &load }).unwrap();
    assert_eq!(*asked.borrow(), path.with_file_name("textures/grace_latlong.exr"));
    let map = Arc::new(EnvMap::new(stub(&path).unwrap()));
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
fn lights_lie_as_pbrt_lays_them() {
    let light = |transform: &str| {
        let text = in_world(&format!("{transform} LightSource \"infinite\" \"string mapname\" \"m\""));
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

#[test]
fn maps_are_loaded_or_stood_in_for() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.pbrt");
    let load = |text: &str, load_map: &dyn Fn(&Path) -> Result<Image>| {
        std::fs::write(&path, in_world(text)).unwrap();
        pbrt::read(&path, &pbrt::PbrtOptions { environment: None, load_map })
    };
    let v4 = "LightSource \"infinite\" \"string filename\" \"m.exr\"";
    let error = fails(load(v4, &|_| Ok(Image::new(4, 4))), "s.pbrt:7:24: the map \"m.exr\" (4 x 4) is not lat-long");
    assert!(matches!(error, Error::Unsupported { .. }) && error.hint().is_some());
    // A missing map is reported where the file names it, other trouble where it is.
    let light = "LightSource \"infinite\"\n\"string mapname\" \"m.exr\"";
    let missing = load(light, &|path| Err(Error::io(path, std::io::ErrorKind::NotFound.into())));
    assert!(fails(missing, "s.pbrt:8:1: cannot read the map").hint().is_some());
    fails(load(light, &|path| Err(Error::input(path, "broken"))), "m.exr: broken");
    // A map that is given stands in for the file's, which is not opened.
    let refuse = |_: &Path| -> Result<Image> { panic!("opened") };
    let given = Some((Arc::new(EnvMap::new(Image::new(3, 3))), "given".to_owned()));
    let options = pbrt::PbrtOptions { environment: given, load_map: &refuse };
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
fn what_a_file_leaves_open_is_said() {
    let warnings = with_options("").unwrap().warnings;
    assert_eq!(warnings.len(), 3, "film, sampler, integrator: {warnings:?}");
    let warned = |text: &str, message: &str| {
        let warnings = with_options(text).unwrap().warnings;
        assert!(warnings.iter().any(|w| w.contains(message)), "{warnings:?}");
    };
    warned("Accelerator \"kdtree\" \"integer intersectcost\" 80", "Accelerator \"kdtree\" cannot change this picture");
    warned("\nSampler \"halton\"", "scene.pbrt:2:1: Sampler \"halton\" sets no number of samples: 16 per pixel");
    warned("Film \"rgb\"", "no PixelFilter");
    warned("\"float shutteropen\" 0", "has no effect here");
    assert!(with_options("ColorSpace \"srgb\"").is_ok());
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
        read(&text).unwrap().scene.objects[0].material
    };
    let grey = |albedo| Material::Diffuse { albedo: Rgb::splat(albedo) };
    assert_eq!((material("Attribute"), material("Transform")), (grey(0.5), grey(1.0)));
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
    let one = objects("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1]");
    assert!(matches!(&one[0].shape, Shape::Mesh(mesh) if mesh.triangles == [[0, 1, 2]]));
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
    let white = Emission { radiance: Rgb::ONE, two_sided: false, role: Role::Lamp };
    assert_eq!(emission(""), white);
    let bright = Emission { radiance: Rgb::new(2.0, 4.0, 8.0), two_sided: true, ..white };
    assert_eq!(emission("\"rgb L\" [4 8 16] \"float scale\" .5 \"bool twosided\" true"), bright);
    assert_eq!(emission("\"color L\" [1 1 2] \"color scale\" [2 4 4] \"bool twosided\" [\"true\"]"), bright);
    let text =
        "AttributeBegin AreaLightSource \"area\" Material \"mirror\" Shape \"sphere\" AttributeEnd Shape \"sphere\"";
    let both = objects(text);
    assert_eq!((both[0].emission, both[1].emission), (Some(white), None));
    assert_eq!(both[0].material, Material::Mirror { reflectance: Rgb::splat(0.9) });
    // The lamp that asks for the most samples decides.
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
    let material = |text: &str| objects(&format!("Material {text} Shape \"sphere\""))[0].material;
    assert_eq!(material("\"mirror\" \"rgb Kr\" [1 .5 0]"), Material::Mirror { reflectance: Rgb::new(1.0, 0.5, 0.0) });
    let glass = |eta| Material::Glass { reflectance: Rgb::ONE, transmittance: Rgb::ONE, eta };
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
    assert_eq!(tinted, Material::Glass { reflectance, transmittance, eta: 1.5 });
    let conductor = |text: &str| match material(text) {
        Material::Conductor(conductor) => conductor,
        other => panic!("{other:?}"),
    };
    let gold = conductor(
        "\"conductor\" \"rgb eta\" [.2 .4 1.3] \"rgb k\" [3 2 1] \"float roughness\" .25 \"bool remaproughness\" false \
         \"string distribution\" \"beckmann\"",
    );
    let (eta, k) = (Rgb::new(0.2, 0.4, 1.3), Rgb::new(3.0, 2.0, 1.0));
    assert_eq!(gold, Conductor { eta, k, alpha: 0.25, distribution: Distribution::Beckmann });
    let v4 = conductor("\"conductor\" \"float uroughness\" .25 \"float vroughness\" .25");
    assert_eq!((v4.alpha, v4.distribution), (0.5, Distribution::Ggx), "the square root");
    assert_eq!(conductor("\"conductor\"").alpha, 0.0);
    let v3 = conductor("\"metal\" \"float roughness\" 1");
    assert_eq!((v3.alpha, v3.distribution), (1.62142, Distribution::Ggx), "the polynomial");
    assert!((conductor("\"metal\"").alpha - 0.138_924).abs() < 1e-6, "0.01");
    // Copper where nothing is said, and metals by name; both are noted.
    let named = in_world("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\"");
    let warnings = read(&named).unwrap().warnings;
    assert!(warnings[0].contains("eta is gold's at 614, 549 and 466 nm"), "{warnings:?}");
    assert!(warnings[1].contains("k is copper's"), "{warnings:?}");
    assert_eq!(conductor("\"conductor\" \"spectrum k\" \"metal-Ag-k\"").k, Rgb::new(4.1283, 3.5892, 2.8132));
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
        let lamps: Vec<&Object> = imported.scene.objects.iter().filter(|o| o.emission.is_some()).collect();
        assert_eq!(lamps.len(), usize::from(rectangles > 0), "{name}");
        for lamp in lamps {
            let Shape::Rectangle(lamp) = lamp.shape else { panic!("{lamp:?}") };
            assert_eq!((lamp.normal(), lamp.centre()), (Vec3::NEG_Y, Vec3::new(0.0, 1.495, 0.0)), "{name}");
        }
    }
}

#[test]
fn files_include_files() {
    let main = in_world("Include \"parts/a.pbrt\"\nShape \"sphere\"\nImport \"b.pbrt\" Shape \"sphere\"");
    let a: &[u8] = b"Translate 1 0 0 Include \"b.pbrt\"";
    let b: &[u8] = b"Translate 0 1 0 Shape \"sphere\"";
    let scene = read_files(&[("m.pbrt", main.as_bytes()), ("parts/a.pbrt", a), ("b.pbrt", b)]).unwrap();
    let centres: Vec<_> = spheres(&scene).iter().map(|(centre, _)| centre.truncate().to_array()).collect();
    assert_eq!(centres, [[1.0, 1.0], [1.0, 1.0], [1.0, 2.0], [1.0, 1.0]], "Import gives the transform back");
    let main = in_world("Include \"a.pbrt\"");
    let including = |a: &[u8]| read_files(&[("m.pbrt", main.as_bytes()), ("a.pbrt", a)]);
    fails(including(b"\n Shape \"cone\""), "a.pbrt:2:2: Shape \"cone\" is not supported");
    fails(including(b" Include \"a.pbrt\""), "a.pbrt includes itself");
    fails(including(b" Include \"m.pbrt\""), "m.pbrt includes itself");
    fails(read(&main), "scene.pbrt:7:1: cannot read");
    fails(read(&in_world("Include \".\"")), "scene.pbrt:7:1: cannot read");
    let blocks = in_world("Import \"a.pbrt\" AttributeEnd");
    let open = read_files(&[("m.pbrt", blocks.as_bytes()), ("a.pbrt", b"AttributeBegin")]);
    fails(open, "a.pbrt:1:1: this AttributeBegin is never closed");
    let blocks = in_world("AttributeBegin Import \"a.pbrt\"");
    let closed = read_files(&[("m.pbrt", blocks.as_bytes()), ("a.pbrt", b" AttributeEnd AttributeBegin")]);
    fails(closed, "a.pbrt:1:2: AttributeEnd without AttributeBegin");
}

#[test]
fn chains_and_trees_of_files_end() {
    let chain: Vec<(String, String)> = (0..40)
        .map(|i| (format!("{i}.pbrt"), format!("Include \"{}.pbrt\"", i + 1)))
        .chain([("40.pbrt".into(), String::new())])
        .collect();
    let files: Vec<(&str, &[u8])> = chain.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
    fails(read_files(&files), "31.pbrt:1:1: more than 32 files include one another");
    // Each file includes the next one many times; only the total of bytes stops that.
    let tree: Vec<(String, String)> =
        (0..20).map(|i| (format!("{i}.pbrt"), format!("Include \"{}.pbrt\"\n", i + 1).repeat(50))).collect();
    let wide = format!("{}{}", "#".repeat(1 << 20), "\nInclude \"empty\"");
    let mut files: Vec<(&str, &[u8])> = tree.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
    files.extend([("20.pbrt", wide.as_bytes()), ("empty", b"")]);
    let error = fails(read_files(&files), "20.pbrt: with this, the scene's files exceed 64 MiB");
    assert!(matches!(error, Error::Limit { .. }));
}

#[test]
fn what_cannot_be_honoured_is_refused_with_its_place() {
    for (text, message) in [
        ("Shape \"cone\"", "Shape \"cone\""),
        ("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"texture alpha\" \"t\"", "\"texture alpha\""),
        ("Shape \"sphere\" \"float zmin\" 0", "zmin 0"),
        ("Shape \"sphere\" \"float phimax\" 90", "phimax 90"),
        ("Shape \"sphere\" \"rgb Kd\" [1 1 1]", "the parameter \"rgb Kd\""),
        ("Scale 1 2 1 Shape \"sphere\"", "ellipsoid"),
        ("AreaLightSource \"diffuse\" \"float power\" 10", "\"float power\""),
        ("AreaLightSource \"sphere\"", "AreaLightSource \"sphere\""),
        ("LightSource \"spot\"", "LightSource \"spot\""),
        ("Scale 2 2 2 LightSource \"point\" \"point from\" [1 0 0]", "lies elsewhere in pbrt-v3"),
        ("LightSource \"distant\" \"float illuminance\" 1", "\"float illuminance\""),
        ("LightSource \"infinite\" \"blackbody L\" 5000", "\"blackbody L\""),
        ("LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"", "\"spectrum L\""),
        ("LightSource \"infinite\" \"float illuminance\" 1", "\"float illuminance\""),
        ("LightSource \"infinite\" LightSource \"infinite\"", "a second light"),
        ("Material \"plastic\"", "Material \"plastic\""),
        ("Material \"glass\" \"float uroughness\" .1", "uroughness 0.1"),
        ("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"", "\"spectrum eta\""),
        ("Material \"dielectric\" \"rgb Kr\" [1 1 1]", "\"rgb Kr\""),
        ("Material \"metal\" \"float uroughness\" .1 \"float vroughness\" .2", "0.1 and 0.2"),
        ("Material \"metal\" \"spectrum eta\" \"spds/Au.eta.spd\"", "\"spds/Au.eta.spd\" is not known"),
        ("Material \"conductor\" \"spectrum k\" \"metal-Au-eta\"", "\"metal-Au-eta\" is not known"),
        ("Material \"conductor\" \"spectrum k\" [400 1 700 2]", "by its samples"),
        ("Material \"conductor\" \"string distribution\" \"blinn\"", "the distribution \"blinn\""),
        ("ReverseOrientation Material \"glass\" Shape \"sphere\"", "ReverseOrientation of a sphere"),
        ("Material \"matte\" \"texture Kd\" \"checks\"", "\"texture Kd\""),
        ("Material \"matte\" \"float sigma\" 20", "sigma 20"),
        ("MakeNamedMaterial \"a\" \"string type\" \"hair\"", "MakeNamedMaterial \"a\" of type \"hair\""),
        ("Texture \"checks\" \"color\" \"checkerboard\"", "Texture"),
        ("ObjectBegin \"a\"", "ObjectBegin"),
        ("MediumInterface \"\" \"fog\"", "MediumInterface"),
        ("ConcatTransform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]", "projective"),
        ("WorldEnd WorldBegin", "\"WorldBegin\" after WorldEnd"),
    ] {
        let error = fails(read(&in_world(text)), message);
        assert!(matches!(error, Error::Unsupported { .. }), "{error:?}");
        assert!(error.to_string().contains("scene.pbrt:7:"), "{error}");
    }
    for (text, message) in [
        ("Camera \"realistic\"", "Camera \"realistic\""),
        ("\"float lensradius\" .1", "lensradius 0.1"),
        ("Film \"spectral\"", "Film \"spectral\""),
        ("Film \"image\" \"float cropwindow\" [0 .5 0 1]", "crop window"),
        ("Film \"rgb\" \"float iso\" 200", "iso 200"),
        ("PixelFilter \"gaussian\"", "PixelFilter \"gaussian\""),
        ("PixelFilter \"box\" \"float xwidth\" 1", "xwidth 1"),
        ("Sampler \"adaptive\"", "Sampler \"adaptive\""),
        ("Integrator \"bdpt\"", "Integrator \"bdpt\""),
        ("Integrator \"path\" \"bool regularize\" true", "regularize"),
        ("Renderer \"metropolis\"", "Renderer \"metropolis\""),
        ("SurfaceIntegrator \"path\" WorldBegin Material \"metal\"", "Material \"metal\" of pbrt-v2"),
        ("ColorSpace \"rec2020\"", "ColorSpace \"rec2020\""),
        ("Option \"bool disablepixeljitter\" true", "Option"),
    ] {
        let error = fails(with_options(text), message);
        assert!(matches!(error, Error::Unsupported { .. }), "{error:?}");
    }
}

#[test]
fn what_is_wrong_is_refused_with_its_place() {
    let deep = "TransformBegin\n".repeat(1025);
    let mesh =
        |rest: &str| format!("Shape \"trianglemesh\" \"integer indices\" {rest} \"point3 P\" [0 0 0 1 0 0 0 1 0]");
    for (text, message) in [
        ("Sphere", ":7:1: \"Sphere\" is not a directive"),
        ("Camera \"perspective\"", ":7:1: Camera belongs before WorldBegin"),
        ("  [", ":7:3: expected a directive, not \"[\""),
        ("Shape \"sphere\" \"float radius\" [0]", ":7:16: Shape \"sphere\": \"float radius\" must be positive"),
        ("Shape \"sphere\" \"float radius\" nan", "needs a value, not \"nan\""),
        ("Shape \"sphere\" \"float radius\" 1e30", "out of range"),
        ("Translate 1e30 0 0 Shape \"sphere\"", "out of range"),
        ("Scale 1e-30 1e-30 1e-30 Shape \"sphere\"", "out of range"),
        ("Scale 1 0 1", ":7:1: this transform cannot be undone"),
        ("Scale 1e90 1 1 Scale 1e300 1 1", ":7:16: the transform has left the range"),
        ("Rotate 90 0 0 0", ":7:1: Rotate needs an axis"),
        ("LookAt 0 0 0 0 0 0 0 1 0", ":7:1: LookAt needs"),
        ("Translate 1 2", "Translate needs 3 numbers, not \"WorldEnd\""),
        ("Translate [1 2 3 4]", ":7:18: Translate needs 3 numbers and then \"]\""),
        ("Material \"matte\" \"rgb Kd\" [2 0 0]", "must be from 0 to 1, not 2"),
        ("Material \"matte\" \"rgb Kd\" [1 1]", "needs 3 numbers, not 2"),
        ("LightSource \"infinite\" \"rgb L\" [-1 0 0]", "must be from 0"),
        ("LightSource \"distant\" \"point to\" [0 0 0]", ":7:1: LightSource \"distant\" needs from and to apart"),
        ("LightSource \"point\" \"point from\" [1e20 0 0]", "out of range"),
        ("AreaLightSource \"diffuse\" \"rgb L\" [1e30 0 0] \"float scale\" 1e30", "L times scale is out of range"),
        ("Material \"glass\" \"float index\" 0", "must be above 0"),
        ("Material \"conductor\" \"float roughness\" 2", "must be from 0 to 1, not 2"),
        ("Shape \"trianglemesh\" \"integer indices\" [0 1 2]", ":7:1: Shape \"trianglemesh\" needs \"point3 P\""),
        ("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1 1]", "needs \"integer indices\""),
        ("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1]", "needs groups of 3 numbers, not 4 in all"),
        (&mesh("[0 1 3]"), ":7:22: Shape \"trianglemesh\": vertex 3 of 3"),
        (&mesh("[0 1 -1]"), "vertex -1 of 3"),
        (&mesh("[0 1 .5]"), "vertex 0.5 of 3"),
        (&mesh("[0 1]"), "needs groups of 3 numbers"),
        (&mesh("[0 1 2] \"normal N\" [0 0 1]"), "has 3 P, but 1 N"),
        (&mesh("[0 1 2] \"normal N\" [0 0 1 0 0 0 0 0 1]"), "a normal has no direction"),
        ("Translate 1e20 0 0 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]", "out of range"),
        ("Shape \"plymesh\"", "Shape \"plymesh\" needs a \"string filename\""),
        ("Shape \"plymesh\" \"string filename\" \"no.ply\"", ":7:17: cannot read"),
        ("LightSource \"infinite\" \"integer nsamples\" 0", "must be a whole number from 1"),
        ("NamedMaterial \"a\"", ":7:1: no material named \"a\""),
        ("CoordSysTransform \"a\"", ":7:1: no coordinate system named \"a\""),
        ("AttributeBegin", ":7:1: this AttributeBegin is never closed"),
        ("AttributeEnd", ":7:1: AttributeEnd without AttributeBegin"),
        ("AttributeBegin TransformEnd", ":7:16: TransformEnd where AttributeBegin is still open"),
        (deep.as_str(), ":1031:1: more than 1024 blocks"),
    ] {
        let error = fails(read(&in_world(text)), message);
        assert!(matches!(error, Error::Input { .. }), "{error:?}");
    }
    for (text, message) in [
        ("Film \"image\" \"integer xresolution\" 0", "must be a whole number from 1 to 65536, not 0"),
        ("Film \"image\" \"integer xresolution\" 65536 \"integer yresolution\" 65536", "are more than"),
        ("Sampler \"random\" \"integer pixelsamples\" -4", "must be a whole number"),
        ("\"float screenwindow\" [1 -1 -1 1]", ":1:23: screenwindow must be"),
        ("Shape \"sphere\"", "Shape belongs after WorldBegin"),
    ] {
        fails(with_options(text), message);
    }
    fails(read(""), "scene.pbrt: the file has no WorldBegin");
    fails(read("WorldBegin WorldEnd"), "scene.pbrt: the file sets no camera");
    assert!(matches!(read_file(Path::new("no/such.pbrt")), Err(Error::Io { .. })));
}

#[test]
fn a_file_cut_anywhere_breaks_nothing() {
    for end in 0..SMALL.len() {
        let text = &SMALL[..end];
        // A scene need not have a WorldEnd, so some of the cuts between directives leave a whole one.
        let between = ["WorldBegin", "AttributeEnd", "\"matte\"", "]", "TransformEnd"];
        let whole = text.contains("WorldBegin") && between.iter().any(|last| text.trim_end().ends_with(last));
        assert!(read(text).is_err() || whole, "{text}");
    }
}

#[test]
fn token_soup_breaks_nothing() {
    let small = SMALL.replace("# left-handed", "");
    let scene: Vec<&str> = small.split_ascii_whitespace().collect();
    let mut words = scene.clone();
    words.extend([
        "[",
        "]",
        "\"",
        "\\",
        "-",
        "1e308",
        "-1",
        "0",
        "\"float fov\"",
        "true",
        "WorldBegin",
        "TransformEnd",
    ]);
    let mut state = 1u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("soup.pbrt");
    let mut whole = 0;
    for round in 0..3000 {
        let soup: Vec<&str> = if round % 2 == 0 {
            (0..random(60)).map(|_| words[random(words.len())]).collect()
        } else {
            let mut some = scene.clone();
            for _ in 0..1 + random(3) {
                let at = random(some.len());
                some[at] = words[random(words.len())];
            }
            some
        };
        let text = soup.join(" ");
        std::fs::write(&path, &text).unwrap();
        if let Ok(scene) = read_file(&path) {
            assert!(spheres(&scene).iter().all(|(centre, radius)| *radius > 0.0 && centre.is_finite()), "{text}");
            whole += 1;
        }
    }
    assert!(whole > 10, "some mutations must leave a scene: {whole}");
}
