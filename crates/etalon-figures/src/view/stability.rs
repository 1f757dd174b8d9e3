//! Maps of errors over the inputs: the renderer's formula, the textbook's, the reports', and the error that rounding of the input causes;
//! and the worst case of every family, variant and precision beside what rounding explains of it.

use super::text::{capitalized, power_of_ten};
use crate::figure::{Axis, Colour, Drawing, Heatmap, Marker, Panel, Plot, Point, Shading, theme};
use etalon_bench::stability::{Case, ErrorRow, Precision, REPORT, STABLE, Scale, Section, Sweep, TEXTBOOK};

/// One colour scale for all maps: from below the rounding of f32 to a relative error of 1.
const SCALE: (f64, f64) = (1e-8, 1.0);
/// Half a unit of f32's last place: how far rounding an input moves it.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;
/// Size of a map.
const FRAME: [f64; 2] = [180.0, 95.0];
/// The label of the colour bar, which all maps share.
const LABEL: &str = "relative error in f32 (darkest: 10^{−8} or less, lightest: 1 or more, grey: not finite)";

/// Grids in a column; more stand in two.
const COLUMN: usize = 4;

/// A row of maps for every grid of the sweeps, each of the relative errors in f32. Grids on which no variant errs are named, and are shown
/// where there are no others.
pub fn maps(sweeps: &[Sweep]) -> Drawing {
    let grids = sweeps.iter().flat_map(|sweep| (0..sweep.family.sections.len()).map(move |number| (sweep, number)));
    let (shown, others): (Vec<_>, Vec<_>) = grids.partition(|(sweep, number)| errs(sweep, *number));
    let (shown, others) = if shown.is_empty() { (others, Vec::new()) } else { (shown, others) };
    let rows: Vec<_> = shown.iter().map(|(sweep, number)| row(sweep, *number)).collect();
    let column = |rows: &[(String, Vec<Panel>)]| Plot::grid(rows.to_vec()).frame_size(FRAME[0], FRAME[1]).draw();
    let half = if rows.len() > COLUMN { rows.len().div_ceil(2) } else { rows.len() };
    let maps = Drawing::beside(rows.chunks(half.max(1)).map(column).collect());
    if others.is_empty() {
        return maps;
    }
    let names: Vec<String> = others.iter().map(|(sweep, number)| heading(sweep, *number)).collect();
    let small = format!("Every variant has errors below {}, and no map:", power_of_ten(VISIBLE).replace("≈ ", ""));
    Drawing::stacked(vec![maps, Drawing::stacked(Vec::new(), 0.0).headed(small, names)], 0.5)
}

/// The least relative error that counts as one in a map.
const VISIBLE: f64 = 1e-5;

/// Whether a variant errs somewhere on a grid, or has no finite value.
fn errs(sweep: &Sweep, number: usize) -> bool {
    let on_grid =
        |case: &&Case| case.precision == Precision::Single && case.place.is_some_and(|place| place.section == number);
    let is_small = |case: &Case| case.deviations.iter().flatten().all(|d| d.relative < VISIBLE);
    !sweep.cases.iter().filter(on_grid).all(is_small)
}

fn heading(sweep: &Sweep, number: usize) -> String {
    capitalized(&format!("{} ({})", sweep.family.about, sweep.family.sections[number].title))
}

/// The maps of one grid under their heading.
fn row(sweep: &Sweep, number: usize) -> (String, Vec<Panel>) {
    let of = |i: usize| move |case: &Case| case.deviations[i].map_or(f64::NAN, |d| d.relative);
    let variants = sweep.family.variants.iter().enumerate();
    let mut panels: Vec<Panel> =
        variants.map(|(i, variant)| panel(sweep, number, title(variant.name), i == 0, &of(i))).collect();
    let rounding = |case: &Case| case.condition.max(1.0) * ROUNDING;
    // Beside the variant that renders: the other variants' number differs
    panels.insert(1, panel(sweep, number, "Rounding of the input".into(), false, &rounding));
    (heading(sweep, number), panels)
}

/// What a variant is called in figures.
pub fn title(variant: &str) -> String {
    match variant.strip_prefix(STABLE) {
        Some(rest) => format!("As it renders{rest}"),
        None => capitalized(variant),
    }
}

/// A map of one grid; the first of a row names the y axis.
fn panel(sweep: &Sweep, number: usize, title: String, is_first: bool, value: &dyn Fn(&Case) -> f64) -> Panel {
    let Section { x, y, .. } = &sweep.family.sections[number];
    let side = sweep.side;
    let mut values = vec![f64::NAN; side * side];
    for case in sweep.cases.iter().filter(|case| case.precision == Precision::Single) {
        if let Some(place) = case.place.filter(|place| place.section == number) {
            // Row 0 of a map is at the top, where the y axis ends. Exact values take the colour of the least error.
            values[(side - 1 - place.row) * side + place.column] = value(case).max(SCALE.0);
        }
    }
    let axis = |scale: &Scale, label| Axis::log(label).range(scale.from, scale.to);
    let map = Heatmap::new(side, values, Shading::Log10, LABEL).range(SCALE.0, SCALE.1);
    Panel::new(axis(x, x.label), axis(y, if is_first { y.label } else { "" })).title(title).heatmap(map)
}

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
    let ratios =
        panel("largest error / rounding of the input", RATIOS, &families, &|row| 2.0 * row.max_ulp_per_condition)
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
