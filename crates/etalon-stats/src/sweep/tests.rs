//! Spaces visit what they say; configurations survive their text; faults are found and shrunk.

use super::*;
use crate::bsdf::{
    ALL, BatchBsdf, Bsdf, BsdfSample, Density, Direction, Energy, Family, Parameter, Properties, Spectrum,
};
use crate::error::Result;
use rayon::prelude::*;
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};

/// A Lambertian surface; its pdf is `pdf` times too large, and random numbers are bent by `bend` before it samples.
struct Lambertian {
    pdf: f64,
    bend: f64,
    transmission: bool,
}

impl Bsdf for Lambertian {
    fn properties(&self) -> Properties {
        Properties { transmission: self.transmission, ..Properties::default() }
    }

    fn eval(&self, wo: Direction, wi: Direction, _: &[f64]) -> Spectrum {
        [if wo[2] * wi[2] > 0.0 { 0.8 / PI } else { 0.0 }; 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        if wo[2] * wi[2] > 0.0 { self.pdf * wi[2].abs() / PI } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let u1 = u[1].powf(self.bend);
        let (r, phi) = (u1.sqrt(), TAU * u[2]);
        let wi = [r * phi.cos(), r * phi.sin(), (1.0 - u1).sqrt() * wo[2].signum()];
        let pdf = Bsdf::pdf(self, wo, wi);
        let weight = Bsdf::eval(self, wo, wi, &[])[0] * wi[2].abs() / pdf;
        (pdf > 0.0).then(|| BsdfSample::new(wi, [weight; 3], Density::Pdf(pdf)))
    }
}

/// Two widths, an index, and a share; what is wrong for which values.
struct Planted {
    transmission: bool,
    fault: fn(&[f64]) -> [f64; 2],
}

const RIGHT: [f64; 2] = [1.0; 2];

impl Family for Planted {
    fn name(&self) -> &str {
        "planted"
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![
            Parameter::new("alpha_x", 0.3, [1e-4, 1.0]),
            Parameter::new("alpha_y", 0.3, [1e-4, 1.0]),
            Parameter::new("eta", 1.5, [1.0 / 2.4, 2.4]),
        ]
    }

    fn with(&self, values: &[f64]) -> Result<Box<dyn BatchBsdf + '_>> {
        let [pdf, bend] = (self.fault)(values);
        Ok(Box::new(Lambertian { pdf, bend, transmission: self.transmission }))
    }
}

const STRATEGIES: [Strategy; 3] = [Strategy::Grid, Strategy::Random, Strategy::Edges];

fn all(family: &Planted, strategy: Strategy, configurations: u64) -> Vec<Configuration> {
    let space = Space::new(family, strategy, configurations, 1).unwrap();
    (0..space.len()).map(|number| space.get(number)).collect()
}

#[test]
fn configurations_differ_lie_in_range_and_survive_their_text() {
    for transmission in [false, true] {
        let family = Planted { transmission, fault: |_| RIGHT };
        let ranges: Vec<[f64; 2]> = family.parameters().iter().map(|parameter| parameter.range).collect();
        for strategy in STRATEGIES {
            let configurations = all(&family, strategy, 500);
            assert!((250..=500).contains(&configurations.len()), "{strategy:?}: {}", configurations.len());
            let texts: HashSet<String> =
                configurations.iter().map(|configuration| configuration.text(&family)).collect();
            assert_eq!(texts.len(), configurations.len(), "{strategy:?}");
            for configuration in &configurations {
                let inside =
                    configuration.values.iter().zip(&ranges).all(|(value, [from, to])| (from..=to).contains(&value));
                let [theta, _] = configuration.wo;
                assert!(inside && (0.0..=180.0).contains(&theta) && (theta - 90.0).abs() > 0.0099, "{configuration:?}");
                let text = configuration.text(&family);
                let (again, check) = Configuration::parse(&family, text.strip_prefix("planted").unwrap()).unwrap();
                assert!(again == *configuration && check.is_none(), "{text}");
            }
            let below = configurations.iter().filter(|configuration| configuration.wo[0] > 90.0).count();
            let expected = if transmission { 0.5 } else { 0.0 };
            assert!((below as f64 / configurations.len() as f64 - expected).abs() < 0.05, "{strategy:?}: {below}");
        }
    }
}

#[test]
fn texts_that_cannot_be_run_are_refused() {
    let family = Planted { transmission: false, fault: |_| RIGHT };
    let read = |text: &str| Configuration::parse(&family, text);
    let (default, _) = read("").unwrap();
    assert_eq!(default, Configuration::default_of(&family));
    let (found, check) = read(" alpha_y=1e-3 wo=100 check=energy seed=18446744073709551615").unwrap();
    assert_eq!((found.values, found.wo, found.seed), (vec![0.3, 1e-3, 1.5], [100.0, 0.0], u64::MAX));
    assert_eq!(check.as_deref(), Some("energy"));
    for bad in
        ["alpha_x", "alpha=0.1", "eta=nan", "eta=3", "wo=90", "wo=-1", "wo=1,x", "wo=181", "seed=-1", "eta=1 eta=2"]
    {
        assert!(read(bad).unwrap_err().to_string().starts_with("replay: "), "{bad}");
    }
}

