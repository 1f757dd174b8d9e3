//! Usual mistakes of BSDFs, by which a pdf or a value differs from what it should be.

use super::contract::{Direction, Hit, Kind, Pair};
use super::subject::{Subject, channel_of, cross, directions, dot, length, same_side, sphere};
use crate::domain::Point;
use crate::error::Result;
use crate::mistakes::{EQUAL, Mistake, Pair as Compared, Variable, number, of_one_variable, of_pairs};
use crate::named_mistake::NamedMistake;
use crate::sampler::Density;

/// The pdf in messages.
pub const PDF: &str = "the pdf";

/// The half-vector of `wo` and `wi`: of reflection, or of refraction where they are on different sides. It points to the side of
/// `wo`.
fn half_vector(subject: &Subject, wi: Direction) -> Direction {
    let wo = subject.wo;
    let eta = subject.eta2(wi).sqrt();
    let sum = [0, 1, 2].map(|axis| wo[axis] + eta * wi[axis]);
    let (length, turn) = (length(sum), if dot(sum, wo) < 0.0 { -1.0 } else { 1.0 });
    sum.map(|x| turn * x / length)
}

/// The reflectance of a smooth interface whose far side has the index of refraction `eta` relative to the near one.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let cos2 = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if cos2 <= 0.0 {
        return 1.0;
    }
    let within = cos2.sqrt();
    let [s, p] = [(cos - eta * within) / (cos + eta * within), (eta * cos - within) / (eta * cos + within)];
    0.5 * (s * s + p * p)
}

/// Factors that pdfs and values of BSDFs lack, or have twice, by `wi`.
fn factors<'a>(subject: &'a Subject) -> Vec<Mistake<'a>> {
    let wo = subject.wo;
    if subject.properties.kind != Kind::Surface {
        return Vec::new();
    }
    let normal = move |wi: Point| half_vector(subject, wi.into());
    let eta2 = move |wi: Point| subject.eta2(wi.into());
    let of_reflection = move |wi: Point| same_side(wo, wi.into());
    // |∂ωi/∂ωm|, of reflection and of refraction
    let jacobian = move |wi: Point| {
        let (wm, wi) = (normal(wi), Direction::from(wi));
        let [to_wo, to_wi] = [wo, wi].map(|w| dot(w, wm).abs());
        if same_side(wo, wi) {
            return 4.0 * to_wo;
        }
        let eta = subject.eta2(wi).sqrt();
        (to_wo - eta * to_wi).powi(2) / (eta * eta * to_wi)
    };
    let one_side = move |wi: Point, factor: f64| if of_reflection(wi) { factor } else { 1.0 };
    let mut all = Vec::new();
    all.extend(Mistake::factor("4 (wo · wm)", move |wi| one_side(wi, 4.0 * dot(wo, normal(wi)).abs())));
    all.extend(Mistake::factor("cos θm/(wo · wm), as all normals and visible ones differ", move |wi| {
        normal(wi)[2].abs() / dot(wo, normal(wi)).abs()
    }));
    all.extend(Mistake::factor("cos θo/(wo · wm)", move |wi| wo[2].abs() / dot(wo, normal(wi)).abs()));
    all.extend(Mistake::factor("4 cos θo cos θi", move |wi| 4.0 * (wo[2] * Direction::from(wi)[2]).abs()));
    all.extend(Mistake::factor("cos θi/cos θo", move |wi| (Direction::from(wi)[2] / wo[2]).abs()));
    let eta = if wo[2] > 0.0 { subject.properties.eta } else { 1.0 / subject.properties.eta };
    if eta != 1.0 {
        let of_facet = move |wi: Point| fresnel(dot(wo, normal(wi)).abs(), eta);
        all.extend(Mistake::factor("the Fresnel reflectance F(wo · wm)", of_facet));
        all.extend(Mistake::factor("1 - F(wo · wm), F the Fresnel reflectance", move |wi| 1.0 - of_facet(wi)));
    }
    if subject.properties.transmission {
        all.extend(Mistake::factor("the Jacobian of the half-vector", jacobian));
        let cosines = move |wi: Point| (dot(wo, normal(wi)) / dot(wi.into(), normal(wi))).abs();
        all.extend(Mistake::factor("(wo · wm)/(wi · wm) where light is transmitted", move |wi| {
            if of_reflection(wi) { 1.0 } else { cosines(wi) }
        }));
        all.extend(Mistake::exact_factor("η² where light is transmitted", eta2));
        all.extend(Mistake::exact_factor("η⁴ where light is transmitted", move |wi| eta2(wi).powi(2)));
        all.push(Mistake::factor_in("where light is transmitted", move |wi| !of_reflection(wi)));
    }
    all
}

