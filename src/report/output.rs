//! Where results go: tables as CSV, drawings as SVG, PNG and PDF, under one name.

use crate::error::{Error, Result};
use crate::figure::Drawing;
use crate::files;
use serde::Serialize;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// What `-o` asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target {
    folder: PathBuf,
    /// The file name without its extension, if a file was named.
    name: Option<OsString>,
}

/// Extensions by which a path is known to name a file, not a folder.
const FILE_EXTENSIONS: [&str; 9] = ["csv", "svg", "png", "pdf", "exr", "pfm", "ppm", "hdr", "json"];

/// Where results go that nobody gave a place.
pub const DEFAULT_FOLDER: &str = "out";

impl Target {
    /// A path with one of the known extensions names the files (all get its stem); any other path is a folder, made
    /// if it is missing. Without a path, the folder `out`.
    #[must_use]
    pub fn new(out: Option<&Path>) -> Self {
        let Some(path) = out else { return Self { folder: DEFAULT_FOLDER.into(), name: None } };
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        match extension {
            Some(e) if FILE_EXTENSIONS.contains(&e.as_str()) => {
                Self { folder: path.parent().unwrap_or(Path::new("")).into(), name: path.file_stem().map(Into::into) }
            }
            _ => Self { folder: path.into(), name: None },
        }
    }

    /// The path of the result called `name`, without extension; `suffix` tells several results of one command apart.
    #[must_use]
    pub fn stem(&self, name: &str, suffix: &str) -> PathBuf {
        let mut file = self.name.clone().unwrap_or_else(|| name.into());
        file.push(suffix);
        self.folder.join(file)
    }
}

/// `stem` with an extension added (a dot inside the stem stays).
#[must_use]
pub fn with_extension(stem: &Path, extension: &str) -> PathBuf {
    let mut path = stem.as_os_str().to_owned();
    path.push(".");
    path.push(extension);
    path.into()
}

/// A name without anything that a file name cannot hold.
#[must_use]
pub fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '-' }).collect()
}

/// The image format that a path names, if it names a file; an error if that is no image.
pub fn image_format(out: Option<&Path>) -> Result<Option<&'static str>> {
    let extension = out.and_then(Path::extension).and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let Some(known) = FILE_EXTENSIONS.iter().find(|known| extension.as_deref() == Some(**known)) else {
        return Ok(None);
    };
    if IMAGES.contains(known) {
        return Ok(Some(known));
    }
    Err(Error::parameter("-o", format!("an image cannot be written as .{known}"))
        .with_hint(format!("image formats: {}", IMAGES.join(", "))))
}

/// Formats that images are written in.
const IMAGES: [&str; 5] = ["exr", "pfm", "ppm", "hdr", "png"];

/// Rows as CSV text, with the field names of `T` as header, which stands there even without rows.
pub fn table<T: Serialize + Default>(rows: &[T]) -> Result<Vec<u8>> {
    if rows.is_empty() {
        let mut text = table(&[T::default()])?;
        let header = text.iter().position(|b| *b == b'\n').map_or(text.len(), |end| end + 1);
        text.truncate(header);
        return Ok(text);
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let bad = |e: String| Error::io(Path::new("table"), std::io::Error::other(e));
    for row in rows {
        writer.serialize(row).map_err(|e| bad(e.to_string()))?;
    }
    writer.into_inner().map_err(|e| bad(e.to_string()))
}

/// Writes `stem.csv`, `stem.svg`, `stem.png` and `stem.pdf`; returns their paths.
pub fn write(stem: &Path, drawing: &Drawing, table: &[u8]) -> Result<Vec<PathBuf>> {
    let csv = with_extension(stem, "csv");
    files::write_bytes(&csv, table)?;
    let mut paths = vec![csv];
    paths.extend(drawing.write(stem)?);
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_names_a_folder_or_files() {
        let stem = |out: Option<&str>| Target::new(out.map(Path::new)).stem("fresnel", "");
        assert_eq!(stem(None), Path::new("out/fresnel"));
        assert_eq!(stem(Some("results")), Path::new("results/fresnel"));
        assert_eq!(stem(Some("results.v2")), Path::new("results.v2/fresnel"));
        assert_eq!(stem(Some("a/glass.png")), Path::new("a/glass"));
        assert_eq!(Target::new(Some(Path::new("m.PNG"))).stem("x", "-64"), Path::new("m-64"));
        assert_eq!(with_extension(Path::new("roughness-0.5"), "csv"), Path::new("roughness-0.5.csv"));
    }

    #[test]
    fn tables_have_their_field_names_as_header() {
        #[derive(Default, Serialize)]
        struct Row {
            theta_deg: f64,
        }
        assert_eq!(table(&[Row { theta_deg: 0.5 }]).unwrap(), b"theta_deg\n0.5\n");
        assert_eq!(table::<Row>(&[]).unwrap(), b"theta_deg\n");
    }
}
