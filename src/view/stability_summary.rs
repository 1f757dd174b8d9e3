//! The worst case of every family, variant and precision on logarithmic scales: the error, beside what rounding of the input
//! explains of it.

use super::stability::title;
use crate::figure::{Axis, Colour, Drawing, Marker, Panel, Plot, Point, theme};
use crate::study::stability::{ErrorRow, Precision, REPORT, STABLE, TEXTBOOK};

/// Scale of relative errors, and of errors over what rounding of the input explains; values outside stand at its ends.
const ERRORS: [f64; 2] = [1e-17, 1e2];
const RATIOS: [f64; 2] = [1e-2, 1e9];
/// Height of a family's line.
const LINE: f64 = 22.0;

/// A line for each family, a marker for each variant: filled for f32, open for f64. Functions at special directions have lines if there
/// is nothing else.
pub fn worst_cases(rows: &[ErrorRow]) -> Drawing {
    let only_special = rows.iter().all(ErrorRow::is_special);
    let is_shown = |row: &&ErrorRow| row.is_compared() && row.is_special() == only_special;
    let rows: Vec<&ErrorRow> = rows.iter().filter(is_shown).collect();
    let mut families: Vec<&str> = rows.iter().map(|row| row.family.as_ref()).collect();
    families.dedup();
    let panel = |label: &str, [least, most]: [f64; 2], names: &[&str], value: &dyn Fn(&ErrorRow) -> f64| {
        let names: Vec<String> =
            names.iter().map(|name| name.trim_start_matches(ErrorRow::SPECIAL).to_owned()).collect();
        let x = Axis::log(label).range(least / 3.0, most * 3.0);
        let panel = Panel::new(x, Axis::named("", names));
        // The legend's entries in the same order on both sides
        let entries = [STABLE, TEXTBOOK, REPORT].into_iter().flat_map(|variant| Precision::ALL.map(|p| (variant, p)));
        let is_there = |(variant, precision): &(&str, Precision)| {
            rows.iter().any(|row| row.precision == *precision && look(row.variant) == look(variant))
        };
        let entries = entries.filter(is_there);
        entries.fold(panel, |panel, (variant, precision)| {
            let (colour, aside) = look(variant);
            let of = rows.iter().filter(|row| row.precision == precision && look(row.variant) == (colour, aside));
            let place = |row: &&ErrorRow| -> Point {
                let line = families.iter().position(|family| *family == row.family).unwrap_or(0);
                // What has no finite value is worse than any
                let value = if value(row).is_nan() { most } else { value(row).clamp(least, most) };
                [value, line as f64 + 0.5 + aside]
            };
            let label = format!("{}, {}", title(variant).to_lowercase(), precision.name());
            panel.markers(label, colour, marker(precision), of.map(place).collect::<Vec<_>>())
        })
    };
    let blank = vec![""; families.len()];
    let errors = panel("largest relative error", ERRORS, &families, &|row| row.max_relative);
    // Rounding of the input by half a last place may move the result by as many as the condition number
    let explained = rows.iter().filter(|row| row.is_rendered()).fold(errors, |panel, row| {
        let line = families.iter().position(|family| *family == row.family).unwrap_or(0);
        let rounding = 0.5 * row.precision.unit(1.0);
        let reach = (row.condition_at_worst.max(1.0) * rounding).clamp(ERRORS[0], ERRORS[1]);
        let y = line as f64 + 0.5 + look(row.variant).1;
        panel.line(
            "explained by rounding of the input, as it renders",
            theme::EXPLAINED_BY_INPUT,
            [[rounding, y], [reach, y]],
        )
    });
    let ratios = panel("largest error / rounding of the input", RATIOS, &blank, &|row| 2.0 * row.max_ulp_per_condition)
        .line("explained by rounding of the input, as it renders", theme::EXPLAINED_BY_INPUT, Vec::new())
        .line("", theme::GUIDE, [[1.0, 0.0], [1.0, families.len() as f64]]);
    let panels = [explained.title("Largest error"), ratios.title("Beyond rounding of the input")];
    Plot::new(panels).frame_size(350.0, LINE * families.len() as f64).draw()
}

/// The colour of a variant, and the vertical offset of its markers in lines, so that none hides another.
fn look(variant: &str) -> (Colour, f64) {
    match variant {
        REPORT => (theme::ERRATUM_VARIANT, 0.24),
        _ if variant.starts_with(STABLE) => (theme::STABLE_VARIANT, -0.24),
        _ => (theme::TEXTBOOK_VARIANT, 0.0),
    }
}

fn marker(precision: Precision) -> Marker {
    match precision {
        Precision::Single => Marker::Disc,
        Precision::Double => Marker::Open,
    }
}
