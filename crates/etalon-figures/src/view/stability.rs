//! Errors over the inputs of a family: the renderer's formula, the textbook's, the reports', and the error that rounding of the input
//! causes; and the worst case of every family, variant and precision beside what rounding explains of it.

use super::text::{capitalized, power_of_ten, rounded};
use crate::figure::{Axis, Colour, Drawing, Marker, Panel, Plot, Point, Stroke, text, theme};
use etalon_bench::stability::{Case, ErrorRow, Precision, REPORT, STABLE, Scale, Section, Sweep, TEXTBOOK};
use serde::Serialize;

/// One scale for all panels: from below the rounding of f32 to a relative error of 1. Errors beyond stand at its ends, with a grey band behind
/// them.
const SCALE: [f64; 2] = [1e-8, 1.0];
/// The title of an axis of errors, and what its grey ends are.
const ERROR: &str = "largest relative error";
const BEYOND: &str = "off the scale, drawn at its end";
/// Half a unit of f32's last place: how far rounding an input moves it.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;
/// The name of what rounding an input explains.
const INPUT_ALONE: &str = "rounding of the input alone";
/// The size of a frame, most panels in a row, and most rows of fewer.
const FRAME: [f64; 2] = [250.0, 150.0];
const MOST_COLUMNS: usize = 4;
const MOST_ROWS: usize = 5;
/// Families whose rendered formula is worse somewhere than rounding of the input and another formula, and why.
const REMARKS: [(&str, &str); 3] = [
    (
        "conductor",
        "Where both /{η} and /{k} are far below 1, as of no metal, the formula that renders loses /{η}² and /{k}² beside cos² /{θ}.",
    ),
    (
        "refraction",
        "The formula that renders takes /{ω}_{o} as a unit vector; next to the critical angle its rounded length decides.",
    ),
    (
        "half-vector",
        "Half vector: the formula that renders removes the rounding of both lengths, which the exact value and the textbook keep.",
    ),
];

/// A panel for every grid of the sweeps: the largest error in f32 along that axis of the grid which tells more of it. Grids on which no
/// variant errs are named, and are shown where there are no others.
pub fn errors(sweeps: &[Sweep]) -> Drawing {
    let grids = sweeps.iter().flat_map(|sweep| (0..sweep.family.sections.len()).map(move |number| (sweep, number)));
    let (shown, others): (Vec<_>, Vec<_>) = grids.partition(|(sweep, number)| errs(sweep, *number));
    let (shown, others) = if shown.is_empty() { (others, Vec::new()) } else { (shown, others) };
    let is_shown = |name: &&str| shown.iter().any(|(sweep, _)| sweep.family.variants.iter().any(|v| v.name == *name));
    let names: Vec<&str> = VARIANTS.into_iter().filter(is_shown).collect();
    let panels: Vec<Panel> = shown.iter().map(|(sweep, number)| panel(sweep, *number, &names)).collect();
    // In few and large panels, curves have their names where they run
    let plot = match panels.len() {
        1 | 2 => Plot::new(panels.into_iter().map(Panel::with_names_on_curves).collect::<Vec<_>>()),
        _ => {
            let rows = panels.chunks(columns(panels.len())).map(|row| (String::new(), row.to_vec()));
            Plot::grid(rows).frame_size(FRAME[0], FRAME[1])
        }
    };
    let is_remarked = |name: &str| shown.iter().any(|(sweep, _)| sweep.family.name == name);
    let remarks = REMARKS.into_iter().filter(|(name, _)| is_remarked(name)).map(|(_, remark)| remark.to_owned());
    let pale = "Errors below the pale line are smaller than what rounding of the input may cause.".to_owned();
    let of_family = |others: &[(&Sweep, usize)]| {
        let grids: Vec<&str> = others.iter().map(|(sweep, number)| sweep.family.sections[*number].title).collect();
        format!("{} ({})", in_words(others[0].0.family.name), grids.join(", "))
    };
    let not_shown: Vec<String> =
        others.chunk_by(|(a, _), (b, _)| a.family.name == b.family.name).map(of_family).collect();
    let below = power_of_ten(VISIBLE).replace("≈ ", "");
    let not_shown = format!("Not shown, as every variant has errors below {below}: {}.", not_shown.join("; "));
    let lines = std::iter::once(pale).chain(remarks).chain((!others.is_empty()).then_some(not_shown)).collect();
    plot.draw().headed(headline(&shown, &names), lines)
}

