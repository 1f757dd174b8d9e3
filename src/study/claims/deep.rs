//! The light of long paths on the glass sphere: by what happens where the eye's ray first meets it.

use super::events::Event;
use super::feature::View;
use crate::sampling::stream::{Independent, Stream};
use glam::DVec3;
use rayon::prelude::*;

/// Scatterings beyond which a path is long.
pub const BEYOND: u32 = 5;
/// Angle of incidence from which it is called grazing: Brewster's angle of the glass, beyond which reflection rises.
pub const GRAZING_DEG: f64 = 55.4;

/// The light of long paths over the pixels of a mask (mean of the channels), with standard errors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LongPaths {
    /// All of it.
    pub all: [f64; 2],
    /// Reflected outside.
    pub reflected: [f64; 2],
    /// Reflected outside at more than [`GRAZING_DEG`].
    pub grazing: [f64; 2],
    /// Refracted into the sphere and reflected inside at least once.
    pub internal: [f64; 2],
}

/// Events of the longest path.
const LONGEST: u32 = 100;

/// Traces `spp` paths of either kind for each pixel of the mask; also returns the image of all.
pub fn long_paths(view: &View, mask: &[bool], spp: u32) -> (LongPaths, Vec<DVec3>) {
    let pixels: Vec<usize> = (0..mask.len()).filter(|&i| mask[i]).collect();
    let limit = GRAZING_DEG.to_radians().cos();
    // Each sample's light by kind, summed, and the squares.
    let of_pixel = |&i: &usize| {
        let (mut sum, mut squares, mut light) = ([0.0; 4], [0.0; 4], DVec3::ZERO);
        for s in 0..spp {
            let stream = Independent::new(view.seed, i as u64, s);
            let ray = view.ray(i, stream.pair(0));
            let cos = view.world.nearest(&ray).map_or(1.0, |vertex| f64::from(vertex.cos(&ray)));
            let mut sample = [0.0; 4];
            for &first in view.world.first_events(&ray) {
                view.world.path(ray, first, BEYOND + 1..=LONGEST, &stream, |events, value| {
                    let value = value / f64::from(spp);
                    let mean = value.element_sum() / 3.0;
                    light += value;
                    let outside = first == Event::Reflected;
                    let internal = events.iter().take_while(|e| !e.is_diffuse()).any(|e| *e == Event::Internal);
                    let kinds = [true, outside, outside && cos < limit, internal];
                    sample.iter_mut().zip(kinds).for_each(|(sum, is)| *sum += if is { mean } else { 0.0 });
                });
            }
            for k in 0..4 {
                sum[k] += sample[k];
                squares[k] += sample[k] * sample[k];
            }
        }
        (sum, squares, light)
    };
    let results: Vec<_> = pixels.par_iter().map(of_pixel).collect();
    let mut image = vec![DVec3::ZERO; mask.len()];
    let mut totals = [[0.0; 2]; 4];
    for (&i, (sum, squares, light)) in pixels.iter().zip(results) {
        image[i] = light;
        for k in 0..4 {
            totals[k][0] += sum[k];
            totals[k][1] += squares[k];
        }
    }
    let [all, reflected, grazing, internal] = totals.map(|[sum, squares]| [sum, f64::sqrt(squares)]);
    (LongPaths { all, reflected, grazing, internal }, image)
}
