//! Where things stand: axes, transforms, cameras and nodes.

use super::*;

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
    let sphere = |transforms: &str| {
        let text = format!("<node>{transforms}<instance_geometry url=\"#ball\"/></node>");
        match last(&more("", &text)).shape {
            Shape::Sphere(sphere) => (sphere.centre, sphere.radius),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(sphere(""), (Vec3::ZERO, 2.0));
    assert_eq!(sphere("<translate>1 2 3</translate><scale>.5 .5 .5</scale>"), (Vec3::new(1.0, 2.0, 3.0), 1.0));
    assert_eq!(sphere("<scale>2 2 2</scale><translate>1 2 3</translate>"), (Vec3::new(2.0, 4.0, 6.0), 4.0));
    assert_eq!(sphere("<rotate>0 0 1 90</rotate><translate>1 0 0</translate>"), (Vec3::Y, 2.0));
    let matrix = "<matrix sid=\"transform\">0 -2 0 4  2 0 0 5  0 0 2 6  0 0 0 1</matrix>";
    assert_eq!(sphere(matrix), (Vec3::new(4.0, 5.0, 6.0), 4.0));
    assert_eq!(
        sphere(&format!("<scale>9 9 9</scale>{matrix}<translate>1 1 1</translate>")).0,
        Vec3::new(4.0, 5.0, 6.0)
    );
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

/// The camera of one of the course's files lacks a number in the middle: `-1 0 0 0  0 0 1 3  0 [1] 0 0  0 0 0 1`. Their
/// renderer reads 12 numbers for three rows and looks at the scene all the same.
#[test]
fn a_matrix_without_a_number_in_the_middle_is_read_as_the_course_reads_it() {
    let matrix = "<matrix>-1 0 0 0 0 0 1 3 0 0 0 0 0 0 1</matrix>";
    let text = scene("Z_UP", "", &format!("<node>{matrix}<instance_camera url=\"#camera\"/></node>{QUAD}"));
    let imported = read_text(&text).unwrap();
    // From the origin to (0, 0, -1) + (0, 3, 0) of the file, where z is up: along +z.
    let camera = imported.scene.camera;
    assert!(camera.forward.abs_diff_eq(DVec3::NEG_Z, 1e-12) && camera.up.abs_diff_eq(DVec3::Y, 1e-12), "{camera:?}");
    let warning = &imported.warnings[0];
    assert!(warning.contains("s.dae:14:7: <matrix> has 15 numbers, not 16"), "{warning}");
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
    fails(&more("", "").replace(">60<", ">180<"), "s.dae:4:60: <xfov> must be between 0 and 180 degrees, not 180");
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
        read(&path, &SceneOptions { resolution, camera: Some(&settings), ..SceneOptions::default() })
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
        (
            "<node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1</matrix></node>",
            "<matrix> of 16 numbers with the last row [1",
        ),
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

/// A node's place is its column, which is not sought before it is needed.
#[test]
fn a_file_of_one_line_takes_no_longer() {
    let nodes = format!("{CAMERA}{QUAD}{}", "<node></node>\n".repeat(200_000));
    let lines = scene("Y_UP", "", &nodes);
    let [one_line, lines] = [lines.replace('\n', " "), lines].map(|text| {
        let start = std::time::Instant::now();
        read_text(&text).unwrap();
        start.elapsed()
    });
    assert!(one_line < 8 * lines, "{one_line:?} {lines:?}");
}