/// By how much each formula is off in f32 where rounding of the input does not explain it.
fn headline(shown: &[(&Sweep, usize)], names: &[&str]) -> String {
    let worst = |name: &str| {
        let of_grid = |(sweep, number): &(&Sweep, usize)| {
            let own = sweep.family.variants.iter().position(|variant| variant.name == name)?;
            let beyond = |(case, _): (&Case, _)| {
                let error = case.deviations[own].map_or(0.0, |d| d.relative);
                (error > 2.0 * case.condition.max(1.0) * ROUNDING).then_some(error)
            };
            cases(sweep, *number).filter_map(beyond).reduce(f64::max)
        };
        shown.iter().filter_map(of_grid).reduce(f64::max)
    };
    let told = |name: &&str| {
        let size = match worst(name) {
            None => "nowhere".into(),
            Some(error) if error >= 1.0 => "by 100 % or more".to_owned(),
            Some(error) if error >= 1e-3 => format!("by up to {} %", rounded(100.0 * error, 2)),
            Some(error) => format!("by up to {}", power_of_ten(error).replace("≈ ", "")),
        };
        format!("the {} is off {size}", formula(name))
    };
    let told: Vec<String> = names.iter().map(told).collect();
    format!("Beyond what rounding of the input explains in f32, {}", told.join(", "))
}

/// The number of panels in a row, from 3 to [`MOST_COLUMNS`], that leaves the fewest places empty, in at most [`MOST_ROWS`].
fn columns(panels: usize) -> usize {
    let fits = |columns: &usize| panels.div_ceil(*columns) <= MOST_ROWS;
    let empty = |columns: &usize| panels.next_multiple_of(*columns) - panels;
    (3..=MOST_COLUMNS).rev().filter(fits).min_by_key(empty).unwrap_or(MOST_COLUMNS)
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
    capitalized(&format!("{}\n{title}", in_words(sweep.family.name)))
}

/// The largest errors of one grid along one of its axes.
fn panel(sweep: &Sweep, number: usize, names: &[&'static str]) -> Panel {
    let (Scale { label, from, to }, curves) = curves(sweep, number, names);
    let within = |(at, error): &(f64, f64)| [*at, error.clamp(SCALE[0], SCALE[1])];
    let ends = [SCALE[0] / 3.0, SCALE[1] * 3.0];
    let error = Axis::log(ERROR).range(ends[0], ends[1]);
    let beyond = |low: f64, high: f64| [[*from, low, high], [*to, low, high]];
    let label = if *label == "/{α}" { "roughness /{α}" } else { label };
    let panel = Panel::new(Axis::log(label).range(*from, *to), error).title(heading(sweep, number));
    let panel =
        panel.band(BEYOND, theme::INK, beyond(ends[0], SCALE[0])).band("", theme::INK, beyond(SCALE[1], ends[1]));
    // All panels have the same legend
    std::iter::once(&INPUT_ALONE).chain(names).fold(panel, |panel, &name| {
        let points = curves.iter().find(|(known, _)| *known == name).map_or(&[][..], |(_, points)| points);
        let dash = if name == REPORT { theme::DASHED } else { theme::SOLID };
        let stroke = if name == INPUT_ALONE {
            theme::EXPLAINED_BY_INPUT
        } else {
            Stroke { dash, ..Stroke::solid(look(name).0, theme::LINE) }
        };
        panel.line(formula(name), stroke, points.iter().map(within).collect::<Vec<Point>>())
    })
}

/// The largest error at each place along an axis.
type Curve = (&'static str, Vec<(f64, f64)>);

/// The largest errors of one grid in f32, and what rounding of the input explains of them, along the axis that tells more of where they are.
fn curves<'a>(sweep: &'a Sweep, number: usize, names: &[&'static str]) -> (&'a Scale, Vec<Curve>) {
    let Section { x, y, .. } = &sweep.family.sections[number];
    let error = |name: &str, case: &Case| {
        let variant = sweep.family.variants.iter().position(|variant| variant.name == name);
        variant.and_then(|variant| case.deviations[variant]).map_or(0.0, |d| d.relative)
    };
    let along = |axis: usize, name: &'static str| -> Curve {
        let rounding = |case: &Case| case.condition.max(1.0) * ROUNDING;
        let value = |case: &Case| if name == INPUT_ALONE { rounding(case) } else { error(name, case) };
        let mut values = vec![0.0f64; sweep.side];
        for (case, place) in cases(sweep, number) {
            let at = &mut values[place[axis]];
            *at = at.max(value(case));
        }
        let at = |i| [x, y][axis].at(i, sweep.side);
        (name, values.into_iter().enumerate().map(|(i, error)| (at(i), error)).collect())
    };
    let has = |name: &&&str| sweep.family.variants.iter().any(|variant| variant.name == **name);
    let of = |axis: usize| names.iter().filter(has).map(move |name| along(axis, name));
    // Where the largest errors are smaller on the whole
    let height = |axis: usize| -> f64 {
        of(axis).flat_map(|(_, points)| points).map(|(_, error)| error.clamp(SCALE[0], SCALE[1]).log10()).sum()
    };
    let axis = usize::from(height(1) < height(0));
    ([x, y][axis], std::iter::once(along(axis, INPUT_ALONE)).chain(of(axis)).collect())
}

/// An error of a curve. Field names are the CSV columns.
#[derive(Debug, Clone, Default, Serialize)]
pub struct CurveRow<'a> {
    family: &'a str,
    /// The grid of the family.
    grid: &'a str,
    /// The quantity along the axis, and its value.
    input: String,
    at: f64,
    /// The variant, or "rounding of the input alone".
    variant: &'a str,
    /// The largest relative error in f32 of all inputs of the grid with that value; infinite where a result is not finite.
    relative: f64,
}

