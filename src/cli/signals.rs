//! Signals: the first Ctrl-C (SIGINT), SIGTERM or SIGHUP asks the command to stop, a second one ends the process at once. So does
//! the first, if for [`PATIENCE`] no work looks whether it was asked and no file is written: it reads files, say, and has no results.

use etalon_core::interrupt;
use std::io;
#[cfg(unix)]
use std::time::Duration;

/// How long the work may go on without noticing that it was asked to stop.
#[cfg(unix)]
const PATIENCE: Duration = Duration::from_secs(2);

/// Installs the handlers.
///
/// SIGXFSZ gets a handler, too, in place of the default action, which would end the process: a write beyond the limit
/// of file sizes is then an error like that of a full disk.
///
/// # Errors
/// Those of the operating system, for example when there can be no further thread.
#[cfg(unix)]
pub fn install() -> io::Result<()> {
    use etalon_core::files;
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    use std::io::Write;
    use std::sync::atomic::Ordering;

    signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default())?;
    let ignored = ignored();
    let mut signals =
        Signals::new([SIGINT, SIGTERM, SIGHUP].iter().filter(|signal| ignored >> (*signal - 1) & 1 == 0))?;
    let requested = interrupt::flag();
    // The first signal asks the command to stop; the second ends the process.
    let handler = move || {
        for signal in signals.forever() {
            if requested.swap(true, Ordering::Relaxed) {
                files::exit_without_parts(128 + signal);
            }
            std::thread::spawn(|| {
                loop {
                    std::thread::sleep(PATIENCE);
                    if interrupt::is_noticed() {
                        return;
                    }
                    if !files::is_writing() {
                        break;
                    }
                }
                // Nobody may read it.
                let _ = writeln!(io::stderr(), "error: interrupted");
                files::exit_without_parts(3);
            });
        }
    };
    std::thread::Builder::new().name("signals".into()).spawn(handler).map(drop)
}

/// The signals that are ignored since the start of the process (`nohup`, shell scripts), one bit each: they stay ignored.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

#[cfg(not(unix))]
pub fn install() -> io::Result<()> {
    use signal_hook::consts::SIGINT;

    signal_hook::flag::register_conditional_shutdown(SIGINT, 130, interrupt::flag())?;
    signal_hook::flag::register(SIGINT, interrupt::flag()).map(drop)
}
