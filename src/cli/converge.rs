//! `etalon converge`: error against run time.

use super::console::Console;
use super::families::reply_limit;
use super::global::{Global, OUTPUT, Reports, SAMPLING, Verdict, out, seed, threads};
use super::scene_file::{Loaded, SceneArgs};
use super::style::StyleArgs;
use super::values::share;
use clap::{ArgAction, ArgGroup, Args};
use etalon_bench::converge::answer::Answer;
use etalon_bench::converge::contender::{Contender, Fault};
use etalon_bench::converge::curve::{BIAS_LEVEL, Curve, CurveVerdict, SLOPE_MARGIN};
use etalon_bench::converge::recorded::Recorded;
use etalon_bench::converge::reference::Reference;
use etalon_bench::converge::strategy::{self, SUFFIXES, Strategy};
use etalon_bench::converge::{Asked, Convergence, Plan, measure};
use etalon_bench::protocol::renderer::{PLACEHOLDERS, Renderer};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_core::raster::{self, ReadOptions};
use etalon_core::scene::{Material, Request, Scene, builtin};
use etalon_figures::output::{self, Saving, file_name};
use etalon_figures::view::checks::{Check, Checks};
use etalon_figures::view::compare::left_out;
use etalon_figures::view::converge as view;
use etalon_figures::view::text::{LINE, duration, rounded, wrapped};
use etalon_stats::Extremes;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;
use std::time::Instant;

/// Measure the error of sampling strategies against their run time
#[derive(Args)]
#[command(after_long_help = after_help())]
#[command(args = [out(), seed(), threads()])]
// Renderers of one's own need no scene; a strategy of ours that is biased is no check that fails
#[command(group = ArgGroup::new("external").args(["renderer", "runs"]).multiple(true))]
#[command(mut_arg("scene", |arg| arg.required(false).required_unless_present("external")))]
#[command(mut_arg("junit", |arg| arg.requires("external")), mut_arg("markdown", |arg| arg.requires("external")))]
pub struct Converge {
    #[command(flatten)]
    scene: SceneArgs,
    /// Strategies, with commas between them [default: those that suit the scene]
    ///
    /// "none" leaves renderers alone.
    #[arg(help_heading = METHODS, long, value_name = "NAME,...", value_delimiter = ',', action = ArgAction::Set)]
    strategies: Vec<String>,
    /// A renderer in another program, repeatable: a name and the command of an image
    ///
    /// The command has placeholders {spp} {out} {seed} {scene} {threads} {width} {height}.
    #[arg(help_heading = METHODS, long, value_name = "NAME=COMMAND")]
    renderer: Vec<String>,
    /// The file that {scene} stands for [default: SCENE if it is a file]
    #[arg(help_heading = METHODS, long, value_name = "FILE", requires = "renderer")]
    renderer_scene: Option<PathBuf>,
    /// Time limit of each run of a renderer
    #[arg(help_heading = METHODS, long, value_name = "SECONDS", default_value_t = 300.0, requires = "renderer", allow_negative_numbers = true)]
    timeout: f64,
    /// The reference: an image file, or the renderer or strategy that renders it
    ///
    /// Default: the exact image where there is one, else the default strategy.
    #[arg(help_heading = METHODS, long, value_name = "FILE|NAME")]
    reference: Option<String>,
    /// Also compare earlier runs: DIR/NAME/times.csv and DIR/NAME/spp-16_seed-3.exr
    #[arg(help_heading = METHODS, long, value_name = "DIR")]
    runs: Option<PathBuf>,
    /// Keep all images and their times in DIR, for --runs
    #[arg(long, help_heading = OUTPUT, value_name = "DIR")]
    keep_runs: Option<PathBuf>,
    /// Seconds of measurement [default: 30, and 60 for each renderer]
    ///
    /// Reading the scene counts; the exact image, which is computed before, and the figures do not. A step that no clock stops may run over: reading a file, preparing one render.
    #[arg(long, help_heading = SAMPLING, value_name = "SECONDS", allow_negative_numbers = true)]
    budget: Option<f64>,
    /// Most samples per pixel of every curve [default: what the budget allows]
    #[arg(long, help_heading = SAMPLING, value_name = "N")]
    max_spp: Option<u32>,
    /// Renders of each strategy, for the confidence bands [default: 8, if they fit]
    #[arg(long, help_heading = SAMPLING, value_name = "N")]
    replicates: Option<u32>,
    /// Relative bias of a renderer's mean to find with 90 % probability: 0.01 or 1%
    #[arg(long, help_heading = SAMPLING, value_name = "W", default_value = "1%", value_parser = share, requires = "external")]
    detect: f64,
    /// Light samples at each hit
    #[arg(short, long, help_heading = SAMPLING, value_name = "N", default_value_t = 1)]
    light_samples: u32,
    /// Most scatterings of a path [default: the scene's]
    #[arg(short, long = "depth", help_heading = SAMPLING, value_name = "DEPTH")]
    max_depth: Option<u32>,
    #[command(flatten)]
    style: StyleArgs,
    #[command(flatten)]
    reports: Reports,
}

