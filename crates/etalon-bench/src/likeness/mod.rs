//! Whether a BSDF is the model that it claims to be: its values, its pdf and its delta lobes against those of a BSDF of this program
//! over all angles and over the range of its parameters; and if it is not, how it differs, in words.
//!
//! Microfacet models are compared in f64, with their known variants (`variants.rs`): a variant is named only if it explains all values
//! and the model does not. Other models are compared as they render, in single precision.

mod variants;

use crate::validation::families::{self, Family};
use etalon_core::bsdf::Bsdf;
use etalon_core::error::{Error, Result};
use etalon_core::optics::microfacet::Distribution;
use etalon_core::sampling::warp;
use etalon_stats::bsdf::{BatchBsdf, BsdfSample, Direction, Family as _, Pair, PdfKind, Spectrum};
use etalon_stats::{Compared, Extremes, NamedMistake, Outcome};
use variants::{Candidate, FACTORS, Material, Surface};

/// Relative differences that count: those of constants with three digits, such as 0.318 for 1/π, are above.
const EQUAL: f64 = 5e-4;
/// Values below this share of the largest for one `wo` are not compared: nobody sees them, and rounding may.
const SEEN: f64 = 1e-5;
/// The largest difference is told among values above this share, if there is one.
const BRIGHT: f64 = 1e-2;
/// Most ways in which a named variant differs from the model.
const CHANGES: usize = 2;
/// Angles of `wo` with the normal, in degrees, and its azimuths, which tell apart the widths along x and y.
const ANGLES: [f64; 6] = [5.0, 30.0, 55.0, 70.0, 80.0, 87.0];
const AZIMUTHS: [[f64; 2]; 2] = [[0.96, 0.28], [-0.28, 0.96]];
/// Directions `wi` that the model samples for each `wo`, and as many that the cosine does, along each side of a square.
const SIDE: usize = 8;
/// Values of each parameter at which a BSDF is compared, as shares of its range.
const SHARES: [f64; 4] = [0.3, 0.6, 0.8, 1.0];
/// Multiples of the golden ratio are uniform modulo 1.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// One of this many pairs is drawn.
const SHOWN: usize = 5;
/// Units of the last place by which each coordinate of the two directions may be rounded.
const MOVED: f64 = 16.0;

/// The claim that a BSDF is one of this program's, with some of its parameters.
pub struct Claim {
    family: Family,
    chosen: Vec<(String, f64)>,
    /// The reflectance of a metal at normal incidence, in place of its index of refraction.
    f0: Option<f64>,
}

/// What that is called among the parameters.
const F0: &str = "f0";

fn is_metal(family: &Family) -> bool {
    family.parameters().iter().any(|parameter| parameter.name == "k")
}

/// The parameters of a family that `name` means: those of that name, or of both axes for a width without one.
fn meant(family: &Family, name: &str) -> Vec<String> {
    let all = family.parameters().into_iter().map(|parameter| parameter.name);
    all.filter(|known| {
        known == name || known.strip_suffix("_x") == Some(name) || known.strip_suffix("_y") == Some(name)
    })
    .collect()
}

impl Claim {
    /// The claim to be the BSDF called `name`, with these values of its parameters: `alpha` sets those along x and y.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an unknown name.
    pub fn new(name: &str, chosen: &[(String, f64)]) -> Result<Self> {
        let family = families::all().into_iter().find(|family| family.name() == name).ok_or_else(|| {
            let known: Vec<String> = families::all().iter().map(|family| family.name().to_owned()).collect();
            Error::parameter("like", format!("there is no BSDF \"{name}\""))
                .with_hint(format!("the BSDFs: {}", known.join(", ")))
        })?;
        let f0 = chosen.iter().find(|(name, _)| name == F0 && is_metal(&family)).map(|(_, f0)| *f0);
        if let Some(f0) = f0.filter(|f0| !(0.0..=1.0).contains(f0)) {
            return Err(Error::parameter("set", format!("{F0} = {f0} is not from 0 to 1")));
        }
        let chosen =
            chosen.iter().flat_map(|(name, value)| meant(&family, name).into_iter().map(|name| (name, *value)));
        let chosen = chosen.collect();
        Ok(Self { family, chosen, f0 })
    }

    pub fn name(&self) -> &str {
        self.family.name()
    }

    pub fn has(&self, name: &str) -> bool {
        !meant(&self.family, name).is_empty() || name == F0 && is_metal(&self.family)
    }

