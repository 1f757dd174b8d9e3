//! `--junit` and `--markdown`: reports of checks for continuous integration.

use super::global::OUTPUT;
use clap::Args;
use etalon_core::error::{Error, Result};
use etalon_core::files;
use etalon_figures::output;
use etalon_figures::view::checks::Checks;
use std::path::{Path, PathBuf};

/// The options, of subcommands with checks.
#[derive(Args)]
pub struct Reports {
    /// Write the checks as JUnit XML too
    #[arg(long, help_heading = OUTPUT, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Append the checks to FILE as Markdown
    ///
    /// For the summary of a job, "$GITHUB_STEP_SUMMARY". FILE is made if it is missing.
    #[arg(long, help_heading = OUTPUT, value_name = "FILE")]
    markdown: Option<PathBuf>,
}

impl Reports {
    /// Refuses files that cannot be written: before the work, not after it.
    pub fn check(&self) -> Result<()> {
        let given = [("junit", &self.junit), ("markdown", &self.markdown)];
        for (name, path) in given.into_iter().filter_map(|(name, path)| Some((name, path.as_ref()?))) {
            if output::result_extension(path).is_some() {
                let message = format!("{} has the extension of a result", path.display());
                return Err(Error::parameter(name, message).with_hint("reports are .xml and .md"));
            }
            files::check_writable(path)?;
        }
        if let Some(path) = &self.markdown {
            if self.junit.as_ref().is_some_and(|junit| junit == path || files::is_same_file(junit, path)) {
                let message = format!("{} is the file of the other report", path.display());
                return Err(Error::parameter("markdown", message).with_hint("name another file than that of `junit`"));
            }
            before(path)?;
        }
        Ok(())
    }

    /// Writes the reports that were asked for; returns their paths.
    pub fn write(&self, checks: &Checks) -> Result<Vec<PathBuf>> {
        if let Some(path) = &self.junit {
            files::write_bytes(path, checks.junit().as_bytes())?;
        }
        if let Some(path) = &self.markdown {
            // Several commands of a step share its summary
            let mut text = before(path)?;
            if !text.is_empty() {
                text.extend(if text.ends_with(b"\n") { "\n" } else { "\n\n" }.bytes());
            }
            text.extend(checks.markdown().bytes());
            files::write_bytes(path, &text)?;
        }
        Ok([&self.junit, &self.markdown].into_iter().flatten().cloned().collect())
    }
}

/// Most bytes of a file that is appended to; summaries of GitHub have at most one MiB.
const LONGEST: u64 = 16 << 20;

/// What stands in the file already.
fn before(path: &Path) -> Result<Vec<u8>> {
    if path.exists() { files::read_own(path, LONGEST) } else { Ok(Vec::new()) }
}
