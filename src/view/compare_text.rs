//! What a comparison of expectations says, in words.

use super::text::{counted, p_is, rounded, wrapped};
use crate::study::compare::{Answer, Bias, Compared, FamilyResult, Needed, Related, Tested};

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// A difference as a share of B's image, with its interval; by itself where that is not told from black.
fn bias(compared: &Compared, family: &FamilyResult, test: &Tested) -> String {
    let Some(Bias { value, low, high }) = compared.bias(family, test) else {
        return format!("{:+.2e}, B is not told from black", test.difference.value);
    };
    let percent = |share: f64| format!("{:+.2}", 100.0 * share);
    format!("{} % ({} to {} %)", percent(value), percent(low), percent(high))
}

/// The verdict in words.
pub fn sentence(compared: &Compared) -> String {
    let needed = compared.needed.map_or(String::new(), |needed| format!("; {}", would_do(&needed)));
    match (compared.answer, compared.uniform_bias) {
        (Answer::NotIndependent, _) => {
            let of_side = |(related, side): (&Option<Related>, &str)| {
                let Related { images: [k, l], correlation, p } = (*related)?;
                Some(format!(
                    "images {} and {} of {side} (correlation {correlation:+.3}, {})",
                    k + 1,
                    l + 1,
                    p_is(p)
                ))
            };
            let pairs: Vec<String> = compared.related.iter().zip(["A", "B"]).filter_map(of_side).collect();
            format!(
                "not independent: {}; they share random numbers, or the images of that side differ in their expectations (several renderers, an exposure of their own)",
                pairs.join("; ")
            )
        }
        (Answer::Different, _) => {
            let worst = compared.families.iter().filter_map(|family| Some((family, family.adjusted_p?, family.worst?)));
            worst.min_by(|a, b| a.1.total_cmp(&b.1)).map_or("different".into(), |(family, _, test)| {
                let (at, channel) = (test.functional, compared.channels[test.channel]);
                let of = if compared.bias(family, &test).is_some() { " of the mean of image B" } else { "" };
                format!("different: most at {at}, {channel}: A − B is {}{of}", bias(compared, family, &test))
            })
        }
        _ if compared.noise_hides_difference => {
            "cannot tell: the image that is declared exact seems to have noise, or differs in fine detail; if it has none, the images differ".into()
        }
        (Answer::NoDifferenceFound, Some(bias)) => {
            let bias = percent(bias);
            format!("no difference found; a uniform bias of {bias} would have been found with 90 % probability")
        }
        (_, Some(bias)) => {
            let [bias, wanted] = [bias, compared.plan.detect].map(percent);
            format!(
                "cannot tell: the smallest uniform bias found with 90 % probability is {bias}, not {wanted}{needed}"
            )
        }
        (_, None) if compared.families.iter().any(|family| family.dominated > 0) => "cannot tell: a few samples dominate the mean of the image".into(),
        (_, None) => {
            format!(
                "cannot tell: too few replicates to know which bias would have been found, or the image is black{needed}"
            )
        }
    }
}

/// What it takes, in words.
fn would_do(needed: &Needed) -> String {
    let of_side = |k: usize| match needed.replicates[k] {
        Some(n) => Some(format!("{n} images of {}", ["A", "B"][k])),
        None => needed.noisy[k].then(|| format!("{:.1} times the samples of {}", needed.times, ["A", "B"][k])),
    };
    let sides: Vec<String> = [0, 1].into_iter().filter_map(of_side).collect();
    format!("{} would do", sides.join(" and "))
}

/// The verdict, a line for each family of tests, and the biases that would have been found.
pub fn text(compared: &Compared) -> String {
    let mut text = wrapped(&sentence(compared), "", 100);
    if compared.non_finite > 0 {
        text += &format!("left out: {} with NaN or infinite values\n", counted(compared.non_finite, "pixel"));
    }
    for family in &compared.families {
        text += &format!("{:<14} ", family.family.name());
        text += &match (family.untested, family.adjusted_p.zip(family.worst)) {
            (Some(reason), _) => format!("not tested: {reason}"),
            (None, Some((p, worst))) => {
                let (p, tests) = (p_is(p), counted(family.tests.len(), "test"));
                let ([a, b], channel) = (worst.means.map(|mean| rounded(mean, 5)), compared.channels[worst.channel]);
                let bias = bias(compared, family, &worst);
                format!("{p:<12} of {tests}; most at {}, {channel}: A {a}, B {b}, {bias}", worst.functional)
            }
            (None, None) => "nothing that can be tested".into(),
        };
        if family.dominated > 0 {
            text += &format!("\n{:<15}{} inconclusive: a few samples dominate", "", family.dominated);
        }
        text.push('\n');
    }
    let found =
        |what: &str, bias: f64| format!("{what} {} would have been found with 90 % probability\n", percent(bias));
    if let Some(ratio) = compared.noise_of_exact {
        text += &wrapped(
            &format!(
                "the image that is declared exact seems to have noise, or differs in fine detail: {} times the variance of the other \
                 side's mean, which the tests allow for; give replicates, or an image with a layer of standard errors",
                rounded(ratio, 2)
            ),
            "",
            100,
        );
    }
    if let (Answer::Different, Some(bias)) = (compared.answer, compared.uniform_bias) {
        text += &found("a uniform bias of", bias);
    }
    if let Some(bias) = compared.tile_bias {
        text += &found("in one tile (median of all), a bias in parts of the image's mean of", bias);
    }
    let level = percent(1.0 - compared.plan.level).replace(".00", "");
    text + &wrapped(
        &format!(
            "p is corrected for the number of tests; A − B is in percent of the mean of image B, with {level} intervals"
        ),
        "",
        100,
    )
}
