//! Which numbers a place in a scene file may have.

/// A condition on numbers, and its words for a message.
pub struct Rule(pub fn(f64) -> bool, pub &'static str);

/// Any number.
pub const ANY: Rule = Rule(|_| true, "a number");
/// Lengths and ratios.
pub const POSITIVE: Rule = Rule(|x| x > 0.0, "positive");
/// Reflectances and roughnesses.
pub const FRACTION: Rule = Rule(|x| (0.0..=1.0).contains(&x), "from 0 to 1");
/// Light of any unit.
pub const LIGHT: Rule = Rule(|x| (0.0..=1e30).contains(&x), "from 0 to 1e30");
/// Fields of view.
pub const ANGLE: Rule = Rule(|x| x > 0.0 && x < 180.0, "between 0 and 180 degrees");
/// Index of refraction of a dielectric: beyond this there is no matter, and squares might leave single precision.
pub const DIELECTRIC_INDEX: Rule = Rule(|x| (1e-3..=1e3).contains(&x), "from 0.001 to 1000");

impl Rule {
    /// `numbers`, if they are `N` that keep the rule.
    ///
    /// # Errors
    /// What is wrong, as the predicate of a sentence.
    pub fn check<const N: usize>(&self, numbers: &[f64]) -> Result<[f64; N], String> {
        let wrong = |_| format!("needs {N} number{}, not {}", if N == 1 { "" } else { "s" }, numbers.len());
        let numbers = <[f64; N]>::try_from(numbers).map_err(wrong)?;
        match numbers.iter().find(|&&number| !(self.0)(number)) {
            Some(bad) => Err(format!("must be {}, not {bad}", self.1)),
            None => Ok(numbers),
        }
    }
}
