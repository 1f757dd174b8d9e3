//! `etalon render`: images of scenes.

mod appearance;
mod model;
mod results;
mod work;

use super::console::Console;
use super::flags::command_line;
use super::global::{Global, OUTPUT, SAMPLING, Verdict, out, seed, threads};
use super::scene_file::{Loaded, SceneArgs, has_material, is_glass, is_metal};
use super::style::StyleArgs;
use super::values::{Shard, choice, map_samplers, map_sampling, stops};
use appearance::ExternalArgs;
use clap::Args;
use etalon_core::build::Build;
use etalon_core::envmap::samplers::MapSampling;
use etalon_core::errata::microfacet::MetalErrors;
use etalon_core::error::{Error, Result};
use etalon_core::raster::{BUILD_NAME, Metadata, ToneMap};
use etalon_core::sampling::stream::StreamKind;
use etalon_core::scene::{Request, Scene};
use etalon_figures::output::Target;
use etalon_figures::view::text::counted;
use etalon_render::film::{Film, Part, PathClasses, shard};
use etalon_render::{Job, Kernel, Sampling, Settings};
use model::ModelArgs;
use results::{Images, Look, Summary};
use std::ops::Range;
use std::path::PathBuf;

/// Render a scene
#[derive(Args)]
#[command(after_long_help = AFTER_HELP)]
#[command(args = [out(), seed(), threads()])]
pub struct Render {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    external: ExternalArgs,
    #[command(flatten)]
    style: StyleArgs,
    /// Camera samples per pixel [default: the scene's]
    #[arg(help_heading = SAMPLING, short, long, value_name = "SPP")]
    spp: Option<u32>,
    /// Light samples at each hit [default: the scene's]
    #[arg(help_heading = SAMPLING, short, long, value_name = "N")]
    light_samples: Option<u32>,
    /// Most scatterings of a path [default: the scene's]
    ///
    /// 0: emission only, 1: direct light.
    #[arg(help_heading = SAMPLING, short, long = "depth", value_name = "DEPTH")]
    max_depth: Option<u32>,
    /// The same as -o
    #[arg(help_heading = SAMPLING, short, hide = true, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Which techniques find the light [default: chosen by a trial of the scene]
    ///
    /// To compare images of two at equal samples, give --uniform, too.
    #[arg(help_heading = SAMPLING, long, value_parser = choice(Sampling::ALL.map(|s| (s.name(), s.about(), s))))]
    sampling: Option<Sampling>,
    /// The same as --sampling hemisphere
    #[arg(help_heading = SAMPLING, short = 'H', hide = true, conflicts_with = "sampling")]
    hemisphere: bool,
    /// How directions towards the environment are sampled
    #[arg(help_heading = SAMPLING, long, value_name = "NAME", long_help = density_help(), value_parser = map_sampling)]
    light_density: Option<MapSampling>,
    /// Owen-scrambled Sobol' or independent random numbers
    #[arg(help_heading = SAMPLING, long, default_value = "sobol",
          value_parser = choice([("sobol", "", StreamKind::Sobol), ("independent", "", StreamKind::Independent)]))]
    stream: StreamKind,
    /// No adaptive sampling: one camera path for each sample
    ///
    /// By default, pixels with more noise than most have several.
    #[arg(help_heading = SAMPLING, long)]
    uniform: bool,
    #[command(flatten)]
    model: ModelArgs,
    /// Tone mapping of PNG and PPM
    #[arg(long, help_heading = OUTPUT, default_value = "srgb", value_parser = choice([
        ("srgb", "The sRGB curve, rounded", ToneMap::default()),
        ("report", "Half a stop brighter, gamma 2.2, clipped: as in the second report",
         ToneMap::SecondReport),
    ]))]
    tone: ToneMap,
    /// Exposure of PNG and PPM in stops, before tone mapping
    #[arg(long, help_heading = OUTPUT, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    exposure: f32,
    /// Show each pixel as N x N pixels of the PNG
    #[arg(long, help_heading = OUTPUT, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=16))]
    scale: u32,
    /// Layers of the EXR file with the light of each path class (LDE, LSDE, ...)
    ///
    /// Up to N scatterings; 4 if N is not given.
    #[arg(long, help_heading = OUTPUT, value_name = "N", num_args = 0..=1, default_missing_value = "4",
          value_parser = clap::value_parser!(u32).range(0..=6))]
    paths: Option<u32>,
    /// Continue from FILE if it exists, and save the state in it, also at the end
    #[arg(long, help_heading = OUTPUT, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Render the I-th of N equal shares of the samples, for `etalon merge`
    #[arg(long, help_heading = OUTPUT, value_name = "I/N")]
    shard: Option<Shard>,
    /// Run also what the scene does not need: the same image, for comparison
    #[arg(help_heading = SAMPLING, long)]
    general: bool,
    /// The implementation that renders
    #[arg(help_heading = SAMPLING, long, default_value = "lanes", value_parser = choice([
        ("lanes", "many paths side by side, in loops that vectorize", Kernel::Lanes),
        ("reference", "one path after the other, as the textbook describes it; no light tracing", Kernel::Reference),
    ]))]
    kernel: Kernel,
}

