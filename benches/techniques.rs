//! Is the default the best? Every scene under every combination of technique, density of the map and adaptive sampling, of this program
//! and of a rival (an earlier version of it), as tables for BENCHMARKS.md.
//!
//! `cargo bench --bench techniques -- --runs FILE [--rival PROGRAM] [--scenes FOLDER]... [--maps FOLDER] [--envmap MAP]
//! [--spp N,...] [--pairs N] [--times N] [NAME ...]`
//! measures the built-in scenes, the scene files of the folders (MAP takes the place of a map that a file names and the folder lacks), and
//! three objects under the built-in maps and those of the folder. Names choose some of the cases. FILE keeps each pair of renders: the same
//! command goes on from there. `benches/kinds` says what a technique is worth; `benches/unknown` has other scenes of the same kinds, kept aside.
//!
//! *Efficiency* is 1 / (seconds × MSE), of processes with one thread that prepare the scene and render it. Two renders with different seeds
//! have independent errors, so half of their mean squared difference is the MSE of one, without any reference. All combinations render 4
//! seeds at 16 samples per pixel; those worse than 1.5 times the best are dropped. The others render at every number of samples until the
//! efficiencies of the default and of the three best are known to 7 %. Even pairs choose the best, odd pairs say how good it is. Other work on
//! the machine only adds to times, so the least of all counts. Two processes side by side may slow each other down, and not each pair alike:
//! each run with `--times N` takes those of the table again, N times, one process at a time, and then only these count in the table.

mod program;

use etalon::raster::{Image, ReadOptions, compare, read};
use program::{ETALON, files, run};
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Samples per pixel of the table, unless `--spp` names some, and those of the first look.
const SAMPLES: [u32; 4] = [4, 16, 64, 256];
const FIRST_LOOK: u32 = 16;
/// Pairs of seeds: of the first look, the least of the table, and the most unless `--pairs` says so.
const PAIRS: [usize; 3] = [2, 4, 128];
/// Combinations with less than this share of the best efficiency are dropped.
const DROPPED: f64 = 1.0 / 1.5;
/// An efficiency is known once its interval is at most this wide, to each side.
const KNOWN: f64 = 0.07;
/// Quantile of a normal distribution, for intervals of 95 %.
const Z: f64 = 1.96;
/// Processes side by side.
const WORKERS: usize = 2;
/// Samples per pixel at which the price of leaving a technique out is measured.
const JUDGED: u32 = 64;
/// The name of the default.
const DEFAULT: &str = "default";

/// Techniques, and the densities of a map with which they are combined; a program may refuse some that another one has.
const TECHNIQUES: [(&str, &[&str]); 5] = [
    ("light", &["cdf", "cosine"]),
    ("bsdf", &["cdf"]),
    ("hemisphere", &["cdf"]),
    ("mis", &["cdf", "compensated", "cosine", "cosine-compensated"]),
    ("mis+lt", &["cdf", "compensated", "cosine", "cosine-compensated"]),
];
/// What the price is asked of: a part of the name of the combinations that have it.
const JUDGED_TECHNIQUES: [&str; 5] = ["+lt", "+adaptive", "cosine", "cosine-compensated", "light"];

fn main() {
    let bench = Bench::from_arguments();
    let cases = bench.cases();
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..WORKERS {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    bench.measure(case);
                    eprintln!("{}", case.name);
                }
            });
        }
    });
    for _ in 0..bench.times {
        cases.iter().for_each(|case| bench.time(case));
    }
    bench.report(&cases);
}

/// What is rendered.
struct Case {
    name: String,
    /// The folder, or what kind of map scene it is.
    kind: String,
    args: Vec<String>,
    has_map: bool,
}

/// What was measured of a combination: the least seconds of a render beside another process and alone, and the MSE by each pair of renders
/// with different seeds.
struct Measured {
    seconds_beside: f64,
    seconds_alone: f64,
    mses: Vec<f64>,
}

impl Measured {
    /// Adds the time of a pair of renders with its MSE, or, without one, a time that was taken alone.
    fn add(&mut self, seconds: f64, mse: Option<f64>) {
        let least = if mse.is_some() { &mut self.seconds_beside } else { &mut self.seconds_alone };
        *least = least.min(seconds);
        self.mses.extend(mse);
    }