    /// Compares the BSDFs of `family` with the model: the one whose parameters have these `values`, and those in which one parameter that
    /// both have goes over its range. The first difference decides.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter of the model without a value; those of the BSDF.
    pub fn examine(&self, family: &dyn etalon_stats::bsdf::Family, values: &[f64]) -> Result<Outcome> {
        let parameters = family.parameters();
        let fixed = |name: &str| self.chosen.iter().any(|(chosen, _)| meant(&self.family, name).contains(chosen));
        let mut configurations = vec![values.to_vec()];
        for (i, parameter) in parameters.iter().enumerate().filter(|(_, p)| self.has(&p.name) && !fixed(&p.name)) {
            configurations.extend(SHARES.map(|share| {
                let mut other = values.to_vec();
                other[i] = parameter.at(share);
                other
            }));
        }
        let mut whole = Outcome::open(0);
        let mut named: Option<(Vec<Variant>, String)> = None;
        for values in &configurations {
            let is_open = named.as_ref().is_some_and(|(names, _)| !names.is_empty());
            if whole.violation.is_some() && !is_open {
                break;
            }
            let own = parameters.iter().map(|parameter| parameter.name.clone()).zip(values.iter().copied());
            let own: Vec<(String, f64)> = own.filter(|(name, _)| self.has(name)).collect();
            let (found, variants) = self.compare(&*family.with(values)?, &own)?;
            if whole.violation.is_some() {
                // Only what explains the values of other parameters, too, is a name: some of its changes may make no difference there.
                if let Some((names, _)) = named.as_mut().filter(|_| found.violation.is_some()) {
                    let has = |name: &Variant, other: &Variant| other.iter().all(|change| name.contains(change));
                    names.retain(|name| variants.iter().any(|other| has(name, other)));
                }
                continue;
            }
            if found.violation.is_some() && !variants.is_empty() {
                named = Some((variants, at(&own)));
            }
            let Outcome { samples, remarks, .. } = whole;
            let new = found.remarks.into_iter().filter(|remark| !remarks.contains(remark)).collect::<Vec<_>>();
            whole = Outcome { samples: samples + found.samples, remarks: [remarks, new].concat(), ..found };
        }
        if let Some((names, at)) = named {
            whole.mistake = match names.is_empty() {
                false => self.named(&names),
                true => whole.mistake.map(|mistake| mistake.with_suffix(&format!("{at} alone"))),
            };
        }
        Ok(whole)
    }

    /// Which variants it is.
    fn named(&self, variants: &[Variant]) -> Option<NamedMistake> {
        let variants: Vec<String> = variants.iter().map(|changes| changes.join(", and ")).collect();
        let name = format!("it is {} with {}", self.name(), variants.join(", or "));
        (!variants.is_empty()).then(|| name.into())
    }

    /// Compares a BSDF, of which these parameters are known besides those that were chosen, and says which variants it may be.
    fn compare(&self, bsdf: &dyn BatchBsdf, own: &[(String, f64)]) -> Result<(Outcome, Vec<Variant>)> {
        let found = self.model(own)?.compare(bsdf)?;
        let at = at(own);
        let mut outcome = Outcome { detectable: Some(EQUAL), remarks: found.remarks, ..Outcome::open(found.compared) };
        let mut all = Vec::new();
        if let Some(Difference { words, variants, numbers }) = found.difference {
            let law = format!("having the values of {}{at}", self.name());
            outcome.mistake = self.named(&variants);
            all = variants;
            outcome.violation = Some(format!("not the values of {}{at}: {words}", self.name()));
            let places: Vec<_> = numbers.into_iter().map(|(wi, numbers)| (wi.into(), numbers)).collect();
            outcome.compared = (!places.is_empty()).then_some(Compared { law, places });
        }
        Ok((outcome, all))
    }

    /// Compares a BSDF without parameters of its own.
    ///
    /// # Errors
    /// As [`examine`](Self::examine).
    pub fn of_bsdf(&self, bsdf: &dyn BatchBsdf) -> Result<Outcome> {
        Ok(self.compare(bsdf, &[])?.0)
    }