/// Quantities of half-vectors and of the mirror direction, by `wi`.
pub fn variables<'a>(subject: &'a Subject) -> Vec<Variable<'a>> {
    let [x, y, z] = subject.wo;
    match subject.properties.kind {
        Kind::Light { .. } => return Vec::new(),
        Kind::Phase { .. } => {
            return vec![Variable::new("(wo · wm)", move |wi| dot(subject.wo, half_vector(subject, wi.into())).abs())];
        }
        Kind::Surface => {}
    }
    let normal = move |wi: Point| half_vector(subject, wi.into());
    let sin = move |wi| {
        let [x, y, _] = normal(wi);
        x.hypot(y)
    };
    vec![
        Variable::new("(wo · wm)", move |wi| dot(subject.wo, normal(wi)).abs()).of(of_facets),
        Variable::new("(wi · wm)", move |wi| dot(wi.into(), normal(wi)).abs()),
        Variable::new("cos θm", move |wi| normal(wi)[2].abs()).of(of_normals),
        Variable::new("sin θm", sin),
        Variable::new("cos α, α the angle with the mirror direction", move |wi| dot([-x, -y, z], wi.into()).abs())
            .of(|_| String::new()),
    ]
}

/// What a pair of directions is changed to.
type Elsewhere = fn(Pair) -> Pair;

/// Other arguments of a function of a pair of directions.
const OTHERS: [(&str, Elsewhere); 4] = [
    ("with wo and wi exchanged", |[wo, wi]| [wi, wo]),
    ("with x and y of both directions exchanged", |pair| pair.map(|[x, y, z]| [y, x, z])),
    ("with both directions on the other side", |pair| pair.map(|[x, y, z]| [x, y, -z])),
    ("with -wo for wo, as if wo pointed the other way", |[wo, wi]| [wo.map(|x| -x), wi]),
];

/// A function of distance and cosine.
type OfHit = fn(f64, f64) -> f64;

/// Factors of pdfs and radiances of lights, by distance and cosine.
const OF_LIGHTS: [(&str, OfHit); 8] = [
    ("divided by the cosine at the light", |_, cos| 1.0 / cos),
    ("times the cosine at the light", |_, cos| cos),
    ("times the square of the cosine at the light", |_, cos| cos * cos),
    ("divided by r²", |r, _| 1.0 / (r * r)),
    ("times r²", |r, _| r * r),
    ("divided by r²/cos, as per area differs from per solid angle", |r, cos| cos / (r * r)),
    ("times r²/cos, as per solid angle differs from per area", |r, cos| r * r / cos),
    ("divided by r", |r, _| 1.0 / r),
];

/// A function of a pair of directions at other arguments, each of [`OTHERS`]; of a light, the function with each of [`OF_LIGHTS`].
fn elsewhere<'a>(subject: &'a Subject, function: impl Fn(&[Pair]) -> Result<Vec<f64>> + Copy + 'a) -> Vec<Mistake<'a>> {
    if subject.is_light() {
        let of = move |factor: OfHit, wis: &[Point]| {
            let pairs = subject.pairs(&directions(wis));
            let both = function(&pairs)?.into_iter().zip(subject.bsdf.hits(&pairs)?).zip(&pairs);
            let times = |((f, hit), pair): ((f64, Option<Hit>), &Pair)| {
                hit.map_or(f, |hit| f * factor(hit.distance, dot(hit.normal, pair[1]).abs()))
            };
            Ok(both.map(times).collect())
        };
        return OF_LIGHTS.map(|(name, factor)| Mistake::asked(name, move |wis| of(factor, wis))).into();
    }
    let at = |(name, other): (&str, Elsewhere)| {
        let pairs = move |wis: &[Point]| subject.pairs(&directions(wis)).into_iter().map(other).collect::<Vec<Pair>>();
        Mistake::asked(name, move |wis| function(&pairs(wis)))
    };
    OTHERS.map(at).into()
}

