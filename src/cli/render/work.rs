//! A running render: what is continued from a file, the progress bar, periodic saves of the state, the end by Ctrl-C.

use crate::cli::console::Console;
use etalon_core::error::{Error, Result};
use etalon_core::raster::Metadata;
use etalon_core::{files, interrupt};
use etalon_render::film::Part;
use etalon_render::{Control, Job};
use indicatif::ProgressBar;
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time between two saves of the state; longer where saving takes more than a tenth of it.
const PAUSE: Duration = Duration::from_secs(60);

pub type Save<'a> = &'a dyn Fn(&mut Part) -> Result<()>;

/// Renders those of the samples that `part` does not have yet, until all are there or an interruption. `save` is
/// called about once a minute meanwhile.
pub fn run(
    job: &Job,
    part: &mut Part,
    samples: &Range<u32>,
    console: &Console,
    name: &str,
    save: Option<Save>,
) -> Result<()> {
    let pixels = part.film.pixels().len() as u64;
    let bar = console.progress(pixels * samples.len() as u64, name, "samples");
    bar.set_position(part.count());
    bar.reset_eta();
    let mut pause = PAUSE;
    loop {
        let until = save.map(|_| Instant::now() + pause);
        job.run(part, samples.clone(), &Watch { bar: &bar, until });
        let Some(save) = save.filter(|_| until.is_some_and(|until| Instant::now() >= until)) else { break };
        if interrupt::requested() {
            break;
        }
        let start = Instant::now();
        save(part)?;
        pause = PAUSE.max(10 * start.elapsed());
    }
    bar.finish_and_clear();
    Ok(())
}

/// Moves the bar; stops the render after an interruption or when it is time to save.
struct Watch<'a> {
    bar: &'a ProgressBar,
    until: Option<Instant>,
}

impl Control for Watch<'_> {
    fn done(&self, samples: u64) {
        self.bar.inc(samples);
    }

    fn stop(&self) -> bool {
        interrupt::requested() || self.until.is_some_and(|until| Instant::now() >= until)
    }
}

/// Reads the part at `path`, if there is a file.
pub fn held(path: &Path) -> Result<Option<Part>> {
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("exr")) {
        return Err(Error::parameter("resume", format!("the state must be an OpenEXR file, not {}", path.display()))
            .with_hint("name a file with the extension .exr"));
    }
    if !path.exists() {
        return Ok(None);
    }
    let part = Part::read(path)?;
    files::release_input(path);
    Ok(Some(part))
}

/// `held` as a part of the same render as `fresh`, which has no samples yet.
///
/// # Errors
/// [`Error::Input`] with the differences of the two; [`Error::Parameter`] when `held` has more samples than wanted.
pub fn continued(mut held: Part, path: &Path, fresh: &Part) -> Result<Part> {
    if held.fingerprint != fresh.fingerprint || held.film.classes() != fresh.film.classes() {
        let mut message = "the file is of another render".to_owned();
        let differences = differences(&held, fresh);
        if !differences.is_empty() {
            message += &format!(" ({})", differences.join("; "));
        }
        let begun = held.metadata.get("command").map_or(String::new(), |command| format!(" (`{command}`)"));
        return Err(Error::input(path, message).with_hint(format!(
            "use the scene, flags and version that began it{begun}, or give `resume` another file"
        )));
    }
    held.set_spp(fresh.ranges().spp())?;
    Ok(held)
}

/// The differences between two parts that their files show.
fn differences(held: &Part, fresh: &Part) -> Vec<String> {
    let size = |part: &Part| Some(format!("{}x{}", part.film.width(), part.film.height()));
    let paths = |part: &Part| part.film.classes().map(|c| c.count().to_string());
    let of = |metadata: &Metadata, name: &str| metadata.get(name).map(str::to_owned);
    let flags = fresh.metadata.entries().iter().filter(|(name, _)| !["command", "spp"].contains(&name.as_str()));
    let flags = flags.map(|(name, _)| (name.as_str(), of(&held.metadata, name), of(&fresh.metadata, name)));
    [("pixels", size(held), size(fresh)), ("path classes", paths(held), paths(fresh))]
        .into_iter()
        .chain(flags)
        .filter(|(_, held, fresh)| held != fresh)
        .map(|(name, held, fresh)| {
            let text = |value: Option<String>| value.unwrap_or_else(|| "none".into());
            format!("{name}: {} there, {} here", text(held), text(fresh))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::build::Build;
    use etalon_core::raster::BUILD_NAME;
    use etalon_render::film::Film;

    #[test]
    fn a_part_of_another_build_is_refused_with_both_builds() {
        let part = |build: &str, fingerprint: &str| {
            Part::new(Film::new(2, 2, None).unwrap(), 4, fingerprint, Metadata::default().with(BUILD_NAME, build))
        };
        let build = Build::current().id();
        let (held, fresh) = (part("0.1.0+9", "f1"), part(&build, "f2"));
        let error = continued(held, Path::new("state.exr"), &fresh).unwrap_err().to_string();
        assert!(error.contains(&format!("build: 0.1.0+9 there, {build} here")), "{error}");
    }
}
