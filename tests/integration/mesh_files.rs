//! Mesh files: every encoding gives the same mesh, damage is refused with its place, and no input breaks the reader.

use etalon::import::mesh;
use etalon::scene::Mesh;
use etalon::{Error, Result};
use glam::{Vec2, Vec3};
use std::path::Path;

/// Reads bytes as a file of this name.
fn read_warned(name: &str, bytes: &[u8]) -> (Result<Mesh>, Vec<String>) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let mut warnings = Vec::new();
    (mesh::read(&path, &mut warnings), warnings)
}

fn read(name: &str, bytes: &[u8]) -> Result<Mesh> {
    let (mesh, warnings) = read_warned(name, bytes);
    assert_eq!(warnings, [""; 0]);
    mesh
}

#[track_caller]
fn fails(name: &str, bytes: &[u8], message: &str) -> Error {
    let error = read_warned(name, bytes).0.expect_err(message);
    assert!(error.to_string().contains(message), "{error}\n  does not contain\n{message}");
    error
}

/// A square and a triangle on it, with normals and things that are not read.
const ROWS: [[f32; 6]; 5] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 2.0],
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0, 0.0, 1.0, 0.0],
    [0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    [0.0, 2.5, -0.5, 1.0, 0.0, 0.0],
];

fn expected(normals: bool) -> Mesh {
    let vector = |row: [f32; 6], i: usize| Vec3::from_slice(&row[i..]);
    Mesh {
        positions: ROWS.iter().map(|&row| vector(row, 0)).collect(),
        normals: if normals { ROWS.iter().map(|&row| vector(row, 3).normalize()).collect() } else { Vec::new() },
        triangles: vec![[0, 1, 2], [0, 2, 3], [3, 2, 4]],
        uv: Vec::new(),
    }
}

fn header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a test\nelement vertex 5\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty float nx\nproperty float ny\nproperty float nz\n\
         element mark 1\nproperty list uchar double weights\nproperty short id\n\
         element face 2\nproperty int8 flag\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn ascii() -> String {
    let rows: String = ROWS.iter().map(|[x, y, z, nx, ny, nz]| format!("{x} {y} {z} 200 {nx} {ny} {nz}\n")).collect();
    format!("{}{rows}2 0.5 0.25 -7\n-1 4 0 1 2 3\n0 3 3 2 4\n", header("ascii"))
}

fn binary(big: bool) -> Vec<u8> {
    let order = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    let float = |x: f32| order(x.to_le_bytes().into());
    let mut bytes = header(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
    for row in ROWS {
        bytes.extend(row[..3].iter().flat_map(|&x| float(x)));
        bytes.push(200);
        bytes.extend(row[3..].iter().flat_map(|&x| float(x)));
    }
    bytes.push(2);
    bytes.extend([0.5f64, 0.25].iter().flat_map(|x| order(x.to_le_bytes().into())));
    bytes.extend(order((-7i16).to_le_bytes().into()));
    for (flag, face) in [(-1i8, &[0i32, 1, 2, 3][..]), (0, &[3, 2, 4])] {
        bytes.extend([flag as u8, face.len() as u8]);
        bytes.extend(face.iter().flat_map(|i| order(i.to_le_bytes().into())));
    }
    bytes
}

#[test]
fn every_encoding_gives_the_same_mesh() {
    assert_eq!(read("a.ply", ascii().as_bytes()).unwrap(), expected(true));
    for (old, new) in [("\n", "\r\n"), ("\n", "\r"), ("float ", "float32 "), ("vertex_indices", "vertex_index")] {
        assert_eq!(read("a.PLY", ascii().replace(old, new).as_bytes()).unwrap(), expected(true), "{new:?}");
    }
    let bom = |text: &str| [b"\xef\xbb\xbf", text.as_bytes()].concat();
    assert_eq!(read("a.ply", &bom(&ascii())).unwrap(), expected(true));
    for big in [false, true] {
        assert_eq!(read("a.ply", &binary(big)).unwrap(), expected(true), "big endian: {big}");
    }
    let plain = ascii().replace("property float nx", "property float mx");
    assert_eq!(read("a.ply", plain.as_bytes()).unwrap(), expected(false));
    let empty_rows = ascii().replace("element face", "element nothing 18446744073709551615\nelement face");
    assert_eq!(read("a.ply", empty_rows.as_bytes()).unwrap(), expected(true));
    let obj = "# a test\no box\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1 2/1 3 -1\nv 0 2.5 \\\n -0.5\ns 1\nf 4 3 5";
    assert_eq!(read("a.obj", obj.as_bytes()).unwrap(), expected(false));
    assert_eq!(read("a.obj", &bom(&obj.replace("# a test\n", ""))).unwrap(), expected(false));
}

#[test]
fn normals_of_corners_split_vertices() {
    let points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 2\nvn 0 3 0\n";
    let mesh = read("a.obj", format!("{points}f 1//1 2//1 3//1\nvt 0\nf 1//1 3//2 4/1/-2\n").as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 4]]);
    assert_eq!(mesh.positions[2], mesh.positions[3]);
    assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Z]);
    for (faces, warning) in
        [("f 1//1 2//1 3", "some corners have no normal"), ("vn 0 0 0\nf 1//1 2//3 3//1", "a normal has no direction")]
    {
        let (mesh, warnings) = read_warned("a.obj", format!("{points}{faces}").as_bytes());
        assert!(warnings.len() == 1 && warnings[0].contains(warning), "{warnings:?}");
        let mesh = mesh.unwrap();
        assert_eq!((mesh.normals.len(), mesh.positions.len(), &mesh.triangles[..]), (0, 4, &[[0, 1, 2]][..]));
    }
    let (_, warnings) = read_warned("a.obj", format!("mtllib a.mtl\n{points}usemtl b\nf 1 2 3\nusemtl c\n").as_bytes());
    assert_eq!(warnings.len(), 2, "one of each kind: {warnings:?}");
    assert!(warnings[1].ends_with("a.obj:8:1: \"usemtl\" is left out"), "{warnings:?}");
}

