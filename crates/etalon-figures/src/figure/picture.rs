//! A picture: marks over an image, enlarged and reduced together; and below it a key of its marks, whose type has its own size.

use super::page::Page;
use super::shapes::{Anchor, Colour, Level, Rect, Text};
use super::style::Room;
use super::{text, theme};

/// A page that is enlarged or reduced as a whole, with its key.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Picture {
    pub page: Page,
    /// Sides of square marks on the page, their colours and what they mean; side 0 is a text alone.
    pub key: Vec<(f64, Colour, String)>,
}

/// Height of a line of the key, of a further line of a text, space at its left end, between a mark and its text, and after the text.
const LINE: f64 = 24.0;
const FURTHER: f64 = 15.0;
/// The rims of a mark, a dark one around a white one, over its side.
const RIM: f64 = 0.4;
const LEFT: f64 = 12.0;
const GAP: f64 = 6.0;
const AFTER: f64 = 28.0;

/// The side of a mark with its rims; 0 where there is none.
fn framed(side: f64) -> f64 {
    side * (1.0 + 2.0 * RIM)
}

impl Picture {
    pub(super) fn laid(&self, room: Room) -> Page {
        let fit = |height: f64| (room.width / self.page.width).min(height / self.page.height);
        let factor = |height: f64| if room.width.is_finite() { fit(height) } else { 1.0 };
        let lines = |factor: f64| self.lines(factor, self.page.width * factor);
        // The height of the key depends on the width of the picture
        let below = |lines: Vec<Line>| lines.iter().map(|line| line.height).sum::<f64>();
        let factor = factor(room.height - below(lines(factor(room.height))));
        let mut page = self.page.clone().scaled(factor);
        for Line { height, texts } in lines(factor) {
            let tallest = texts.iter().map(|(side, ..)| framed(*side)).fold(LINE, f64::max);
            let (mut x, middle) = (LEFT, page.height + height - 0.5 * tallest);
            for (side, colour, name, width) in texts {
                if side > 0.0 {
                    let mark = Rect::new(x + RIM * side, middle - 0.5 * side, side, side);
                    // On dark paper, too, a mark stands out as it does on the picture
                    page.rect(mark.grown(RIM * side), theme::MARKER_SHADE);
                    page.rect(mark.grown(0.5 * RIM * side), theme::BORDER);
                    page.rect(mark, colour);
                    x += framed(side) + GAP;
                }
                page.text(Text::new([x, middle], theme::NOTE_SIZE, name).held(Anchor::Start, Level::Middle));
                x += width + AFTER;
            }
            page.height += height;
        }
        page
    }

    /// The key in lines of this width.
    fn lines(&self, factor: f64, width: f64) -> Vec<Line> {
        let mut lines: Vec<Line> = Vec::new();
        let mut x = f64::INFINITY;
        for (side, colour, name) in &self.key {
            let limit = width - 2.0 * LEFT - framed(side * factor) - GAP;
            for (i, part) in text::wrapped(name, theme::NOTE_SIZE, false, limit).into_iter().enumerate() {
                let side = if i == 0 { side * factor } else { 0.0 };
                let long = text::width(&part, theme::NOTE_SIZE, false);
                if x + framed(side) + GAP + long > width || i > 0 {
                    lines.push(Line { height: if i > 0 { FURTHER } else { LINE }, texts: Vec::new() });
                    x = LEFT;
                }
                x += framed(side) + GAP + long + AFTER;
                let line = lines.last_mut().expect("a line was begun");
                line.height = line.height.max(framed(side));
                line.texts.push((side, *colour, part, long));
            }
        }
        lines
    }
}

/// A line of the key: marks and their texts, with the widths of these.
struct Line {
    height: f64,
    texts: Vec<(f64, Colour, String, f64)>,
}

#[cfg(test)]
mod tests {
    use super::super::page::Item;
    use super::*;

    #[test]
    fn lines_of_one_text_stand_close_together() {
        let key = vec![(0.0, theme::INK, "word ".repeat(40)), (4.0, theme::MARKER, "another".to_owned())];
        let picture = Picture { page: Page::new(300.0, 100.0, 1.0), key };
        let page = picture.laid(Room { width: 300.0, height: f64::INFINITY, pixels: None });
        let height = |item: &Item| if let Item::Text(text) = item { Some(text.at[1]) } else { None };
        let heights: Vec<f64> = page.items.iter().filter_map(height).collect();
        let steps: Vec<f64> = heights.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let (last, first) = steps.split_last().unwrap();
        assert!(first.len() > 2 && first.iter().all(|step| *step == FURTHER) && *last == LINE, "{steps:?}");
    }
}
