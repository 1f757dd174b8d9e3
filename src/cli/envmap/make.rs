//! `etalon envmap make`: a built-in map as a file.

use crate::cli::console::Console;
use crate::cli::global::{Global, Verdict, out};
use clap::Args;
use etalon_core::envmap::synthetic::Synthetic;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{self, Metadata, Precision, WriteOptions};
use etalon_figures::output;
use serde::Serialize;

/// Write a built-in map
#[derive(Args)]
#[command(after_long_help = "Example:\n  etalon envmap make nave -o envmaps")]
#[command(next_help_heading = "Map", args = [out()])]
pub struct Make {
    /// nave, sun, constant, onehot or black
    #[arg(help_heading = None::<&str>)]
    name: String,
}

impl Make {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        #[derive(Serialize)]
        struct Output {
            name: &'static str,
            width: usize,
            height: usize,
        }
        let Some(synthetic) = Synthetic::from_name(&self.name) else {
            let known: Vec<_> = Synthetic::ALL.iter().map(|s| format!("{} ({})", s.name(), s.description())).collect();
            return Err(Error::parameter("name", format!("there is no built-in map \"{}\"", self.name))
                .with_hint(format!("built-in maps: {}", known.join("; "))));
        };
        synthetic.request()?;
        let image = synthetic.make();
        interrupt::check()?;
        let target = global.target();
        let format = output::image_format(global.out.as_deref())?.unwrap_or("exr");
        let path = output::with_extension(&target.stem(synthetic.name(), "", &[format])?, format);
        let metadata = Metadata::default().with("map", synthetic.name());
        let options = WriteOptions { precision: Precision::Half, ..WriteOptions::default() };
        raster::write_with(&path, &image, &metadata, options)?;
        let written = target.written(vec![path]);
        let output = Output { name: synthetic.name(), width: image.width(), height: image.height() };
        console.saved(&output, &written, String::new);
        Ok(Verdict::Good)
    }
}
