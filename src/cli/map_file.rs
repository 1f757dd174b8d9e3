//! Loading the environment map that a command names: a built-in one or a file.

use super::console::Console;
use crate::envmap::NamedMap;
use crate::envmap::info::Info;
use crate::envmap::synthetic::Synthetic;
use crate::envmap::{EnvMap, check_range};
use crate::error::{Error, Result};
use crate::interrupt;
use crate::raster::{self, ReadOptions};
use crate::view::text::counted;
use clap::Args;
use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

/// How a map file is to be understood.
#[derive(Args, Clone, Copy, Default)]
pub struct MapOptions {
    /// Turn the map upside-down: its file has the floor in row 0
    #[arg(long)]
    pub flip: bool,
    /// Accept an 8-bit map (PNG, JPEG, TGA, PPM), whose lights are clipped
    #[arg(long)]
    pub ldr: bool,
}

impl MapOptions {
    /// Refuses the options where no map is read.
    pub fn check_unused(self) -> Result<()> {
        match [(self.flip, "flip"), (self.ldr, "ldr")].into_iter().find(|(given, _)| *given) {
            None => Ok(()),
            Some((_, name)) => {
                Err(Error::parameter(name, "no map is read").with_hint("it says how to read a map's file"))
            }
        }
    }
}

/// Reads a map. A built-in name wins over a file of that name (which `./name` reaches).
pub fn load(map: &OsStr, options: MapOptions, console: &Console) -> Result<NamedMap> {
    let (path, name) = (Path::new(map), map.to_string_lossy());
    let image = match map.to_str().and_then(Synthetic::from_name) {
        Some(synthetic) => synthetic.make(),
        None if !path.exists() && path.extension().is_none() => {
            let known: Vec<_> = Synthetic::ALL.iter().map(|s| s.name()).collect();
            return Err(Error::parameter("map", format!("there is no file and no built-in map \"{name}\""))
                .with_hint(format!("built-in maps: {}", known.join(", "))));
        }
        None => {
            let (image, notes) =
                raster::read_lat_long(path, ReadOptions { allow_ldr: options.ldr, ..ReadOptions::default() })?;
            notes.iter().for_each(|note| console.warn(note));
            check_range(path, &image)?;
            image
        }
    };
    let map = EnvMap::new(if options.flip { image.flipped_vertically() } else { image });
    interrupt::check()?;
    let found = map.found();
    if found.nonfinite + found.negative > 0 {
        console.warn(&format!(
            "{name}: {} with NaN or infinite values and {} with negative values; such values count as 0",
            counted(found.nonfinite, "texel"),
            found.negative
        ));
    }
    Ok(NamedMap { map: Arc::new(map), name: name.into_owned() })
}

/// Warns about a map that is known to be stored upside-down.
pub fn warn_upside_down(source: &NamedMap, console: &Console) -> Info {
    let info = Info::of(&source.map);
    if let Some(why) = info.upside_down() {
        console.warn(&format!("{} is probably stored upside-down: {why}; --flip turns it", source.name));
    }
    info
}

/// The name of a map without folders and extension, for the names of results.
pub fn short_name(map: &OsStr) -> String {
    Path::new(map).file_stem().map_or_else(|| "map".into(), |s| s.to_string_lossy().into_owned())
}