fn after_help() -> String {
    let methods: String = strategy::methods().iter().map(|(name, what)| format!("  {name:<16} {what}\n")).collect();
    let suffixes: String = SUFFIXES.map(|(suffix, about, _)| format!("  ...+{suffix:<12} {about}\n")).concat();
    let placeholders: String =
        PLACEHOLDERS.map(|(name, what)| format!("  {{{name}}}{:<1$}{what}\n", "", 9 - name.len())).concat();
    format!(
        "Strategies:\n{methods}{suffixes}\nErrors are against the exact image where it is known (sphere-env; furnace without its \
         metal\nsphere), else against two long renders, which may take half of the budget; the output says\nwhich. The exact image is computed first and is no part of the budget. Images are at \
         most {LONGEST_SIDE} pixels long unless -r says more, and have the scene's own size if\na renderer does not take {{width}} \
         and {{height}}.\nWrites SCENE-converge.{{csv,svg,png,pdf}} (curves), SCENE-converge-replicates.csv \
         and\nSCENE-converge-pictures.{{svg,png,pdf}}.\n\nThe efficiency is 1/(MSE · processor time); the MSE includes the \
         bias.\nIntervals in the text are of the ratio of two efficiencies, those in the figure of each alone.\nA method is called biased if a t-test of its replicates says so, of the pixels or of the\nimage's mean, each at a \
         level of {:.1} %; its bias is that of the mean of all channels (that of\n`etalon compare --against` is of the channel \
         that differs most). Steeper or flatter: the\ninterval of its slope is further than {SLOPE_MARGIN} from -1/2.\n\nPlaceholders of a renderer's command (split into words as by a shell; \
         nothing is substituted):\n{placeholders}\nWithout SCENE, renderers are compared with each other; --reference is an image file then, or one of them.\n\n\
         Exit codes: 0 good, 1 a renderer is biased against the reference or a run of it failed, 2 usage or bad input, \
         3 the bias of a renderer was \
         not tested, or one of --detect might have gone unnoticed; the budget was too small for any verdict; or interrupted.\n\nExamples:\n  etalon converge sphere-env\n  etalon converge cornell-spheres --budget 60\n  \
         etalon converge brushed-metal --strategies light,bsdf,mis --max-spp 16\n  \
         etalon converge sphere-env --envmap sun --strategies light,light-cosine,median-cut-64\n  \
         etalon converge scene.pbrt --renderer 'pbrt=pbrt --spp {{spp}} --seed {{seed}} --outfile {{out}} --nthreads {{threads}} {{scene}}'\n  \
         etalon converge --renderer 'old=./old {{spp}} {{seed}} {{out}}' --renderer 'new=./new {{spp}} {{seed}} {{out}}' --reference ref.exr",
        100.0 * BIAS_LEVEL
    )
}

/// Heading of the help.
const METHODS: &str = "Methods to compare";

/// Longest side of an image whose size is not given.
const LONGEST_SIDE: usize = 120;

/// The share of the budget from which the time for reading the scene is told of.
const LONG_READING: f64 = 0.25;

/// What lets a renderer take more samples per pixel.
const MORE_SAMPLES: &str = "fewer --replicates or a larger --budget";

/// Seconds of the default budget, and for each renderer.
const BUDGET: [f64; 2] = [30.0, 60.0];

