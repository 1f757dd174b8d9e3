//! The one look of all figures: colours, dashes, line widths, sizes.

use super::shapes::{Colour, Stroke};

/// The palette of Okabe and Ito (2008), told apart with every common kind of colour vision.
pub const ORANGE: Colour = Colour::rgb(230, 159, 0);
pub const SKY_BLUE: Colour = Colour::rgb(86, 180, 233);
pub const GREEN: Colour = Colour::rgb(0, 158, 115);
pub const YELLOW: Colour = Colour::rgb(240, 228, 66);
pub const BLUE: Colour = Colour::rgb(0, 114, 178);
pub const VERMILION: Colour = Colour::rgb(213, 94, 0);
pub const PURPLE: Colour = Colour::rgb(204, 121, 167);
pub const BLACK: Colour = Colour::BLACK;

/// The palette in the order in which series take it; yellow is left out, too pale for lines on white.
pub const SERIES: [Colour; 7] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY_BLUE, BLACK];

/// Dash patterns, in drawing units.
pub const SOLID: &[f64] = &[];
pub const DASHED: &[f64] = &[6.0, 3.0];
pub const DOTTED: &[f64] = &[1.5, 2.5];
pub const DASH_DOT: &[f64] = &[7.0, 2.5, 1.5, 2.5];
pub const LONG_DASH: &[f64] = &[11.0, 3.5];

const DASHES: [&[f64]; 5] = [SOLID, DASHED, DASH_DOT, DOTTED, LONG_DASH];

/// Width of a curve.
pub const LINE: f64 = 1.6;
/// Width of frames and ticks.
pub const THIN: f64 = 0.9;
/// Radius of a scatter dot.
pub const DOT: f64 = 2.4;

/// Frames, ticks and tick labels.
pub const INK: Colour = Colour::rgb(38, 38, 38);
/// Grid lines.
pub const GRID: Stroke = Stroke::solid(Colour::rgb(228, 228, 228), 0.7);
/// Reference lines.
pub const RULE: Stroke = Stroke { colour: Colour::rgb(90, 90, 90), width: 1.0, dash: &[3.5, 2.5] };
/// What a heat map shows where there is no value: a grey that neither colour scale comes near.
pub const NO_VALUE: Colour = Colour::rgb(150, 150, 150);

/// Font sizes.
pub const TITLE_SIZE: f64 = 13.5;
pub const LABEL_SIZE: f64 = 13.0;
pub const TICK_SIZE: f64 = 11.5;
pub const NOTE_SIZE: f64 = 11.5;

/// The stroke of the `index`-th series: every one of the first 35 differs, neighbours in both colour and dash.
#[must_use]
pub fn series(index: usize) -> Stroke {
    Stroke { colour: SERIES[index % SERIES.len()], width: LINE, dash: DASHES[index % DASHES.len()] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_differ() {
        let all: Vec<Stroke> = (0..35).map(series).collect();
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a != b), "series {i} repeats");
        }
    }
}
