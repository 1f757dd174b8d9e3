//! A page as SVG: searchable text, real dash patterns, coordinates to a hundredth of a unit. On a dark page neutral colours are
//! exchanged, and those that mean something keep their hue.

use super::page::{Item, Page};
use super::shapes::{Anchor, Colour, Paint, Point, Rect, Text};
use super::text::{self, Face};
use super::theme;
use base64::prelude::{BASE64_STANDARD, Engine};
use std::fmt::Write;

/// DejaVu Sans, or at the viewer's without it Verdana, whose letters are as wide.
const FONTS: &str = "DejaVu Sans,Verdana,sans-serif";

const MM_PER_CSS: f64 = 25.4 / 96.0;

impl Page {
    /// The page as an SVG document. Text stays text; images are embedded as PNG. A page whose unit is no CSS pixel has its size in
    /// millimetres.
    pub fn svg(&self) -> String {
        let (w, h) = (number(self.width), number(self.height));
        let size = |units: f64| match self.unit {
            1.0 => number(units),
            unit => format!("{}mm", number(units * unit * MM_PER_CSS)),
        };
        let (width, height) = (size(self.width), size(self.height));
        let paper = if self.paper == Colour::WHITE { "#fff".to_owned() } else { hexadecimal(self.paper) };
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"{FONTS}\" stroke-linejoin=\"round\" xml:space=\"preserve\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"{paper}\"/>\n"
        );
        for item in &self.items {
            write_item(&mut out, item);
            out.push('\n');
        }
        out.push_str("</svg>\n");
        out
    }
}

fn write_item(out: &mut String, item: &Item) {
    // Writing to a string cannot fail.
    let _ = match item {
        Item::Path { points, closed, paint } => {
            write!(out, "<path d=\"{}{}\"{}/>", path(points), if *closed { "Z" } else { "" }, attributes(paint))
        }
        Item::Rect { rect, paint } => write!(out, "<rect{}{}/>", place(rect), attributes(paint)),
        Item::Circle { centre, radius, paint } => {
            let (x, y) = (number(centre[0]), number(centre[1]));
            write!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"{}/>", number(*radius), attributes(paint))
        }
        Item::Text(text) => write_text(out, text),
        Item::Image { rect, image } => {
            let sharp = rect.width >= image.width() as f64 && rect.height >= image.height() as f64;
            let style = if sharp { " style=\"image-rendering:pixelated\"" } else { "" };
            let (place, data) = (place(rect), BASE64_STANDARD.encode(image.png()));
            let href = format_args!("href=\"data:image/png;base64,{data}\"");
            write!(out, "<image{place} preserveAspectRatio=\"none\"{style} {href}/>")
        }
    };
}