/// Whether a function of (wo · wm) can be a reflectance, or divide by one: that falls to the normal, and is 1 at most.
fn of_facets(function: &[[f64; 2]]) -> String {
    let is_reflectance = [1.0, -1.0].into_iter().any(|sign| {
        let falls = function.windows(2).all(|both| sign * (both[1][1] - both[0][1]) <= EQUAL);
        falls && function.iter().all(|[_, ln]| sign * ln <= EQUAL)
    });
    if is_reflectance { ", as a Fresnel term is".to_owned() } else { String::new() }
}

/// Whether a function of cos θm is the ratio of two GGX distributions of normals, and of which: ((1 + q c)/(1 + p c))² up to a
/// factor, with c = cos² θm, p = α² − 1 of the first and q of the second. Its root is linear in three unknown numbers.
fn of_normals(function: &[[f64; 2]]) -> String {
    let rows: Vec<([f64; 3], f64)> = function
        .iter()
        .map(|[cos, ln]| {
            let (c, root) = (cos * cos, (0.5 * ln).exp());
            ([1.0, c, -c * root], root)
        })
        .collect();
    // The normal equations, by Cramer's rule
    let sum = |i: usize, j: usize| rows.iter().map(|(row, _)| row[i] * row[j]).sum::<f64>();
    let matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| sum(i, j)));
    let right = [0, 1, 2].map(|i| rows.iter().map(|(row, root)| row[i] * root).sum::<f64>());
    let of = |m: [Direction; 3]| dot(m[0], cross(m[1], m[2]));
    let [k, m, p] = [0, 1, 2].map(|column| {
        let mut other = matrix;
        (0..3).for_each(|row| other[row][column] = right[row]);
        of(other) / of(matrix)
    });
    // Three numbers fit any function that hardly bends: what is fitted must be nearly exact, over much of the range, and parameters.
    let is_exact = rows.iter().all(|(row, root)| (dot(*row, [k, m, p]) - root).abs() <= 0.1 * EQUAL * root);
    let [least, most] = [rows.first(), rows.last()].map(|row| row.map_or(f64::NAN, |(row, _)| row[1]));
    let [found, expected] = [p, m / k].map(|p| (1.0 + p).sqrt());
    let are_parameters = [found, expected].iter().all(|alpha| *alpha > 0.0 && *alpha <= 1.0);
    if is_exact && most - least >= 0.25 && are_parameters {
        return format!(", as GGX normals of α = {} differ from those of α = {}", number(found), number(expected));
    }
    String::new()
}

/// The mistakes of the pdf.
pub fn of_pdf<'a>(subject: &'a Subject) -> Vec<Mistake<'a>> {
    let mut all = factors(subject);
    all.extend(elsewhere(subject, |pairs| subject.bsdf.pdf(pairs)));
    if subject.bsdf.lobes() == 2 {
        let lobes = |wis: &[Point]| {
            let pairs = subject.pairs(&directions(wis));
            let lobe = |lobe: usize| {
                let pdfs = subject.bsdf.lobe_pdf(&pairs, &vec![lobe; pairs.len()])?;
                Ok(pdfs.into_iter().map(|pdf| pdf.unwrap_or(f64::NAN)).collect())
            };
            Ok([lobe(0)?, lobe(1)?])
        };
        all.push(Mistake::mixed("with a share of {} for lobe 0", lobes));
    }
    all
}

