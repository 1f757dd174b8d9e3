//! Values: finite, not negative, within declared bounds, and only where the BSDF declares that it scatters light.

use super::contract::{Density, Direction};
use super::subject::{Comparison, Subject};
use crate::error::Result;
use crate::outcome::Outcome;
use rand::RngExt;

/// Looks at values, pdfs and weights at samples, at random numbers on the edges of the unit cube, and in many directions: along
/// the surface, at the poles, towards and opposite to `wo`.
pub fn check(subject: &Subject) -> Result<Option<Outcome>> {
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
    let directions: Vec<Direction> = subject.directions().into_iter().chain(sampled).collect();
    let pairs = subject.pairs(&directions);
    let u: Vec<f64> = (0..directions.len() * properties.eval_dimension).map(|_| rng.random::<f64>()).collect();
    let (values, pdfs) = (bsdf.eval(&pairs, &u)?, bsdf.pdf(&pairs)?);
    for ((wi, f), pdf) in directions.into_iter().zip(values).zip(pdfs) {
        let f = &f[..properties.channels];
        let finite = |x: &f64| x.is_finite() && *x >= 0.0;
        found.holds(f.iter().all(finite), || format!("{}: f = {f:?}", subject.at(wi)));
        found.holds(finite(&pdf), || format!("{}: pdf = {pdf}", subject.at(wi)));
        // Along the surface there are no sides.
        let side = wo[2] * wi[2];
        let scatters = if side > 0.0 { properties.reflection } else { side == 0.0 || properties.transmission };
        let dark = f.iter().all(|&x| x == 0.0);
        found.holds(scatters || dark, || format!("{}: light on a side that is not declared", subject.at(wi)));
    }
    // Weights of samples.
    for (u, sample) in samples {
        let weight = &sample.weight[..properties.channels];
        let at = || format!("{}, u = {u:?}", subject.at(sample.wi));
        found.holds(weight.iter().all(|w| w.is_finite() && *w >= 0.0), || format!("{}: weight = {weight:?}", at()));
        let above = subject.above_bound(&sample);
        found.holds(above.is_none(), || format!("{}, u = {u:?}", above.unwrap_or_default()));
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
    Ok(found.outcome("being finite, not negative and as declared"))
}
