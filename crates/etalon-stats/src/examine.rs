//! One test of a sampler against a density: exact checks first, then counts in cells.

use crate::counting::{Counted, Counting, Source, streams};
use crate::cubature::{InvalidPdf, NOISE, Probe};
use crate::diagnosis::{diagnose, tuple};
use crate::domain::Domain;
use crate::error::{Error, Result};
use crate::exact::{self, Corners};
use crate::extremes::Extremes;
use crate::grid::{Cell, Grid, Subdivision};
use crate::leaves::Leaves;
use crate::looks::Looks;
use crate::mass::Integral;
use crate::mistakes::{self, Kinds, unless_cancelled};
use crate::multiple::sidak;
use crate::named_mistake::NamedMistake;
use crate::outcome::{Counts, Outcome, decide};
use crate::power::{ChiSquare, FEWEST, POWER, chi_square_below, chi_square_of_uncertain, detectable, samples_for};
use crate::sampler::{Atom, Density, Mass, Sampler};
use crate::serial::Labels;
use crate::structure::{self, CELLS, Structure};
use crate::weights;
use std::cell::LazyCell;
use std::time::Instant;

/// How many samples a test takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SampleCount {
    /// This many.
    Fixed(u64),
    /// As many as detect a relative error of the pdf of this size (root mean square over the cells) with 90 % probability.
    Detect(f64),
}

/// How tests are done.
#[derive(Debug, Clone, Copy)]
pub struct Protocol {
    /// The seed of all random numbers: equal seeds give equal outcomes.
    pub seed: u64,
    /// How many samples to take.
    pub samples: SampleCount,
    /// Probability that a run in which every sampler is right rejects any of them.
    pub level: f64,
    /// Tests of the run, which share the level.
    pub tests: usize,
    /// Cells of a domain's chart, about.
    pub cells: usize,
    /// Asked between batches of samples whether to stop; the test then returns [`Error::Cancelled`].
    pub cancelled: fn() -> bool,
}

impl Default for Protocol {
    /// A single test at level 1 % that detects relative errors of 2 %, with 200 cells, seed 1; never cancelled.
    fn default() -> Self {
        let samples = SampleCount::Detect(0.02);
        Self { seed: 1, samples, level: 0.01, tests: 1, cells: 200, cancelled: || false }
    }
}

/// A test that cannot detect relative errors of this size is inconclusive.
const COARSEST: f64 = 0.1;
/// Most samples of one test.
const MOST: u64 = 1 << 34;
/// How far the integral of a density may be from its declared mass, beyond the integral's own error bound.
const MASS: f64 = 1e-4;
/// Share of samples that rounding may carry over an edge of the support.
const ROUNDING: f64 = 1e-7;
/// Samples that decide on the cells, apart from those that are counted.
const PILOT: u64 = 1 << 14;
/// A p-value below this has the test say where counts differ.
pub(crate) const SUSPECT: f64 = 0.01;
/// The share of a test's level that the bound of the mass may fail with.
const RISK: f64 = 0.1;

impl Protocol {
    /// Refuses values that no test can be done with.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the name of the field: `level`, `cells`, `samples` or `detect`.
    pub fn check(&self) -> Result<()> {
        let refuse = |name, message: String, hint| Err(Error::parameter(name, message, hint));
        if !(self.level > 0.0 && self.level < 1.0) {
            return refuse("level", format!("level {}", self.level), "use a probability such as 0.01");
        }
        if !(2..=1 << 20).contains(&self.cells) {
            return refuse("cells", format!("{} cells", self.cells), "use 2 to 2^20 cells");
        }
        match self.samples {
            SampleCount::Fixed(n) if !(1..=MOST).contains(&n) => {
                refuse("samples", format!("{n} samples"), "use 1 to 2^34 samples")
            }
            SampleCount::Detect(w) if !(w > 0.0 && w <= 1.0) => {
                refuse("detect", format!("error {w}"), "use a relative error such as 0.01")
            }
            SampleCount::Detect(w) if self.samples_for(self.cells - 1) >= MOST => {
                refuse("detect", format!("error {w} takes more than 2^34 samples"), "use a larger error")
            }
            _ => Ok(()),
        }
    }

