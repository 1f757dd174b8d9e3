//! The second report's glazing on the glass sphere: which of the long paths make it.

use super::claim::{Agreement, Bound, Claim, Finding, Unit, VISIBLE, percent};
use super::deep::{BEYOND, GRAZING_DEG, LongPaths, long_paths};
use super::events::World;
use super::feature::{Place, PlacePicture, Share};
use crate::math::mean_rgb;
use crate::raster::Image;
use crate::scene::Scene;
use crate::study::depth::{DEPTHS, Depths};
use crate::study::object_ids::{Kind, ObjectIdBuffer};

/// Tests whether longer paths brighten the top of the glass sphere, and whether its outside reflects them; also what is seen of them,
/// and how well their light agrees with the renderer's.
pub fn glazing(
    world: &World,
    scene: &Scene,
    depths: &Depths,
    spp: u32,
    seed: u64,
) -> (Vec<Claim>, Option<PlacePicture>, Option<Agreement>) {
    let request = &depths.request;
    let objects = ObjectIdBuffer::new(scene, request);
    // The upper third of the sphere
    let glass = objects.mask(Kind::Glass);
    let rows: Vec<usize> = (0..glass.len()).filter(|&i| glass[i]).map(|i| i / request.width).collect();
    let (Some(&first), Some(&last)) = (rows.first(), rows.last()) else { return (Vec::new(), None, None) };
    let below = first + (last - first) / 3;
    let top: Vec<bool> = glass.iter().enumerate().map(|(i, g)| *g && i / request.width < below).collect();
    let (LongPaths { all, reflected, grazing, internal }, light) = long_paths(world, scene, request, &top, spp, seed);
    let deepest = &depths.images[DEPTHS.len() - 1];
    let there: f64 = deepest.pixels().iter().zip(&top).filter(|(_, t)| **t).map(|(p, _)| mean_rgb(*p)).sum();
    let errors = depths.standard_error.pixels().iter().zip(&top).filter(|(_, t)| **t);
    let error_there = errors.map(|(p, _)| mean_rgb(*p).powi(2)).sum::<f64>().sqrt();
    let everywhere = 1.0 - depths.mean(BEYOND) / depths.mean(DEPTHS[DEPTHS.len() - 1]);
    let share = |what: String, [part, error]: [f64; 2], whole: f64, bound| Finding {
        what,
        value: part / whole,
        error: error / whole,
        unit: Unit::Percent,
        bound,
    };
    let visible = format!(
        "share of longer paths in the light of the sphere's upper third (of the image: {})",
        percent(everywhere)
    );
    let evidence: &'static [&'static str] = &["depth-100", "claims-places"];
    let claims = vec![
        Claim {
            place: "Fig. 1g",
            claim: "Depth 100 adds a glazing on the top of the glass sphere.",
            findings: vec![share(visible, all, there, Bound::AtLeast(everywhere + VISIBLE))],
            evidence,
            ..Claim::default()
        },
        Claim {
            place: "Fig. 1g",
            claim: "The glazing is reflection by the outside near grazing incidence.",
            findings: vec![
                share("share of it that the outside reflects".into(), reflected, all[0], Bound::AtLeast(0.5)),
                share(
                    format!(
                        "share of it that the outside reflects beyond {GRAZING_DEG}° (reflected inside: {})",
                        percent(internal[0] / all[0])
                    ),
                    grazing,
                    all[0],
                    Bound::AtLeast(0.5),
                ),
            ],
            evidence,
            ..Claim::default()
        },
    ];
    let pixels = light.iter().map(|p| p.as_vec3()).collect();
    let columns = (0..top.len()).filter(|&i| top[i]).map(|i| i % request.width);
    let [left, right] = columns.fold([request.width, 0], |[l, r], x| [l.min(x), r.max(x + 1)]);
    let picture = PlacePicture {
        title: "the glazing on the glass sphere",
        word: "more than 5 events".into(),
        depth: DEPTHS[DEPTHS.len() - 1],
        class: Image::from_pixels(request.width, request.height, pixels),
        place: Place { from: [left, first], to: [right, below] },
        share: Share::of([all[0], all[1]], [there, error_there]),
    };
    // The errors of the image are those of all its light.
    let rendered: f64 =
        depths.differences.last().map_or(f64::NAN, |added| sum_over(added.pixels().iter().map(|p| mean_rgb(*p)), &top));
    let name = "light of more than 5 scatterings on the sphere's upper third, event by event minus the renderer";
    let agreement = Agreement { name, z: (all[0] - rendered) / all[1].hypot(error_there) };
    (claims, Some(picture), Some(agreement))
}

/// The sum of the values at the pixels of a mask.
fn sum_over(values: impl Iterator<Item = f64>, mask: &[bool]) -> f64 {
    values.zip(mask).filter(|(_, m)| **m).map(|(v, _)| v).sum()
}
