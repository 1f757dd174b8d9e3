//! Files of results: tables as CSV, drawings as SVG, PNG and PDF, under one name.

pub use crate::figure::with_extension;
use crate::figure::{Drawing, Style};
pub use etalon_bench::table::{csv, file_name};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Where results go, by `-o`, and under which names.
#[derive(Debug)]
#[must_use]
pub struct Target {
    folder: PathBuf,
    /// The file name without its extension, if a file was named.
    name: Option<OsString>,
    /// What the command is about: its results may replace those of another run about the same.
    subject: String,
    /// Files in the folder before the command, unless a file was named.
    before: Vec<OsString>,
    /// The names that this run has taken, by what they stand for.
    taken: Mutex<BTreeMap<String, String>>,
}

/// Where a folder of results notes which command made which: a file for each name, so that processes do not disturb each other.
const OWNERS: &str = ".etalon";

/// Extensions of results: a path with one of them names a file, not a folder.
const RESULTS: [&str; 10] = ["csv", "svg", "png", "pdf", "exr", "pfm", "ppm", "hdr", "html", "json"];

/// The extension of a path that names a result.
pub fn result_extension(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?;
    RESULTS.into_iter().find(|known| extension.eq_ignore_ascii_case(known))
}

/// The folder of results without `-o`.
const DEFAULT_FOLDER: &str = "out";

impl Target {
    /// A path with one of the known extensions names the files (all get its stem); any other path is a folder, made
    /// if it is missing. Without a path, the folder `out`. `subject` is the command with what it is about.
    pub fn new(out: Option<&Path>, subject: &str) -> Self {
        let path = out.unwrap_or(Path::new(DEFAULT_FOLDER));
        let (folder, name) = match result_extension(path) {
            Some(_) => (path.parent().unwrap_or(Path::new("")), path.file_stem().map(OsString::from)),
            None => (path, None),
        };
        // Remember the folder's files, to spare those of other commands and to report which are replaced
        let there = std::fs::read_dir(folder).ok().filter(|_| name.is_none());
        let before = there.into_iter().flatten().flatten().map(|entry| entry.file_name()).collect();
        Self { folder: folder.into(), name, subject: subject.into(), before, taken: Mutex::default() }
    }

    /// Whether a file was named, not a folder.
    pub fn is_named(&self) -> bool {
        self.name.is_some()
    }

    /// The path of the result called `name`, without extension; `suffix` distinguishes several results of one command.
    ///
    /// A name that was asked for is taken as it is. A default name is cut if it is too long, and ends with `.2`, `.3`, … where the files of
    /// that name are not those of an earlier run of this command.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the path with one of the `extensions` is that of an input.
    pub fn stem(&self, name: &str, suffix: &str, extensions: &[&str]) -> Result<PathBuf> {
        let file = match &self.name {
            Some(named) => [named.as_os_str(), suffix.as_ref()].into_iter().collect(),
            None => OsString::from(self.free(name, suffix, extensions)),
        };
        let stem = self.folder.join(file);
        extensions.iter().try_for_each(|extension| files::check_no_input(&with_extension(&stem, extension)))?;
        Ok(stem)
    }

    /// The path of a result that is one file, as [`stem`](Self::stem).
    ///
    /// # Errors
    /// As `stem`.
    pub fn file(&self, name: &str, suffix: &str, extension: &str) -> Result<PathBuf> {
        Ok(with_extension(&self.stem(name, suffix, &[extension])?, extension))
    }

    /// The first name for a result that neither another command nor another result of this one has.
    fn free(&self, name: &str, suffix: &str, extensions: &[&str]) -> String {
        let whole = format!("{name}{suffix}");
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(own) = taken.get(&whole) {
            return own.clone();
        }
        let is_there = |stem: &str, extension: &&str| {
            let file = with_extension(Path::new(stem), extension);
            self.before.iter().any(|there| there.as_os_str() == file.as_os_str())
        };
        let is_free = |stem: &String| {
            let is_own = || std::fs::read_to_string(self.note_of(stem)).is_ok_and(|subject| subject == self.subject);
            let is_used = || extensions.iter().any(|extension| is_there(stem, extension));
            !taken.values().any(|other| other == stem) && (!is_used() || is_own())
        };
        let ends = std::iter::once(suffix.to_owned()).chain((2..).map(|number| format!("{suffix}.{number}")));
        let named = |end: String| {
            let limit = LONGEST_NAME.saturating_sub(end.len() + LONGEST_EXTENSION);
            format!("{}{end}", &name[..name.floor_char_boundary(limit)])
        };
        let free = ends.map(named).find(is_free).unwrap_or_else(|| whole.clone());
        taken.insert(whole, free.clone());
        free
    }

