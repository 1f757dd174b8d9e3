//! Named tests, ready to run: the elements of a suite, the values that they share, and their selection by names.

use super::museum::Exhibit;
use super::plain;
use super::planted::PlantedFault;
use etalon_core::error::{Error, Result};
use etalon_core::sampling::hash;
use etalon_core::{interrupt, memory};
use etalon_stats::{
    Density, DensityFn, Domain, NoInverse, Outcome, Point, Protocol, Sample, Sampler, SamplerFn, density, examine,
    sampler,
};
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// One round of a test; see [`examine`].
type Test = dyn Fn(&Protocol, u64) -> Result<Outcome> + Send + Sync;
/// p of [`plain`]'s test for a seed, where there is a pdf.
type Plain = dyn Fn(u64) -> Result<Option<f64>> + Send + Sync;

pub struct Case {
    /// Words separated by `/`, from the general to the special (`normals/beckmann/visible/0.05/30`).
    pub name: String,
    pub(super) test: Box<Test>,
    pub(super) plain: Option<Box<Plain>>,
    /// Computes values that the test shares with others, so that parallel tests do not repeat it.
    pub(super) preparation: Option<Box<dyn Fn() + Send + Sync>>,
    /// Bytes of its tables, if they are large.
    pub(super) memory: usize,
}

pub type DirectionSampler<F> = SamplerFn<F, NoInverse>;

/// The sampler of directions from two random numbers.
pub fn direction_sampler<F: Fn([f64; 2]) -> Option<DVec3> + Sync>(
    sample: F,
) -> DirectionSampler<impl Fn(&[f64]) -> Option<Sample> + Sync + use<F>> {
    sampler(2, move |u| sample([u[0], u[1]]).map(|w| Sample::new(w.to_array())))
}

/// The [`density`] of directions whose pdf per solid angle is `pdf`.
pub fn direction_density<F: Fn(DVec3) -> f64 + Sync>(pdf: F) -> DensityFn<impl Fn(Point) -> f64 + Sync + use<F>> {
    density(move |w: [f64; 3]| pdf(DVec3::from_array(w)))
}

/// Tests with tables of more bytes than this run one after the other.
const LARGE: usize = 1 << 26;

impl Case {
    /// A test of any kind.
    pub fn new(
        name: impl Into<String>,
        test: impl Fn(&Protocol, u64) -> Result<Outcome> + Send + Sync + 'static,
    ) -> Self {
        Self { name: name.into(), test: Box::new(test), plain: None, preparation: None, memory: 0 }
    }

    /// Whether no other test must run beside this one, which uses all threads itself.
    pub(super) fn is_large(&self) -> bool {
        self.memory > LARGE
    }

    /// The test of a sampler against its pdf. `make` builds both, when the test runs and not before: tables of large maps
    /// need not all exist at once.
    pub fn of<D, S, P>(name: impl Into<String>, domain: D, make: impl Fn() -> (S, P) + Send + Sync + 'static) -> Self
    where
        D: Domain + Send + Sync + 'static,
        S: Sampler,
        P: Density,
    {
        let shared = Arc::new((domain, make));
        let other = shared.clone();
        Self::new(name, move |protocol, round| {
            let (sampler, density) = (shared.1)();
            Ok(examine(&shared.0, &sampler, &density, protocol, round)?)
        })
        .with_plain(move |seed| {
            let (sampler, density) = (other.1)();
            plain::p_value(&other.0, &sampler, &density, seed)
        })
    }

    /// The same test, and what the plain one says.
    pub(super) fn with_plain(self, plain: impl Fn(u64) -> Result<Option<f64>> + Send + Sync + 'static) -> Self {
        Self { plain: Some(Box::new(plain)), ..self }
    }

    /// p of the [plain](plain) chi-square test of the same sampler; `None` where there is no pdf to test.
    pub(super) fn plain(&self, seed: u64) -> Result<Option<f64>> {
        self.plain.as_ref().map_or(Ok(None), |plain| plain(self.seed(seed)))
    }

    /// A seed of its own.
    fn seed(&self, seed: u64) -> u64 {
        self.name.bytes().fold(seed, |key, byte| hash::mix64(key ^ u64::from(byte)))
    }

    /// Computes the values that the test shares with others.
    pub fn prepare(&self) {
        if let Some(prepare) = &self.preparation {
            prepare();
        }
    }

    /// Runs one round. The random numbers depend on the name and the seed alone, not on the other tests of the run.
    ///
    /// # Errors
    /// [`Error::Interrupted`](etalon_core::error::Error::Interrupted) if the process is asked to stop; too little memory for the
    /// tables; those of [`examine`].
    pub fn examine(&self, protocol: &Protocol, round: u64) -> Result<Outcome> {
        memory::request(self.memory, || format!("the tables of the test {}", self.name))?;
        let seed = self.seed(protocol.seed);
        (self.test)(&Protocol { seed, cancelled: interrupt::requested, ..*protocol }, round)
    }
}

pub trait Named {
    /// A path such as `bsdf/ggx/visible/0.25/60`.
    fn name(&self) -> &str;
}

impl Named for Case {
    fn name(&self) -> &str {
        &self.name
    }
}

impl Named for Exhibit {
    fn name(&self) -> &str {
        self.fault.name
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

/// A value that is computed when it is first needed.
///
/// No thread waits for another under a lock: each thread that finds no value computes one, and the first result stays. A
/// waiting thread could be one that the computation needs, since both take work from the same pool.
pub struct Shared<T>(OnceLock<Arc<T>>);

impl<T> Shared<T> {
    /// Without a value yet.
    pub const fn new() -> Self {
        Self(OnceLock::new())
    }

    /// The value, computed by `make` if there is none.
    pub fn get(&self, make: impl FnOnce() -> T) -> Arc<T> {
        self.0.get().cloned().unwrap_or_else(|| {
            let made = Arc::new(make());
            self.0.get_or_init(|| made).clone()
        })
    }
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