    /// The model with these parameters of the BSDF, besides those that were chosen.
    fn model(&self, own: &[(String, f64)]) -> Result<Model<'_>> {
        let all = own.iter().flat_map(|(name, value)| meant(&self.family, name).into_iter().map(|name| (name, *value)));
        let mut known: Vec<(String, f64)> = all.collect();
        for (name, value) in &self.chosen {
            known.retain(|(other, _)| other != name);
            known.push((name.clone(), *value));
        }
        let parameters = self.family.parameters();
        let missing: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let missing: Vec<&str> =
            missing.into_iter().filter(|name| known.iter().all(|(other, _)| other != name)).collect();
        let is_by_schlick = is_metal(&self.family) && missing.ends_with(&["eta", "k"]);
        let missing = if is_by_schlick { &missing[..missing.len() - 2] } else { &missing };
        if !missing.is_empty() {
            return Err(Error::parameter("like", format!("{} needs {}", self.name(), missing.join(" and ")))
                .with_hint(format!("`set` {}=…", missing[0].trim_end_matches("_x"))));
        }
        let values = families::values(&self.family, &known)?;
        let surface = match self.family.bsdf(&values) {
            Bsdf::Ggx(_) => Some(Distribution::Ggx),
            Bsdf::Beckmann(_) => Some(Distribution::Beckmann),
            Bsdf::GgxDielectric(_) => Some(Distribution::Ggx),
            Bsdf::BeckmannDielectric(_) => Some(Distribution::Beckmann),
            _ => None,
        };
        let surface = surface.map(|distribution| {
            let material = match values[..] {
                [_, _, eta, k] if !is_by_schlick => Material::Metal([eta, k]),
                [_, _, eta] => Material::Dielectric(eta),
                _ => Material::Schlick(self.f0),
            };
            Surface { distribution, alpha: [values[0], values[1]], material }
        });
        Ok(Model { family: &self.family, values, surface })
    }
}

/// The values of parameters in words.
fn at(own: &[(String, f64)]) -> String {
    let at: Vec<String> = own.iter().map(|(name, value)| format!("{name} = {}", rounded(*value))).collect();
    if at.is_empty() { String::new() } else { format!(" at {}", at.join(", ")) }
}

/// How a variant differs from the model: one or more changes, in words.
type Variant = Vec<String>;

/// Another value of a parameter, and its name.
type Changed = (&'static str, fn(f64) -> f64);

/// A BSDF of this program.
struct Model<'a> {
    family: &'a Family,
    values: Vec<f64>,
    /// If it is a microfacet model with known variants.
    surface: Option<Surface>,
}

/// What a comparison found.
#[derive(Default)]
struct Likeness {
    compared: u64,
    difference: Option<Difference>,
    remarks: Vec<String>,
}

#[derive(Default)]
struct Difference {
    words: String,
    variants: Vec<Variant>,
    /// Directions `wi` with the value that was found and that of the model.
    numbers: Vec<(Direction, [f64; 2])>,
}

impl Difference {
    fn said(words: String) -> Self {
        Self { words, ..Self::default() }
    }
}

