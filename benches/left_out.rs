//! Specialised kernels against the general one (`--general`): each scene rendered by both, alternating, each in a process of
//! its own; time to prepare and render, and peak memory, as a table.

use std::process::Command;

/// Scenes, with options of the renders.
const SCENES: [(&str, &[&str]); 6] = [
    ("sphere-env", &["-s", "16", "-l", "1"]),
    ("sphere-env, BSDF sampling", &["-s", "16", "-l", "1", "--sampling", "bsdf"]),
    ("cornell-lambert", &["-s", "32", "-l", "1"]),
    ("cornell-spheres", &["-s", "32", "-l", "1"]),
    ("cornell-statue-au", &["-s", "8", "-l", "1"]),
    ("furnace", &["-s", "64"]),
];

/// Renders of each kind, of which the fastest counts.
const ROUNDS: usize = 5;

fn main() {
    println!("| scene | left out | time, s | general, s | saved | memory, MB | general, MB |");
    println!("|---|---|---|---|---|---|---|");
    for (name, options) in SCENES {
        let mut best = [Measured::default(), Measured::default()];
        for _ in 0..ROUNDS {
            for (general, best) in best.iter_mut().enumerate() {
                let found = measure(name, options, general == 1);
                if best.left_out.is_none() || found.seconds < best.seconds {
                    *best = found;
                }
            }
        }
        let [lean, general] = best;
        println!(
            "| `{name}` | {} | {:.3} | {:.3} | {:.0} % | {:.1} | {:.1} |",
            lean.left_out.as_deref().unwrap_or_default(),
            lean.seconds,
            general.seconds,
            100.0 * (1.0 - lean.seconds / general.seconds),
            lean.megabytes,
            general.megabytes
        );
    }
}

#[derive(Default)]
struct Measured {
    seconds: f64,
    megabytes: f64,
    left_out: Option<String>,
}

fn measure(name: &str, options: &[&str], general: bool) -> Measured {
    let folder = tempfile::tempdir().expect("a folder for the image");
    let mut command = Command::new(env!("CARGO_BIN_EXE_etalon"));
    let scene = name.split(',').next().unwrap_or(name);
    command.args(["render", scene, "--json", "-o"]).arg(folder.path().join("image.pfm")).args(options);
    if general {
        command.arg("--general");
    }
    let output = command.output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("the program writes JSON");
    let words = json["left_out"].as_array().into_iter().flatten().filter_map(|word| word.as_str());
    Measured {
        seconds: json["seconds"].as_f64().expect("a time"),
        megabytes: json["peak_memory_bytes"].as_f64().unwrap_or(f64::NAN) / 1e6,
        left_out: Some(words.collect::<Vec<_>>().join(", ")),
    }
}
