//! Drawings on a dark page: neutral colours are exchanged, and those that mean something keep their hue.

use super::shapes::Colour;
use super::svg::hexadecimal;
use super::theme;

/// Colours of ink, lines and marks, and what they become on a dark page.
const EXCHANGED: [(Colour, Colour); 10] = [
    (Colour::BLACK, Colour::rgb(242, 242, 242)),
    (theme::INK, Colour::rgb(228, 228, 230)),
    (theme::RULE.colour, Colour::rgb(180, 184, 190)),
    (theme::MARKER_RIM, Colour::rgb(168, 173, 180)),
    (theme::GUIDE.colour, Colour::rgb(152, 158, 166)),
    (theme::GRID.colour, Colour::rgb(58, 63, 70)),
    // The darkest of the palette become lighter.
    (theme::BLUE, Colour::rgb(51, 151, 216)),
    (theme::VERMILION, Colour::rgb(234, 116, 32)),
    (theme::GREEN, Colour::rgb(16, 178, 132)),
    // Behind other marks
    (theme::EXPLAINED_BY_INPUT.colour, Colour::rgb(52, 86, 110)),
];
/// What white areas become. White text and white lines lie over images, and stay.
const PAPER: Colour = Colour::rgb(31, 34, 38);

/// An SVG drawing of this program with a style that applies where the page around it is dark.
pub fn with_dark_colours(svg: &str) -> String {
    let rule = |(light, dark): &(Colour, Colour)| {
        let [light, dark] = [*light, *dark].map(hexadecimal);
        format!("[fill=\"{light}\"]{{fill:{dark}}}[stroke=\"{light}\"]{{stroke:{dark}}}")
    };
    let rules: String = EXCHANGED.iter().map(rule).collect();
    let paper = format!(":is([fill=\"#fff\"],[fill=\"#ffffff\"]):not(text){{fill:{}}}", hexadecimal(PAPER));
    let style = format!("<style>@media (prefers-color-scheme:dark){{{paper}{rules}}}</style>");
    match svg.split_once('>') {
        Some((tag, rest)) => format!("{tag}>{style}{rest}"),
        None => svg.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Drawing, Rect, Stroke};

    #[test]
    fn every_colour_of_the_theme_has_a_dark_counterpart_that_is_as_distinct() {
        let mut drawing = Drawing::new(20.0, 10.0, 1.0);
        drawing.line([[0.0, 0.0], [9.0, 9.0]], Stroke::solid(theme::INK, 1.0));
        drawing.rect(Rect::new(1.0, 1.0, 2.0, 2.0), theme::BLUE);
        let dark = with_dark_colours(&drawing.svg());
        assert!(
            dark.contains("[stroke=\"#262626\"]{stroke:#e4e4e6}") && dark.contains("[fill=\"#0072b2\"]{fill:#3397d8}")
        );
        roxmltree::Document::parse(&dark).unwrap();
        // Contrast with the paper: lines at least 3 to 1, and no pair of marks becomes one colour.
        let linear = |c: u8| (f64::from(c) / 255.0).powf(2.2);
        let luminance = |c: Colour| 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
        let marks = [
            Colour::BLACK,
            theme::INK,
            theme::BLUE,
            theme::VERMILION,
            theme::GREEN,
            theme::PURPLE,
            theme::ORANGE,
            theme::SKY_BLUE,
            theme::RED,
            theme::CYAN,
            theme::YELLOW,
            theme::VIOLET,
        ];
        let shown =
            marks.map(|mark| EXCHANGED.iter().find(|(light, _)| *light == mark).map_or(mark, |(_, dark)| *dark));
        for (i, colour) in shown.iter().enumerate() {
            assert!((luminance(*colour) + 0.05) / (luminance(PAPER) + 0.05) > 3.0, "{colour:?}");
            assert!(!shown[..i].contains(colour), "{colour:?} twice");
        }
    }
}
