//! A running render: the progress bar, periodic saves of the state, the end by Ctrl-C.

use crate::cli::console::Console;
use crate::error::Result;
use crate::interrupt;
use crate::render::film::Part;
use crate::render::{Control, Job};
use indicatif::ProgressBar;
use std::ops::Range;
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
