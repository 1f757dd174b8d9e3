//! A plot: panels side by side or stacked, their frames aligned, with legends that hide nothing.

use super::chart::Chart;
use super::drawing::Drawing;
use super::frame::Sides;
use super::legend::Legend;
use super::panel::Panel;

/// Panels that make up one figure.
///
/// Every panel's legend goes into a corner that is free of data, or else below the panel. Panels with the same legend
/// share one, below all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    panels: Vec<Panel>,
    stacked: bool,
    frame: [f64; 2],
}

/// Space at the page's edge, and between panels.
const EDGE: f64 = 10.0;
const BETWEEN: f64 = 18.0;
/// From what stands below a frame to a legend below it.
const LEGEND_GAP: f64 = 6.0;
/// PNG pixels per unit.
const SCALE: f64 = 2.0;

impl Plot {
    /// Panels side by side.
    #[must_use]
    pub fn new(panels: impl Into<Vec<Panel>>) -> Self {
        let panels = panels.into();
        let frame = if panels.len() > 1 { [350.0, 265.0] } else { [460.0, 310.0] };
        Self { panels, stacked: false, frame }
    }

    /// Panels above each other.
    #[must_use]
    pub fn stacked(panels: impl Into<Vec<Panel>>) -> Self {
        Self { panels: panels.into(), stacked: true, frame: [460.0, 220.0] }
    }

    /// Sets the size of each panel's frame in drawing units; at least 60 and at most 4000 a side.
    #[must_use]
    pub fn frame_size(self, width: f64, height: f64) -> Self {
        Self { frame: [width, height].map(|v| if v.is_nan() { 60.0 } else { v.clamp(60.0, 4000.0) }), ..self }
    }

    /// Lays out and draws all panels.
    #[must_use]
    pub fn draw(&self) -> Drawing {
        let [width, height] = self.frame;
        let shared = self.shared_legend();
        let mut charts: Vec<Chart> =
            self.panels.iter().map(|panel| Chart::new(panel, width, height, shared.is_none())).collect();
        for chart in &mut charts {
            if let Some(legend) = chart.legend.take() {
                let columns = legend.columns_within(width + 0.5 * chart.room.left);
                let [w, h] = legend.size(columns);
                let x = (width - w) / 2.0;
                legend.draw(&mut chart.drawing, [x, height + chart.room.bottom + LEGEND_GAP], columns);
                let overhang = (w - width) / 2.0;
                let below =
                    Sides { left: overhang, right: overhang, bottom: chart.room.bottom + LEGEND_GAP + h, top: 0.0 };
                chart.room = chart.room.union(below);
            }
        }
        // Frames line up: beside each other they share what is above and below, stacked what is left and right.
        let common = charts.iter().fold(Sides::default(), |sides, chart| sides.union(chart.room));
        let mut places = Vec::with_capacity(charts.len());
        let [mut x, mut y] = [EDGE, EDGE];
        for chart in &charts {
            let room = if self.stacked {
                Sides { left: common.left, right: common.right, ..chart.room }
            } else {
                Sides { top: common.top, bottom: common.bottom, ..chart.room }
            };
            places.push([(x + room.left).round(), (y + room.top).round()]);
            if self.stacked {
                y += (room.top + height + room.bottom + BETWEEN).ceil();
            } else {
                x += (room.left + width + room.right + BETWEEN).ceil();
            }
        }
        let (page_width, mut page_height) = if self.stacked {
            (EDGE + common.left + width + common.right + EDGE, y - BETWEEN + EDGE)
        } else {
            (x - BETWEEN + EDGE, EDGE + common.top + height + common.bottom + EDGE)
        };
        let legend = shared.map(|legend| {
            let columns = legend.columns_within(page_width - 2.0 * EDGE);
            let [w, h] = legend.size(columns);
            let at = [(page_width - w) / 2.0, page_height - EDGE + LEGEND_GAP];
            page_height += LEGEND_GAP + h;
            (legend, at, columns)
        });
        let mut page = Drawing::new(page_width.max(2.0 * EDGE).ceil(), page_height.max(2.0 * EDGE).ceil(), SCALE);
        for (chart, [x, y]) in charts.into_iter().zip(places) {
            page.append(chart.drawing, x, y);
        }
        if let Some((legend, at, columns)) = legend {
            legend.draw(&mut page, at, columns);
        }
        page
    }

    /// The legend of all panels, if there are several and all have the same.
    fn shared_legend(&self) -> Option<Legend> {
        let mut legends = self.panels.iter().map(|panel| Legend::new(&panel.marks));
        let first = legends.next()??;
        (self.panels.len() > 1 && legends.all(|legend| legend.as_ref() == Some(&first))).then_some(first)
    }
}
