//! `etalon render SCENE --bsdf FILE.py` and `--exec COMMAND`: spheres with the BSDF of another program, by its values alone, and with the
//! closest model.

use super::Render;
use crate::cli::console::Console;
use crate::cli::families::{ProgramSource, REPLY_LIMIT};
use crate::cli::flags::command_line;
use crate::cli::global::{Global, SCENE, Verdict};
use crate::cli::scene_file::Loaded;
use crate::cli::values::setting;
use clap::{ArgAction, ArgGroup, Args};
use etalon_bench::appearance::{Rendered, appearance};
use etalon_bench::validation::families;
use etalon_core::error::{Error, Result};
use etalon_core::raster::{Layer, Metadata, Precision, write_exr};
use etalon_core::scene::Request;
use etalon_figures::output;
use etalon_figures::view::appearance as view;
use etalon_render::film::ERRORS_OF_SUMS;
use etalon_stats::bsdf::Family;

/// The longer side of the images, and samples per pixel, unless they are given: a program in plain Python takes seconds.
const LONGER_SIDE: usize = 128;
const SPP: u32 = 16;

/// Options of the renderer that renders the program's own BSDFs.
const OF_RENDERER: [&str; 18] = [
    "light_samples",
    "sampling",
    "hemisphere",
    "light_density",
    "stream",
    "uniform",
    "model",
    "fresnel",
    "normals",
    "tone",
    "exposure",
    "scale",
    "paths",
    "resume",
    "shard",
    "general",
    "kernel",
    "file",
];

/// The BSDF of another program.
#[derive(Args)]
#[command(next_help_heading = SCENE)]
#[command(group = ArgGroup::new("program").args(["bsdf", "exec"]).conflicts_with_all(OF_RENDERER))]
pub struct ExternalArgs {
    /// Give the spheres the BSDF of a Python file
    ///
    /// Functions sample(wo, u), pdf(wo, wi) and value(wo, wi), as for `etalon validate FILE.py`. They are rendered beside the same
    /// BSDF by `value` alone, which shows what a fault of sample or pdf does, and beside the closest BSDF of this program, by default 128 pixels
    /// wide with 16 samples.
    #[arg(long, value_name = "FILE.py")]
    bsdf: Option<String>,
    /// Give the spheres the BSDF of the program that COMMAND starts
    #[arg(long, value_name = "COMMAND")]
    exec: Option<String>,
    /// Parameters of that BSDF [default: the values that it declares]
    #[arg(long, value_name = "NAME=VALUE,...", requires = "program", value_delimiter = ',', action = ArgAction::Set, value_parser = setting)]
    set: Vec<(String, f64)>,
    /// Time limit for each reply of the program
    #[arg(long, value_name = "SECONDS", default_value_t = REPLY_LIMIT, requires = "program")]
    timeout: f64,
}

impl ExternalArgs {
    /// Where the BSDF comes from, if one is given.
    pub fn source(&self) -> Option<ProgramSource<'_>> {
        let command = self.exec.as_deref().map(ProgramSource::Command);
        command.or(self.bsdf.as_deref().map(ProgramSource::File))
    }
}

impl Render {
    /// Renders the spheres of the scene with a program's BSDF, by its values alone, and with the closest model.
    pub fn appearance(&self, source: ProgramSource<'_>, global: &Global, console: &Console) -> Result<Verdict> {
        let program = source.bsdf(self.external.timeout)?;
        let values = families::values(&program, &self.external.set)?;
        let bsdf = program.with(&values)?;
        let Loaded { scene, request } = self.scene.load(console)?;
        let (scene, request) = if self.scene.has_size() {
            (scene, request)
        } else {
            let longer = request.width.max(request.height);
            let size = [request.width, request.height].map(|side| (side * LONGER_SIDE).div_ceil(longer));
            scene.resized(request, size)
        };
        let max_depth = self.max_depth.unwrap_or(request.max_depth);
        let request = Request { spp: self.spp.unwrap_or(SPP), max_depth, ..request };
        if request.spp < 2 {
            return Err(Error::parameter("spp", "noise is estimated from at least 2 samples per pixel"));
        }
        let target = global.target();
        let name = output::file_name(&format!("{}-{}", scene.name, program.name()));
        let stem = target.stem(&name, "", &["svg", "png", "pdf", "exr"])?;
        let other = |suffix: &str| target.file(&name, suffix, "exr");
        let [of_values, of_model] = [other("-values")?, other("-model")?];
        let style = self.style.style()?;
        let bar = console.progress(3 * u64::from(request.spp), "render", "samples");
        let found = appearance((program.name(), &*bsdf), &scene, &request, global.seed, &|| bar.inc(1))?;
        bar.finish_and_clear();
        let mut files = view::drawing(&found).write(&stem, &style)?;
        let metadata = Metadata::default().with("command", command_line()).with("seed", global.seed);
        let metadata = metadata.with("spp", request.spp).with(ERRORS_OF_SUMS[0], ERRORS_OF_SUMS[1]);
        for (Rendered { image, error }, path) in
            found.images.iter().zip([output::with_extension(&stem, "exr"), of_values, of_model])
        {
            let layers = [Layer { name: "", image }, Layer { name: "error", image: error }];
            write_exr(&path, &layers, Precision::Float, &metadata)?;
            files.push(path);
        }
        let tested = match source {
            ProgramSource::File(file) => file.to_owned(),
            ProgramSource::Command(command) => format!("--exec '{command}'"),
        };
        let test = format!("its samples, pdf and values themselves are tested by: etalon validate {tested}\n");
        console.saved(&found, &target.written(files), || view::text(&found) + &test);
        Ok(Verdict::Good)
    }
}
