//! Median cut of the environment map: `median-cut-2`, `-4`, `-16`, `-64` and `median-cut-radiance-64`.

use crate::figure::Drawing;
use crate::gallery::prelude::*;
use crate::view::map::Display;
use etalon_bench::median_cut::{self, Centroid, RegionRow};
use etalon_core::envmap::cut::{SideRule, Split};

/// Side of a light's marker in texels.
const MARKER: usize = 11;

/// Four partitions of the map, and the lights of the last one.
pub fn figures() -> Vec<Figure> {
    let partition = |id, title, n, reproduces, beside| Figure {
        id,
        title,
        report: Report::First,
        reproduces,
        shows: "Regions of equal energy, each halved along its longer side. A blue dot is the energy centroid of a region, the place of \
                its light; the report marks the median pixel instead.",
        matters: "A few lights in place of a map make a render without noise, whose error is a bias that no number of samples removes.",
        papers: &[papers::DEBEVEC],
        beside: Some(beside),
        command: Some(format!("etalon envmap cut {{map}} -n {n}")),
        ..Figure::by(move |inputs, studies| content(inputs, studies, n, Display::partition))
    };
    vec![
        partition(
            "median-cut-2",
            "Median cut of the map into 2 regions",
            2,
            "Figure 7, 1 cut: 2 regions of the Grace map",
            "median-cut-4",
        ),
        partition(
            "median-cut-4",
            "Median cut of the map into 4 regions",
            4,
            "Figure 8, 2 cuts: 4 regions of the Grace map",
            "median-cut-16",
        ),
        partition(
            "median-cut-16",
            "Median cut of the map into 16 regions",
            16,
            "Figure 9, 4 cuts: 16 regions of the Grace map",
            "median-cut-64",
        ),
        partition(
            "median-cut-64",
            "Median cut of the map into 64 regions",
            64,
            "Figure 10, 6 cuts: 64 regions of the Grace map",
            "median-cut-radiance-64",
        ),
        Figure {
            id: "median-cut-radiance-64",
            title: "The lights of 64 regions",
            report: Report::First,
            reproduces: "Figure 11, the 64 centroids with their RGB radiance",
            shows: "One light at each energy centroid, in the colour of its region's flux, on the map at two fifths of its brightness. The \
                    regions have nearly the same energy, so that their lights differ in colour more than in brightness.",
            matters: "These lights are the whole illumination of such a render: each casts a shadow with a hard edge.",
            papers: &[papers::DEBEVEC],
            beside: Some("median-cut-64"),
            command: Some("etalon envmap cut {map} -n 64".into()),
            ..Figure::by(|inputs, studies| content(inputs, studies, 64, |display, rows| display.lights(rows, MARKER)))
        },
    ]
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
