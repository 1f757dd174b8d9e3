//! The metals as small multiples: reflectance, and the error of the second report's approximation.

use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use crate::study::metal::{ConductorCurves, ConductorRow};

/// One column for each metal: reflectance above, error of the approximation below, each row on one scale.
pub fn drawing(metals: &[ConductorCurves]) -> Drawing {
    let columns: Vec<Drawing> = metals.iter().enumerate().map(|(i, metal)| column(metal, i)).collect();
    let height = columns.iter().map(|column| column.height).fold(0.0, f64::max);
    let mut sheet = Drawing::new(0.0, height, 2.0);
    for column in columns {
        let x = sheet.width;
        sheet.width += column.width;
        sheet.append(column, x, 0.0);
    }
    sheet
}

fn column(metal: &ConductorCurves, place: usize) -> Drawing {
    // The first column names the axes, and its upper panel, where there is room, the colours.
    let of_first = |text: &'static str| if place == 0 { text } else { "" };
    let panel = |y: Axis, value: fn(&ConductorRow) -> f64, named: bool| {
        let angle = Axis::linear("/{θ} (degrees)").range(0.0, 90.0).every(30.0);
        metal.channels.iter().zip(theme::CHANNELS).fold(Panel::new(angle, y), |panel, (channel, colour)| {
            let points: Vec<Point> = channel.rows.iter().map(|r| [r.theta_deg, value(r)]).collect();
            let label = if named && place == 0 { channel.name.as_str() } else { "" };
            panel.line(label, Stroke::solid(colour, theme::LINE), points)
        })
    };
    let reflectance = Axis::linear(of_first("reflectance")).range(0.4, 1.0).every(0.2);
    let error = Axis::linear(of_first("approximate − exact")).range(0.0, 0.008).every(0.002);
    Plot::stacked([
        panel(reflectance, |r| r.r_unpolarized, true).title(metal.metal.clone()),
        panel(error, |r| r.r_unpolarized_approximate - r.r_unpolarized, false),
    ])
    .frame_size(150.0, 150.0)
    .draw()
}