/// The curves of all grids, without the ends of the figure's scale.
pub fn curve_rows(sweeps: &[Sweep]) -> Vec<CurveRow<'_>> {
    let grids = sweeps.iter().flat_map(|sweep| sweep.family.sections.iter().enumerate().map(move |grid| (sweep, grid)));
    let mut rows = Vec::new();
    for (sweep, (number, section)) in grids {
        let (scale, curves) = curves(sweep, number, &VARIANTS);
        let (family, grid, input) = (sweep.family.name, section.title, text::plain(scale.label));
        for (variant, points) in curves {
            let row = |(at, relative)| CurveRow { family, grid, input: input.clone(), at, variant, relative };
            rows.extend(points.into_iter().map(row));
        }
    }
    rows
}

/// The variants, in the order of legends of curves.
const VARIANTS: [&str; 3] = [TEXTBOOK, REPORT, STABLE];

/// What a variant is, where a figure stands alone.
fn formula(variant: &str) -> String {
    match variant {
        STABLE => "formula that renders".into(),
        TEXTBOOK => "textbook formula".into(),
        REPORT => "formula of a course report".into(),
        other => other.into(),
    }
}

/// Scale of relative errors in each precision; values outside stand at its ends.
const ERRORS: [(Precision, &str, [f64; 2]); 2] = [
    (Precision::Single, "Single precision (f32)", [1e-9, 1e2]),
    (Precision::Double, "Double precision (f64)", [1e-17, 1e2]),
];
/// Height of a family's line.
const LINE: f64 = 24.0;

/// A panel for each precision, a line for each family, a marker for each variant. Functions at special directions have lines if there is
/// nothing else.
pub fn worst_cases(rows: &[ErrorRow]) -> Drawing {
    let only_special = rows.iter().all(ErrorRow::is_special);
    let is_shown = |row: &&ErrorRow| row.is_compared() && row.is_special() == only_special;
    let rows: Vec<&ErrorRow> = rows.iter().filter(is_shown).collect();
    let mut families: Vec<&str> = Vec::new();
    for row in &rows {
        if !families.contains(&&*row.family) {
            families.push(&row.family);
        }
    }
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
        let x = Axis::log(ERROR).range(ends[0], ends[1]);
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
            panel.markers(formula(variant), look(variant).0, *marker, places)
        })
    };
    let title = match only_special {
        true => "Largest relative error at special directions, indices and widths",
        false => "Largest relative error over all inputs",
    };
    let explained = [
        "pale bar: how far rounding of the input alone may move the result of the formula that renders",
        "no mark: not computed in that precision; grey: off the scale, drawn at its end",
    ];
    let far_out = [
        "Beckmann, sampled: a random number of 0 has an infinite slope, which the code bounds",
        "rough glass: opposite directions along the surface have no half vector, and the code returns a pdf of 0",
    ];
    let lines: Vec<&str> = explained.into_iter().chain(far_out.into_iter().filter(|_| only_special)).collect();
    let plot = Plot::new(ERRORS.map(panel)).frame_size(380.0, LINE * families.len() as f64).draw();
    plot.headed(title, lines.into_iter().map(str::to_owned).collect())
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
        "half-vector" => "half vector of reflection".into(),
        "half-cosine" => "cosine with the half vector of reflection".into(),
        "refraction-half-vector" => "half vector of refraction".into(),
        "refraction-jacobian" => "Jacobian of the half vector of refraction".into(),
        "sphere" => "distance to a sphere".into(),
        "triangle" => "distance to a triangle".into(),
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
        REPORT => (theme::ERRATUM_VARIANT, 0.18),
        STABLE => (theme::STABLE_VARIANT, -0.18),
        _ => (theme::TEXTBOOK_VARIANT, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_remark_is_of_a_family() {
        let names: Vec<&str> = etalon_bench::stability::REGISTRY.iter().map(|family| family.name).collect();
        assert!(REMARKS.iter().all(|(name, _)| names.contains(name)), "{names:?}");
    }
}
