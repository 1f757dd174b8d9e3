//! Samplers with weights: right ones and wrong ones, level and power, stochastic pdfs.

use crate::SamplerFn;
use crate::prelude::*;

/// Resampled importance sampling on the interval from 0 to 1: one of `M` uniform candidates, chosen by the target function `p`, with the
/// weight Σ wᵢ/(`divisor` p).
fn resampled<const M: usize>(p: fn(f64) -> f64, divisor: f64) -> impl Sampler {
    sampler(M + 1, move |u| {
        let weights: [f64; M] = std::array::from_fn(|i| p(u[i]));
        let sum: f64 = weights.iter().sum();
        let mut left = u[M] * sum;
        let chosen = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        })?;
        Some(Sample::with_weight(u[chosen], sum / (divisor * p(u[chosen]))))
    })
}

/// Samples of density 2x whose weights vary by a factor that is random.
fn noisy(noise: fn(f64) -> f64) -> SamplerFn<impl Fn(&[f64]) -> Option<Sample> + Sync, crate::NoInverse> {
    sampler(2, move |u| {
        let x = (1.0 - u[0]).sqrt();
        Some(Sample::with_weight(x, noise(u[1]) / (2.0 * x)))
    })
}

fn outcome(sampler: &dyn Sampler, of: &dyn Density, samples: Option<u64>, seed: u64) -> Outcome {
    let samples = samples.map_or(Protocol::default().samples, SampleCount::Fixed);
    validate(&Line::UNIT, sampler, of, &Protocol { samples, seed, ..Protocol::default() }).unwrap()
}

fn one() -> impl Density {
    target(|_: f64| 1.0)
}

fn ramp(x: f64) -> f64 {
    x + 0.1
}

fn peak(x: f64) -> f64 {
    0.1 + (-0.5 * ((x - 0.5) / 0.1f64).powi(2)).exp()
}

/// Two reservoirs, of candidates below ¾ and above ¼, merged: by weights with the number of all candidates, which is biased where one
/// cannot have the sample (RTXDI before its bias correction), or with those that can.
fn merged(is_right: bool) -> impl Sampler {
    sampler(3, move |u| {
        let [a, b] = [0.75 * u[0], 0.25 + 0.75 * u[1]];
        // Weights of the reservoirs: 1/pdf = ¾; both have one candidate
        let (x, sum) = if u[2] < 0.5 { (a, 2.0 * 0.75) } else { (b, 2.0 * 0.75) };
        let able = if !is_right || (0.25..0.75).contains(&x) { 2.0 } else { 1.0 };
        Some(Sample::with_weight(x, sum / able))
    })
}

#[test]
fn weights_of_right_samplers_are_accepted_and_wrong_normalizations_are_not() {
    let verdict = |sampler: &dyn Sampler| {
        let found = outcome(sampler, &one(), None, 1);
        (found.verdict, found.reason().unwrap_or_default())
    };
    assert_eq!(verdict(&resampled::<8>(peak, 8.0)), (Verdict::Accept, String::new()));
    assert_eq!(verdict(&merged(true)), (Verdict::Accept, String::new()));
    let (wrong, why) = verdict(&resampled::<8>(peak, 7.0));
    assert!(wrong == Verdict::Reject && why.contains("1.14"), "{why}");
    let (wrong, why) = verdict(&merged(false));
    assert!(wrong == Verdict::Reject && why.contains("weight"), "{why}");
    // The target itself, in place of 1
    let weighed = sampler(1, |u| Some(Sample::with_weight(u[0], peak(u[0]))));
    assert!(outcome(&weighed, &target(peak), None, 1).is_accepted());
    // No samples where the target is not 0
    let half = sampler(1, |u| Some(Sample::with_weight(0.5 * u[0], 0.5)));
    assert_eq!(verdict(&half).0, Verdict::Reject);
    let found = outcome(&half, &target(|x: f64| if x < 0.5 { 1.0 } else { 0.0 }), None, 1);
    assert!(found.is_accepted(), "{found}");
}

#[test]
fn variances_are_told_and_weights_without_one_are_inconclusive() {
    // ∫ (1 + 1/12)/(2x) is infinite; that of weights x and 1/x is known
    let known = sampler(1, |u| Some(Sample::with_weight(u[0], 2.0 * u[0])));
    let found = outcome(&known, &target(|x: f64| 2.0 * x), None, 1).variance_of_weights.unwrap();
    assert!((found.value - 1.0 / 3.0).abs() < 2.0 * found.half_width && found.half_width < 0.01, "{found:?}");
    let pareto = noisy(|u| 1.0 / 3.0 * (1.0 - u).powf(-2.0 / 3.0));
    let found = outcome(&pareto, &one(), None, 1);
    assert!(found.verdict == Verdict::Inconclusive && found.reason().unwrap().contains("trusted"), "{found}");
}

