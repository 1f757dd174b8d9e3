//! Files are written whole or not at all: to a temporary file in the same folder, then renamed. A process that is
//! killed meanwhile leaves the temporary file, `.etalon-*.part`, which nothing reads and which may be removed.

use crate::error::{Error, Result};
use crate::interrupt;
use crate::memory;
use std::collections::BTreeSet;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// The temporary files that are being written.
static PARTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn parts() -> MutexGuard<'static, Vec<PathBuf>> {
    PARTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What tells whether two paths lead to the same file.
#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = PathBuf;

/// The identity of the file at `path`, if there is one.
fn identity(path: &Path) -> Option<Identity> {
    #[cfg(unix)]
    let found = {
        use std::os::unix::fs::MetadataExt;
        path.metadata().map(|there| (there.dev(), there.ino()))
    };
    #[cfg(not(unix))]
    let found = path.canonicalize();
    found.ok()
}

/// Whether both paths lead to the same existing file.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((identity(a), identity(b)), (Some(a), Some(b)) if a == b)
}

/// The files that a command reads: those that its arguments name, and those that these name. `None` in a library, which
/// leaves it to its user what may be replaced.
static INPUTS: Mutex<Option<BTreeSet<Identity>>> = Mutex::new(None);

fn inputs() -> MutexGuard<'static, Option<BTreeSet<Identity>>> {
    INPUTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on nothing replaces a file that was read.
pub fn protect_inputs() {
    *inputs() = Some(BTreeSet::new());
}

/// Remembers a file that is read.
pub fn note_input(path: &Path) {
    if let Some(inputs) = inputs().as_mut() {
        inputs.extend(identity(path));
    }
}

/// Remembers the files that the words of a command name, alone or after `=` and in lists.
pub fn note_command(words: &[String]) {
    let parts = words.iter().flat_map(|word| word.split(|c: char| c.is_whitespace() || "=,;:'\"|&<>()".contains(c)));
    let named = parts.chain(words.iter().map(String::as_str)).map(Path::new);
    named.filter(|path| path.is_file()).for_each(note_input);
}

/// Forgets a file that was read to be continued, and may be replaced.
pub fn release_input(path: &Path) {
    if let (Some(inputs), Some(identity)) = (inputs().as_mut(), identity(path)) {
        inputs.remove(&identity);
    }
}

/// An error if `path` leads to a file that the command reads.
pub fn check_no_input(path: &Path) -> Result<()> {
    let Some(identity) = identity(path) else { return Ok(()) };
    if inputs().as_ref().is_some_and(|inputs| inputs.contains(&identity)) {
        return Err(Error::input(path, "this file is an input of this command")
            .with_hint("name another file or folder: the result would replace the input"));
    }
    Ok(())
}

/// Keeps a file in the list; dropped, it removes the file from there.
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        parts().retain(|part| *part != self.0);
    }
}

/// Whether a file is being written.
pub fn is_writing() -> bool {
    !parts().is_empty()
}

/// Ends the process at once, without leaving temporary files behind.
pub fn exit_without_parts(code: i32) -> ! {
    // The lock is never released: other threads that begin a file wait until the process ends.
    let parts = parts();
    for part in parts.iter() {
        // Files that cannot be removed stay: no error can be reported any more.
        let _ = std::fs::remove_file(part);
    }
    std::process::exit(code)
}

/// Writes `path` through `fill`; after an error or a crash the former file is unchanged.
///
/// Missing parent folders are made. The file gets the usual permissions (0666 & ~umask). A symbolic link stays a
/// link: the file that it leads to is replaced, or made if it is missing.
pub fn write_atomic(path: &Path, fill: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    // Who has results to write has come to an end, whether asked to or not.
    let _ = interrupt::requested();
    let path = &link_target(path)?;
    let (mut part, _listed) = temporary(path)?;
    let mut writer = BufWriter::with_capacity(1 << 16, part.as_file_mut());
    fill(&mut writer)?;
    writer.flush().map_err(|e| Error::io(path, e))?;
    drop(writer);
    part.persist(path).map_err(|e| Error::io(path, e.error))?;
    Ok(())
}

/// Checks before a long computation that `path` can be written.
pub fn check_writable(path: &Path) -> Result<()> {
    temporary(&link_target(path)?).map(drop)
}

/// Where a chain of symbolic links ends, whether there is a file or not; a path that is no link stays as it is.
fn link_target(path: &Path) -> Result<PathBuf> {
    let mut end = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(next) = std::fs::read_link(&end) else { return Ok(end) };
        end = end.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(Error::io(path, std::io::Error::other("too many levels of symbolic links")))
}

/// As many symbolic links are followed as Linux follows.
const MAX_LINKS: usize = 40;