    /// The files that were written, and which of them replaced older ones under default names.
    pub fn written(&self, files: Vec<PathBuf>) -> Written {
        let was_there = |path: &&PathBuf| {
            path.parent() == Some(&self.folder) && self.before.iter().any(|name| path.file_name() == Some(name))
        };
        let replaced = files.iter().filter(was_there).cloned().collect();
        self.own();
        Written { files, replaced }
    }

    /// Notes whose the results are. Where that fails, a later run takes other names and loses nothing.
    fn own(&self) {
        let taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        for name in taken.values() {
            let _ = files::write_bytes(&self.note_of(name), self.subject.as_bytes());
        }
    }

    fn note_of(&self, name: &str) -> PathBuf {
        self.folder.join(OWNERS).join(name)
    }
}

/// The name of the results of a command on all that it knows, or on these subjects: `sweep`, `sweep-ggx+glass`.
pub fn name_of_run(command: &str, subjects: &[String]) -> String {
    file_name([command, &subjects.join("+")].join("-").trim_end_matches('-'))
}

/// What files are called together: one after itself, without folder and extension; several after how their names begin, else after
/// their folder, else they are "images".
pub fn name_of(paths: &[PathBuf]) -> String {
    let stem = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let Some((first, others)) = paths.split_first() else { return String::new() };
    if others.is_empty() {
        return stem(first);
    }
    let shared = others.iter().fold(stem(first), |shared, other| {
        let other = stem(other);
        shared.chars().zip(other.chars()).take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
    });
    let shared = shared.trim_end_matches(|c: char| c.is_ascii_digit() || "-_. ".contains(c)).to_owned();
    let folder = first.parent().filter(|folder| others.iter().all(|other| other.parent() == Some(folder)));
    let folder = folder.and_then(Path::file_name).map(|folder| folder.to_string_lossy().into_owned());
    // A letter that all begin with says less than their folder
    match (shared.len(), folder) {
        (0 | 1, Some(folder)) => folder,
        (0, None) => "images".into(),
        _ => shared,
    }
}

/// What a comparison of files is called: `a-vs-b`; with their folders where only these differ.
pub fn name_of_pair(a: &[PathBuf], word: &str, b: &[PathBuf]) -> String {
    let mut names = [a, b].map(name_of);
    if names[0] == names[1] {
        let folder = |paths: &[PathBuf]| {
            let folder = paths.first()?.parent()?.file_name()?;
            Some(folder.to_string_lossy().into_owned())
        };
        if let [Some(a), Some(b)] = [a, b].map(folder)
            && a != b
        {
            names = [format!("{a}-{}", names[0]), format!("{b}-{}", names[1])];
        } else {
            // The images of both sides are in one folder
            names = [a, b].map(|paths| name_of(&paths[..paths.len().min(1)]));
        }
    }
    format!("{}-{word}-{}", names[0], names[1])
}

#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Written {
    #[serde(serialize_with = "lossy")]
    pub files: Vec<PathBuf>,
    /// Those under default names that replaced older ones.
    #[serde(serialize_with = "lossy")]
    pub replaced: Vec<PathBuf>,
}

impl Written {
    /// A line for the files of one name: "wrote out/NAME.{csv,svg}".
    pub fn text(&self) -> String {
        let (replaced, wrote): (Vec<_>, Vec<_>) = self.files.iter().partition(|path| self.replaced.contains(path));
        let lines = |verb, files| braced(files).iter().map(|name| format!("{verb} {name}\n")).collect::<String>();
        lines("wrote", wrote) + &lines("replaced", replaced)
    }
}