    /// The level of one test among all of the run.
    #[must_use]
    pub fn own_level(&self) -> f64 {
        sidak(self.level, self.tests)
    }

    /// The level of the counts of the cells when all of `samples` samples have been drawn; looks before and structure in
    /// finer parts have the rest.
    #[must_use]
    pub fn level_of_cells(&self, samples: u64) -> f64 {
        Looks::at_doubling(samples).share(samples) * CELLS * self.own_level()
    }

    /// The number of samples for that many degrees of freedom.
    #[must_use]
    pub fn samples_for(&self, dof: usize) -> u64 {
        match self.samples {
            SampleCount::Fixed(n) => n,
            SampleCount::Detect(w) => {
                let several = samples_for(dof, self.level_of_cells(MOST), w);
                // So few that there is one look, with the whole level, need fewer still.
                let is_one = Looks::at_doubling(several) == Looks::one(several);
                if is_one { samples_for(dof, CELLS * self.own_level(), w) } else { several }.min(MOST)
            }
        }
    }

    fn looks(&self, dof: usize) -> Looks {
        Looks::at_doubling(self.samples_for(dof))
    }

    /// The relative error that a test must be able to detect.
    pub(crate) fn coarsest(&self) -> f64 {
        match self.samples {
            SampleCount::Fixed(_) => COARSEST,
            // Errors of integrals take a little of what was asked for.
            SampleCount::Detect(w) => (1.25 * w).at_least(COARSEST),
        }
    }
}

/// Tests whether the samples of `sampler` follow `density` over `domain`, with one repetition if they seem not to.
///
/// # Errors
/// [`Error::Parameter`] for an impossible `protocol`; [`Error::External`] from a sampler or density that is computed
/// in another process; [`Error::Cancelled`].
pub fn validate(
    domain: &dyn Domain,
    sampler: &dyn Sampler,
    density: &dyn Density,
    protocol: &Protocol,
) -> Result<Outcome> {
    let mut outcome = [examine(domain, sampler, density, protocol, 0)?];
    decide(&mut outcome, protocol.own_level(), |_| examine(domain, sampler, density, protocol, 1))?;
    let [outcome] = outcome;
    Ok(outcome)
}

