//! How much memory the process may take.
//!
//! What depends on the size of an input or of a request asks here before it allocates, so that too much is an error
//! that says what would take how much, and not the end of the process. The estimates are of what is about to be
//! allocated; what the process holds already is measured.

use crate::error::{Error, Result, Shortage};
use std::cell::Cell;
use std::collections::HashMap;
use std::hash::Hash;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// None before the first request.
static LIMITS: Mutex<Option<Limits>> = Mutex::new(None);

/// Limits in bytes, with the words that say where they come from: of memory in use, and of addresses, in use or not.
type Limits = [(u64, &'static str); 2];

/// Sets the limit for all requests from now on; without one, it is what the machine has left at the first request.
pub fn set_limit(bytes: Option<u64>) {
    *limits() = bytes.map(|bytes| [(bytes, "as it was chosen"), address_space()]);
}

fn limits() -> MutexGuard<'static, Option<Limits>> {
    LIMITS.lock().unwrap_or_else(PoisonError::into_inner)
}

thread_local! {
    /// Whether what this thread asks for has been granted already.
    static GRANTED: Cell<bool> = const { Cell::new(false) };
    /// What this thread may take in small parts until the process is measured again.
    static ALLOWANCE: Cell<usize> = const { Cell::new(0) };
}

/// Runs `work`, for whose memory this thread has asked already, or which takes next to none.
pub fn granted<T>(work: impl FnOnce() -> T) -> T {
    let before = GRANTED.replace(true);
    let result = work();
    GRANTED.set(before);
    result
}

/// Asks for n bytes more than the process holds. Nothing is reserved.
///
/// # Errors
/// [`Error::Memory`] when they exceed the limit, with `what` they are for.
pub fn request(bytes: usize, what: impl FnOnce() -> String) -> Result<()> {
    left_after(bytes, what).map(drop)
}

/// What is left to the limit when n bytes more are taken.
fn left_after(bytes: usize, what: impl FnOnce() -> String) -> Result<u64> {
    if GRANTED.get() {
        return Ok(u64::MAX);
    }
    let limits = *limits().get_or_insert_with(of_machine);
    let (mut least, needed) = (u64::MAX, bytes as u64);
    for ((limit, source), held) in limits.into_iter().zip(in_use()) {
        let Some(left) = limit.checked_sub(held.saturating_add(needed)) else {
            return Err(Error::Memory(Shortage { what: what(), needed, held, limit, source }));
        };
        least = least.min(left);
    }
    Ok(least)
}

/// Most bytes in small parts between two measurements, and what is left free for all else.
const STEP: usize = 1 << 20;
/// How many times more than it asks for a small part may take: the system gives some of them a page each.
const EXCESS: u64 = 64;

/// Asks for n bytes that stay in use, such as those of one of many things in a file. The process is measured when
/// they are many, and else now and then.
///
/// # Errors
/// As [`request`].
pub fn grow(bytes: usize, what: impl FnOnce() -> String) -> Result<()> {
    let allowance = match ALLOWANCE.get().checked_sub(bytes) {
        Some(allowance) => allowance,
        None => (left_after(bytes.max(STEP), what)? / EXCESS).min(STEP as u64) as usize,
    };
    ALLOWANCE.set(allowance);
    Ok(())
}

/// Appends to a vector whose final length is not known: it asks when it becomes longer.
///
/// # Errors
/// As [`filled`].
#[inline]
pub fn push<T>(values: &mut Vec<T>, value: T, what: impl Fn() -> String) -> Result<()> {
    if values.len() == values.capacity() {
        let more = values.len().max(4);
        grow(more.saturating_mul(size_of::<T>()), &what)?;
        reserve(values, more, what)?;
    }
    values.push(value);
    Ok(())
}

/// Inserts into a map of unknown size: it asks when it becomes larger. Its former table is held meanwhile.
///
/// # Errors
/// As [`request`].
pub fn insert<K: Eq + Hash, V>(map: &mut HashMap<K, V>, key: K, value: V, what: impl FnOnce() -> String) -> Result<()> {
    if map.len() == map.capacity() {
        grow(map.len().saturating_mul(2 * size_of::<(K, V)>()), what)?;
    }
    map.insert(key, value);
    Ok(())
}

/// `count` times the same value, for `what`.
///
/// # Errors
/// As [`request`]; also when the system refuses anyway.
pub fn filled<T: Clone>(count: usize, value: T, what: impl Fn() -> String) -> Result<Vec<T>> {
    let mut values = reserved(count, what)?;
    values.resize(count, value);
    Ok(values)
}

/// An empty vector with room for `count` values, for `what`.
///
/// # Errors
/// As [`filled`].
pub fn reserved<T>(count: usize, what: impl Fn() -> String) -> Result<Vec<T>> {
    let bytes = count.saturating_mul(size_of::<T>());
    request(bytes, &what)?;
    let mut values = Vec::new();
    reserve(&mut values, count, what)?;
    Ok(values)
}

/// Makes room for `more` values, which have been asked for.
fn reserve<T>(values: &mut Vec<T>, more: usize, what: impl Fn() -> String) -> Result<()> {
    values.try_reserve_exact(more).map_err(|_| {
        let (needed, [held, _]) = (more.saturating_mul(size_of::<T>()) as u64, in_use());
        Error::Memory(Shortage { what: what(), needed, held, limit: held, source: "the system gives no more" })
    })
}

fn of_machine() -> Limits {
    let available = available().map(|bytes| (bytes + in_use()[0], "which is what the machine has left"));
    let group = control_group().map(|bytes| (bytes, "which is what its control group may have"));
    [available.into_iter().chain(group).min().unwrap_or((u64::MAX, "")), address_space()]
}

/// The memory and the addresses that the process holds, in bytes.
fn in_use() -> [u64; 2] {
    ["VmRSS:", "VmSize:"].map(|name| of_process(name).unwrap_or(0))
}

/// A quantity of the process in bytes from Linux's `/proc`, such as `VmHWM:`, the most memory that it has held so far.
/// Elsewhere it is not known.
pub fn of_process(name: &str) -> Option<u64> {
    field(&std::fs::read_to_string("/proc/self/status").ok()?, name)
}

/// A line of `/proc` such as `VmRSS:   1234 kB`, in bytes.
fn field(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? << 10)
}