fn density_help() -> String {
    let usual = "default: cosine-compensated with mis and mis+lt, otherwise cosine; without --sampling what has the least variance in a few pixels";
    format!("How directions towards the environment are sampled ({usual}). {}", map_samplers(|_| true))
}

const AFTER_HELP: &str = "\
Without -o (or with a folder) the image is written as EXR, PFM, PPM and PNG, named after the scene; with a file name, in that format and as PNG. The EXR file also has \
the standard error of every pixel.

`etalon scenes` lists what built-in scenes ask for: size, -s, -l, -m. As in the course's command line, -f FILE means -o FILE, and -H --sampling hemisphere.

Ctrl-C (and SIGTERM) end a render early: the samples so far go to an EXR file, with a PNG preview, and the same command \
with --resume FILE continues it, to the same bits as an uninterrupted render. --resume FILE from the beginning also \
saves the state every minute. A finished FILE can be continued with a larger -s.

Exit codes: 0 good, 2 usage or bad input, 3 interrupted.

Examples:
  etalon render sphere-env -s 64 -o out
  etalon render sphere-env --envmap grace.exr --flip -s 16 -o sphere.exr
  etalon render cornell-spheres -s 256 -l 4 -m 7 -r 480 360 --paths 3
  etalon render cornell-statue-au --alpha 0.005 --model report --tone report
  etalon render cornell-statue-cu -s 256 --exposure 1 --scale 2 -o slide.png
  etalon render CBspheres.dae -s 64 -m 5 -r 480 360 -f spheres.png
  etalon render sphere-env --bsdf my_bsdf.py
  etalon render cornell-spheres -s 4096 --resume state.exr
  etalon render cornell-spheres -s 4096 --shard 1/8 -o part-1.exr";

impl Render {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        if let Some(source) = self.external.source() {
            return self.appearance(source, global, console);
        }
        if let Some((flag, _)) = self.style.flags().first() {
            return Err(Error::parameter(flag.trim_start_matches('-'), "the renderer writes images, and no figure")
                .with_hint("it goes with `bsdf` FILE.py or `exec`"));
        }
        let model = self.model.model()?;
        if self.scene.has_multiple_scattering() && model.metal != MetalErrors::NONE {
            return Err(Error::parameter("multiple_scattering", "the report's metal has single scattering alone"));
        }
        let images = self.images(global)?;
        let Loaded { scene, request: asked } = self.scene.load(console)?;
        self.check_effect(&scene)?;
        let settings = self.settings(Settings { seed: global.seed, model, ..Settings::usual() });
        // The scene's request, changed by flags; a resumed render has the samples of its state by default
        let state = self.resume.as_deref();
        let held = state.map(work::held).transpose()?.flatten();
        let request = Request {
            spp: self.spp.or(held.as_ref().map(|part| part.ranges().spp())).unwrap_or(asked.spp),
            light_samples: self.light_samples.unwrap_or(asked.light_samples),
            max_depth: self.max_depth.unwrap_or(asked.max_depth),
            ..asked
        };
        let samples = self.samples(request.spp, held.as_ref())?;
        // Prepare the render and check the files, before any sample
        let job = Job::new(&scene, &request, &settings)?;
        let metadata = self.metadata(&scene, &request, job.settings());
        let fresh = job.part(metadata.clone())?;
        let mut part = match (held, state) {
            (Some(held), Some(path)) => work::continued(held, path, &fresh)?,
            _ => fresh,
        };
        images.check(&scene.name, state)?;
        if let Some(path) = state.filter(|_| part.ranges().have(&samples)) {
            console.warn(&format!("{}: all samples are there; the images are written again", path.display()));
        }
        // Render, with the time of all runs in the metadata of every save
        let (before, count) = (seconds(&part.metadata), part.count());
        let describe =
            |part: &mut Part| part.metadata = metadata.clone().with(SECONDS, format!("{:.3}", before + job.seconds()));
        let save = state.map(|path| {
            move |part: &mut Part| {
                describe(part);
                part.save(path)
            }
        });
        let save = save.as_ref().map(|save| save as work::Save);
        work::run(&job, &mut part, &samples, console, &scene.name, save)?;
        describe(&mut part);