/// The files of each name in one: "out/NAME.{csv,svg}".
pub fn braced<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Vec<String> {
    let mut names: Vec<(PathBuf, Vec<String>)> = Vec::new();
    for path in files {
        let (stem, extension) = match path.extension() {
            Some(extension) => (path.with_extension(""), vec![extension.to_string_lossy().into_owned()]),
            None => (path.clone(), Vec::new()),
        };
        match names.iter_mut().find(|(name, _)| *name == stem) {
            Some((_, extensions)) => extensions.extend(extension),
            None => names.push((stem, extension)),
        }
    }
    let one = |(stem, extensions): &(PathBuf, Vec<String>)| {
        let end = match extensions.as_slice() {
            [] => String::new(),
            [one] => format!(".{one}"),
            many => format!(".{{{}}}", many.join(",")),
        };
        format!("{}{end}", stem.display())
    };
    names.iter().map(one).collect()
}

/// Paths as text; invalid UTF-8 becomes U+FFFD.
fn lossy<S: Serializer>(paths: &[PathBuf], serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_seq(paths.iter().map(|path| path.to_string_lossy()))
}

/// Files that are written one after the other. Where one of them cannot be written, the others still are, and the result is
/// told before the error.
#[derive(Default)]
pub struct Saving {
    files: Vec<PathBuf>,
    error: Option<Error>,
}

impl Saving {
    pub fn add(&mut self, written: Result<Vec<PathBuf>>) {
        match written {
            Ok(files) => self.files.extend(files),
            Err(error) => self.error = self.error.take().or(Some(error)),
        }
    }

    /// The files that were written, and the first error.
    pub fn end(self) -> (Vec<PathBuf>, Result<()>) {
        (self.files, self.error.map_or(Ok(()), Err))
    }
}

/// Length of the longest default file name in bytes, extension included.
const LONGEST_NAME: usize = 120;
/// A dot and three letters.
const LONGEST_EXTENSION: usize = 4;

/// The image format that a path names, if it names a file.
pub fn image_format(out: Option<&Path>) -> Result<Option<&'static str>> {
    let Some(known) = out.and_then(result_extension) else { return Ok(None) };
    if IMAGES.contains(&known) {
        return Ok(Some(known));
    }
    Err(Error::parameter("out", format!("an image cannot be written as .{known}"))
        .with_hint(format!("image formats: {}", IMAGES.join(", "))))
}

/// Formats that images are written in.
const IMAGES: [&str; 5] = ["exr", "pfm", "ppm", "hdr", "png"];

/// Extensions of the files of [`write`](write()).
pub const STUDY: [&str; 4] = ["csv", "svg", "png", "pdf"];
/// Extensions of the files of a drawing alone.
pub use crate::figure::FORMATS as DRAWING;

/// Writes `stem.csv`, `stem.svg`, `stem.png` and `stem.pdf`; returns their paths.
pub fn write(stem: &Path, drawing: &Drawing, style: &Style, table: &[u8]) -> Result<Vec<PathBuf>> {
    Ok([vec![write_table(stem, table)?], drawing.write(stem, style)?].concat())
}