#[derive(Serialize)]
struct Output<'a> {
    answer: Option<Answer>,
    #[serde(flatten)]
    result: &'a Convergence,
    common_cpu_seconds: f64,
    common_rmse: f64,
}

impl Converge {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let start = Instant::now();
        self.reports.check()?;
        let strategies = match self.strategies.as_slice() {
            [only] if only == "none" && !(self.renderer.is_empty() && self.runs.is_none()) => Some(Vec::new()),
            [only] if only == "none" => {
                return Err(Error::parameter("strategies", "\"none\" leaves no method to compare")
                    .with_hint("give another method by `renderer` or `runs`"));
            }
            [] => None,
            names => Some(names.iter().map(|name| name.parse()).collect::<Result<Vec<Strategy>>>()?),
        };
        let renderers = self.renderers(global)?;
        let recorded = self.runs.as_deref().map(Recorded::read_all).transpose()?.unwrap_or_default();
        let Loaded { mut scene, request: asked } = if self.scene.is_given() {
            self.scene.load(console)?
        } else {
            let names = renderers.iter().map(Renderer::name).chain(recorded.iter().map(Recorded::name));
            self.nothing(&names.collect::<Vec<_>>())?
        };
        let (target, style) = (global.target(), self.style.style()?);
        let name = format!("{}-converge", file_name(&scene.name));
        let stem = target.stem(&name, "", &output::STUDY)?;
        let replicates = target.stem(&name, "-replicates", &["csv"])?;
        let images = target.stem(&name, "-pictures", &output::DRAWING)?;
        let is_ours_alone = renderers.is_empty() && recorded.is_empty();
        if scene.name == "furnace" && is_ours_alone {
            console
                .warn("the metal sphere is left out of the furnace: it loses light, and without it the image is known");
            scene.objects.retain(|object| !matches!(object.material, Material::Conductor(_)));
        }
        let (scene, request) = self.size(scene, asked, renderers.iter().all(Renderer::has_size));
        let usual = || if self.scene.is_given() { Strategy::usual(&scene) } else { Vec::new() };
        let strategies = strategies.unwrap_or_else(usual);
        let mut contenders = Contender::of(&strategies);
        contenders.extend(renderers.into_iter().map(Contender::Renderer));
        let budget = self.budget.unwrap_or(BUDGET[0] + BUDGET[1] * self.renderer.len() as f64);
        contenders.extend(recorded.into_iter().map(Contender::Recorded));
        let (max_spp, replicates_asked) = (self.max_spp, self.replicates);
        let keep = self.keep_runs.clone();
        // What was spent on reading the scene is not left for measurements; a budget that is none is refused as it is
        let read = start.elapsed().as_secs_f64();
        let left = if budget > 0.0 { (budget - read).at_least(1e-3) } else { budget };
        if read > LONG_READING * budget {
            console.warn(&format!("reading took {} of the budget of {budget} s", duration(read)));
        }
        let plan = Plan { budget: left, max_spp, replicates: replicates_asked, seed: global.seed, keep };
        let reference = self.reference(&contenders, &request, console)?;
        let reference = reference.as_ref().map(|reference| match reference {
            Chosen::Image(image) => Asked::Known(image),
            Chosen::By(contender) => Asked::By(contender),
        });
        let bar = console.countdown(left, "converge");
        let mut result = measure(&scene, &request, &contenders, &plan, reference)?;
        bar.finish_and_clear();
        // Who fixes the samples compares images of equal ones
        result.equal_samples = self.max_spp.is_some();
        result.sufficient_budget = result.sufficient_budget.map(|seconds| seconds + read);
        let end = if result.interrupted { "the interruption".into() } else { format!("the budget of {budget} s") };
        for what in &result.cut {
            console.warn(&format!("stopped by {end}: {what}"));
        }
        for Fault { strategy, replicate, seed, spp, message } in &result.faults {
            console.warn(&format!("{strategy}, replicate {replicate} (seed {seed}, {spp} spp): {message}"));
        }
        result.notes.iter().for_each(|note| console.warn(&format!("{note}; {MORE_SAMPLES} may help")));
        let mut saving = Saving::default();
        if !result.curves.is_empty() {
            saving.add(output::write(&stem, &view::curves(&result), &style, &view::csv(&[&result])?));
            let table = output::with_extension(&replicates, "csv");
            let rows = view::replicates_csv(&result)?;
            saving.add(files::write_bytes(&table, &rows).map(|()| vec![table]));
            // Panels are those of the curves
            saving.add(view::images(&result, usize::MAX).write(&images, &style.with_all_panels()));
        }
        let checks = Checks {
            title: format!("etalon converge {}", result.scene),
            list: checks(&result, self.detect),
            seconds: start.elapsed().as_secs_f64(),
        };
        saving.add(self.reports.write(&checks));
        let (files, saved) = saving.end();
        let (common_cpu_seconds, common_rmse) = (result.common_seconds(), result.common_rmse());
        let output = Output { answer: Answer::of(&result, 0.95), result: &result, common_cpu_seconds, common_rmse };
        console.saved(&output, &target.written(files), || text(&output, self.detect));
        saved?;
        Ok(match result.interrupted {
            true => Verdict::Inconclusive,
            false if is_ours_alone => Verdict::of(true, !result.has_verdict()),
            false => Verdict::from(&checks),
        })
    }

    /// What stands for a scene where only images of other programs, of these names, are compared.
    fn nothing(&self, names: &[&str]) -> Result<Loaded> {
        let missing = |name: &str, message: &str, hint: &str| Err(Error::parameter(name, message).with_hint(hint));
        if self.strategies.iter().any(|name| name != "none") {
            return missing("strategies", "they render a scene, and none is given", "give a scene, or only renderers");
        }
        let Some(reference) = self.reference.as_deref() else {
            let hint = "an image file, or the name of the renderer that is right";
            return missing("reference", "without a scene there is nothing that renders one", hint);
        };
        let path = Path::new(reference);
        if !names.contains(&reference) && !path.is_file() {
            return missing(
                "reference",
                &format!("{reference:?} is no file and no renderer"),
                "an image file, or a renderer's name",
            );
        }
        let size = match self.scene.size_alone()? {
            Some(size) => size,
            None if path.is_file() => {
                let image = raster::read(path, ReadOptions::default())?;
                [image.width(), image.height()]
            }
            None => {
                return missing("resolution", "no file says how large the images are", "give their width and height");
            }
        };
        // Nothing renders it: of a scene there is only the name and the size
        let (scene, request) = builtin::cornell_lambert();
        let scene =
            Scene { name: names.join("-"), objects: Vec::new(), lights: Vec::new(), environment: None, ..scene };
        Ok(Loaded { scene, request: Request { width: size[0], height: size[1], ..request } })
    }

    /// The renderers in other programs.
    fn renderers(&self, global: &Global) -> Result<Vec<Renderer>> {
        let threads = global.threads.map_or_else(|| available_parallelism().map_or(1, usize::from), |n| n as usize);
        let limit = reply_limit(self.timeout)?;
        if let Some(path) = &self.renderer_scene {
            std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
        }
        let scene = self.renderer_scene.as_deref().or_else(|| self.scene.file());
        self.renderer.iter().map(|definition| Renderer::new(definition, scene, threads, limit)).collect()
    }

    /// The reference that is asked for: by a contender's name, a file, or a strategy that is not compared.
    fn reference(&self, contenders: &[Contender], request: &Request, console: &Console) -> Result<Option<Chosen>> {
        let Some(name) = &self.reference else { return Ok(None) };
        if let Some(contender) = contenders.iter().find(|contender| contender.name() == name) {
            return Ok(Some(Chosen::By(Box::new(contender.clone()))));
        }
        let path = Path::new(name);
        if path.is_file() {
            let (image, notes) = raster::read_with_notes(path, ReadOptions::default())?;
            notes.iter().for_each(|note| console.warn(note));
            let bad = image.pixels().iter().filter(|pixel| !pixel.is_finite()).count();
            if bad > 0 {
                console.warn(&format!("{name}: {}", left_out(bad)));
            }
            console.note(&format!(
                "the noise of {name} counts as error of the renderers; bias is judged by the mean of the image, in which it averages out"
            ));
            return Reference::given(image, request, name.clone()).map(|r| Some(Chosen::Image(Box::new(r))));
        }
        let strategy = name.parse::<Strategy>().map_err(|_| {
            Error::parameter("reference", format!("{name:?} is no file, renderer or strategy"))
                .with_hint("an image file, or the name of what renders it")
        })?;
        Ok(Some(Chosen::By(Box::new(strategy.into()))))
    }

    /// An image small enough to be rendered thousands of times, unless a size is given.
    fn size(&self, scene: Scene, asked: Request, may_change: bool) -> (Scene, Request) {
        let longest = asked.width.max(asked.height);
        let (scene, request) =
            if self.scene.has_size() || !self.scene.is_given() || !may_change || longest <= LONGEST_SIDE {
                (scene, asked)
            } else {
                let scaled = |side: usize| (side * LONGEST_SIDE).div_ceil(longest);
                scene.resized(asked, [scaled(asked.width), scaled(asked.height)])
            };
        let max_depth = self.max_depth.unwrap_or(request.max_depth);
        (scene, Request { light_samples: self.light_samples, max_depth, ..request })
    }
}