        // Write the images and report
        let interrupted = !part.ranges().have(&samples);
        let mut summary = Summary::new(&scene.name, &request, &part, part.count() - count, job.seconds());
        summary.left_out = job.left_out();
        summary.interrupted = interrupted;
        summary.written = images.write(&part, &scene.name, state, interrupted)?;
        warn_of_lost_light(&part.film, console);
        if interrupted && let Some(file) = summary.written.files.first() {
            console.warn(&format!("interrupted; to continue: the same command with --resume {}", file.display()));
            let black = part.film.pixels().iter().filter(|pixel| pixel.samples() == 0).count();
            if black > 0 {
                console.warn(&format!("{} without a sample: black", counted(black, "pixel")));
            }
        }
        console.result(&summary, || summary.text());
        Ok(if interrupted { Verdict::Inconclusive } else { Verdict::Good })
    }

    /// Refuses options that change nothing in this scene.
    fn check_effect(&self, scene: &Scene) -> Result<()> {
        let without = |name: &str, what: &str| {
            Err(Error::parameter(name, format!("the scene {} has no {what}", scene.name))
                .with_hint("`etalon scenes` lists the options of built-in scenes"))
        };
        if self.light_density.is_some() && scene.environment.is_none() {
            return without("light_density", "environment map");
        }
        if self.model.has_normals() && !has_material(scene, is_metal) {
            return without("normals", "metal");
        }
        if self.model.has_fresnel() && !has_material(scene, is_glass) {
            return without("fresnel", "glass");
        }
        Ok(())
    }

    fn images(&self, global: &Global) -> Result<Images> {
        if self.file.is_some() && global.out.is_some() {
            return Err(Error::parameter("file", "`out` is given, too").with_hint("both mean the same"));
        }
        let shard = self.shard.map(Shard::suffix);
        let out = self.file.as_deref().or(global.out.as_deref());
        let look = Look { tone: self.tone, exposure: self.exposure, scale: self.scale };
        Images::new(out, Target::new(out, &global.arguments.subject), look, shard)
    }

    /// The samples to render: all, or a shard's.
    fn samples(&self, spp: u32, held: Option<&Part>) -> Result<Range<u32>> {
        let Some(Shard { index, count }) = self.shard else { return Ok(0..spp) };
        if count > spp {
            return Err(Error::parameter("shard", format!("{spp} samples per pixel cannot be cut into {count}"))
                .with_hint("at most one shard for each sample of `spp`"));
        }
        match held.map(|part| part.ranges().spp()) {
            Some(held) if held != spp => {
                Err(Error::parameter("spp", format!("{spp}, but the shard to continue is of {held} samples"))
                    .with_hint("all shards of an image need the same `spp`"))
            }
            _ => Ok(shard(index, count, spp)),
        }
    }

    /// The settings by default, changed by flags.
    fn settings(&self, usual: Settings) -> Settings {
        let asked = if self.hemisphere { Some(Sampling::Hemisphere) } else { self.sampling };
        let (stream, general, kernel) = (self.stream, self.general, self.kernel);
        let paths = self.paths.map(PathClasses::up_to);
        let plain = Settings { stream, paths, general, kernel, adaptive: !self.uniform, ..usual };
        if asked.is_none() && self.light_density.is_none() && self.kernel == Kernel::Lanes {
            return plain;
        }
        let sampling = asked.unwrap_or(match self.kernel {
            Kernel::Lanes => Sampling::default(),
            Kernel::Reference => Sampling::Mis,
        });
        Settings { sampling, density: self.light_density, choose: false, ..plain }
    }

    fn metadata(&self, scene: &Scene, request: &Request, settings: &Settings) -> Metadata {
        Metadata::default()
            .with("command", command_line())
            .with(BUILD_NAME, Build::current().id())
            .with("scene", &scene.name)
            .with("seed", settings.seed)
            .with("spp", request.spp)
            .with("lightSamples", request.light_samples)
            .with("maxDepth", request.max_depth)
            .with("filter", scene.camera.filter)
            .with("sampling", settings.sampling.name())
            .with("lightDensity", settings.map_sampling().density())
            .with("adaptive", settings.adaptive)
            .with("stream", lower(settings.stream))
            .with("model", self.model.names())
            .with("fresnel", lower(settings.model.dielectric))
            .with("normals", settings.model.normals.name())
    }
}

/// The attribute with the seconds of all runs together.
const SECONDS: &str = "seconds";

fn seconds(metadata: &Metadata) -> f64 {
    metadata.get(SECONDS).and_then(|text| text.parse().ok()).filter(|s: &f64| s.is_finite()).unwrap_or(0.0)
}

/// The name of an enum's variant in lower case, which is its name at the command line.
fn lower(variant: impl std::fmt::Debug) -> String {
    format!("{variant:?}").to_lowercase()
}

/// The share of the light that rounding may take without a warning.
const ROUNDING: f64 = 1e-4;

/// Warns of samples that count as black, and of light at the lower end of the film's range.
pub fn warn_of_lost_light(film: &Film, console: &Console) {
    let dropped = film.dropped();
    if dropped.total() > 0 {
        console.warn(&dropped.to_string());
    }
    let lost = film.lost_to_rounding();
    if lost > ROUNDING {
        console.warn(&format!(
            "the light is as faint as the film's unit, 2^-64 = 5.4e-20: rounding takes up to {:.1} % of it ({} samples count as \
             black); scale the lights up",
            100.0 * lost,
            dropped.faint
        ));
    }
}
