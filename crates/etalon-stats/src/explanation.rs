//! The usual mistake that explains a finding, or several that explain it equally well.

use std::fmt;

/// Most mistakes that are told where several are left open.
const TOLD: usize = 2;

/// What explains a finding: one mistake, or several of which it is left open which it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    /// What all begin with, "samples follow", and end with, ", not the pdf".
    about: String,
    instead: String,
    /// The mistakes, at least one; each with the names of what is the same here, by a symmetry or for one angle, the usual one first.
    open: Vec<Vec<String>>,
}

impl Explanation {
    /// One of these mistakes, each by its names, after the words `about` and before `instead`; `None` if there is none.
    pub(crate) fn one_of(about: &str, open: Vec<Vec<String>>, instead: &str) -> Option<Self> {
        (!open.is_empty()).then(|| Self { about: format!("{about} "), instead: instead.to_owned(), open })
    }

    /// One of these mistakes, each in words of its own.
    pub(crate) fn of_names(names: Vec<String>) -> Option<Self> {
        let open: Vec<Vec<String>> = names.into_iter().map(|name| vec![name]).collect();
        (!open.is_empty()).then(|| Self { about: String::new(), instead: String::new(), open })
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

impl From<String> for Explanation {
    /// One mistake, in these words.
    fn from(words: String) -> Self {
        Self { about: String::new(), instead: String::new(), open: vec![vec![words]] }
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told: Vec<&str> = self.open.iter().take(TOLD).map(|names| names[0].as_str()).collect();
        write!(f, "{}{}", self.about, told.join(" or "))?;
        match self.open.len() - told.len() {
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
            let open = open.iter().map(|one| one.split('=').map(str::to_owned).collect()).collect();
            Explanation::one_of("samples follow", open, ", not the pdf").unwrap()
        };
        let [first, second, other] = [of(&["a", "b", "c=e"]), of(&["d", "b=e"]), of(&["d"])];
        assert_eq!(first.to_string(), "samples follow a or b or 1 more that explain as much, not the pdf");
        assert_eq!(first.common(&second), Some(of(&["b", "e"])));
        assert_eq!(first.common(&other), None);
        assert_eq!(first.common(&second.clone().after("here: ")), None, "the findings are not of the same kind");
        assert_eq!(
            Explanation::all(vec![second, other.then(" there")]).unwrap().to_string(),
            "samples follow d or b, not the pdf; samples follow d, not the pdf there"
        );
    }
}
