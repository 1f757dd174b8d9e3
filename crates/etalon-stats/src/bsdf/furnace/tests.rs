//! Albedos of known weights lie within their bounds.

use super::super::contract::{Bsdf, BsdfSample, Density};
use super::*;

/// Weights as a function of the three random numbers. Of these the first chooses between two lobes of equal probability; the
/// second lobe has no sample where the weight is negative.
struct Weights<F> {
    weight: F,
    largest: Option<f64>,
    map: Option<[usize; 2]>,
    precision: f64,
}

impl<F: Fn(usize, [f64; 2]) -> f64 + Sync> Bsdf for Weights<F> {
    fn properties(&self) -> Properties {
        Properties { largest_weight: self.largest, map: self.map, precision: self.precision, ..Properties::default() }
    }

    fn eval(&self, _: Direction, _: Direction, _: &[f64]) -> Spectrum {
        [0.0; 3]
    }

    fn pdf(&self, _: Direction, _: Direction) -> f64 {
        0.0
    }

    fn sample(&self, _: Direction, u: &[f64]) -> Option<BsdfSample> {
        let lobe = usize::from(u[0] >= 0.5);
        let weight = (self.weight)(lobe, [u[1], u[2]]);
        let sample = BsdfSample::new([0.0, 0.0, 1.0], [weight; 3], Density::Pdf(1.0)).of_lobe(lobe, 0.5);
        (weight >= 0.0).then_some(sample)
    }

    fn lobes(&self) -> usize {
        2
    }
}

const UP: Direction = [0.0, 0.0, 1.0];

fn albedo(bsdf: &dyn BatchBsdf, error: f64, seed: u64) -> Albedo {
    directional_albedo(bsdf, UP, error, &Protocol { seed, ..Protocol::default() }).unwrap()
}

#[test]
fn smooth_weights_of_two_lobes_are_certified() {
    let weight = |lobe: usize, [u, v]: [f64; 2]| {
        if lobe == 0 {
            u * u
        } else if u < 0.25 {
            -1.0
        } else {
            v
        }
    };
    let bsdf = Weights { weight, largest: Some(1.0), map: Some([1, 2]), precision: f64::EPSILON };
    let exact = 0.5 / 3.0 + 0.5 * 0.75 * 0.5;
    for seed in 0..5 {
        let found = albedo(&bsdf, 1e-3, seed);
        assert!(matches!(found.basis, Basis::Certified(w) if (w - 1.0).abs() < 1e-6));
        assert!((found.value[0] - exact).abs() <= found.error[0] && found.error[0] <= 1e-3, "{found:?}");
    }
    let assumed = albedo(&Weights { largest: None, ..bsdf }, 1e-3, 1);
    assert!(
        matches!(assumed.basis, Basis::Found(w) if (0.99..=1.0).contains(&w))
            && (assumed.value[0] - exact).abs() < 1e-3,
        "{assumed:?}"
    );
}

#[test]
fn a_weight_above_the_declared_bound_is_named() {
    let weight = |_: usize, [u, v]: [f64; 2]| if u < 0.01 && v < 0.1 { 1.5 } else { 0.2 };
    let found = albedo(&Weights { weight, largest: Some(1.0), map: Some([1, 2]), precision: f64::EPSILON }, 1e-3, 1);
    assert!(matches!(found.basis, Basis::Exceeded { found, .. } if found == 1.5), "{found:?}");
}

#[test]
fn probabilities_of_lobes_that_are_rounded_do_not_count_a_lobe_twice() {
    // The first lobe's interval is longer than what the samples say.
    struct Rounded;
    impl Bsdf for Rounded {
        fn properties(&self) -> Properties {
            Properties { largest_weight: Some(1.0), ..Properties::default() }
        }
        fn eval(&self, _: Direction, _: Direction, _: &[f64]) -> Spectrum {
            [0.0; 3]
        }
        fn pdf(&self, _: Direction, _: Direction) -> f64 {
            0.0
        }
        fn sample(&self, _: Direction, u: &[f64]) -> Option<BsdfSample> {
            let (lobe, probability) = if u[0] < 0.41 { (0, 0.4) } else { (1, 0.59) };
            Some(BsdfSample::new(UP, [1.0; 3], Density::Pdf(1.0)).of_lobe(lobe, probability))
        }
        fn lobes(&self) -> usize {
            2
        }
    }
    let found = albedo(&Rounded, 1e-3, 1);
    assert!((found.value[0] - 0.99).abs() < 1e-3, "{found:?}");
}

