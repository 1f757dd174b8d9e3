//! What phase functions and lights have beside BSDFs: places for which to test them, the mean cosine, and the geometry of lights.

use super::contract::{BatchBsdf, Density, Direction, Energy, Kind, Pair};
use super::subject::{Comparison, Subject, channel_of, cross, dot, length};
use crate::error::Result;
use crate::examine::{SUSPECT, SampleCount};
use crate::extremes::Extremes;
use crate::hash::{mix64, unit_f64};
use crate::mistakes::{EQUAL, number};
use crate::multiple::sidak;
use crate::outcome::Outcome;
use rand::RngExt;

/// Angles of `wo` to the normal in degrees, and its azimuth as (cos φ, sin φ): in no symmetric position to the tangents, and
/// with all signs of x, y and xy on each side.
const WOS: [(f64, [f64; 2]); 6] = [
    (0.0, [0.8, 0.6]),
    (30.0, [0.8, 0.6]),
    (60.0, [-0.6, -0.8]),
    (85.0, [0.8, -0.6]),
    (110.0, [-0.8, 0.6]),
    (150.0, [0.6, -0.8]),
];
/// Which of these serve for phase functions, whose mistakes are often right along an axis.
const OBLIQUE: [usize; 3] = [1, 3, 5];
/// Directions to which nothing is symmetric, and distances in sizes of the light.
const AROUND: [(&str, f64, [f64; 3]); 6] = [
    ("inside", 0.15, [0.48, -0.6, 0.64]),
    ("near", 1.2, [0.36, 0.48, 0.8]),
    ("oblique", 2.5, [-0.8, 0.36, 0.48]),
    ("below", 3.0, [0.48, 0.36, -0.8]),
    ("across", 5.0, [-0.36, -0.8, -0.48]),
    ("far", 40.0, [0.64, -0.6, 0.48]),
];
/// The same for a light with a front: along two tangents and the normal.
const BEFORE: [(&str, f64, [f64; 3]); 6] = [
    ("near", 0.4, [0.36, -0.48, 0.8]),
    ("front", 2.0, [-0.48, 0.36, 0.8]),
    ("oblique", 2.5, [0.8, -0.592, 0.1]),
    ("far", 40.0, [-0.6, 0.48, 0.64]),
    ("behind", 1.5, [0.36, 0.48, -0.8]),
    (EDGE_ON, 2.5, [-0.6, 0.8, 0.0]),
];
/// The place in the plane of a light, where its solid angle is 0: numbers must be finite there, and no more is asked.
const EDGE_ON: &str = "edge-on";
/// Samples of a light from one place that say where it is.
const SURVEYED: usize = 32;

/// Where something is tested by default, by name: directions `wo`, or reference points of a light. A light with a front is looked at from before,
/// from behind and edge-on, another from all sides, and one at infinity from two points.
///
/// # Errors
/// [`Error::External`](crate::Error::External) from another program.
pub fn places(bsdf: &dyn BatchBsdf) -> Result<Vec<(String, Direction)>> {
    let properties = bsdf.properties();
    let rounded = |w: Direction| {
        if properties.precision < f64::from(f32::EPSILON) { w } else { w.map(|x| f64::from(x as f32)) }
    };
    let named = |(name, w): (String, Direction)| (name, rounded(w));
    let Kind::Light { points, .. } = &properties.kind else {
        let place = |(degrees, [x, y]): (f64, [f64; 2])| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            named((degrees.to_string(), [x * sin, y * sin, cos]))
        };
        return Ok(match properties.kind {
            Kind::Surface => WOS.map(place).to_vec(),
            _ => OBLIQUE.map(|i| place(WOS[i])).to_vec(),
        });
    };
    if !points.is_empty() {
        return Ok(points.iter().enumerate().map(|(i, point)| named((i.to_string(), *point))).collect());
    }
    let surface = survey(bsdf)?;
    if surface.is_empty() {
        return Ok(vec![("here".to_owned(), [0.0; 3]), named(("there".to_owned(), [3.1, -2.3, 5.7]))]);
    }
    let (centre, size) = extent(&surface);
    let normals: Vec<Direction> = surface.iter().filter_map(|(_, normal)| *normal).collect();
    let mean = [0, 1, 2].map(|i| normals.iter().map(|n| n[i]).sum::<f64>() / normals.len().max(1) as f64);
    let (is_open, is_point) = (length(mean) > 0.9, size == 0.0);
    let z = if is_open { unit(mean) } else { [0.0, 0.0, 1.0] };
    let [x, y] = tangents(z);
    let axes = [x, y, z];
    let size = if is_point { 1.0 } else { size };
    let place = |(name, distance, [a, b, c]): (&str, f64, [f64; 3])| {
        let towards = [0, 1, 2].map(|i| a * axes[0][i] + b * axes[1][i] + c * axes[2][i]);
        named((name.to_owned(), moved(centre, towards, size * distance)))
    };
    Ok(if is_open { BEFORE } else { AROUND }
        .map(place)
        .into_iter()
        .filter(|(name, _)| !is_point || name != "inside")
        .collect())
}

