//! Values: finite, not negative, within declared bounds, and only where the BSDF declares that it scatters light. The formula of
//! weights: weight = f |cos θᵢ| / pdf, and the pdf that a sample carries. Lobe mixtures: the balance heuristic's weights of the
//! lobes sum to 1, that is the pdfs of the lobes sum to the pdf.

use super::contract::{BsdfSample, Density, Direction, Kind, Pair, PdfKind, Properties, Spectrum};
use super::mistakes::{PDF, explain, light};
use super::sampling::Scattering;
use super::subject::{Comparison, Subject, dot, length, same_side, sphere};
use crate::diagnosis::{different, tuple};
use crate::domain::Domain;
use crate::error::Result;
use crate::exact::{Carried, relative_difference};
use crate::extremes::Extremes;
use crate::mistakes::{EQUAL, FEWEST_PAIRS, common_factor, number};
use crate::named_mistake::NamedMistake;
use crate::outcome::Outcome;
use crate::sampler::Sample;
use rand::RngExt;

/// Looks at values, pdfs and weights at samples, at random numbers on the edges of the unit cube, and in many directions: along
/// the surface, at the poles, towards and opposite to `wo`.
pub fn values(subject: &Subject) -> Result<Option<Outcome>> {
    let Subject { bsdf, properties, wo, .. } = subject;
    let mut found = Comparison::default();
    for parameter in &properties.parameters {
        let ([from, to], value) = (parameter.range, parameter.value);
        found.holds((from..=to).contains(&value), || format!("{} = {value} is not in {from}..{to}", parameter.name));
    }
    let samples = subject.samples()?;
    // Values and pdfs in all directions.
    let mut rng = subject.random(1, 0);
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    let directions: Vec<Direction> = subject.directions()?.into_iter().chain(sampled).collect();
    let pairs = subject.pairs(&directions);
    let u: Vec<f64> = (0..directions.len() * properties.eval_dimension).map(|_| rng.random::<f64>()).collect();
    let (values, pdfs) = (bsdf.eval(&pairs, &u)?, bsdf.pdf(&pairs)?);
    let mut lit = Lit::default();
    lit.add(subject, directions.iter().copied().zip(values.iter().copied()), &samples);
    for ((wi, f), pdf) in directions.into_iter().zip(values).zip(pdfs) {
        let f = &f[..properties.channels];
        let finite = |x: &f64| x.is_finite() && *x >= 0.0;
        found.holds(f.iter().all(finite), || format!("{}: f = {f:?}", subject.at(wi)));
        found.holds(finite(&pdf), || format!("{}: pdf = {pdf}", subject.at(wi)));
        // Along the surface there are no sides.
        let side = wo[2] * wi[2];
        let scatters = if side > 0.0 { properties.reflection } else { side == 0.0 || properties.transmission };
        let dark = f.iter().all(|&x| x == 0.0);
        found.holds(scatters || dark, || {
            let (light, what) = if side > 0.0 { ("reflected", "reflection") } else { ("transmitted", "transmission") };
            format!("{}: light is {light}, and no {what} is declared (`scatters`)", subject.at(wi))
        });
    }
    // Weights of samples.
    for (u, sample) in samples {
        let weight = &sample.weight[..properties.channels];
        let at = || format!("{}, u = {}", subject.at(sample.wi), tuple(&u));
        found.holds(weight.iter().all(|w| w.is_finite() && *w >= 0.0), || format!("{}: weight = {weight:?}", at()));
        let above = subject.above_bound(&sample);
        found.holds(above.is_none(), || format!("{}, u = {}", above.unwrap_or_default(), tuple(&u)));
        found.holds(sample.lobe < bsdf.lobes(), || format!("{}: there is no lobe {}", at(), sample.lobe));
        let declared = properties.delta || !sample.is_delta();
        found.holds(declared, || format!("{}: a delta lobe that is not declared", at()));
        let probability = match sample.density {
            Density::Delta(probability) => probability,
            _ => sample.lobe_probability,
        };
        let range = 0.0..=1.0 + properties.precision;
        found.holds(range.contains(&probability), || format!("{}: a probability of {probability}", at()));
    }
    let is_surface = properties.kind == Kind::Surface;
    let remarks = if is_surface { unseen_lobes(subject, lit)? } else { Vec::new() };
    let outcome = found.outcome("the rule that all is finite, not negative and as declared");
    // Snell's law has no solution there, and roots of negative numbers are NaN.
    let sin2 = 1.0 - wo[2] * wo[2];
    let is_total = is_surface && properties.transmission && sin2 > subject.eta2([0.0, 0.0, -wo[2]]);
    let is_nan = |what: &String| what.contains("NaN");
    let total = || "NaN where wo is beyond the critical angle of a smooth surface".to_owned();
    Ok(outcome.map(|outcome| {
        let mistake = outcome.violation.as_ref().filter(|what| is_total && is_nan(what)).map(|_| total().into());
        Outcome { remarks, mistake, ..outcome }
    }))
}

