//! A furnace test: the directional albedo over the angle and parameters, and spheres in uniform light.

use super::depth::grid;
use super::text::{LINE, rounded, wrapped};
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Shading};
use etalon_bench::albedo::{Row, Table, is_wrong};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;

/// Pixels across a sphere's image.
const PIXELS: usize = 160;
/// Weights are uneven if one has so many times their mean.
const UNEVEN: f64 = 10.0;
/// Spheres beside the map.
const SPHERES: usize = 4;

/// The table as a map, and below it spheres for some values of the parameters.
pub fn drawing(table: &Table) -> Drawing {
    let spheres = spheres(table);
    let cells: Vec<(String, &Image)> = spheres.iter().map(|(caption, image)| (caption.clone(), image)).collect();
    // Darker, so that radiance above 1 shows, too.
    let title = "Spheres in light of radiance 1 from everywhere";
    Drawing::stacked(vec![map(table), grid(title, SPHERES, -0.5, &cells)], 0.5)
}

fn map(table: &Table) -> Drawing {
    let (columns, rows) = (table.thetas_deg.len(), table.parameters.len());
    // The first row of a heat map is at the top.
    let values: Vec<f64> = table.largest_channels().chunks(columns).rev().flatten().copied().collect();
    let (low, high) = values.iter().fold((1.0f64, 0.0f64), |(low, high), &v| (low.min(v), high.max(v)));
    let low = if high - low < 1e-3 { high - 1e-3 } else { low };
    let map = Heatmap::new(columns, values, Shading::Linear, "directional albedo").range(low, high.max(1.0));
    let name = if table.over.is_empty() { "BSDF".to_owned() } else { table.over.join(" = ") };
    // Each cell is drawn around its value.
    let [across, up] = [ends(&table.thetas_deg, false), ends(&table.parameters, table.is_logarithmic)];
    let axis = if table.is_logarithmic { Axis::log(name) } else { Axis::linear(name) };
    let fixed: Vec<String> = table.fixed.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let title =
        format!("{}, {columns} /{{×}} {rows} cells", [std::slice::from_ref(&table.family), &fixed].concat().join(", "));
    let panel = Panel::new(
        Axis::linear("angle of /{ω}o with the normal (degrees)").range(across[0], across[1]),
        axis.range(up[0], up[1]),
    )
    .title(title)
    .heatmap(map);
    Plot::new([panel]).draw()
}

/// Where the first cell begins and the last ends.
fn ends(values: &[f64], is_logarithmic: bool) -> [f64; 2] {
    let scaled = |v: f64| if is_logarithmic { v.ln() } else { v };
    let (first, last) = (scaled(values[0]), scaled(values[values.len() - 1]));
    let half = if values.len() > 1 { 0.5 * (last - first) / (values.len() - 1) as f64 } else { 0.5 };
    [first - half, last + half].map(|v| if is_logarithmic { v.exp() } else { v })
}

/// Spheres seen from far away. A point of a convex body in uniform light of radiance 1 has the radiance of its directional albedo.
fn spheres(table: &Table) -> Vec<(String, Image)> {
    let (angles, rows) = (table.thetas_deg.len(), table.parameters.len());
    let albedos = table.largest_channels();
    let count = SPHERES.min(rows);
    let numbers = (0..count).map(|i| if count > 1 { i * (rows - 1) / (count - 1) } else { 0 });
    let sphere = |row: usize| {
        let albedos = &albedos[row * angles..(row + 1) * angles];
        let radiance =
            |r: f64| if r < 1.0 { interpolate(&table.thetas_deg, albedos, r.asin().to_degrees()) } else { 1.0 };
        // A pixel's mean over points in it smooths the edge.
        const POINTS: usize = 4;
        let at = |i: usize, k: usize| (i as f64 + (k as f64 + 0.5) / POINTS as f64) / PIXELS as f64 * 2.2 - 1.1;
        let pixel = |x: usize, y: usize| {
            let points = (0..POINTS * POINTS).map(|k| radiance(at(x, k % POINTS).hypot(at(y, k / POINTS))));
            Rgb::splat((points.sum::<f64>() / (POINTS * POINTS) as f64) as f32)
        };
        let value = table.parameters[row];
        let value = if value >= 0.1 { format!("{value:.3}") } else { format!("{value:.1e}") };
        let caption = match table.over.is_empty() {
            true => String::new(),
            false => format!("{} = {value}", table.over.join(" = ")),
        };
        (caption, Image::from_fn(PIXELS, PIXELS, pixel))
    };
    numbers.map(sphere).collect()
}