/// Whether a place is in the plane of a light.
pub fn is_edge_on(name: &str) -> bool {
    name == EDGE_ON
}

pub fn unit(a: Direction) -> Direction {
    a.map(|x| x / length(a))
}

/// Two unit vectors perpendicular to `z` and to each other.
pub fn tangents(z: Direction) -> [Direction; 2] {
    let x = unit(cross(if z[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }, z));
    [x, cross(z, x)]
}

pub fn moved(from: Direction, towards: Direction, distance: f64) -> Direction {
    [0, 1, 2].map(|i| from[i] + distance * towards[i])
}

/// The middle of the bounding box of points, and half its diagonal.
fn extent(points: &[(Direction, Option<Direction>)]) -> (Direction, f64) {
    let end = |i: usize, of: fn(f64, f64) -> f64| points.iter().map(|(p, _)| p[i]).reduce(of).unwrap_or_default();
    let [low, high] = [f64::at_most as fn(f64, f64) -> f64, f64::at_least].map(|of| [0, 1, 2].map(|i| end(i, of)));
    ([0, 1, 2].map(|i| 0.5 * (low[i] + high[i])), 0.5 * length([0, 1, 2].map(|i| high[i] - low[i])))
}

/// Points of a light with their normals, as it is sampled from all sides; none of a light at infinity.
pub fn survey(bsdf: &dyn BatchBsdf) -> Result<Vec<(Direction, Option<Direction>)>> {
    let mut found = Vec::new();
    let (mut centre, mut size) = ([0.0; 3], 1.0);
    // Where nothing is known of the light, look from far away, too; then from around it.
    for distances in [&[1.0, 30.0, 1000.0][..], &[1.5, 6.0]] {
        let sides = AROUND.iter().flat_map(|(.., [x, y, z])| [[*x, *y, *z], [-x, -y, -z]]);
        let from = sides.flat_map(|side| distances.iter().map(move |by| moved(centre, side, by * size)));
        let wos: Vec<Direction> = from.flat_map(|from| [from; SURVEYED]).collect();
        let dimension = bsdf.properties().dimension;
        let number = |i: usize| unit_f64(mix64(i as u64));
        let samples = bsdf.sample(&wos, &(0..wos.len() * dimension).map(number).collect::<Vec<f64>>())?;
        let (pairs, points): (Vec<Pair>, Vec<_>) =
            wos.iter().zip(samples).filter_map(|(wo, s)| s.map(|s| ([*wo, s.wi], s.point))).unzip();
        let hits = bsdf.hits(&pairs)?;
        for (([wo, wi], point), hit) in pairs.into_iter().zip(points).zip(hits) {
            let point = point.or_else(|| hit.map(|hit| moved(wo, wi, hit.distance)));
            found.extend(point.filter(|p| p.iter().all(|x| x.is_finite())).map(|p| (p, hit.map(|hit| hit.normal))));
        }
        if !found.is_empty() {
            (centre, size) = extent(&found);
            size = if size > 0.0 { size } else { 1.0 };
        }
    }
    Ok(found)
}