/// One round of a test, its verdict still open: see [`decide`]. Each `round` has random numbers of its own.
///
/// # Errors
/// As [`validate`].
pub fn examine(
    domain: &dyn Domain,
    sampler: &dyn Sampler,
    density: &dyn Density,
    protocol: &Protocol,
    round: u64,
) -> Result<Outcome> {
    protocol.check()?;
    let start = Instant::now();
    if round == 0 {
        domain.check()?;
    }
    let source = Source { domain, leaves: None, sampler, density, seed: protocol.seed, cancelled: protocol.cancelled };
    if domain.space().is_some() && !density.narrow().is_empty() {
        let message = "narrow places have one or two coordinates; the domain has more".to_owned();
        return Err(Error::parameter("narrow", message, "declare none"));
    }
    if density.is_target() || density.is_stochastic() {
        let outcome = weights::examine(&source, protocol, round)?;
        return Ok(Outcome { seconds: start.elapsed().as_secs_f64(), ..outcome });
    }

    // In many dimensions samples make up for the errors of integrals.
    let samples = match protocol.samples {
        SampleCount::Detect(w) if domain.space().is_some() => SampleCount::Detect(w / (1.0 + NOISE).sqrt()),
        samples => samples,
    };
    let protocol = &Protocol { samples, ..*protocol };

    // Do the exact checks. A finite number of samples allows none at the corners and a smaller pilot.
    let finite = sampler.finite_len();
    let corners = if finite.is_none() { exact::corners(domain, sampler, density)? } else { Corners::default() };
    let pilots = finite.map_or(PILOT, |len| PILOT.min(len / 4));
    let drawn = source.drawn(streams(round, 0)[0], pilots)?;
    let atoms = density.atoms();
    let looks_for = |dof| finite.map_or_else(|| protocol.looks(dof), |len| Looks::one(len - pilots));
    // A domain of many dimensions becomes the leaves of a tree.
    let leaves = domain.space().map(|space| {
        let bits = Subdivision::bits(looks_for(protocol.cells + atoms.len()).samples());
        Leaves::new(domain, space, &drawn, bits)
    });
    let leaves = leaves.transpose()?;
    let domain = leaves.as_ref().map_or(domain, |leaves| leaves);
    let source = Source { domain, leaves: leaves.as_ref(), ..source };
    let pilot = source.probes(&drawn)?;
    // Integrals and counts of a density that changes are meaningless, as are the counts of samples that repeat.
    let unusable = exact::repeatable(domain, density, &pilot)?.or_else(|| exact::repeated(domain, &pilot));
    if let Some(violation) = unusable {
        let seconds = start.elapsed().as_secs_f64();
        return Ok(Outcome { violation: Some(violation), seconds, ..Outcome::open(pilots) });
    }

    // Choose cells, the number of samples and the looks at them. The first of samples at hand say nothing: they may be sorted.
    let shape = shape(domain, protocol.cells);
    let grid = match &leaves {
        Some(leaves) => leaves.grid(protocol.cells),
        None => cells(domain, &pilot, shape, looks_for(shape[0] * shape[1] + atoms.len()).samples()),
    };
    let looks = looks_for(grid.len() + atoms.len());
    let charts: Vec<[f64; 2]> = pilot.iter().map(|probe| probe.at).collect();
    let subdivision = match &leaves {
        Some(leaves) => Subdivision::even(&grid, leaves.bits()),
        None => Subdivision::new(&grid, domain.is_plane(), &charts, looks.samples()),
    };
    let subdivision = if domain.outcomes().is_some() { subdivision.of_finite_set() } else { subdivision };
    let labels = Labels::new(&subdivision, looks.samples());
    // What only rejections need. The first of samples at hand may be sorted.
    let others: Lazy<Option<Counts>> =
        Lazy::new(Box::new(|| if finite.is_none() { mistakes::of_others(domain, &charts) } else { None }));
    let function: Lazy<Option<usize>> =
        Lazy::new(Box::new(|| if domain.is_plane() { mistakes::curve::of(&charts) } else { None }));

    // Integrate the density over the cells, and count samples in them until a look rejects.
    let test = Test {
        domain,
        is_in_leaves: leaves.is_some(),
        source: &source,
        round,
        density,
        protocol,
        pilot: &pilot,
        pilots,
        others,
        function,
        corners: &corners,
        subdivision: &subdivision,
        labels,
        atoms: &atoms,
        looks,
    };
    let counting = Counting {
        source: &source,
        subdivision: &subdivision,
        labels,
        atoms: &atoms,
        whole: (density.mass() == Mass::AtMostOne).then(|| 1.0 - test.at_atoms()),
        normalized: test.is_normalized(),
        risk: RISK * protocol.own_level() / looks.count(),
        looks,
    };
    let rejects = |counted: &Counted| {
        let Findings { p, violation, is_mass_wrong, counts, beyond, .. } = test.find(counted, false);
        match violation {
            _ if beyond.is_some() => true,
            Some(_) if !is_mass_wrong => true,
            // A wrong mass ends the test when counts tell what else is wrong.
            Some(_) if !mistakes::is_clear(&counts) => false,
            None if p.is_none_or(|p| p >= protocol.own_level()) => false,
            _ => !mistakes::is_open(&counts, looks.samples()),
        }
    };
    let counted = counting.run(&pilot, round, rejects)?;
    let outcome = test.outcome(counted)?;
    Ok(Outcome { seconds: start.elapsed().as_secs_f64(), ..outcome })
}

/// What is computed when it is first needed.
type Lazy<'a, T> = LazyCell<T, Box<dyn FnOnce() -> T + 'a>>;

