//! Output: results to standard output, warnings, errors and progress to standard error.

use etalon_core::error::{Error, Result};
use etalon_figures::output::Written;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressState, ProgressStyle};
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

/// Standard output and standard error, and what is printed there.
pub struct Console {
    json: bool,
    quiet: bool,
    /// The first error of standard output.
    lost: OnceLock<std::io::Error>,
}

impl Console {
    /// Output as JSON or as text; `quiet` suppresses warnings, notes and progress bars.
    pub fn new(json: bool, quiet: bool) -> Self {
        Self { json, quiet, lost: OnceLock::new() }
    }

    /// An error if a result could not be written to standard output, for example because its disk is full.
    pub fn check(self) -> Result<()> {
        self.lost.into_inner().map_or(Ok(()), |e| Err(Error::io(Path::new("standard output"), e)))
    }

    /// Prints a result: `value` as JSON with `--json`, else the text of `human`.
    pub fn result(&self, value: &impl Serialize, human: impl FnOnce() -> String) {
        if self.json {
            let text = serde_json::to_string(value).unwrap_or_else(|e| format!("{{\"error\":\"{e}\"}}"));
            self.print(&visible(&text, |c| format!("\\u{:04x}", u32::from(c))));
        } else {
            self.print(&shown(&human()));
        }
    }

    /// Prints a part of a result ahead of the rest; with `--json` nothing, for the result has all.
    pub fn part(&self, text: impl FnOnce() -> String) {
        if !self.json {
            self.print(&shown(&text()));
        }
    }

    fn print(&self, text: &str) {
        let mut stdout = std::io::stdout();
        let written = writeln!(stdout, "{}", text.trim_end()).and_then(|()| stdout.flush());
        // A closed pipe is not an error: the files are written.
        if let Err(e) = written
            && e.kind() != std::io::ErrorKind::BrokenPipe
        {
            let _ = self.lost.set(e);
        }
    }

    /// Prints a result with the files that were written: as one JSON object, or the text and a line for each file.
    pub fn saved(&self, result: &impl Serialize, written: &Written, human: impl FnOnce() -> String) {
        #[derive(Serialize)]
        struct Saved<'a, T> {
            #[serde(flatten)]
            result: &'a T,
            #[serde(flatten)]
            written: &'a Written,
        }
        self.result(&Saved { result, written }, || human() + &written.text());
    }

    pub fn warn(&self, text: &str) {
        self.tell("warning", text);
    }

    /// Says what was done without being asked for.
    pub fn note(&self, text: &str) {
        self.tell("note", text);
    }

    fn tell(&self, kind: &str, text: &str) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr(), "{kind}: {}", shown(text));
        }
    }

    pub fn error(error: &Error) {
        let mut stderr = std::io::stderr();
        let _ = writeln!(stderr, "error: {}", shown(&error.to_string()));
        let more_memory =
            matches!(error, Error::Memory(_)).then_some("reduce the size, or allow more by --memory SIZE");
        if let Some(hint) = error.hint().or(more_memory) {
            let _ = writeln!(stderr, "hint: {}", shown(hint));
        }
    }

    /// A progress bar on standard error that is not drawn yet; hidden with `--quiet` or where that is no terminal.
    pub fn bar(&self, steps: u64) -> ProgressBar {
        if self.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr())
    }

    /// A progress bar of steps that take the same time; `unit` is the plural of a step. It is gone when it is dropped.
    pub fn progress(&self, steps: u64, what: &str, unit: &'static str) -> ProgressBar {
        // Nothing is known before the first step has ended. Writing into memory cannot fail.
        let rate = move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let _ = match state.pos() {
                0 => write!(out, "{}", seconds(state.elapsed())),
                _ => write!(out, "{} {unit}/s  {} left", short(state.per_sec()), seconds(state.eta())),
            };
        };
        self.ticking(steps, what, bar_style("{msg} [{bar:40}] {percent:>3} %  {rate}").with_key("rate", rate))
    }

    /// The progress of work that ends after at most n seconds.
    pub fn countdown(&self, most: f64, what: &str) -> ProgressBar {
        let left = move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let left = Duration::from_secs_f64(most).saturating_sub(state.elapsed());
            let _ = write!(out, "{}, at most {} left", seconds(state.elapsed()), seconds(left));
        };
        self.ticking(1, what, bar_style("{msg}  {left}").with_key("left", left))
    }

    /// The time that work takes of which no more is known.
    pub fn busy(&self, what: &str) -> ProgressBar {
        let spent = |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let _ = write!(out, "{}", seconds(state.elapsed()));
        };
        self.ticking(1, what, bar_style("{msg}  {spent}").with_key("spent", spent))
    }

    /// A bar that is drawn anew while nothing happens, the first time after a moment.
    fn ticking(&self, steps: u64, what: &str, style: ProgressStyle) -> ProgressBar {
        let bar = self.bar(steps).with_style(style).with_message(shown(what)).with_finish(ProgressFinish::AndClear);
        if !bar.is_hidden() {
            bar.enable_steady_tick(TICK);
        }
        bar
    }
}

