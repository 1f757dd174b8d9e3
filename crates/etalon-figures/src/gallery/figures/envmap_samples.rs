//! Importance samples of the environment map: `envmap-samples-64`, `-256`, `-1024` and `-only-256`.

use crate::figure::Drawing;
use crate::gallery::prelude::*;
use crate::view::map::Display;
use etalon_bench::map_samples::{self, SampleRow};
use etalon_core::envmap::samplers::TexelSampler;
use glam::DVec3;

/// Side of a marker in texels, as in the report.
const MARKER: usize = 5;

/// Three numbers of samples on the map, and one without the map.
pub fn figures() -> Vec<Figure> {
    let on_the_map = |id, title, n, reproduces, beside| Figure {
        id,
        title,
        report: Report::First,
        reproduces,
        shows: "A blue marker at each direction, sampled in proportion to the radiance from there. Samples \
                that one marker would cover share one of as many times its area; the inset enlarges the place with most of \
                them. The map is shown 1.5 stops darker than usual, so that lights keep their colours.",
        matters: "Samples where the light is are what makes an environment map with a sun renderable: uniform directions would hardly ever find it.",
        papers: &[papers::PBRT],
        beside: Some(beside),
        command: Some(format!("etalon envmap sample {{map}} -n {n}")),
        ..Figure::by(move |inputs, studies| content(inputs, studies, n, Display::samples))
    };
    vec![
        on_the_map(
            "envmap-samples-64",
            "64 importance samples of the map",
            64,
            "Figure 3, 64 samples of the Grace map of 1024×512, 5×5 markers",
            "envmap-samples-256",
        ),
        on_the_map(
            "envmap-samples-256",
            "256 importance samples of the map",
            256,
            "Figure 4, 256 samples of the Grace map of 1024×512, 5×5 markers",
            "median-cut-64",
        ),
        on_the_map(
            "envmap-samples-1024",
            "1024 importance samples of the map",
            1024,
            "Figure 5, 1024 samples of the Grace map of 1024×512, 5×5 markers",
            "envmap-samples-256",
        ),
        Figure {
            id: "envmap-samples-only-256",
            title: "256 samples alone, in the colour of their radiance",
            report: Report::First,
            reproduces: "Figure 6, 256 samples alone with the RGB of the map",
            shows: "The 256 samples of `envmap-samples-256` without the map: each marker has the radiance of its direction.",
            matters: "The samples alone are all that an estimator knows of the map: here are its brightest windows, and next to nothing else.",
            papers: &[papers::PBRT],
            beside: Some("envmap-samples-256"),
            command: Some("etalon envmap sample {map} -n 256".into()),
            ..Figure::by(|inputs, studies| content(inputs, studies, 256, Display::samples_only))
        },
    ]
}

fn content(
    inputs: &Inputs,
    studies: &mut Studies,
    n: usize,
    draw: impl Fn(&Display, &[SampleRow], usize) -> Drawing,
) -> Result<Content> {
    let map = &inputs.map.map;
    let result = map_samples::draw(map, &TexelSampler::new(map.clone()), DVec3::Y, n, inputs.seed)?;
    let flux = studies.map_info(inputs)?.flux_rgb.iter().sum::<f64>() / 3.0;
    let checks = vec![
        Check::equal("pdfs that differ from pdf(direction)", 0.0, result.pdf_mismatches as f64),
        // The pdf is proportional to radiance, so that the estimator has no variance.
        Check::within("flux estimated from the samples", flux, result.flux_estimate, 1e-6 * flux),
    ];
    Content::new(draw(&*studies.map_display(inputs)?, &result.rows, MARKER), &result.rows, checks)
}