#[test]
fn texture_coordinates_belong_to_corners() {
    let points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1\nvt 1 1 7\nvt 5 5\n";
    let mesh = read("a.obj", format!("{points}f 1/1 2/2 3/3\nf 1/-1 3/3 4/1\n").as_bytes()).unwrap();
    let expected = [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[5.0, 5.0], [1.0, 1.0], [0.0, 0.0]]];
    assert_eq!((mesh.positions.len(), &mesh.uv[..]), (4, &expected.map(|corners| corners.map(Vec2::from))[..]));
    assert!(mesh.validate().is_ok() && mesh.tangent(0) == Some(Vec3::X));
    assert_eq!(read("a.obj", format!("{points}f 1/1 2/2 3\n").as_bytes()).unwrap().uv.len(), 0, "not all corners");
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
        let names = ascii().replace("property float nx", &format!("property float {u}"));
        let mesh =
            read("a.ply", names.replace("property float ny", &format!("property float {v}")).as_bytes()).unwrap();
        assert_eq!((mesh.normals.len(), mesh.uv[2]), (0, [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]].map(Vec2::from)));
    }
    let not_finite =
        ascii().replace("property float nx", "property float u").replace("property float ny", "property float v");
    let not_finite = not_finite.replacen("200 0 0", "200 nan 0", 1);
    assert_eq!(read("a.ply", not_finite.as_bytes()).unwrap().uv.len(), 0);
}

#[test]
fn wrong_plys_are_refused_with_their_place() {
    let change = |old: &str, new: &str| {
        assert!(ascii().contains(old), "{old}");
        ascii().replacen(old, new, 1)
    };
    for (text, message) in [
        ("plx\n".into(), "this is no PLY file"),
        (header("ascii").replace("end_header\n", ""), "a.ply:18:1: the file ends before its header's end_header"),
        (change("comment a test\n", &"comment\n".repeat(10_000)), "a.ply:10001:1: a header of more than 10000 lines"),
        (change("format ascii", "format utf8"), "a.ply:2:1: the format \"utf8\""),
        (change("format ascii 1.0\n", ""), "no format line"),
        (change("ascii 1.0", "ascii 2.0"), "a.ply:2:1: "),
        (change("vertex 5", "vertex -5"), "a.ply:4:1: \"-5\" is no count"),
        (change("vertex 5", "vertex 18446744073709551615"), "the header claims 18446744073709551615 \"vertex\""),
        (change("face 2", "face 4000000000"), "bytes follow"),
        (change("element mark", "element vertex"), "a.ply:12:1: a second element"),
        (change("float x", "half x"), "a.ply:5:1: \"half\" is no type"),
        (change("list uchar int", "list uchar"), "a.ply:17:1: a property is"),
        (change("property float x", "property float w"), "the vertices have no x"),
        (change("vertex 5", "vertex 5\nelement points 5"), "the vertices have no x"),
        (change("vertex_indices", "corners"), "the faces have no list vertex_indices"),
        (change("face 2", "face 2\nelement polygons 2"), "the faces have no list vertex_indices"),
        (change("element face", "element faces"), "the file has points, but no faces"),
        (change("1 1 0 200", "1 nan 0 200"), "a.ply:21:1: a vertex at 1 NaN 0 is not finite"),
        (change("1 1 0 200", "1 1e30 0 200"), "out of range"),
        (change("1 1 0 200", "1 1 O 200"), "a.ply:21:5: \"O\" is not a number"),
        (change("-1 4 0 1 2 3", "-1 4 0 1 2 5"), "a.ply:25:1: vertex 5 of 5"),
        (change("-1 4 0 1 2 3", "-1 4 0 1 2 -3"), "vertex -3 of 5"),
        (change("-1 4 0 1 2 3", "-1 4 0 1 2 .5"), "vertex 0.5 of 5"),
        (change("0 3 3 2 4", "0 2 3 2"), "a.ply:26:1: a face of 2 corners"),
        (change("0 3 3 2 4", "0 4 3 2 4"), "a.ply:27:1: the file ends before"),
        (change("0 3 3 2 4", "0 -3 3 2 4"), "a.ply:26:3: a list of -3 numbers"),
        (change("0 3 3 2 4", "0 1e300 3 2 4"), "the file ends before"),
    ] {
        let error = fails("a.ply", text.as_bytes(), message);
        assert!(matches!(error, Error::Input { .. } | Error::Unsupported { .. }));
    }
    let mut nan = binary(false);
    let body = header("binary_little_endian").len();
    nan[body + 4..body + 8].copy_from_slice(&f32::NAN.to_le_bytes());
    fails("a.ply", &nan, &format!("a.ply, byte {body}: a vertex at 0 NaN 0"));
    assert!(fails("a.ply", &binary(true)[..body + 20], "but only").hint().is_some());
}

