//! The table of metals as small multiples: reflectance, and the error of the second report's approximation.

use crate::figure::{Axis, Colour, Drawing, Panel, Plot, Point, Stroke, theme};
use crate::study::metal::{Curves, Row};

/// Colours of the three channels.
const CHANNELS: [(&str, Colour); 3] = [("614 nm", theme::VERMILION), ("549 nm", theme::GREEN), ("466 nm", theme::BLUE)];

/// One column for each metal: reflectance above, error of the approximation below, each row on one scale.
#[must_use]
pub fn drawing(metals: &[Curves]) -> Drawing {
    let angle = || Axis::linear("/{θ} (degrees)").range(0.0, 90.0).every(30.0);
    let row = |y: &dyn Fn() -> Axis, value: fn(&Row) -> f64, titled: bool| {
        let panels: Vec<Panel> = metals
            .iter()
            .map(|metal| {
                let mut panel = Panel::new(angle(), y());
                if titled {
                    panel = panel.title(metal.metal.clone());
                }
                metal.channels.iter().zip(CHANNELS).fold(panel, |panel, (channel, (name, colour))| {
                    let points: Vec<Point> = channel.rows.iter().map(|r| [r.theta_deg, value(r)]).collect();
                    panel.line(name, Stroke { colour, width: theme::LINE, dash: theme::SOLID }, points)
                })
            })
            .collect();
        Plot::new(panels).frame_size(150.0, 150.0).draw()
    };
    let reflectance = row(&|| Axis::linear("reflectance").range(0.4, 1.0), |r| r.r_unpolarized, true);
    let errors = row(
        &|| Axis::linear("approximate − exact").range(-0.004, 0.008),
        |r| r.r_unpolarized_approximate - r.r_unpolarized,
        false,
    );
    let mut sheet = Drawing::new(reflectance.width().max(errors.width()), reflectance.height() + errors.height(), 2.0);
    let below = reflectance.height();
    sheet.append(reflectance, 0.0, 0.0);
    sheet.append(errors, 0.0, below);
    sheet
}