    /// Those alone, if they were taken.
    fn seconds(&self) -> f64 {
        if self.seconds_alone.is_finite() { self.seconds_alone } else { self.seconds_beside }
    }
}

impl Default for Measured {
    fn default() -> Self {
        Self { seconds_beside: f64::INFINITY, seconds_alone: f64::INFINITY, mses: Vec::new() }
    }
}

/// A case, a combination and a number of samples.
type Key = (String, String, u32);

struct Bench {
    rival: Option<String>,
    scenes: Vec<PathBuf>,
    maps: Option<PathBuf>,
    envmap: Option<String>,
    names: Vec<String>,
    spp: Vec<u32>,
    most: usize,
    times: usize,
    measured: Mutex<HashMap<Key, Measured>>,
    file: Mutex<File>,
}

/// The mean of a quantity of pairs and the relative standard error of it.
fn mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let variance = values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt() / mean)
}

impl Bench {
    fn from_arguments() -> Self {
        let (mut rival, mut scenes, mut maps, mut envmap, mut runs, mut names) =
            (None, Vec::new(), None, None, None, Vec::new());
        let (mut spp, mut most, mut times) = (SAMPLES.to_vec(), PAIRS[2], 0);
        let number = |arg: Option<String>| arg.and_then(|number| number.parse().ok()).expect("a number");
        let mut args = std::env::args().skip(1);
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--rival" => rival = args.next(),
                "--scenes" => scenes.extend(args.next().map(PathBuf::from)),
                "--maps" => maps = args.next().map(PathBuf::from),
                "--envmap" => envmap = args.next(),
                "--runs" => runs = args.next(),
                "--spp" => {
                    let list = args.next().unwrap_or_default();
                    spp = list.split(',').map(|spp| spp.parse().expect("numbers with commas between them")).collect();
                }
                "--pairs" => most = number(args.next()),
                "--times" => times = number(args.next()),
                // Cargo says so to every bench.
                "--bench" => {}
                _ => names.push(arg),
            }
        }
        let runs = runs.expect("--runs FILE keeps what is measured");
        let mut measured: HashMap<Key, Measured> = HashMap::new();
        for line in std::fs::read_to_string(&runs).unwrap_or_default().lines() {
            if let [case, combination, spp, seconds, mse] = line.split(',').collect::<Vec<_>>()[..]
                && let (Ok(spp), Ok(seconds)) = (spp.parse(), seconds.parse())
                && (mse.is_empty() || mse.parse::<f64>().is_ok())
            {
                measured.entry((case.into(), combination.into(), spp)).or_default().add(seconds, mse.parse().ok());
            }
        }
        let file = OpenOptions::new().create(true).append(true).open(&runs).expect("a file for the runs");
        Self {
            rival,
            scenes,
            maps,
            envmap,
            names,
            spp,
            most,
            times,
            measured: Mutex::new(measured),
            file: Mutex::new(file),
        }
    }

    fn cases(&self) -> Vec<Case> {
        let mut cases: Vec<Case> =
            program::built_in().into_iter().map(|name| Case::new("built-in", &name, vec![name.clone()])).collect();
        for folder in &self.scenes {
            let kind = stem(folder);
            for path in files(folder, &["pbrt", "dae"]) {
                let mut args = vec![path.display().to_string()];
                if path.extension().is_some_and(|extension| extension == "dae") {
                    args.extend(["-m", "5", "--fit"].map(str::to_owned));
                } else if let Some(map) = &self.envmap
                    && std::fs::read_to_string(&path).is_ok_and(|text| text.contains("grace_latlong"))
                {
                    args.extend(["--envmap".into(), map.clone(), "-l".into(), "4".into()]);
                }
                // Folders may have files of the same name.
                cases.push(Case::new(&kind, &format!("{kind}/{}", stem(&path)), args));
            }
        }
        let mesh = self.scenes.iter().map(|folder| folder.join("mesh-sky.pbrt")).find(|path| path.exists());
        let objects = ["sphere-env".to_owned(), "brushed-metal".to_owned()];
        let objects: Vec<String> = objects.into_iter().chain(mesh.map(|path| path.display().to_string())).collect();
        let maps = ["nave".to_owned(), "sun".to_owned()].into_iter();
        let of_folder = self.maps.iter().flat_map(|folder| files(folder, &["exr", "hdr", "pfm"]));
        for map in maps.chain(of_folder.map(|path| path.display().to_string())) {
            for object in &objects {
                let name = format!("{} under {}", stem(Path::new(object)), stem(Path::new(&map)));
                cases.push(Case::new("maps", &name, vec![object.clone(), "--envmap".into(), map.clone()]));
            }
        }
        cases.retain(|case| self.names.is_empty() || self.names.iter().any(|name| case.name.contains(name)));
        cases.iter_mut().for_each(Case::find_map);
        cases
    }

    /// The names of all combinations, those of the rival with a sign.
    fn combinations(&self, case: &Case) -> Vec<String> {
        let sampled = TECHNIQUES.iter().flat_map(|(technique, densities)| {
            let densities = if case.has_map { densities } else { &[""][..] };
            densities.iter().map(move |density| format!("{technique} {density}").trim_end().to_owned())
        });
        let adaptive = sampled.flat_map(|name| [name.clone(), format!("{name} +adaptive")]);
        let ours: Vec<String> = adaptive.collect();
        let rivals = ours.iter().filter(|_| self.rival.is_some()).map(|name| format!("rival {name}"));
        std::iter::once(DEFAULT.to_owned()).chain(ours.iter().cloned()).chain(rivals).collect()
    }

    fn measure(&self, case: &Case) {
        let all = self.combinations(case);
        all.iter().for_each(|name| self.render(case, name, FIRST_LOOK, PAIRS[0]));
        let beside = |measured: &Measured| measured.seconds_beside;
        let all = self.ranked(case, &all, FIRST_LOOK, 0..PAIRS[0], beside);
        let Some(best) = all.first().map(|(_, [log, _])| *log) else { return };
        let mut kept: Vec<String> =
            all.iter().filter(|(_, [log, _])| log - best > DROPPED.ln()).map(|(name, _)| name.clone()).collect();
        // The best without each technique says what it is worth.
        for technique in JUDGED_TECHNIQUES {
            kept.extend(all.iter().map(|(name, _)| name).find(|name| !has(name, technique)).cloned());
        }
        kept.push(DEFAULT.to_owned());
        kept.sort();
        kept.dedup();
        for &spp in &self.spp {
            kept.iter().for_each(|name| self.render(case, name, spp, PAIRS[1]));
            for count in (PAIRS[1] + 2..=self.most).step_by(2) {
                let ranked = self.ranked(case, &kept, spp, 0..count, beside);
                let mut wanted: Vec<_> = ranked.iter().take(3).collect();
                wanted.extend(ranked.iter().filter(|(name, _)| name == DEFAULT));
                let unknown: Vec<_> = wanted.iter().filter(|(_, [_, error])| Z * error > KNOWN).collect();
                if unknown.is_empty() {
                    break;
                }
                unknown.iter().for_each(|(name, _)| self.render(case, name, spp, count));
            }
        }
    }

    /// Combinations by their efficiency from some of their pairs, the best first.
    fn ranked(
        &self,
        case: &Case,
        names: &[String],
        spp: u32,
        range: impl Iterator<Item = usize> + Clone,
        seconds: fn(&Measured) -> f64,
    ) -> Vec<(String, [f64; 2])> {
        let measured = self.measured.lock().expect("no panic");
        let of = |name: &String| {
            let measured = measured.get(&(case.name.clone(), name.clone(), spp))?;
            let some: Vec<f64> = range.clone().filter_map(|i| measured.mses.get(i).copied()).collect();
            let (mse, error) = (some.len() > 1).then(|| mean(some.iter().copied()))?;
            let log = -(seconds(measured) * mse).ln();
            log.is_finite().then(|| (name.clone(), [log, error]))
        };
        let mut ranked: Vec<_> = names.iter().filter_map(of).collect();
        ranked.sort_by(|(_, a), (_, b)| b[0].total_cmp(&a[0]));
        ranked
    }

    /// Renders pairs of a combination until there are n.
    fn render(&self, case: &Case, name: &str, spp: u32, count: usize) {
        while self.pairs(case, name, spp) < count {
            let Some([a, b]) = self.pair(case, name, spp, self.pairs(case, name, spp)) else { return };
            let mse = 0.5 * compare(&a.1, &b.1).expect("images of one size").mse;
            self.keep(case, name, spp, 0.5 * (a.0 + b.0), Some(mse));
        }
    }

    /// Takes the time of the first pair of each combination that has enough of them for the table once more, alone.
    fn time(&self, case: &Case) {
        for (name, &spp) in self.combinations(case).iter().flat_map(|name| self.spp.iter().map(move |spp| (name, spp)))
        {
            if self.pairs(case, name, spp) >= PAIRS[1]
                && let Some([a, b]) = self.pair(case, name, spp, 0)
            {
                self.keep(case, name, spp, 0.5 * (a.0 + b.0), None);
            }
        }
    }

    /// How many pairs were measured.
    fn pairs(&self, case: &Case, name: &str, spp: u32) -> usize {
        let key = (case.name.clone(), name.to_owned(), spp);
        self.measured.lock().expect("no panic").get(&key).map_or(0, |measured| measured.mses.len())
    }

    /// Keeps what was measured, in the file too.
    fn keep(&self, case: &Case, name: &str, spp: u32, seconds: f64, mse: Option<f64>) {
        let written = mse.map_or(String::new(), |mse| format!("{mse:e}"));
        let line = format!("{},{name},{spp},{seconds},{written}", case.name);
        writeln!(self.file.lock().expect("no panic"), "{line}").expect("the line is written");
        let key = (case.name.clone(), name.to_owned(), spp);
        self.measured.lock().expect("no panic").entry(key).or_default().add(seconds, mse);
    }

    /// Seconds and images of the two renders of a pair; `None` for a combination that the program refuses.
    fn pair(&self, case: &Case, name: &str, spp: u32, number: usize) -> Option<[(f64, Image); 2]> {
        let folder = tempfile::tempdir().expect("a folder for the image");
        let path = folder.path().join("image.pfm");
        let (program, options) = match (name.strip_prefix("rival "), &self.rival) {
            (Some(options), Some(rival)) => (rival.as_str(), options),
            _ => (ETALON, name),
        };
        let mut args = vec!["render".to_owned()];
        args.extend(case.args.iter().cloned());
        args.extend(["-r", "80", "60", "-t", "1", "--json", "--quiet", "-o"].map(str::to_owned));
        args.extend([path.display().to_string(), "-s".into(), spp.to_string()]);
        if options != DEFAULT {
            let mut words = options.split(' ').peekable();
            args.extend(["--sampling".into(), words.next()?.into()]);
            if let Some(density) = words.next_if(|word| !word.starts_with('+')) {
                args.extend(["--light-density".into(), density.into()]);
            }
            args.extend(words.next().is_none().then(|| "--uniform".into()));
        }
        let render = |seed: usize| {
            let seeded = args.iter().cloned().chain(["--seed".into(), seed.to_string()]);
            let json = run(program, &seeded.collect::<Vec<_>>()).ok()?;
            Some((json["seconds"].as_f64()?, read(&path, ReadOptions::default()).ok()?))
        };
        Some([render(2 * number + 1)?, render(2 * number + 2)?])
    }

    fn report(&self, cases: &[Case]) {
        self.report_default(cases);
        self.report_prices(cases);
    }

    /// The default beside the best: its share of the efficiency of the best, chosen by other pairs, and which that is.
    fn report_default(&self, cases: &[Case]) {
        let columns: Vec<String> = self.spp.iter().map(|spp| format!("{spp} samples per pixel")).collect();
        println!("| case | {} |\n|{}", columns.join(" | "), "---|".repeat(1 + columns.len()));
        let mut ratios: HashMap<u32, Vec<f64>> = HashMap::new();
        for case in cases {
            let cell = |&spp: &u32| {
                let Some((best, [ratio, width])) = self.ratio(case, spp) else { return String::new() };
                ratios.entry(spp).or_default().push(ratio);
                let [low, middle, high] = [ratio - width, ratio, ratio + width].map(f64::exp);
                let of = if best == DEFAULT { String::new() } else { format!(" of {best}") };
                format!("{middle:.2} ({low:.2} to {high:.2}){of}")
            };
            let cells: Vec<String> = self.spp.iter().map(cell).collect();
            println!("| {} | {} |", case.name, cells.join(" | "));
        }
        for &spp in &self.spp {
            let Some(ratios) = ratios.get(&spp) else { continue };
            let (mean, least) =
                (ratios.iter().sum::<f64>() / ratios.len() as f64, ratios.iter().copied().fold(0.0, f64::min));
            println!(
                "\nDefault over the best at {spp} samples per pixel: geometric mean of {} cases {:.3}, least {:.2}",
                ratios.len(),
                mean.exp(),
                least.exp()
            );
        }
    }

    /// The best combination by the even pairs; the logarithm of the default's efficiency over it by the odd ones, and half of its 95 %
    /// interval.
    fn ratio(&self, case: &Case, spp: u32) -> Option<(String, [f64; 2])> {
        let (even, odd) = ((0..self.most).step_by(2), (1..self.most).step_by(2));
        let (best, _) = self.ranked(case, &self.combinations(case), spp, even, Measured::seconds).into_iter().next()?;
        let by_odd =
            |name: &str| Some(self.ranked(case, &[name.to_owned()], spp, odd.clone(), Measured::seconds).pop()?.1);
        let ([a, da], [b, db]) = (by_odd(DEFAULT)?, by_odd(&best)?);
        let width = if best == DEFAULT { 0.0 } else { Z * da.hypot(db) };
        Some((best, [a - b, width]))
    }

    /// What each technique is worth, by kind of scene.
    fn report_prices(&self, cases: &[Case]) {
        println!(
            "\n| kind | left out | best without it over the best, {JUDGED} samples per pixel | of each case |\n|---|---|---|---|"
        );
        let mut kinds: Vec<String> = cases.iter().map(Case::group).collect();
        kinds.sort();
        kinds.dedup();
        for kind in &kinds {
            for technique in JUDGED_TECHNIQUES {
                let of = |case: &Case| {
                    let names: Vec<_> = self.combinations(case);
                    let ours: Vec<_> =
                        names.into_iter().filter(|name| !name.starts_with("rival") && name != DEFAULT).collect();
                    let all = self.ranked(case, &ours, JUDGED, 0..self.most, Measured::seconds);
                    let without = all.iter().find(|(name, _)| !has(name, technique))?;
                    Some((without.1[0] - all.first()?.1[0]).exp())
                };
                let each: Vec<f64> = cases.iter().filter(|case| case.group() == *kind).filter_map(of).collect();
                if each.is_empty() || each.iter().all(|ratio| *ratio == 1.0) {
                    continue;
                }
                let mean = (each.iter().map(|ratio| ratio.ln()).sum::<f64>() / each.len() as f64).exp();
                let listed: Vec<String> = each.iter().map(|ratio| format!("{ratio:.2}")).collect();
                println!("| {kind} | {technique} | {mean:.2} | {} |", listed.join(" "));
            }
        }
    }
}