impl Model<'_> {
    fn compare(&self, bsdf: &dyn BatchBsdf) -> Result<Likeness> {
        let model = self.family.with(&self.values)?;
        let properties = bsdf.properties();
        if properties.transmission != model.properties().transmission {
            let of = |transmits: bool| if transmits { "transmits light" } else { "transmits no light" };
            let difference =
                format!("it {}, {} {}", of(properties.transmission), self.family.name(), of(!properties.transmission));
            return Ok(Likeness { difference: Some(Difference::said(difference)), ..Likeness::default() });
        }
        let wos = wos(properties.precision);
        let difference = deltas(bsdf, &*model, &wos)?.map(Difference::said);
        let mut found = Likeness { difference, ..Likeness::default() };
        let pairs = pairs(&*model, &wos)?;
        if found.difference.is_some() || pairs.is_empty() {
            return Ok(found);
        }
        let stochastic = properties.eval_dimension;
        if stochastic > 0 {
            found.remarks.push("values are random: only delta lobes were compared".to_owned());
            return Ok(found);
        }
        let values = bsdf.eval(&pairs, &[])?;
        found.compared = (pairs.len() * properties.channels) as u64;
        for channel in 0..properties.channels {
            let of_channel: Vec<f64> = values.iter().map(|value| value[channel]).collect();
            let told = self.explain(&*model, &pairs, &of_channel, properties.precision, &mut found.remarks)?;
            found.difference = found.difference.or(told);
        }
        if found.difference.is_none() && properties.pdf == PdfKind::Exact {
            found.remarks.extend(self.pdf(&*model, bsdf, &pairs)?);
        }
        Ok(found)
    }

    /// How `found` differs from the values of the model, and the variant of it that has these values; `None` if it does not.
    fn explain(
        &self,
        model: &dyn BatchBsdf,
        pairs: &[Pair],
        found: &[f64],
        precision: f64,
        remarks: &mut Vec<String>,
    ) -> Result<Option<Difference>> {
        if let Some((value, pair)) = found.iter().zip(pairs).find(|(value, _)| !value.is_finite()) {
            let [wo, wi] = pair.map(theta);
            return Ok(Some(Difference::said(format!("{value} for wo at {wo} and wi at {wi}"))));
        }
        let expected = self.candidates(model, pairs, found, 0)?.swap_remove(0);
        let rounding = self.rounding(model, pairs, &expected.values, precision)?;
        let compared = Comparison { pairs, found, rounding };
        if compared.largest(&expected.values, SEEN).is_none() {
            remarks.extend(
                expected
                    .fitted
                    .map(|f0| format!("its reflectance at normal incidence is {}, by Schlick's formula", rounded(f0))),
            );
            return Ok(None);
        }
        let eta =
            if let Some(Material::Dielectric(eta)) = self.surface.map(|surface| surface.material) { eta } else { 1.0 };
        let mut variants: Vec<(usize, Variant, Option<f64>)> = Vec::new();
        for (f, (factor_name, factor)) in FACTORS.into_iter().enumerate() {
            let factors = factors(pairs, factor, eta);
            let without: Vec<f64> = found.iter().zip(&factors).map(|(found, factor)| found / factor).collect();
            for candidate in &self.candidates(model, pairs, &without, CHANGES - usize::from(f > 0))? {
                let changes = candidate.changes.len() + usize::from(f > 0);
                if variants.iter().any(|(least, ..)| changes > *least) {
                    continue;
                }
                let values: Vec<f64> =
                    candidate.values.iter().zip(&factors).map(|(value, factor)| value * factor).collect();
                let names = candidate.changes.iter().copied().chain(Some(factor_name).filter(|_| f > 0));
                let mut name: Variant = names.map(str::to_owned).collect();
                if compared.largest(&values, SEEN).is_none() {
                    variants.push((changes, name, candidate.fitted));
                } else if changes < CHANGES
                    && let Some(constant) = compared.constant(&values)
                {
                    name.push(format!("values {}", brightness(constant)));
                    variants.push((changes + 1, name, candidate.fitted));
                }
            }
        }
        let least = variants.iter().map(|(changes, ..)| *changes).min();
        variants.retain(|(changes, ..)| Some(*changes) == least);
        // A reflectance that was fitted is that of the variant
        let fitted = variants.first().map_or(expected.fitted, |(.., fitted)| *fitted);
        let expected = match (self.surface, fitted) {
            (Some(surface), Some(f0)) => {
                let known = Surface { material: Material::Schlick(Some(f0)), ..surface };
                known.candidates(pairs, found, 0).swap_remove(0)
            }
            _ => expected,
        };
        let difference = [
            compared.in_words(&expected.values),
            fitted.map_or(String::new(), |f0| {
                format!(" (Schlick's reflectance at normal incidence fitted: {})", rounded(f0))
            }),
            match (variants.is_empty(), fitted) {
                (true, Some(_)) => "; none of the known variants has these values (without eta and k no exact Fresnel \
                                    reflectance was tried)"
                    .to_owned(),
                (true, None) => "; none of the known variants has these values".to_owned(),
                (false, _) => String::new(),
            },
        ];
        let variants = variants.into_iter().map(|(_, name, _)| name).collect();
        Ok(Some(Difference { words: difference.concat(), variants, numbers: compared.numbers(&expected.values) }))
    }

    /// The model and its variants of at most `most` changes, with the values of each.
    fn candidates(&self, model: &dyn BatchBsdf, pairs: &[Pair], found: &[f64], most: usize) -> Result<Vec<Candidate>> {
        if let Some(surface) = self.surface {
            return Ok(surface.candidates(pairs, found, most));
        }
        let of = |values: Vec<Spectrum>| values.into_iter().map(|value| value[0]).collect();
        let mut all = vec![Candidate { changes: Vec::new(), values: of(model.eval(pairs, &[])?), fitted: None }];
        for (i, parameter) in self.family.parameters().iter().enumerate().filter(|_| most > 0) {
            let others: [Changed; 4] = [
                ("the square of a parameter", |x| x * x),
                ("the root of a parameter", f64::sqrt),
                ("half of a parameter", |x| 0.5 * x),
                ("twice a parameter", |x| 2.0 * x),
            ];
            for (name, other) in others {
                let mut values = self.values.clone();
                values[i] = other(values[i]);
                let [from, to] = parameter.range;
                if (from..=to).contains(&values[i]) {
                    let other = self.family.with(&values)?;
                    all.push(Candidate { changes: vec![name], values: of(other.eval(pairs, &[])?), fitted: None });
                }
            }
        }
        Ok(all)
    }

    /// What rounding of the directions may change of the model's values.
    fn rounding(&self, model: &dyn BatchBsdf, pairs: &[Pair], expected: &[f64], precision: f64) -> Result<Vec<f64>> {
        // The model itself is computed in single precision if it has no variants
        let precision = if self.surface.is_some() { precision } else { f64::from(f32::EPSILON) };
        let mut changes = vec![0.0; pairs.len()];
        for (which, axis) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)] {
            let moved: Vec<Pair> = pairs
                .iter()
                .map(|pair| {
                    let mut pair = *pair;
                    pair[which][axis] *= 1.0 + MOVED * precision;
                    pair
                })
                .collect();
            let values = self.candidates(model, &moved, expected, 0)?.swap_remove(0).values;
            for ((change, value), expected) in changes.iter_mut().zip(values).zip(expected) {
                let by = (value - expected).abs();
                *change += if by.is_finite() { by } else { 0.0 };
            }
        }
        Ok(changes)
    }

    /// How directions are sampled, where that differs from the model.
    fn pdf(&self, model: &dyn BatchBsdf, bsdf: &dyn BatchBsdf, pairs: &[Pair]) -> Result<Option<String>> {
        let found = bsdf.pdf(pairs)?;
        let known = match self.surface {
            Some(surface) => surface.pdfs(pairs),
            None => vec![("the model's pdf", model.pdf(pairs)?)],
        };
        let compared = Comparison { pairs, found: &found, rounding: vec![0.0; pairs.len()] };
        let of_model = model.pdf(pairs)?;
        let model = Comparison { pairs, found: &of_model, rounding: vec![0.0; pairs.len()] };
        let [same, own] =
            [&compared, &model].map(|compared| known.iter().position(|(_, pdf)| compared.largest(pdf, SEEN).is_none()));
        let own = own.unwrap_or(0);
        Ok(match same {
            Some(i) if i == own => None,
            Some(i) => Some(format!("it samples by {}, {} by {}", known[i].0, self.family.name(), known[own].0)),
            None => {
                let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
                Some(format!("its pdf is none of those known: {}", names.join(", ")))
            }
        })
    }
}