/// The value at `x` between ascending places.
fn interpolate(places: &[f64], values: &[f64], x: f64) -> f64 {
    let next = places.partition_point(|&place| place < x).clamp(1, places.len().max(2) - 1);
    let Some((&high, &to)) = places.get(next).zip(values.get(next)) else { return values[0] };
    let (low, from) = (places[next - 1], values[next - 1]);
    from + (to - from) * ((x - low) / (high - low)).clamp(0.0, 1.0)
}

/// The indent of what goes on below a value.
const BELOW: &str = "                   ";

/// What a table says, in a few lines.
pub fn text(table: &Table) -> String {
    let Some([least, most]) = table.extremes() else { return String::new() };
    let over = table.over.join(" = ");
    let at = |row: &Row| match over.is_empty() {
        true => format!("at {:.2}°", row.theta_deg),
        false => format!("at {:.2}°, {over} = {:.4}", row.theta_deg, row.parameter),
    };
    let fixed: Vec<String> = table.fixed.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let fixed = if fixed.is_empty() { String::new() } else { format!(" ({})", fixed.join(", ")) };
    let mut text = format!("{}{fixed}\n", table.family) + &wrapped(&found(table), "  ", LINE);
    for (name, row) in [("smallest", least), ("largest", most)] {
        text += &format!("  {:<15}  {:.5} ± {:.1e} {}\n", format!("{name} albedo"), row.albedo, row.error, at(row));
    }
    if let Some(row) = table.with_largest_error() {
        text += &format!("  largest error    {:.1e} {}\n", row.error, at(row));
    }
    let uncertain = table.uncertain().count();
    if let Some(row) = table.with_largest_error().filter(|_| uncertain > 0) {
        text += &format!(
            "  INCONCLUSIVE     {uncertain} of {} albedos have errors above {}",
            table.rows.len(),
            table.wanted_error
        );
        // Weights far above their mean are why
        let weight = row.largest_weight.filter(|weight| *weight > UNEVEN * row.albedo && row.basis != "certified");
        text += &weight.map_or("\n".into(), |weight| {
            format!(
                ": weights are uneven, at {} up to {} where their mean is {}\n",
                at(row).trim_start_matches("at "),
                rounded(weight, 3),
                rounded(row.albedo, 3)
            )
        });
    }
    for (basis, count) in table.bases() {
        let of = if count == table.rows.len() { String::new() } else { format!(" of {count} albedos") };
        let confidence = format!("  confidence       99 % for each error{of}");
        text += &match basis {
            "certified" => format!("{confidence},\n{BELOW}as no weight exceeds what the BSDF declares\n"),
            "exceeded" => wrapped(
                &format!(
                    "{count} albedos with weights BELOW 0 OR ABOVE what the BSDF declares: nothing is known of their errors"
                ),
                "  ",
                LINE,
            ),
            "found" => format!("{confidence},\n{BELOW}if weights are no more uneven than those that were found\n"),
            _ => format!(
                "{confidence},\n{BELOW}if means are normally distributed and no weight is larger\n{BELOW}than those that were found\n"
            ),
        };
    }
    let lost = table.rows.iter().filter(|row| row.lost_by_single_scattering.is_some());
    if let Some(row) = lost.max_by(|a, b| {
        a.lost_by_single_scattering.partial_cmp(&b.lost_by_single_scattering).unwrap_or(std::cmp::Ordering::Equal)
    }) {
        let share = 100.0 * row.lost_by_single_scattering.unwrap_or(0.0);
        text += &format!(
            "  most light lost  {share:.1} % {},\n{BELOW}by a metal that absorbs nothing: single scattering alone\n",
            at(row)
        );
    }
    if let Some(weak) = table.weak_deviation() {
        let verdict =
            if is_wrong(weak) { "D and G1 DO NOT BELONG TOGETHER" } else { "D and G1 belong together at these angles" };
        text += &format!("  weak furnace     1 within {weak:.1e}: {verdict}\n");
    }
    text + &format!("  {:.1} s\n", table.seconds)
}

/// Whether the BSDF is what it declares, in a line.
pub fn found(table: &Table) -> String {
    match (table.violations(), table.above_one()) {
        (0, 0) => "no albedo contradicts what the BSDF declares".to_owned(),
        (0, above) => {
            format!("{above} albedos exceed 1 by more than their own error; none contradicts what the BSDF declares")
        }
        (n, _) => format!(
            "{n} VIOLATIONS: more light than arrives, less from a BSDF that conserves energy, weights above the largest, or values that \
             are not finite"
        ),
    }
}
