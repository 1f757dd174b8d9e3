//! Mistakes at a smooth boundary of glass, whose directions are two: reflected and refracted.

use super::fault::PlantedFault;
use etalon_core::errata::fresnel::schlick_incident_cosine;
use etalon_core::optics::{dielectric, schlick};
use etalon_stats::{Atom, Density, Directions, Point, Pole, Sample, Sampler, density, sampler};
use glam::DVec3;

const ETA: f64 = 1.5;

/// What happens to light at the boundary.
#[derive(Clone, Copy)]
struct Boundary {
    /// Directions towards the viewer, and where light is reflected and refracted from.
    reflected: DVec3,
    refracted: DVec3,
    /// Probability of reflection.
    share: f64,
}

impl Boundary {
    /// The truth for a viewer at that angle, inside the glass or outside, on the side z > 0, below the critical angle.
    fn at(degrees: f64, eta: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let cos_t = dielectric::eta_cos_t(cos, eta).map_or(0.0, |g| g / eta);
        Self {
            reflected: DVec3::new(-sin, 0.0, cos),
            refracted: DVec3::new(-sin / eta, 0.0, -cos_t),
            share: dielectric::fresnel(cos, eta).unpolarized(),
        }
    }

    /// Samples by `self`, tested against `truth`.
    fn against(self, truth: Self) -> (impl Sampler, impl Density) {
        let draw = move |u: &[f64]| {
            Some(Sample::atom((if u[0] < self.share { self.reflected } else { self.refracted }).to_array()))
        };
        let atom = |point: DVec3, probability| Atom::new(point.to_array(), probability);
        let atoms = vec![atom(truth.reflected, truth.share), atom(truth.refracted, 1.0 - truth.share)];
        (sampler(1, draw), density(|_: Point| 0.0).with_atoms(atoms))
    }
}

fn planted(name: &'static str, degrees: f64, eta: f64, spoil: fn(&mut Boundary)) -> PlantedFault {
    PlantedFault::of(name, Directions::sphere(Pole::Z), move |faulty| {
        let truth = Boundary::at(degrees, eta);
        let mut boundary = truth;
        if faulty {
            spoil(&mut boundary);
        }
        boundary.against(truth)
    })
}

pub fn faults() -> Vec<PlantedFault> {
    vec![
        planted("bsdf/glass/incident-cosine", 40.0, 1.0 / ETA, |boundary| {
            boundary.share = schlick_incident_cosine(40f64.to_radians().cos(), 1.0 / ETA)
        })
        .mistake(
            "Schlick's polynomial of the incident cosine also inside the glass, 0.04 for 0.25 at 40°: both reports",
        ),
        planted("bsdf/glass/schlick-for-fresnel", 85.0, ETA, |boundary| {
            boundary.share = schlick::schlick(85f64.to_radians().cos(), ETA)
        })
        .mistake("Schlick's approximation as the probability of reflection, weighed as if by Fresnel's equations"),
        planted("bsdf/glass/total-reflection-outside", 60.0, ETA, |boundary| boundary.share = 1.0)
            .mistake("the critical angle looked for on the wrong side: light that enters is totally reflected"),
        planted("bsdf/glass/inverted-index", 30.0, ETA, |boundary| {
            boundary.refracted = Boundary::at(30.0, 1.0 / ETA).refracted
        })
        .mistake("refraction by η where it should be 1/η: the side of the ray mistaken"),
        planted("bsdf/glass/exchanged", 30.0, ETA, |boundary| {
            boundary.share = 1.0 - boundary.share;
        })
        .mistake("refraction chosen as often as light is reflected"),
    ]
}
