//! A map divided into regions of equal energy, with the light that stands for each.

use etalon_core::envmap::EnvMap;
use etalon_core::envmap::cut::{MedianCut, Region, SideRule, Split};
use etalon_core::error::Result;
use glam::DVec3;
use serde::Serialize;

/// Which point of a region its light stands at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Centroid {
    #[default]
    Energy,
    /// The first report's "median pixel": where the region's energy halves in either direction.
    Median,
}

/// One region. Field names are the CSV columns: its texels are \[x0, x1) × \[y0, y1), the centroid is in continuous
/// texel coordinates, the direction is the centroid's, the flux is ∫ L dω, the energy its mean over R, G, B, and r, g, b the mean
/// radiance, flux over solid angle.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct RegionRow {
    /// First column.
    pub x0: usize,
    pub y0: usize,
    /// Column after the last.
    pub x1: usize,
    /// RegionRow after the last.
    pub y1: usize,
    pub centroid_x: f64,
    pub centroid_y: f64,
    pub dir_x: f64,
    /// Direction, y (up).
    pub dir_y: f64,
    pub dir_z: f64,
    pub flux_r: f64,
    pub flux_g: f64,
    pub flux_b: f64,
    /// Mean of the flux.
    pub energy: f64,
    pub solid_angle: f64,
    /// Mean radiance, red.
    pub r: f64,
    /// Mean radiance, green.
    pub g: f64,
    /// Mean radiance, blue.
    pub b: f64,
}

/// Cuts `map` into each of the numbers of regions asked for.
pub fn cut(
    map: &EnvMap,
    counts: &[usize],
    split: Split,
    sides: SideRule,
    centroid: Centroid,
) -> Result<Vec<Vec<RegionRow>>> {
    map.request(MedianCut::bytes(split), "the summed-area tables")?;
    let tables = MedianCut::new(map, split, sides);
    let row = |region: Region| {
        let (x, y) = if centroid == Centroid::Energy { region.centroid } else { region.median };
        let direction = map.geometry().direction(x, y);
        let block = region.block;
        let solid_angle =
            (block.x1 - block.x0) as f64 * (block.y0..block.y1).map(|y| map.geometry().solid_angle(y)).sum::<f64>();
        RegionRow {
            x0: block.x0,
            y0: block.y0,
            x1: block.x1,
            y1: block.y1,
            centroid_x: x,
            centroid_y: y,
            dir_x: direction.x,
            dir_y: direction.y,
            dir_z: direction.z,
            flux_r: region.flux.x,
            flux_g: region.flux.y,
            flux_b: region.flux.z,
            energy: region.energy,
            solid_angle,
            r: region.flux.x / solid_angle,
            g: region.flux.y / solid_angle,
            b: region.flux.z / solid_angle,
        }
    };
    counts.iter().map(|&n| Ok(tables.regions(n)?.into_iter().map(row).collect())).collect()
}

/// |Σ flux of the regions − flux of the map| / flux of the map; 0 for a black map.
pub fn flux_error(rows: &[RegionRow], map_flux: [f64; 3]) -> f64 {
    let map_flux = DVec3::from_array(map_flux);
    let sum: DVec3 = rows.iter().map(|r| DVec3::new(r.flux_r, r.flux_g, r.flux_b)).sum();
    if map_flux.length() > 0.0 { (sum - map_flux).length() / map_flux.length() } else { sum.length() }
}

/// Largest energy of a region over the mean; 1 is a perfect cut. 0 for a black map.
pub fn imbalance(rows: &[RegionRow]) -> f64 {
    let total: f64 = rows.iter().map(|r| r.energy).sum();
    let largest = rows.iter().map(|r| r.energy).fold(0.0, f64::max);
    if total > 0.0 { largest * rows.len() as f64 / total } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::envmap::info::Info;
    use etalon_core::envmap::synthetic::Synthetic;
    use std::f64::consts::PI;

    #[test]
    fn every_built_in_map_keeps_its_flux() {
        for synthetic in Synthetic::ALL {
            let map = EnvMap::new(synthetic.make());
            let flux = Info::of(&map).flux_rgb;
            for centroid in [Centroid::Energy, Centroid::Median] {
                for rows in cut(&map, &[1, 7, 64], Split::Energy, SideRule::default(), centroid).unwrap() {
                    assert!(flux_error(&rows, flux) < 1e-9, "{}", synthetic.name());
                    let sphere: f64 = rows.iter().map(|r| r.solid_angle).sum();
                    assert!((sphere / (4.0 * PI) - 1.0).abs() < 1e-9, "{}: {sphere}", synthetic.name());
                }
            }
        }
    }

    #[test]
    fn the_nave_is_cut_into_similar_energies() {
        let map = EnvMap::new(Synthetic::Nave.make());
        let rows = &cut(&map, &[64], Split::Energy, SideRule::default(), Centroid::Energy).unwrap()[0];
        assert!(imbalance(rows) < 1.5, "{}", imbalance(rows));
    }
}
