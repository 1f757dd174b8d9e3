//! The theme of all figures: colours by role, dashes, line widths, font sizes.

use super::shapes::{Colour, Marker, Stroke};

// The palette of Okabe and Ito (2008), distinct with every common kind of colour vision. It is private to `figure`: views
// take colours by the roles below.
pub(super) const ORANGE: Colour = Colour::rgb(230, 159, 0);
pub(super) const SKY_BLUE: Colour = Colour::rgb(86, 180, 233);
pub(super) const GREEN: Colour = Colour::rgb(0, 158, 115);
pub(super) const BLUE: Colour = Colour::rgb(0, 114, 178);
pub(super) const VERMILION: Colour = Colour::rgb(213, 94, 0);
pub(super) const PURPLE: Colour = Colour::rgb(204, 121, 167);
pub(super) const BLACK: Colour = Colour::BLACK;

// Colours of Tol (2021), distinct with every common kind of colour vision: those that the first report gives its curves.
pub(super) const RED: Colour = Colour::rgb(204, 51, 17);
pub(super) const CYAN: Colour = Colour::rgb(51, 187, 238);
pub(super) const YELLOW: Colour = Colour::rgb(204, 187, 68);
pub(super) const VIOLET: Colour = Colour::rgb(170, 68, 153);

// Dark colours of Tol (2021), for strategies beyond those of the first palette.
pub(super) const WINE: Colour = Colour::rgb(136, 34, 85);
pub(super) const OLIVE: Colour = Colour::rgb(140, 140, 45);
pub(super) const INDIGO: Colour = Colour::rgb(51, 34, 136);
pub(super) const SAND: Colour = Colour::rgb(190, 165, 70);

/// The palette in the order in which series take it; the palette's yellow is too pale for lines on white.
const SERIES: [Colour; 7] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY_BLUE, BLACK];

// Roles in plots of reflectance.

pub const R_PARALLEL: Colour = BLUE;
pub const R_PERPENDICULAR: Colour = GREEN;
pub const UNPOLARIZED: Colour = RED;
pub const TRANSMITTANCE: Colour = BLACK;
/// Schlick's approximation, and its errors.
pub const SCHLICK: Colour = CYAN;
/// The same at the angle of incidence where that of refraction is right.
pub const SCHLICK_INCIDENT: Colour = ORANGE;
pub const BREWSTER: Colour = YELLOW;
pub const CRITICAL: Colour = VIOLET;
/// Where all light is reflected.
pub const TOTAL_REFLECTION: Colour = VIOLET;
pub const CHANNELS: [Colour; 3] = [VERMILION, GREEN, BLUE];

// Roles in plots of tests.

/// A test whose claim is accepted.
pub const ACCEPTED: Colour = BLUE;
/// A test whose claim is rejected, and the line below which that happens.
pub const REJECTED: Colour = VERMILION;
/// A test with too few samples for either.
pub const INCONCLUSIVE: Colour = ORANGE;
pub const OBSERVED: Colour = SKY_BLUE;
/// What a true claim predicts.
pub const EXPECTED: Colour = BLACK;
pub const RESIDUAL: Colour = BLUE;
/// An interval that holds most results of true claims.
pub const INTERVAL: Colour = SKY_BLUE;
pub const ERRATUM: Colour = VERMILION;
pub const CORRECTED: Colour = BLUE;

// Roles in plots of renders.

/// A measurement by another program.
pub const REFERENCE: Colour = BLACK;
pub const IMPORTANCE_SAMPLING: Colour = BLUE;
pub const HEMISPHERE_SAMPLING: Colour = VERMILION;
/// A line of known slope.
pub const GUIDE: Stroke = Stroke { colour: Colour::rgb(120, 120, 120), width: 1.0, dash: DOTTED };

// Roles in plots of numerical errors.

pub const STABLE_VARIANT: Colour = BLUE;
pub const TEXTBOOK_VARIANT: Colour = VERMILION;
pub const ERRATUM_VARIANT: Colour = PURPLE;
/// How far rounding of the input alone may move a result.
pub const EXPLAINED_BY_INPUT: Stroke = Stroke::solid(Colour::rgb(176, 208, 232), 4.0);

// Roles over environment maps.

/// Markers of samples and centroids: a blue that stands out from stone and from glass.
pub const MARKER: Colour = Colour::rgb(30, 90, 255);
/// Dark lines around white ones, so that these stand out from bright windows.
pub const MARKER_SHADE: Colour = Colour::rgb(16, 16, 24);
/// The rim of a marker on black, whose own colour may be nearly black.
pub const MARKER_RIM: Colour = Colour::rgb(175, 175, 178);
/// The frame of the place where images differ most, on maps of blue and red.
pub const DIFFERS: Colour = GREEN;
/// The frame of what an inset shows, among markers with white rims.
pub const INSET: Colour = Colour::rgb(255, 140, 0);
/// Borders of regions, and the rims of markers: over images, and not quite the white of paper, so that they stay in the dark.
pub const BORDER: Colour = Colour::rgb(254, 254, 254);

/// The sampling strategies, each of which has one colour in all figures.
const STRATEGIES: [(&str, Colour); 12] = [
    ("bsdf", IMPORTANCE_SAMPLING),
    ("visible normals", IMPORTANCE_SAMPLING),
    ("hemisphere", HEMISPHERE_SAMPLING),
    ("light", GREEN),
    ("light-cosine", ORANGE),
    ("mis", BLACK),
    ("mis+lt", OLIVE),
    ("mis-cosine", SKY_BLUE),
    ("mis-cosine-compensated", WINE),
    ("median-cut", INDIGO),
    ("variance-cut", SAND),
    ("default", PURPLE),
];

