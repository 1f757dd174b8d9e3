//! Usual mistakes of BSDFs, by which a pdf or a value differs from what it should be.

use super::contract::{Direction, Pair};
use super::subject::{Subject, channel_of, directions, dot, length, same_side, sphere};
use crate::domain::Point;
use crate::error::Result;
use crate::mistakes::{Mistake, Pair as Compared, of_pairs};
use crate::sampler::Density;

/// The pdf of a BSDF, and its light, in messages.
pub const PDF: &str = "the pdf";
pub const LIGHT: &str = "f |cos θi|";

/// The half-vector of `wo` and `wi`: of reflection, or of refraction where they are on different sides. It points to the side of
/// `wo`.
fn half_vector(subject: &Subject, wi: Direction) -> Direction {
    let wo = subject.wo;
    let eta = subject.eta2(wi).sqrt();
    let sum = [0, 1, 2].map(|axis| wo[axis] + eta * wi[axis]);
    let (length, turn) = (length(sum), if dot(sum, wo) < 0.0 { -1.0 } else { 1.0 });
    sum.map(|x| turn * x / length)
}

/// Factors that pdfs and values of BSDFs lack, or have twice, by `wi`.
fn factors<'a>(subject: &'a Subject) -> Vec<Mistake<'a>> {
    let wo = subject.wo;
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
    all.extend(Mistake::factor("(wo · wm)", move |wi| one_side(wi, dot(wo, normal(wi)).abs())));
    all.extend(Mistake::factor("cos θm", move |wi| normal(wi)[2].abs()));
    all.extend(Mistake::factor("sin θm", move |wi| {
        let [x, y, _] = normal(wi);
        x.hypot(y)
    }));
    all.extend(Mistake::factor("cos θm/(wo · wm), as all normals and visible ones differ", move |wi| {
        normal(wi)[2].abs() / dot(wo, normal(wi)).abs()
    }));
    all.extend(Mistake::factor("cos θo/(wo · wm)", move |wi| wo[2].abs() / dot(wo, normal(wi)).abs()));
    all.extend(Mistake::factor("4 cos θo cos θi", move |wi| 4.0 * (wo[2] * Direction::from(wi)[2]).abs()));
    all.extend(Mistake::factor("cos θi/cos θo", move |wi| (Direction::from(wi)[2] / wo[2]).abs()));
    if subject.properties.transmission {
        all.extend(Mistake::factor("the Jacobian of the half-vector", jacobian));
        all.extend(Mistake::exact_factor("η² where light is transmitted", eta2));
        all.extend(Mistake::exact_factor("η⁴ where light is transmitted", move |wi| eta2(wi).powi(2)));
    }
    all
}

/// The arguments of a function in the other order.
fn exchanged<'a>(subject: &'a Subject, function: impl Fn(&[Pair]) -> Result<Vec<f64>> + 'a) -> Mistake<'a> {
    let wo = subject.wo;
    let values = move |wis: &[Point]| {
        let pairs: Vec<Pair> = directions(wis).into_iter().map(|wi| [wi, wo]).collect();
        function(&pairs)
    };
    Mistake::asked("with wo and wi exchanged", values)
}

/// The mistakes of the pdf.
pub fn of_pdf<'a>(subject: &'a Subject) -> Vec<Mistake<'a>> {
    let mut all = factors(subject);
    all.push(exchanged(subject, |pairs| subject.bsdf.pdf(pairs)));
    all
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
        Ok(values.map(|(f, [_, wi])| f * wi[2].abs()).collect())
    };
    Values { subject, function, channel, is_exchanged: false }
}

impl<F: Fn(&[Pair], usize) -> Result<Vec<f64>> + Sync> Values<'_, F> {
    /// The mistake that makes `found`, by its name, other numbers than the function has in the directions `wis`.
    pub fn explain(&self, wis: &[Direction], numbers: &[[f64; 2]], names: [&str; 2]) -> Result<Option<String>> {
        let pairs: Vec<Compared> = wis.iter().map(|&wi| wi.into()).zip(numbers.iter().copied()).collect();
        of_pairs(&sphere(), self, &pairs, names)
    }
}

impl<F: Fn(&[Pair], usize) -> Result<Vec<f64>> + Sync> Density for Values<'_, F> {
    fn pdf(&self, points: &[Point], out: &mut Vec<f64>) -> Result<()> {
        out.extend((self.function)(&self.subject.pairs(&directions(points)), self.channel)?);
        Ok(())
    }

    fn mistakes(&self) -> Vec<Mistake<'_>> {
        let Self { subject, function, channel, is_exchanged } = self;
        let mut all = factors(subject);
        if !is_exchanged {
            all.push(exchanged(subject, move |pairs| function(pairs, *channel)));
        }
        let others = (0..subject.properties.channels).filter(|other| other != channel);
        all.extend(others.map(|other| {
            let name = format!("of channel {other} in channel {channel}");
            let values = move |wis: &[Point]| function(&subject.pairs(&directions(wis)), other);
            Mistake::asked(&name, values)
        }));
        all
    }
}