/// The mean cosine of a phase function against the declared one; and the mean weight against 1, which is less where light comes from directions
/// that are never sampled.
pub fn mean_cosine(subject: &Subject) -> Result<Option<Outcome>> {
    let Kind::Phase { wo_points_away, mean_cosine } = subject.properties.kind else { return Ok(None) };
    /// What rounding and tables may add.
    const ROUNDING: f64 = 1e-4;
    const BATCH: u64 = 1 << 13;
    let conserved = if let Energy::Conserved(error) = subject.properties.energy { Some((1.0, error)) } else { None };
    let declared = [mean_cosine.map(|g| (g, 0.0)), conserved].into_iter().zip(["cosine", "weight"]).enumerate();
    let declared: Vec<_> = declared.filter_map(|(i, (is, name))| Some((i, is?, name))).collect();
    if declared.is_empty() {
        return Ok(None);
    }
    let count = match subject.protocol.samples {
        SampleCount::Fixed(n) => n,
        SampleCount::Detect(w) => ((30.0 / (w * w)) as u64).clamp(BATCH, 1 << 24),
    };
    let (mut sums, mut squares) = ([0.0; 2], [0.0; 2]);
    for batch in 0..count.div_ceil(BATCH) {
        let mut rng = subject.random(10, batch);
        let n = BATCH.min(count - batch * BATCH) as usize;
        let u: Vec<f64> = (0..n * subject.properties.dimension).map(|_| rng.random::<f64>()).collect();
        for sample in subject.sample(&u)?.into_iter().flatten() {
            let cos = dot(sample.wi, subject.wo) * if wo_points_away { -1.0 } else { 1.0 };
            for (i, x) in [sample.weight[0] * cos, sample.weight[0]].into_iter().enumerate() {
                sums[i] += x;
                squares[i] += x * x;
            }
        }
    }
    let (n, tests) = (count as f64, declared.len());
    let level = sidak(subject.protocol.own_level(), tests);
    let mut found = Outcome { p: Some(1.0), detectable: Some(0.0), ..Outcome::open(count) };
    for (i, (is, known), name) in declared {
        let mean = sums[i] / n;
        let deviation = ((squares[i] / n - mean * mean).at_least(0.0) / (n - 1.0)).sqrt();
        let error = (mean - is).abs() - known - ROUNDING;
        // A single wrong direction may change the mean by 2/n.
        let p = tests as f64 * libm::erfc((error - 2.0 / n).at_least(0.0) / deviation.at_least(1.0 / n) / 2f64.sqrt());
        let detectable = known + ROUNDING + deviation * crate::power::noncentrality(1, level).sqrt();
        found.detectable = found.detectable.map(|largest| largest.at_least(detectable));
        if found.p.is_none_or(|least| least.may_exceed(p)) {
            found.p = Some(p.at_most(1.0));
            let what = || format!("{}: the mean {name} is {mean:.5} ± {deviation:.1e}, not {is}", subject.from());
            found.diagnosis = (p < SUSPECT).then(what);
            let is_opposite = i == 0 && (mean + is).abs() < 5.0 * deviation + ROUNDING && p < SUSPECT;
            found.mistake = is_opposite.then(|| {
                let [is, points] =
                    if wo_points_away { ["away", "along the light"] } else { ["along the light", "away"] };
                let declared = format!("declared is that it points {is}");
                format!("forward and backward are exchanged, as if wo pointed {points}: {declared}").into()
            });
        }
    }
    Ok(Some(found))
}

