//! What each scene goes without, and what that would cost: every scene rendered as it needs and with everything (`--general`, and all
//! techniques), alternating, each in a process of its own, as a table for BENCHMARKS.md.
//!
//! `cargo bench --bench left_out -- [--scenes FOLDER] [--envmap MAP] [NAME ...]` renders the built-in scenes, and with `--scenes` the scene
//! files of a folder, a map of which is replaced by MAP; names choose some of them.

mod program;

use etalon::raster::{Image, ReadOptions, compare, read};
use std::path::{Path, PathBuf};

/// Renders of each kind, with a seed for each round.
const ROUNDS: u32 = 5;
/// Options of a render with everything; the techniques change the image where one is left out.
const ALL_TECHNIQUES: [&str; 3] = ["--general", "--sampling", "mis+lt"];
/// The techniques that may be left out.
const TECHNIQUES: [&str; 3] = ["BSDF sampling", "light sampling", "light tracing"];
/// Samples per pixel, light samples for each.
const SAMPLES: [&str; 4] = ["-s", "16", "-l", "1"];

fn main() {
    let mut folder = None;
    let mut map = None;
    let mut chosen = Vec::new();
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--scenes" => folder = args.next(),
            "--envmap" => map = args.next(),
            // Cargo says so to every bench.
            "--bench" => {}
            _ => chosen.push(arg),
        }
    }
    let mut scenes: Vec<Scene> = built_in().collect();
    scenes.extend(folder.iter().flat_map(|folder| files(Path::new(folder), map.as_deref())));
    scenes.retain(|scene| chosen.is_empty() || chosen.contains(&scene.name));
    println!(
        "| scene | left out | time, s | time of everything over it | MSE of everything over it | memory, MB | of everything, MB |"
    );
    println!("|---|---|---|---|---|---|---|");
    scenes.iter().for_each(Scene::row);
}

struct Scene {
    name: String,
    /// What `render` is called with.
    args: Vec<String>,
}

fn built_in() -> impl Iterator<Item = Scene> {
    program::built_in().into_iter().map(|name| Scene { args: vec![name.clone()], name })
}

/// The scene files of a folder; pbrt's take the map, which the folder may lack.
fn files(folder: &Path, map: Option<&str>) -> Vec<Scene> {
    let scene = |path: &PathBuf| {
        let mut args = vec![path.to_str().expect("a name in UTF-8").to_owned()];
        if let Some(map) = map.filter(|_| path.extension().is_some_and(|extension| extension == "pbrt")) {
            args.extend(["--envmap".to_owned(), map.to_owned()]);
        }
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name in UTF-8");
        Scene { name: name.to_owned(), args }
    };
    program::files(folder, &["pbrt", "dae"]).iter().map(scene).collect()
}

/// One render.
struct Measured {
    seconds: f64,
    megabytes: f64,
    left_out: String,
    image: Image,
}

impl Scene {
    /// Renders all rounds and prints the row.
    fn row(&self) {
        let both = |seed| {
            let lean = self.render(seed, &[]);
            let lacks_technique = TECHNIQUES.iter().any(|technique| lean.left_out.contains(technique));
            let techniques: &[&str] = if lacks_technique { &ALL_TECHNIQUES } else { &ALL_TECHNIQUES[..1] };
            let general = self.render(seed, techniques);
            [lean, general]
        };
        let rounds: Vec<[Measured; 2]> = (1..=ROUNDS).map(both).collect();
        let all = |general: usize, of: fn(&Measured) -> f64| rounds.iter().map(move |pair| of(&pair[general]));
        let mut ratios: Vec<f64> = rounds.iter().map(|[lean, general]| general.seconds / lean.seconds).collect();
        ratios.sort_by(f64::total_cmp);
        // Renders of different seeds have independent errors: half of their squared difference is the MSE of one.
        let mse = |general: usize| -> f64 {
            let pairs = rounds.windows(2).map(|pair| [&pair[0][general].image, &pair[1][general].image]);
            pairs.map(|[a, b]| 0.5 * compare(a, b).expect("images of one size").mse).sum::<f64>()
        };
        println!(
            "| `{}` | {} | {:.3} | {:.2} ({:.2} to {:.2}) | {:.2} | {:.0} | {:.0} |",
            self.name,
            rounds[0][0].left_out,
            all(0, |m| m.seconds).fold(f64::INFINITY, f64::min),
            ratios[ratios.len() / 2],
            ratios[0],
            ratios[ratios.len() - 1],
            mse(1) / mse(0),
            all(0, |m| m.megabytes).fold(0.0, f64::max),
            all(1, |m| m.megabytes).fold(0.0, f64::max),
        );
    }

    fn render(&self, seed: u32, options: &[&str]) -> Measured {
        let folder = tempfile::tempdir().expect("a folder for the image");
        let path = folder.path().join("image.pfm");
        let mut args = vec!["render".to_owned()];
        args.extend(self.args.iter().cloned());
        args.extend(SAMPLES.map(str::to_owned));
        args.extend(["--seed".into(), seed.to_string(), "--json".into(), "-o".into(), path.display().to_string()]);
        args.extend(options.iter().map(|option| (*option).to_owned()));
        let json = program::run(program::ETALON, &args).unwrap_or_else(|error| panic!("{error}"));
        let words = json["left_out"].as_array().into_iter().flatten().filter_map(|word| word.as_str());
        Measured {
            seconds: json["seconds"].as_f64().expect("a time"),
            megabytes: json["peak_memory_bytes"].as_f64().unwrap_or(f64::NAN) / 1e6,
            left_out: words.collect::<Vec<_>>().join(", "),
            image: read(&path, ReadOptions::default()).expect("the image"),
        }
    }
}
