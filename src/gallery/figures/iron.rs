//! The statue in iron: `iron`.

use super::roughness::{self, Statue};
use crate::gallery::prelude::*;

/// One figure.
pub fn figures() -> Vec<Figure> {
    vec![Figure {
        id: "iron",
        title: "Iron statue",
        report: Report::Second,
        reproduces: "Figure 4, iron",
        shows: "The same statue in iron: all colours are reflected nearly alike.",
        beside: Some("roughness-0.5"),
        command: Some("etalon render cornell-statue-fe -s 128 -l 1 -m 5 --tone report".into()),
        make: Box::new(content),
    }]
}

fn content(inputs: &Inputs, studies: &mut Studies) -> Result<Content> {
    let statue = Statue::new("Fe", 0.5);
    let mut content = roughness::content(inputs, studies, statue, "iron")?;
    // Grey: no channel differs from the mean of all by more than a fifth.
    let radiance = studies.get(statue, inputs)?.statue;
    let colour = radiance.value.map(|v| (v / radiance.intensity() - 1.0).abs());
    let largest = colour.into_iter().fold(0.0, f64::max);
    content.checks.push(Check::at_most("largest relative difference of a channel from grey", largest, 0.2));
    Ok(content)
}
