//! Errors over the inputs of a family: the renderer's formula, the textbook's, the reports', and the error that rounding of the input
//! causes; and the worst case of every family, variant and precision beside what rounding explains of it.

use super::text::{capitalized, power_of_ten};
use crate::figure::{Axis, Colour, Drawing, Marker, Panel, Plot, Point, Stroke, theme};
use etalon_bench::stability::{Case, ErrorRow, Precision, REPORT, STABLE, Scale, Section, Sweep, TEXTBOOK};

/// One scale for all panels: from below the rounding of f32 to a relative error of 1. Errors beyond stand at its ends.
const SCALE: [f64; 2] = [1e-8, 1.0];
/// Half a unit of f32's last place: how far rounding an input moves it.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;
/// The name of what rounding an input explains.
const INPUT_ALONE: &str = "rounding of the input alone";
/// Panels in a row, and the size of a frame.
const COLUMNS: usize = 3;
const FRAME: [f64; 2] = [250.0, 150.0];

/// A panel for every grid of the sweeps: the largest error in f32 along that axis of the grid which tells more of it. Grids on which no
/// variant errs are named, and are shown where there are no others.
pub fn errors(sweeps: &[Sweep]) -> Drawing {
    let grids = sweeps.iter().flat_map(|sweep| (0..sweep.family.sections.len()).map(move |number| (sweep, number)));
    let (shown, others): (Vec<_>, Vec<_>) = grids.partition(|(sweep, number)| errs(sweep, *number));
    let (shown, others) = if shown.is_empty() { (others, Vec::new()) } else { (shown, others) };
    // All panels have the same legend
    let is_shown = |name: &&str| shown.iter().any(|(sweep, _)| sweep.family.variants.iter().any(|v| v.name == *name));
    let names: Vec<&str> = [TEXTBOOK, REPORT, STABLE].into_iter().filter(is_shown).collect();
    let panels: Vec<Panel> = shown.iter().map(|(sweep, number)| panel(sweep, *number, &names)).collect();
    let rows = panels.chunks(COLUMNS).map(|row| (String::new(), row.to_vec()));
    let plot = Plot::grid(rows).frame_size(FRAME[0], FRAME[1]).draw();
    if others.is_empty() {
        return plot;
    }
    let names: Vec<String> = others.iter().map(|(sweep, number)| heading(sweep, *number)).collect();
    let small = format!("Every variant has errors below {} here:", power_of_ten(VISIBLE).replace("≈ ", ""));
    Drawing::stacked(vec![plot, Drawing::stacked(Vec::new(), 0.0).headed(small, names)], 0.5)
}

/// The least relative error that counts as one.
const VISIBLE: f64 = 1e-5;

/// The cases of a grid in f32. Where rounding alone decides whether there is a value, errors do not count.
fn cases(sweep: &Sweep, number: usize) -> impl Iterator<Item = (&Case, [usize; 2])> {
    let single = sweep.cases.iter().filter(|case| case.precision == Precision::Single && case.condition.is_finite());
    single.filter_map(move |case| {
        let place = case.place.filter(|place| place.section == number)?;
        Some((case, [place.column, place.row]))
    })
}

/// Whether a variant errs somewhere on a grid, or has no finite value.
fn errs(sweep: &Sweep, number: usize) -> bool {
    let is_small = |(case, _): (&Case, _)| case.deviations.iter().flatten().all(|d| d.relative < VISIBLE);
    !cases(sweep, number).all(is_small)
}

fn heading(sweep: &Sweep, number: usize) -> String {
    let title = sweep.family.sections[number].title.replace(" = ", "\u{a0}=\u{a0}");
    capitalized(&format!("{} ({title})", sweep.family.about))
}

/// The largest errors of one grid along one of its axes.
fn panel(sweep: &Sweep, number: usize, names: &[&str]) -> Panel {
    let Section { x, y, .. } = &sweep.family.sections[number];
    let rounding = |case: &Case| case.condition.max(1.0) * ROUNDING;
    let of = |name: &str| {
        let variant = sweep.family.variants.iter().position(|variant| variant.name == name)?;
        Some(move |case: &Case| case.deviations[variant].map_or(0.0, |d| d.relative))
    };
    // The axis along which the largest errors are smaller on the whole: it tells more of where they are
    let height = |axis: usize| -> f64 {
        let of_variant = |name| of(name).map(|value| largest(sweep, number, axis, &value));
        names.iter().filter_map(|name| of_variant(name)).flatten().map(f64::log10).sum()
    };
    let (axis, Scale { label, from, to }) = if height(1) < height(0) { (1, y) } else { (0, x) };
    let along = |value: &dyn Fn(&Case) -> f64| -> Vec<Point> {
        let at = |i| [x, y][axis].at(i, sweep.side);
        largest(sweep, number, axis, value).into_iter().enumerate().map(|(i, error)| [at(i), error]).collect()
    };
    let error = Axis::log("largest relative error").range(SCALE[0] / 2.0, SCALE[1] * 2.0);
    let panel = Panel::new(Axis::log(*label).range(*from, *to), error).title(heading(sweep, number));
    let panel = panel.line(INPUT_ALONE, theme::EXPLAINED_BY_INPUT, along(&rounding));
    names.iter().fold(panel, |panel, name| {
        let dash = if *name == REPORT { theme::DASHED } else { theme::SOLID };
        let stroke = Stroke { dash, ..Stroke::solid(look(name).0, theme::LINE) };
        panel.line(*name, stroke, of(name).map(|value| along(&value)).unwrap_or_default())
    })
}