/// A test, prepared before samples are counted.
struct Test<'a> {
    domain: &'a dyn Domain,
    /// Whether the domain has more than two dimensions.
    is_in_leaves: bool,
    source: &'a Source<'a>,
    /// The round of the test.
    round: u64,
    density: &'a dyn Density,
    protocol: &'a Protocol,
    pilot: &'a [Probe],
    /// Draws of the pilot, "no sample" and atoms included.
    pilots: u64,
    /// Counts of the pilot by which names of mistakes are confirmed.
    others: Lazy<'a, Option<Counts>>,
    /// The coordinate of samples that is a function of the other one.
    function: Lazy<'a, Option<usize>>,
    /// What was found at the corners of the random numbers.
    corners: &'a Corners,
    subdivision: &'a Subdivision<'a>,
    labels: Labels,
    atoms: &'a [Atom],
    looks: Looks,
}

/// What is counted, and what it is compared with.
const NAMES: [&str; 2] = ["samples", "the pdf"];

/// Samples that are drawn for a name, at most as many times those that were counted: external programs may be slow.
const MOST_MORE: u64 = 8;

/// What counts show.
struct Findings {
    counts: Counts,
    /// Samples that count: without "no sample" where its probability is not known.
    samples: u64,
    mass: Option<Integral>,
    /// The test of the cells, and the share of the variance of their counts that errors of the integrals add.
    test: Option<ChiSquare>,
    noise: f64,
    /// Whether only one outcome can occur.
    certain: bool,
    structure: Structure,
    /// The p-value of all looks; `None` where nothing could be tested.
    p: Option<f64>,
    violation: Option<String>,
    /// Whether the violation is that of the mass.
    is_mass_wrong: bool,
    /// Why nothing can be said: too many samples are where integrals do not reach.
    beyond: Option<String>,
}

