//! `etalon render`: pictures of scenes.

use super::console::{Console, files_written};
use super::map_file::{self, MapOptions};
use super::{Global, Verdict};
use crate::error::{Error, Result};
use crate::import::pbrt::{self, PbrtOptions};
use crate::raster::{self, Metadata, ReadOptions, ToneMap, WriteOptions};
use crate::render::{self, Dropped, LightDensity, Rendered, Settings};
use crate::report::output::{self, Target};
use crate::sampling::stream::StreamKind;
use crate::scene::{Environment, Request, Scene, builtin};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Render a scene: a built-in one (sphere-env) or a .pbrt file
#[derive(Args)]
#[command(after_help = "Without -o (or with a folder) the picture is written as EXR, PFM, PPM (the first report's: \
                        linear, scaled by its maximum) and PNG (sRGB); with a file name, in that format and as PNG.\n\n\
                        Examples:\n  etalon render sphere-env -s 64 -o out\n  etalon render sphere-env --envmap \
                        grace.exr --flip -s 16 -o grace.exr\n  etalon render simple_sphere.pbrt --envmap grace.exr -s 8")]
pub struct Render {
    /// sphere-env, or a .pbrt file
    scene: String,
    /// Camera samples per pixel
    #[arg(short, value_name = "SPP")]
    spp: Option<u32>,
    /// Light samples at each hit
    #[arg(short, value_name = "N")]
    light_samples: Option<u32>,
    /// 0: emission only; 1: direct light; n: light over at most n segments
    #[arg(short, value_name = "DEPTH")]
    max_depth: Option<u32>,
    /// Width and height in pixels
    #[arg(short, num_args = 2, value_names = ["W", "H"])]
    resolution: Option<Vec<usize>>,
    /// The environment map: a file or a built-in name (in a .pbrt scene it stands in for the file's mapname)
    #[arg(long, value_name = "MAP")]
    envmap: Option<String>,
    #[command(flatten)]
    options: MapOptions,
    /// How directions towards the light are chosen: by the light, by the material, by both (a diffuse surface needs no
    /// material samples where the light density has the cosine in it), or uniformly
    #[arg(long, value_enum, default_value_t = SamplingName::Mis)]
    sampling: SamplingName,
    /// What directions towards the environment are drawn in proportion to: radiance times cosine, radiance, or radiance
    /// less its mean (for MIS only)
    #[arg(long, value_enum, default_value_t = DensityName::Cosine)]
    light_density: DensityName,
    /// Owen-scrambled Sobol' or independent random numbers
    #[arg(long, value_enum, default_value_t = StreamName::Sobol)]
    stream: StreamName,
    /// Run the kernel with nothing left out: the same picture, for comparison
    #[arg(long)]
    general: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SamplingName {
    Light,
    Bsdf,
    Mis,
    Hemisphere,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DensityName {
    Cosine,
    Map,
    Compensated,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum StreamName {
    Sobol,
    Independent,
}

#[derive(Serialize)]
struct Output<'a> {
    scene: &'a str,
    width: usize,
    height: usize,
    spp: u32,
    light_samples: u32,
    max_depth: u32,
    seconds: f64,
    mean_rgb: [f64; 3],
    dropped: Dropped,
    left_out: &'a [&'static str],
    files: Vec<PathBuf>,
}

impl Render {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let (scene, asked) = self.scene(console)?;
        let [width, height] = match self.resolution.as_deref() {
            Some(&[w, h]) => [w, h],
            _ => [asked.width, asked.height],
        };
        let request = Request {
            width,
            height,
            spp: self.spp.unwrap_or(asked.spp),
            light_samples: self.light_samples.unwrap_or(asked.light_samples),
            max_depth: self.max_depth.unwrap_or(asked.max_depth),
        };
        let scene = Scene { camera: scene.camera.fitted([asked.width, asked.height], [width, height]), ..scene };
        let bar = console.progress((width * height) as u64 * u64::from(request.spp), &scene.name);
        let rendered = render::render(&scene, &request, &self.settings(global.seed), &Bar(&bar))?;
        bar.finish_and_clear();
        let files = self.write(&scene, &rendered, global)?;
        if rendered.dropped.total() > 0 {
            console.warn(&format!(
                "{} samples were not finite and {} negative; they count as black (first at pixel {:?})",
                rendered.dropped.nonfinite,
                rendered.dropped.negative,
                rendered.dropped.first_pixel.unwrap_or_default()
            ));
        }
        let output = Output {
            scene: &scene.name,
            width,
            height,
            spp: request.spp,
            light_samples: request.light_samples,
            max_depth: request.max_depth,
            seconds: rendered.seconds,
            mean_rgb: mean(&rendered),
            dropped: rendered.dropped,
            left_out: &rendered.left_out,
            files,
        };
        console.result(&output, || {
            let left_out = if output.left_out.is_empty() { "nothing".into() } else { output.left_out.join(", ") };
            format!(
                "{} {width}x{height}, {} samples per pixel, {} light samples: {:.2} s, mean {:.5} {:.5} {:.5}\nleft out: {left_out}\n{}",
                output.scene,
                output.spp,
                output.light_samples,
                output.seconds,
                output.mean_rgb[0],
                output.mean_rgb[1],
                output.mean_rgb[2],
                files_written(&output.files)
            )
        });
        Ok(Verdict::Good)
    }

