//! What several figures need of the run's environment map, computed once: its statistics, and the map to draw on.

use super::inputs::Inputs;
use super::studies::Study;
use crate::envmap::info::Info;
use crate::error::Result;
use crate::view::map::{Display, Look};

/// The statistics of the map.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct MapInfo;

impl Study for MapInfo {
    type Output = Info;

    fn run(self, inputs: &Inputs) -> Result<Info> {
        Ok(Info::of(&inputs.map.map))
    }
}

/// The map, tone-mapped.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct MapDisplay;

impl Study for MapDisplay {
    type Output = Display;

    fn run(self, inputs: &Inputs) -> Result<Display> {
        Ok(Display::new(&inputs.map.map, Look::default()))
    }
}
