//! Legends: a sample of each mark beside its label.

use super::drawing::Drawing;
use super::panel::Mark;
use super::shapes::{Anchor, Colour, Level, Marker, Paint, Point, Rect, Stroke, Text};
use super::text;
use super::theme;

const SAMPLE: f64 = 30.0;
const ROW: f64 = 17.5;
const PAD: f64 = 7.0;
const SAMPLE_GAP: f64 = 7.0;
const COLUMN_GAP: f64 = 20.0;

/// How a mark looks in the legend.
#[derive(Debug, Clone, PartialEq)]
enum Sample {
    Line(Stroke),
    Dot(Colour, Marker),
    Area { colour: Colour, outlined: bool },
}

/// The labels of a panel with their samples; marks under the same label share an entry.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Legend {
    entries: Vec<(String, Vec<Sample>)>,
}

impl Legend {
    /// The legend of these marks, or none when none of them has a label.
    pub fn new(marks: &[Mark]) -> Option<Self> {
        let mut entries: Vec<(String, Vec<Sample>)> = Vec::new();
        for mark in marks.iter().filter(|mark| !mark.label().is_empty()) {
            let sample = match mark {
                Mark::Line { stroke, .. } => Sample::Line(*stroke),
                Mark::Dots { colour, marker, .. } => Sample::Dot(*colour, *marker),
                Mark::Band { colour, .. } => Sample::Area { colour: *colour, outlined: false },
                Mark::Bars { colour, .. } => Sample::Area { colour: *colour, outlined: true },
                Mark::Vertical { .. } | Mark::Horizontal { .. } | Mark::Shade { .. } | Mark::Note { .. } => continue,
            };
            match entries.iter_mut().find(|(label, _)| label == mark.label()) {
                Some((_, samples)) if samples.contains(&sample) => {}
                Some((_, samples)) => samples.push(sample),
                None => entries.push((mark.label().to_owned(), vec![sample])),
            }
        }
        (!entries.is_empty()).then_some(Self { entries })
    }

    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// The columns for a legend as low as a width allows, and no more than its rows need; at least one.
    pub fn columns_within(&self, width: f64) -> usize {
        let most = (1..=self.len()).rev().find(|&columns| self.size(columns)[0] <= width).unwrap_or(1);
        self.len().div_ceil(self.len().div_ceil(most))
    }

    /// Width and height with entries in this many columns, filled row by row.
    pub fn size(&self, columns: usize) -> [f64; 2] {
        let widths = self.widths(columns);
        let width = widths.iter().sum::<f64>() + COLUMN_GAP * (widths.len() - 1) as f64 + 2.0 * PAD;
        [width, ROW * self.len().div_ceil(columns) as f64 + 2.0 * PAD - 3.0]
    }

    fn widths(&self, columns: usize) -> Vec<f64> {
        let mut widths = vec![0.0f64; columns];
        for (i, (label, _)) in self.entries.iter().enumerate() {
            let width = SAMPLE + SAMPLE_GAP + text::width(label, theme::NOTE_SIZE, false);
            widths[i % columns] = widths[i % columns].max(width);
        }
        widths
    }

    /// Draws the entries with the legend's top left corner at `at`.
    pub fn draw(&self, drawing: &mut Drawing, at: Point, columns: usize) {
        let widths = self.widths(columns);
        for (i, (label, samples)) in self.entries.iter().enumerate() {
            let (row, column) = (i / columns, i % columns);
            let x = at[0] + PAD + widths[..column].iter().map(|w| w + COLUMN_GAP).sum::<f64>();
            let y = at[1] + PAD - 1.5 + ROW * (row as f64 + 0.5);
            for sample in samples {
                draw_sample(drawing, sample, [x, y]);
            }
            let text = Text::new([x + SAMPLE + SAMPLE_GAP, y], theme::NOTE_SIZE, label.clone());
            drawing.text(text.held(Anchor::Start, Level::Middle));
        }
    }
}

fn draw_sample(drawing: &mut Drawing, sample: &Sample, [x, y]: Point) {
    match *sample {
        Sample::Line(stroke) => drawing.line([[x, y], [x + SAMPLE, y]], stroke),
        Sample::Dot(colour, marker) => drawing.marker([x + SAMPLE / 2.0, y], theme::DOT, marker, colour),
        Sample::Area { colour, outlined } => {
            let fill = Some(colour.faded(if outlined { 0.3 } else { 0.2 }));
            let stroke = outlined.then(|| Stroke::solid(colour, 1.2));
            drawing.rect(Rect::new(x, y - 5.0, SAMPLE, 10.0), Paint { fill, stroke });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(label: impl Into<String>) -> Mark {
        Mark::Line { label: label.into(), stroke: theme::series(0), points: Vec::new() }
    }

    #[test]
    fn marks_of_one_label_share_an_entry() {
        let dots = Mark::Dots { label: "a".into(), colour: theme::BLUE, marker: Marker::Disc, points: Vec::new() };
        let legend = Legend::new(&[line("a"), line("b"), line(""), dots, line("a")]).unwrap();
        assert_eq!((legend.len(), legend.entries[0].1.len()), (2, 2));
        assert_eq!(Legend::new(&[line("")]), None);
    }

    #[test]
    fn columns_fit_the_width() {
        let marks: Vec<Mark> = (0..6).map(|i| line(format!("series number {i}"))).collect();
        let legend = Legend::new(&marks).unwrap();
        for width in [10.0, 200.0, 400.0, 2000.0] {
            let columns = legend.columns_within(width);
            assert!(columns == 1 || legend.size(columns)[0] <= width);
        }
        assert_eq!(legend.columns_within(2000.0), 6);
        assert_eq!(legend.columns_within(legend.size(5)[0]), 3, "two even rows, not five and one");
    }
}