/// From where light comes: the same side of the surface, the other, and delta lobes.
#[derive(Default)]
struct Lit {
    sides: [bool; 2],
    delta: bool,
}

impl Lit {
    /// Takes values and samples of `subject` into account, and its delta lobes.
    fn add(
        &mut self,
        subject: &Subject,
        values: impl Iterator<Item = (Direction, Spectrum)>,
        samples: &[(Vec<f64>, BsdfSample)],
    ) {
        let samples = samples.iter().map(|(_, sample)| (sample.is_delta(), sample.wi, sample.weight));
        let lobes = subject.deltas.iter().map(|lobe| (true, lobe.wi, lobe.throughput));
        for (is_delta, wi, f) in values.map(|(wi, f)| (false, wi, f)).chain(samples).chain(lobes) {
            if f[..subject.properties.channels].iter().any(|f| *f != 0.0) {
                self.sides[usize::from(subject.wo[2] * wi[2] < 0.0)] = true;
                self.delta |= is_delta;
            }
        }
    }

    /// What is declared and gives no light.
    fn missing(&self, properties: &Properties) -> Vec<String> {
        let unseen = [
            (properties.reflection && !self.sides[0], "reflection is declared, and nothing was reflected"),
            (properties.transmission && !self.sides[1], "transmission is declared, and nothing was transmitted"),
            (properties.delta && !self.delta, "delta lobes are declared, and none was found"),
        ];
        unseen.into_iter().filter(|(is_unseen, _)| *is_unseen).map(|(_, remark)| remark.to_owned()).collect()
    }
}

/// Sides and delta lobes that are declared and give no light, neither at `wo` nor along the normals, where nothing is reflected
/// totally.
fn unseen_lobes(subject: &Subject, mut lit: Lit) -> Result<Vec<String>> {
    let Subject { bsdf, properties, .. } = subject;
    for wo in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
        if lit.missing(properties).is_empty() {
            break;
        }
        let normal = Subject::new(*bsdf, wo, subject.protocol, subject.round)?;
        let directions = normal.directions()?;
        let u = vec![0.5; directions.len() * properties.eval_dimension];
        let values = bsdf.eval(&normal.pairs(&directions), &u)?;
        lit.add(&normal, directions.into_iter().zip(values), &normal.samples()?);
    }
    Ok(lit.missing(properties))
}

/// A sample with its random numbers, and its pdf or, of a delta lobe, its probability.
type Drawn<'a> = (&'a Vec<f64>, &'a BsdfSample, f64);

/// Compares weight · pdf with f |cos θᵢ| at samples, and the pdf of each with what `pdf` returns, to the last bit. For samples of
/// delta lobes, probability and weight are those of the lobe.
pub fn formula(subject: &Subject) -> Result<Option<Outcome>> {
    let mut found = Comparison::default();
    let samples = subject.samples_inside()?;
    let (mut spread, mut delta) = (Vec::new(), Vec::new());
    for (u, sample) in &samples {
        let unit = (length(sample.wi) - 1.0).abs() <= 1e-5;
        found.holds(unit, || format!("{}, u = {}: wi is not a unit vector", subject.at(sample.wi), tuple(u)));
        match sample.density {
            Density::Pdf(pdf) if subject.properties.pdf == PdfKind::Exact => spread.push((u, sample, pdf)),
            Density::Delta(probability) => delta.push((u, sample, probability)),
            _ => {}
        }
    }
    carried_pdfs(subject, &spread, &mut found)?;
    if subject.is_deterministic() {
        weights(subject, &spread, &mut found)?;
    }
    delta_lobes(subject, &delta, &mut found)?;
    Ok(found.outcome(match subject.properties.kind {
        Kind::Surface => "weight = f |cos| / pdf",
        Kind::Phase { .. } => "weight = value / pdf",
        Kind::Light { .. } => "weight = radiance / pdf",
    }))
}

fn at(subject: &Subject, (u, sample, _): &Drawn) -> String {
    format!("{}, u = {}", subject.at(sample.wi), tuple(u))
}

