//! Values that several tests share.

use std::sync::{Arc, OnceLock};

/// A value that is computed when it is first needed.
///
/// No thread waits for another under a lock: each thread that finds no value computes one, and the first result stays. A
/// waiting thread could be one that the computation needs, since both take work from the same pool.
pub struct Shared<T>(OnceLock<Arc<T>>);

impl<T> Shared<T> {
    /// Without a value yet.
    pub const fn new() -> Self {
        Self(OnceLock::new())
    }

    /// The value, computed by `make` if there is none.
    pub fn get(&self, make: impl FnOnce() -> T) -> Arc<T> {
        self.0.get().cloned().unwrap_or_else(|| {
            let made = Arc::new(make());
            self.0.get_or_init(|| made).clone()
        })
    }
}
