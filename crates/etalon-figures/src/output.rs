//! Files of results: tables as CSV, drawings as SVG, PNG and PDF, under one name.

pub use crate::figure::with_extension;
use crate::figure::{Drawing, Style};
pub use etalon_bench::table::{csv, file_name};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use serde::{Serialize, Serializer};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Where results go, by `-o`.
#[derive(Debug, Clone, PartialEq, Eq)]
#[must_use]
pub struct Target {
    folder: PathBuf,
    /// The file name without its extension, if a file was named.
    name: Option<OsString>,
    /// Files in the folder before the command, unless a file was named.
    before: Vec<OsString>,
}

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
    /// if it is missing. Without a path, the folder `out`.
    pub fn new(out: Option<&Path>) -> Self {
        let path = out.unwrap_or(Path::new(DEFAULT_FOLDER));
        let (folder, name) = match result_extension(path) {
            Some(_) => (path.parent().unwrap_or(Path::new("")), path.file_stem().map(OsString::from)),
            None => (path, None),
        };
        // Remember the folder's files, to report which are replaced
        let there = std::fs::read_dir(folder).ok().filter(|_| name.is_none());
        let before = there.into_iter().flatten().flatten().map(|entry| entry.file_name()).collect();
        Self { folder: folder.into(), name, before }
    }

    /// Whether a file was named, not a folder.
    pub fn is_named(&self) -> bool {
        self.name.is_some()
    }

    /// The path of the result called `name`, without extension; `suffix` distinguishes several results of one command. A
    /// default name that is too long is cut and ends with a checksum of the whole.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the path with one of the `extensions` is that of an input.
    pub fn stem(&self, name: &str, suffix: &str, extensions: &[&str]) -> Result<PathBuf> {
        let mut file = self.name.clone().unwrap_or_else(|| {
            let limit = LONGEST_NAME.saturating_sub(suffix.len() + LONGEST_EXTENSION);
            shortened(name.to_owned(), limit).into()
        });
        file.push(suffix);
        let stem = self.folder.join(file);
        extensions.iter().try_for_each(|extension| files::check_no_input(&with_extension(&stem, extension)))?;
        Ok(stem)
    }

    /// The files that were written, and which of them replaced older ones under default names.
    pub fn written(&self, files: Vec<PathBuf>) -> Written {
        let was_there = |path: &&PathBuf| {
            path.parent() == Some(&self.folder) && self.before.iter().any(|name| path.file_name() == Some(name))
        };
        let replaced = files.iter().filter(was_there).cloned().collect();
        Written { files, replaced }
    }
}

/// The files that a command has written.
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
    /// Adds what was written, or why it was not.
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

/// `name`, cut to `limit` bytes if it is longer, with a checksum of the whole at its end.
fn shortened(name: String, limit: usize) -> String {
    if name.len() <= limit {
        return name;
    }
    let checksum = checksum(OsStr::new(&name));
    format!("{}-{checksum}", &name[..name.floor_char_boundary(limit.saturating_sub(checksum.len() + 1))])
}

/// Eight hexadecimal digits that differ where texts do, as far as eight digits can.
fn checksum(text: &OsStr) -> String {
    let mut crc = flate2::Crc::new();
    crc.update(text.as_encoded_bytes());
    format!("{:08x}", crc.sum())
}

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

    #[test]
    fn a_path_names_a_folder_or_files() {
        let stem = |out: Option<&str>| Target::new(out.map(Path::new)).stem("fresnel", "", &[]).unwrap();
        assert_eq!(stem(None), Path::new("out/fresnel"));
        assert_eq!(stem(Some("results")), Path::new("results/fresnel"));
        assert_eq!(stem(Some("results.v2")), Path::new("results.v2/fresnel"));
        assert_eq!(stem(Some("a/glass.png")), Path::new("a/glass"));
        let named = Target::new(Some(Path::new("m.PNG")));
        assert_eq!(named.stem("x", "-64", &[]).unwrap(), Path::new("m-64"));
        assert_eq!(Target::new(None).stem("x", "-64", &[]).unwrap(), Path::new("out/x-64"));
        assert_eq!(with_extension(Path::new("roughness-0.5"), "csv"), Path::new("roughness-0.5.csv"));
    }

    #[test]
    fn long_names_are_cut_and_remain_distinct() {
        let stem = |last: char| {
            let name = format!("validation-{}{last}", "é".repeat(200));
            let stem = Target::new(None).stem(&name, "-suffix", &[]).unwrap();
            stem.file_name().unwrap().to_str().unwrap().to_owned()
        };
        let [a, b] = ['a', 'b'].map(stem);
        assert!(a != b && a.starts_with("validation-é") && a.ends_with("-suffix"), "{a}");
        assert!((110..=116).contains(&a.len()), "{} bytes", a.len());
    }

    #[test]
    fn replaced_results_are_reported() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        files::write_bytes(&at("a.csv"), b"input").unwrap();
        let files = vec![at("a.csv"), at("b.csv"), at("c/a.csv")];
        let written = Target::new(Some(dir.path())).written(files.clone());
        assert_eq!(written.replaced, [at("a.csv")]);
        assert!(written.text().ends_with(&format!("replaced {}\n", at("a.csv").display())));
        assert_eq!(written.text().matches("wrote ").count(), 2);
        let drawing = DRAWING.map(|extension| at(&format!("v1.5.{extension}"))).to_vec();
        let written = Target::new(Some(dir.path())).written(drawing);
        assert_eq!(written.text(), format!("wrote {}.{{svg,png,pdf}}\n", at("v1.5").display()));
        assert!(Target::new(Some(&at("a.csv"))).written(files).replaced.is_empty(), "this name was asked for");
    }
}