/// Directions `wo`, in single precision for a BSDF that computes in it.
fn wos(precision: f64) -> Vec<Direction> {
    let all = ANGLES.into_iter().flat_map(|theta| AZIMUTHS.map(|azimuth| (theta.to_radians(), azimuth)));
    let wos = all.map(|(theta, [x, y])| [theta.sin() * x, theta.sin() * y, theta.cos()]);
    if precision < f64::from(f32::EPSILON) {
        wos.collect()
    } else {
        wos.map(|wo| wo.map(|x| f64::from(x as f32))).collect()
    }
}

/// Each `wo` with directions that the model samples, and with directions distributed by the cosine on each side that it scatters to.
fn pairs(model: &dyn BatchBsdf, wos: &[Direction]) -> Result<Vec<Pair>> {
    let grid: Vec<[f64; 2]> =
        (0..SIDE * SIDE).map(|i| [i % SIDE, i / SIDE].map(|k| (k as f64 + 0.5) / SIDE as f64)).collect();
    let transmits = model.properties().transmission;
    let sides: Vec<[f64; 2]> =
        if transmits { vec![[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] } else { vec![[1.0, 1.0]] };
    let mut pairs = Vec::new();
    for [x, y, z] in wos {
        for [of_wo, of_wi] in &sides {
            let wo = [*x, *y, of_wo * z];
            // The first number chooses the lobe
            let numbers = |(i, u): (usize, &[f64; 2])| [(i as f64 * GOLDEN).fract(), u[0], u[1]];
            let u: Vec<f64> = grid.iter().enumerate().flat_map(numbers).collect();
            let samples = model.sample(&vec![wo; grid.len()], &u)?;
            let is_spread = |sample: &BsdfSample| !sample.is_delta();
            if *of_wi > 0.0 {
                pairs.extend(samples.into_iter().flatten().filter(is_spread).map(|sample| [wo, sample.wi]));
            }
            pairs.extend(grid.iter().map(|u| {
                let [x, y, z] = warp::cosine_hemisphere(*u).to_array();
                [wo, [x, y, of_wo * of_wi * z]]
            }));
        }
    }
    Ok(pairs)
}

/// How the delta lobes of a BSDF differ from those of the model.
fn deltas(bsdf: &dyn BatchBsdf, model: &dyn BatchBsdf, wos: &[Direction]) -> Result<Option<String>> {
    let channels = bsdf.properties().channels;
    for (wo, (found, expected)) in wos.iter().zip(bsdf.delta_lobes(wos)?.into_iter().zip(model.delta_lobes(wos)?)) {
        let theta = theta(*wo);
        let lit = |lobe: &&etalon_stats::bsdf::DeltaLobe| lobe.throughput[..channels].iter().any(|t| *t > 0.0);
        let (found, expected): (Vec<_>, Vec<_>) =
            (found.iter().filter(lit).collect(), expected.iter().filter(lit).collect());
        if found.len() != expected.len() {
            let (found, expected) = (found.len(), expected.len());
            return Ok(Some(format!("for wo at {theta} the number of delta lobes is {found}, not {expected}")));
        }
        for expected in expected {
            let distance = |w: Direction| (0..3).map(|axis| (w[axis] - expected.wi[axis]).powi(2)).sum::<f64>().sqrt();
            let same = found.iter().find(|lobe| distance(lobe.wi) < EQUAL);
            let side = if expected.wi[2] * wo[2] > 0.0 { "reflected" } else { "transmitted" };
            let Some(lobe) = same else {
                return Ok(Some(format!(
                    "no light is {side} to the direction of the model's delta lobe, for wo at {theta}"
                )));
            };
            for (t, model) in lobe.throughput[..channels].iter().zip(expected.throughput) {
                if (t - model).abs() > EQUAL * model.abs() {
                    let (t, model) = (rounded(*t), rounded(model));
                    return Ok(Some(format!("the factor of {side} radiance is {t}, not {model}, for wo at {theta}")));
                }
            }
        }
    }
    Ok(None)
}

/// The factor of each pair, for a surface of this index below over that above.
fn factors(pairs: &[Pair], factor: fn(Pair, f64) -> f64, index: f64) -> Vec<f64> {
    pairs.iter().map(|pair| factor(*pair, if pair[0][2] > 0.0 { index } else { 1.0 / index })).collect()
}

/// Values with what rounding may change of them.
struct Comparison<'a> {
    pairs: &'a [Pair],
    found: &'a [f64],
    rounding: Vec<f64>,
}

