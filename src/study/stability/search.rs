//! A search for the worst inputs within ranges: random numbers, uniform over the floating-point numbers of each range, so that
//! every power of two counts as much as any other.

use super::inputs::parse;
use super::sweep::Sweep;
use crate::error::Result;
use crate::sampling::stream::CounterRng;
use rand::RngExt;

/// Inputs that are tried, beside the ends of all ranges; fewer where the reference takes long.
const INPUTS: u64 = 1 << 14;

/// All cases of a family at random inputs such as `fresnel:eta=0.999..1.001,cos=0.1..1`.
pub fn at_random(text: &str, seed: u64) -> Result<Sweep> {
    let (family, ranges) = parse(text, "range")?;
    let count = INPUTS / (family.coarser * family.coarser) as u64;
    let random = (0..count).map(|number| {
        let mut rng = CounterRng::new(seed, number);
        ranges.iter().map(|range| between(*range, rng.random())).collect()
    });
    let corners = (0..1usize << ranges.len())
        .map(|corner| ranges.iter().enumerate().map(|(i, range)| range[corner >> i & 1]).collect());
    let inputs: Vec<Vec<f64>> = corners.chain(random).collect();
    Ok(Sweep::of_inputs(family, &inputs))
}

/// The floating-point number at share `u` of those from `from` to `to`.
fn between([from, to]: [f64; 2], u: f64) -> f64 {
    let [first, last] = [from, to].map(|end| i128::from(ordinal(end)));
    let at = first + ((last - first + 1) as f64 * u) as i128;
    of_ordinal(at.min(last) as i64)
}

/// The number's place among all floating-point numbers; 0 for both zeros.
fn ordinal(x: f64) -> i64 {
    let bits = x.to_bits() as i64;
    if bits < 0 { i64::MIN - bits } else { bits }
}

fn of_ordinal(place: i64) -> f64 {
    f64::from_bits(if place < 0 { i64::MIN - place } else { place } as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::stability::TEXTBOOK;

    #[test]
    fn ordinals_follow_each_other_and_lead_back() {
        let ascending = [f64::MIN, -1.0, -f64::from_bits(1), 0.0, f64::from_bits(1), 0.5, 1.0, 2.0, f64::MAX];
        assert!(ascending.windows(2).all(|pair| ordinal(pair[0]) < ordinal(pair[1])));
        assert!(ascending.iter().all(|&x| of_ordinal(ordinal(x)) == x));
        assert_eq!(ordinal(-0.0), 0);
        assert_eq!((between([-2.0, 3.0], 0.0), between([-2.0, 3.0], 1.0), between([7.0, 7.0], 0.5)), (-2.0, 3.0, 7.0));
    }

    #[test]
    fn the_worst_input_is_at_least_as_bad_as_a_known_one() {
        let rows = at_random("fresnel:eta=1.0001..1.001,cos=0.1..1", 1).unwrap().rows();
        let textbook = rows.iter().find(|row| row.variant == TEXTBOOK).unwrap();
        // The textbook's error at η = 1.0003 and cos θ = 1/8 is 1.5·10⁻⁴.
        assert!(textbook.max_relative > 1e-4 && textbook.worst.starts_with("fresnel:eta=1.000"), "{textbook:?}");
    }

    #[test]
    fn ranges_that_are_none_are_refused() {
        for bad in [
            "fresnel",
            "film:samples=1..2",
            "fresnel:eta=2..1,cos=1",
            "fresnel:eta=1..,cos=1",
            "fresnel:eta=0..1,cos=1",
        ] {
            assert!(at_random(bad, 1).is_err(), "{bad}");
        }
    }
}
