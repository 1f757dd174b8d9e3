//! The second report's glazing on the glass sphere: which of the long paths make it.

use super::claim::{Agreement, Bound, Claim, Finding, Unit, VISIBLE, percent};
use super::deep::{BEYOND, GRAZING_DEG, LongPaths, long_paths};
use super::feature::{Place, PlacePicture, View};
use super::share::Share;
use crate::math::mean_rgb;
use crate::raster::Image;
use crate::study::depth::{DEPTHS, Depths};
use crate::study::object_ids::{Kind, ObjectIdBuffer};

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
