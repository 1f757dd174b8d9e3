//! What a comparison of expectations says, in words.

use super::text::{counted, p_is, rounded};
use crate::study::compare::{Answer, Compared};

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// The verdict in words.
pub fn sentence(compared: &Compared) -> String {
    match (compared.answer, compared.uniform_bias) {
        (Answer::Different, _) => "different".into(),
        (Answer::NoDifferenceFound, Some(bias)) => {
            let bias = percent(bias);
            format!("no difference found; a uniform bias of {bias} would have been found with 90 % probability")
        }
        (_, Some(bias)) => {
            let [bias, wanted] = [bias, compared.plan.detect].map(percent);
            format!("cannot tell: the smallest uniform bias found with 90 % probability is {bias}, not {wanted}")
        }
        (_, None) if compared.families.iter().any(|family| family.dominated > 0) => {
            "cannot tell: a few samples dominate the mean of the image".into()
        }
        (_, None) => {
            "cannot tell: too few replicates to know which bias would have been found, or the image is black".into()
        }
    }
}

/// The verdict, a line for each family of tests, and the bias of a tile that would have been found.
pub fn text(compared: &Compared) -> String {
    let mut text = format!("{}\n", sentence(compared));
    for family in &compared.families {
        text += &format!("{:<14} ", family.family.name());
        text += &match (family.untested, family.adjusted_p.zip(family.worst)) {
            (Some(reason), _) => format!("not tested: {reason}"),
            (None, Some((p, worst))) => {
                let (p, tests) = (p_is(p), counted(family.tests.len(), "test"));
                let ([a, b], channel) = (worst.means.map(|mean| rounded(mean, 5)), compared.channels[worst.channel]);
                format!("{p:<12} of {tests}; most at {}, {channel}: A {a}, B {b}", worst.functional)
            }
            (None, None) => "nothing that can be tested".into(),
        };
        if family.dominated > 0 {
            text += &format!("\n{:<15}{} inconclusive: a few samples dominate", "", family.dominated);
        }
        text.push('\n');
    }
    if let Some(bias) = compared.tile_bias {
        text += &format!(
            "in half of the tiles, a bias of {} of the image's mean would have been found with 90 % probability\n",
            percent(bias)
        );
    }
    text
}