impl Test<'_> {
    /// The probability of all atoms.
    fn at_atoms(&self) -> f64 {
        self.atoms.iter().map(|atom| atom.probability).sum()
    }

    /// Whether the density has an unknown mass, so that it is tested up to a factor.
    fn is_normalized(&self) -> bool {
        self.density.mass() == Mass::Unknown
    }

    /// The number of samples that the counts lack to name a mistake: none if all samples are given.
    fn missing(&self, counts: &Counts) -> u64 {
        let known = counts.observed.iter().sum::<u64>();
        let wanted = mistakes::SAMPLES_TO_NAME.min(known.saturating_mul(MOST_MORE));
        if self.is_in_leaves || self.source.sampler.finite_len().is_some() { 0 } else { wanted.saturating_sub(known) }
    }

    /// The counts, with those of the samples that they lack. The verdict is fixed before, and these have no part in it: a sampler that
    /// fails now, or a test that is interrupted, has no name of its mistake.
    fn with_more(&self, counts: &Counts, missing: u64) -> Counts {
        let mut all = counts.clone();
        let known = counts.observed.iter().sum::<u64>();
        let Ok(mut fresh) = self.source.counts(self.round, missing, &counts.grid, self.atoms) else { return all };
        // "No sample" is left out where its probability is not known.
        fresh.last_mut().filter(|_| self.is_normalized()).into_iter().for_each(|none| *none = 0);
        all.observed.iter_mut().zip(fresh).for_each(|(n, more)| *n += more);
        let growth = all.observed.iter().sum::<u64>() as f64 / known as f64;
        all.expected.iter_mut().for_each(|expected| *expected *= growth);
        all
    }

    /// The mistake that explains the counts. In more than two dimensions none is tried: each takes integrals of its own.
    fn mistake(&self, counts: &Counts, kinds: Kinds) -> Result<Option<NamedMistake>> {
        if self.is_in_leaves {
            return Ok(None);
        }
        if let Some(i) = *self.function {
            let names = self.domain.coordinates();
            let (y, x) = (names[i], names[1 - i]);
            let words = format!("samples have {y} as a function of {x}, as if one random number were used for both");
            return Ok(Some(NamedMistake::from(words)));
        }
        mistakes::of_counts(self.domain, self.density, counts, self.others.as_ref(), NAMES, kinds)
    }

    /// The mistake: as clear counts name it; then as the map from random numbers to samples does, which takes few of them; then as more
    /// counts do. Else what is known by the map: on which side the pdf is right, which power or which function of one variable it lacks; or that
    /// a random number changes nothing.
    fn named(&self, counts: &Counts) -> Result<Option<NamedMistake>> {
        let missing = self.missing(counts);
        let kinds = if missing == 0 { Kinds::All } else { Kinds::Certain };
        if let Some(named) = self.mistake(counts, kinds)? {
            return Ok(Some(named));
        }
        let (domain, sampler, density, seed) = (self.domain, self.source.sampler, self.density, self.protocol.seed);
        let names = ["the density of samples", "the pdf"];
        let charts: Vec<[f64; 2]> = self.pilot.iter().map(|probe| probe.at).collect();
        // Of a pdf of unknown mass no factor is known, and so no ratio
        let pairs = match self.is_in_leaves || self.is_normalized() {
            true => None,
            false => unless_cancelled(mistakes::map::of(domain, sampler, density, &charts, self.pilots, seed))?,
        };
        let pairs = pairs.unwrap_or_default();
        let mut named = mistakes::of_samples(domain, density, &pairs, NAMES)?;
        if named.is_none() && missing > 0 {
            named = self.mistake(&self.with_more(counts, missing), Kinds::All)?;
        }
        named = named.or_else(|| mistakes::of_side(domain, &pairs, names));
        named = named.or_else(|| mistakes::of_power(&pairs, names));
        named = named.or_else(|| mistakes::of_one_variable(domain, density, &pairs, names));
        if named.is_none() && !self.is_in_leaves {
            let unused = unless_cancelled(mistakes::map::unused(sampler, seed))?;
            let told = |u| format!("none of {} samples changed with the random number u{u}", mistakes::map::SAMPLES);
            named = unused.map(|u| NamedMistake::from(told(u)));
        }
        Ok(named)
    }

    /// Tests the samples and integrals of a look. Scales say what they detect where `states_power`.
    fn find(&self, counted: &Counted, states_power: bool) -> Findings {
        let Self { domain, density, protocol, corners, subdivision, labels, atoms, looks, .. } = *self;
        let Counted { values, errors, shares, integral, uncertain, invalid, tally, .. } = counted;
        let level = protocol.own_level();
        // Leave "no sample" out where its probability is not known.
        let none = if self.is_normalized() { 0 } else { tally.none };
        let samples = tally.samples - (tally.none - none);
        let n = samples as f64;

        // Compare the integral with the declared mass; derive the probability of "no sample".
        let mass = integral.plus(self.at_atoms());
        let tolerated = MASS + mass.error;
        // Values that are finite, but too large for a finite integral.
        let overflows = invalid.is_none() && !mass.value.is_finite();
        let (none_expected, mass_is_wrong) = match density.mass() {
            Mass::Exactly(m) => (1.0 - m, (mass.value - m).abs().may_exceed(tolerated)),
            Mass::AtMostOne => {
                // Where the integral is not exact, "no sample" is never known to be impossible.
                let is_wrong = mass.value.may_exceed(1.0 + tolerated);
                let least = if mass.error > 0.0 && !is_wrong { 0.5 / n } else { 0.0 };
                let rest = 1.0 - self.at_atoms() - values.iter().sum::<f64>();
                (rest.at_least(least), is_wrong)
            }
            Mass::Unknown => (0.0, false),
        };
        let is_known = mass.value.is_finite() || overflows;
        let mass_violation = (is_known && (mass_is_wrong || overflows)).then(|| match density.mass() {
            _ if overflows => "the integral of the pdf is not a finite number".to_owned(),
            Mass::Exactly(m) => format!("the pdf integrates to {mass}{}, not to {m}", constant(mass)),
            Mass::AtMostOne | Mass::Unknown => format!("the pdf integrates to {mass}{}, more than 1", constant(mass)),
        });
        let is_pdf = invalid.is_none() && !overflows;
        let pdf_violation =
            invalid.map(|InvalidPdf { point, value }| format!("the pdf at {} is {value}", tuple(&point)));

        // Expected counts of the cells, the atoms and "no sample"; observed ones beside them.
        let none_expected = n * none_expected.at_least(0.0);
        let expected: Vec<f64> = values
            .iter()
            .copied()
            .chain(atoms.iter().map(|atom| atom.probability))
            .map(|share| (n * share).at_least(f64::MIN_POSITIVE))
            .chain([none_expected.at_least(f64::MIN_POSITIVE)])
            .collect();
        let observed: Vec<u64> = tally.observed.iter().copied().chain([none]).collect();
        // No sample where there must always be one is as impossible as a sample of pdf 0.
        let impossible = tally.outside_support + if none_expected == 0.0 { none } else { 0 };

        // A deterministic distribution (a mirror, a black map): only impossible samples can show that it is wrong.
        let certain =
            expected.iter().filter(|e| **e >= 1.0).count() == 1 && expected.iter().all(|e| *e >= 1.0 || *e < 1e-300);
        // "No sample" has the errors of all cells, if its probability is not declared.
        let of_none = errors.iter().fold(0.0, |all: f64, error| all.hypot(*error));
        let of_none = if density.mass() == Mass::AtMostOne { of_none } else { 0.0 };
        let of_atoms = std::iter::repeat_n(&0.0, atoms.len());
        let variances = errors.iter().chain(of_atoms).chain([&of_none]).map(|error| (n * error).powi(2));
        let variances: Vec<f64> = variances.collect();
        let test = chi_square_of_uncertain(&observed, &expected, &variances).filter(|_| !certain);
        let noise = variances.iter().zip(&expected).filter(|(_, e)| **e >= FEWEST).map(|(variance, e)| variance / e);
        let noise = noise.sum::<f64>() / expected.len() as f64;
        let parts = structure::Counted {
            subdivision,
            domain,
            labels,
            tally,
            shares,
            samples,
            level: looks.share(tally.samples) * level,
            is_last: tally.samples == looks.samples(),
            states_power,
        };
        let structure = test.filter(|_| !uncertain).map(|test| parts.structure(test, SUSPECT));
        let p_of_counts = if certain { Some(1.0) } else { structure.as_ref().map(|structure| structure.p) };
        let p = p_of_counts
            .filter(|_| !uncertain && pdf_violation.is_none())
            .map(|p| with_impossible(p, impossible, n * ROUNDING))
            .map(|p| looks.overall(p, tally.samples, level));

        // Single precision returns the ends of an interval now and then; a density that is infinite more often is none.
        let is_often = |count| looks.overall(with_impossible(1.0, count, n * ROUNDING), tally.samples, level) < level;
        let infinite_violation = is_often(tally.infinite)
            .then(|| format!("the pdf is infinite at {} of {samples} samples", tally.infinite))
            .or_else(|| tally.at_infinity().filter(|_| is_often(tally.at_infinity)));
        let beyond = is_often(tally.beyond).then(|| {
            format!(
                "{} of {samples} samples are beyond 10⁶⁰, or closer to 0 than 10⁻⁶⁰, where integrals of the pdf do not reach: \
                 test their logarithms",
                tally.beyond
            )
        });
        let (of_samples, carried) = (tally.violation.clone(), tally.carried.violation());
        let of_corners = corners.violation.clone();
        // What concerns all of the pdf comes first.
        let invalid = of_samples.or(pdf_violation).or(infinite_violation);
        let of_corners = of_corners.filter(|_| invalid.is_none());
        let is_mass_wrong = mass_violation.is_some();
        let violations = [mass_violation, invalid, carried.or(of_corners)];
        let violations: Vec<String> = violations.into_iter().flatten().collect();
        // Numbers that have become 0 or infinite are no more than one expects beyond.
        let violation = Some(violations.join("; ")).filter(|text| !text.is_empty() && beyond.is_none());
        let p = p.filter(|_| beyond.is_none());
        let grid = subdivision.grid.clone();
        Findings {
            counts: Counts::new(domain, grid, density.atom_names(), observed, expected),
            samples,
            mass: is_pdf.then_some(mass),
            test,
            noise,
            certain,
            structure: structure.unwrap_or_default(),
            p,
            violation,
            is_mass_wrong,
            beyond,
        }
    }

    /// The outcome of the look at which the test ended, its verdict still open.
    fn outcome(&self, counted: Counted) -> Result<Outcome> {
        let Self { domain, density, protocol, pilot, pilots, corners, looks, .. } = *self;
        let Findings { mut counts, samples, mass, test, noise, certain, structure, p, mut violation, beyond, .. } =
            self.find(&counted, true);
        let is_within = beyond.is_none();
        let Counted { uncertain, integral, tally, far, .. } = counted;
        let Structure { scales, words, mut remarks, finer, .. } = structure;
        counts.finer = finer;
        remarks.extend(
            corners
                .infinite
                .as_ref()
                .map(|at| format!("the pdf is infinite at the point {at}, which has no part in integrals")),
        );
        remarks.extend(tally.at_infinity().filter(|_| violation.is_none()));
        remarks.extend(far.map(|InvalidPdf { point, value }| {
            format!("the pdf at {} is {value}: far from all samples it counts as 0", tuple(&point))
        }));
        if self.is_normalized() {
            let mass = integral.plus(self.at_atoms());
            remarks.push(format!(
                "only the shape of the pdf was tested: it integrates to {mass}, and its mass is not declared"
            ));
        }
        let level = looks.share(tally.samples) * CELLS * protocol.own_level();
        let detectable = match test {
            _ if certain => Some(detectable_share(samples as f64)),
            _ => test.map(|test| detectable(test.dof, level, samples) * (1.0 + noise).sqrt()),
        };
        let inconclusive_reason = match detectable {
            _ if beyond.is_some() => beyond,
            _ if uncertain => Some(
                "the integrals of the pdf are too uncertain for that many samples; a pdf with steps can declare them (`table`)"
                    .to_owned(),
            ),
            None if !counts.expected.iter().all(|e| e.is_finite()) => Some("expected counts are not finite".to_owned()),
            None => Some("too few samples: all cells had to be pooled".to_owned()),
            Some(w) if w > protocol.coarsest() => {
                Some(format!("too few samples: an error of the pdf below {:.0} % would remain undetected", 100.0 * w))
            }
            Some(_) => None,
        };
        // Look for equal samples and values. A batch has too few of them: they end no look before.
        // A pdf of unknown mass is in units of its integral, and of its samples nobody knows how many had to be.
        let (unit, draws) =
            if self.is_normalized() { (integral.plus(self.at_atoms()).value, None) } else { (1.0, Some(pilots)) };
        let repeated = || {
            exact::discrete(domain, pilot, unit)
                .or_else(|| exact::repeated_values(domain, pilot, &tally.repeats, unit))
                .or_else(|| exact::collisions(domain, pilot, draws?))
        };
        violation = violation
            .or_else(|| exact::same_batches(domain, &tally.serial))
            .or_else(|| repeated().filter(|_| is_within));
        // Name the mistake: of the pdfs that samples carry, and of their places.
        let mut mistakes = Vec::new();
        if tally.carried.violation().is_some() && !tally.carried.is_rounding() {
            let names = ["what samples carry", "the pdf"];
            let pairs = &tally.carried.pairs;
            let mistake = mistakes::of_pairs(domain, density, pairs, names)?;
            mistakes.extend(mistake.or_else(|| mistakes::of_one_variable(domain, density, pairs, names)));
        }
        let is_suspect = p.is_some_and(|p| p < SUSPECT);
        let [mut coordinates, mut widths] = [None, None];
        if is_suspect && mass.is_some() {
            let mistake = self.named(&counts)?;
            if mistake.is_none() && !self.is_in_leaves {
                [coordinates, widths] = mistakes::facts(domain, density, &counts, NAMES)?;
            }
            mistakes.extend(mistake);
        }
        // Beside a mistake that is no factor, the integral is a known constant by chance.
        if let (Some(mass), Some(text)) = (mass, violation.as_mut())
            && mistakes.iter().any(|mistake: &NamedMistake| mistake.factor().is_none())
        {
            *text = text.replacen(&constant(mass), "", 1);
        }
        if let Some(violation) = violation.as_mut().filter(|_| tally.carried.violation().is_some()) {
            let is_followed = p.is_some_and(|p| p >= SUSPECT);
            if is_followed {
                *violation += &format!("; as far as {samples} samples tell, they follow the pdf");
            }
        }
        let places = is_suspect.then(|| diagnose(domain, &counts)).flatten();
        let told = [coordinates, places].into_iter().flatten().collect::<Vec<_>>().join(": ");
        let told = Some(told).filter(|told| !told.is_empty());
        let words = told.into_iter().chain(widths).chain(words).collect::<Vec<_>>();
        let nowhere = || "counts differ from what the pdf predicts, in no place clearly".to_owned();
        let words = if words.is_empty() && is_suspect { vec![nowhere()] } else { words };
        Ok(Outcome {
            statistic: test.map_or(0.0, |test| test.statistic),
            dof: test.map_or(0, |test| test.dof),
            p,
            detectable,
            mass,
            cells: counts.observed.len(),
            pooled: test.map_or(0, |test| test.dof + 1),
            none: tally.none,
            mistake: NamedMistake::joined(mistakes),
            violation,
            inconclusive_reason,
            diagnosis: Some(words.join("; ")).filter(|words| is_suspect && !words.is_empty()),
            scales,
            remarks,
            counts: Some(counts),
            stopped: tally.samples < looks.samples(),
            compared: tally.carried.differences(domain),
            ..Outcome::open(samples)
        })
    }
}

