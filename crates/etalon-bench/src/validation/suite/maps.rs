//! Test cases: environment maps, the built-in ones and small ones that find bugs, by every sampler, and regions of a median cut
//! as strata.

use super::super::case::{Case, Shared, direction_density};
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::cut::{MedianCut, Region, SideRule, Split};
use etalon_core::envmap::samplers::{self, Entry, MapSampling, Method, cosine};
use etalon_core::envmap::synthetic::Synthetic;
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::sampling::table::{Table1, Table2};
use etalon_stats::{Directions, Mass, Pole, Protocol, Sample, examine, sampler};
use glam::DVec3;
use std::sync::Arc;

/// A map's name, and a function that returns the map.
type Source = (String, Arc<dyn Fn() -> Arc<EnvMap> + Send + Sync>);

/// A map that is made when it is first needed.
fn source(name: impl Into<String>, make: impl Fn() -> Image + Send + Sync + 'static) -> Source {
    let map = Shared::new();
    (name.into(), Arc::new(move || map.get(|| EnvMap::new(make()))))
}

/// The cases of the built-in maps and of those of this file.
pub fn maps() -> Vec<Case> {
    let mut sources: Vec<Source> = Synthetic::ALL.map(|map| source(map.name(), move || map.make())).into();
    for [width, height] in [[1, 1], [2, 1], [3, 2], [10, 10]] {
        sources.push(source(format!("{width}x{height}"), move || Image::from_fn(width, height, contrasts)));
    }
    for (place, hot) in [("corner", [0, 0]), ("seam", [15, 4]), ("pole", [7, 7]), ("centre", [8, 4])] {
        sources.push(source(format!("onehot-{place}"), move || one_hot(hot)));
    }
    let mut cases: Vec<Case> = sources.iter().flat_map(of).map(|(_, case)| case).collect();
    // With blocks of 16 × 32 texels.
    let large = source("1024x1024", || Image::from_fn(1024, 1024, contrasts));
    cases.push(case(&large, cosine::ENTRY, "cosine-up".into(), DVec3::Y));
    cases
}

/// The cases of a map that the user gives.
pub fn of_map(name: &str, map: Arc<EnvMap>) -> Vec<Case> {
    let texels = map.image().pixels().len();
    of(&(name.to_owned(), Arc::new(move || map.clone())))
        .into_iter()
        .map(|(entry, case)| Case { memory: texels * entry.bytes_per_texel, ..case })
        .collect()
}

/// Dark texels beside bright ones, and one that is brighter by orders of magnitude.
fn contrasts(x: usize, y: usize) -> Rgb {
    match (x * 7 + y * 13) % 5 {
        _ if (x, y) == (2, 1) => Rgb::splat(1e5),
        1 => Rgb::ZERO,
        k => Rgb::new(k as f32 + 1.0, 0.5, 0.1),
    }
}

fn one_hot([x, y]: [usize; 2]) -> Image {
    let mut image = Image::new(16, 8);
    image.set(x, y, Rgb::new(1000.0, 500.0, 250.0));
    image
}

/// Normals of surfaces, with their names in the names of tests.
const NORMALS: [(&str, DVec3); 3] =
    [("up", DVec3::Y), ("down", DVec3::NEG_Y), ("slanted", DVec3::new(0.48, -0.6, 0.64))];

/// A case for every sampler of directions in the registry, for each normal if the sampler depends on that.
fn of(source: &Source) -> Vec<(&'static Entry, Case)> {
    let mut cases = Vec::new();
    for &entry in samplers::ALL {
        match entry.method {
            Method::Directions(_) => cases.push((entry, case(source, entry, entry.name.to_owned(), DVec3::Y))),
            Method::ForNormal(_) => cases.extend(
                NORMALS.map(|(towards, n)| (entry, case(source, entry, format!("{}-{towards}", entry.name), n))),
            ),
            // There are no samples to test.
            Method::FixedLights(_) => {}
        }
    }
    cases
}