/// A relative difference, found over expected minus 1, with both values and their pair.
#[derive(Clone, Copy)]
struct OfPair {
    size: f64,
    values: [f64; 2],
    pair: Pair,
}

impl Comparison<'_> {
    /// The differences that count, and those of equal values where either is seen; infinite where the model scatters no light.
    fn differences<'a>(&'a self, expected: &'a [f64], seen: f64) -> impl Iterator<Item = (OfPair, bool)> + 'a {
        let light = |f: f64, pair: &Pair| f.abs() * pair[1][2].abs();
        let mut most: Vec<(Direction, f64)> = Vec::new();
        for ((found, expected), pair) in self.found.iter().zip(expected).zip(self.pairs) {
            // Values that are no numbers, which a fit without data has, hide no others.
            let light = light(if expected.is_finite() { found.at_least(*expected) } else { *found }, pair);
            match most.last_mut() {
                Some((wo, most)) if *wo == pair[0] => *most = most.at_least(light),
                _ => most.push((pair[0], light)),
            }
        }
        let all = self.found.iter().zip(expected).zip(self.pairs.iter().zip(&self.rounding));
        all.filter_map(move |((&found, &expected), (pair, rounding))| {
            let most = most.iter().filter(|(wo, _)| *wo == pair[0]).map(|(_, most)| *most).fold(0.0, f64::at_least);
            let larger = found.abs().at_least(expected.abs());
            let is_seen = !expected.is_finite() || larger > 0.0 && light(larger, pair) >= seen * most;
            let is_equal = larger.is_finite() && (found - expected).abs() <= EQUAL * larger + rounding;
            is_seen
                .then(|| (OfPair { size: found / expected - 1.0, values: [found, expected], pair: *pair }, !is_equal))
        })
    }

    /// The largest difference that counts, of values above a share of the largest for one `wo`.
    fn largest(&self, expected: &[f64], seen: f64) -> Option<OfPair> {
        let differing =
            self.differences(expected, seen).filter(|(_, differs)| *differs).map(|(difference, _)| difference);
        differing.max_by(|a, b| a.size.abs().total_cmp(&b.size.abs()))
    }

    /// The largest difference that is told: of bright values, or of dark ones where bright ones are equal.
    fn worst(&self, expected: &[f64]) -> Option<OfPair> {
        self.largest(expected, BRIGHT).or_else(|| self.largest(expected, SEEN))
    }

    /// Some of the bright values, and the one that differs most, with those of the model.
    fn numbers(&self, expected: &[f64]) -> Vec<(Direction, [f64; 2])> {
        let bright = self.differences(expected, BRIGHT).map(|(difference, _)| difference);
        let shown = bright.step_by(SHOWN).chain(self.worst(expected));
        shown.filter(|of| of.values.iter().all(|value| *value > 0.0)).map(|of| (of.pair[1], of.values)).collect()
    }

    /// The constant by which all values differ, if one does.
    fn constant(&self, expected: &[f64]) -> Option<f64> {
        let mut ratios: Vec<f64> =
            self.differences(expected, SEEN).map(|(difference, _)| 1.0 + difference.size).collect();
        ratios.sort_by(f64::total_cmp);
        let constant = ratios.get(ratios.len() / 2).copied().filter(|ratio| ratio.is_finite() && *ratio > 0.0)?;
        let scaled: Vec<f64> = expected.iter().map(|value| constant * value).collect();
        self.largest(&scaled, SEEN).is_none().then_some(constant)
    }

    /// Sizes and places of the differences: everywhere the same, or in the median and at most, and how they change with the angle.
    fn in_words(&self, expected: &[f64]) -> String {
        if let Some(constant) = self.constant(expected) {
            return format!("{} everywhere", brightness(constant));
        }
        let all: Vec<OfPair> = self.differences(expected, SEEN).map(|(difference, _)| difference).collect();
        let Some(worst) = self.worst(expected) else { return String::new() };
        let median = |of: &dyn Fn(&OfPair) -> bool| {
            let mut sizes: Vec<f64> = all.iter().filter(|d| of(d)).map(|d| d.size).collect();
            sizes.sort_by(f64::total_cmp);
            sizes.get(sizes.len() / 2).copied().unwrap_or(0.0)
        };
        let [first, last] = [all.first(), all.last()].map(|d| d.map_or(worst.pair[0], |d| d.pair[0]));
        let by_angle = [first, last].map(|wo| (theta(wo), brightness(1.0 + median(&|d| d.pair[0] == wo))));
        let most = brightness(1.0 + worst.size);
        let [(near, at_near), (far, at_far)] = by_angle;
        let [wo, wi] = worst.pair.map(theta);
        format!("{most} for wo at {wo} and wi at {wi}; in the median {at_near} for wo at {near} and {at_far} at {far}")
    }
}

