//! Special directions: every function of optics, of microfacets and of warps, and every BSDF, at inputs where a
//! root, a quotient or a comparison may fail.

use super::family::{ErrorRow, Family, Precision, STABLE, of_cosine};
use super::sweep::Sweep;
use super::{BoundCheck, REGISTRY};
use crate::validation::families as bsdfs;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_stats::bsdf::{BatchBsdf, BsdfSample, Density, Family as _};

/// What `run` takes beside names of families, and what it is.
pub const NAME: &str = "special-directions";
pub const ABOUT: &str = "cosines 0, −0, denormal and 1 ± 4 ULP; indices next to 1, √½ and √2; extreme widths";

/// The families that have special inputs: all but distances to shapes, which have none of these inputs.
fn functions() -> impl Iterator<Item = &'static Family> {
    REGISTRY.into_iter().filter(|family| !values(family.inputs).is_empty())
}

/// The f32 that is `places` above or below `x`.
fn next(x: f32, places: i32) -> f64 {
    let step = if places < 0 { f32::next_down } else { f32::next_up };
    f64::from((0..places.abs()).fold(x, |x, _| step(x)))
}

/// Cosines of special directions, and an ordinary one.
fn cosines() -> Vec<f64> {
    let around_1 = [-4, -1, 0, 1, 4].map(|places| next(1.0, places));
    [&[0.0, -0.0, f64::from(f32::from_bits(1)), 0.5][..], &around_1].concat()
}

/// Indices of refraction, at which η² − 1 and the critical angle change their sign or their formula.
fn indices() -> Vec<f64> {
    let around = |x: f32| [-1, 0, 1].map(|places| next(x, places));
    [1.0, std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::SQRT_2].map(around).concat()
}

/// The special values of the first of these inputs, or of the three that are a direction; none of another kind of input.
fn values(names: &[&str]) -> Vec<Vec<f64>> {
    let numbers = |numbers: Vec<f64>| numbers.into_iter().map(|x| vec![x]).collect();
    match names[0] {
        "cos" => numbers(cosines()),
        "eta" => numbers(indices()),
        "k" => numbers(vec![0.0, 1e-6, 3.0]),
        "alpha" => numbers(vec![1e-4, 1.0]),
        "u0" | "u1" => numbers(vec![0.0, 0.5, next(1.0, -1)]),
        "x" | "wo_x" if names.len() >= 3 => cosines().into_iter().map(|cos| of_cosine(cos).to_vec()).collect(),
        // The second direction on either side, and at the opposite azimuth.
        "wi_x" | "wm_x" => {
            let opposite = |cos: f64| of_cosine(cos).map(|x| -x);
            cosines().into_iter().flat_map(|cos| [opposite(cos), opposite(-cos)]).map(Vec::from).collect()
        }
        _ => Vec::new(),
    }
}

/// All combinations of special values of a family's inputs within its domains.
fn inputs(family: &Family) -> Vec<Vec<f64>> {
    let mut inputs = vec![Vec::new()];
    while let Some(begun) = inputs.first().filter(|begun: &&Vec<f64>| begun.len() < family.inputs.len()) {
        let values = values(&family.inputs[begun.len()..]);
        let extend = |begun: Vec<f64>| values.iter().map(move |value| [&begun[..], value].concat()).collect::<Vec<_>>();
        inputs = inputs.into_iter().flat_map(extend).collect();
    }
    inputs.retain(|x| family.domains.iter().zip(x).all(|((least, largest), x)| (least..=largest).contains(&x)));
    inputs
}

pub fn run() -> Result<Vec<ErrorRow>> {
    let mut rows = Vec::new();
    for family in functions() {
        if interrupt::requested() {
            return Err(Error::Interrupted);
        }
        rows.extend(of_formula(family));
    }
    for family in bsdfs::all() {
        rows.push(of_bsdf(&family)?);
    }
    Ok(rows)
}

/// No result is impossible, or has a larger error than the bound of the function.
pub fn bound(rows: &[ErrorRow]) -> BoundCheck {
    let name = format!("{NAME}: results that are impossible, or have a larger error than the bound of the function");
    BoundCheck::new(name, 0.0, rows.iter().map(|row| (row.out_of_range as f64, row.worst.clone())))
}