/// Replaces what a terminal would obey instead of print: control characters, except for the ends of lines, and marks that turn
/// the direction of writing. Names of files and what other programs say may have both.
fn visible(text: &str, replacement: impl Fn(char) -> String) -> String {
    let mut clean = String::with_capacity(text.len());
    for c in text.chars() {
        let turns =
            matches!(c, '\u{061C}' | '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}');
        if turns || c.is_control() && c != '\n' {
            clean += &replacement(c);
        } else {
            clean.push(c);
        }
    }
    clean
}

/// A text for the terminal: `\u{1b}` in place of the character that begins a terminal's commands.
pub fn shown(text: &str) -> String {
    visible(text, |c| c.escape_unicode().to_string())
}

/// A style of progress bars.
pub fn bar_style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Between two drawings of a bar.
const TICK: Duration = Duration::from_millis(500);

/// Whole seconds, from two minutes on with minutes: `75 s`, `3 min 5 s`.
fn seconds(duration: Duration) -> String {
    match duration.as_secs() {
        seconds @ 0..120 => format!("{seconds} s"),
        seconds => format!("{} min {} s", seconds / 60, seconds % 60),
    }
}

/// A number of three digits or so: `0.52`, `17.0 k`, `3.25 M`.
fn short(number: f64) -> String {
    match number {
        n if n >= 1e6 => format!("{:.2} M", n * 1e-6),
        n if n >= 1e3 => format!("{:.1} k", n * 1e-3),
        n if n >= 10.0 => format!("{n:.0}"),
        n => format!("{n:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{seconds, short, shown, visible};
    use std::time::Duration;

    #[test]
    fn times_are_whole_seconds() {
        assert_eq!([0.4, 119.9, 185.0].map(|s| seconds(Duration::from_secs_f64(s))), ["0 s", "119 s", "3 min 5 s"]);
    }

    #[test]
    fn rates_are_short() {
        let texts = [0.517, 12.3, 999.0, 17_012.0, 3_251_000.0].map(short);
        assert_eq!(texts, ["0.52", "12", "999", "17.0 k", "3.25 M"]);
    }

    #[test]
    fn terminals_get_no_commands() {
        assert_eq!(shown("a\u{1b}[31mb\nc\td\u{9b}2J\u{202e}"), "a\\u{1b}[31mb\nc\\u{9}d\\u{9b}2J\\u{202e}");
        assert_eq!(shown("sphère, α ≤ 1"), "sphère, α ≤ 1");
        let json = serde_json::to_string("\u{1b}\u{9b}\u{7f}").unwrap();
        let clean = visible(&json, |c| format!("\\u{:04x}", u32::from(c)));
        assert_eq!(clean, "\"\\u001b\\u009b\\u007f\"");
        assert_eq!(serde_json::from_str::<String>(&clean).unwrap(), "\u{1b}\u{9b}\u{7f}");
    }
}
