//! The second report's own scene files, to use instead of the built-in scenes.

use crate::error::Result;
use crate::files;
use crate::import::{SceneOptions, collada};
use crate::scene::{Request, Scene};
use sha2::{Digest, Sha256};
use std::path::Path;

/// The scenes of one folder, at the report's size.
#[derive(Debug, Clone)]
pub struct Originals {
    pub spheres: (Scene, Request),
    pub dragon: (Scene, Request),
    pub bunny: (Scene, Request),
    /// Names of the files that are known by their checksums.
    pub recognised: Vec<&'static str>,
}

/// SHA-256 of the report's own files; the book's page on them lists these, too. Its dragon is not published: any other may stand in
/// its place.
const CHECKSUMS: [(&str, &str); 2] = [
    ("CBspheres.dae", "8611bc4cde82f2b75ed3d92ce385b541a41b23f8522b3590d01d1712db102429"),
    ("CBbunny_microfacet_cu.dae", "711089ea5bf08a7c79a1165d81068aeec8da2ef28f4ce30ef2f4a43a88d91760"),
];
/// Most bytes of a scene file.
const LIMIT: u64 = 1 << 30;

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
        let mut recognised = Vec::new();
        for (name, checksum) in CHECKSUMS {
            let bytes = files::read_bounded(&folder.join(name), LIMIT)?;
            let found: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
            recognised.extend((found == checksum).then_some(name));
        }
        Ok((Self { spheres, dragon, bunny, recognised }, warnings))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_book_has_the_checksums() {
        // A package has no book
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src/originals.md");
        let Ok(text) = std::fs::read_to_string(book) else { return };
        for (name, checksum) in CHECKSUMS {
            assert!(text.contains(&format!("{checksum}  {name}\n")), "{name}");
        }
    }
}
