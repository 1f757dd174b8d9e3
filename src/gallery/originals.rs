//! The second report's own scene files, to use instead of the built-in scenes.

use crate::error::Result;
use crate::import::{SceneOptions, collada};
use crate::scene::{Request, Scene};
use std::path::Path;

/// The scenes of one folder, at the report's size.
#[derive(Debug, Clone)]
pub struct Originals {
    pub spheres: (Scene, Request),
    pub dragon: (Scene, Request),
    pub bunny: (Scene, Request),
}

/// Width and height of the report's images.
pub const SIZE: [usize; 2] = [480, 360];

impl Originals {
    /// Reads `CBspheres.dae`, `CBdragon_microfacet_au.dae` and `CBbunny_microfacet_cu.dae`; also returns the readers'
    /// warnings.
    pub fn read(folder: &Path) -> Result<(Self, Vec<String>)> {
        let mut warnings = Vec::new();
        let mut scene = |name: &str| -> Result<(Scene, Request)> {
            let options = SceneOptions { resolution: Some(SIZE), ..SceneOptions::default() };
            let imported = collada::read(&folder.join(name), &options)?;
            warnings.extend(imported.warnings);
            Ok((imported.scene, imported.request))
        };
        let spheres = scene("CBspheres.dae")?;
        let dragon = scene("CBdragon_microfacet_au.dae")?;
        let bunny = scene("CBbunny_microfacet_cu.dae")?;
        Ok((Self { spheres, dragon, bunny }, warnings))
    }
}