#[test]
fn the_first_configurations_of_a_sequence_are_spread_and_longer_ones_go_on() {
    let family = Planted { transmission: false, fault: |_| RIGHT };
    let (few, many) = (all(&family, Strategy::Random, 64), all(&family, Strategy::Random, 1000));
    assert_eq!(few, many[..64]);
    // Every eighth of each range has a value.
    for (axis, [from, to]) in family.parameters().iter().map(|parameter| parameter.range).enumerate() {
        let share = |value: f64| {
            if to > 10.0 * from { (value / from).ln() / (to / from).ln() } else { (value - from) / (to - from) }
        };
        let eighths: HashSet<usize> = few.iter().map(|c| (8.0 * share(c.values[axis])).min(7.0) as usize).collect();
        assert_eq!(eighths.len(), 8, "axis {axis}");
    }
}

#[test]
fn edges_visit_corners_equal_widths_and_both_sides_of_one() {
    let family = Planted { transmission: true, fault: |_| RIGHT };
    let visited = all(&family, Strategy::Edges, 10_000);
    let any = |wanted: &dyn Fn(&Configuration) -> bool| assert!(visited.iter().any(wanted));
    for corner in [[1e-4, 1e-4, 2.4], [1e-4, 1.0, 1.0 / 2.4], [1.0, 1.0, 1.0]] {
        any(&|c| c.values == corner && c.wo[0] == 89.99);
    }
    any(&|c| c.values[2] == 0.999 && c.wo[0] == 180.0);
    any(&|c| c.values[2] == 1.001 && c.wo == [90.01, 90.0]);
    any(&|c| c.values[0] == c.values[1] && ![1e-4, 0.3, 1.0].contains(&c.values[0]));
}

/// The configurations of `strategy` in which the fault shows, and the simplest form of the first of them by `check`.
fn found(family: &Planted, strategy: Strategy, check: &str) -> (usize, Option<Shrunk>) {
    let check = ALL.iter().position(|known| known.name == check).unwrap();
    let wrong: Vec<Configuration> =
        all(family, strategy, 500).into_iter().filter(|c| (family.fault)(&c.values) != RIGHT).collect();
    let shrunk = wrong.first().map(|first| shrink(family, first, check, 0.05, || false).unwrap().unwrap());
    (wrong.len(), shrunk)
}

#[test]
fn a_fault_of_narrow_lobes_is_found_by_all_and_shrunk() {
    // Samples follow another distribution: a matter of statistics.
    let fault = |values: &[f64]| if values[0] < 0.003 { [1.0, 1.3] } else { RIGHT };
    let family = Planted { transmission: false, fault };
    for strategy in STRATEGIES {
        let (count, shrunk) = found(&family, strategy, "sampling");
        let shrunk = shrunk.unwrap();
        assert!(count > 50 && shrunk.finding.p.unwrap() < CONFIRM_LEVEL, "{strategy:?}: {count}");
        let Configuration { values, wo, .. } = shrunk.configuration;
        assert!(
            [1e-4, 1e-3, 2e-3].contains(&values[0]) && values[1..] == [0.3, 1.5] && wo == [0.0, 0.0],
            "{values:?} {wo:?}"
        );
    }
}

#[test]
fn a_fault_of_unequal_widths_is_found_by_all_and_shrunk() {
    let fault = |values: &[f64]| if values[0] == values[1] { RIGHT } else { [1.1, 1.0] };
    let family = Planted { transmission: false, fault };
    for strategy in STRATEGIES {
        let (_, shrunk) = found(&family, strategy, "jacobian");
        let shrunk = shrunk.unwrap();
        let defaults = shrunk.configuration.values.iter().filter(|value| [0.3, 1.5].contains(*value)).count();
        assert!(shrunk.finding.state == State::Violated && defaults == 2, "{strategy:?}: {shrunk:?}");
    }
    // The converse is met by edges alone: other strategies set no two values equal, except for ends of the grid.
    let fault = |values: &[f64]| if values[0] == values[1] && values[0] < 1.0 { [1.1, 1.0] } else { RIGHT };
    let family = Planted { transmission: false, fault };
    assert_eq!(found(&family, Strategy::Random, "jacobian").0, 0);
    assert!(found(&family, Strategy::Edges, "jacobian").1.is_some());
}

