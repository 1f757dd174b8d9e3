//! Regions of a median cut as strata: a region is sampled by its share of the energy, a texel in it by its energy.
//!
//! The pdf of both steps together is that of the whole map, if the regions tile the map and their energies are right.

use super::super::case::Case;
use crate::validation::case::direction_density;
use etalon_core::envmap::EnvMap;
use etalon_core::envmap::cut::{MedianCut, Region, SideRule, Split};
use etalon_core::error::Result;
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_core::sampling::table::{Table1, Table2};
use etalon_stats::{Directions, Pole, Protocol, Sample, examine, sampler};
use glam::DVec3;

/// The cuts of the suite.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (rule, split) in [("energy", Split::Energy), ("variance", Split::Variance)] {
        for regions in [1, 16, 77] {
            cases.push(strata(format!("strata/{rule}/{regions}"), split, regions, ENERGY));
        }
    }
    cases
}

/// The probability of a region, up to a factor.
pub type Share = fn(&Region) -> f64;
/// In proportion to its energy.
pub const ENERGY: Share = |region| region.energy;

/// The test of a number of regions.
pub fn strata(name: String, split: Split, regions: usize, share: Share) -> Case {
    Case::new(name, move |protocol, round| examine_strata(split, regions, share, protocol, round))
}

/// A gradient with a bright spot that no straight line halves.
fn map() -> EnvMap {
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
    let map = map();
    let g = map.geometry();
    let regions = MedianCut::new(&map, split, SideRule::default()).regions(regions)?;
    // Table of the regions, and a table of the texels of each.
    let shares = Table1::new(&regions.iter().map(share).collect::<Vec<_>>());
    let within = |Region { block, .. }: &Region| {
        let energy = |x: usize, y: usize| map.energy(block.x0 + x, block.y0 + y);
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
        (0..g.height()).flat_map(|y| (0..g.width()).map(move |x| (x, y))).map(|(x, y)| map.energy(x, y)).sum();
    let pdf = |wi: DVec3| {
        let (x, y) = g.texel(wi);
        map.mean_rgb(x, y) / total
    };
    let sphere = Directions::sphere(Pole::Y);
    Ok(examine(&sphere, &sampler(3, draw), &direction_density(pdf).with_steps(g.edges()), protocol, round)?)
}
