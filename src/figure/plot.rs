//! A plot: panels side by side or stacked, their frames aligned, with legends that cover no data.

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
#[must_use]
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
    pub fn new(panels: impl Into<Vec<Panel>>) -> Self {
        let panels = panels.into();
        let frame = if panels.len() > 1 { [350.0, 265.0] } else { [460.0, 310.0] };
        Self { panels, stacked: false, frame }
    }

    /// Panels above each other.
    pub fn stacked(panels: impl Into<Vec<Panel>>) -> Self {
        Self { panels: panels.into(), stacked: true, frame: [460.0, 220.0] }
    }

    /// Sets the size of each panel's frame in drawing units; at least 60 and at most 4000 a side.
    pub fn frame_size(self, width: f64, height: f64) -> Self {
        Self { frame: [width, height].map(|v| if v.is_nan() { 60.0 } else { v.clamp(60.0, 4000.0) }), ..self }
    }

    pub fn draw(&self) -> Drawing {
        let [width, height] = self.frame;
        let shared = self.shared_legend();
        let mut charts: Vec<Chart> =
            self.panels.iter().map(|panel| Chart::new(panel, width, height, shared.is_none())).collect();
        // Legends that found no free place inside their frame go below it
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
        // A legend that all panels share goes below them all
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

#[cfg(test)]
mod tests {
    use super::super::axis::Axis;
    use super::super::drawing::Item;
    use super::super::heatmap::{Heatmap, Shading};
    use super::super::shapes::{Point, Rect, Text};
    use super::super::{text, theme};
    use super::*;

    /// The box around a text's capitals and descenders.
    fn bounds(t: &Text) -> Rect {
        let along = t.start();
        let (top, height) = (t.drop() - t.size * text::CAP_HEIGHT, t.size * (text::CAP_HEIGHT + text::DESCENT));
        let [x, y] = t.at;
        if t.upwards {
            Rect::new(x + top, y - along - t.width(), height, t.width())
        } else {
            Rect::new(x + along, y + top, t.width(), height)
        }
    }

    fn texts(page: &Drawing) -> Vec<&Text> {
        page.items.iter().filter_map(|item| if let Item::Text(text) = item { Some(text) } else { None }).collect()
    }

    /// Nothing is cut off, and no text lies on another or on the data.
    fn assert_sound(page: &Drawing) {
        let sheet = Rect::new(0.0, 0.0, page.width, page.height);
        let boxes: Vec<(Rect, &str)> = texts(page).into_iter().map(|t| (bounds(t), t.markup.as_str())).collect();
        let overlap = |a: &Rect, b: &Rect| a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
        for (i, (a, what)) in boxes.iter().enumerate() {
            let inside = a.x >= 0.0 && a.y >= 0.0 && a.right() <= sheet.right() && a.bottom() <= sheet.bottom();
            assert!(inside, "{what:?} at {a:?} leaves the page {sheet:?}");
            for (b, other) in &boxes[..i] {
                assert!(!overlap(a, b), "{what:?} lies on {other:?}");
            }
        }
        for item in &page.items {
            let Item::Path { points, paint, .. } = item else { continue };
            if paint.stroke.is_some_and(|stroke| stroke.width == theme::LINE) {
                for pair in points.windows(2) {
                    for i in 0..=20 {
                        let at = [0, 1].map(|k| pair[0][k] + (pair[1][k] - pair[0][k]) * f64::from(i) / 20.0);
                        let dot = Rect::new(at[0], at[1], 1e-9, 1e-9);
                        assert!(boxes.iter().all(|(b, _)| !overlap(b, &dot)), "a curve crosses a text at {at:?}");
                    }
                }
            }
        }
    }

    fn wave(k: usize) -> Vec<Point> {
        let height = |x: f64| 0.5 + 0.48 * (x * (1.0 + 0.3 * k as f64) + k as f64).sin();
        (0..300).map(|i| f64::from(i) / 30.0).map(|x| [x, height(x)]).collect()
    }

    #[test]
    fn nothing_collides_however_crowded() {
        for curves in 1..=8 {
            let axes = (Axis::linear("time (s)"), Axis::linear("/{E}_{0} (10^{−3} W)").range(0.0, 1.0));
            let mut panel = Panel::new(axes.0, axes.1).title("A title that is wider than the narrow frame below it");
            for k in 0..curves {
                panel = panel.line(format!("series {k}"), theme::series(k), wave(k));
            }
            panel = panel.vertical(3.3, "first rule").vertical(3.5, "second").vertical(9.9, "/{θ}_{B} = 55.41°");
            panel = panel.horizontal(0.5, "half").horizontal(0.52, "a little more").note([5.0, 0.5], "slope −1/2");
            let other = Panel::new(Axis::log("/{n}"), Axis::linear("").range(-3e-7, 2e6));
            let other = other.dots("dots", theme::GREEN, [[1e-9, 1.0]]);
            let both = [panel.clone(), other];
            for plot in [Plot::new([panel]), Plot::new(both.clone()), Plot::stacked(both)] {
                assert_sound(&plot.draw());
                assert_sound(&plot.frame_size(150.0, 120.0).draw());
            }
        }
    }

    #[test]
    fn long_labels_fit_on_the_page() {
        let x = Axis::linear("an axis label far wider than its frame").range(0.0, 1e7);
        let y = Axis::linear("another one, higher than its frame").range(0.0, 3e-9);
        let panel = Panel::new(x, y).line("", theme::series(0), [[0.0, 0.0], [1e7, 3e-9]]);
        let panel = panel.vertical(5e6, "1").horizontal(1e-9, "h");
        assert_sound(&Plot::new([panel.clone()]).frame_size(130.0, 100.0).draw());
        assert_sound(&Plot::new([panel]).frame_size(700.0, 500.0).draw());
        // A label too long for any place is not lost.
        let endless = "long ".repeat(300);
        let panel = Panel::new(Axis::linear("").range(0.0, 1.0), Axis::linear("").range(0.0, 1.0));
        let panel = panel.vertical(0.5, endless.clone()).horizontal(0.5, endless.clone());
        let page = Plot::new([panel]).draw();
        assert_eq!(texts(&page).iter().filter(|t| t.markup == endless).count(), 2);
    }

    #[test]
    fn odd_data_are_drawn_somehow() {
        let odd = [f64::NAN, f64::INFINITY, -1e300, -1.0, 0.0, 5e-324, 1e-300, 1.0, 1e300, f64::MAX];
        for x in odd {
            for y in odd {
                for axis in [Axis::linear, Axis::log] {
                    let panel = Panel::new(axis("x"), axis("y"))
                        .line("a", theme::series(0), [[x, y], [y, x], [1.0, 2.0]])
                        .dots("b", theme::BLUE, [[x, y]])
                        .band("c", theme::BLUE, [[x, y, 1.0], [1.0, x, y], [2.0, 1.0, y]])
                        .bars("d", theme::BLUE, vec![x, y, 1.0], vec![y, x, 3.0])
                        .vertical(x, "v")
                        .horizontal(y, "h")
                        .note([x, y], "n");
                    let page = Plot::new([panel]).frame_size(100.0, 80.0).draw();
                    assert!(page.width < 2000.0 && page.height < 2000.0, "{x} {y}");
                }
            }
        }
        assert!(Plot::new([]).draw().png().is_ok());
    }

    #[test]
    fn panels_with_the_same_legend_share_it() {
        let panel = || Panel::new(Axis::linear("x"), Axis::linear("y")).line("only once", theme::series(0), wave(0));
        let count = |plot: Plot| texts(&plot.draw()).iter().filter(|t| t.markup == "only once").count();
        assert_eq!(count(Plot::new([panel(), panel()])), 1);
        assert_eq!(count(Plot::new([panel(), panel().line("more", theme::series(1), wave(1))])), 2);
    }

    #[test]
    fn heat_maps_stand_with_their_colour_bars() {
        let map = Heatmap::new(2, vec![1e-8, 2e-8, f64::NAN, 5e-8], Shading::Linear, "density (1/sr)");
        let panel = Panel::new(Axis::linear("/{φ} (°)").range(0.0, 360.0), Axis::linear("/{θ} (°)").range(180.0, 0.0));
        let panel = panel.title("Observed").heatmap(map);
        let page = Plot::new([panel.clone(), panel]).frame_size(200.0, 100.0).draw();
        assert_sound(&page);
        assert_eq!(page.items.iter().filter(|item| matches!(item, Item::Image { .. })).count(), 4);
    }
}
