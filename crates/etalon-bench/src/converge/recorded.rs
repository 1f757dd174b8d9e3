//! Runs that were kept: images and their times in a folder, one folder for each contender.
//!
//! `DIR/NAME/spp-16_seed-3.exr` is the image of 16 samples per pixel by seed 3; `DIR/NAME/times.csv` has a row for each image, with
//! the columns `spp`, `seed`, `wall_seconds`, `cpu_seconds`.

use super::doubling::Times;
use crate::protocol::renderer::check_name;
use crate::table::{csv, file_name};
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_core::raster::{self, Image, Metadata, ReadOptions};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The runs of one contender.
#[derive(Debug, Clone)]
pub struct Recorded {
    name: String,
    folder: PathBuf,
    /// By seed and samples per pixel.
    times: BTreeMap<(u64, u32), Times>,
}

/// A row of `times.csv`. Field names are its columns.
#[derive(Serialize, Deserialize, Default)]
struct Row {
    spp: u32,
    seed: u64,
    wall_seconds: f64,
    cpu_seconds: f64,
}

const TIMES: &str = "times.csv";
/// Largest file of times, in bytes.
const LONGEST: u64 = 1 << 24;

fn image_path(folder: &Path, spp: u32, seed: u64) -> PathBuf {
    folder.join(format!("spp-{spp}_seed-{seed}.exr"))
}

/// The folder of a contender's runs.
fn folder_of(dir: &Path, name: &str) -> PathBuf {
    dir.join(file_name(name))
}

pub fn keep_image(dir: &Path, name: &str, [spp, seed]: [u64; 2], image: &Image) -> Result<()> {
    raster::write(&image_path(&folder_of(dir, name), spp as u32, seed), image, &Metadata::default())
}

/// Keeps the times of a contender's images, by seed and samples per pixel.
pub fn keep_times(dir: &Path, name: &str, times: impl Iterator<Item = (u64, u32, Times)>) -> Result<()> {
    let row =
        |(seed, spp, times): (u64, u32, Times)| Row { spp, seed, wall_seconds: times.wall, cpu_seconds: times.cpu };
    files::write_bytes(&folder_of(dir, name).join(TIMES), &csv(&times.map(row).collect::<Vec<_>>())?)
}

impl Recorded {
    /// All contenders in a folder, by their names.
    ///
    /// # Errors
    /// [`Error::Input`] for a folder without runs and for a damaged file of times, with its line; [`Error::Io`].
    pub fn read_all(dir: &Path) -> Result<Vec<Self>> {
        let entries = std::fs::read_dir(dir).map_err(|e| Error::io(dir, e))?;
        let mut folders: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        folders.retain(|folder| folder.join(TIMES).is_file());
        folders.sort();
        if folders.is_empty() {
            return Err(Error::input(dir, format!("no folder in it has a file {TIMES}"))
                .with_hint("DIR/NAME/times.csv and DIR/NAME/spp-16_seed-3.exr, as `keep_runs` writes them"));
        }
        folders.into_iter().map(Self::read).collect()
    }

