//! How faults that are not those of a sampler or a BSDF are modelled: by the images that they lead to, and by means of estimators.

use super::super::case::Case;
use super::super::planted::PlantedFault;
use super::super::suite::adjoint::equal_means;
use crate::compare::{Answer, Compared, Plan, Side, compare};
use etalon_core::math::Rgb;
use etalon_core::raster::Image;
use etalon_stats::stream::CounterRng;
use etalon_stats::{Outcome, Protocol, SampleCount};
use rand::RngExt;
use std::time::Instant;

fn pair(name: &'static str, case: impl Fn(String, bool) -> Case) -> PlantedFault {
    let faulty = case(format!("museum/{name}"), true);
    PlantedFault { name, mistake: "", faulty, sound: case(format!("twin/{name}"), false) }
}

/// An estimator of three pairs of random numbers, whose mean is compared with that of the right one.
pub fn means(name: &'static str, estimator: fn(bool, [[f64; 2]; 3]) -> f64) -> PlantedFault {
    pair(name, |case, faulty| {
        equal_means(case, [Box::new(move |u| estimator(faulty, u)), Box::new(move |u| estimator(false, u))])
    })
}

/// Size of images in pixels, replicates of each side, and places in a pixel along each axis.
pub const SIZE: [usize; 2] = [48, 32];
const REPLICATES: u64 = 16;
const PLACES: usize = 4;

/// A scene: a ramp with a bright disc. Coordinates in pixels.
pub fn scene([x, y]: [f64; 2]) -> [f64; 3] {
    let [x, y] = [x / SIZE[0] as f64, y / SIZE[1] as f64];
    let disc = (x - 0.65).hypot(0.7 * (y - 0.4)) < 0.15;
    if disc { [0.9, 0.5, 0.3] } else { [0.1 + 0.4 * x, 0.15 + 0.2 * y, 0.3 - 0.2 * x] }
}

/// Images of the radiance that a renderer computes at a place of the image, against right ones, all with independent noise.
pub fn images(name: &'static str, radiance: fn(bool, [f64; 2]) -> [f64; 3]) -> PlantedFault {
    let mean = move |faulty: bool| {
        Image::from_fn(SIZE[0], SIZE[1], |x, y| {
            let place = |i: usize, k: usize| i as f64 + (k as f64 + 0.5) / PLACES as f64;
            let at = |k: usize| radiance(faulty, [place(x, k % PLACES), place(y, k / PLACES)]).map(|v| v as f32);
            (0..PLACES * PLACES).map(|k| Rgb::from_array(at(k))).sum::<Rgb>() / (PLACES * PLACES) as f32
        })
    };
    pair(name, |case, faulty| {
        Case::new(case, move |protocol, round| {
            let start = Instant::now();
            let side = |image: Image, k: u64| {
                let noisy = |i| {
                    let mut rng = CounterRng::new(protocol.seed, (2 * round + k) * REPLICATES + i);
                    image.pixels().iter().map(|rgb| *rgb * (0.75 + 0.5 * rng.random::<f32>())).collect()
                };
                Side::replicates((0..REPLICATES).map(|i| Image::from_pixels(SIZE[0], SIZE[1], noisy(i))).collect())
            };
            let detect = if let SampleCount::Detect(detect) = protocol.samples { detect } else { 0.02 };
            let plan = Plan { level: protocol.own_level(), detect };
            let found = compare(side(mean(faulty), 0), side(mean(false), 1), plan)?;
            Ok(Outcome { seconds: start.elapsed().as_secs_f64(), ..outcome(found, protocol) })
        })
    })
}

/// What `compare` says, as a test among others.
fn outcome(found: Compared, protocol: &Protocol) -> Outcome {
    let least = found.families.iter().filter_map(|family| Some((family, family.worst?, family.adjusted_p?)));
    let worst = least.min_by(|a, b| a.2.total_cmp(&b.2));
    let told = worst.map(|(family, test, _)| {
        let [a, b] = test.means;
        format!("{}, {}: A {a:.4}, B {b:.4}", family.family.name(), found.channels[test.channel])
    });
    let is_open = matches!(found.answer, Answer::CannotTell | Answer::NotIndependent);
    Outcome {
        p: worst.map(|(.., p)| p),
        detectable: found.uniform_bias,
        mistake: found.explanation.map(|explanation| explanation.mistake.into()),
        diagnosis: told.filter(|_| worst.is_some_and(|(.., p)| p < protocol.level)),
        inconclusive_reason: is_open.then(|| "too noisy to tell".to_owned()),
        ..Outcome::open(2 * REPLICATES * (SIZE[0] * SIZE[1]) as u64)
    }
}
