//! Image files that are right but not what a lat-long map of linear RGB should be: refused, or read with a warning that
//! says what was guessed.

use crate::program::{etalon, json};
use etalon::math::Rgb;
use etalon::raster::{Image, Metadata, write};
use exr::meta::attribute::{Chromaticities, EnvironmentMap};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, SmallVec, Vec2, WritableImage,
};
use std::path::Path;

const SIZE: (usize, usize) = (8, 4);

/// An OpenEXR file with these channels, and whatever `change` adds to its attributes.
fn exr_file(
    path: &Path,
    channels: &[&str],
    change: impl FnOnce(&mut exr::prelude::Image<Layer<AnyChannels<FlatSamples>>>),
) {
    let samples = || FlatSamples::F32((0..SIZE.0 * SIZE.1).map(|i| 1.0 + i as f32).collect());
    let channels: Vec<_> = channels.iter().map(|&name| AnyChannel::new(name, samples())).collect();
    let channels = AnyChannels::sort(SmallVec::from_vec(channels));
    let layer = Layer::new(SIZE, LayerAttributes::named("main"), Encoding::SMALL_LOSSLESS, channels);
    let mut image = exr::prelude::Image::from_layer(layer);
    change(&mut image);
    image.write().to_file(path).unwrap();
}

#[test]
fn a_cube_map_is_no_lat_long_map() {
    let dir = tempfile::tempdir().unwrap();
    let file = |name: &str, kind| {
        exr_file(&dir.path().join(name), &["R", "G", "B"], |image| {
            image.layer_data.attributes.environment_map = Some(kind);
        });
    };
    file("cube.exr", EnvironmentMap::Cube);
    file("latlong.exr", EnvironmentMap::LatitudeLongitude);
    std::fs::write(
        dir.path().join("scene.pbrt"),
        "WorldBegin LightSource \"infinite\" \"string mapname\" \"cube.exr\" Shape \"sphere\"",
    )
    .unwrap();
    std::fs::write(dir.path().join("samples.csv"), "x,y,z\n0,0,1\n").unwrap();
    for line in [
        "envmap info cube.exr",
        "envmap sample cube.exr",
        "render sphere-env --envmap cube.exr",
        "render scene.pbrt",
        "validate --envmap cube.exr",
        "validate --samples samples.csv --pdf cube.exr",
        "converge sphere-env --envmap cube.exr",
        "reproduce --only sphere-8 --envmap cube.exr",
    ] {
        let ran = etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
        assert!(ran.code == 2 && ran.stderr.contains("cube.exr: this is a cube map"), "{line}: {}", ran.stderr);
    }
    let ran = etalon(dir.path(), &["envmap", "info", "latlong.exr"]);
    assert!(ran.code == 0 && ran.stderr.is_empty(), "{}", ran.stderr);
    assert_eq!(json(dir.path(), &["compare", "cube.exr", "latlong.exr"])["mse"], 0.0, "as images they are equal");
}

#[test]
fn what_is_guessed_about_channels_is_said() {
    let dir = tempfile::tempdir().unwrap();
    for (channels, code, expected) in [
        (&["R", "G", "B"][..], 0, &[][..]),
        (&["R", "G", "B", "A"], 0, &["a.exr: alpha, which is not 1 everywhere, is ignored"]),
        (&["Y"], 0, &["a.exr: there is luminance Y and no colour", "grey"]),
        (&["diffuse.R", "diffuse.G", "diffuse.B"], 0, &["a.exr: the layer \"diffuse\" is taken as the image"]),
        (&["G"], 0, &["a.exr: G is the only channel", "grey"]),
        (&["Z"], 0, &["a.exr: ", "\"z\"", "grey"]),
        (&["R", "G"], 0, &["a.exr: there is no channel B", "black"]),
        (&["X", "Y", "Z"], 2, &["\"X\", \"Y\", \"Z\"", "hint: "]),
        (&["u", "v"], 2, &["\"u\", \"v\"", "hint: "]),
        (
            &["albedo.R", "albedo.G", "albedo.B", "beauty.R", "beauty.G", "beauty.B"],
            2,
            &["\"albedo\", \"beauty\"", "hint: "],
        ),
    ] {
        exr_file(&dir.path().join("a.exr"), channels, |_| {});
        for args in [["envmap", "info", "a.exr"], ["compare", "a.exr", "a.exr"]] {
            let ran = etalon(dir.path(), &args);
            assert_eq!(ran.code, code, "{channels:?}: {}", ran.stderr);
            assert!(expected.iter().all(|words| ran.stderr.contains(words)), "{channels:?}: {}", ran.stderr);
            assert_eq!(ran.stderr.is_empty(), expected.is_empty(), "{channels:?}: {}", ran.stderr);
        }
    }
}

