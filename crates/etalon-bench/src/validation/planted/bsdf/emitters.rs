//! Mistakes in phase functions and lights.

use super::super::fault::PlantedFault;
use super::faulty::{Change, Faulty, planted, planted_at};
use etalon_stats::bsdf::{Bsdf, BsdfSample, Density, Direction, Hit, Kind, Properties, Spectrum};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

fn vector(w: Direction) -> DVec3 {
    DVec3::from_array(w)
}

/// The direction at this cosine with a unit vector.
fn around(axis: DVec3, cos: f64, turns: f64) -> DVec3 {
    let ((x, y), (s, c)) = (axis.any_orthonormal_pair(), (TAU * turns).sin_cos());
    (1.0 - cos * cos).max(0.0).sqrt() * (c * x + s * y) + cos * axis
}

/// The phase function of Henyey and Greenstein; both directions point away from the place of scattering.
#[derive(Clone, Copy)]
struct Greenstein {
    mean_cosine: f64,
}

impl Greenstein {
    const G: f64 = 0.6;

    fn scattered(&self, wo: Direction, forward: DVec3, u: &[f64]) -> BsdfSample {
        let g = Self::G;
        let cos = (1.0 + g * g - ((1.0 - g * g) / (1.0 - g + 2.0 * g * u[0])).powi(2)) / (2.0 * g);
        let wi = around(forward, cos, u[1]).to_array();
        BsdfSample::new(wi, [1.0; 3], Density::Pdf(self.pdf(wo, wi)))
    }
}

impl Bsdf for Greenstein {
    fn properties(&self) -> Properties {
        let kind = Kind::Phase { wo_points_away: true, mean_cosine: Some(self.mean_cosine) };
        Properties { kind, ..Properties::phase() }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [self.pdf(wo, wi); 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        let g = Self::G;
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g + 2.0 * g * vector(wo).dot(vector(wi))).powf(1.5))
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        Some(self.scattered(wo, -vector(wo), u))
    }
}

/// A square of side 1 that emits to the side of its normal, sampled by area.
#[derive(Clone, Copy)]
struct Panel;

const CORNER: DVec3 = DVec3::new(-0.5, -0.4, 2.0);
const SIDES: [DVec3; 2] = [DVec3::X, DVec3::new(0.0, 0.8, 0.6)];
const NORMAL: DVec3 = DVec3::new(0.0, 0.6, -0.8);
/// Reference points before it and behind it.
const BEFORE: [Direction; 2] = [[0.3, 0.2, 0.5], [-1.5, 2.5, 1.0]];
const BEHIND: [Direction; 1] = [[0.4, -0.5, 3.5]];

impl Panel {
    fn distance(self, from: Direction, wi: Direction) -> Option<f64> {
        let distance = NORMAL.dot(CORNER - vector(from)) / NORMAL.dot(vector(wi));
        let at = vector(from) + distance * vector(wi) - CORNER;
        let is_met = distance > 0.0 && SIDES.iter().all(|side| (0.0..=1.0).contains(&side.dot(at)));
        is_met.then_some(distance)
    }
}

impl Bsdf for Panel {
    fn properties(&self) -> Properties {
        Properties { kind: Kind::Light { hits: true, one_sided: true, points: Vec::new() }, ..Properties::light() }
    }

    fn eval(&self, from: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [if self.pdf(from, wi) > 0.0 { 5.0 } else { 0.0 }; 3]
    }

    fn pdf(&self, from: Direction, wi: Direction) -> f64 {
        let cos = -NORMAL.dot(vector(wi));
        if cos > 0.0 { self.distance(from, wi).map_or(0.0, |r| r * r / cos) } else { 0.0 }
    }

    fn sample(&self, from: Direction, u: &[f64]) -> Option<BsdfSample> {
        let point = CORNER + u[0] * SIDES[0] + u[1] * SIDES[1];
        let to = point - vector(from);
        let pdf = to.length().powi(3) / -NORMAL.dot(to);
        let sample = BsdfSample::new(to.normalize().to_array(), [5.0 / pdf; 3], Density::Pdf(pdf));
        (pdf > 0.0).then_some(BsdfSample { point: Some(point.to_array()), ..sample })
    }