    fn read(folder: PathBuf) -> Result<Self> {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        check_name(&name)?;
        let path = folder.join(TIMES);
        let bytes = files::read_bounded(&path, LONGEST)?;
        let mut times = BTreeMap::new();
        for (i, row) in csv::Reader::from_reader(bytes.as_slice()).deserialize::<Row>().enumerate() {
            let wrong = |what: String| Error::input(&path, format!("row {}: {what}", i + 1));
            let row = row.map_err(|e| wrong(e.to_string()))?;
            let seconds = [row.wall_seconds, row.cpu_seconds];
            if row.spp == 0 || !seconds.iter().all(|s| s.is_finite() && *s >= 0.0) {
                return Err(wrong("0 samples per pixel, or times that are no seconds".to_owned()));
            }
            let here = Times { wall: row.wall_seconds, cpu: row.cpu_seconds };
            if times.insert((row.seed, row.spp), here).is_some() {
                return Err(wrong(format!("{} samples per pixel by seed {} stand there twice", row.spp, row.seed)));
            }
        }
        if times.is_empty() {
            return Err(Error::input(&path, "it has no rows"));
        }
        Ok(Self { name, folder, times })
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// The last two replicates, as a reference, and all others: an image has no error that its own reference could show.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are no others.
    pub fn split(&self) -> Result<[Self; 2]> {
        let seeds: Vec<u64> = (0..).map_while(|index| self.seed(index)).collect();
        let [.., _, first, second] = seeds.as_slice() else {
            let message = format!(
                "{} has {} kept replicates; at least 3 are needed: the last two are the reference, the others are measured",
                self.name,
                seeds.len()
            );
            return Err(Error::parameter("reference", message));
        };
        let with = |name: String, is_reference: bool| {
            let mut times = self.times.clone();
            times.retain(|(seed, _), _| (seed >= first) == is_reference);
            Self { name, folder: self.folder.clone(), times }
        };
        Ok([with(format!("{} (kept seeds {first} and {second})", self.name), true), with(self.name.clone(), false)])
    }

    /// The seed of a replicate, counted from 0.
    pub fn seed(&self, index: u32) -> Option<u64> {
        let mut seeds: Vec<u64> = self.times.keys().map(|(seed, _)| *seed).collect();
        seeds.dedup();
        seeds.get(index as usize).copied()
    }

    /// The next larger number of samples per pixel by a seed.
    pub fn next_spp(&self, seed: u64, spp: u32) -> Option<u32> {
        let from = (seed, spp.checked_add(1)?);
        self.times.range(from..=(seed, u32::MAX)).next().map(|((_, spp), _)| *spp)
    }

    /// An image of `size` and its times; an error in words.
    pub fn image(&self, seed: u64, spp: u32, size: [usize; 2]) -> std::result::Result<(Image, Times), String> {
        let path = image_path(&self.folder, spp, seed);
        let image = raster::read(&path, ReadOptions::default()).map_err(|e| e.to_string())?;
        if [image.width(), image.height()] != size {
            let sizes = format!("{}x{} pixels, not {}x{}", image.width(), image.height(), size[0], size[1]);
            return Err(format!("{} has {sizes}", path.display()));
        }
        if image.pixels().iter().any(|pixel| !pixel.is_finite()) {
            return Err(format!("{} has pixels that are not finite", path.display()));
        }
        let times = self.times.get(&(seed, spp)).copied();
        times.map(|times| (image, times)).ok_or_else(|| format!("{} has no times", path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damaged_folders_are_refused_by_file_and_row() {
        let dir = tempfile::tempdir().unwrap();
        let read = |text: &str| {
            std::fs::create_dir_all(dir.path().join("a")).unwrap();
            std::fs::write(dir.path().join("a/times.csv"), text).unwrap();
            Recorded::read_all(dir.path())
        };
        assert!(Recorded::read_all(dir.path()).unwrap_err().to_string().contains("no folder in it"));
        let head = "spp,seed,wall_seconds,cpu_seconds\n";
        for (rows, says) in [
            ("", "it has no rows"),
            ("1,2,x,4\n", "row 1"),
            ("1,2,3,4\n0,2,3,4\n", "row 2: 0 samples"),
            ("1,2,NaN,4\n", "no seconds"),
            ("1,2,3,4\n1,2,3,4\n", "stand there twice"),
        ] {
            let error = read(&format!("{head}{rows}")).unwrap_err().to_string();
            assert!(error.contains(says) && error.contains("times.csv"), "{rows}: {error}");
        }
        let all = read(&format!("{head}1,5,1,1\n4,5,2,2\n1,7,1,1\n")).unwrap();
        let [one] = all.as_slice() else { panic!("{all:?}") };
        assert_eq!((one.name(), one.seed(0), one.seed(1), one.seed(2)), ("a", Some(5), Some(7), None));
        assert_eq!(
            (one.next_spp(5, 0), one.next_spp(5, 1), one.next_spp(5, 4), one.next_spp(7, 1)),
            (Some(1), Some(4), None, None)
        );
        assert!(one.image(5, 1, [1, 1]).is_err(), "there is no image");
        assert!(one.split().is_err(), "two replicates leave none to be measured");
    }

    #[test]
    fn what_is_the_reference_is_not_measured() {
        let times = BTreeMap::from([5, 6, 7, 8].map(|seed| ((seed, 1), Times { wall: 1.0, cpu: 1.0 })));
        let kept = Recorded { name: "a".to_owned(), folder: PathBuf::new(), times };
        let [reference, others] = kept.split().unwrap();
        let seeds = |of: &Recorded| (0..).map_while(|index| of.seed(index)).collect::<Vec<u64>>();
        assert_eq!((seeds(&reference), seeds(&others)), (vec![7, 8], vec![5, 6]));
        assert_eq!((reference.name(), others.name()), ("a (kept seeds 7 and 8)", "a"));
    }
}
