//! Selection of tests by their names: whole ones, families, patterns.

use super::case::Case;
use super::planted::PlantedFault;
use etalon_core::error::{Error, Result};

/// A test that is chosen by its name.
pub trait Named {
    /// A path such as `bsdf/ggx/visible/0.25/60`.
    fn name(&self) -> &str;
}

impl Named for Case {
    fn name(&self) -> &str {
        &self.name
    }
}

impl Named for PlantedFault {
    fn name(&self) -> &str {
        self.name
    }
}

/// The tests that any of `patterns` names, in their own order; all of them without patterns.
///
/// A pattern names a case (`bsdf/ggx/visible/0.25/60`) or all of a family (`bsdf/ggx`); `*` stands for any text, `?` for
/// one character.
///
/// # Errors
/// When a pattern names nothing; the hint has the nearest names.
pub fn select<T: Named>(cases: Vec<T>, patterns: &[String]) -> Result<Vec<T>> {
    if let Some(unknown) = patterns.iter().find(|pattern| cases.iter().all(|case| !matches_name(pattern, case.name())))
    {
        return Err(Error::parameter("names", format!("there is no test \"{unknown}\""))
            .with_hint(format!("the nearest: {}; `list` shows all", nearest(&cases, unknown).join(", "))));
    }
    let wanted = |case: &T| patterns.is_empty() || patterns.iter().any(|pattern| matches_name(pattern, case.name()));
    Ok(cases.into_iter().filter(wanted).collect())
}

/// Whether `pattern` matches the name or that of a family of the case.
fn matches_name(pattern: &str, name: &str) -> bool {
    let family = pattern.trim_end_matches('/');
    matches(pattern, name) || matches(&format!("{family}/*"), name)
}

/// Whether `name` is `pattern` with `*` and `?` filled in.
fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    // `reached[i]`: whether the pattern up to here matches the first i characters of the name.
    let mut reached = vec![false; name.len() + 1];
    reached[0] = true;
    for symbol in pattern {
        if symbol == '*' {
            for i in 1..reached.len() {
                reached[i] |= reached[i - 1];
            }
        } else {
            for i in (1..reached.len()).rev() {
                reached[i] = reached[i - 1] && (symbol == '?' || symbol == name[i - 1]);
            }
            reached[0] = false;
        }
    }
    reached[name.len()]
}

/// The three names of cases or families that take the fewest changes to become `wanted`.
fn nearest<T: Named>(cases: &[T], wanted: &str) -> Vec<String> {
    let mut known: Vec<String> = cases.iter().map(|case| case.name().to_owned()).collect();
    let families = |name: &str| name.match_indices('/').map(|(i, _)| name[..i].to_owned()).collect::<Vec<_>>();
    known.extend(cases.iter().flat_map(|case| families(case.name())));
    known.sort();
    known.dedup();
    known.sort_by_key(|name| strsim::levenshtein(name, wanted));
    known.truncate(3);
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(patterns: &[&str]) -> Result<Vec<String>> {
        let all = ["warp/cosine", "normals/ggx/all/0.5", "normals/ggx/visible/0.5/60", "normals/beckmann/all/0.5"];
        let cases = all.map(|name| Case::new(name, |_, _| unreachable!("only names are looked at")));
        let patterns: Vec<String> = patterns.iter().map(|p| (*p).to_owned()).collect();
        Ok(select(cases.into(), &patterns)?.into_iter().map(|case| case.name).collect())
    }

    #[test]
    fn names_families_and_patterns() {
        assert_eq!(chosen(&[]).unwrap().len(), 4);
        assert_eq!(chosen(&["warp/cosine"]).unwrap(), ["warp/cosine"]);
        assert_eq!(chosen(&["normals"]).unwrap().len(), 3);
        assert_eq!(chosen(&["normals/ggx/"]).unwrap().len(), 2);
        assert_eq!(chosen(&["normals/*/all"]).unwrap().len(), 2);
        assert_eq!(chosen(&["*/0.5"]).unwrap().len(), 3);
        assert_eq!(chosen(&["w?rp", "*60"]).unwrap().len(), 2);
    }

    #[test]
    fn unknown_names_are_refused_with_the_nearest() {
        for bad in ["", "norm", "warp/cosin", "WARP"] {
            assert!(chosen(&[bad]).is_err(), "{bad}");
        }
        let error = chosen(&["normals/gxg/all/0.5"]).unwrap_err();
        assert!(error.hint().unwrap().contains("normals/ggx/all/0.5"), "{error}");
    }
}