    fn hit(&self, from: Direction, wi: Direction) -> Option<Hit> {
        let hit = |distance| Hit { distance, normal: NORMAL.to_array(), pdf_area: Some(1.0) };
        self.distance(from, wi).map(hit)
    }
}

/// A map whose radiance grows towards a direction, and its samples.
#[derive(Clone, Copy)]
struct Sky;

impl Sky {
    const TOWARDS: DVec3 = DVec3::new(0.8, 0.0, 0.6);
    /// The radiance is 1 + GROWTH cos.
    const GROWTH: f64 = 0.9;
}

impl Bsdf for Sky {
    fn properties(&self) -> Properties {
        Properties::light()
    }

    fn eval(&self, _: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [1.0 + Self::GROWTH * Self::TOWARDS.dot(vector(wi)); 3]
    }

    fn pdf(&self, from: Direction, wi: Direction) -> f64 {
        0.25 * FRAC_1_PI * self.eval(from, wi, &[])[0]
    }

    fn sample(&self, from: Direction, u: &[f64]) -> Option<BsdfSample> {
        let b = Self::GROWTH;
        let cos = (((1.0 - b).powi(2) + 4.0 * b * u[0]).sqrt() - 1.0) / b;
        let wi = around(Self::TOWARDS, cos, u[1]).to_array();
        Some(BsdfSample::new(wi, [4.0 * PI; 3], Density::Pdf(self.pdf(from, wi))))
    }
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::{PdfAndWeight, Sample, Value};
    let right = || Greenstein { mean_cosine: Greenstein::G };
    let phase = |name, change, mistake| planted(name, right, &[30.0, 110.0], change, mistake);
    let panel = |name, places: &[Direction], change, mistake| {
        let make = move |is_faulty: bool| Faulty { right: Panel, change: is_faulty.then_some(change) };
        planted_at(name, make, places.to_vec(), mistake)
    };
    vec![
        phase(
            "whole/phase/sampled-around-z",
            Sample(|m, o, u| Some(m.scattered(o, -DVec3::Z, u))),
            "a lobe sampled around z in place of wo: right along z alone",
        ),
        phase(
            "whole/phase/backward-for-forward",
            Value(|m, o, i| m.pdf(o.map(|x| -x), i)),
            "values for wo along the light, samples for wo that points away",
        ),
        planted_at(
            "whole/phase/mean-cosine-of-the-other-sign",
            move |is_faulty: bool| {
                let mean_cosine = if is_faulty { -Greenstein::G } else { Greenstein::G };
                Faulty { right: Greenstein { mean_cosine }, change: None }
            },
            vec![super::faulty::towards(30.0)],
            "a mean cosine for wo along the light, samples for wo that points away",
        ),
        panel(
            "whole/light/pdf-per-area",
            &BEFORE,
            PdfAndWeight(|m, p, i| f64::from(m.pdf(p, i) > 0.0)),
            "the pdf per area in place of that per solid angle",
        ),
        panel(
            "whole/light/both-sides",
            &BEHIND,
            Value(|m, p, i| m.distance(p, i).map_or(0.0, |_| 5.0)),
            "radiance of both sides of a light that emits to one",
        ),
        panel(
            "whole/light/point-of-other-numbers",
            &BEFORE,
            Sample(|m, p, u| {
                let point = m.sample(p, &[u[1], u[0]])?.point;
                Some(BsdfSample { point, ..m.sample(p, u)? })
            }),
            "a sampled point that is not where the direction leads",
        ),
        panel(
            "whole/light/normal-flipped",
            &BEFORE,
            Change::Hit(|hit| Hit { normal: hit.normal.map(|x| -x), ..hit }),
            "normals to the side that does not emit",
        ),
        planted_at(
            "whole/light/map-rotated",
            |is_faulty| Faulty {
                right: Sky,
                change: is_faulty.then_some(Value(|m: &Sky, p, [x, y, z]| m.eval(p, [-y, x, z], &[])[0])),
            },
            vec![[0.0; 3]],
            "the radiance of a map that is turned by 90°, the pdf and samples of the map as it is",
        ),
    ]
}