/// Writes `stem.csv` and returns its path.
pub fn write_table(stem: &Path, table: &[u8]) -> Result<PathBuf> {
    let csv = with_extension(stem, "csv");
    files::write_bytes(&csv, table).map(|()| csv)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(out: Option<&Path>) -> Target {
        Target::new(out, "fresnel glass")
    }

    #[test]
    fn a_path_names_a_folder_or_files() {
        let stem = |out: Option<&str>| target(out.map(Path::new)).stem("fresnel", "", &[]).unwrap();
        assert_eq!(stem(None), Path::new("out/fresnel"));
        assert_eq!(stem(Some("results")), Path::new("results/fresnel"));
        assert_eq!(stem(Some("results.v2")), Path::new("results.v2/fresnel"));
        assert_eq!(stem(Some("a/glass.png")), Path::new("a/glass"));
        let named = target(Some(Path::new("m.PNG")));
        assert_eq!(named.stem("x", "-64", &[]).unwrap(), Path::new("m-64"));
        assert_eq!(target(None).stem("x", "-64", &[]).unwrap(), Path::new("out/x-64"));
        assert_eq!(with_extension(Path::new("roughness-0.5"), "csv"), Path::new("roughness-0.5.csv"));
    }

    #[test]
    fn long_names_are_cut_and_remain_distinct() {
        let target = target(None);
        let stem = |last: char| {
            let name = format!("validation-{}{last}", "é".repeat(200));
            let stem = target.stem(&name, "-suffix", &["csv"]).unwrap();
            stem.file_name().unwrap().to_str().unwrap().to_owned()
        };
        let [a, b, again] = ['a', 'b', 'a'].map(stem);
        assert!(a.starts_with("validation-é") && a.ends_with("é-suffix") && b.ends_with("é-suffix.2"), "{a} {b}");
        assert!(again == a && (110..=116).contains(&a.len()), "{} bytes", a.len());
    }

    #[test]
    fn a_command_replaces_its_own_results_alone() {
        let dir = tempfile::tempdir().unwrap();
        let run = |subject: &str| {
            let target = Target::new(Some(dir.path()), subject);
            let path = with_extension(&target.stem("a", "-64", &["csv", "png"]).unwrap(), "csv");
            files::write_bytes(&path, subject.as_bytes()).unwrap();
            target.written(vec![path]).files[0].file_name().unwrap().to_str().unwrap().to_owned()
        };
        let own = ["a-64.csv", "a-64.csv", "a-64.2.csv", "a-64.csv", "a-64.2.csv"];
        assert_eq!([run("plot x/a"), run("plot x/a"), run("plot y/a"), run("plot x/a"), run("plot y/a")], own);
        // What no command has made is not replaced
        files::write_bytes(&dir.path().join("a-64.3.png"), b"a photograph").unwrap();
        assert_eq!([run("plot"), run("plot y/a")], ["a-64.4.csv", "a-64.2.csv"]);
        std::fs::remove_dir_all(dir.path().join(OWNERS)).unwrap();
        assert_eq!(run("plot y/a"), "a-64.5.csv");
    }

    #[test]
    fn files_have_the_names_that_people_would_choose() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let name = |names: &[&str]| name_of(&paths(names));
        assert_eq!(name(&["x/mine-1.v2.exr"]), "mine-1.v2");
        assert_eq!(name(&["mine-1.exr", "mine-10.exr", "mine-2.exr"]), "mine");
        assert_eq!(name(&["students/anna.png", "students/ben.png"]), "students");
        assert_eq!(name(&["x/s01.png", "x/s02.png"]), "x");
        assert_eq!([name(&["a1.exr", "a2.exr"]), name(&["anna.png", "ben.png"])], ["a", "images"]);
        let pair = |a: &[&str], b: &[&str]| name_of_pair(&paths(a), "vs", &paths(b));
        assert_eq!(pair(&["a.exr"], &["x/b.exr"]), "a-vs-b");
        assert_eq!(pair(&["old/box.exr"], &["new/box.exr"]), "old-box-vs-new-box");
        assert_eq!(pair(&["box.exr"], &["box.exr"]), "box-vs-box");
        assert_eq!(pair(&["x/a1.exr", "x/a2.exr"], &["x/b1.exr", "x/b2.exr"]), "a1-vs-b1");
        assert_eq!(name_of_run("validation", &["map/*".into(), "warp".into()]), "validation-map--+warp");
        assert_eq!(name_of_run("stability", &[]), "stability");
    }

    #[test]
    fn replaced_results_are_reported() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        files::write_bytes(&at("a.csv"), b"input").unwrap();
        let files = vec![at("a.csv"), at("b.csv"), at("c/a.csv")];
        let written = target(Some(dir.path())).written(files.clone());
        assert_eq!(written.replaced, [at("a.csv")]);
        assert!(written.text().ends_with(&format!("replaced {}\n", at("a.csv").display())));
        assert_eq!(written.text().matches("wrote ").count(), 2);
        let drawing = DRAWING.map(|extension| at(&format!("v1.5.{extension}"))).to_vec();
        let written = target(Some(dir.path())).written(drawing);
        assert_eq!(written.text(), format!("wrote {}.{{svg,png,pdf}}\n", at("v1.5").display()));
        assert!(target(Some(&at("a.csv"))).written(files).replaced.is_empty(), "this name was asked for");
    }
}
