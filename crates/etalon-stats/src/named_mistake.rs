//! The usual mistake that explains a finding, or several that explain it equally well.

use std::fmt;

/// Most mistakes that are told where several are left open.
const TOLD: usize = 2;

/// What explains a finding: one mistake, or several of which it is left open which it is.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedMistake {
    /// What all begin with, "samples follow", and end with, ", not the pdf".
    prefix: String,
    suffix: String,
    /// The mistakes, at least one; each with the names of what is the same here, by a symmetry or for one angle, the usual one first.
    open: Vec<Vec<String>>,
    /// The factor, if nothing else is wrong.
    factor: Option<Factor>,
}

/// A factor by which a function is wrong, where its shape is right.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Factor {
    /// What follows what: "samples", "the pdf".
    pub names: [String; 2],
    /// How many times as large as it should be the second is.
    pub value: f64,
}

impl NamedMistake {
    /// One of these mistakes, each by its names, after the words `prefix` and before `suffix`; `None` if there is none.
    pub(crate) fn one_of(prefix: &str, open: Vec<Vec<String>>, suffix: &str) -> Option<Self> {
        (!open.is_empty()).then(|| Self { prefix: prefix.to_owned(), suffix: suffix.to_owned(), open, factor: None })
    }

    /// Explanations of different findings; `None` if there is none.
    pub(crate) fn joined(mut all: Vec<Self>) -> Option<Self> {
        let last = all.pop()?;
        let words = || all.iter().chain([&last]).map(ToString::to_string).collect::<Vec<_>>().join("; ");
        Some(if all.is_empty() { last } else { Self::from(words()) })
    }

    /// The same with words before it.
    pub(crate) fn with_prefix(self, words: &str) -> Self {
        Self { prefix: format!("{words}{}", self.prefix), ..self }
    }

    /// The same with words after it.
    #[must_use]
    pub fn with_suffix(self, words: &str) -> Self {
        Self { suffix: self.suffix + words, ..self }
    }

    /// The same, where nothing is wrong but this factor.
    pub(crate) fn with_factor(self, names: [&str; 2], value: f64) -> Self {
        Self { factor: Some(Factor { names: names.map(str::to_owned), value }), ..self }
    }

    /// The factor, if nothing else is wrong.
    pub(crate) fn factor(&self) -> Option<&Factor> {
        self.factor.as_ref()
    }

    /// What follows the mistake in words.
    pub(crate) fn suffix(&self) -> &str {
        &self.suffix
    }

    /// Whether it is left open which mistake it is.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.open.len() > 1
    }

    /// The same with more words behind one of the names.
    pub(crate) fn with_words_after(mut self, name: &str, words: &str) -> Self {
        self.open.iter_mut().flatten().filter(|own| *own == name).for_each(|own| *own += words);
        self
    }

    /// What explains this finding and another of the same kind, if one mistake can.
    #[must_use]
    pub fn common(&self, other: &Self) -> Option<Self> {
        let is_same = (&self.prefix, &self.suffix) == (&other.prefix, &other.suffix);
        let is_known = |name: &&String| is_same && other.open.iter().any(|names| names.contains(name));
        let common = |names: &Vec<String>| names.iter().filter(is_known).cloned().collect::<Vec<_>>();
        let open: Vec<Vec<String>> = self.open.iter().map(common).filter(|names| !names.is_empty()).collect();
        (!open.is_empty()).then(|| Self { open, ..self.clone() })
    }

    /// The first of the mistakes, alone.
    #[must_use]
    pub fn first(&self) -> &str {
        &self.open[0][0]
    }
}

impl From<String> for NamedMistake {
    /// One mistake, in these words.
    fn from(words: String) -> Self {
        Self { prefix: String::new(), suffix: String::new(), open: vec![vec![words]], factor: None }
    }
}

impl fmt::Display for NamedMistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told: Vec<&str> = self.open.iter().take(TOLD).map(|names| names[0].as_str()).collect();
        write!(f, "{}{}", self.prefix, told.join(" or "))?;
        match self.open.len() - told.len() {
            0 => f.write_str(&self.suffix),
            more => write!(f, " or {more} more that explain as much{}", self.suffix),
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for NamedMistake {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_findings_leave_open_what_explains_both() {
        let of = |open: &[&str]| {
            let open = open.iter().map(|one| one.split('=').map(str::to_owned).collect()).collect();
            NamedMistake::one_of("samples follow ", open, ", not the pdf").unwrap()
        };
        let [first, second, other] = [of(&["a", "b", "c=e"]), of(&["d", "b=e"]), of(&["d"])];
        assert_eq!(first.to_string(), "samples follow a or b or 1 more that explain as much, not the pdf");
        assert_eq!(first.common(&second), Some(of(&["b", "e"])));
        assert_eq!(first.common(&other), None);
        assert_eq!(first.common(&second.clone().with_prefix("here: ")), None, "the findings are not of the same kind");
        assert_eq!(
            NamedMistake::joined(vec![second, other.with_suffix(" there")]).unwrap().to_string(),
            "samples follow d or b, not the pdf; samples follow d, not the pdf there"
        );
    }
}
