//! Mistakes in the random numbers that a sampler is fed with: their bits, their ends, their order. Counts in 200 cells hardly
//! show them.

use super::fault::PlantedFault;
use super::hemispheres::polar;
use etalon_stats::stream::CounterRng;
use etalon_stats::{Directions, Line, Pole, Sample, Sampler, density, sampler};
use rand::RngExt;
use std::f64::consts::TAU;

/// Uniform directions of the sphere whose azimuth is made of a random number that `spoil` is done to.
fn azimuth(name: &'static str, spoil: fn(f64) -> f64) -> PlantedFault {
    PlantedFault::of(name, Directions::sphere(Pole::Z), move |faulty| {
        let draw = move |u: &[f64]| {
            let turns = if faulty { spoil(u[1]) } else { u[1] };
            Some(Sample::new(polar(1.0 - 2.0 * u[0], turns).to_array()))
        };
        (sampler(2, draw), density(|_: [f64; 3]| 0.5 / TAU))
    })
}

/// Numbers of a generator of its own, which `draw` makes from a seed.
struct Own<F>(F);

impl<F: Fn(u32, &mut [f64]) + Sync> Sampler for Own<F> {
    fn dimension(&self) -> usize {
        0
    }

    fn sample(&self, _: &[f64], _: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        Err(etalon_stats::Error::external("this sampler takes no random numbers"))
    }

    fn sample_seeded(&self, count: usize, seed: u32, out: &mut Vec<Option<Sample>>) -> etalon_stats::Result<()> {
        let mut numbers = vec![0.0; count];
        (self.0)(seed, &mut numbers);
        out.extend(numbers.into_iter().map(|x| Some(Sample::new(x))));
        Ok(())
    }
}

/// Independent uniform numbers.
fn independent(seed: u32, numbers: &mut [f64]) {
    let mut rng = CounterRng::new(u64::from(seed), 0);
    numbers.iter_mut().for_each(|x| *x = rng.random());
}

/// A generator of uniform numbers on a line.
fn generator(name: &'static str, wrong: fn(u32, &mut [f64])) -> PlantedFault {
    PlantedFault::of(name, Line::UNIT, move |faulty| {
        (Own(if faulty { wrong } else { independent }), density(|_: f64| 1.0))
    })
}

pub fn faults() -> Vec<PlantedFault> {
    vec![
        azimuth("warp/numbers/twelve-bits", |u| (4096.0 * u).floor() / 4096.0)
            .mistake("a random number of 12 bits: directions in 4096 planes only"),
        azimuth("warp/numbers/clamped", |u| u.min(0.999))
            .mistake("random numbers above 0.999 set to 0.999: one in a thousand in one plane"),
        azimuth("warp/numbers/not-to-the-end", |u| 0.999 * u)
            .mistake("azimuths up to 0.999 · 2π: a gap of a third of a degree"),
        generator("warp/numbers/randu", |seed, numbers| {
            let mut x = u64::from(seed | 1);
            numbers.iter_mut().for_each(|u| {
                x = x * 65_539 % (1 << 31);
                *u = x as f64 / f64::from(1u32 << 31);
            });
        })
        .mistake("the generator RANDU, three successive numbers of which lie in 15 planes"),
        generator("warp/numbers/rejected-moves", |seed, numbers| {
            independent(seed, numbers);
            let mut rng = CounterRng::new(u64::from(seed), 1);
            for i in 1..numbers.len() {
                if rng.random::<f64>() < 0.02 {
                    numbers[i] = numbers[i - 1];
                }
            }
        })
        .mistake("a Markov chain taken for independent samples: one move in fifty is rejected and repeats the sample"),
        generator("warp/numbers/random-walk", |seed, numbers| {
            independent(seed, numbers);
            for i in 1..numbers.len() {
                let to = (numbers[i - 1] + 0.5 * (2.0 * numbers[i] - 1.0)).abs();
                numbers[i] = if to > 1.0 { 2.0 - to } else { to };
            }
        })
        .mistake("a random walk with steps of up to half the domain"),
        generator("warp/numbers/seed-ignored", |_, numbers| independent(1, numbers))
            .mistake("a generator that is started anew with the same seed for each batch"),
    ]
}
