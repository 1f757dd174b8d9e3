//! Indices, special angles and albedo of the metals: `metals-table`.

use super::roughness::{iron_of_the_report, printed_iron};
use crate::gallery::prelude::*;
use crate::study::metal;
use crate::view::metals as view;

const POINTS: usize = 181;

pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "metals-table",
        title: "Metals: indices, special angles, albedo, error of the approximation",
        report: Report::Second,
        reproduces: "Table 1, η and k of iron at 614, 549 and 466 nm: 2.8851 + 3.0449i, 2.9500 + 2.9300i, 2.6500 + 2.8095i",
        shows: "Reflectance of each metal in red, green and blue over the angle of incidence, and how far the report's \
                approximation (without sin²θ beside η² + k²) lies above it. The sources of η and k stand in the CSV file.",
        matters: "The colour of a metal is its reflectance, so that an error of these curves is an error of colour in every image of it.",
        papers: &[papers::JOHNSON_CHRISTY, papers::PBRT],
        ..Figure::by(|_, _| content())
    }]
}

fn content() -> Result<Content> {
    let table = metal::table(POINTS)?;
    let mut checks = iron_of_the_report();
    checks.extend([
        Check::at_most("error of R(0°) against ((η−1)²+k²)/((η+1)²+k²)", table.normal_error(), 1e-14),
        Check::at_most(
            "error of the approximation's albedo against its closed form",
            table.approximate_albedo_error(),
            1e-9,
        ),
        Check::at_most("largest error of the approximation", table.approximation_error(), 8e-3),
        Check::at_most("largest relative error of its albedo", table.albedo_error(), 6e-3),
    ]);
    Ok(Content::new(view::drawing(&table), &table.rows, checks)?.with_printed(printed_iron()))
}
