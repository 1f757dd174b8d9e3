//! Drawing of the cost against the number of lights, spheres and triangles.

use crate::figure::{Axis, Drawing, Panel, Plot, theme};
use crate::study::scaling::{Cost, Many};

/// Time per camera sample, and time to prepare, over the number of primitives.
pub fn drawing(costs: &[Cost]) -> Drawing {
    let panel = |title: &str, label: &str, value: fn(&Cost) -> f64| {
        let panel = Panel::new(Axis::log("number of primitives"), Axis::log(label)).title(title);
        Many::ALL.into_iter().enumerate().fold(panel, |panel, (i, many)| {
            let of = costs.iter().filter(|cost| cost.many == many);
            panel.dotted_line(many.name(), theme::series(i), of.map(|c| [c.count as f64, value(c)]).collect::<Vec<_>>())
        })
    };
    Plot::new([
        panel("Cost of a camera sample", "processor time (µs per sample)", |cost| cost.microseconds_per_sample),
        panel("Cost of the preparation", "processor time (s)", |cost| cost.preparation_seconds),
    ])
    .draw()
}