fn pairs(subject: &Subject, spread: &[Drawn]) -> Vec<Pair> {
    spread.iter().map(|(_, sample, _)| [subject.wo, sample.wi]).collect()
}

fn carried_pdfs(subject: &Subject, spread: &[Drawn], found: &mut Comparison) -> Result<()> {
    let (mut carried, pairs) = (Carried::default(), pairs(subject, spread));
    let asked = subject.bsdf.pdf(&pairs)?;
    if subject.is_light() {
        // The sample knows its point, and the pdf intersects a ray.
        let numbers: Vec<[f64; 2]> = spread.iter().zip(&asked).map(|((.., pdf), asked)| [*pdf, *asked]).collect();
        let rounding = |far: &[usize]| {
            let (pdfs, pairs): (Vec<f64>, Vec<Pair>) = far.iter().map(|&i| (asked[i], pairs[i])).unzip();
            subject.rounding(&pdfs, &pairs, |pairs| subject.bsdf.pdf(pairs))
        };
        let words =
            |i: usize| (Some(spread[i].1.wi), format!("{} (the sample's pdf, the pdf asked)", at(subject, &spread[i])));
        if !found.equal(&numbers, |i| 16.0 * subject.last_places(numbers[i][1]), rounding, words)? {
            let pairs: Vec<_> = spread.iter().zip(&numbers).map(|(s, n)| (s.1.wi.into(), *n)).collect();
            found.named(explain(subject, &Scattering(subject), &pairs, CARRIED, || Ok(None))?);
        }
    } else {
        for (sample, asked) in spread.iter().zip(asked) {
            let (_, BsdfSample { wi, .. }, pdf) = *sample;
            let words = || {
                let both = different(pdf, asked);
                format!("{}: the sample's pdf {} is not pdf(wo, wi) = {}", at(subject, sample), both[0], both[1])
            };
            carried.count(&Sample::with_pdf(*wi, pdf), asked, 0.0, words);
        }
    }
    if let Some(violation) = carried.violation() {
        found.all_hold(carried.counts(), || violation);
        let used: Vec<f64> = spread.iter().map(|(.., pdf)| *pdf).collect();
        let own = |name: &str| format!("what samples carry is the pdf of their own lobe {name}, not that of all lobes");
        let of_lobes = || Ok(of_own_lobes(subject, spread, &used)?.map(own));
        found.named(explain(subject, &Scattering(subject), &carried.pairs, CARRIED, of_lobes)?);
    }
    for sample in spread {
        found.holds(sample.2 > 0.0, || format!("{}: the pdf of a sample is {}", at(subject, sample), sample.2));
    }
    Ok(())
}

/// The pdf that samples carry, and what it should be.
const CARRIED: [&str; 2] = ["what samples carry", PDF];

/// How the pdfs that are `used`, NaN where they are not known, are those of the lobes that the samples come from, in place of that
/// of all lobes, if they are.
fn of_own_lobes(subject: &Subject, spread: &[Drawn], used: &[f64]) -> Result<Option<&'static str>> {
    if subject.bsdf.lobes() < 2 {
        return Ok(None);
    }
    let pairs = pairs(subject, spread);
    let lobes: Vec<usize> = spread.iter().map(|(_, sample, _)| sample.lobe).collect();
    let (own, all) = (subject.bsdf.lobe_pdf(&pairs, &lobes)?, subject.bsdf.pdf(&pairs)?);
    let is_equal = |a: f64, b: f64| relative_difference(a, b) <= EQUAL;
    let are_own = |is_divided: bool| {
        let mut telling = 0;
        for (((_, sample, _), own), (used, all)) in spread.iter().zip(&own).zip(used.iter().zip(&all)) {
            let Some(own) = own.map(|own| if is_divided { own / sample.lobe_probability } else { own }) else {
                return false;
            };
            if !used.is_nan() && !is_equal(*used, own) {
                return false;
            }
            telling += usize::from(!used.is_nan() && !is_equal(own, *all));
        }
        telling >= FEWEST_PAIRS
    };
    let names = [(false, "times its probability"), (true, "without its probability")];
    Ok(names.into_iter().find(|(is_divided, _)| are_own(*is_divided)).map(|(_, name)| name))
}

