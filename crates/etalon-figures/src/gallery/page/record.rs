//! Records of the figures in a folder: one per figure, in `reproduce.json`.

use crate::gallery::check::Check;
use crate::gallery::figure::{Claim, Erratum, Figure, Numbers, Printed};
use crate::gallery::inputs::Inputs;
use etalon_core::build::Build;
use etalon_core::error::{Error, Result};
use etalon_core::files;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::num::NonZero;
use std::path::Path;

const FILE: &str = "reproduce.json";
const LIMIT: u64 = 16 << 20;

/// Records by the figure's id.
pub type Records = BTreeMap<String, Record>;

/// The outcome of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub seconds: f64,
    /// The input that it shows, as "the map nave"; empty if none, and in records of earlier versions.
    #[serde(default)]
    pub input: String,
    pub checks: Vec<Check>,
    pub errata: Vec<Erratum>,
    /// None in records of earlier versions.
    #[serde(default)]
    pub claims: Vec<Claim>,
    /// None in records of earlier versions.
    #[serde(default)]
    pub printed: Vec<Printed>,
    /// None in records of earlier versions.
    #[serde(default)]
    pub numbers: Numbers,
    pub setup: Setup,
}

/// The program, its arguments and the machine, without names of host, user or folder.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Setup {
    pub version: String,
    /// The commit that the program was built on, in brief; empty where it is unknown.
    #[serde(default)]
    pub commit: String,
    /// The day of the run in UTC, as 2026-01-31; empty in records of earlier versions.
    #[serde(default)]
    pub date: String,
    pub seed: u64,
    /// The environment map, as the command line names it.
    pub map: String,
    pub options: String,
    /// Files of the reports, recognised by their content; none in records of earlier versions.
    #[serde(default)]
    pub originals: Vec<String>,
    pub cpu: String,
    pub cores: usize,
    pub threads: usize,
    pub system: String,
}

impl Setup {
    pub fn of(inputs: &Inputs, options: &str) -> Self {
        let build = Build::current();
        Self {
            version: build.version.to_owned(),
            commit: build.commit.to_owned(),
            date: today(),
            seed: inputs.seed,
            map: without_folder(&inputs.map.name),
            options: options.to_owned(),
            originals: inputs.recognised(),
            cpu: cpu(),
            cores: std::thread::available_parallelism().map_or(1, NonZero::get),
            threads: rayon::current_num_threads(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

/// The day in UTC by the Gregorian calendar, as 2026-01-31.
fn today() -> String {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    date(since.as_secs() / 86_400)
}

/// The date of a day after 1 January 1970.
fn date(mut day: u64) -> String {
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while day >= 365 + u64::from(leap(year)) {
        day -= 365 + u64::from(leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", day + 1)
}

/// A path without the place on this machine: absolute paths lose their folders.
pub fn without_folder(name: &str) -> String {
    let path = Path::new(name);
    match path.file_name() {
        Some(file) if path.is_absolute() => file.to_string_lossy().into_owned(),
        _ => name.to_owned(),
    }
}

/// The processor's model, or its architecture where the system does not say.
fn cpu() -> String {
    let info = files::read_bounded(Path::new("/proc/cpuinfo"), LIMIT).unwrap_or_default();
    let info = String::from_utf8_lossy(&info);
    let model = info.lines().filter_map(|line| line.split_once(':')).find(|(key, _)| key.trim() == "model name");
    model.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}

/// The records of earlier runs in `folder`, of those `figures` whose files are still there.
///
/// # Errors
/// When the file is there but cannot be read or understood.
pub fn read_records(folder: &Path, figures: &[Figure]) -> Result<Records> {
    let path = folder.join(FILE);
    if !path.exists() {
        return Ok(Records::new());
    }
    let mut records: Records = serde_json::from_slice(&files::read_own(&path, LIMIT)?).map_err(|e| {
        Error::input(&path, format!("no records of figures: {e}"))
            .with_hint("remove it: the page then covers what the next run makes")
    })?;
    records.retain(|id, _| {
        figures.iter().any(|figure| figure.id == *id)
            && ["png", "svg"].iter().all(|e| folder.join(format!("{id}.{e}")).exists())
    });
    Ok(records)
}

/// Writes the records to `reproduce.json` in `folder`.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn write_records(folder: &Path, records: &Records) -> Result<()> {
    let path = folder.join(FILE);
    let mut text = serde_json::to_vec_pretty(records).map_err(|e| Error::io(&path, e.into()))?;
    text.push(b'\n');
    files::write_bytes(&path, &text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::registry;
    use crate::gallery::tests::record;

    #[test]
    fn records_are_read_back_without_those_of_missing_figures() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str| std::fs::write(dir.path().join(name), "x").unwrap();
        assert_eq!(read_records(dir.path(), registry()).unwrap(), Records::new());
        let records: Records = ["iron", "depth-1", "no-such"].map(|id| (id.to_owned(), record())).into();
        write_records(dir.path(), &records).unwrap();
        for name in ["iron.png", "iron.svg", "no-such.png", "no-such.svg", "depth-1.svg"] {
            write(name);
        }
        let read = read_records(dir.path(), registry()).unwrap();
        assert_eq!(read.keys().collect::<Vec<_>>(), ["iron"]);
        let checks = &read["iron"].checks;
        assert!(checks[0] == record().checks[0] && checks[1].got.is_nan() && checks[1].failed());
        write(FILE);
        assert!(matches!(read_records(dir.path(), registry()), Err(Error::Input { .. })));
    }

    #[test]
    fn days_have_the_dates_of_the_calendar() {
        let days = [0, 58, 59, 789, 11_016, 20_818, 47_540].map(date);
        let dates = ["1970-01-01", "1970-02-28", "1970-03-01", "1972-02-29", "2000-02-29", "2026-12-31", "2100-02-28"];
        assert_eq!(days, dates);
        assert_eq!(date(47_541), "2100-03-01");
    }

    #[test]
    fn absolute_paths_lose_their_folders() {
        assert_eq!(without_folder("maps/a.exr"), "maps/a.exr");
        assert_eq!(without_folder("nave"), "nave");
        assert_eq!(without_folder("/home/who/a.exr"), "a.exr");
    }
}
