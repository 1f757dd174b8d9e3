//! Older processors render the same images: the program under emulation, where an emulator is installed.

use crate::program::etalon;
use crate::render::layers;
use std::process::Command;

#[test]
#[ignore = "takes seconds: cargo test -- --ignored"]
fn images_are_the_same_without_wide_vectors() {
    const EMULATOR: &str = "qemu-x86_64";
    if cfg!(not(target_arch = "x86_64")) || Command::new(EMULATOR).arg("--version").output().is_err() {
        return eprintln!("skipped: {EMULATOR} does not run here");
    }
    let program = assert_cmd::cargo::cargo_bin("etalon");
    for line in [
        "cornell-spheres -r 40 30 -s 2",
        "cornell-spheres -r 40 30 -s 2 --sampling mis+lt",
        "cornell-statue-au -r 40 30 -s 2",
        "sphere-env -r 32 32 -s 4",
        "furnace -r 40 10 -s 2 -m 20",
        "brushed-metal -r 30 20 -s 2",
    ] {
        let args: Vec<&str> = ["render"].into_iter().chain(line.split(' ')).chain(["-o", "image.exr"]).collect();
        let native = tempfile::tempdir().unwrap();
        assert_eq!(etalon(native.path(), &args).code, 0, "{line}");
        let native = layers(&native.path().join("image.exr"));
        // The first has SSE4.2 and no AVX; the second AVX2 and FMA and no AVX-512.
        for processor in ["Nehalem", "Haswell"] {
            let folder = tempfile::tempdir().unwrap();
            let mut emulated = Command::new(EMULATOR);
            emulated.args(["-cpu", processor]).arg(&program).args(&args).current_dir(folder.path());
            let ran = emulated.output().unwrap();
            assert!(ran.status.success(), "{line}, {processor}: {}", String::from_utf8_lossy(&ran.stderr));
            assert!(layers(&folder.path().join("image.exr")) == native, "{line}, {processor}: the images differ");
        }
    }
}