/// Whether a renderer is biased, and what is said of it: a bias that was found, or the one that would have been.
fn judged(result: &Convergence, curve: &Curve, detect: f64) -> (etalon_stats::Verdict, String) {
    use etalon_stats::Verdict::{Accept, Inconclusive, Reject};
    let bias = view::bias(result, curve);
    let found = match curve.verdict {
        _ if !curve.is_tested() => return (Inconclusive, bias),
        CurveVerdict::Unknown => format!("slope unknown; {bias}"),
        verdict => format!("{}; {bias}", view::word(verdict)),
    };
    match curve.verdict {
        CurveVerdict::Biased => (Reject, found),
        _ if curve.detectable_mean_bias <= detect => (Accept, format!("{found}; {}", view::detectable(curve))),
        _ => (Inconclusive, format!("{found}; {}", too_little(curve, detect))),
    }
}

/// "cannot tell: the smallest bias of the mean found with 90 % probability is 5.0 %, not 1 %; 200 replicates or 25 times …".
fn too_little(curve: &Curve, detect: f64) -> String {
    let percent = |share: f64| format!("{} %", rounded(100.0 * share, 2));
    let needed = match curve.samples_to_find(detect) {
        Some(times) => {
            let replicates = (times * curve.replicates as f64).ceil();
            let times = rounded(times, 2);
            format!(
                "about {replicates} replicates, or {times} times the samples (--replicates, --budget), would find that"
            )
        }
        None => "the noise of the reference hides that".into(),
    };
    format!(
        "cannot tell: the smallest bias of the image's mean found with 90 % probability is {}, not {} (--detect); {needed}",
        percent(curve.detectable_mean_bias),
        percent(detect)
    )
}