#[test]
fn other_primaries_are_said() {
    let dir = tempfile::tempdir().unwrap();
    let warned = |name: &str| {
        let ran = etalon(dir.path(), &["envmap", "info", name]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        ran.stderr.contains(&format!("warning: {name}: ")) && ran.stderr.contains("linear Rec. 709")
    };
    for (x, expected) in [(0.64, false), (0.708, true)] {
        let red = Vec2(x, 0.33);
        let (green, blue, white) = (Vec2(0.30, 0.60), Vec2(0.15, 0.06), Vec2(0.3127, 0.3290));
        exr_file(&dir.path().join("a.exr"), &["R", "G", "B"], |image| {
            image.attributes.chromaticities = Some(Chromaticities { red, green, blue, white });
        });
        let header = format!("#?RADIANCE\nPRIMARIES= {x} .33 .3 .6 .15 .06 .3127 .329\n\n-Y 1 +X 2\n");
        std::fs::write(dir.path().join("a.hdr"), [header.as_bytes(), &[128; 8]].concat()).unwrap();
        assert_eq!([warned("a.exr"), warned("a.hdr")], [expected; 2], "{x}");
    }
}

#[test]
fn a_compression_that_is_not_read_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    exr_file(&path, &["R", "G", "B"], |_| {});
    let mut bytes = std::fs::read(&path).unwrap();
    let mark = b"compression\0compression\0\x01\0\0\0";
    let at = bytes.windows(mark.len()).position(|window| window == mark).unwrap() + mark.len();
    for (method, name) in [(10, "HTJ2K"), (11, "HTJ2K"), (12, "number 12")] {
        bytes[at] = method;
        std::fs::write(&path, &bytes).unwrap();
        let ran = etalon(dir.path(), &["envmap", "info", "a.exr"]);
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        assert!(ran.stderr.contains(&format!("the OpenEXR compression {name}")), "{}", ran.stderr);
        assert!(ran.stderr.contains("exrmetrics --convert -z zip"), "{}", ran.stderr);
    }
}

#[test]
fn maps_beyond_the_range_of_renders_are_refused_everywhere() {
    let dir = tempfile::tempdir().unwrap();
    let mut image = Image::from_fn(8, 4, |_, _| Rgb::ONE);
    image.set(5, 2, Rgb::splat(1e20));
    write(&dir.path().join("hot.pfm"), &image, &Metadata::default()).unwrap();
    let scene = |more: &str| format!("WorldBegin LightSource \"infinite\" \"string mapname\" {more} Shape \"sphere\"");
    std::fs::write(dir.path().join("hot.pbrt"), scene("\"hot.pfm\"")).unwrap();
    for line in [
        "envmap info hot.pfm",
        "envmap sample hot.pfm",
        "render sphere-env --envmap hot.pfm",
        "render hot.pbrt",
        "validate map/hot --envmap hot.pfm",
        "converge sphere-env --envmap hot.pfm",
    ] {
        let ran = etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
        assert_eq!(ran.code, 2, "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains("hot.pfm: the texel in row 2, column 5 holds 1e20"), "{line}: {}", ran.stderr);
    }
    // A scale in the scene counts, too.
    write(&dir.path().join("warm.pfm"), &image.map(|p| p.min(Rgb::splat(1e15))), &Metadata::default()).unwrap();
    std::fs::write(dir.path().join("scaled.pbrt"), scene("\"warm.pfm\" \"rgb L\" [100 100 100]")).unwrap();
    let ran = etalon(dir.path(), &["render", "scaled.pbrt"]);
    assert!(ran.code == 2 && ran.stderr.contains("scaled.pbrt:1:12: "), "{}", ran.stderr);
    // Just inside the range the image is right: a constant map of 10^16, times 8, over a white sphere is that constant.
    write(&dir.path().join("bright.pfm"), &image.map(|_| Rgb::splat(1e16)), &Metadata::default()).unwrap();
    let value = json(dir.path(), &["render", "sphere-env", "--envmap", "bright.pfm", "-s", "4", "-r", "8", "8"]);
    assert_eq!(value["dropped"]["nonfinite"], 0, "{value}");
}

#[test]
fn light_outside_of_the_range_of_the_film_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let dim = |name: &str, value: f32| {
        let image = Image::from_fn(4, 2, |_, _| Rgb::splat(value));
        write(&dir.path().join(name), &image, &Metadata::default()).unwrap();
        etalon(dir.path(), &["render", "sphere-env", "--envmap", name, "-s", "4", "-r", "8", "8", "--json"])
    };
    // 8 times the radiance of the map, below and above 2^-64 = 5.4e-20.
    let black = dim("black.pfm", 1e-25);
    let value: serde_json::Value = serde_json::from_str(&black.stdout).unwrap();
    assert!(black.code == 0 && value["dropped"]["faint"].as_u64() == Some(4 * 64), "{value}");
    assert!(black.stderr.contains("up to 100.0 % of it (256 samples count as black)"), "{}", black.stderr);
    assert!(dim("faint.pfm", 1e-18).stderr.contains("rounding takes up to"));
    assert!(!dim("right.pfm", 1e-12).stderr.contains("rounding"));
    // Radiance from 2^63 on is dropped, and a comparison with dropped samples does not pass.
    let light = "LookAt 0 0 5 0 0 0 0 1 0 Camera \"perspective\" WorldBegin Shape \"sphere\" AttributeBegin Translate 0 0 3 \
                 AreaLightSource \"diffuse\" \"rgb L\" [1e25 1e25 1e25] Shape \"sphere\" \"float radius\" 0.1 AttributeEnd";
    std::fs::write(dir.path().join("huge.pbrt"), light).unwrap();
    let line = "converge huge.pbrt --strategies light,mis --budget 2 --max-spp 4";
    let ran = etalon(dir.path(), &line.split(' ').collect::<Vec<_>>());
    assert_ne!(ran.code, 0, "{}", ran.stdout);
    assert!((ran.stdout + &ran.stderr).contains("samples were not finite"), "{}", ran.stderr);
}