/// The mistake that makes numbers other than the density has in the directions of `pairs`: in all of them, or on one side; else what
/// `special` knows; else the variable on which the ratio depends.
pub fn explain(
    subject: &Subject,
    density: &dyn Density,
    pairs: &[Compared],
    names: [&str; 2],
    special: impl FnOnce() -> Result<Option<String>>,
) -> Result<Option<NamedMistake>> {
    let whole = of_pairs(&sphere(), density, pairs, names)?;
    if whole.is_some() {
        return Ok(whole);
    }
    if let Some(special) = special()? {
        return Ok(Some(NamedMistake::from(special)));
    }
    if !subject.properties.transmission || subject.properties.kind != Kind::Surface {
        return Ok(of_one_variable(&sphere(), density, pairs, names));
    }
    let (reflected, transmitted): (Vec<Compared>, Vec<Compared>) =
        pairs.iter().partition(|(wi, _)| same_side(subject.wo, (*wi).into()));
    let sides = [("reflected", reflected), ("transmitted", transmitted)].into_iter();
    let of_side = |(side, pairs): (&str, Vec<Compared>)| -> Result<Option<NamedMistake>> {
        let mistake = of_pairs(&sphere(), density, &pairs, names)?;
        let told = mistake.or_else(|| of_one_variable(&sphere(), density, &pairs, names));
        Ok(told.map(|told| told.with_suffix(&format!(" where light is {side}"))))
    };
    Ok(NamedMistake::joined(sides.map(of_side).collect::<Result<Vec<_>>>()?.into_iter().flatten().collect()))
}

/// A function of `wi` in one channel, with its mistakes.
pub struct Values<'a, F> {
    pub subject: &'a Subject<'a>,
    /// By pairs of directions and the channel.
    pub function: F,
    pub channel: usize,
    /// Whether what is compared with it is the function with `wo` and `wi` exchanged.
    pub is_exchanged: bool,
}

/// f |cos θi| of a deterministic BSDF in one channel.
pub fn light<'a>(
    subject: &'a Subject<'a>,
    channel: usize,
) -> Values<'a, impl Fn(&[Pair], usize) -> Result<Vec<f64>> + Sync> {
    let function = |pairs: &[Pair], channel| {
        let values = channel_of(&subject.bsdf.eval(pairs, &[])?, channel).into_iter().zip(pairs);
        Ok(values.map(|(f, [_, wi])| f * subject.properties.kind.cos(*wi)).collect())
    };
    Values { subject, function, channel, is_exchanged: false }
}

impl<F: Fn(&[Pair], usize) -> Result<Vec<f64>> + Sync> Values<'_, F> {
    /// The mistake that makes `found`, by its name, other numbers than the function has in the directions `wis`.
    pub fn explain(
        &self,
        wis: &[Direction],
        numbers: &[[f64; 2]],
        names: [&str; 2],
        special: impl FnOnce() -> Result<Option<String>>,
    ) -> Result<Option<NamedMistake>> {
        let pairs: Vec<Compared> = wis.iter().map(|&wi| wi.into()).zip(numbers.iter().copied()).collect();
        explain(self.subject, self, &pairs, names, special)
    }
}

impl<F: Fn(&[Pair], usize) -> Result<Vec<f64>> + Sync> Density for Values<'_, F> {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> Result<()> {
        out.extend((self.function)(&self.subject.pairs(&directions(points)), self.channel)?);
        Ok(())
    }

    fn variables(&self) -> Vec<Variable<'_>> {
        variables(self.subject)
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let Self { subject, function, channel, is_exchanged } = self;
        let mut all = factors(subject);
        let elsewhere = elsewhere(subject, move |pairs| function(pairs, *channel));
        all.extend(elsewhere.into_iter().skip(usize::from(*is_exchanged)));
        let others = (0..subject.properties.channels).filter(|other| other != channel);
        all.extend(others.map(|other| {
            let name = format!("of channel {other} in channel {channel}");
            let values = move |wis: &[Point]| function(&subject.pairs(&directions(wis)), other);
            Mistake::asked(&name, values)
        }));
        all
    }
}