/// A check for each renderer in another program: whether it is biased against the reference, and no run of it failed.
fn checks(result: &Convergence, detect: f64) -> Vec<Check> {
    let source = result.reference.as_ref().map_or("no reference", |facts| &facts.source);
    let check = |name: &str, verdict, message: String| Check {
        group: format!("{} against {source}", result.scene),
        name: name.to_owned(),
        verdict: Some(verdict),
        message,
        details: String::new(),
        seconds: None,
    };
    let external = result.curves.iter().filter(|curve| curve.contender.is_timed_from_outside());
    let failures = view::failures(result);
    let failed = failures.iter().map(|(Fault { strategy, replicate, seed, spp, message }, count)| {
        let also = result.curve(strategy).map(|curve| judged(result, curve, detect).1);
        let also = also.map_or(String::new(), |also| format!("; {also}"));
        let message = format!("{message} ({count} failed; replicate {replicate}, seed {seed}, {spp} spp){also}");
        check(strategy, etalon_stats::Verdict::Reject, message)
    });
    let whole = external.filter(|curve| failures.iter().all(|(fault, _)| fault.strategy != curve.strategy));
    let of_curve = whole.map(|curve| {
        let (verdict, found) = judged(result, curve, detect);
        check(&curve.strategy, verdict, found)
    });
    let mut list: Vec<Check> = of_curve.chain(failed).collect();
    if list.is_empty() {
        let why = if result.interrupted { "interrupted" } else { "the budget was too small" };
        let message = format!("{why}: no renderer has finished all its renders");
        list.push(check("budget", etalon_stats::Verdict::Inconclusive, message));
    }
    list
}

