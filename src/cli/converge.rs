//! `etalon converge`: error against run time.

use super::console::Console;
use super::global::{Global, Verdict};
use super::scene_file::{Loaded, SceneArgs};
use crate::error::Result;
use crate::output::{self, file_name};
use crate::scene::{Material, Request, Scene};
use crate::study::converge::strategy::{self, SUFFIXES, Strategy};
use crate::study::converge::{Convergence, Plan, measure};
use crate::view::converge::{self as view, duration, word};
use clap::{ArgAction, Args};
use serde::Serialize;

/// Measure the error of sampling strategies against their run time
#[derive(Args)]
#[command(after_help = after_help())]
pub struct Converge {
    #[command(flatten)]
    scene: SceneArgs,
    /// Strategies, with commas between them (default: eight that suit the scene)
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', action = ArgAction::Set)]
    strategies: Vec<String>,
    /// Seconds for the whole run, including the reference
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, allow_negative_numbers = true)]
    budget: f64,
    /// Samples per pixel at which every curve ends
    #[arg(long, value_name = "N", default_value_t = 4096)]
    max_spp: u32,
    /// Renders of each strategy with different seeds, for the confidence bands
    #[arg(long, value_name = "N", default_value_t = 8)]
    replicates: u32,
    /// Light samples at each hit
    #[arg(short, value_name = "N", default_value_t = 1)]
    light_samples: u32,
    /// Longest paths, in segments after the camera's (default: what the scene asks for)
    #[arg(short, value_name = "DEPTH")]
    max_depth: Option<u32>,
}

fn after_help() -> String {
    let methods: String = strategy::methods().iter().map(|(name, what)| format!("  {name:<16} {what}\n")).collect();
    let suffixes: String = SUFFIXES.map(|(suffix, about, _)| format!("  ...+{suffix:<12} {about}\n")).concat();
    format!(
        "Strategies:\n{methods}{suffixes}\nErrors are against the exact image (sphere-env; furnace without its metal \
         sphere), else against two\nlong renders that take half of the budget; images are at most \
         {LONGEST_SIDE} pixels long unless -r says\nmore. Writes SCENE-converge.{{csv,svg,png,pdf}} (curves) and \
         SCENE-converge-pictures.{{svg,png,pdf}}.\n\nExit codes: 0 good, 2 usage or bad input, 3 the budget was too small \
         for any verdict, or interrupted.\n\nExamples:\n  etalon converge sphere-env\n  etalon converge cornell-spheres --budget 60\n  \
         etalon converge sphere-env --envmap sun --strategies light,strata-64,median-cut-64"
    )
}

/// Longest side of an image whose size is not given.
const LONGEST_SIDE: usize = 120;

#[derive(Serialize)]
struct Output<'a> {
    #[serde(flatten)]
    result: &'a Convergence,
    common_cpu_seconds: f64,
    common_rmse: f64,
}

impl Converge {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let strategies = self.strategies.iter().map(|name| name.parse()).collect::<Result<Vec<Strategy>>>()?;
        let Loaded { mut scene, request: asked, map } = self.scene.load(console)?;
        let target = global.target(&["scene"]).with_inputs(&Vec::from_iter(map));
        let name = format!("{}-converge", file_name(&scene.name));
        let stem = target.stem(&name, "", &output::STUDY)?;
        let images = target.stem(&name, "-pictures", &output::DRAWING)?;
        if scene.name == "furnace" {
            console
                .warn("the metal sphere is left out of the furnace: it loses light, and without it the image is known");
            scene.objects.retain(|object| !matches!(object.material, Material::Conductor(_)));
        }
        let (scene, request) = self.size(scene, asked);
        let strategies = if strategies.is_empty() { Strategy::usual(&scene) } else { strategies };
        let plan = Plan { budget: self.budget, max_spp: self.max_spp, replicates: self.replicates, seed: global.seed };
        let result = measure(&scene, &request, &strategies, &plan, None)?;
        let end =
            if result.interrupted { "the interruption".into() } else { format!("the budget of {} s", self.budget) };
        for what in &result.cut {
            console.warn(&format!("stopped by {end}: {what}"));
        }
        let mut files = output::write(&stem, &view::curves(&result), &output::table(&view::rows(&result))?)?;
        files.extend(view::images(&result).write(&images)?);
        let (common_cpu_seconds, common_rmse) = (result.common_seconds(), result.common_rmse());
        let output = Output { result: &result, common_cpu_seconds, common_rmse };
        console.saved(&output, &target.written(files), || text(&output));
        Ok(if result.has_verdict() && !result.interrupted { Verdict::Good } else { Verdict::Inconclusive })
    }

    /// An image small enough to be rendered thousands of times, unless a size is given.
    fn size(&self, scene: Scene, asked: Request) -> (Scene, Request) {
        let longest = asked.width.max(asked.height);
        let (scene, request) = if self.scene.has_size() || longest <= LONGEST_SIDE {
            (scene, asked)
        } else {
            let scaled = |side: usize| (side * LONGEST_SIDE).div_ceil(longest);
            scene.resized(asked, [scaled(asked.width), scaled(asked.height)])
        };
        let max_depth = self.max_depth.unwrap_or(request.max_depth);
        (scene, Request { light_samples: self.light_samples, max_depth, ..request })
    }
}

fn text(output: &Output<'_>) -> String {
    let Output { result, common_cpu_seconds, common_rmse } = output;
    let mut text = format!("{}, {}x{} pixels; ", result.scene, result.width, result.height);
    text += &match &result.reference {
        None => "no reference\n".to_owned(),
        Some(facts) if facts.exact => "against the exact image\n".to_owned(),
        Some(facts) => format!("reference of {} spp, its own RMSE {:.2e}\n", facts.spp, facts.rmse),
    };
    text += &format!(
        "{:<26} {:>7} {:>10} {:>10} {:>10} {:>8}  {:<17} {:<15} time to RMSE {common_rmse:.2e}\n",
        "strategy", "spp", "time", "RMSE", "rel. MSE", "FLIP", "slope", "verdict"
    );
    for curve in &result.curves {
        let Some(level) = curve.levels.last() else { continue };
        let slope = match curve.slope.value {
            unknown if unknown.is_nan() => "unknown".to_owned(),
            value => format!("{value:.3} ± {:.3}", curve.slope.half_width),
        };
        text += &format!(
            "{:<26} {:>7} {:>10} {:>10.3e} {:>10.3e} {:>8}  {slope:<17} {:<15} {}\n",
            curve.strategy.name,
            level.spp,
            duration(level.cpu_seconds),
            level.rmse(),
            level.rel_mse.value,
            level.flip.map_or("none".into(), |flip| format!("{flip:.4}")),
            word(curve.verdict),
            curve.time_to(*common_rmse).map_or("never".into(), duration),
        );
    }
    text +=
        &format!("equal time: {} of processor time; {:.1} s in all\n", duration(*common_cpu_seconds), result.seconds);
    if result.interrupted {
        text += "interrupted: this is what was measured until then\n";
    }
    text
}
