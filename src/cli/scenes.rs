//! `etalon scenes`: what can be rendered, and built-in scenes as files of other renderers.

use super::console::Console;
use super::global::{Global, Verdict};
use super::map_file::MapOptions;
use super::scene_file::{SceneArgs, accepted};
use clap::Args;
use etalon_bench::table::Table;
use etalon_core::envmap::EnvMap;
use etalon_core::error::{Error, Result};
use etalon_core::export;
use etalon_core::import::SCENE_EXTENSIONS;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::scene::Environment;
use etalon_core::scene::builtin::{self, BuiltIn};
use etalon_figures::output::Written;
use etalon_figures::view::text::{LINE, wrapped};
use serde::Serialize;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// List the built-in scenes, or write one as a file of pbrt-v4 or Mitsuba 3
#[derive(Args)]
#[command(next_help_heading = "Export")]
pub struct Scenes {
    /// Write the scene NAME as a file of pbrt-v4 or Mitsuba 3
    ///
    /// As NAME.pbrt or NAME.xml, its meshes and its map beside it; a folder may stand before NAME.
    #[arg(long, value_name = "NAME.{pbrt,xml}")]
    export: Option<PathBuf>,
    /// Environment map of the exported scene, a file or a built-in name [default: nave]
    #[arg(long, value_name = "MAP", requires = "export")]
    envmap: Option<OsString>,
    #[command(flatten)]
    map_options: MapOptions,
}

#[derive(Serialize)]
struct Entry {
    name: String,
    description: String,
    width: usize,
    height: usize,
    spp: u32,
    light_samples: u32,
    max_depth: u32,
    /// What it multiplies the radiance of its environment map by.
    map_scale: Option<f32>,
    /// Options of `render` that change it and that other scenes may refuse.
    options: Vec<&'static str>,
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
            None => {
                self.map_options.check_unused()?;
                Self::list(console)
            }
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
        let entry = |built_in: BuiltIn| -> Result<Entry> {
            let map = Arc::new(EnvMap::new(Image::from_fn(4, 2, |_, _| Rgb::ONE)));
            let environment = built_in.map_scale().map(|scale| Environment::upright(map, "constant", scale));
            let (scene, request) = built_in.make(environment, None)?;
            Ok(Entry {
                options: accepted(&built_in, &scene),
                map_scale: built_in.map_scale(),
                name: built_in.name,
                description: built_in.doc,
                width: request.width,
                height: request.height,
                spp: request.spp,
                light_samples: request.light_samples,
                max_depth: request.max_depth,
            })
        };
        let scenes = builtin::scenes().into_iter().map(entry).collect::<Result<_>>()?;
        let output = Output { scenes, files: SCENE_EXTENSIONS };
        console.result(&output, || {
            let scenes = Table::of(&output.scenes)
                .words("scene", |scene| &scene.name)
                .words("size", |scene| format!("{}x{}", scene.width, scene.height))
                .numbers("-s", |scene| scene.spp)
                .numbers("-l", |scene| scene.light_samples)
                .numbers("-m", |scene| scene.max_depth);
            let options = |scene: &Entry| match scene.options.join(" ") {
                none if none.is_empty() => none,
                options => wrapped(&format!("options: {options}"), "    ", LINE),
            };
            let map = |scene: &Entry| match scene.map_scale {
                Some(scale) => format!("    the radiance of its map is multiplied by {scale}\n"),
                None => String::new(),
            };
            let told = |scene: &Entry| wrapped(&scene.description, "    ", LINE) + &map(scene) + &options(scene);
            scenes.text_with(|scene, line| line + &told(scene))
                + "render also takes scene files: pbrt (.pbrt) and COLLADA (.dae)\n"
        });
        Ok(Verdict::Good)
    }
}

#[cfg(test)]
mod tests {
    use etalon_core::scene::builtin;

    #[test]
    fn the_book_says_what_scenes_multiply_their_maps_by() {
        assert!(include_str!("../../docs/src/render.md").contains(&builtin::map_scales()), "{}", builtin::map_scales());
    }
}
