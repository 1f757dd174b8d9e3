//! Text: the embedded faces, the small markup for indices and exponents, and widths from the fonts' own metrics.
//!
//! Markup: `_{…}` lowers, `^{…}` raises, `/{…}` slants, and they nest: `/{R}_{∥}`, `10^{−3}`. Every other character,
//! a lone `_` or `{` included, stands for itself; a group left open ends with the string. Bold text ignores the slant.

use std::sync::LazyLock;

/// Height of a capital letter, in font sizes (DejaVu Sans: 1493 of 2048 units).
pub const CAP_HEIGHT: f64 = 0.729;
/// What descends below the baseline (g, parentheses), in font sizes.
pub const DESCENT: f64 = 0.236;
/// An index or exponent is this much smaller than the text around it: 5.5 pt where that has 7.1 pt.
const SMALL: f64 = 0.78;

/// The three cuts of DejaVu Sans that drawings use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Face {
    Regular,
    Oblique,
    Bold,
}

impl Face {
    pub fn bytes(self) -> &'static [u8] {
        match self {
            Face::Regular => dejavu::sans::regular(),
            Face::Oblique => dejavu::sans::oblique(),
            Face::Bold => dejavu::sans::bold(),
        }
    }

    /// The font file's tables, parsed once per process.
    pub fn tables(self) -> &'static ttf_parser::Face<'static> {
        static TABLES: LazyLock<[ttf_parser::Face<'static>; 3]> = LazyLock::new(|| {
            [Face::Regular, Face::Oblique, Face::Bold]
                .map(|face| ttf_parser::Face::parse(face.bytes(), 0).expect("the embedded fonts are sound"))
        });
        &TABLES[self as usize]
    }

    /// Advance width of `c` in font sizes; a character that the font lacks counts as its empty box.
    pub fn advance(self, c: char) -> f64 {
        let tables = self.tables();
        let glyph = tables.glyph_index(c).unwrap_or_default();
        f64::from(tables.glyph_hor_advance(glyph).unwrap_or(0)) / f64::from(tables.units_per_em())
    }
}

/// A stretch of text in one face, size and height above the baseline.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    pub text: String,
    pub face: Face,
    pub size: f64,
    /// Height of this run's baseline above the text's, in drawing units.
    pub rise: f64,
}

impl Run {
    /// Advance width in drawing units (without kerning, so never too narrow by more than a hair).
    pub fn width(&self) -> f64 {
        self.size * self.text.chars().map(|c| self.face.advance(c)).sum::<f64>()
    }
}

/// Splits `markup` into runs for text of the given size.
pub fn runs(markup: &str, size: f64, bold: bool) -> Vec<Run> {
    let upright = if bold { Face::Bold } else { Face::Regular };
    let mut current = Run { text: String::new(), face: upright, size, rise: 0.0 };
    let mut outer: Vec<Run> = Vec::new();
    let mut out: Vec<Run> = Vec::new();
    let mut finish = |run: &mut Run| {
        let text = std::mem::take(&mut run.text);
        if !text.is_empty() {
            out.push(Run { text, ..run.clone() });
        }
    };
    let mut chars = markup.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            // Open a group: lower, raise or slant what follows
            '_' | '^' | '/' if chars.peek() == Some(&'{') => {
                chars.next();
                finish(&mut current);
                outer.push(current.clone());
                match c {
                    '_' => current.rise -= 0.2 * current.size,
                    '^' => current.rise += 0.4 * current.size,
                    _ if !bold => current.face = Face::Oblique,
                    _ => {}
                }
                if c != '/' {
                    current.size *= SMALL;
                }
            }
            // Close it: the style outside the group again
            '}' if !outer.is_empty() => {
                finish(&mut current);
                current = outer.pop().expect("just seen not to be empty");
            }
            _ => current.text.push(c),
        }
    }
    finish(&mut current);
    out
}

/// Advance width of a marked-up string in drawing units.
pub fn width(markup: &str, size: f64, bold: bool) -> f64 {
    runs(markup, size, bold).iter().map(Run::width).sum()
}

/// The text without its markup.
pub fn plain(markup: &str) -> String {
    runs(markup, 1.0, false).into_iter().map(|run| run.text).collect()
}

/// Breaks a text between words into lines of at most `limit` (a single word, or a group of the markup, may be wider).
pub fn wrapped(markup: &str, size: f64, bold: bool, limit: f64) -> Vec<String> {
    if limit == f64::INFINITY {
        return vec![markup.to_owned()];
    }
    let is_open = |line: &str| {
        ["_{", "^{", "/{"].map(|open| line.matches(open).count()).iter().sum::<usize>() > line.matches('}').count()
    };
    let mut lines: Vec<String> = Vec::new();
    // At blanks only: others, as the one between a number and its unit, hold words together.
    for word in markup.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if is_open(line) || width(&format!("{line} {word}"), size, bold) <= limit => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_becomes_runs() {
        let got = runs("/{R}_{∥} = 10^{−3}", 10.0, false);
        let expected = [
            ("R", Face::Oblique, 10.0, 0.0),
            ("∥", Face::Regular, 10.0 * SMALL, -2.0),
            (" = 10", Face::Regular, 10.0, 0.0),
            ("−3", Face::Regular, 10.0 * SMALL, 4.0),
        ];
        assert_eq!(got.len(), expected.len());
        for (run, (text, face, size, rise)) in got.iter().zip(expected) {
            assert_eq!((run.text.as_str(), run.face, run.size, run.rise), (text, face, size, rise));
        }
    }

    #[test]
    fn stray_marks_are_plain_text() {
        for plain in ["a_b}c^d{e", "roughness_0.005", "{}", "a/b"] {
            let got = runs(plain, 10.0, false);
            assert_eq!(got.len(), 1, "{plain}");
            assert_eq!(got[0].text, plain);
        }
        assert_eq!(runs("a_{open", 10.0, true)[1].text, "open");
        assert!(runs(&"_{".repeat(100_000), 10.0, false).is_empty(), "deep nesting does not overflow the stack");
    }

    #[test]
    fn the_fonts_have_every_glyph_that_the_plots_need() {
        for face in [Face::Regular, Face::Oblique, Face::Bold] {
            for c in "θηκλμρσφωαβΔΩ∥⊥°₀₁₂²³⁻−×±·≤≥≈∞∫√→–—…".chars()
            {
                assert!(face.tables().glyph_index(c).is_some(), "{face:?} lacks {c}");
            }
        }
    }

    #[test]
    fn lines_are_broken_between_words() {
        let lines = wrapped("one two three four five six seven eight nine", 11.5, false, 100.0);
        assert!(lines.len() > 1);
        assert!(lines.iter().all(|line| width(line, 11.5, false) <= 100.0), "{lines:?}");
        assert_eq!(lines.join(" "), "one two three four five six seven eight nine");
        assert!(wrapped("about 13.5\u{a0}% of the light", 11.5, false, 1.0).contains(&"13.5\u{a0}%".to_owned()));
    }

    #[test]
    fn widths_come_from_the_font() {
        // DejaVu Sans: a digit is 1303 of 2048 units wide.
        assert!((width("0123", 20.48, false) - 4.0 * 13.03).abs() < 1e-9);
        assert!(width("W", 10.0, true) > width("W", 10.0, false));
        assert!((width("x^{0}", 10.0, false) - width("x", 10.0, false) - width("0", 10.0 * SMALL, false)).abs() < 1e-9);
    }
}
