//! `etalon scenes`: what can be rendered, and built-in scenes as files of other renderers.

use super::console::Console;
use super::global::{Global, Verdict};
use super::map_file::MapOptions;
use super::scene_file::SceneArgs;
use crate::error::{Error, Result};
use crate::export;
use crate::import::SCENE_EXTENSIONS;
use crate::output::Written;
use crate::scene::builtin;
use clap::Args;
use serde::Serialize;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// List the built-in scenes, or write one as a file of pbrt-v4 or Mitsuba 3
#[derive(Args)]
pub struct Scenes {
    /// Write the scene NAME as NAME.pbrt (pbrt-v4) or NAME.xml (Mitsuba 3), its meshes and its map beside it; a folder may stand
    /// before NAME
    #[arg(long, value_name = "NAME.{pbrt,xml}")]
    export: Option<PathBuf>,
    /// The environment map of the exported scene: a file or a built-in name
    #[arg(long, value_name = "MAP", requires = "export")]
    envmap: Option<OsString>,
    #[command(flatten)]
    map_options: MapOptions,
}

#[derive(Serialize)]
struct Entry {
    name: String,
    description: String,
}

#[derive(Serialize)]
struct Output {
    scenes: Vec<Entry>,
    /// Extensions of the scene files that are read.
    files: [&'static str; 2],
}

/// An exported scene.
#[derive(Serialize)]
struct Export {
    #[serde(flatten)]
    written: Written,
    /// Where the other renderer's image has another expectation.
    notes: Vec<String>,
}

impl Scenes {
    pub fn run(&self, _global: &Global, console: &Console) -> Result<Verdict> {
        match &self.export {
            Some(path) => self.write(path, console),
            None => Self::list(console),
        }
    }

    fn write(&self, path: &Path, console: &Console) -> Result<Verdict> {
        let name = path.file_stem().unwrap_or_default().to_owned();
        if builtin::find(&name.to_string_lossy()).is_none() {
            let known: Vec<String> = builtin::scenes().into_iter().map(|scene| scene.name).collect();
            let message = format!("\"{}\" is no built-in scene", name.to_string_lossy());
            return Err(Error::parameter("export", message).with_hint(format!("built-in scenes: {}", known.join(", "))));
        }
        let loaded = SceneArgs::built_in(name, self.envmap.clone(), self.map_options).load(console)?;
        let exported = export::write(path, &loaded.scene, &loaded.request)?;
        exported.notes.iter().for_each(|note| console.warn(note));
        let written = Written { files: exported.files, replaced: Vec::new() };
        let output = Export { written, notes: exported.notes };
        console.result(&output, || output.written.text());
        Ok(Verdict::Good)
    }

    fn list(console: &Console) -> Result<Verdict> {
        let scenes =
            builtin::scenes().into_iter().map(|scene| Entry { name: scene.name, description: scene.doc }).collect();
        let output = Output { scenes, files: SCENE_EXTENSIONS };
        console.result(&output, || {
            let lines = output.scenes.iter().map(|scene| format!("{:<18} {}\n", scene.name, scene.description));
            lines.chain(["scene files work, too: pbrt (.pbrt) and COLLADA (.dae)".to_owned()]).collect()
        });
        Ok(Verdict::Good)
    }
}
