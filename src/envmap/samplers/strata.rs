//! Regions of a cut as strata: a region in proportion to its energy, then a direction uniformly within it.
//!
//! Unlike the lights of a cut, which stand at fixed places, such directions reach all of the map, so the estimate has
//! no bias. Regions of equal energy are chosen equally often; with stratified random numbers each gets its share exactly.

use super::contract::{Entry, EnvSample, Method, SurfaceSampler};
use crate::envmap::cut::{MedianCut, SideRule, Split};
use crate::envmap::{Block, EnvMap};
use crate::error::Result;
use crate::sampling::table::Table1;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

/// Its entry in the registry. It is complete: a region that is never sampled has no light.
pub const ENTRY: &Entry = &Entry {
    name: "strata",
    density: "strata",
    doc: "radiance, constant over each of K regions of a median cut",
    has_regions: true,
    complete: true,
    invertible: false,
    bytes_per_texel: MedianCut::bytes(Split::Energy) + size_of::<u32>(),
    method: Method::Directions(|map, regions| Ok(Box::new(StrataSampler::new(map, regions as usize)?))),
};

/// Samples directions by the regions of a median cut.
pub struct StrataSampler {
    map: Arc<EnvMap>,
    regions: Table1,
    strata: Vec<Stratum>,
    /// The region of each texel.
    of_texel: Vec<u32>,
}

/// A region between two meridians and two parallels.
struct Stratum {
    block: Block,
    /// cos θ of its upper edge.
    top: f64,
    /// `top` minus cos θ of its lower edge.
    height: f64,
    /// Pdf per solid angle of its directions.
    pdf: f64,
}

impl StrataSampler {
    /// Cuts the map into `count` regions.
    ///
    /// # Errors
    /// As [`MedianCut::regions`].
    pub fn new(map: Arc<EnvMap>, count: usize) -> Result<Self> {
        let regions = MedianCut::new(&map, Split::Energy, SideRule::default()).regions(count)?;
        let (width, rows) = (map.geometry().width(), map.geometry().height());
        let energies: Vec<f64> = regions.iter().map(|region| region.energy).collect();
        let table = Table1::new(&energies);
        let mut of_texel = vec![0; width * rows];
        let mut strata = Vec::with_capacity(count);
        for (number, region) in regions.iter().enumerate() {
            let Block { x0, x1, y0, y1 } = region.block;
            for y in y0..y1 {
                of_texel[y * width + x0..y * width + x1].fill(number as u32);
            }
            let cos = |y: usize| (PI * y as f64 / rows as f64).cos();
            let (top, height) = (cos(y0), cos(y0) - cos(y1));
            let solid_angle = height * 2.0 * PI * (x1 - x0) as f64 / width as f64;
            strata.push(Stratum { block: region.block, top, height, pdf: table.probability(number) / solid_angle });
        }
        Ok(Self { map, regions: table, strata, of_texel })
    }
}

impl SurfaceSampler for StrataSampler {
    #[inline]
    fn sample_for(&self, u: [f64; 2], normal: DVec3) -> Option<EnvSample> {
        let at = self.regions.sample(u[0])?;
        // Sample cos θ and φ uniformly between the edges of the region.
        let Stratum { block, top, height, .. } = &self.strata[at.cell];
        let cos_theta = (top - u[1] * height).clamp(-1.0, 1.0);
        let sin_theta = (1.0 - cos_theta * cos_theta).sqrt();
        let x = block.x0 as f64 + at.offset * (block.x1 - block.x0) as f64;
        let (sin_phi, cos_phi) = (2.0 * PI * x / self.map.geometry().width() as f64).sin_cos();
        let wi = DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
        Some(EnvSample { wi, pdf: self.pdf_for(wi, normal), radiance: self.map.radiance(wi) })
    }

    fn map(&self) -> &EnvMap {
        &self.map
    }

    fn has_samples(&self) -> bool {
        self.regions.total() > 0.0
    }

    #[inline]
    fn pdf_in_texel(&self, (x, y): (usize, usize), _normal: DVec3) -> f64 {
        self.strata[self.of_texel[y * self.map.geometry().width() + x] as usize].pdf
    }
}
