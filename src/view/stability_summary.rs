//! The worst case of every family, variant and precision on one logarithmic scale.

use crate::figure::{Anchor, Colour, Drawing, Level, Paint, Rect, Stroke, Text, theme};
use crate::study::stability::{ErrorRow, Precision, REPORT, STABLE};

/// Powers of ten of the scale; smaller and larger errors are drawn at its ends.
const SCALE: (i32, i32) = (-17, 1);
const DECADE: f64 = 26.0;
const LINE: f64 = 21.0;
/// Left and top of the frame.
const FRAME: [f64; 2] = [128.0, 62.0];

/// A line for each family, a dot for each variant: filled for f32, open for f64.
pub fn worst_cases(rows: &[ErrorRow]) -> Drawing {
    let mut families: Vec<&str> = rows.iter().map(|row| row.family).collect();
    families.dedup();
    let [left, top] = FRAME;
    let (width, height) = (DECADE * f64::from(SCALE.1 - SCALE.0), LINE * families.len() as f64);
    let mut page = Drawing::new(left + width + 24.0, top + height + 50.0, 2.0);
    let text = |x: f64, y: f64, size: f64, markup: String| Text::new([x, y], size, markup);
    // Decades
    for power in SCALE.0..=SCALE.1 {
        let x = left + DECADE * f64::from(power - SCALE.0);
        page.line([[x, top], [x, top + height]], theme::GRID);
        if (power - SCALE.0) % 3 == 1 {
            let label =
                if power == 0 { "1".into() } else { format!("10^{{{}}}", power.to_string().replace('-', "−")) };
            page.text(text(x, top + height + 17.0, theme::TICK_SIZE, label).held(Anchor::Middle, Level::Baseline));
        }
    }
    // A line of dots for each family
    for (i, family) in families.iter().enumerate() {
        let y = top + LINE * (i as f64 + 0.5);
        page.line([[left, y], [left + width, y]], theme::GRID);
        page.text(text(left - 8.0, y, theme::TICK_SIZE, (*family).into()).held(Anchor::End, Level::Middle));
        for row in rows.iter().filter(|row| row.family == *family) {
            let place = (row.max_relative.log10() - f64::from(SCALE.0)) * DECADE;
            let x = left + if place.is_nan() { width } else { place.clamp(0.0, width) };
            let (colour, aside) = look(row.variant);
            dot(&mut page, [x, y + aside], colour, row.precision);
        }
    }
    page.rect(Rect::new(left, top, width, height), Paint::from(Stroke::solid(theme::INK, theme::THIN)));
    let below = [left + width / 2.0, top + height + 39.0];
    let label =
        text(below[0], below[1], theme::LABEL_SIZE, "largest relative error (at the edges: none, or more)".into());
    page.text(label.held(Anchor::Middle, Level::Baseline));
    legend(&mut page, left);
    page
}

/// The colour of a variant, and the vertical offset of its dots, so that none hides another.
fn look(variant: &str) -> (Colour, f64) {
    match variant {
        REPORT => (theme::ERRATUM_VARIANT, 5.0),
        _ if variant.starts_with(STABLE) => (theme::STABLE_VARIANT, -5.0),
        _ => (theme::TEXTBOOK_VARIANT, 0.0),
    }
}

fn dot(page: &mut Drawing, at: [f64; 2], colour: Colour, precision: Precision) {
    match precision {
        Precision::Single => page.circle(at, 3.4, Paint::from(colour)),
        Precision::Double => page.circle(at, 3.4, Paint::from(Stroke::solid(colour, 1.5))),
    }
}

fn legend(page: &mut Drawing, left: f64) {
    for (line, precision) in Precision::ALL.into_iter().enumerate() {
        let y = 20.0 + LINE * line as f64;
        for (column, (form, name)) in
            [(STABLE, "as it renders"), ("textbook", "textbook"), (REPORT, "report")].into_iter().enumerate()
        {
            let x = left + 160.0 * column as f64;
            dot(page, [x + 6.0, y], look(form).0, precision);
            let label = Text::new([x + 16.0, y], theme::TICK_SIZE, format!("{name}, {}", precision.name()));
            page.text(label.held(Anchor::Start, Level::Middle));
        }
    }
}
