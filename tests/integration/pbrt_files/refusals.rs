//! Files that include files, what is refused and where, and damaged files.

use super::*;

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
fn instances_and_warnings_are_limited() {
    // A list that has no effect counts, too.
    let shape = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer faceIndices\" [";
    let object = format!("ObjectBegin \"o\"\n{shape}{}]\nObjectEnd\n", "0 ".repeat(1 << 20));
    let many = in_world(&format!("{object}{}", "ObjectInstance \"o\"\n".repeat(64)));
    fails(read(&many), "scene.pbrt:73:1: \"o\": with this, the scene's instances exceed 512 MiB");
    // An object that says more than is shown, and then others.
    let disks = "Shape \"disk\"\n".repeat(500);
    let text = format!("ObjectBegin \"o\"\n{disks}ObjectEnd\nObjectInstance \"o\"\nObjectInstance \"o\"\n{disks}");
    let warnings = read(&in_world(&text)).unwrap().warnings;
    assert!(warnings.len() == 101 && warnings[99].contains("scene.pbrt:107:1"), "{warnings:?}");
    assert!(warnings[100].ends_with("scene.pbrt: further warnings are left out"), "{}", warnings[100]);
}

#[test]
fn nested_mixtures_and_many_small_files_end_soon() {
    let start = std::time::Instant::now();
    // Each line doubles the materials of the one before.
    let mut text = String::from("MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n");
    for i in 1..40 {
        text += &format!(
            "MakeNamedMaterial \"m{i}\" \"string type\" \"mix\" \"string materials\" [\"m{0}\" \"m{0}\"]\n",
            i - 1
        );
    }
    fails(read(&in_world(&text)), "a mixture of more than 64 materials");
    // A million files of a few bytes.
    let tree: Vec<(String, String)> =
        (0..20).map(|i| (format!("{i}.pbrt"), format!("Include \"{}.pbrt\"\n", i + 1).repeat(2))).collect();
    let mut files: Vec<(&str, &[u8])> = tree.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
    files.push(("20.pbrt", b""));
    fails(read_files(&files), "the scene's files exceed 64 MiB");
    assert!(start.elapsed() < std::time::Duration::from_secs(30), "{:?}", start.elapsed());
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
        ("LightSource \"infinite\" \"blackbody L\" 5000", "\"blackbody L\""),
        ("LightSource \"infinite\" \"spectrum L\" \"stdillum-D65\"", "\"spectrum L\""),
        (
            "LightSource \"infinite\" \"string mapname\" \"m.exr\" \"float illuminance\" 1",
            "the illuminance of a light with a map",
        ),
        ("LightSource \"infinite\" \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]", "\"point3 portal\""),
        ("Shape \"cylinder\"", "Shape \"cylinder\""),
        ("Shape \"disk\" \"float innerradius\" .5", "innerradius 0.5"),
        ("Shape \"disk\" \"float phimax\" 90", "phimax 90"),
        ("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 .1]", "no parallelogram"),
        ("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"normal N\" [0 0 1]", "\"normal N\""),
        ("Attribute \"shape\" \"float radius\" 2", "Attribute is not supported"),
        ("LightSource \"infinite\" LightSource \"infinite\"", "a second light"),
        ("Material \"plastic\"", "Material \"plastic\""),
        ("Material \"coateddiffuse\" \"rgb albedo\" [.1 0 0]", "a coat that scatters light"),
        ("Material \"dielectric\" \"spectrum eta\" \"glass-BK8\"", "\"glass-BK8\" is not known"),
        ("Material \"dielectric\" \"spectrum eta\" \"metal-Au-eta\"", "not known as the eta of this material"),
        ("Material \"conductor\" \"spectrum eta\" \"metal-TiO2-eta\"", "\"metal-TiO2-eta\" is not known"),
        ("Material \"matte\" \"spectrum Kd\" \"stdillum-D65\"", "\"stdillum-D65\" is not known as a reflectance"),
        ("Material \"matte\" \"xyz Kd\" [.1 .1 .1]", "\"xyz Kd\""),
        ("Material \"dielectric\" \"rgb Kr\" [1 1 1]", "\"rgb Kr\""),
        (
            "Material \"conductor\" \"float uroughness\" .1 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \
             \"vector3 S\" [1 0 0 1 0 0 1 0 0]",
            "tangents are those of the texture coordinates",
        ),
        ("Material \"metal\" \"spectrum eta\" \"spds/Au.eta.spd\"", "\"spds/Au.eta.spd\" is not known"),
        ("Material \"conductor\" \"spectrum k\" \"metal-Au-eta\"", "\"metal-Au-eta\" is not known"),
        ("Material \"conductor\" \"string distribution\" \"blinn\"", "the distribution \"blinn\""),
        ("ReverseOrientation Material \"glass\" Shape \"sphere\"", "ReverseOrientation of a sphere"),
        ("Material \"matte\" \"texture sigma\" \"checks\"", "\"texture sigma\""),
        ("MakeNamedMaterial \"a\" \"string type\" \"hair\"", "MakeNamedMaterial \"a\" of type \"hair\""),
        (
            "ObjectBegin \"a\" AreaLightSource \"diffuse\" Shape \"sphere\" ObjectEnd",
            "an area light in an object for ObjectInstance",
        ),
        ("MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" MediumInterface \"\" \"fog\"", "the medium \"fog\""),
        ("MediumInterface \"fog\"", "the medium \"fog\""),
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
        ("PixelFilter \"mitchell\" \"float B\" .3", "PixelFilter \"mitchell\" has negative lobes"),
        ("PixelFilter \"sinc\"", "scene.pbrt:1:23: PixelFilter \"sinc\" has negative lobes"),
        ("PixelFilter \"catrom\"", "PixelFilter \"catrom\""),
        ("PixelFilter \"gaussian\" \"float xradius\" 1 \"float alpha\" 2", "\"float alpha\" is not supported"),
        ("PixelFilter \"box\" \"float sigma\" 1", "\"float sigma\" is not supported"),
        ("Sampler \"adaptive\"", "Sampler \"adaptive\""),
        ("Film \"rgb\" \"float exposuretime\" .5", "exposuretime 0.5"),
        ("Film \"rgb\" \"string sensor\" \"canon_eos_100d\"", "the sensor \"canon_eos_100d\""),
        ("Film \"rgb\" \"float whitebalance\" 5000", "whitebalance 5000"),
        ("Integrator \"ambientocclusion\"", "Integrator \"ambientocclusion\""),
        ("Integrator \"bdpt\" \"bool visualizeweights\" true", "visualizeweights"),
        ("Integrator \"path\" \"bool regularize\" true", "regularize"),
        ("Renderer \"metropolis\"", "Renderer \"metropolis\""),
        ("SurfaceIntegrator \"path\" WorldBegin Material \"metal\"", "Material \"metal\" of pbrt-v2"),
        ("ColorSpace \"rec2020\"", "ColorSpace \"rec2020\""),
        ("Option \"bool disablepixeljitter\" true", "Option: disablepixeljitter"),
        ("Option \"bool disablewavelengthjitter\" true", "Option: disablewavelengthjitter"),
        ("Option \"bool forcediffuse\" true", "Option: forcediffuse"),
        ("Option \"float sharpness\" 1", "Option: the parameter \"float sharpness\""),
        (
            "Film \"rgb\" WorldBegin LightSource \"point\" \"spectrum I\" \"metal-Au-k\"",
            "\"metal-Au-k\" is not known as light",
        ),
        ("Film \"rgb\" \"integer pixelbounds\" [0 1 0 1]", "\"integer pixelbounds\""),
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
        ("ObjectBegin \"a\"", ":7:1: this ObjectBegin is never closed"),
        ("ObjectBegin \"a\" ObjectBegin \"b\"", ":7:17: ObjectBegin inside of an object"),
        ("ObjectBegin \"a\" ObjectInstance \"a\"", ":7:17: ObjectInstance inside of an object"),
        ("ObjectEnd", ":7:1: ObjectEnd without ObjectBegin"),
        ("ObjectInstance \"a\"", ":7:1: no object named \"a\""),
        ("  [", ":7:3: expected a directive, not \"[\""),
        ("Shape \"sphere\" \"float radius\" [0]", ":7:16: Shape \"sphere\": \"float radius\" must be positive"),
        ("Shape \"sphere\" \"float radius\" [1 2]", "needs 1 number, not 2"),
        ("Shape \"sphere\" \"float radius\" \"1\"", "has values of another type"),
        ("Shape \"sphere\" \"float radius\" [1 \"a\"]", ":7:34: "),
        ("Shape \"sphere\" \"float radius\" [1 [2]]", ":7:34: "),
        ("Shape \"sphere\" \"float radius\" []", ":7:32: "),
        ("Shape \"sphere\" \"float radius\" ]", ":7:31: "),
        ("Shape \"sphere\" \"float radius\" Shape", ":7:31: "),
        ("Shape \"sphere\" \"integer radius\" 1", "is not of type float"),
        ("Shape \"sphere\" \"float\" 1", "is not a type and a name"),
        ("Shape \"sphere\" \"float r r\" 1", "is not a type and a name"),
        ("Shape \"sphere\" \"double r\" 1", "unknown type"),
        ("Shape \"sphere\" \"float a\" 1 \"integer a\" 1", ":7:28: Shape \"sphere\" already has the parameter"),
        ("Shape sphere", ":7:7: Shape needs its kind in double quotes, not \"sphere\""),
        ("Shape \"plymesh\" \"string filename\" [\"a\" \"b\"]", "needs one string"),
        ("AreaLightSource \"diffuse\" \"bool twosided\" \"yes\"", "needs true or false"),
        ("LightSource \"infinite\" \"integer nsamples\" 2.5", "must be a whole number from 1"),
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
        ("Material \"matte\" \"float sigma\" 100", "must be from 0 to 90 degrees, not 100"),
        ("LightSource \"infinite\" \"rgb L\" [-1 0 0]", "must be from 0"),
        ("LightSource \"distant\" \"point to\" [0 0 0]", ":7:1: LightSource \"distant\" needs from and to apart"),
        ("LightSource \"point\" \"point from\" [1e20 0 0]", "out of range"),
        ("AreaLightSource \"diffuse\" \"rgb L\" [1e30 0 0] \"float scale\" 1e30", "L times scale is out of range"),
        ("Material \"glass\" \"float index\" 0", "must be from 0.001 to 1000, not 0"),
        ("Material \"dielectric\" \"float eta\" 1e-25", "must be from 0.001 to 1000, not 0.0"),
        ("Material \"conductor\" \"float roughness\" 2", "must be from 0 to 1, not 2"),
        ("Material \"mix\" \"string materials\" \"a\"", "of two names"),
        ("Material \"mix\" \"string materials\" [\"a\" \"b\"]", "no material named \"a\""),
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
        (
            "PixelFilter \"box\" \"float xwidth\" 17",
            ":1:41: PixelFilter \"box\": \"float xwidth\" must be from 0.01 to 16 pixels, not 17",
        ),
        ("PixelFilter \"triangle\" \"float yradius\" 0", "must be from 0.01"),
        ("PixelFilter \"gaussian\" \"float sigma\" -1", "must be from 0.01"),
        ("PixelFilter \"gaussian\" \"float alpha\" 0", "must be from 0.002"),
        ("\"float screenwindow\" [1 -1 -1 1]", ":1:23: screenwindow must be"),
        ("Shape \"sphere\"", "Shape belongs after WorldBegin"),
    ] {
        fails(with_options(text), message);
    }
    fails(read("Film"), ":1:1: the file ends where Film needs its kind");
    fails(read("Film \"rgb\" \"float r\""), ":1:12: the file ends where Film \"rgb\": \"float r\" needs a value");
    fails(read("Film \"rgb\" \"float r\" ["), ":1:22: Film \"rgb\": \"float r\": this bracket is never closed");
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
    write_map(&dir.path().join("maps/m.exr"), &map());
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
