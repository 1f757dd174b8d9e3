//! Median cut of the environment map: `median-cut-2`, `-4`, `-16`, `-64` and `median-cut-radiance-64`.

use crate::figure::Drawing;
use crate::gallery::prelude::*;
use crate::view::map::Display;
use etalon_bench::median_cut::{self, Centroid, RegionRow};
use etalon_core::envmap::cut::{SideRule, Split};

/// Side of a light's marker in texels.
const MARKER: usize = 11;

pub fn figures() -> Vec<Maker> {
    let partition = |n: usize| {
        maker(format!("median-cut-{n}"), move |inputs, studies| content(inputs, studies, n, Display::partition))
    };
    let lights = maker("median-cut-radiance-64", |inputs, studies| {
        content(inputs, studies, 64, |display, rows| display.lights(rows, MARKER))
    });
    [2, 4, 16, 64].map(partition).into_iter().chain([lights]).collect()
}

fn content(
    inputs: &Inputs,
    studies: &mut Studies,
    n: usize,
    draw: impl Fn(&Display, &[RegionRow]) -> Drawing,
) -> Result<Content> {
    let map = &inputs.map.map;
    let rows = median_cut::cut(map, &[n], Split::Energy, SideRule::default(), Centroid::Energy)?.remove(0);
    let error = median_cut::flux_error(&rows, studies.map_info(inputs)?.flux_rgb);
    let checks = vec![Check::at_most("relative error of the regions' total flux", error, 1e-9)];
    Content::new(draw(&*studies.map_display(inputs)?, &rows), &rows, checks)
}