/// The geometry of a light: sampled points lie where `wi` points to and where the ray meets the light, normals are those of the surface and
/// towards the side that emits, the pdf per solid angle is that per area times r²/cos, radiance does not change along a ray and the
/// light of a point falls with r². Where nothing is sampled, no light comes.
pub fn geometry(subject: &Subject) -> Result<Option<Outcome>> {
    let Kind::Light { hits: has_hits, one_sided, .. } = subject.properties.kind else { return Ok(None) };
    let (bsdf, from, mut found) = (subject.bsdf, subject.wo, Comparison::default());
    let samples = subject.samples_inside()?;
    let wis: Vec<Direction> = samples.iter().map(|(_, sample)| sample.wi).collect();
    let at = |i: usize, what: &str| (Some(wis[i]), format!("{} ({what})", subject.at(wis[i])));
    let pairs = subject.pairs(&wis);
    // What is compared has the roundings of positions, which are larger than those of a direction.
    let far_places = |length: f64, scale: f64| subject.last_places(length.at_least(scale));
    let scale = |point: Direction| length(point) + length(from);
    // Sampled points
    let mut along = Vec::new();
    for (i, (_, sample)) in samples.iter().enumerate() {
        let Some(point) = sample.point.filter(|p| p.iter().all(|x| x.is_finite())) else { continue };
        let to = [0, 1, 2].map(|axis| point[axis] - from[axis]);
        let aside = length(cross(to, sample.wi)) + (length(to) - dot(to, sample.wi)).abs();
        let tolerance = far_places(length(to), scale(point));
        found.holds(aside <= tolerance, || {
            format!("{}: the sampled point is {aside} aside of the ray", subject.at(sample.wi))
        });
        along.push((i, length(to), scale(point)));
    }
    let distance_of = |pairs: &[Pair]| -> Result<Vec<f64>> {
        Ok(bsdf.hits(pairs)?.into_iter().map(|hit| hit.map_or(f64::INFINITY, |hit| hit.distance)).collect())
    };
    // The change of a direction by which slopes are measured
    let step = subject.properties.precision.sqrt();
    if has_hits {
        let spread: Vec<usize> = (0..wis.len()).filter(|&i| !samples[i].1.is_delta()).collect();
        let hits = bsdf.hits(&pairs)?;
        let met: Vec<usize> = spread.iter().copied().filter(|&i| hits[i].is_some()).collect();
        found.all_hold([spread.len() as u64, (spread.len() - met.len()) as u64], || {
            let missed = spread.iter().find(|&&i| hits[i].is_none()).map_or(from, |&i| wis[i]);
            format!("{}: the ray to a sampled point does not meet the light", subject.at(missed))
        });
        let of = |i: usize| hits[i].into_iter();
        let both = along.iter().flat_map(|&(i, r, scale)| of(i).map(move |hit| (i, [hit.distance, r], scale)));
        let both: Vec<(usize, [f64; 2], f64)> = both.collect();
        let numbers: Vec<[f64; 2]> = both.iter().map(|(_, numbers, _)| *numbers).collect();
        let rounding = |far: &[usize]| {
            let (r, pairs): (Vec<f64>, Vec<Pair>) = far.iter().map(|&k| (numbers[k][0], pairs[both[k].0])).unzip();
            subject.rounding(&r, &pairs, distance_of)
        };
        let words = |k: usize| at(both[k].0, "distance by the ray, of the sampled point");
        if !found.equal(&numbers, |k| far_places(numbers[k][1], both[k].2), rounding, words)? {
            let is = |power: i32| numbers.iter().all(|[ray, r]| (ray - r.powi(power)).abs() <= EQUAL * ray);
            found.named(is(2).then(|| "the distance by the ray is that of the point squared".to_owned()));
        }
        // Normals, and two directions beside each ray
        let beside = |i: usize| tangents(wis[i]).map(|side| [from, unit(moved(wis[i], side, -step))]);
        let near: Vec<Pair> = met.iter().flat_map(|&i| beside(i)).collect();
        let near_hits = bsdf.hits(&near)?;
        let values = bsdf.eval(&pairs, &[])?;
        let (mut slanted, mut dark, mut lit) = (0, 0, 0);
        for (k, &i) in met.iter().enumerate() {
            let Some(hit) = hits[i] else { continue };
            let is_unit = (length(hit.normal) - 1.0).abs() <= 1e-5;
            found.holds(is_unit, || format!("{}: the normal {:?} is no unit vector", subject.at(wis[i]), hit.normal));
            let there = moved(from, wis[i], hit.distance);
            let is_slanted = [2 * k, 2 * k + 1].into_iter().any(|j| {
                let to = near_hits[j].map_or(there, |other| moved(from, near[j][1], other.distance));
                let edge = [0, 1, 2].map(|axis| to[axis] - there[axis]);
                // Beyond an edge of the light there is another part of it.
                length(edge) < 0.1 * hit.distance && dot(edge, hit.normal).abs() > 0.1 * length(edge)
            });
            slanted += u64::from(is_slanted);
            let is_front = dot(hit.normal, wis[i]) < 0.0;
            let is_lit = values[i][..subject.properties.channels].iter().any(|x| *x > 0.0);
            dark += u64::from(one_sided && is_lit && !is_front);
            lit += u64::from(one_sided && is_lit);
        }
        let all = met.len() as u64;
        let most = u64::from(slanted * 20 > all) * slanted;
        found.all_hold([all, most], || format!("{}: normals are not perpendicular to the surface", subject.from()));
        found.all_hold([lit, dark], || {
            format!("{}: it emits to the side from which its normals point away", subject.from())
        });
        found.named(
            (dark > 0 && dark == lit).then(|| "the normal is flipped, or the light emits to its back".to_owned()),
        );
        // The pdf per area
        let mut numbers = Vec::new();
        let mut of_area = Vec::new();
        for &i in &met {
            let (Some(hit), Density::Pdf(pdf)) = (hits[i], samples[i].1.density) else { continue };
            let cos = dot(hit.normal, wis[i]).abs();
            if let Some(area) = hit.pdf_area.filter(|_| cos > 1e-3) {
                numbers.push([pdf, area * hit.distance * hit.distance / cos]);
                of_area.push((i, hit.distance, cos));
            }
        }
        // Normals of a curved surface turn with the rounding of positions, the more so where rays graze it.
        let quick = |k: usize| {
            let (i, r, cos) = of_area[k];
            let point = moved(from, wis[i], r);
            numbers[k][1] * subject.last_places(1.0) * (100.0 + scale(point) / r) / (cos * cos)
        };
        let words = |k: usize| at(of_area[k].0, "pdf per solid angle, pdf per area · r²/cos");
        if !found.near(&numbers, quick, words)? {
            type OfDistance = fn(f64, f64) -> f64;
            let names: [(&str, OfDistance); 5] = [
                ("the pdf is per area, not per solid angle: the factor r²/cos is missing", |r, c| c / (r * r)),
                ("the pdf lacks the cosine at the light", |_, c| c),
                ("the pdf lacks r²", |r, _| 1.0 / (r * r)),
                ("the pdf has r in place of r²", |r, _| 1.0 / r),
                ("the pdf is multiplied by the cosine at the light, not divided", |_, c| c * c),
            ];
            let ratio = |k: usize| numbers[k][0] / numbers[k][1];
            let is = |of: OfDistance| {
                let first = ratio(0) / of(of_area[0].1, of_area[0].2);
                let same = (0..numbers.len())
                    .all(|k| (ratio(k) / of(of_area[k].1, of_area[k].2) / first - 1.0).abs() <= EQUAL);
                same.then_some(first)
            };
            let factor = |first: f64| match (first - 1.0).abs() <= EQUAL {
                true => String::new(),
                false => format!("; besides, it has a factor of {}", number(first)),
            };
            let named = names.into_iter().find_map(|(name, of)| Some(name.to_owned() + &factor(is(of)?)));
            let constant = || Some(format!("the pdf is {} times that per area · r²/cos", number(is(|_, _| 1.0)?)));
            found.named(named.or_else(constant));
        }
        // Radiance along rays, half way towards the light
        let nearer: Vec<Pair> =
            met.iter().map(|&i| [moved(from, wis[i], 0.5 * hits[i].map_or(0.0, |hit| hit.distance)), wis[i]]).collect();
        let there = bsdf.eval(&nearer, &[])?;
        for channel in 0..subject.properties.channels {
            let numbers: Vec<[f64; 2]> =
                met.iter().zip(&there).map(|(&i, f)| [f[channel], values[i][channel]]).collect();
            let rounding = |far: &[usize]| {
                let (f, pairs): (Vec<f64>, Vec<Pair>) = far.iter().map(|&k| (numbers[k][1], pairs[met[k]])).unzip();
                subject.rounding(&f, &pairs, |pairs| Ok(channel_of(&bsdf.eval(pairs, &[])?, channel)))
            };
            let words = |k: usize| at(met[k], "radiance from half the distance, from here");
            if !found.equal(&numbers, |k| 1e3 * subject.last_places(numbers[k][1]), rounding, words)? {
                let is = |ratio: f64| numbers.iter().all(|[a, b]| (a / b / ratio - 1.0).abs() <= EQUAL);
                found.named(is(4.0).then(|| "the radiance is divided by r²".to_owned()));
            }
        }
    }
    // The light of a point falls with r², that of directions does not.
    for lobe in &subject.deltas {
        let point =
            samples.iter().find(|(_, s)| s.is_delta() && dot(s.wi, lobe.wi) > 1.0 - 1e-6).and_then(|(_, s)| s.point);
        let Some(distance) = point.map(|p| length([0, 1, 2].map(|i| p[i] - from[i]))).filter(|r| r.is_finite()) else {
            continue;
        };
        let there = bsdf.delta_lobes(&[moved(from, lobe.wi, 0.5 * distance)])?.swap_remove(0);
        let throughput = there.first().map_or([f64::NAN; 3], |lobe| lobe.throughput);
        let channels = throughput.into_iter().zip(lobe.throughput).take(subject.properties.channels);
        for (found_there, here) in channels {
            let numbers = [[found_there, 4.0 * here]];
            let words = |_| {
                (Some(lobe.wi), format!("{} (from half the distance, 4 times that from here)", subject.at(lobe.wi)))
            };
            let tolerance = |_| 1e3 * subject.last_places(numbers[0][1]);
            if !found.near(&numbers, tolerance, words)? {
                let ratio = 4.0 * numbers[0][0] / numbers[0][1];
                let power = 0.0 - ratio.log2();
                found.named(Some(format!(
                    "the light of the point falls as r to the power of {}, not -2",
                    number(power)
                )));
            }
        }
    }
    // Where nothing is sampled, no light comes: towards the light, beside what is sampled of it, and all around.
    let mut towards = subject.directions()?;
    let mean = unit([0, 1, 2].map(|axis| wis.iter().map(|wi| wi[axis]).sum::<f64>()));
    towards.extend(wis.iter().map(|&wi| unit([0, 1, 2].map(|axis| mean[axis] + 1.3 * (wi[axis] - mean[axis])))));
    towards.retain(|wi| wi.iter().all(|x| x.is_finite()));
    let pairs = subject.pairs(&towards);
    let (values, pdfs) = (bsdf.eval(&pairs, &[])?, bsdf.pdf(&pairs)?);
    let is_hidden = |i: &usize| {
        let is_lit = values[*i][..subject.properties.channels].iter().any(|x| *x > 0.0);
        (is_lit && pdfs[*i] == 0.0) || (samples.is_empty() && pdfs[*i] > 0.0)
    };
    let hidden: Vec<usize> = (0..towards.len()).filter(is_hidden).collect();
    // Rounding decides on single rays to an edge.
    let count = if hidden.len() > 2 { hidden.len() as u64 } else { 0 };
    found.all_hold([towards.len() as u64, count], || {
        format!("{}: light or a pdf where nothing is sampled", subject.at(hidden.first().map_or(mean, |&i| towards[i])))
    });
    Ok(found.outcome("the geometry of the light"))
}

