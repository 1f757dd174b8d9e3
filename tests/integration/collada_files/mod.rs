//! Scenes in the course's COLLADA dialect: what they become, what is refused and where, and that no input breaks the
//! reader.

mod place;
mod real;
mod surface;

use etalon::import::collada::read;
use etalon::import::{Imported, SceneOptions};
use etalon::math::Rgb;
use etalon::scene::{
    Conductor, Dielectric, Distribution, Emission, EmitterVisibility, Falloff, Light, Material, Object, Projection,
    Rectangle, Request, Shape,
};
use etalon::{Error, Result};
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};

/// Horizontal and vertical field of view in degrees.
fn fields(imported: &Imported) -> [f64; 2] {
    match imported.scene.camera.projection {
        Projection::Perspective { tan_half_width, tan_half_height } => {
            [tan_half_width, tan_half_height].map(|t| 2.0 * t.atan().to_degrees())
        }
        Projection::Orthographic { .. } => panic!("not a perspective camera"),
    }
}

/// Reads text as a scene for the default resolution.
fn read_text(text: &str) -> Result<Imported> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.dae");
    std::fs::write(&path, text).unwrap();
    read(&path, &SceneOptions::default())
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
/// A node with the geometry `m`.
const INSTANCE: &str = r##"<node><instance_geometry url="#m"/></node>"##;

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

fn common(kind: &str, colour: &str) -> String {
    format!("<technique_common><{kind}><color>{colour}</color></{kind}></technique_common>")
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
    // What the parser would be slow at.
    let attributes: String = (0..200_000).map(|i| format!(" a{i}=\">\"")).collect();
    let nested: String = (0..20_000).map(|i| format!("<a xmlns:b{i}=\"c{i}\">")).collect();
    for (text, message) in [(format!("<a{attributes}/>"), "64 attributes"), (nested, "64 declarations of namespaces")] {
        assert!(matches!(fails(&text, message), Error::Limit { .. }));
    }
    // Latin-1, a byte order mark and DOS line ends.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("s.dae");
    std::fs::write(&path, b"<a>\xe9</a>").unwrap();
    let error = read(&path, &SceneOptions::default()).unwrap_err();
    assert!(error.to_string().contains("s.dae, byte 3: not UTF-8"), "{error}");
    let dos = format!("\u{feff}{}", whole.replace('\n', "\r\n"));
    assert_eq!(read_text(&dos).unwrap().scene.objects[0].shape, read_text(&whole).unwrap().scene.objects[0].shape);
    fails(&dos.replacen("1 1 0", "1 ! 0", 1), "s.dae:7:63: \"!\" is not a finite number");
    assert!(matches!(read(Path::new("no/such.dae"), &SceneOptions::default()), Err(Error::Io { .. })));
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
