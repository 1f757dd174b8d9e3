//! Sampling: random number streams, warps, tables, pixel filters, normals of microfacets, rectangles, triangles.

pub mod filter;
pub mod normals;
pub mod rectangle;
pub mod spherical_triangle;
pub mod table;
pub mod warp;

pub use etalon_random::{hash, stream};

/// Starts to bring `table[index]` into the cache and does not wait for it; nothing beyond the end of the table. On
/// processors other than x86-64 it does nothing.
#[inline(always)]
pub fn prefetch<T>(table: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(element) = table.get(index) {
        safe_arch::prefetch_t0(element);
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (table, index);
}