/// The angle of a direction with the normal, in words.
fn theta(w: Direction) -> String {
    format!("{:.0}°", w[2].clamp(-1.0, 1.0).acos().to_degrees())
}

/// A factor of values in words.
fn brightness(factor: f64) -> String {
    let percent = 100.0 * (factor - 1.0);
    match factor {
        _ if !factor.is_finite() => "bright where the model is black".to_owned(),
        _ if percent.abs() < 0.05 => "equal".to_owned(),
        _ if (0.0..=2.0).contains(&factor) => {
            let word = if percent > 0.0 { "bright" } else { "dark" };
            format!("{:.*} % too {word}", usize::from(percent.abs() < 10.0), percent.abs())
        }
        _ if factor > 0.0 => format!("{} times as bright", rounded(factor)),
        _ => "negative".to_owned(),
    }
}

/// A number with three or four digits.
fn rounded(x: f64) -> String {
    let text = format!("{x:.3e}");
    let is_short = (1e-4..1e6).contains(&x.abs()) || x == 0.0;
    text.parse::<f64>().ok().filter(|_| is_short).map_or(text, |x| x.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validation::planted::faulty::{Change, Faulty};
    use crate::validation::planted::rough::{Facets, Rough};
    use etalon_stats::bsdf::Parameter;

    /// What `claim` says of the BSDF of this program with these values of its parameters.
    fn examine(claim: &str, chosen: &[(&str, f64)], name: &str, values: &[f64]) -> Outcome {
        let chosen: Vec<(String, f64)> = chosen.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        let family = families::all().into_iter().find(|family| family.name() == name).unwrap();
        Claim::new(claim, &chosen).unwrap().examine(&family, values).unwrap()
    }

    #[test]
    fn every_bsdf_is_itself() {
        for family in families::all() {
            let values: Vec<f64> = family.parameters().iter().map(|parameter| parameter.value).collect();
            let found = examine(family.name(), &[], family.name(), &values);
            assert_eq!(found.violation, None, "{}", family.name());
        }
    }

    #[test]
    fn models_that_are_not_meant_are_rejected_and_variants_named() {
        let gold = [0.3, 0.3, 0.2, 3.0];
        let named = |found: Outcome| found.mistake.unwrap_or_else(|| panic!("{:?}", found.violation)).to_string();
        let beckmann = examine("ggx", &[("alpha", 0.3)], "beckmann", &gold);
        assert!(named(beckmann).contains("Beckmann's normals"));
        let squared = examine("ggx", &[("alpha", 0.3)], "ggx", &[0.09, 0.09, 0.2, 3.0]);
        assert!(named(squared).contains("α² where α is meant"));
        let dark = examine("diffuse", &[("albedo", 0.5)], "diffuse", &[0.4]);
        assert!(named(dark).contains("20 % too dark"));
        let other = examine("diffuse", &[("albedo", 0.8)], "oren-nayar", &[0.8, 40.0]);
        assert_eq!(other.mistake, None, "{:?}", other.violation);
        assert!(other.violation.unwrap().contains("none of the known variants"));
    }

    /// A metal by Schlick's formula, of which nothing but α is given.
    #[test]
    fn an_unknown_reflectance_is_found() {
        let metal = Rough { alpha: [0.2, 0.2], facets: Facets::Conductor(0.9) };
        let found = Claim::new("ggx", &[("alpha".to_owned(), 0.2)]).unwrap().of_bsdf(&metal).unwrap();
        assert_eq!(found.violation, None);
        assert_eq!(found.remarks, ["its reflectance at normal incidence is 0.9, by Schlick's formula"]);
    }

    /// Where a candidate's normals are too narrow to be a number, and no reflectance can be fitted, it explains nothing.
    #[test]
    fn a_lobe_of_another_model_has_no_name() {
        let lobe = |_: &Rough, wo: Direction, wi: Direction| {
            let [x, y, z] = [0, 1, 2].map(|i| wo[i] + wi[i]);
            (z / (x * x + y * y + z * z).sqrt()).powi(20) / std::f64::consts::PI
        };
        for (model, alpha) in [("beckmann", 0.3), ("beckmann", 0.03), ("ggx", 0.3), ("ggx", 0.1)] {
            let right = Rough { alpha: [alpha, alpha], facets: Facets::Conductor(0.9) };
            let other = Faulty { right, change: Some(Change::ValueAndWeight(lobe)) };
            let found = Claim::new(model, &[("alpha".to_owned(), alpha)]).unwrap().of_bsdf(&other).unwrap();
            assert_eq!(found.mistake, None, "{model} {alpha}");
            assert!(!found.violation.unwrap().contains("NaN"), "{model} {alpha}");
        }
    }

    /// Metals of one parameter, by which their width is not what it should be.
    struct Widths(fn(f64) -> f64);

    impl etalon_stats::bsdf::Family for Widths {
        fn name(&self) -> &str {
            "widths"
        }

        fn parameters(&self) -> Vec<Parameter> {
            vec![Parameter::new("alpha", 0.3, [0.01, 1.0])]
        }

        fn with(&self, values: &[f64]) -> etalon_stats::Result<Box<dyn BatchBsdf + '_>> {
            Ok(Box::new(Rough { alpha: [self.0(values[0]); 2], facets: Facets::Conductor(0.9) }))
        }
    }

    #[test]
    fn a_name_explains_all_parameters() {
        let named = |width| {
            let found = Claim::new("ggx", &[]).unwrap().examine(&Widths(width), &[0.3]).unwrap();
            found.mistake.unwrap().to_string()
        };
        assert_eq!(named(|alpha| alpha * alpha), "it is ggx with α² where α is meant");
        assert_eq!(named(|_| 0.09), "it is ggx with α² where α is meant at alpha = 0.3 alone");
    }
}