/// " = π", where the integral is a known constant.
fn constant(mass: Integral) -> String {
    let precision = (mass.error / mass.value.abs()).within(1e-5, 1e-3);
    mistakes::constant(mass.value, precision).map_or(String::new(), |name| format!(" = {name}"))
}

/// Rows and columns of about that many cells: rows half as many as columns.
pub(crate) fn shape(domain: &dyn Domain, cells: usize) -> [usize; 2] {
    if let Some(n) = domain.outcomes() {
        return [cells.min(n), 1];
    }
    if !domain.is_plane() {
        return [cells, 1];
    }
    // Sets of their own have rows of their own.
    let parts = domain.parts().min(cells);
    let rows = parts * ((cells as f64 / (2 * parts) as f64).sqrt().round() as usize).max(1);
    [rows, cells.div_ceil(rows)]
}

/// Cells of equal area where the pilot fills at least half of them; otherwise cells that adapt to it.
pub(crate) fn cells(domain: &dyn Domain, pilot: &[Probe], shape: [usize; 2], samples: u64) -> Grid {
    let equal = Grid::equal(shape, domain.outcomes());
    let mut counts = vec![0u64; equal.len()];
    let pilot: Vec<[f64; 2]> = pilot.iter().map(|probe| probe.at).collect();
    pilot.iter().for_each(|&at| counts[equal.find(at)] += 1);
    let enough = FEWEST * pilot.len() as f64 / samples as f64;
    let filled = counts.iter().filter(|&&n| n > 0 && n as f64 >= enough).count();
    if 2 * filled >= equal.len() { equal } else { Grid::adapted(&pilot, shape, Cell::WHOLE, domain.outcomes()) }
}

/// The share of impossible samples that is detected with probability [`POWER`] among `n`, one being enough to reject.
fn detectable_share(n: f64) -> f64 {
    -(1.0 - POWER).ln() / n
}

/// The p-value of the counts, and of `impossible` samples where rounding explains `allowed` on average.
fn with_impossible(p: f64, impossible: u64, allowed: f64) -> f64 {
    if impossible == 0 {
        return p;
    }
    // P(Poisson(m) ≥ k) = P(χ²(2k) ≤ 2m); the smaller of two p-values counts twice (Bonferroni).
    let p_of_impossible = chi_square_below(2.0 * impossible as f64, 2.0 * allowed);
    (2.0 * p.at_most(p_of_impossible)).at_most(1.0)
}
