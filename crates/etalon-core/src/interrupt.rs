//! Whether this process has been asked to stop, by Ctrl-C for example.
//!
//! Loops that may take long poll [`requested`]; functions that return a [`Result`] call [`check`], so that the request
//! ends them as an error does. Whoever has finished results at hand keeps them.

use crate::error::{Error, Result};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

static REQUESTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// The flag itself, for a signal handler to set.
pub fn flag() -> Arc<AtomicBool> {
    REQUESTED.clone()
}

/// Whether anyone has found that the process has been asked to stop.
static NOTICED: AtomicBool = AtomicBool::new(false);

/// Whether the process has been asked to stop.
#[inline]
pub fn requested() -> bool {
    let requested = REQUESTED.load(Ordering::Relaxed);
    if requested {
        NOTICED.store(true, Ordering::Relaxed);
    }
    requested
}

/// Whether [`requested`] has returned true: whoever asked was told.
pub fn is_noticed() -> bool {
    NOTICED.load(Ordering::Relaxed)
}

/// An error once the process has been asked to stop.
///
/// # Errors
/// [`Error::Interrupted`].
#[inline]
pub fn check() -> Result<()> {
    if requested() { Err(Error::Interrupted) } else { Ok(()) }
}