#[test]
fn stochastic_pdfs_are_compared_in_the_mean() {
    // An estimate by a random number of the place; what samples carry has another one.
    let noise = |x: f64, salt: f64| 2.0 * ((x * 7919.0 + salt).sin() * 43_758.545_3).rem_euclid(1.0);
    let linear = |factor: f64| {
        sampler(2, move |u| {
            let x = (1.0 - u[0]).sqrt();
            Some(Sample::with_pdf(x, factor * 2.0 * x * noise(u[1], 3.0)))
        })
    };
    let of = |slope: f64| density(move |x: f64| (1.0 - slope + 2.0 * slope * x) * noise(x, 0.0)).stochastic();
    let right = outcome(&linear(1.0), &of(1.0), None, 1);
    assert!(right.is_accepted() && right.detectable.unwrap() < 0.05, "{right}");
    let wrong = outcome(&linear(1.1), &of(1.0), None, 1);
    assert!(wrong.verdict == Verdict::Reject && wrong.reason().unwrap().contains("carry"), "{wrong}");
    assert_eq!(outcome(&linear(1.0), &of(0.8), None, 1).verdict, Verdict::Reject);
}

#[test]
fn weights_and_stochastic_pdfs_in_many_dimensions() {
    let volume = named("box:0,1,0,1,0,1").unwrap();
    let tested =
        |sampler: &dyn Sampler, of: &dyn Density| validate(&*volume, sampler, of, &Protocol::default()).unwrap();
    // One of two candidates, by the product of ramps
    let resampled = |exponent: f64| {
        sampler(7, move |u| {
            let [a, b] = [&u[..3], &u[3..6]];
            let of = |point: &[f64]| point.iter().map(|x| ramp(*x)).product::<f64>();
            let (sum, chosen) = (of(a) + of(b), if u[6] * (of(a) + of(b)) < of(a) { a } else { b });
            Some(Sample::with_weight(Point::of(chosen)?, 0.5 * sum / of(chosen).powf(exponent)))
        })
    };
    let one = target(|_: Point| 1.0);
    let found = tested(&resampled(1.0), &one);
    assert!(found.is_accepted() && found.detectable.unwrap() < 0.1, "{found}");
    assert_eq!(tested(&resampled(0.9), &one).verdict, Verdict::Reject);

    let cubes = sampler(3, |u| Point::of(&[u[0].sqrt(), u[1], u[2]]).map(Sample::new));
    let of = |noise: f64| {
        density(move |point: Point| {
            let x = point.coordinates()[0];
            2.0 * x.powf(noise) * 2.0 * ((x * 7919.0).sin() * 43_758.545_3).rem_euclid(1.0)
        })
    };
    assert!(tested(&cubes, &of(1.0).stochastic()).is_accepted());
    assert_eq!(tested(&cubes, &of(1.2).stochastic()).verdict, Verdict::Reject);
    let narrow = of(1.0).with_narrow(vec![[[0.5; 2]; 2]]);
    assert!(validate(&*volume, &cubes, &narrow, &Protocol::default()).is_err());
}

/// The share of seeds for which a sampler is rejected, and the error that was to be detected.
fn rejected(sampler: &dyn Sampler, samples: Option<u64>, seeds: u64) -> [f64; 2] {
    let found: Vec<Outcome> = (1..=seeds).map(|seed| outcome(sampler, &one(), samples, seed)).collect();
    let share = |verdict| found.iter().filter(|found| found.verdict == verdict).count() as f64 / seeds as f64;
    println!("  {samples:?}: rejected {}, inconclusive {}", share(Verdict::Reject), share(Verdict::Inconclusive));
    let detectable = found.iter().filter_map(|found| found.detectable).sum::<f64>() / seeds as f64;
    [share(Verdict::Reject), detectable]
}

#[test]
#[ignore = "minutes: thousands of tests"]
fn level_and_power_are_as_stated_with_few_and_many_samples() {
    let exponential = |u: f64| -(1.0 - u).ln();
    let lognormal = |u: f64| {
        let z = statrs::distribution::ContinuousCDF::inverse_cdf(&statrs::distribution::Normal::standard(), u);
        (z - 0.5).exp()
    };
    let right: [(&str, Box<dyn Sampler>); 9] = [
        ("ramp", Box::new(resampled::<4>(ramp, 4.0))),
        ("peak", Box::new(resampled::<16>(peak, 16.0))),
        ("steep", Box::new(resampled::<2>(|x| 10f64.powf(-4.0 * x), 2.0))),
        ("one candidate", Box::new(resampled::<1>(ramp, 1.0))),
        ("merged", Box::new(merged(true))),
        ("exponential", Box::new(noisy(exponential))),
        ("lognormal", Box::new(noisy(lognormal))),
        ("often 0", Box::new(noisy(|u| if u < 0.1 { 10.0 } else { 0.0 }))),
        ("Pareto", Box::new(noisy(|u| 1.0 / 3.0 * (1.0 - u).powf(-2.0 / 3.0)))),
    ];
    for (name, sampler) in &right {
        println!("{name}");
        for (samples, seeds) in [(Some(2_000), 1000), (Some(50_000), 300), (None, 100)] {
            let [share, _] = rejected(&**sampler, samples, seeds);
            // 99.9 % of right tests at 1 % are within this limit
            let limit = 0.01 + 3.1 * (0.01 * 0.99 / seeds as f64).sqrt() + 1.0 / seeds as f64;
            assert!(share <= limit, "{name} {samples:?}: {share}");
        }
    }
    for samples in [20_000, 200_000] {
        let [_, error] = rejected(&resampled::<4>(ramp, 4.0), Some(samples), 100);
        let [share, _] = rejected(&resampled::<4>(ramp, 4.0 / (1.0 + error)), Some(samples), 300);
        println!("  an error of {error:.4} is found in {share:.3}");
        assert!(share > 0.82, "{samples}: an error of {error} is found in {share}");
    }
}
