//! Why several tests do not accept, each cause once.

use crate::extremes::Extremes;
use crate::mistakes::number;
use crate::named_mistake::NamedMistake;
use crate::outcome::{Outcome, Verdict};

/// What one of several tests found.
pub struct Finding<'a> {
    /// The name of the test.
    pub name: &'a str,
    /// What tests of its kind have in common, whatever the direction.
    pub kind: &'a str,
    /// What it found.
    pub outcome: &'a Outcome,
}

/// The check of BSDFs that finds mistakes of pdfs alone, exactly.
const OF_PDF: &str = "jacobian";

/// Tests of one kind that do not accept for one cause.
struct Cause<'a> {
    findings: Vec<&'a Finding<'a>>,
    /// What explains all of them.
    explanation: Option<NamedMistake>,
}

impl<'a> Cause<'a> {
    /// Takes a finding into account, if it may have this cause: if one mistake explains it too, or if what is told of it differs in numbers
    /// alone.
    fn takes(&mut self, finding: &'a Finding<'a>) -> bool {
        let first = self.findings[0];
        if (first.kind, first.outcome.verdict) != (finding.kind, finding.outcome.verdict) {
            return false;
        }
        let common = || self.explanation.as_ref()?.common(finding.outcome.mistake.as_ref()?);
        let common = common();
        let takes = common.is_some() || words(first.outcome) == words(finding.outcome);
        self.explanation = common.or(self.explanation.take());
        if takes {
            self.findings.push(finding);
        }
        takes
    }

    /// One mistake says more than several that are left open; weights are wrong by what the pdf is wrong by, whose mistake says more; and
    /// exact numbers say more than counts.
    fn rank(&self) -> impl Ord + use<> {
        let Finding { kind, outcome, .. } = self.findings[0];
        let is_open = self.explanation.as_ref().is_some_and(NamedMistake::is_open);
        let is_by_counts = outcome.continuous_p().is_some();
        let is_named = self.explanation.is_some();
        (outcome.verdict != Verdict::Reject, !is_named, is_open, !kind.ends_with(OF_PDF), is_by_counts)
    }

    /// The line of the first finding, with the names of the others.
    fn line(self) -> String {
        let (first, others) = (self.findings[0], &self.findings[1..]);
        let also: Vec<&str> = others.iter().map(|finding| finding.name).collect();
        let also = if also.is_empty() { String::new() } else { format!("; also {}", also.join(", ")) };
        format!("{}: {}{also}", first.name, Outcome { mistake: self.explanation, ..first.outcome.clone() })
    }
}

/// What is told of a test, without numbers.
fn words(outcome: &Outcome) -> String {
    let mistake = outcome.mistake.as_ref().map(ToString::to_string);
    let told = mistake.or_else(|| outcome.violation.clone().or_else(|| outcome.inconclusive_reason.clone()));
    // Signs of numbers are no words, those of axes are.
    let told: Vec<char> = told.unwrap_or_default().chars().collect();
    let is_digit = |i: usize| told.get(i).is_some_and(|c| c.is_ascii_digit() || *c == '.');
    let is_word = |i: &usize| !(is_digit(*i) || "-+".contains(told[*i]) && is_digit(i + 1));
    (0..told.len()).filter(is_word).map(|i| told[i]).collect()
}

/// The relative error of a factor that counts as none.
const SAME: f64 = 0.02;