    fn settings(&self, seed: u64) -> Settings {
        Settings {
            sampling: match self.sampling {
                SamplingName::Light => render::Sampling::Light,
                SamplingName::Bsdf => render::Sampling::Bsdf,
                SamplingName::Mis => render::Sampling::Mis,
                SamplingName::Hemisphere => render::Sampling::Hemisphere,
            },
            density: match self.light_density {
                DensityName::Cosine => LightDensity::Cosine,
                DensityName::Map => LightDensity::Map,
                DensityName::Compensated => LightDensity::Compensated,
            },
            stream: match self.stream {
                StreamName::Sobol => StreamKind::Sobol,
                StreamName::Independent => StreamKind::Independent,
            },
            seed,
            general: self.general,
            ..Settings::default()
        }
    }

    fn scene(&self, console: &Console) -> Result<(Scene, Request)> {
        let path = Path::new(&self.scene);
        if self.scene == "sphere-env" {
            let source = map_file::load(self.envmap.as_deref().unwrap_or("nave"), self.options, console)?;
            let info = crate::envmap::info::Info::of(&source.map);
            map_file::warn_upside_down(&info, &source.name, console);
            return Ok(builtin::sphere_env(Environment::upright(source.map, source.name, builtin::SPHERE_ENV_SCALE)));
        }
        if let Some(found) = builtin::by_name(&self.scene, None)? {
            return Ok(found);
        }
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("pbrt")) {
            let environment = match &self.envmap {
                Some(name) => Some(map_file::load(name, self.options, console)?).map(|s| (s.map, s.name)),
                None => None,
            };
            let ldr = ReadOptions { allow_ldr: self.options.ldr };
            let load_map = |p: &Path| {
                raster::read(p, ldr)
                    .map_err(|e| e.with_hint("--envmap FILE stands in for the map that the scene names"))
            };
            let imported = pbrt::read(path, &PbrtOptions { environment, load_map: &load_map })?;
            for warning in &imported.warnings {
                console.warn(warning);
            }
            return Ok((imported.scene, imported.request));
        }
        Err(Error::parameter("SCENE", format!("\"{}\" is neither a built-in scene nor a .pbrt file", self.scene))
            .with_hint("built-in scenes: sphere-env"))
    }

    fn write(&self, scene: &Scene, rendered: &Rendered, global: &Global) -> Result<Vec<PathBuf>> {
        let metadata = Metadata::default()
            .with("command", std::env::args().collect::<Vec<_>>().join(" "))
            .with("seed", global.seed)
            .with("spp", rendered.request.spp)
            .with("lightSamples", rendered.request.light_samples)
            .with("maxDepth", rendered.request.max_depth)
            .with("seconds", format!("{:.3}", rendered.seconds))
            .with("droppedNonfinite", rendered.dropped.nonfinite)
            .with("droppedNegative", rendered.dropped.negative);
        let stem = Target::new(global.out.as_deref()).stem(&output::file_name(&scene.name), "");
        let formats: Vec<&str> = match output::image_format(global.out.as_deref())? {
            Some("png") => vec!["png"],
            Some(format) => vec![format, "png"],
            None => vec!["exr", "pfm", "ppm", "png"],
        };
        formats
            .into_iter()
            .map(|format| {
                let path = output::with_extension(&stem, format);
                let tone = if format == "ppm" { ToneMap::LinearMax } else { ToneMap::Srgb { stops: 0.0 } };
                raster::write_with(
                    &path,
                    &rendered.image,
                    &metadata,
                    WriteOptions { tone, ..WriteOptions::default() },
                )?;
                Ok(path)
            })
            .collect()
    }
}

fn mean(rendered: &Rendered) -> [f64; 3] {
    let pixels = rendered.image.pixels();
    let sum: glam::DVec3 = pixels.iter().map(|p| p.as_dvec3()).sum();
    (sum / pixels.len() as f64).to_array()
}

struct Bar<'a>(&'a indicatif::ProgressBar);
impl render::Control for Bar<'_> {
    fn done(&self, n: u64) {
        self.0.inc(n);
    }
}