/// The colours of the sampling strategies of one comparison. A strategy with a suffix (`+adaptive`, `-64`) has the colour of
/// the one without. Others, renderers among them, take the colours that remain, in the order of the palette.
pub fn strategies(names: &[&str]) -> Vec<Colour> {
    let known = |name: &str| STRATEGIES.iter().find(|(known, _)| *known == name).map(|(_, colour)| *colour);
    let own = |name: &str| {
        let ends = name.match_indices(['+', '-']).map(|(end, _)| end);
        known(name).or_else(|| ends.rev().find_map(|end| known(&name[..end])))
    };
    let taken: Vec<Colour> = names.iter().filter_map(|name| own(name)).collect();
    let mut free = SERIES.into_iter().filter(|colour| !taken.contains(colour)).chain(SERIES.into_iter().cycle());
    names.iter().filter_map(|name| own(name).or_else(|| free.next())).collect()
}

/// Colours of ink, lines and marks, and what they become on dark paper.
pub(super) const EXCHANGED: [(Colour, Colour); 13] = [
    (Colour::BLACK, Colour::rgb(242, 242, 242)),
    (INK, Colour::rgb(228, 228, 230)),
    (RULE.colour, Colour::rgb(180, 184, 190)),
    (GUIDE.colour, Colour::rgb(152, 158, 166)),
    (GRID.colour, Colour::rgb(58, 63, 70)),
    // The darkest of the palettes become lighter.
    (BLUE, Colour::rgb(51, 151, 216)),
    (VERMILION, Colour::rgb(234, 116, 32)),
    (GREEN, Colour::rgb(16, 178, 132)),
    (RED, Colour::rgb(240, 92, 66)),
    (VIOLET, Colour::rgb(205, 105, 190)),
    (WINE, Colour::rgb(214, 92, 140)),
    (INDIGO, Colour::rgb(138, 124, 236)),
    // Behind other marks
    (EXPLAINED_BY_INPUT.colour, Colour::rgb(52, 86, 110)),
];
/// What white areas become in the dark. White text and white lines lie over images, and stay.
pub(super) const DARK_PAPER: Colour = Colour::rgb(31, 34, 38);

/// The colour on dark paper of ink, a line or a mark, at its opacity.
pub(super) fn in_the_dark(colour: Colour) -> Colour {
    let opaque = colour.with_alpha(255);
    let dark = EXCHANGED.iter().find(|(light, _)| *light == opaque).map_or(opaque, |(_, dark)| *dark);
    dark.with_alpha(colour.alpha)
}

#[cfg(test)]
pub(super) fn marks() -> Vec<Colour> {
    let mut marks = vec![INK, RED, CYAN, YELLOW, VIOLET];
    let more = SERIES.into_iter().chain(STRATEGIES.map(|(_, colour)| colour));
    more.for_each(|colour| {
        if !marks.contains(&colour) {
            marks.push(colour)
        }
    });
    marks
}

/// Dash patterns, in drawing units.
pub const SOLID: &[f64] = &[];
pub const DASHED: &[f64] = &[6.0, 3.0];
pub const DOTTED: &[f64] = &[1.5, 2.5];
pub const DASH_DOT: &[f64] = &[7.0, 2.5, 1.5, 2.5];
pub const LONG_DASH: &[f64] = &[11.0, 3.5];

const DASHES: [&[f64]; 5] = [SOLID, DASHED, DASH_DOT, DOTTED, LONG_DASH];

/// The markers of curves, by dash pattern: black-and-white prints distinguish points as well as lines.
const MARKERS: [Marker; 5] = [Marker::Disc, Marker::Square, Marker::Diamond, Marker::Triangle, Marker::Wedge];

/// The marker of points on a curve of this stroke.
pub fn marker(stroke: Stroke) -> Marker {
    DASHES.iter().position(|dash| *dash == stroke.dash).map_or(Marker::Disc, |place| MARKERS[place])
}

pub const LINE: f64 = 1.6;
/// A line that must be seen across others.
pub const BOLD: f64 = 2.4;
pub const THIN: f64 = 0.9;
pub const DOT: f64 = 3.0;

/// Frames, ticks and tick labels.
pub const INK: Colour = Colour::INK;
pub const GRID: Stroke = Stroke::solid(Colour::rgb(228, 228, 228), 0.7);
pub const RULE: Stroke = Stroke { colour: Colour::rgb(90, 90, 90), width: 1.0, dash: &[3.5, 2.5] };
/// What a heat map shows where there is no value: a grey that neither colour scale comes near.
pub const NO_VALUE: Colour = Colour::rgb(150, 150, 150);

/// Font sizes.
pub const TITLE_SIZE: f64 = 13.5;
pub const LABEL_SIZE: f64 = 13.0;
pub const TICK_SIZE: f64 = 11.5;
pub const NOTE_SIZE: f64 = 11.5;

/// The stroke of the `index`-th series: every one of the first 35 differs, neighbours in both colour and dash.
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

    #[test]
    fn a_strategy_has_one_colour_in_every_figure_and_shares_it_with_no_other() {
        let names = ["median-cut-64", "mis", "light", "hemisphere", "mis-cosine", "default"];
        let colours = strategies(&names);
        for (i, colour) in colours.iter().enumerate() {
            assert!(!colours[..i].contains(colour), "{}", names[i]);
        }
        assert_eq!(colours[2], strategies(&["light"])[0]);
        assert_eq!(strategies(&["light-cosine+adaptive", "mis+lt", "mis+adaptive"]), [ORANGE, OLIVE, BLACK]);
        assert_eq!(strategies(&["unknown"; 20]).len(), 20);
    }

    #[test]
    fn neighbouring_series_have_different_markers() {
        for i in 0..35 {
            assert_ne!(marker(series(i)), marker(series(i + 1)));
        }
    }
}
