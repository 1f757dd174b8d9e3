//! Loading the environment map that a command names, a built-in one or a file, with its zenith in row 0.

use super::console::Console;
use clap::Args;
use etalon_core::envmap::info::Info;
use etalon_core::envmap::synthetic::Synthetic;
use etalon_core::envmap::{EnvMap, Grace, NamedMap, check_range};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{self, ReadOptions};
use etalon_figures::view::text::counted;
use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

/// How a map file is to be understood.
#[derive(Args, Clone, Copy, Default)]
pub struct MapOptions {
    /// Turn the map upside-down: its file has the floor in row 0
    #[arg(long)]
    pub flip: bool,
    /// Leave the map as its file has it
    ///
    /// Without this and --flip, only the light probe of Grace Cathedral is turned, whose file has the floor in row 0.
    #[arg(long, conflicts_with = "flip")]
    pub no_flip: bool,
    /// Accept an 8-bit map (PNG, JPEG, TGA, PPM), whose lights are clipped
    #[arg(long)]
    pub ldr: bool,
}

impl MapOptions {
    /// Refuses the options where no map is read.
    pub fn check_unused(self) -> Result<()> {
        let options = [(self.flip, "flip"), (self.no_flip, "no_flip"), (self.ldr, "ldr")];
        match options.into_iter().find(|(given, _)| *given) {
            None => Ok(()),
            Some((_, name)) => {
                Err(Error::parameter(name, "no map is read").with_hint("it says how to read a map's file"))
            }
        }
    }
}

/// Reads a map and turns it if that is asked for, or if it is the file of the Grace Cathedral probe. A map that only seems to be
/// upside-down is not turned: a warning says why. A built-in name wins over a file of that name (which `./name` reaches).
pub fn load(map: &OsStr, options: MapOptions, console: &Console) -> Result<NamedMap> {
    let source = load_as_stored(map, options, console)?;
    if options.flip || options.no_flip {
        return Ok(source);
    }
    if Grace::of(source.map.image()) == Some(Grace::UpsideDown) {
        let name = &source.name;
        console.note(&format!("{name}: the Grace Cathedral probe, stored upside-down, is turned (not with --no-flip)"));
        return Ok(NamedMap { map: Arc::new(EnvMap::new(source.map.image().clone().flipped_vertically())), ..source });
    }
    if let Some(why) = Info::of(&source.map).upside_down() {
        console.warn(&format!(
            "{} is probably stored upside-down: {why}; --flip turns it, --no-flip says that it is right",
            source.name
        ));
    }
    Ok(source)
}

/// Reads a map as its file has it, for a scene that says how the map stands; only [`MapOptions::flip`] turns it.
pub fn load_as_stored(map: &OsStr, options: MapOptions, console: &Console) -> Result<NamedMap> {
    let (path, name) = (Path::new(map), map.to_string_lossy());
    let image = match map.to_str().and_then(Synthetic::from_name) {
        Some(synthetic) => {
            synthetic.request()?;
            synthetic.make()
        }
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

/// The name of a map without folders and extension, for the names of results.
pub fn short_name(map: &OsStr) -> String {
    Path::new(map).file_stem().map_or_else(|| "map".into(), |s| s.to_string_lossy().into_owned())
}
