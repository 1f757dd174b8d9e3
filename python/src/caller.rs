//! The thread that called from Python: it runs the callbacks, one at a time, while other threads compute.
//!
//! So callbacks need not be thread-safe, what belongs to their thread (a variant of Mitsuba, `torch.no_grad`, a debugger) holds in
//! them, and their exceptions arrive where they were caused. A callback may itself run another test: each has threads of its own.

use crate::exception;
use etalon::interrupt;
use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError};
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Interval at which Ctrl-C is looked for while no callback is asked for.
const POLL: Duration = Duration::from_millis(50);

/// What the calling thread is asked to do.
type Job = Box<dyn FnOnce(Python<'_>) -> PyResult<()> + Send>;

/// The way from threads that compute to the calling thread.
#[derive(Clone)]
pub struct Caller {
    jobs: Sender<Job>,
    /// Steps that are done, and all of them; 0 while these are not known.
    steps: Arc<[AtomicU64; 2]>,
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
    /// Another one of n steps is done.
    pub fn step(&self, of: u64) {
        let [done, all] = &*self.steps;
        all.store(of, Ordering::Relaxed);
        done.fetch_add(1, Ordering::Relaxed);
    }

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

/// What is told of work that takes long: by `etalon_bench._progress`, which knows where.
struct Progress<'a> {
    what: &'a str,
    steps: Arc<[AtomicU64; 2]>,
    start: Instant,
    told: Option<Instant>,
}

/// Work that is done in this time is not told of.
const SHORT: Duration = Duration::from_secs(2);
/// Between two tellings.
const AGAIN: Duration = Duration::from_millis(500);

impl Progress<'_> {
    fn done(&self) -> [u64; 2] {
        self.steps.each_ref().map(|steps| steps.load(Ordering::Relaxed))
    }

    /// Nobody's test fails for a line that cannot be shown.
    fn tell(&mut self, py: Python<'_>) {
        if self.start.elapsed() >= SHORT && self.told.is_none_or(|told| told.elapsed() >= AGAIN) {
            self.told = Some(Instant::now());
            let ([done, of], seconds) = (self.done(), self.start.elapsed().as_secs_f64());
            let module = py.import("etalon_bench._progress");
            let _ = module.map(|module| module.call_method1("show", (self.what, done, of, seconds)).is_ok());
        }
    }

    fn end(&self, py: Python<'_>) {
        if self.told.is_some() {
            let module = py.import("etalon_bench._progress");
            let _ = module.map(|module| module.call_method0("clear").is_ok());
        }
    }

    /// KeyboardInterrupt, with what was done until then.
    fn interrupted(&self) -> PyErr {
        let steps = match self.done() {
            [_, 0] => String::new(),
            [done, of] => format!(", {done} of {of} steps done"),
        };
        let seconds = self.start.elapsed().as_secs_f64();
        PyKeyboardInterrupt::new_err(format!("{}: interrupted after {seconds:.1} s{steps}", self.what))
    }
}

/// Runs `work`, called `what`, on a thread pool while this thread runs what it asks for, looks for Ctrl-C and tells of its progress.
///
/// # Errors
/// The exception of a callback, unchanged; KeyboardInterrupt; else the error of `work`.
pub fn run<T: Send>(py: Python<'_>, what: &str, work: impl FnOnce(Caller) -> etalon::Result<T> + Send) -> PyResult<T> {
    // A pool for each call: a forked process would wait for threads of an older one for ever
    let pool = rayon::ThreadPoolBuilder::new().build().map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    let (jobs, asked) = channel::<Job>();
    let (asked, pool) = (Mutex::new(asked), &pool);
    let steps = Arc::default();
    let mut progress = Progress { what, steps: Arc::clone(&steps), start: Instant::now(), told: None };
    let (mut failure, mut is_interrupted): (Option<PyErr>, bool) = (None, false);
    let result = thread::scope(|scope| {
        let caller = Caller { jobs, steps };
        let worker = scope.spawn(move || pool.install(move || work(caller)));
        while let Some(job) = next(py, &asked) {
            progress.tell(py);
            // After a failure the jobs are dropped, which ends the work
            if failure.is_some() {
                continue;
            }
            let told = |error: PyErr| {
                let is_key = error.is_instance_of::<PyKeyboardInterrupt>(py);
                if is_key { progress.interrupted() } else { error }
            };
            // Ctrl-C may come while a callback runs, or between two
            failure = job.and_then(|job| job(py).err()).map(told);
            if let Err(signal) = py.check_signals() {
                // Work that asks for nothing looks at the flag
                is_interrupted = true;
                interrupt::flag().store(true, Ordering::Relaxed);
                failure.get_or_insert_with(|| told(signal));
            }
        }
        py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic))
    });
    progress.end(py);
    if is_interrupted {
        interrupt::flag().store(false, Ordering::Relaxed);
    }
    failure.map_or_else(|| result.map_err(exception), Err)
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