/// Whether weights are divided by the pdf of the lobe that was sampled, of a BSDF that says nothing of its lobes. Samples of two lobes in nearly
/// one direction have different weights then, though f |cos θi| and pdf are the same. With the pdf p q₁ + (1 − p) q₂, the pdfs q₁ and q₂ by
/// which the weights were divided have p q₁/pdf + (1 − p) q₂/pdf = 1; where they include their probabilities, their sum is the pdf.
fn of_hidden_lobes(spread: &[Drawn], numbers: &[[f64; 2]]) -> Option<String> {
    /// The cosine of 2°, within which directions are nearly the same, and the factors by which numbers are.
    const NEAR: f64 = 0.9994;
    const SAME: f64 = 1.1;
    const OTHER: f64 = 1.5;
    let within = |a: f64, b: f64, factor: f64| a.at_most(b) * factor >= a.at_least(b);
    // The pdf by which a weight was divided, over the pdf
    let share = |i: usize| numbers[i][1] / numbers[i][0];
    let known: Vec<usize> = (0..spread.len()).filter(|&i| share(i).is_finite() && share(i) > 0.0).collect();
    let pairs = known.iter().enumerate().flat_map(|(k, &i)| known[..k].iter().map(move |&j| [i, j]));
    let is_near = |[i, j]: &[usize; 2]| dot(spread[*i].1.wi, spread[*j].1.wi) >= NEAR;
    let is_other = |[i, j]: &[usize; 2]| {
        let same = within(spread[*i].2, spread[*j].2, SAME) && within(numbers[*i][1], numbers[*j][1], SAME);
        same && !within(share(*i), share(*j), OTHER)
    };
    let shares: Vec<[f64; 2]> =
        pairs.filter(|both| is_near(both) && is_other(both)).map(|both| both.map(share)).collect();
    if shares.len() < FEWEST_PAIRS {
        return None;
    }
    let median = |of: &dyn Fn(&[f64; 2]) -> f64| {
        let mut all: Vec<f64> = shares.iter().map(of).collect();
        all.sort_unstable_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let divided = "the weight is f |cos θi| divided by the pdf of the lobe that was sampled";
    let sum = median(&|[a, b]| a + b);
    let p = median(&|[a, b]| {
        let p = (1.0 - b) / (a - b);
        p.at_most(1.0 - p)
    });
    let misses = median(&|[a, b]| {
        let of = |p: f64| (p * a + (1.0 - p) * b - 1.0).abs();
        of(p).at_most(of(1.0 - p))
    });
    Some(if within(sum, 1.0, SAME) {
        format!("{divided}, times its probability, not by that of all lobes")
    } else if p > 0.0 && misses < SAME - 1.0 {
        format!(
            "{divided}, not by that of all lobes, which has about {:.0} % of it and {:.0} % of another",
            100.0 * (1.0 - p),
            100.0 * p
        )
    } else {
        "the weight depends on more than wo and wi: samples in nearly one direction have different ones".to_owned()
    })
}

fn weights(subject: &Subject, spread: &[Drawn], found: &mut Comparison) -> Result<()> {
    let Subject { bsdf, properties, .. } = subject;
    let kind = &properties.kind;
    let pairs = pairs(subject, spread);
    let values = bsdf.eval(&pairs, &[])?;
    found.named(of_colours(spread, &values, properties.channels));
    for channel in 0..properties.channels {
        let both = spread.iter().zip(&values);
        let numbers: Vec<[f64; 2]> = both
            .map(|((_, sample, pdf), f)| [sample.weight[channel] * pdf, f[channel] * kind.cos(sample.wi)])
            .collect();
        // The weight may be computed without f: its rounding is that of f/pdf at directions a last place away.
        let rounding = |far: &[usize]| {
            let pairs: Vec<Pair> = far.iter().map(|&i| pairs[i]).collect();
            let light: Vec<f64> = far.iter().map(|&i| numbers[i][1]).collect();
            let of_light = subject.rounding(&light, &pairs, |pairs| {
                let values = bsdf.eval(pairs, &[])?.into_iter().zip(pairs);
                Ok(values.map(|(f, [_, wi])| f[channel] * kind.cos(*wi)).collect())
            })?;
            let pdfs: Vec<f64> = far.iter().map(|&i| spread[i].2).collect();
            let of_pdf = subject.rounding(&pdfs, &pairs, |pairs| bsdf.pdf(pairs))?;
            let weight = |i: usize| spread[i].1.weight[channel];
            let both = of_light.iter().zip(of_pdf).zip(far);
            Ok(both.map(|((light, pdf), &i)| light + pdf * weight(i)).collect())
        };
        let message = |i: usize| {
            let words =
                format!("{} (weight · pdf, {}{})", at(subject, &spread[i]), kind.integrand(), subject.channel(channel));
            (Some(spread[i].1.wi), words)
        };
        if !found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)? {
            let wis: Vec<Direction> = spread.iter().map(|(_, sample, _)| sample.wi).collect();
            let is_light = |((_, sample, _), [_, light]): (&Drawn, &[f64; 2])| {
                relative_difference(sample.weight[channel], *light) <= EQUAL
            };
            let used: Vec<f64> = spread
                .iter()
                .zip(&numbers)
                .map(|((_, sample, _), [_, light])| light / sample.weight[channel])
                .collect();
            let own = |name: &str| {
                format!("the weight is f |cos θi| divided by the pdf of its own lobe {name}, not by that of all lobes")
            };
            let undivided = spread.iter().zip(&numbers).all(is_light);
            let special = || match undivided {
                true => Ok(Some(format!("the weight is {}, not divided by the pdf", kind.integrand()))),
                false => {
                    let named = of_own_lobes(subject, spread, &used)?.map(own);
                    Ok(named.or_else(|| of_hidden_lobes(spread, &numbers)))
                }
            };
            let mistake =
                light(subject, channel).explain(&wis, &numbers, ["weight · pdf", kind.integrand()], special)?;
            found.named_in([channel, properties.channels], mistake);
        }
    }
    Ok(())
}

