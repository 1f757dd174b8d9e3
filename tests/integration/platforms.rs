//! A processor without AVX2 renders the same images: the program under emulation, where an emulator is installed.

use crate::program::etalon;
use crate::render::layers;
use std::process::Command;

#[test]
fn images_are_the_same_without_avx2() {
    const EMULATOR: &str = "qemu-x86_64";
    if cfg!(not(target_arch = "x86_64")) || Command::new(EMULATOR).arg("--version").output().is_err() {
        return eprintln!("skipped: {EMULATOR} does not run here");
    }
    let program = assert_cmd::cargo::cargo_bin("etalon");
    for line in [
        "cornell-spheres -r 40 30 -s 2",
        "cornell-statue-au -r 40 30 -s 2",
        "sphere-env -r 32 32 -s 4",
        "furnace -r 40 10 -s 2 -m 20",
        "brushed-metal -r 30 20 -s 2",
    ] {
        let images = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let args: Vec<&str> = ["render"].into_iter().chain(line.split(' ')).chain(["-o", "image.exr"]).collect();
        assert_eq!(etalon(images[0].path(), &args).code, 0, "{line}");
        let mut emulated = Command::new(EMULATOR);
        emulated.args(["-cpu", "Nehalem"]).arg(&program).args(&args).current_dir(images[1].path());
        let ran = emulated.output().unwrap();
        assert!(ran.status.success(), "{line}: {}", String::from_utf8_lossy(&ran.stderr));
        let [native, emulated] = images.map(|folder| layers(&folder.path().join("image.exr")));
        assert!(native == emulated, "{line}: the images differ");
    }
}
