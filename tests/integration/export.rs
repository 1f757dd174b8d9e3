//! `etalon scenes --export`: files of other renderers, and what cannot be exported.

use super::program::etalon;

#[test]
fn both_formats_stand_beside_each_other_and_are_read_again() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["sphere-env.pbrt", "sphere-env.xml", "cornell-lambert.pbrt"] {
        let ran = etalon(folder.path(), &["scenes", "--export", name]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stdout.contains(&format!("wrote {name}")), "{}", ran.stdout);
    }
    for name in ["sphere-env.pbrt", "cornell-lambert.pbrt"] {
        let ran = etalon(folder.path(), &["render", name, "-r", "16", "12", "-s", "1", "-o", "image.exr"]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
    }
}

#[test]
fn what_cannot_be_exported_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for (name, says) in [
        ("room.xml", "--export: \"room\" is no built-in scene"),
        ("cornell-spheres.obj", "--export: no scene format has the extension"),
        ("furnace.pbrt", "Beckmann"),
        ("brushed-metal.pbrt", "one side"),
    ] {
        let ran = etalon(folder.path(), &["scenes", "--export", name]);
        assert!(ran.code == 2 && ran.stderr.contains(says), "{name}: {} {}", ran.code, ran.stderr);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