/// The power of the colours of weights that the colours of values are, if these differ: colours are ratios of channels.
fn of_colours(spread: &[Drawn], values: &[Spectrum], channels: usize) -> Option<String> {
    let colour = |of: &dyn Fn(usize) -> Spectrum, channel: usize| {
        let ratios: Vec<f64> = (0..spread.len()).map(|i| of(i)[channel] / of(i)[0]).filter(|r| r.is_finite()).collect();
        common_factor(&ratios).filter(|_| ratios.len() >= FEWEST_PAIRS)
    };
    let powers = (1..channels).map(|channel| {
        let [weight, value] = [colour(&|i| spread[i].1.weight, channel)?, colour(&|i| values[i], channel)?];
        Some(value.ln() / weight.ln())
    });
    let powers: Vec<f64> = powers.collect::<Option<_>>()?;
    let power = common_factor(&powers).filter(|power| power.is_finite() && (power - 1.0).abs() > EQUAL)?;
    (channels > 2).then(|| format!("the colour of f is that of the weights to the power of {}", number(power)))
}

fn delta_lobes(subject: &Subject, samples: &[Drawn], found: &mut Comparison) -> Result<()> {
    let [mut of_probability, mut of_weight] = [Names::default(), Names::default()];
    for sample in samples {
        let (at, &(_, &BsdfSample { wi, weight, .. }, probability)) = (|| at(subject, sample), sample);
        let Some(lobe) = subject.deltas.iter().find(|lobe| sphere().same(lobe.wi.into(), wi.into())) else {
            let known: Vec<String> = subject.deltas.iter().map(|lobe| tuple(&lobe.wi)).collect();
            let known = if known.is_empty() { "there are none".to_owned() } else { known.join(", ") };
            found.holds(false, || format!("{}: {} is none of the delta lobes: {known}", at(), tuple(&wi)));
            let [x, y, z] = wi;
            let is = |a: Direction, b: Direction| sphere().same(a.into(), b.into());
            let is_lobe = |w: Direction| subject.deltas.iter().any(|lobe| is(lobe.wi, w));
            let changed = [
                (is_lobe([-x, -y, -z]), "sampled delta lobes point the opposite way"),
                (is_lobe([x, y, -z]), "sampled delta lobes are on the other side of the surface"),
                (is_lobe([-x, -y, z]), "sampled delta lobes are turned by half about the normal"),
                (is(wi, subject.wo), "sampled delta lobes point to wo"),
            ];
            let changed = changed.into_iter().find(|(is_changed, _)| *is_changed).map(|(_, name)| name.to_owned());
            found.named(changed.or_else(|| of_refraction(subject, wi)));
            continue;
        };
        let mut compare = |numbers: [f64; 2], what: &str| {
            let words = |_| (Some(wi), format!("{} ({what})", at()));
            found.near(&[numbers], |_| subject.last_places(numbers[1]), words)
        };
        if !compare([probability, lobe.probability], "probability of the sample, of the delta lobe")? {
            let others = [(1.0, "1"), (1.0 - lobe.probability, "1 - that of the lobe"), (0.5, "1/2")];
            of_probability.add(
                probability,
                &others.map(|(value, name)| (value, format!("the probability of a sampled delta lobe is {name}"))),
            );
        }
        let (eta2, cos) = (subject.eta2(wi), subject.properties.kind.cos(wi));
        for (channel, weight) in weight.iter().enumerate().take(subject.properties.channels) {
            let product = weight * lobe.probability;
            if !compare([product, lobe.throughput[channel]], "weight · probability, throughput")? {
                let right = lobe.throughput[channel] / lobe.probability;
                let others = [
                    (lobe.throughput[channel], "not divided by its probability"),
                    (right / lobe.probability, "divided by its probability twice"),
                    (right * eta2, "times η²"),
                    (right / eta2, "divided by η²"),
                    (right * cos, "times |cos θi|"),
                    (right / cos, "divided by |cos θi|"),
                ];
                of_weight.add(
                    *weight,
                    &others.map(|(value, name)| (value, format!("the weight of a sampled delta lobe is {name}"))),
                );
            }
        }
    }
    for names in [of_probability, of_weight] {
        let names = names.left.unwrap_or_default().into_iter().map(|name| vec![name]);
        found.named(NamedMistake::one_of("", names.collect(), ""));
    }
    Ok(())
}