#[test]
fn kinks_edges_and_rare_large_weights_are_within_the_bound() {
    // Edges that no rectangle follows, a steep flank at the border, and weights of 1 in a share of 10⁻³ of the square.
    type Function = fn([f64; 2]) -> f64;
    let functions: [(Function, f64); 3] = [
        (|[u, v]| f64::from(u8::from(u * u + v * v < 1.0)), std::f64::consts::FRAC_PI_4),
        (|[u, _]| (-u / 0.002).exp(), 0.002 * (1.0 - (-500f64).exp())),
        (
            |[u, v]| {
                f64::from(u8::from(
                    ((40.0 * u).fract() - 0.3).hypot((40.0 * v).fract() - 0.7) < 1e-3f64.sqrt() * 0.564_19,
                ))
            },
            1e-3,
        ),
    ];
    for (function, exact) in functions {
        let weight = move |_: usize, at: [f64; 2]| function(at);
        let bsdf = Weights { weight, largest: Some(1.0), map: Some([1, 2]), precision: f64::EPSILON };
        // 3 or more of 20 with a risk of 1 % have a probability of 0.1 %.
        let outside = (0..20).filter(|&seed| {
            let found = albedo(&bsdf, 1e-3, seed);
            assert!(found.error[0] <= 1e-3, "{found:?}");
            (found.value[0] - exact).abs() > found.error[0]
        });
        assert!(outside.count() < 3);
    }
}

#[test]
fn a_spike_between_the_nodes_is_within_the_bound() {
    // It holds 5·10⁻⁴ of the light, on a strip that no node of the rule is in.
    let weight = |_: usize, [u, _]: [f64; 2]| if (0.401..0.402).contains(&u) { 1.0 } else { 0.5 };
    let bsdf = Weights { weight, largest: Some(1.0), map: Some([1, 2]), precision: f64::EPSILON };
    for seed in 0..3 {
        let found = albedo(&bsdf, 1e-4, seed);
        assert!((found.value[0] - 0.5005).abs() <= found.error[0], "{found:?}");
    }
}

#[test]
fn a_white_surface_with_rounded_weights_is_white() {
    // Weights of 1 with roundings of a few last places, all of one sign in half of the cases.
    for (precision, bias) in [f32::EPSILON.into(), f64::EPSILON].into_iter().flat_map(|e: f64| [(e, 0.0), (e, 4.0)]) {
        let weight = move |_: usize, [u, v]: [f64; 2]| {
            1.0 + precision * (bias + 8.0 * (1e4 * u + 1e5 * v).fract() - 4.0).round()
        };
        for map in [Some([1, 2]), None] {
            let bsdf = Weights { weight, largest: None, map, precision };
            for seed in 0..10 {
                let found = albedo(&bsdf, 0.01, seed);
                let excess = (found.value[0] - 1.0).abs();
                assert!(excess <= found.error[0] && found.error[0] < 0.01, "{precision} {bias} {map:?}: {found:?}");
                // What rounding may do has its part of the error.
                assert!(found.error[0] > 8.0 * precision);
            }
        }
    }
}

#[test]
fn a_black_surface_is_black() {
    for map in [Some([1, 2]), None] {
        let bsdf = Weights { weight: |_: usize, _: [f64; 2]| 0.0, largest: None, map, precision: f64::EPSILON };
        let found = albedo(&bsdf, 0.01, 1);
        assert!(found.value[0] == 0.0 && found.error[0] < 0.01, "{found:?}");
    }
}