/// The errors of the code that renders; cases beyond a bound of the family count as out of range.
fn of_formula(family: &'static Family) -> Vec<ErrorRow> {
    let sweep = Sweep::of_inputs(family, &inputs(family));
    let mut rows: Vec<ErrorRow> = sweep.rows().into_iter().filter(ErrorRow::is_rendered).collect();
    for row in &mut rows {
        row.family = format!("special/{}", family.name).into();
        for case in sweep.cases.iter().filter(|case| case.precision == row.precision && case.condition.is_finite()) {
            // NaN violates every bound.
            let errors = family.bounds.iter().filter_map(|bound| Some(((bound.error)(case)?, bound.limit)));
            if errors.into_iter().any(|(error, limit)| error.is_nan() || error > limit) {
                row.out_of_range += 1;
                row.worst = family.text(case);
            }
        }
    }
    rows
}

/// A BSDF with each of its parameters at the ends of its range or at a special index, between all pairs of directions: values, pdfs and
/// weights are finite and not negative, and samples are unit vectors with their own pdf.
fn of_bsdf(family: &bsdfs::Family) -> Result<ErrorRow> {
    let mut row = ErrorRow::new(format!("special/bsdf/{}", family.name()), STABLE, Precision::Single);
    let parameters = family.parameters();
    let mut settings = vec![parameters.iter().map(|parameter| parameter.value).collect::<Vec<f64>>()];
    for (i, parameter) in parameters.iter().enumerate() {
        let indices = if parameter.name == "eta" { indices() } else { Vec::new() };
        let [least, largest] = parameter.range;
        let values = indices.into_iter().chain(parameter.range).filter(|x| (least..=largest).contains(x));
        settings.extend(
            values
                .map(|x| {
                    let mut setting = settings[0].clone();
                    setting[i] = x;
                    setting
                })
                .collect::<Vec<_>>(),
        );
    }
    let up = cosines().into_iter().map(of_cosine);
    let wos: Vec<[f64; 3]> = up.flat_map(|[x, y, z]| [[x, y, z], [x, y, -z]]).collect();
    let wis: Vec<[f64; 3]> =
        wos.iter().map(|[x, y, z]| [-x, -y, *z]).chain([[0.8, 0.0, 0.6], [0.8, 0.0, -0.6]]).collect();
    for setting in &settings {
        let bsdf = family.with(setting)?;
        let place = |wo: &[f64; 3]| format!("{} of {setting:?} at wo = {wo:?}", family.name());
        for wo in &wos {
            let pairs: Vec<[[f64; 3]; 2]> = wis.iter().map(|wi| [*wo, *wi]).collect();
            for (value, pdf) in bsdf.eval(&pairs, &[])?.into_iter().zip(bsdf.pdf(&pairs)?) {
                row.judge(value.into_iter().chain([pdf]), || place(wo));
            }
            for u in [[0.0; 3], [0.5; 3], [next(1.0, -1); 3], [0.0, next(1.0, -1), 0.5]] {
                let Some(sample) = bsdf.sample(&[*wo], &u)?.pop().flatten() else { continue };
                row.judge(sample.weight.into_iter().chain([sample.lobe_probability]), || place(wo));
                let is_sound = is_unit(&sample) && has_own_pdf(&*bsdf, *wo, &sample)?;
                if !is_sound {
                    row.out_of_range += 1;
                    row.worst = place(wo);
                }
            }
        }
    }
    Ok(row)
}

fn is_unit(sample: &BsdfSample) -> bool {
    let length2: f64 = sample.wi.iter().map(|x| x * x).sum();
    (length2 - 1.0).abs() < 4e-6
}

fn has_own_pdf(bsdf: &dyn BatchBsdf, wo: [f64; 3], sample: &BsdfSample) -> Result<bool> {
    Ok(match sample.density {
        Density::Pdf(pdf) => bsdf.pdf(&[[wo, sample.wi]])? == [pdf],
        Density::Delta(probability) => (0.0..=1.0).contains(&probability),
        Density::Unknown => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_function_has_special_inputs() {
        for family in functions() {
            assert!(inputs(family).len() > 8, "{}", family.name);
        }
        let names: Vec<&str> = functions().map(|family| family.name).collect();
        let others: Vec<&str> =
            REGISTRY.iter().map(|family| family.name).filter(|name| !names.contains(name)).collect();
        assert_eq!(others, ["sphere", "triangle"]);
    }
}