#[cfg(test)]
mod tests {
    use super::super::contract::{Bsdf, BsdfSample, Hit, Properties, Spectrum};
    use super::super::textbook::{DeltaLight, difference};
    use super::super::{Report, test};
    use super::*;
    use crate::examine::Protocol;
    use std::f64::consts::{PI, TAU};

    /// Henyey's and Greenstein's phase function.
    struct Greenstein {
        g: f64,
        mean_cosine: f64,
        wo_points_away: bool,
        /// The factor of wo in values.
        towards: f64,
        factor: f64,
        is_sampled_along_z: bool,
    }

    const GREENSTEIN: Greenstein = Greenstein {
        g: 0.6,
        mean_cosine: 0.6,
        wo_points_away: true,
        towards: 1.0,
        factor: 1.0,
        is_sampled_along_z: false,
    };

    impl Greenstein {
        fn density(&self, cos: f64) -> f64 {
            let g = self.g;
            (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
        }

        fn forward(&self, wo: Direction) -> Direction {
            wo.map(|x| if self.wo_points_away { -x } else { x })
        }
    }

    impl Bsdf for Greenstein {
        fn properties(&self) -> Properties {
            let kind = Kind::Phase { wo_points_away: self.wo_points_away, mean_cosine: Some(self.mean_cosine) };
            Properties { kind, ..Properties::phase() }
        }

        fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
            [self.factor * self.density(self.towards * dot(self.forward(wo), wi)); 3]
        }

        fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
            self.density(dot(self.forward(wo), wi))
        }

        fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
            let g = self.g;
            let cos = (1.0 + g * g - ((1.0 - g * g) / (1.0 - g + 2.0 * g * u[0])).powi(2)) / (2.0 * g);
            let (sin, phi) = ((1.0 - cos * cos).max(0.0).sqrt(), TAU * u[1]);
            let z = if self.is_sampled_along_z { [0.0, 0.0, -1.0] } else { self.forward(wo) };
            let [x, y] = tangents(z);
            let wi = [0, 1, 2].map(|i| sin * (phi.cos() * x[i] + phi.sin() * y[i]) + cos * z[i]);
            let pdf = Bsdf::pdf(self, wo, wi);
            Some(BsdfSample::new(wi, Bsdf::eval(self, wo, wi, &[]).map(|f| f / pdf), Density::Pdf(pdf)))
        }
    }

    /// A disk that emits to the side of its normal, by parts of what it answers; `of` is its distance and cosine.
    struct Disk {
        pdf: fn(f64, f64) -> f64,
        weight: fn(f64, f64) -> f64,
        radiance: fn(f64, f64) -> f64,
        normal: f64,
        is_two_sided: bool,
        aside: f64,
    }

    const DISK: Disk = Disk {
        pdf: |_, _| 1.0,
        weight: |_, _| 1.0,
        radiance: |_, _| 1.0,
        normal: 1.0,
        is_two_sided: false,
        aside: 0.0,
    };
    const CENTRE: Direction = [1.0, -2.0, 3.0];
    const NORMAL: Direction = [0.48, 0.6, -0.64];
    const RADIUS: f64 = 0.7;
    const AREA: f64 = PI * RADIUS * RADIUS;
    const RADIANCE: f64 = 5.0;

    impl Disk {
        /// Distance and cosine.
        fn met(&self, from: Direction, wi: Direction) -> Option<[f64; 2]> {
            let cos = -dot(NORMAL, wi);
            let distance = dot(NORMAL, difference(CENTRE, from)) / -cos;
            let is_met = distance > 0.0 && length(difference(moved(from, wi, distance), CENTRE)) <= RADIUS;
            is_met.then_some([distance, cos])
        }
    }

    impl Bsdf for Disk {
        fn properties(&self) -> Properties {
            Properties { kind: Kind::Light { hits: true, one_sided: true, points: Vec::new() }, ..Properties::light() }
        }

        fn hit(&self, from: Direction, wi: Direction) -> Option<Hit> {
            let normal = NORMAL.map(|x| self.normal * x);
            self.met(from, wi).map(|[distance, _]| Hit { distance, normal, pdf_area: Some(1.0 / AREA) })
        }

        fn eval(&self, from: Direction, wi: Direction, _: &[f64]) -> Spectrum {
            let met = self.met(from, wi).filter(|[_, cos]| *cos > 0.0 || self.is_two_sided);
            [met.map_or(0.0, |[r, cos]| RADIANCE * (self.radiance)(r, cos)); 3]
        }

        fn pdf(&self, from: Direction, wi: Direction) -> f64 {
            let met = self.met(from, wi).filter(|[_, cos]| *cos > 0.0);
            met.map_or(0.0, |[r, cos]| r * r / (AREA * cos) * (self.pdf)(r, cos))
        }

        fn sample(&self, from: Direction, u: &[f64]) -> Option<BsdfSample> {
            let x = unit(cross([1.0, 0.0, 0.0], NORMAL));
            let (y, r, phi) = (cross(NORMAL, x), RADIUS * u[0].sqrt(), TAU * u[1]);
            let point = [0, 1, 2].map(|i| CENTRE[i] + r * (phi.cos() * x[i] + phi.sin() * y[i]));
            let to = difference(point, from);
            let (wi, r, cos) = (unit(to), length(to), -dot(NORMAL, unit(to)));
            let pdf = r * r / (AREA * cos) * (self.pdf)(r, cos);
            let weight = [RADIANCE * (self.radiance)(r, cos) * (self.weight)(r, cos) / pdf; 3];
            let point = Some(moved(point, x, self.aside));
            (cos > 0.0).then(|| BsdfSample { point, ..BsdfSample::new(wi, weight, Density::Pdf(pdf)) })
        }
    }

    /// A point whose light falls with a power of the distance.
    fn point_light(power: i32) -> impl BatchBsdf {
        DeltaLight(move |from| {
            let to = difference(CENTRE, from);
            let weight = [2.0 * length(to).powi(-power); 3];
            Some(BsdfSample { point: Some(CENTRE), ..BsdfSample::new(unit(to), weight, Density::Delta(1.0)) })
        })
    }

    fn report(subject: &dyn BatchBsdf, seed: u64) -> Report {
        let usual = places(subject).unwrap().into_iter().filter(|(name, _)| !is_edge_on(name));
        let samples = SampleCount::Detect(0.05);
        test(
            "subject",
            subject,
            &usual.map(|(_, wo)| wo).collect::<Vec<_>>(),
            &Protocol { seed, samples, ..Protocol::default() },
        )
        .unwrap()
    }

    /// What the exact checks find at all places.
    fn exact(subject: &dyn BatchBsdf) -> String {
        let mut found = String::new();
        for (name, wo) in places(subject).unwrap().iter().filter(|(name, _)| !is_edge_on(name)) {
            for check in super::super::ALL.iter().filter(|check| !check.is_statistical) {
                let outcome = check.examine(subject, *wo, &Protocol::default(), 0).unwrap().unwrap_or_default();
                let said = outcome.reason().unwrap_or_default();
                if !said.is_empty() {
                    found += &format!("{}/{name}: {said}\n", check.name);
                }
            }
        }
        found
    }

    #[test]
    fn right_phase_functions_and_lights_are_accepted() {
        let along = Greenstein { wo_points_away: false, ..GREENSTEIN };
        for subject in [&GREENSTEIN as &dyn BatchBsdf, &along, &DISK, &point_light(2)] {
            assert_eq!(exact(subject), "");
        }
        let report = report(&Greenstein { g: -0.3, mean_cosine: -0.3, ..GREENSTEIN }, 1);
        assert!(report.is_accepted() && report.checks.len() > 10, "{report}");
    }

    #[test]
    fn mistakes_of_phase_functions_are_named() {
        let right = GREENSTEIN;
        let wrong = [
            (Greenstein { towards: -1.0, ..right }, "forward and backward are exchanged"),
            (
                Greenstein { mean_cosine: -0.6, ..right },
                "forward and backward are exchanged, as if wo pointed along the light",
            ),
            (Greenstein { mean_cosine: 0.5, ..right }, "the mean cosine is"),
            (Greenstein { factor: 2.0, ..right }, "the integral over the sphere is"),
            (Greenstein { is_sampled_along_z: true, ..right }, "sampling"),
        ];
        for (wrong, words) in wrong {
            let report = report(&wrong, 1).to_string();
            assert!(report.contains(" reject") && report.contains(words), "{words}: {report}");
        }
    }

    #[test]
    fn mistakes_of_lights_are_named() {
        let wrong = [
            (Disk { pdf: |_, cos| cos, ..DISK }, "the pdf lacks the cosine at the light"),
            (Disk { pdf: |r, _| 1.0 / (r * r), ..DISK }, "the pdf lacks r²"),
            (Disk { pdf: |r, cos| cos / (r * r), ..DISK }, "the pdf is per area, not per solid angle"),
            (Disk { pdf: |_, _| 0.5, ..DISK }, "the pdf is 0.5 = 1/2 times that per area · r²/cos"),
            (Disk { weight: |_, cos| cos, ..DISK }, "times the cosine at the light"),
            (Disk { radiance: |r, _| 1.0 / (r * r), ..DISK }, "the radiance is divided by r²"),
            (Disk { normal: -1.0, ..DISK }, "the normal is flipped, or the light emits to its back"),
            (Disk { is_two_sided: true, ..DISK }, "light or a pdf where nothing is sampled"),
            (Disk { aside: 0.01, ..DISK }, "aside of the ray"),
        ];
        for (wrong, words) in wrong {
            let report = exact(&wrong);
            assert!(report.contains(words), "{words}: {report}");
        }
        for power in [0, 1] {
            let report = exact(&point_light(power));
            assert!(report.contains(&format!("falls as r to the power of {}", -power)), "{report}");
        }
    }
}
