//! A furnace test: the directional albedo over the angle and parameters, and spheres in uniform light.

use super::depth::grid;
use super::text::{LINE, rounded, wrapped};
use crate::figure::{Axis, Drawing, Heatmap, Panel, Plot, Point, Shading, Stroke, theme};
use etalon_bench::albedo::{Row, Table, is_wrong};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;

/// Pixels across a sphere's image, which is reduced where there is less room.
const PIXELS: usize = 480;
/// Weights are uneven if one has so many times their mean.
const UNEVEN: f64 = 10.0;
/// Spheres beside the map.
const SPHERES: usize = 4;

/// The table as a map, and below it spheres for some values of the parameters.
pub fn drawing(table: &Table) -> Drawing {
    let spheres = spheres(table);
    let cells: Vec<(String, &Image)> = spheres.iter().map(|(caption, image)| (caption.clone(), image)).collect();
    // Darker, so that radiance above 1 shows, too.
    let title = match cells.len() {
        1 => "A sphere in light of radiance 1 from everywhere",
        _ => "Spheres in light of radiance 1 from everywhere",
    };
    let albedos = if table.parameters.len() > 1 { map(table) } else { curve(table) };
    Drawing::stacked(vec![albedos, grid(title, SPHERES, -0.5, &cells)], 0.5)
}

/// A BSDF in words: what the light comes from.
fn surface(family: &str) -> &str {
    match family {
        "diffuse" => "a diffuse surface",
        "mirror" => "a mirror",
        "refraction" => "a surface that only refracts",
        "dielectric" => "smooth glass",
        "smooth-conductor" => "a smooth metal",
        "beckmann" => "a rough metal (Beckmann)",
        "ggx" => "a rough metal (GGX)",
        "ggx-bounded" => "a rough metal (GGX, bounded normals)",
        "ggx-ndf" => "a rough metal (GGX, all normals)",
        "beckmann-dielectric" => "rough glass (Beckmann)",
        "ggx-dielectric" => "rough glass (GGX)",
        "compensated-beckmann" => "a rough metal with multiple scattering (Beckmann)",
        "compensated-ggx" => "a rough metal with multiple scattering (GGX)",
        "coated-diffuse" => "a diffuse surface under a coat",
        "oren-nayar" => "a rough diffuse surface (Oren–Nayar)",
        "thin-dielectric" => "a thin pane of glass",
        "mixture" => "a mixture of diffuse surface and rough metal",
        "errata-conductor" => "a rough metal of the second report",
        other => other,
    }
}

/// Parameters that have one value, in words.
fn quantity(names: &[String]) -> String {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    match names[..] {
        ["alpha"] | ["alpha_x", "alpha_y"] => "roughness /{α}".into(),
        ["alpha_x"] => "roughness /{α}_{x}".into(),
        ["alpha_y"] => "roughness /{α}_{y}".into(),
        ["eta"] => "/{η}".into(),
        ["k"] => "/{k}".into(),
        ["sigma_deg"] => "/{σ} in degrees".into(),
        _ => names.join(" = "),
    }
}

/// The same beside a value.
fn symbol(names: &[String]) -> String {
    quantity(names).replace("roughness ", "")
}

