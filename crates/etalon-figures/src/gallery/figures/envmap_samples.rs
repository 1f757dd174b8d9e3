//! Importance samples of the environment map: `envmap-samples-64`, `-256`, `-1024` and `-only-256`.

use crate::figure::Drawing;
use crate::gallery::prelude::*;
use crate::view::map::Display;
use etalon_bench::map_samples::{self, SampleRow};
use etalon_core::envmap::samplers::TexelSampler;
use glam::DVec3;

/// Side of a marker in texels, as in the report.
const MARKER: usize = 5;

pub fn figures() -> Vec<Maker> {
    let on_the_map = |n: usize| {
        maker(format!("envmap-samples-{n}"), move |inputs, studies| content(inputs, studies, n, Display::samples))
    };
    let alone =
        maker("envmap-samples-only-256", |inputs, studies| content(inputs, studies, 256, Display::samples_only));
    [64, 256, 1024].map(on_the_map).into_iter().chain([alone]).collect()
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
