//! A share of a sweep, computed.

use super::part::{MOST, Part};
use super::plan::Plan;
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// Configurations computed at a time.
const BATCH: usize = 64;
/// How often what is finished is saved.
const SAVE: Duration = Duration::from_secs(60);

/// Computes what `part` lacks. `save` is called about once a minute and at the end; `done` with the number of configurations so far. Once the
/// process is asked to stop, what is finished is saved; the part then lacks the rest.
///
/// # Errors
/// [`Error::Parameter`] for a part that is too large; those of the checks, except interruption, and of `save`.
pub fn run(plan: &Plan, part: &mut Part, done: &dyn Fn(u64), save: &dyn Fn(&Part) -> Result<()>) -> Result<()> {
    let count = u64::from(part.shard().count);
    if plan.len().div_ceil(count) > MOST {
        return Err(Error::parameter("shard", format!("{} configurations in {count} parts", plan.len()))
            .with_hint(format!("use at least {} parts", plan.len().div_ceil(MOST))));
    }
    let missing: Vec<u64> = part.shard().numbers(plan.len()).filter(|&number| !part.has(number)).collect();
    let mut saved = Instant::now();
    for batch in missing.chunks(BATCH) {
        if interrupt::requested() {
            break;
        }
        let one = |&number: &u64| match plan.screen(number) {
            Ok(findings) => Ok(Some((number, findings))),
            Err(Error::Interrupted) => Ok(None),
            Err(error) => Err(error),
        };
        let found: Vec<_> = match plan.is_sequential() {
            true => batch.iter().map(one).collect::<Result<_>>()?,
            false => batch.par_iter().map(one).collect::<Result<_>>()?,
        };
        for (number, findings) in found.into_iter().flatten() {
            part.add(plan, number, &findings);
        }
        done(batch.len() as u64);
        if saved.elapsed() > SAVE {
            save(part)?;
            saved = Instant::now();
        }
    }
    save(part)
}