/// A number in as few digits as tell it.
fn short(value: f64) -> String {
    let text = rounded(value, 3);
    let has_zeros = text.contains('.') && !text.contains('e');
    if has_zeros { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Parameters with their value, in one line.
fn equation(names: &[String], value: f64) -> String {
    format!("{} = {}", symbol(names), short(value)).replace(' ', "\u{a0}")
}

/// What the table has: the surface, and the parameters that do not vary.
fn title(table: &Table) -> String {
    let does =
        if table.thetas_deg.iter().any(|theta| *theta > 90.0) { "reflected or transmitted" } else { "reflected" };
    let one = |name: &str, value: f64| equation(&[name.to_owned()], value);
    let mut fixed: Vec<String> = table.fixed.iter().map(|(name, value)| one(name, *value)).collect();
    if let ([value], false) = (&table.parameters[..], table.over.is_empty()) {
        fixed.insert(0, equation(&table.over, *value));
    }
    let fixed = if fixed.is_empty() { String::new() } else { format!(": {}", fixed.join(", ")) };
    format!("Light {does} by {}{fixed}", surface(&table.family))
}

fn angle_axis([from, to]: [f64; 2]) -> Axis {
    Axis::linear("angle of /{ω}_{o} with the normal (degrees)").range(from, to)
}

/// The albedos of one BSDF over the angle.
fn curve(table: &Table) -> Drawing {
    let albedos = table.largest_channels();
    let points: Vec<Point> = table.thetas_deg.iter().zip(&albedos).map(|(theta, albedo)| [*theta, *albedo]).collect();
    let end = if table.thetas_deg.iter().any(|theta| *theta > 90.0) { 180.0 } else { 90.0 };
    let most = albedos.iter().fold(1.0f64, |most, albedo| most.max(*albedo));
    let panel =
        Panel::new(angle_axis([0.0, end]).every(end / 6.0), Axis::linear("directional albedo").range(0.0, 1.05 * most));
    let panel = panel.title(title(table)).horizontal(1.0, "all light");
    Plot::new([panel.dotted_line("", Stroke::solid(theme::IMPORTANCE_SAMPLING, theme::LINE), points)]).draw()
}

fn map(table: &Table) -> Drawing {
    let columns = table.thetas_deg.len();
    // The first row of a heat map is at the top.
    let values: Vec<f64> = table.largest_channels().chunks(columns).rev().flatten().copied().collect();
    let (low, high) = values.iter().fold((1.0f64, 0.0f64), |(low, high), &v| (low.min(v), high.max(v)));
    let low = if high - low < 1e-3 { high - 1e-3 } else { low };
    let map = Heatmap::new(columns, values, Shading::Linear, "directional albedo").range(low, high.max(1.0));
    // Each cell is drawn around its value.
    let [across, up] = [ends(&table.thetas_deg, false), ends(&table.parameters, table.is_logarithmic)];
    let name = quantity(&table.over);
    let axis = if table.is_logarithmic { Axis::log(name) } else { Axis::linear(name) };
    let panel = Panel::new(angle_axis(across), axis.range(up[0], up[1])).title(title(table)).heatmap(map);
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
    // At equal steps of the parameter: most of a logarithmic table may look alike
    let ends = [table.parameters[0], table.parameters[rows - 1]];
    let number = |i: usize| match count {
        0 | 1 => 0,
        _ => {
            let wanted = ends[0] + (ends[1] - ends[0]) * i as f64 / (count - 1) as f64;
            let off = |row: &usize| (table.parameters[*row] - wanted).abs();
            (0..rows).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        }
    };
    let mut numbers: Vec<usize> = (0..count).map(number).collect();
    numbers.dedup();
    let sphere = |row: usize| {
        let albedos = &albedos[row * angles..(row + 1) * angles];
        let radiance =
            |r: f64| if r < 1.0 { interpolate(&table.thetas_deg, albedos, r.asin().to_degrees()) } else { 1.0 };
        // A pixel's mean over points in it smooths the edge.
        const POINTS: usize = 2;
        let at = |i: usize, k: usize| (i as f64 + (k as f64 + 0.5) / POINTS as f64) / PIXELS as f64 * 2.2 - 1.1;
        let pixel = |x: usize, y: usize| {
            let points = (0..POINTS * POINTS).map(|k| radiance(at(x, k % POINTS).hypot(at(y, k / POINTS))));
            Rgb::splat((points.sum::<f64>() / (POINTS * POINTS) as f64) as f32)
        };
        let value = table.parameters[row];
        let caption = match table.over.is_empty() {
            true => String::new(),
            false => equation(&table.over, value),
        };
        (caption, Image::from_fn(PIXELS, PIXELS, pixel))
    };
    numbers.into_iter().map(sphere).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_bench::validation::families;
    use etalon_stats::bsdf::Family;

    fn table(parameters: usize) -> Table {
        let family = families::all().into_iter().find(|family| family.name() == "ggx").unwrap();
        let request = etalon_bench::albedo::Request {
            over: Vec::new(),
            set: Vec::new(),
            cells: [3, parameters],
            error: 0.05,
            samples: None,
            seed: 1,
        };
        etalon_bench::albedo::albedo_table(&family, &|_| None, &request, &|_| {}).unwrap()
    }

    #[test]
    fn every_bsdf_has_words() {
        families::all().iter().for_each(|family| assert_ne!(surface(family.name()), family.name()));
        assert_eq!([1e-4, 0.0464, 0.5, 1.0].map(short), ["0.0001", "0.0464", "0.5", "1"]);
    }

    #[test]
    fn several_roughnesses_are_a_map_and_one_is_a_curve() {
        let several = drawing(&table(2)).svg();
        for text in ["Light reflected by a rough metal (GGX): ", "Spheres in light of radiance 1 from everywhere"] {
            assert!(several.contains(text), "{text}");
        }
        assert!(!several.contains("alpha_x") && several.contains("0.0001"));
        let one = drawing(&table(1)).svg();
        assert!(one.contains("directional albedo") && one.contains("A sphere in light"), "{one}");
    }
}
