//! The thread that called from Python: it runs the callbacks, one at a time, while other threads compute.
//!
//! So callbacks need not be thread-safe, what belongs to their thread (a variant of Mitsuba, `torch.no_grad`, a debugger) holds in
//! them, and their exceptions arrive where they were caused. A callback may itself run another test: each has threads of its own.

use crate::errors;
use etalon::interrupt;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Interval at which Ctrl-C is looked for while no callback is asked for.
const POLL: Duration = Duration::from_millis(50);

/// What the calling thread is asked to do.
type Job = Box<dyn FnOnce(Python<'_>) -> PyResult<()> + Send>;

/// The way from threads that compute to the calling thread.
#[derive(Clone)]
pub struct Caller {
    jobs: Sender<Job>,
}

/// The error of a test whose callback has raised an exception, which the calling thread keeps.
#[derive(Debug)]
struct Ended;

impl std::fmt::Display for Ended {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a callback has failed")
    }
}

impl std::error::Error for Ended {}

impl Caller {
    /// Has the calling thread run `job` and waits for its result.
    ///
    /// # Errors
    /// [`Error::External`](etalon_stats::Error::External) if this or an earlier job has failed.
    pub fn call<T: Send + 'static>(
        &self,
        job: impl FnOnce(Python<'_>) -> PyResult<T> + Send + 'static,
    ) -> etalon_stats::Result<T> {
        let (answer, answered) = sync_channel(1);
        let job = move |py: Python<'_>| {
            let value = job(py)?;
            // The thread that asked waits for it.
            let _ = answer.send(value);
            Ok(())
        };
        let ended = || etalon_stats::Error::external(Ended);
        self.jobs.send(Box::new(job)).map_err(|_| ended())?;
        answered.recv().map_err(|_| ended())
    }
}

/// Runs `work` on a thread pool while this thread runs what it asks for, and looks for Ctrl-C.
///
/// # Errors
/// The exception of a callback, unchanged; KeyboardInterrupt; else the error of `work`.
pub fn run<T: Send>(py: Python<'_>, work: impl FnOnce(Caller) -> etalon::Result<T> + Send) -> PyResult<T> {
    // A pool for each call: a forked process would wait for threads of an older one for ever
    let pool = rayon::ThreadPoolBuilder::new().build().map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    let (jobs, asked) = channel::<Job>();
    let (asked, pool) = (Mutex::new(asked), &pool);
    let (mut failure, mut is_interrupted): (Option<PyErr>, bool) = (None, false);
    let result = thread::scope(|scope| {
        let caller = Caller { jobs };
        let worker = scope.spawn(move || pool.install(move || work(caller)));
        while let Some(job) = next(py, &asked) {
            // After a failure the jobs are dropped, which ends the work
            if failure.is_some() {
                continue;
            }
            failure = job.and_then(|job| job(py).err());
            if let Err(interrupted) = py.check_signals() {
                // Work that asks for nothing looks at the flag
                is_interrupted = true;
                interrupt::flag().store(true, Ordering::Relaxed);
                failure.get_or_insert(interrupted);
            }
        }
        py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic))
    });
    if is_interrupted {
        interrupt::flag().store(false, Ordering::Relaxed);
    }
    failure.map_or_else(|| result.map_err(errors::of), Err)
}

/// The next job; `Some(None)` if there is none for a while, `None` when there will be none.
fn next(py: Python<'_>, asked: &Mutex<Receiver<Job>>) -> Option<Option<Job>> {
    let wait = || asked.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(POLL);
    match py.detach(wait) {
        Ok(job) => Some(Some(job)),
        Err(RecvTimeoutError::Timeout) => Some(None),
        Err(RecvTimeoutError::Disconnected) => None,
    }
}