/// The directions of one sampler for a surface of that normal.
fn case(source: &Source, entry: &'static Entry, how: String, normal: DVec3) -> Case {
    let (name, get) = source;
    let (name, preparation, get) = (format!("map/{name}/{how}"), get.clone(), get.clone());
    let test = move |protocol: &Protocol, round| {
        let map = get();
        let by = MapSampling::new(entry).sampler(map.clone())?;
        // A black map gives no samples. A sampler by the normal gives none where all that it samples is below the horizon.
        let mass = match entry.method {
            Method::Directions(_) => Mass::Exactly(if is_black(&map) { 0.0 } else { 1.0 }),
            _ => Mass::AtMostOne,
        };
        // Test sampler and pdf, and the inverse if there is one.
        let pdf = direction_density(|wi| by.pdf_for(wi, normal)).with_mass(mass).with_steps(map.geometry().edges());
        let draw = |u: &[f64]| by.sample_for([u[0], u[1]], normal).map(|s| Sample::with_pdf(s.wi.to_array(), s.pdf));
        let (sphere, drawn) = (Directions::sphere(Pole::Y), sampler(2, draw));
        if !entry.invertible {
            return Ok(examine(&sphere, &drawn, &pdf, protocol, round)?);
        }
        let invert = |wi: [f64; 3]| by.invert_for(wi.into(), normal).map_or_else(Vec::new, |u| u.to_vec());
        Ok(examine(&sphere, &drawn.with_inverse(invert), &pdf, protocol, round)?)
    };
    Case { preparation: Some(Box::new(move || drop(preparation()))), ..Case::new(name, test) }
}

fn is_black(map: &EnvMap) -> bool {
    map.image().pixels().iter().all(|p| *p == Rgb::ZERO)
}

pub fn cuts() -> Vec<Case> {
    let mut cases = Vec::new();
    for split in Split::ALL {
        for regions in [1, 16, 77] {
            cases.push(strata(format!("strata/{}/{regions}", split.name()), split, regions, ENERGY));
        }
    }
    cases
}

/// The probability of a region, up to a factor.
pub type Share = fn(&Region) -> f64;
/// In proportion to its energy.
pub const ENERGY: Share = |region| region.energy;

/// The test of a number of regions: a region is sampled by its share, a texel in it by its energy. The pdf of both steps is that of the
/// whole map if the regions tile it and their energies are right.
pub fn strata(name: String, split: Split, regions: usize, share: Share) -> Case {
    Case::new(name, move |protocol, round| examine_strata(split, regions, share, protocol, round))
}

/// A gradient with a bright spot that no straight line halves.
fn spot() -> EnvMap {
    let level =
        |x: usize, y: usize| 0.2 + x as f32 / 64.0 + if x.abs_diff(40) + y.abs_diff(9) < 4 { 60.0 } else { 0.0 };
    EnvMap::new(Image::from_fn(64, 32, |x, y| Rgb::new(level(x, y), 0.3, 0.1 * y as f32)))
}

/// One round of the test of a number of regions.
fn examine_strata(
    split: Split,
    regions: usize,
    share: Share,
    protocol: &Protocol,
    round: u64,
) -> Result<etalon_stats::Outcome> {
    let spot = spot();
    let g = spot.geometry();
    let regions = MedianCut::new(&spot, split, SideRule::default()).regions(regions)?;
    // Table of the regions, and a table of the texels of each.
    let shares = Table1::new(&regions.iter().map(share).collect::<Vec<_>>());
    let within = |Region { block, .. }: &Region| {
        let energy = |x: usize, y: usize| spot.energy(block.x0 + x, block.y0 + y);
        Table2::new(block.x1 - block.x0, block.y1 - block.y0, energy)
    };
    let tables: Vec<Table2> = regions.iter().map(within).collect();
    let draw = |u: &[f64]| {
        let i = shares.sample(u[0])?.cell;
        let (draw, block) = (tables[i].sample([u[1], u[2]])?, regions[i].block);
        let (x, y) = (block.x0 + draw.x.cell, block.y0 + draw.y.cell);
        Some(Sample::new(g.direction_in_texel(x, y, draw.x.offset, draw.y.offset).to_array()))
    };
    // The pdf of the whole map.
    let total: f64 =
        (0..g.height()).flat_map(|y| (0..g.width()).map(move |x| (x, y))).map(|(x, y)| spot.energy(x, y)).sum();
    let pdf = |wi: DVec3| {
        let (x, y) = g.texel(wi);
        spot.mean_rgb(x, y) / total
    };
    let sphere = Directions::sphere(Pole::Y);
    Ok(examine(&sphere, &sampler(3, draw), &direction_density(pdf).with_steps(g.edges()), protocol, round)?)
}