/// A temporary file beside `path`, which must not be there or be a file that is no input: a device or a pipe would be replaced.
fn temporary(path: &Path) -> Result<(NamedTempFile, Listed)> {
    check_no_input(path)?;
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(Error::io(path, std::io::ErrorKind::IsADirectory.into())),
        // A name that is too long, for one.
        Err(error) if error.kind() == std::io::ErrorKind::InvalidFilename => return Err(Error::io(path, error)),
        Ok(there) if !there.is_file() => {
            return Err(Error::parameter("path", format!("{} is there and is not a file", path.display()))
                .with_hint("name a file that is new or may be replaced"));
        }
        _ => {}
    }
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".etalon-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // Locked until the file is in the list: none is made while the process ends.
    let mut parts = parts();
    let file = builder.tempfile_in(folder).map_err(|e| Error::io(path, e))?;
    parts.push(file.path().into());
    let listed = Listed(file.path().into());
    Ok((file, listed))
}

/// [`write_atomic`] for bytes in memory.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    write_atomic(path, |w| w.write_all(bytes).map_err(|e| Error::io(path, e)))
}

/// Reads an input as a whole, refusing one that is larger than `limit` bytes, a device, which may never end, and a named
/// pipe, which may never begin. Pipes of the shell (`/dev/stdin`, `<(command)`) are read.
pub fn read_bounded(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let bytes = read_own(path, limit)?;
    note_input(path);
    Ok(bytes)
}

/// The same for a file that the program wrote, and may replace.
pub fn read_own(path: &Path, limit: u64) -> Result<Vec<u8>> {
    use std::io::Read;
    let there = std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
    if there.is_dir() {
        return Err(Error::io(path, std::io::ErrorKind::IsADirectory.into()));
    }
    if !there.is_file() && !is_shell_pipe(path, &there) {
        return Err(Error::input(path, "this is a pipe or a device, not a file")
            .with_hint("what a pipe brings can be read from /dev/stdin"));
    }
    let file = std::fs::File::open(path).map_err(|e| Error::io(path, e))?;
    let size = if there.is_file() { there.len().min(limit) as usize } else { 0 };
    let what = || format!("{}, a file", path.display());
    let mut bytes = memory::reserved(size, what)?;
    let (mut file, mut next) = (file.take(limit + 1), Vec::new());
    // What is longer than its size says, or has none, asks each time that its room is full.
    loop {
        let room = (bytes.capacity() - bytes.len()) as u64;
        file.by_ref().take(room).read_to_end(&mut bytes).map_err(|e| Error::io(path, e))?;
        file.by_ref().take(1).read_to_end(&mut next).map_err(|e| Error::io(path, e))?;
        match next.pop() {
            Some(byte) if (bytes.len() as u64) < limit => memory::push(&mut bytes, byte, what)?,
            Some(byte) => break bytes.push(byte),
            None => break,
        }
    }
    if bytes.len() as u64 > limit {
        let size = if limit < 1 << 20 { format!("{limit} bytes") } else { format!("{} MiB", limit >> 20) };
        return Err(Error::limit(path, format!("larger than {size}")));
    }
    Ok(bytes)
}

/// A text without the byte order mark that some programs begin it with.
pub fn without_bom(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

/// A pipe that a shell has opened, or what else stands for one.
#[cfg(unix)]
fn is_shell_pipe(path: &Path, there: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = there.file_type();
    kind.is_fifo() && (path.starts_with("/dev") || path.starts_with("/proc"))
}

#[cfg(not(unix))]
fn is_shell_pipe(_: &Path, _: &std::fs::Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_keeps_the_old_file() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("deep/er/a.txt");
        write_bytes(&path, b"old").unwrap();
        let failed = write_atomic(&path, |w| {
            w.write_all(b"half of the new").unwrap();
            Err(Error::parameter("test", "stop here"))
        });
        assert!(failed.is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        check_writable(&path).unwrap();
        assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "no temporary file is left");
        assert!(check_writable(&path.join("below a file")).is_err() && check_writable(dir.path()).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_are_written_through() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        write_bytes(&at("folder/real"), b"old").unwrap();
        symlink("folder/real", at("direct")).unwrap();
        symlink(at("direct"), at("chained")).unwrap();
        symlink("folder/new", at("dangling")).unwrap();
        for (link, real, text) in [("direct", "real", "1"), ("chained", "real", "2"), ("dangling", "new", "3")] {
            check_writable(&at(link)).unwrap();
            write_bytes(&at(link), text.as_bytes()).unwrap();
            assert!(std::fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link} is no link any more");
            assert_eq!(std::fs::read_to_string(at("folder").join(real)).unwrap(), text);
        }
        symlink("loop", at("loop")).unwrap();
        assert!(write_bytes(&at("loop"), b"").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_file_is_the_same_under_every_name() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        write_bytes(&at("a"), b"same").unwrap();
        write_bytes(&at("b"), b"same").unwrap();
        std::os::unix::fs::symlink("a", at("symbolic")).unwrap();
        std::fs::hard_link(at("a"), at("hard")).unwrap();
        for name in ["a", "./a", "symbolic", "hard"] {
            assert!(is_same_file(&at("a"), &at(name)), "{name}");
        }
        assert!(!is_same_file(&at("a"), &at("b")) && !is_same_file(&at("gone"), &at("gone")));
    }

    #[test]
    fn oversized_files_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        write_bytes(&path, &[0; 11]).unwrap();
        assert!(read_bounded(&path, 10).is_err());
        assert_eq!(read_bounded(&path, 11).unwrap().len(), 11);
    }
}