/// What sampled and declared transmission make of the sine of `wo`.
fn of_refraction(subject: &Subject, wi: Direction) -> Option<String> {
    let sine = |w: Direction| w[0].hypot(w[1]);
    let (wo, transmits) = (subject.wo, |wi: Direction| !same_side(subject.wo, wi));
    let is_refraction = |wi: Direction| transmits(wi) && (wo[0] * wi[1] - wo[1] * wi[0]).abs() <= EQUAL * sine(wo);
    let declared = subject.deltas.iter().map(|lobe| lobe.wi).find(|wi| is_refraction(*wi))?;
    let known = sine(wo) > EQUAL && is_refraction(wi);
    let [sampled, declared] = [wi, declared].map(|wi| number(sine(wi) / sine(wo)));
    known.then(|| {
        format!("sampled transmission has {sampled} times the sine of wo, the declared delta lobe {declared} times")
    })
}

/// Names of mistakes, of which those are left that explain all numbers.
#[derive(Default)]
struct Names {
    left: Option<Vec<String>>,
}

impl Names {
    /// Keeps the names whose value is the number.
    fn add(&mut self, number: f64, others: &[(f64, String)]) {
        let equal = others.iter().filter(|(value, _)| relative_difference(number, *value) <= EQUAL);
        let names: Vec<String> = equal.map(|(_, name)| name.clone()).collect();
        match &mut self.left {
            Some(left) => left.retain(|name| names.contains(name)),
            None => self.left = Some(names),
        }
    }
}

/// Adds the pdfs of all lobes, each times the lobe's probability, and compares the sum with the pdf.
pub fn partition(subject: &Subject) -> Result<Option<Outcome>> {
    let Subject { bsdf, properties, .. } = subject;
    if bsdf.lobes() < 2 || properties.pdf != PdfKind::Exact {
        return Ok(None);
    }
    let samples = subject.samples()?;
    let sampled = samples.iter().filter(|(_, sample)| !sample.is_delta()).map(|(_, sample)| sample.wi);
    let directions: Vec<Direction> = sampled.chain(subject.directions()?).collect();
    let pairs = subject.pairs(&directions);
    let mut numbers: Vec<[f64; 2]> = bsdf.pdf(&pairs)?.into_iter().map(|pdf| [0.0, pdf]).collect();
    for lobe in 0..bsdf.lobes() {
        for (numbers, pdf) in numbers.iter_mut().zip(bsdf.lobe_pdf(&pairs, &vec![lobe; pairs.len()])?) {
            let Some(pdf) = pdf else { return Ok(None) };
            numbers[0] += pdf;
        }
    }
    let rounding = |far: &[usize]| {
        let (pdfs, pairs): (Vec<f64>, Vec<_>) = far.iter().map(|&i| (numbers[i][1], pairs[i])).unzip();
        subject.rounding(&pdfs, &pairs, |pairs| bsdf.pdf(pairs))
    };
    let message = |i: usize| (Some(directions[i]), format!("{} (sum over the lobes, pdf)", subject.at(directions[i])));
    let mut found = Comparison::default();
    found.equal(&numbers, |i| subject.last_places(numbers[i][1]), rounding, message)?;
    Ok(found.outcome("pdf = Σ of the lobes' pdfs"))
}
