//! The job script of the book, run with a stand-in for Slurm's `srun`: as an array, and with one task alone.

use crate::program::json;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

/// The book's script, for three small shares.
fn script() -> String {
    let page = include_str!("../../docs/src/cluster.md");
    let script = page.split("```").find(|block| block.contains("#SBATCH")).expect("the page has a job script");
    let script = script.strip_prefix("sh\n").expect("a block of shell commands");
    let changes = [("--array=1-16 ", "--array=1-3 "), ("tasks=16 ", "tasks=3 "), ("-s 16384 ", "-s 6 -r 24 18 ")];
    changes.into_iter().fold(script.to_owned(), |script, (old, new)| {
        assert_eq!(script.matches(old).count(), 1, "{old}: {script}");
        script.replace(old, new)
    })
}

/// Runs task `index` of a job in which Slurm counts `count` tasks.
fn run(folder: &Path, index: u32, count: u32) {
    let program = assert_cmd::cargo::cargo_bin("etalon");
    let path =
        format!("{}:{}:{}", folder.display(), program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let output = Command::new("sh")
        .arg("job.sh")
        .current_dir(folder)
        .env("PATH", path)
        .env("SLURM_ARRAY_TASK_ID", index.to_string())
        .env("SLURM_ARRAY_TASK_COUNT", count.to_string())
        .env("SLURM_CPUS_PER_TASK", "1")
        .output()
        .unwrap();
    assert!(output.status.success(), "task {index} of {count}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_task_that_is_submitted_alone_completes_the_array() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path();
    std::fs::write(folder.join("job.sh"), script()).unwrap();
    let srun = folder.join("srun");
    std::fs::write(&srun, "#!/bin/sh\n[ \"$1 $2\" = \"-c 1\" ] && shift 2 && exec \"$@\"\n").unwrap();
    std::fs::set_permissions(&srun, std::fs::Permissions::from_mode(0o755)).unwrap();
    let merged = |name: &str| {
        json(folder, &["merge", "parts/1.exr", "parts/2.exr", "parts/3.exr", "-o", name]);
        json(folder, &["compare", "whole.exr", name])["mse"].as_f64().unwrap()
    };
    json(folder, &["render", "cornell-spheres", "-s", "6", "-r", "24", "18", "-o", "whole.exr"]);
    (1..=3).for_each(|index| run(folder, index, 3));
    assert_eq!(merged("array.exr"), 0.0);
    std::fs::remove_file(folder.join("parts/2.exr")).unwrap();
    run(folder, 2, 1);
    assert_eq!(merged("alone.exr"), 0.0);
}
