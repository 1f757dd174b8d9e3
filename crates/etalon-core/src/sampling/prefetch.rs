//! A hint to the processor that an element of a table will be read soon; none on processors other than x86-64.

/// Starts to bring `table[index]` into the cache and does not wait for it; nothing beyond the end of the table.
#[inline(always)]
pub fn prefetch<T>(table: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(element) = table.get(index) {
        safe_arch::prefetch_t0(element);
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (table, index);
}
