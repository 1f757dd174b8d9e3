//! The usual mistake that explains a finding, or several that explain it equally well.

use std::fmt;

/// Most mistakes that are told where several are left open.
const TOLD: usize = 2;

/// What explains a finding: one mistake, or several of which a symmetry, or one angle, leaves open which it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    /// What all begin with, "samples follow", and end with, ", not the pdf".
    about: String,
    instead: String,
    /// The mistakes, at least one.
    open: Vec<String>,
}

impl Explanation {
    /// One of these mistakes, after the words `about` and before `instead`; `None` if there is none.
    pub(crate) fn one_of(about: &str, open: Vec<String>, instead: &str) -> Option<Self> {
        let about = if about.is_empty() { String::new() } else { format!("{about} ") };
        (!open.is_empty()).then(|| Self { about, instead: instead.to_owned(), open })
    }

    /// Explanations of different findings; `None` if there is none.
    pub(crate) fn all(mut all: Vec<Self>) -> Option<Self> {
        let last = all.pop()?;
        let words = || all.iter().chain([&last]).map(ToString::to_string).collect::<Vec<_>>().join("; ");
        Some(if all.is_empty() { last } else { Self::from(words()) })
    }

    /// The same with words before it.
    pub(crate) fn after(self, words: &str) -> Self {
        Self { about: format!("{words}{}", self.about), ..self }
    }

    /// The same with words after it.
    pub(crate) fn then(self, words: &str) -> Self {
        Self { instead: self.instead + words, ..self }
    }

    /// Whether it is left open which mistake it is.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.open.len() > 1
    }

    /// What explains this finding and another of the same kind, if one mistake can.
    #[must_use]
    pub fn common(&self, other: &Self) -> Option<Self> {
        let is_same = (&self.about, &self.instead) == (&other.about, &other.instead);
        let open: Vec<String> = self.open.iter().filter(|one| is_same && other.open.contains(one)).cloned().collect();
        (!open.is_empty()).then(|| Self { open, ..self.clone() })
    }

    /// The first of the mistakes, alone.
    #[must_use]
    pub fn first(&self) -> &str {
        &self.open[0]
    }
}

impl From<String> for Explanation {
    /// One mistake, in these words.
    fn from(words: String) -> Self {
        Self { about: String::new(), instead: String::new(), open: vec![words] }
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told = self.open.len().min(TOLD);
        write!(f, "{}{}", self.about, self.open[..told].join(" or "))?;
        match self.open.len() - told {
            0 => f.write_str(&self.instead),
            more => write!(f, " or {more} more that explain as much{}", self.instead),
        }
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Explanation {
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
            let open = open.iter().map(|&one| one.to_owned()).collect();
            Explanation::one_of("samples follow", open, ", not the pdf").unwrap()
        };
        let [first, second, other] = [of(&["a", "b", "c"]), of(&["d", "b"]), of(&["d"])];
        assert_eq!(first.to_string(), "samples follow a or b or 1 more that explain as much, not the pdf");
        assert_eq!(first.common(&second), Some(of(&["b"])));
        assert_eq!(first.common(&other), None);
        assert_eq!(first.common(&second.clone().after("here: ")), None, "the findings are not of the same kind");
        assert_eq!(
            Explanation::all(vec![second, other.then(" there")]).unwrap().to_string(),
            "samples follow d or b, not the pdf; samples follow d, not the pdf there"
        );
    }
}
