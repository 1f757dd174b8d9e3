//! `etalon scenes`: what can be rendered.

use super::console::Console;
use super::{Global, Verdict};
use crate::error::Result;
use crate::import::SCENE_EXTENSIONS;
use crate::scene::builtin::SCENES;
use clap::Args;
use serde::Serialize;

/// List the built-in scenes
#[derive(Args)]
pub struct Scenes {}

#[derive(Serialize)]
struct Entry {
    name: &'static str,
    description: &'static str,
}

#[derive(Serialize)]
struct Output {
    scenes: Vec<Entry>,
    /// Extensions of the scene files that are read.
    files: [&'static str; 2],
}

impl Scenes {
    pub fn run(&self, _global: &Global, console: &Console) -> Result<Verdict> {
        let scenes = SCENES.into_iter().map(|(name, description)| Entry { name, description }).collect();
        let output = Output { scenes, files: SCENE_EXTENSIONS };
        console.result(&output, || {
            let lines = output.scenes.iter().map(|scene| format!("{:<18} {}\n", scene.name, scene.description));
            lines.chain(["scene files work, too: pbrt (.pbrt) and COLLADA (.dae)".to_owned()]).collect()
        });
        Ok(Verdict::Good)
    }
}