/// What explains findings of one kind that are factors, for different `wo`: one factor, or one that changes with wo, with its law if that
/// is a usual one.
fn factor_of_wo(findings: &[&Finding]) -> Option<NamedMistake> {
    let of = |finding: &&Finding| Some((finding.outcome.wo?[2], finding.outcome.mistake.as_ref()?.factor()?.value));
    let factors: Vec<(f64, f64)> = findings.iter().map(of).collect::<Option<_>>()?;
    let first = findings.first()?.outcome.mistake.as_ref()?;
    let [samples, function] = &first.factor()?.names;
    // Channels have factors of their own.
    let is_alike = |told: &NamedMistake| told.suffix() == first.suffix();
    if !findings.iter().all(|finding| finding.outcome.mistake.as_ref().is_some_and(is_alike)) {
        return None;
    }
    let is_same = |factor: f64, other: f64| (factor / other - 1.0).abs() <= SAME;
    if factors.iter().all(|(_, factor)| is_same(*factor, factors[0].1)) {
        // What differs in numbers alone is one cause in any case.
        let is_told_once = findings.iter().all(|finding| words(finding.outcome) == words(findings[0].outcome));
        let told = format!(
            "{samples} follow {function} up to a factor: {function} is {:.3} times as large as {samples} say",
            factors[0].1
        );
        return (!is_told_once).then(|| NamedMistake::from(told).with_suffix(first.suffix()));
    }
    let told = |(cos, factor): &(f64, f64)| {
        format!("{factor:.3} times as large at {:.0}°", cos.within(-1.0, 1.0).acos().to_degrees())
    };
    let law = law_of_wo(&factors, is_same).map_or(String::new(), |law| format!(": {law}"));
    let told = format!(
        "{samples} follow {function} up to a factor that changes with wo alone: {function} is {}{law}",
        factors.iter().map(told).collect::<Vec<_>>().join(", ")
    );
    Some(NamedMistake::from(told).with_suffix(first.suffix()))
}

/// What factors are by the cosine of the angle of `wo`: a power of it, or a masking that is missing, or there twice.
fn law_of_wo(factors: &[(f64, f64)], is_same: impl Fn(f64, f64) -> bool) -> Option<String> {
    for (power, name) in [(1, "cos θo"), (-1, "1/cos θo"), (2, "cos² θo"), (-2, "1/cos² θo")] {
        let constant = |(cos, factor): &(f64, f64)| factor / cos.abs().powi(power);
        let first = constant(&factors[0]);
        if factors.iter().all(|both| is_same(constant(both), first)) {
            let constant = if is_same(first, 1.0) { String::new() } else { format!("{} times ", number(first)) };
            return Some(format!("a factor of {constant}{name}"));
        }
    }
    // Smith's masking of GGX normals, 1/G1 = (1 + √(1 + α² tan² θ))/2, with the α that the largest factor has
    let is_missing = factors.iter().all(|(_, factor)| *factor > 1.0);
    let inverse = |factor: f64| if is_missing { factor } else { 1.0 / factor };
    let tan2 = |cos: f64| (1.0 - cos * cos) / (cos * cos);
    let &(cos, factor) = factors.iter().max_by(|a, b| inverse(a.1).total_cmp(&inverse(b.1)))?;
    let alpha = (((2.0 * inverse(factor) - 1.0).powi(2) - 1.0) / tan2(cos)).sqrt();
    let masking = |cos: f64| 0.5 * (1.0 + (1.0 + alpha * alpha * tan2(cos)).sqrt());
    let is_masking = factors.iter().all(|(cos, factor)| is_same(inverse(*factor), masking(*cos)));
    let what = if is_missing { "lacks" } else { "has once more" };
    (alpha <= 1.0 && is_masking)
        .then(|| format!("it {what} Smith's masking G1(wo), of GGX normals with α = {alpha:.2}"))
}

/// A line for each cause for which tests do not accept, rejections with a name first.
#[must_use]
pub fn causes(findings: &[Finding]) -> Vec<String> {
    let mut causes = gathered(findings);
    causes.sort_by_key(Cause::rank);
    causes.into_iter().map(Cause::line).collect()
}

/// What explains each finding: of several for one direction alone, those that explain all findings of its cause.
#[must_use]
pub fn explanations(findings: &[Finding]) -> Vec<Option<NamedMistake>> {
    let causes = gathered(findings);
    let common = |finding: &Finding, own: &NamedMistake| {
        let is_its = |cause: &&Cause| cause.findings.iter().any(|other| std::ptr::eq(*other, finding));
        causes.iter().find(is_its)?.explanation.as_ref()?.common(own)
    };
    let explained = |finding: &Finding| {
        let own = finding.outcome.mistake.as_ref()?;
        Some(common(finding, own).unwrap_or_else(|| own.clone()))
    };
    findings.iter().map(explained).collect()
}