/// The largest value at each place along an axis of a grid, within the scale.
fn largest(sweep: &Sweep, number: usize, axis: usize, value: &dyn Fn(&Case) -> f64) -> Vec<f64> {
    let mut values = vec![SCALE[0]; sweep.side];
    for (case, place) in cases(sweep, number) {
        let at = &mut values[place[axis]];
        *at = at.max(value(case)).min(SCALE[1]);
    }
    values
}

/// Scale of relative errors in each precision; values outside stand at its ends.
const ERRORS: [(Precision, &str, [f64; 2]); 2] = [
    (Precision::Single, "Single precision (f32)", [1e-9, 1e2]),
    (Precision::Double, "Double precision (f64)", [1e-17, 1e2]),
];
/// Height of a family's line.
const LINE: f64 = 22.0;

/// A panel for each precision, a line for each family, a marker for each variant. Functions at special directions have lines if there is
/// nothing else.
pub fn worst_cases(rows: &[ErrorRow]) -> Drawing {
    let only_special = rows.iter().all(ErrorRow::is_special);
    let is_shown = |row: &&ErrorRow| row.is_compared() && row.is_special() == only_special;
    let rows: Vec<&ErrorRow> = rows.iter().filter(is_shown).collect();
    let mut families: Vec<&str> = rows.iter().map(|row| row.family.as_ref()).collect();
    families.dedup();
    // The markers of a line stand above each other if there are several variants
    let is_alone = rows.windows(2).all(|pair| look(pair[0].variant) == look(pair[1].variant));
    let aside = |variant: &str| if is_alone { 0.0 } else { look(variant).1 };
    let line = |row: &ErrorRow| {
        families.iter().position(|family| *family == row.family).unwrap_or(0) as f64 + 0.5 + aside(row.variant)
    };
    let names: Vec<String> = families.iter().map(|name| in_words(name.trim_start_matches(ErrorRow::SPECIAL))).collect();
    // The legend's entries in the same order on both sides
    let variants = [STABLE, TEXTBOOK, REPORT].into_iter().zip([Marker::Disc, Marker::Square, Marker::Triangle]);
    let is_there = |(variant, _): &(&str, Marker)| rows.iter().any(|row| look(row.variant) == look(variant));
    let variants: Vec<_> = variants.filter(is_there).collect();
    let panel = |(precision, title, [least, most]): (Precision, &str, [f64; 2])| {
        let of_precision = || rows.iter().filter(|row| row.precision == precision);
        let ends = [least / 3.0, most * 3.0];
        let x = Axis::log("largest relative error (grey: at the line or beyond)").range(ends[0], ends[1]);
        let panel = Panel::new(x, Axis::named("", names.clone())).title(title);
        let panel = panel.shade(ends[0], least, theme::INK).shade(most, ends[1], theme::INK);
        // Rounding of the input by half a last place may move the result by as many as the condition number
        let panel = of_precision().filter(|row| row.is_rendered()).fold(panel, |panel, row| {
            let rounding = 0.5 * row.precision.unit(1.0);
            let reach = (row.condition_at_worst.max(1.0) * rounding).clamp(least, most);
            panel.line(INPUT_ALONE, theme::EXPLAINED_BY_INPUT, [[rounding, line(row)], [reach, line(row)]])
        });
        variants.iter().fold(panel, |panel, (variant, marker)| {
            let of = of_precision().filter(|row| look(row.variant) == look(variant));
            // What has no finite value is worse than any
            let worst =
                |row: &ErrorRow| if row.max_relative.is_nan() { most } else { row.max_relative.clamp(least, most) };
            let places: Vec<Point> = of.map(|row| [worst(row), line(row)]).collect();
            panel.markers(*variant, look(variant).0, *marker, places)
        })
    };
    Plot::new(ERRORS.map(panel)).frame_size(380.0, LINE * families.len() as f64).draw()
}

/// A family's name as people read it: "ggx-pdf" is "GGX, pdf of normals".
fn in_words(family: &str) -> String {
    let of = |distribution: &str, what: &str| {
        let what = match what {
            "d" => "distribution of normals /{D}",
            "g" => "masking /{G}_{1}",
            "g2" => "masking and shadowing /{G}_{2}",
            "pdf" => "pdf of visible normals",
            _ => "sampled visible normals",
        };
        format!("{distribution}, {what}")
    };
    match family {
        "fresnel" => "Fresnel, dielectric".into(),
        "conductor" => "Fresnel, conductor".into(),
        "schlick" => "Schlick's approximation".into(),
        "refraction" => "refracted direction".into(),
        "dielectric-pdf" => "rough glass, pdf of directions".into(),
        "half-cosine" => "half vector, its cosine".into(),
        "refraction-half-vector" => "refraction, half vector".into(),
        "refraction-jacobian" => "refraction, Jacobian".into(),
        "sphere" => "distance to a sphere".into(),
        "triangle" => "distance to a triangle".into(),
        "offsets" => "offsets of ray origins".into(),
        "tables" => "sampling tables of a map".into(),
        "areas" => "summed areas of a map".into(),
        "areas-extreme" => "summed areas, 2^{40} among 2^{−40}".into(),
        "film" => "mean of a pixel's samples".into(),
        "paths" => "energy of paths in a furnace".into(),
        "walks" => "energy of walks over materials".into(),
        _ => match family.split_once('-') {
            Some(("beckmann", what)) => of("Beckmann", what),
            Some(("ggx", what)) => of("GGX", what),
            _ => family.replace('-', " "),
        },
    }
}

/// The colour of a variant, and the vertical offset of its markers in lines, so that none hides another.
fn look(variant: &str) -> (Colour, f64) {
    match variant {
        REPORT => (theme::ERRATUM_VARIANT, 0.24),
        _ if variant.starts_with(STABLE) => (theme::STABLE_VARIANT, -0.24),
        _ => (theme::TEXTBOOK_VARIANT, 0.0),
    }
}