fn place(rect: &Rect) -> String {
    let [x, y, w, h] = [rect.x, rect.y, rect.width, rect.height].map(number);
    format!(" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"")
}

fn write_text(out: &mut String, text: &Text) -> std::fmt::Result {
    let [x, y] = text.at;
    let (place, drop) = if text.upwards {
        (format!(" transform=\"translate({} {}) rotate(-90)\"", number(x), number(y)), text.drop())
    } else {
        (format!(" x=\"{}\"", number(x)), y + text.drop())
    };
    let anchor = match text.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let bold = if text.bold { " font-weight=\"bold\"" } else { "" };
    let colour = paint_attribute("fill", text.colour);
    let (size, drop) = (number(text.size), number(drop));
    write!(out, "<text{place} y=\"{drop}\" font-size=\"{size}\"{anchor}{bold}{colour}>")?;
    // Shifts by `dy` because browsers disagree about `baseline-shift`.
    let mut rise = 0.0;
    for run in text::runs(&text.markup, text.size, text.bold) {
        let mut style = String::new();
        if run.rise != rise {
            write!(style, " dy=\"{}\"", number(rise - run.rise))?;
            rise = run.rise;
        }
        if run.size != text.size {
            write!(style, " font-size=\"{}\"", number(run.size))?;
        }
        if run.face == Face::Oblique {
            style.push_str(" font-style=\"oblique\"");
        }
        let content = escape(&run.text);
        if style.is_empty() { write!(out, "{content}")? } else { write!(out, "<tspan{style}>{content}</tspan>")? }
    }
    write!(out, "</text>")
}

/// Text for XML, between tags or in a quoted attribute; what XML cannot hold becomes a space.
pub fn escape(text: &str) -> String {
    let clean = text.replace(|c: char| c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}'), " ");
    clean.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Path data; after the first point, steps from the rounded place of the one before, which are shorter to write.
fn path(points: &[Point]) -> String {
    let hundredths = |v: f64| (v * 100.0).round();
    let mut out = String::new();
    let mut last = [0.0, 0.0];
    for (i, p) in points.iter().enumerate() {
        let here = [hundredths(p[0]), hundredths(p[1])];
        let (x, y) = (number((here[0] - last[0]) / 100.0), number((here[1] - last[1]) / 100.0));
        let separator = if y.starts_with('-') { "" } else { " " };
        let command = match i {
            0 => "M",
            1 => "l",
            _ if x.starts_with('-') => "",
            _ => " ",
        };
        out.push_str(command);
        out.push_str(&x);
        out.push_str(separator);
        out.push_str(&y);
        last = here;
    }
    out
}

fn attributes(paint: &Paint) -> String {
    let mut out = match paint.fill {
        Some(colour) => paint_attribute("fill", colour),
        None => " fill=\"none\"".to_owned(),
    };
    if let Some(stroke) = paint.stroke {
        out.push_str(&paint_attribute("stroke", stroke.colour));
        let _ = write!(out, " stroke-width=\"{}\"", number(stroke.width));
        if !stroke.dash.is_empty() {
            let dash: Vec<String> = stroke.dash.iter().map(|&d| number(d)).collect();
            let _ = write!(out, " stroke-dasharray=\"{}\"", dash.join(" "));
        }
    }
    out
}

/// As CSS and attributes write it, without opacity.
fn hexadecimal(Colour { r, g, b, .. }: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn paint_attribute(name: &str, colour: Colour) -> String {
    let mut out = format!(" {name}=\"{}\"", hexadecimal(colour));
    if colour.alpha < 255 {
        let _ = write!(out, " {name}-opacity=\"{}\"", number(f64::from(colour.alpha) / 255.0));
    }
    out
}

/// At most two decimals, no trailing zeros, no negative zero.
fn number(value: f64) -> String {
    let text = format!("{:.2}", (value * 100.0).round() / 100.0 + 0.0);
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// An SVG drawing of this program with a style that applies where the page around it is dark.
pub fn with_dark_colours(svg: &str) -> String {
    let rule = |(light, dark): &(Colour, Colour)| {
        let [light, dark] = [*light, *dark].map(hexadecimal);
        format!("[fill=\"{light}\"]{{fill:{dark}}}[stroke=\"{light}\"]{{stroke:{dark}}}")
    };
    let rules: String = theme::EXCHANGED.iter().map(rule).collect();
    let paper = format!(":is([fill=\"#fff\"],[fill=\"#ffffff\"]):not(text){{fill:{}}}", hexadecimal(theme::DARK_PAPER));
    let style = format!("<style>@media (prefers-color-scheme:dark){{{paper}{rules}}}</style>");
    match svg.split_once('>') {
        Some((tag, rest)) => format!("{tag}>{style}{rest}"),
        None => svg.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::shapes::Stroke;
    use super::super::{Page, Rect};
    use super::*;

    #[test]
    fn numbers_are_short() {
        let numbers = [1.0, 0.125, -0.001, 10.5, 100.0, -2.25].map(number);
        assert_eq!(numbers, ["1", "0.13", "0", "10.5", "100", "-2.25"]);
    }

    #[test]
    fn path_steps_do_not_drift() {
        let points: Vec<Point> = (0..1000).map(|i| [f64::from(i) * 0.333, f64::from(i) * -0.111]).collect();
        let data = path(&points);
        let numbers: Vec<f64> =
            data.replace(['M', 'l'], " ").replace('-', " -").split_whitespace().map(|n| n.parse().unwrap()).collect();
        assert_eq!(numbers.len(), 2000);
        let (x, y) = numbers.chunks(2).fold((0.0, 0.0), |(x, y), n| (x + n[0], y + n[1]));
        assert!((x - 999.0 * 0.333).abs() < 0.006 && (y + 999.0 * 0.111).abs() < 0.006, "{x} {y}");
    }

    #[test]
    fn text_stays_searchable_and_escaped() {
        let mut drawing = Page::new(100.0, 20.0, 1.0);
        drawing.text(Text::new([0.0, 10.0], 10.0, "a < b & \u{1}θ_{B} done"));
        let svg = drawing.svg();
        let index = "<tspan dy=\"2\" font-size=\"7.8\">B</tspan><tspan dy=\"-2\"> done</tspan>";
        assert!(svg.contains(&format!(">a &lt; b &amp;  θ{index}</text>")), "{svg}");
    }

    #[test]
    fn dashes_are_real() {
        let mut drawing = Page::new(100.0, 20.0, 1.0);
        drawing.line([[0.0, 1.0], [9.0, 1.0]], Stroke { colour: Colour::BLACK, width: 1.5, dash: &[6.0, 2.5] });
        drawing.rect(Rect::new(1.0, 2.0, 3.0, 4.0), Colour::BLACK.faded(0.5));
        let svg = drawing.svg();
        assert!(svg.contains(
            "<path d=\"M0 1l9 0\" fill=\"none\" stroke=\"#000000\" stroke-width=\"1.5\" stroke-dasharray=\"6 2.5\"/>"
        ));
        assert!(svg.contains("fill-opacity=\"0.5\""), "{svg}");
    }

    #[test]
    fn every_colour_of_the_theme_has_a_dark_counterpart_that_is_as_distinct() {
        let mut drawing = Page::new(20.0, 10.0, 1.0);
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
        let marks = theme::marks();
        let shown: Vec<Colour> = marks.iter().map(|mark| theme::in_the_dark(*mark)).collect();
        for (i, colour) in shown.iter().enumerate() {
            assert!((luminance(*colour) + 0.05) / (luminance(theme::DARK_PAPER) + 0.05) > 3.0, "{colour:?}");
            assert!(!shown[..i].contains(colour), "{colour:?} twice");
        }
    }
}