/// The causes for which tests do not accept.
fn gathered<'a>(findings: &'a [Finding<'a>]) -> Vec<Cause<'a>> {
    let mut causes: Vec<Cause> = Vec::new();
    let failed = || findings.iter().filter(|finding| !finding.outcome.is_accepted());
    let has_factor = |finding: &&Finding| finding.outcome.mistake.as_ref().is_some_and(|told| told.factor().is_some());
    let mut kinds: Vec<&str> = failed().filter(has_factor).map(|finding| finding.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        let findings: Vec<&Finding> = failed().filter(|finding| finding.kind == kind).filter(has_factor).collect();
        causes.extend(factor_of_wo(&findings).map(|told| Cause { findings, explanation: Some(told) }));
    }
    for finding in failed() {
        let is_told = causes.iter().any(|cause| cause.findings.iter().any(|told| std::ptr::eq(*told, finding)));
        if !is_told && !causes.iter_mut().any(|cause| cause.takes(finding)) {
            causes.push(Cause { findings: vec![finding], explanation: finding.outcome.mistake.clone() });
        }
    }
    causes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is told of rejections at these angles, with a pdf that is each of these times as large.
    fn told(factors: &[(f64, f64)]) -> Vec<String> {
        let outcome = |&(degrees, factor): &(f64, f64)| {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            // Where samples may be none, the pdf's factor is one of probabilities.
            let words = if degrees > 60.0 { "and probabilities are wrong" } else { "up to a factor" };
            let mistake = NamedMistake::from(format!("samples follow the pdf, {words}"));
            let mistake = Some(mistake.with_factor(["samples", "the pdf"], factor));
            Outcome { verdict: Verdict::Reject, wo: Some([sin, 0.0, cos]), mistake, ..Outcome::open(1000) }
        };
        let outcomes: Vec<Outcome> = factors.iter().map(outcome).collect();
        let finding = |(outcome, (degrees, _)): (_, &(f64, f64))| (format!("sampling/{degrees}"), outcome);
        let named: Vec<(String, &Outcome)> = outcomes.iter().zip(factors).map(finding).collect();
        causes(&named.iter().map(|(name, outcome)| Finding { name, kind: "sampling", outcome }).collect::<Vec<_>>())
    }

    /// 1/G1 of GGX normals.
    fn masking(alpha: f64, angle: f64) -> f64 {
        0.5 * (1.0 + (1.0 + (alpha * angle.tan()).powi(2)).sqrt())
    }

    #[test]
    fn factors_of_several_angles_are_one_cause_with_their_law() {
        let by = |factor: fn(f64) -> f64| [20.0, 50.0, 80.0].map(|degrees| (degrees, factor(f64::to_radians(degrees))));
        type Law = (fn(f64) -> f64, &'static str);
        let laws: [Law; 4] = [
            (f64::cos, "times as large at 80°: a factor of cos θo"),
            (|angle| 4.0 / angle.cos(), ": a factor of 4 times 1/cos θo"),
            (|angle| 1.005 * masking(0.4, angle), "it lacks Smith's masking G1(wo), of GGX normals with α = 0.40"),
            (
                |angle| 1.0 / masking(0.7, angle),
                "it has once more Smith's masking G1(wo), of GGX normals with α = 0.70",
            ),
        ];
        let masking_of_all = told(&by(laws[2].0));
        assert!(masking_of_all[0].contains("1.010 times as large at 20°"), "{masking_of_all:?}");
        for (factor, law) in laws {
            let all = told(&by(factor));
            assert!(all.len() == 1 && all[0].contains(law), "{law}: {all:?}");
            assert!(all[0].contains("; also sampling/50, sampling/80"), "{all:?}");
        }
        // Other factors have no law; one factor is told once, whatever its words are
        assert!(
            told(&by(|angle| 2.0 + angle))[0]
                .contains("the pdf is 2.349 times as large at 20°, 2.873 times as large at 50°")
        );
        let one = told(&by(|_| 2.0));
        assert!(
            one.len() == 1 && one[0].contains("up to a factor: the pdf is 2.000 times as large as samples say"),
            "{one:?}"
        );
    }
}
