//! `etalon merge`: parts of a render as one image.

use super::console::Console;
use super::flags::command_line;
use super::global::{Global, Verdict, out, threads};
use super::render::warn_of_lost_light;
use clap::Args;
use etalon_core::error::{Error, Result};
use etalon_core::raster::{self, Metadata};
use etalon_figures::output;
use etalon_figures::view::text::counted;
use etalon_render::film::{Dropped, list, merge_files};
use serde::Serialize;
use std::ops::Range;
use std::path::PathBuf;

/// Merge parts of a render
#[derive(Args)]
#[command(
    after_long_help = "Writes the image as EXR and PNG. Sums are exact: the merged image is, bit for bit, that of \
                        an undivided render, for any order of the parts. While samples are missing, the EXR file \
                        has the sums and can itself be merged.\n\nExample:\n  etalon render furnace -s 2 --shard 1/2 -o a.exr && etalon render furnace -s 2 --shard 2/2 -o b.exr \
                        && etalon merge a.exr b.exr -o image.exr"
)]
#[command(next_help_heading = "Parts", args = [out(), threads()])]
pub struct Merge {
    /// Files with different samples of the same image
    #[arg(required = true, help_heading = None::<&str>)]
    parts: Vec<PathBuf>,
}

#[derive(Serialize)]
struct Output {
    parts: usize,
    width: usize,
    height: usize,
    /// Samples that every pixel has.
    samples: u32,
    /// Samples of the whole render.
    of: u32,
    complete: bool,
    missing: Vec<Range<u32>>,
    dropped: Dropped,
}

impl Merge {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        if output::image_format(global.out.as_deref())?.is_some_and(|format| format != "exr") {
            return Err(Error::parameter("out", "parts are merged into an OpenEXR file")
                .with_hint("name a file with the extension .exr, or a folder"));
        }
        let target = global.target();
        let stem = target.stem("merged", "", &FORMATS)?;
        let bar = console.busy("merge");
        let mut part = merge_files(&self.parts)?;
        bar.finish_and_clear();
        part.metadata = with_command(&part.metadata);
        let files = FORMATS.map(|format| output::with_extension(&stem, format));
        part.write(&files[0])?;
        raster::write(&files[1], &part.film.image(), &part.metadata)?;

        warn_of_lost_light(&part.film, console);
        let ranges = part.ranges();
        let output = Output {
            parts: self.parts.len(),
            width: part.film.width(),
            height: part.film.height(),
            samples: ranges.samples(),
            of: ranges.spp(),
            complete: ranges.is_complete(),
            missing: ranges.missing(),
            dropped: part.film.dropped(),
        };
        if !output.complete {
            let missing = list(&output.missing);
            console.warn(&format!("samples {missing} of {} are missing; the file has the sums", output.of));
        }
        console.saved(&output, &target.written(files.into()), || {
            format!(
                "{}, {}x{}, {} of {} per pixel\n",
                counted(output.parts, "part"),
                output.width,
                output.height,
                output.samples,
                counted(output.of as usize, "sample")
            )
        });
        Ok(Verdict::Good)
    }
}

const FORMATS: [&str; 2] = ["exr", "png"];

/// The metadata with this command in place of the one that made the parts.
fn with_command(metadata: &Metadata) -> Metadata {
    let others = metadata.entries().iter().filter(|(name, _)| name != "command");
    others.fold(Metadata::default().with("command", command_line()), |all, (name, value)| all.with(name, value))
}