#[test]
fn a_fault_of_an_index_below_one_is_found_by_all_and_one_of_an_index_of_one_by_edges() {
    let family = Planted { transmission: true, fault: |values| if values[2] < 1.0 { [1.1, 1.0] } else { RIGHT } };
    for strategy in STRATEGIES {
        let shrunk = found(&family, strategy, "jacobian").1.unwrap();
        let Configuration { values, wo, .. } = shrunk.configuration;
        assert!(values[..2] == [0.3, 0.3] && values[2] < 1.0 && wo == [0.0, 0.0], "{strategy:?}: {values:?}");
    }
    let near = |values: &[f64]| if (values[2] - 1.0).abs() < 0.002 { [1.1, 1.0] } else { RIGHT };
    let family = Planted { transmission: true, fault: near };
    let counts = STRATEGIES.map(|strategy| found(&family, strategy, "jacobian").0);
    assert!(counts[0] == 0 && counts[1] < 5 && counts[2] > 100, "{counts:?}");
}

#[test]
fn a_fault_of_two_small_ranges_together_is_met_by_edges() {
    // A share of 10⁻⁴ of the space.
    let corner = |values: &[f64]| if values[0] < 1.1e-4 && values[2] > 2.38 { [1.1, 1.0] } else { RIGHT };
    let family = Planted { transmission: false, fault: corner };
    let counts = STRATEGIES.map(|strategy| found(&family, strategy, "jacobian").0);
    assert!(counts[0] > 0 && counts[1] == 0 && counts[2] > 0, "{counts:?}");
    let (_, shrunk) = found(&family, Strategy::Edges, "jacobian");
    assert_eq!(shrunk.unwrap().configuration.values, [1e-4, 0.3, 2.4]);
}

#[test]
fn what_is_right_does_not_fail() {
    let family = Planted { transmission: true, fault: |_| RIGHT };
    let states = |family: &Planted, configuration: &Configuration| {
        let findings = screen(family, configuration, 0.05, || false).unwrap();
        findings.iter().map(|finding| (ALL[finding.check].name, finding.state)).collect::<Vec<_>>()
    };
    for configuration in all(&family, Strategy::Edges, 3) {
        let states = states(&family, &configuration);
        assert!(states.iter().all(|(_, state)| *state == State::Holds), "{states:?}");
    }
    let bent = Planted { transmission: false, fault: |_| [1.0, 1.3] };
    let states = states(&bent, &Configuration::default_of(&bent));
    assert!(states.contains(&("jacobian", State::Violated)) && states.contains(&("sampling", State::Suspicious)));
    let default = Configuration::default_of(&family);
    assert_eq!(shrink(&family, &default, 1, 0.05, || false).unwrap(), None);
}

/// A white surface whose values are random numbers: 0 or twice its value; `excess` times too bright.
struct Walk {
    excess: f64,
}

impl Bsdf for Walk {
    fn properties(&self) -> Properties {
        Properties { eval_dimension: 1, energy: Energy::Conserved(0.0), ..Properties::default() }
    }

    fn eval(&self, wo: Direction, wi: Direction, u: &[f64]) -> Spectrum {
        [if u[0] < 0.5 && wo[2] > 0.0 && wi[2] > 0.0 { 2.0 * self.excess / PI } else { 0.0 }; 3]
    }

    fn pdf(&self, _: Direction, wi: Direction) -> f64 {
        wi[2].max(0.0) / PI
    }

    fn sample(&self, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
        let sample = Bsdf::sample(&Lambertian { pdf: 1.0, bend: 1.0, transmission: false }, wo, u)?;
        Some(BsdfSample { weight: [self.excess; 3], ..sample })
    }
}

impl Family for Walk {
    fn name(&self) -> &str {
        "walk"
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn with(&self, _: &[f64]) -> Result<Box<dyn BatchBsdf + '_>> {
        Ok(Box::new(Self { ..*self }))
    }
}

#[test]
fn the_energy_of_stochastic_values_is_a_matter_of_chance() {
    let energy = ALL.iter().position(|check| check.name == "energy").unwrap();
    let of = |excess: f64, seed: u64| {
        let family = Walk { excess };
        let configuration = Configuration { seed, ..Configuration::default_of(&family) };
        confirm(&family, &configuration, energy, 0.05, || false).unwrap().unwrap()
    };
    // Right ones: one or two of 500 lie beyond three standard errors.
    let right: Vec<Finding> = (0..500).into_par_iter().map(|seed| of(1.0, seed)).collect();
    assert!(right.iter().all(|finding| finding.state != State::Violated));
    let survivors = right.iter().filter(|finding| finding.p.unwrap() < SCREEN_LEVEL).count();
    assert!(survivors <= 3, "{survivors} of 500 at level 0.001");
    // A surface that is too bright by five percent survives the screen and is rejected by the second run.
    let wrong = of(1.05, 1);
    assert!(wrong.state == State::Suspicious && wrong.p.unwrap() < CONFIRM_LEVEL, "{wrong:?}");
    assert!(wrong.detectable.unwrap() < 0.05 && wrong.message.unwrap().contains("the albedo is 1.0"));
}