/// What can be had without swapping.
fn available() -> Option<u64> {
    field(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// The least limit of the control groups (version 1 or 2) that this process is in.
fn control_group() -> Option<u64> {
    let groups = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let limits = groups.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, Path::new(parts.next()?.trim_start_matches('/')));
        let (root, file) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            _ if controllers.split(',').any(|name| name == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => return None,
        };
        // A group's limit holds for those within it, too. A container may see its own group as the root.
        path.ancestors().filter_map(|group| read_number(&Path::new(root).join(group).join(file))).min()
    });
    limits.min()
}

/// The number in a file; nothing if there is none, or the word `max`.
fn read_number(path: &Path) -> Option<u64> {
    std::fs::read_to_string(path).ok()?.trim().parse().ok()
}

/// The limit of addresses (RLIMIT_AS).
#[cfg(unix)]
fn address_space() -> (u64, &'static str) {
    use nix::sys::resource::{Resource, getrlimit};
    (getrlimit(Resource::RLIMIT_AS).map_or(u64::MAX, |(soft, _)| soft), "of address space (`ulimit -v`)")
}

#[cfg(not(unix))]
fn address_space() -> (u64, &'static str) {
    (u64::MAX, "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_beyond_memory_are_refused_and_small_ones_granted() {
        request(1 << 20, || "a mebibyte".into()).unwrap();
        let error = request(1 << 60, || "an exbibyte".into()).unwrap_err();
        assert!(error.to_string().starts_with("an exbibyte: this takes 1099511627776 MiB beside"), "{error}");
        assert_eq!(filled(3, 7u8, || "three bytes".into()).unwrap(), [7; 3]);
        assert!(reserved::<u64>(usize::MAX, || "everything".into()).is_err());
    }

    /// Set where a test is alone in its process, whose limit it may change.
    const ALONE: &str = "ETALON_TEST_ALONE";

    #[test]
    fn a_limit_holds_until_the_next_one() {
        if std::env::var_os(ALONE).is_none() {
            let name = "memory::tests::a_limit_holds_until_the_next_one";
            let mut alone = std::process::Command::new(std::env::current_exe().unwrap());
            assert!(alone.args(["--exact", name]).env(ALONE, "").output().unwrap().status.success());
            return;
        }
        let grants = |limit: Option<u64>| {
            set_limit(limit);
            request(1 << 20, || "a mebibyte".into()).is_ok()
        };
        let limits = [Some(1 << 10), Some(1 << 40), Some(1 << 10), None];
        assert_eq!(limits.map(grants), [false, true, false, true]);
    }

    #[test]
    fn small_parts_ask_together() {
        grow(STEP + 1, || unreachable!()).unwrap();
        assert_eq!(ALLOWANCE.get(), STEP);
        grow(1000, || unreachable!()).unwrap();
        assert_eq!(ALLOWANCE.get(), STEP - 1000);
        assert!(grow(usize::MAX, || "everything".into()).is_err());
        assert_eq!(ALLOWANCE.get(), STEP - 1000);
    }

    #[test]
    fn vectors_and_maps_grow_as_they_are_filled() {
        let (mut values, mut map) = (Vec::new(), HashMap::new());
        for i in 0..1000 {
            push(&mut values, i, || unreachable!()).unwrap();
            insert(&mut map, i, 2 * i, || unreachable!()).unwrap();
        }
        assert!(values == (0..1000).collect::<Vec<_>>() && map.len() == 1000 && map[&999] == 1998);
    }

    #[test]
    fn lines_of_proc_are_in_kibibytes() {
        let text = "VmPeak:\t  300 kB\nVmSize:\t     200 kB\nVmRSS:\t       3 kB\n";
        assert_eq!(
            (field(text, "VmSize:"), field(text, "VmRSS:"), field(text, "VmSwap:")),
            (Some(204_800), Some(3072), None)
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_process_knows_what_it_holds() {
        let [before, _] = in_use();
        let held = vec![1u8; 1 << 26];
        let [after, addresses] = in_use();
        assert!(before > 0 && after > before + (1 << 25), "{before} {after} {}", held[9]);
        assert!(addresses >= after);
    }
}
