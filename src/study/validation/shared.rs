//! What several tests need and one of them makes.

use std::sync::{Arc, OnceLock};

/// A value that is made when it is first needed.
///
/// Nobody waits for it under a lock: whoever finds it missing makes it, and the first to be done wins. A thread that waited
/// could be one that the making needs, for both share the work of one pool.
pub struct Shared<T>(OnceLock<Arc<T>>);

impl<T> Shared<T> {
    pub const fn new() -> Self {
        Self(OnceLock::new())
    }

    pub fn get(&self, make: impl FnOnce() -> T) -> Arc<T> {
        self.0.get().cloned().unwrap_or_else(|| {
            let made = Arc::new(make());
            self.0.get_or_init(|| made).clone()
        })
    }
}

impl<T> From<Arc<T>> for Shared<T> {
    fn from(value: Arc<T>) -> Self {
        Self(value.into())
    }
}