/// A reference that was asked for.
enum Chosen {
    Image(Box<Reference>),
    By(Box<Contender>),
}

fn text(output: &Output<'_>, detect: f64) -> String {
    let Output { answer, result, common_cpu_seconds, common_rmse } = output;
    let failed = view::failures(result)
        .into_iter()
        .map(|(fault, count)| wrapped(&format!("failed: {}: {} ({count})", fault.strategy, fault.message), "", LINE));
    let failed: String = failed.collect();
    let sufficient = result.sufficient_budget.map_or(String::new(), |seconds| {
        format!("too little time for verdicts: a budget of about {} would do (--budget)\n", duration(seconds))
    });
    if result.curves.is_empty() {
        let what = if result.faults.is_empty() { "finished its renders" } else { "given images that can be used" };
        let before = if result.interrupted { " before the interruption" } else { "" };
        return format!("{failed}no answer: no method has {what}{before}\n{sufficient}");
    }
    let untested = result.curves.iter().filter(|curve| !curve.is_tested());
    let untested = untested.map(|curve| format!("{}: {}\n", curve.strategy, view::bias(result, curve)));
    let mut text = failed + &untested.collect::<String>();
    text.extend(view::sentences(answer.as_ref()).lines().map(|line| wrapped(line, "", LINE)));
    text += &sufficient;
    text += &format!("{}, {}x{} pixels; ", result.scene, result.width, result.height);
    text += &match &result.reference {
        None => "no reference\n".to_owned(),
        Some(facts) if facts.spp == 0 => format!("against {}\n", facts.source),
        Some(facts) => {
            format!("reference by {}, {} spp, its own RMSE {}\n", facts.source, facts.spp, rounded(facts.rmse, 3))
        }
    };
    text += &view::table(result);
    if common_rmse.is_finite() {
        text += &format!("* processor time to an RMSE of {}\n", rounded(*common_rmse, 3));
    }
    let equal = duration(*common_cpu_seconds);
    text += &format!("† after equal time, {equal} of processor time; the CSV file has all levels\n");
    for curve in &result.curves {
        let Some(fit) = curve.times else { continue };
        let of = |e: etalon_stats::estimate::Estimate| [e.value, e.half_width];
        let [start, each] = [fit.startup_cpu_seconds, fit.cpu_seconds_per_spp].map(of);
        let [wall, wall_each] = [fit.startup_wall_seconds, fit.wall_seconds_per_spp].map(of);
        let times = format!(
            "start-up {:.3} ± {:.3} s, {:.5} ± {:.5} s of processor time per spp; wall clock {:.3} ± {:.3} s, {:.5} ± {:.5} s",
            start[0], start[1], each[0], each[1], wall[0], wall[1], wall_each[0], wall_each[1]
        );
        text += &format!("{}:\n{}", curve.strategy, wrapped(&times, "  ", LINE));
    }
    let is_judged = |curve: &&Curve| {
        curve.contender.is_timed_from_outside() && curve.is_tested() && curve.verdict != CurveVerdict::Biased
    };
    let mut is_any_accepted = false;
    for curve in result.curves.iter().filter(is_judged) {
        let is_accepted = curve.detectable_mean_bias <= detect;
        let found = if is_accepted { view::detectable(curve) } else { too_little(curve, detect) };
        text += &wrapped(&format!("{}: {found}", curve.strategy), "", LINE);
        is_any_accepted |= is_accepted;
    }
    if is_any_accepted {
        text += "a part of an image may hide a larger bias: etalon compare IMAGE... --against\nIMAGE... tests tiles, too (--keep-runs DIR keeps images)\n";
    }
    text += &match result.exact_seconds {
        0.0 => format!("{:.1} s in all\n", result.seconds),
        exact => {
            format!("{:.1} s in all, {exact:.1} s of them for the exact image, no part of --budget\n", result.seconds)
        }
    };
    if result.interrupted {
        text += "interrupted: this is what was measured until then\n";
    }
    text
}
