//! `etalon scenes`: what can be rendered.

use super::console::Console;
use super::global::{Global, Verdict};
use crate::error::Result;
use crate::import::SCENE_EXTENSIONS;
use crate::scene::builtin;
use clap::Args;
use serde::Serialize;

/// List the built-in scenes
#[derive(Args)]
pub struct Scenes {}

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

impl Scenes {
    pub fn run(&self, _global: &Global, console: &Console) -> Result<Verdict> {
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