impl Case {
    fn new(kind: &str, name: &str, args: Vec<String>) -> Self {
        Self { name: name.to_owned(), kind: kind.to_owned(), args, has_map: false }
    }

    /// Finds out whether the scene has a map: a density of it is refused where there is none.
    fn find_map(&mut self) {
        let mut args = vec!["render".to_owned()];
        args.extend(self.args.iter().cloned());
        let folder = tempfile::tempdir().expect("a folder for the image");
        let path = folder.path().join("image.pfm").display().to_string();
        let options = ["-r", "1", "1", "-s", "1", "--light-density", "cdf", "--json", "--quiet", "-o", &path];
        args.extend(options.map(str::to_owned));
        self.has_map = run(ETALON, &args).is_ok();
    }

    /// The group in which the price of a technique is averaged: `frosted-panes` of `frosted-panes-1`, or the folder.
    fn group(&self) -> String {
        let numbered = self.name.rsplit_once('-').filter(|(_, number)| matches!(*number, "1" | "2"));
        numbered.map_or_else(|| self.kind.clone(), |(kind, _)| kind.to_owned())
    }
}

/// Whether a combination has a technique: whole words, but any `+`.
fn has(name: &str, technique: &str) -> bool {
    name.split(' ').any(|word| word == technique || (technique.starts_with('+') && word.contains(technique)))
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