#[test]
fn a_gain_of_a_hundredth_is_found() {
    for map in [Some([1, 2]), None] {
        let bsdf = Weights { weight: |_: usize, _: [f64; 2]| 1.01, largest: None, map, precision: f64::EPSILON };
        // As many tests as a table of 32 x 32 has, with the error that other programs are tested with.
        let found = albedo(&bsdf, 0.01, 1);
        assert!(found.value[0] - found.error_of(0, 1024) > 1.0, "{found:?}");
    }
}

#[test]
fn poles_at_the_border_are_within_the_bound() {
    // Weights without a variance, with random numbers of single precision: 2⁻²⁴ is the smallest.
    let levels = f64::from(1u32 << 24);
    let weight = move |_: usize, [u, v]: [f64; 2]| {
        let [u, v] = [u, v].map(|x| (x * levels).floor() / levels);
        0.3 / (1.0 - u).sqrt() + 0.2 / v.max(0.5 / levels).sqrt()
    };
    let bsdf = Weights { weight, largest: None, map: Some([1, 2]), precision: f32::EPSILON.into() };
    let outside = (0..20).filter(|&seed| {
        let found = albedo(&bsdf, 1e-2, seed);
        assert!(found.error[0] < 1e-2, "{found:?}");
        (found.value[0] - 1.0).abs() > found.error[0]
    });
    // 3 or more of 20 with a risk of 1 % have a probability of 0.1 %.
    assert!(outside.count() < 3);
}

#[test]
fn other_bsdfs_are_averaged() {
    let weight = |lobe: usize, [u, v]: [f64; 2]| if lobe == 0 { 2.0 * u } else { v * v };
    let bsdf = Weights { weight, largest: Some(2.0), map: None, precision: f64::EPSILON };
    let outside = (0..200).filter(|&seed| {
        let found = albedo(&bsdf, 0.1, seed);
        assert!(matches!(found.basis, Basis::Normal { freedom: 15.0, .. }), "{found:?}");
        (found.value[0] - (0.5 + 0.5 / 3.0)).abs() > found.error[0]
    });
    // 7 or more of 200 with a risk of 1 % have a probability of 0.4 %.
    assert!(outside.count() < 7);
}

#[test]
fn bounds_for_many_are_wider() {
    let one = Albedo { value: [1.0; 3], error: [0.01; 3], basis: Basis::Normal { freedom: 15.0, largest: 1.0 } };
    assert!((one.error_of(0, 1) / 0.01 - 1.0).abs() < 1e-3);
    assert!(one.error_of(0, 1000) > 0.018);
    let certified = Albedo { basis: Basis::Certified(1.0), ..one };
    // ln(2 · 200/risk) is twice ln(2/risk).
    assert!(certified.error_of(0, 1) == 0.01 && (certified.error_of(0, 200) - 0.02).abs() < 1e-12);
}

#[test]
fn the_protocol_bounds_the_points() {
    /// Weights of a narrow lobe, which counts how often it is sampled.
    struct Narrow(std::sync::atomic::AtomicU64, Option<[usize; 2]>);
    impl Bsdf for Narrow {
        fn properties(&self) -> Properties {
            Properties { map: self.1, ..Properties::default() }
        }
        fn eval(&self, _: Direction, _: Direction, _: &[f64]) -> [f64; 3] {
            [0.0; 3]
        }
        fn pdf(&self, _: Direction, _: Direction) -> f64 {
            0.0
        }
        fn sample(&self, _: Direction, u: &[f64]) -> Option<BsdfSample> {
            self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            Some(BsdfSample::new(UP, [500.0 * u[1].powi(499); 3], Density::Pdf(1.0)))
        }
    }
    for map in [None, Some([1, 2])] {
        let narrow = Narrow(0.into(), map);
        let protocol = Protocol { samples: SampleCount::Fixed(1 << 15), ..Protocol::default() };
        let found = directional_albedo(&narrow, UP, 1e-6, &protocol).unwrap();
        // The third number, which chooses no lobe, is asked for twice at each point.
        assert!(narrow.0.into_inner() < 5 << 15 && found.error[0] > 1e-6, "{map:?}: {found:?}");
    }
}