#[test]
fn wrong_objs_are_refused_with_their_place() {
    let points = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    for (text, message) in [
        ("f 1 2 4", "a.obj:4:7: vertex 4 does not exist: there are 3 so far"),
        ("f 1 2 -4", "a.obj:4:7: vertex -4 does not exist"),
        ("f 1 2 0", "a.obj:4:7: \"0\" is not a vertex"),
        ("f 1 2 x", "a.obj:4:7: \"x\" is not a vertex"),
        ("f 1 2 99999999999999999999", "is not a vertex"),
        ("f 1 2 -9223372036854775808", "does not exist"),
        ("f 1//1 2 3", "a.obj:4:3: normal 1 does not exist: there are 0"),
        ("f 1/1 2 3", "a.obj:4:3: texture coordinate 1 does not exist: there are 0"),
        ("vt", "a.obj:4:1: \"vt\" needs a number"),
        ("vt 0 x", "a.obj:4:6: \"x\" is not a finite number"),
        ("f 1 2", "a.obj:4:1: a face of 2 corners"),
        ("v 1 2", "a.obj:4:1: \"v\" needs 3 numbers, not 2"),
        ("v 1 nan 0", "a.obj:4:5: \"nan\" is not a finite number"),
        ("v 1 1e30 0", "out of range"),
        ("surf 0 1 0 1 1 2 3", "\"surf\" is not supported"),
        ("\u{0}\u{1}", "is no statement of an OBJ file"),
        ("# nothing else", "the file has no faces"),
    ] {
        fails("a.obj", format!("{points}{text}\n").as_bytes(), message);
    }
    fails("a.obj", b"\xff\xd8", "a.obj:1:1: ");
    assert!(fails("a.ply.gz", b"", "not a mesh file").hint().is_some());
    assert!(matches!(mesh::read(Path::new("no/such.obj"), &mut Vec::new()), Err(Error::Io { .. })));
}

#[test]
fn files_cut_anywhere_break_nothing() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf -1 -2 -3\n".as_bytes().to_vec();
    let files = [("a.ply", ascii().into_bytes()), ("a.ply", binary(false)), ("a.ply", binary(true)), ("a.obj", obj)];
    for (name, whole) in files {
        for end in 0..whole.len() - 1 {
            let cut = read_warned(name, &whole[..end]).0;
            // A text may lose digits of its last number, and an OBJ file may end after any line.
            assert!(cut.is_err() || end + 2 > whole.len() || name == "a.obj", "{name} cut at {end}");
        }
    }
}

#[test]
fn real_meshes_are_read() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    for (name, points, triangles, normals) in [
        ("assets/meshes/bunny.obj", 1839, 3674, 0),
        ("assets/meshes/dragon_vrip_res3.ply", 22998, 47794, 0),
        ("peers/knot.ply", 50000, 100_000, 50000),
    ] {
        let path = shared.join(name);
        if !path.exists() {
            println!("skipped: there is no {}", path.display());
            continue;
        }
        let mut warnings = Vec::new();
        let mesh = mesh::read(&path, &mut warnings).unwrap();
        assert_eq!((mesh.positions.len(), mesh.triangles.len(), mesh.normals.len()), (points, triangles, normals));
        assert_eq!(warnings, [""; 0], "{name}");
    }
}
