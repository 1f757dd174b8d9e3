//! The second report's glazing on the glass sphere: which of the long paths make it, by what happens where the eye's ray first meets
//! the sphere.

use super::claim::{Agreement, Bound, Claim, Finding, Share, Unit, VISIBLE, percent};
use super::events::Event;
use super::feature::{Place, PlacePicture, View};
use crate::depth::{DEPTHS, Depths};
use crate::object_ids::{Kind, ObjectIdBuffer};
use etalon_core::math::mean_rgb;
use etalon_core::raster::Image;
use etalon_core::sampling::stream::{Independent, Stream};
use glam::DVec3;
use rayon::prelude::*;

/// Tests whether longer paths brighten the top of the glass sphere, and whether its outside reflects them; also what is seen of them,
/// and how well their light agrees with the renderer's.
pub fn glazing(view: &View, depths: &Depths, spp: u32) -> (Vec<Claim>, Option<PlacePicture>, Option<Agreement>) {
    let request = view.request;
    let objects = ObjectIdBuffer::new(view.scene, request);
    // The upper third of the sphere
    let glass = objects.mask(Kind::Glass);
    let rows: Vec<usize> = (0..glass.len()).filter(|&i| glass[i]).map(|i| i / request.width).collect();
    let (Some(&first), Some(&last)) = (rows.first(), rows.last()) else { return (Vec::new(), None, None) };
    let below = first + (last - first) / 3;
    let top: Vec<bool> = glass.iter().enumerate().map(|(i, g)| *g && i / request.width < below).collect();
    let (LongPaths { all, reflected, grazing, internal }, light) = long_paths(view, &top, spp);
    let light_of = |image: &Image, of: fn(f64) -> f64| sum_over(image.pixels().iter().map(|p| of(mean_rgb(*p))), &top);
    // The light of shorter paths, by the renderer
    let shorter = [light_of(depths.image(BEYOND), |v| v), light_of(&depths.standard_error, |v| v * v).sqrt()];
    let of_all_light = Share::of(all, shorter);
    let everywhere = 1.0 - depths.mean(BEYOND) / depths.mean(DEPTHS[DEPTHS.len() - 1]);
    let share_of_it = |what: String, [part, error]: [f64; 2]| {
        Finding::estimated(what, [part / all[0], error / all[0]], Unit::Percent, Bound::AtLeast(0.5))
    };
    let bound = everywhere + VISIBLE;
    let visible = format!(
        "share of longer paths in the light of the sphere's upper third (of the image: {})",
        percent(everywhere)
    );
    let evidence: &'static [&'static str] = &["depth-100", "claims-places"];
    let claims = vec![
        Claim {
            place: "Fig. 1g",
            claim: "Depth 100 adds a glazing on the top of the glass sphere.",
            findings: vec![Finding::estimated(
                visible,
                [of_all_light.value, of_all_light.error_at(bound)],
                Unit::Percent,
                Bound::AtLeast(bound),
            )],
            evidence,
            ..Claim::default()
        },
        Claim {
            place: "Fig. 1g",
            claim: "The glazing is reflection by the outside near grazing incidence.",
            findings: vec![
                share_of_it("share of it that the outside reflects".into(), reflected),
                share_of_it(
                    format!(
                        "share of it that the outside reflects beyond {GRAZING_DEG}° (reflected inside: {})",
                        percent(internal[0] / all[0])
                    ),
                    grazing,
                ),
            ],
            evidence,
            ..Claim::default()
        },
    ];
    let pixels = light.iter().map(|p| p.as_vec3()).collect();
    let columns = (0..top.len()).filter(|&i| top[i]).map(|i| i % request.width);
    let [left, right] = columns.fold([request.width, 0], |[l, r], x| [l.min(x), r.max(x + 1)]);
    let rendered: f64 = depths.differences.last().map_or(f64::NAN, |added| light_of(added, |v| v));
    // The errors of the image are those of all its light.
    let z = (all[0] - rendered) / all[1].hypot(shorter[1]);
    let picture = PlacePicture {
        title: "the glazing on the glass sphere",
        word: format!("paths of more than {BEYOND} events"),
        depth: DEPTHS[DEPTHS.len() - 1],
        class: Image::from_pixels(request.width, request.height, pixels),
        place: Place { from: [left, first], to: [right, below] },
        share: of_all_light,
        z,
    };
    let name = "light of more than 5 scatterings on the sphere's upper third, event by event minus the renderer";
    (claims, Some(picture), Some(Agreement { name, z }))
}

/// The sum of the values at the pixels of a mask.
fn sum_over(values: impl Iterator<Item = f64>, mask: &[bool]) -> f64 {
    values.zip(mask).filter(|(_, m)| **m).map(|(v, _)| v).sum()
}

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
