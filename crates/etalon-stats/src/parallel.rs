//! Loops over indices, on all threads.

use crate::error::Result;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// What `of` returns for each number below `count`, in order.
///
/// # Errors
/// One of `of`'s; numbers that no thread has begun are then left out.
pub fn each<T: Send + Sync>(count: u64, of: impl Fn(u64) -> Result<T> + Sync) -> Result<Vec<T>> {
    let found: Vec<OnceLock<Result<T>>> = (0..count).map(|_| OnceLock::new()).collect();
    let has_failed = AtomicBool::new(false);
    run(count, &|number| {
        if !has_failed.load(Ordering::Relaxed) {
            let result = found[number as usize].get_or_init(|| of(number));
            has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
        }
    });
    // Numbers that are left out are there only with an error.
    let (good, bad): (Vec<_>, Vec<_>) = found.into_iter().filter_map(OnceLock::into_inner).partition(Result::is_ok);
    bad.into_iter().chain(good).collect()
}

/// `each` part of `items`, which has at most `size` of them.
pub fn each_part<I: Sync, T: Send + Sync>(
    items: &[I],
    size: usize,
    of: impl Fn(&[I]) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let parts: Vec<&[I]> = items.chunks(size).collect();
    each(parts.len() as u64, |part| of(parts[part as usize]))
}

/// Folds `add` over a range, one sum for each thread, and adds these by `plus`: memory does not grow with the range. The order must not
/// matter.
pub fn sum<T: Send + Sync>(
    range: Range<u64>,
    empty: impl Fn() -> T + Sync,
    add: impl Fn(T, u64) -> Result<T> + Sync,
    plus: impl Fn(T, T) -> T,
) -> Result<T> {
    let next = AtomicU64::new(range.start);
    let of_thread = |_| {
        let number = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|number| range.contains(number));
        std::iter::from_fn(number).try_fold(empty(), |sum, number| {
            // The other threads need not go on after an error.
            add(sum, number).inspect_err(|_| next.store(range.end, Ordering::Relaxed))
        })
    };
    let sums = each(rayon::current_num_threads() as u64, of_thread)?;
    Ok(sums.into_iter().reduce(plus).unwrap_or_else(empty))
}

/// Rayon's code is compiled once, for a function behind a pointer, and not for each caller.
fn run(count: u64, of: &(dyn Fn(u64) + Sync)) {
    (0..count).into_par_iter().for_each(of);
}
