//! Renderers in other programs: a command line with placeholders, run once for each image and timed from outside.

use super::program::{Group, last_line, tail, words};
use etalon_core::error::{Error, Result};
use etalon_core::interrupt;
use etalon_core::raster::{self, Image, ReadOptions};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// The placeholders of a command, and what stands in their place.
pub const PLACEHOLDERS: [(&str, &str); 7] = [
    ("scene", "the scene file"),
    ("spp", "samples per pixel"),
    ("seed", "the seed, another one for each replicate"),
    ("out", "the image to write: a path that ends in .exr, in an empty folder"),
    ("threads", "the number of threads"),
    ("width", "columns of the image"),
    ("height", "rows of the image"),
];
/// Placeholders without which a program cannot be measured.
const NEEDED: [&str; 2] = ["spp", "out"];
/// Longest name of a renderer, in bytes.
const LONGEST_NAME: usize = 64;
/// Interval at which interrupts are checked, and the time for the end of standard error to arrive.
const POLL: Duration = Duration::from_millis(50);
const GRACE: Duration = Duration::from_secs(2);

/// A renderer in another program.
#[derive(Debug, Clone)]
pub struct Renderer {
    name: String,
    words: Vec<String>,
    /// What `{scene}` stands for, empty if the command does not have it.
    scene: PathBuf,
    threads: usize,
    limit: Duration,
}

/// One image by a renderer, and the time that its process took.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// As it was written.
    pub image: Image,
    /// Wall-clock seconds from the start of the process to its end.
    pub wall: f64,
    /// Processor seconds (user and system) of the process and of those processes that it has waited for.
    pub cpu: f64,
}

/// Why there is no image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunFailure {
    /// In words, with the last line of the program's standard error.
    pub message: String,
    /// Whether another run would only waste time: the program cannot be started, or it took too long.
    pub is_final: bool,
}

impl Renderer {
    /// A renderer by its `definition`, `NAME=COMMAND`; `{scene}` in the command stands for `scene`. A run may take `limit`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a definition without a name or a command, a placeholder that is unknown, and one that is missing.
    pub fn new(definition: &str, scene: Option<&Path>, threads: usize, limit: Duration) -> Result<Self> {
        let wrong = |message: String| Error::parameter("renderer", message);
        let (name, command) = definition.split_once('=').ok_or_else(|| {
            wrong(format!("{definition:?} has no name"))
                .with_hint("NAME=COMMAND, for example mine='prog {scene} {out}'")
        })?;
        check_name(name)?;
        let words = words("renderer", command)?;
        let used: Vec<&str> = words.iter().flat_map(|word| placeholders(word)).collect();
        let known = || PLACEHOLDERS.map(|(name, _)| format!("{{{name}}}")).join(" ");
        if let Some(unknown) = used.iter().find(|used| !PLACEHOLDERS.iter().any(|(name, _)| name == *used)) {
            return Err(wrong(format!("{name}: there is no placeholder {{{unknown}}}")).with_hint(known()));
        }
        if let Some(missing) = NEEDED.iter().find(|needed| !used.contains(needed)) {
            return Err(wrong(format!("{name}: the command has no {{{missing}}}")).with_hint(known()));
        }
        let scene = match scene {
            _ if !used.contains(&"scene") => PathBuf::new(),
            Some(scene) => scene.to_owned(),
            None => {
                return Err(wrong(format!("{name}: {{scene}} stands for no file, as the scene is a built-in one"))
                    .with_hint("`renderer_scene` names the file"));
            }
        };
        Ok(Self { name: name.to_owned(), words, scene, threads, limit })
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether its command asks for images of a given size.
    pub fn has_size(&self) -> bool {
        let has = |wanted| self.words.iter().any(|word| placeholders(word).contains(&wanted));
        has("width") && has("height")
    }

    /// Runs the program once. Processor time is that of all children of this process: nothing else may be run meanwhile.
    ///
    /// # Errors
    /// [`RunFailure`] if it does not end with exit code 0 within the limit of time, or `at_most` if that is shorter, or does
    /// not leave an image of `size` whose values are finite.
    pub fn run(
        &self,
        spp: u32,
        seed: u64,
        size: [usize; 2],
        at_most: Duration,
    ) -> std::result::Result<Rendered, RunFailure> {
        let failure = |message: String| RunFailure { message, is_final: false };
        let folder = tempfile::tempdir().map_err(|e| failure(format!("no temporary folder: {e}")))?;
        let out = folder.path().join("image.exr");
        let value = |name: &str| match name {
            "scene" => self.scene.display().to_string(),
            "spp" => spp.to_string(),
            "seed" => seed.to_string(),
            "out" => out.display().to_string(),
            "threads" => self.threads.to_string(),
            "width" => size[0].to_string(),
            _ => size[1].to_string(),
        };
        let fill = |word: &String| {
            placeholders(word)
                .iter()
                .fold(word.clone(), |text, name| text.replace(&format!("{{{name}}}"), &value(name)))
        };
        let words: Vec<String> = self.words.iter().map(fill).collect();
        let (wall, cpu) = execute(&words, self.limit.min(at_most))?;
        let image = read_only_image(folder.path(), &out).map_err(failure)?;
        let found = [image.width(), image.height()];
        if found != size {
            let [[w, h], [expected_w, expected_h]] = [found, size];
            return Err(failure(format!("its image has {w}x{h} pixels, not {expected_w}x{expected_h}")));
        }
        if let Some(i) = image.pixels().iter().position(|pixel| !pixel.is_finite()) {
            let count = image.pixels().iter().filter(|pixel| !pixel.is_finite()).count();
            let pixels =
                if count == 1 { "1 pixel of its image is".into() } else { format!("{count} pixels of its image are") };
            let (x, y) = (i % size[0], i / size[0]);
            return Err(failure(format!("{pixels} not finite, the first at ({x}, {y})")));
        }
        Ok(Rendered { image, wall, cpu })
    }
}

/// Checks the name of a renderer, which is that of a folder, too.
///
/// # Errors
/// [`Error::Parameter`].
pub fn check_name(name: &str) -> Result<()> {
    let usual = |c: char| c.is_alphanumeric() || "-_.+ ".contains(c);
    if name.is_empty() || name.len() > LONGEST_NAME || !name.chars().all(usual) || name.starts_with('.') {
        return Err(Error::parameter("renderer", format!("{name:?} is no name of a renderer"))
            .with_hint("NAME=COMMAND; names have letters, digits, spaces and -_.+, and begin with no dot"));
    }
    Ok(())
}

/// The names between braces in a word; braces around anything but lower-case letters are no placeholders.
fn placeholders(word: &str) -> Vec<&str> {
    let name = |part: &'_ str| part.split_once('}').map_or(0, |(name, _)| name.len());
    let parts = word.split('{').skip(1).map(|part| &part[..name(part)]);
    parts.filter(|name| !name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase())).collect()
}

/// Runs a command to its end; returns its wall-clock and processor seconds.
fn execute(words: &[String], limit: Duration) -> std::result::Result<(f64, f64), RunFailure> {
    let hopeless = |message: String| RunFailure { message, is_final: true };
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    // The group starts first, so that the program is always a member; its leader is not waited for before the clock stops.
    let group = Group::start().map_err(|e| hopeless(e.to_string()))?;
    group.add(&mut command);
    let (start, before) = (Instant::now(), children_seconds());
    let mut child = command.spawn().map_err(|e| hopeless(format!("{} cannot be started: {e}", words[0])))?;
    let (keep, stderr) = channel();
    if let Some(pipe) = child.stderr.take() {
        thread::spawn(move || keep.send(tail(pipe)));
    }
    let (tell, ended) = channel();
    thread::spawn(move || {
        let status = child.wait();
        tell.send((status, start.elapsed(), children_seconds()))
    });
    // Wait for its end, the limit or an interrupt.
    let waited = loop {
        let left = limit.saturating_sub(start.elapsed());
        match ended.recv_timeout(left.min(POLL)) {
            Ok(end) => break Some(end),
            Err(RecvTimeoutError::Timeout) if left > Duration::ZERO && !interrupt::requested() => {}
            Err(_) => break None,
        }
    };
    // What it has started and left must not slow down the next run.
    drop(group);
    let said = || {
        let text = stderr.recv_timeout(GRACE).unwrap_or_default();
        last_line(&text).map_or_else(String::new, |line| format!("; its standard error ends with {line}"))
    };
    let Some((status, elapsed, after)) = waited else {
        return Err(hopeless(format!("it did not end within {:.1} s{}", start.elapsed().as_secs_f64(), said())));
    };
    let wall = elapsed.as_secs_f64();
    let cpu = before.zip(after).map_or(wall, |(before, after)| after - before);
    match status {
        Ok(status) if status.success() => Ok((wall, cpu)),
        Ok(status) => {
            Err(RunFailure { message: format!("it failed ({}){}", described(status), said()), is_final: false })
        }
        Err(e) => Err(hopeless(format!("its end is unknown: {e}"))),
    }
}

fn described(status: ExitStatus) -> String {
    status.code().map_or_else(|| status.to_string(), |code| format!("exit code {code}"))
}

/// Processor seconds of the children that have ended; `None` where the system does not say.
#[cfg(unix)]
fn children_seconds() -> Option<f64> {
    use nix::sys::resource::{UsageWho, getrusage};
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).ok()?;
    let seconds = |time: nix::sys::time::TimeVal| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64;
    Some(seconds(usage.user_time()) + seconds(usage.system_time()))
}

/// `None`: wall-clock time counts instead.
#[cfg(not(unix))]
fn children_seconds() -> Option<f64> {
    None
}

/// The image at `out`, or else the only file beside it: programs may add an extension of their own.
fn read_only_image(folder: &Path, out: &Path) -> std::result::Result<Image, String> {
    let files: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    let path = match files.as_slice() {
        [] => return Err("it ended well and wrote no image".to_owned()),
        _ if out.is_file() => out,
        [only] => only,
        many => return Err(format!("it wrote {} files, none of them the one that was asked for", many.len())),
    };
    raster::read(path, ReadOptions::default()).map_err(|e| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        format!("its image cannot be read: {}", e.to_string().replace(&path.display().to_string(), &name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new(definition: &str) -> Result<Renderer> {
        Renderer::new(definition, Some(Path::new("a scene.xml")), 2, Duration::from_secs(20))
    }

    #[test]
    fn definitions_are_checked() {
        for (wrong, says) in [
            ("prog {spp} {out}", "has no name"),
            ("=prog {spp} {out}", "no name of a renderer"),
            ("../up=prog {spp} {out}", "no name of a renderer"),
            ("a=", "is no command"),
            ("a='prog {spp} {out}", "is no command"),
            ("a=BIAS=0.1 prog {spp} {out}", "no shell reads the command"),
            ("a=prog {spp} {output}", "no placeholder {output}"),
            ("a=prog {spp}", "has no {out}"),
            ("a=prog {out}", "has no {spp}"),
        ] {
            let error = new(wrong).unwrap_err().to_string();
            assert!(error.contains(says), "{wrong}: {error}");
        }
        let without = Renderer::new("a=prog {scene} {spp} {out}", None, 1, Duration::from_secs(1));
        assert!(without.unwrap_err().to_string().contains("stands for no file"));
        assert!(new("a=prog {spp} {out}").is_ok_and(|r| !r.has_size() && r.name() == "a"));
        assert!(new("a=prog {spp} -r {width}x{height} --json='{\"A\": {}}' {out}").is_ok_and(|r| r.has_size()));
    }

    #[cfg(unix)]
    #[test]
    fn runs_are_timed_and_their_failures_named() {
        let run = |script: &str, limit: f64| {
            let renderer = new(&format!("a=sh -c '{script}' - {{spp}} {{seed}} {{out}} {{scene}}")).unwrap();
            renderer.run(3, 7, [2, 1], Duration::from_secs_f64(limit))
        };
        let image = |values: &str| format!("printf \"PF\\n2 1\\n-1\\n\" > \"$3\"; printf \"{values}\" >> \"$3\"");
        let black = "\\\\000".repeat(24);
        let good =
            run(&format!("test \"$1 $2 $4\" = \"3 7 a scene.xml\" && sleep 0.2 && {}", image(&black)), 20.0).unwrap();
        assert!(good.wall > 0.2 && good.cpu < good.wall, "{} {}", good.wall, good.cpu);
        // A file with another extension is found, too.
        assert!(run(&image(&black).replace("$3", "$3.pfm"), 20.0).is_ok());
        let nan = format!("{}\\\\000\\\\000\\\\300\\\\177", "\\\\000".repeat(20));
        for (script, says, is_final) in [
            ("echo reason >&2; exit 5", "exit code 5); its standard error ends with \"reason\"", false),
            ("true", "wrote no image", false),
            ("echo nonsense > \"$3\"", "cannot be read: image.exr", false),
            (&image(&black).replace("2 1", "1 2"), "has 1x2 pixels, not 2x1", false),
            (&image(&nan), "1 pixel of its image is not finite, the first at (1, 0)", false),
            ("sleep 1000", "did not end within", true),
        ] {
            let failure = run(script, if is_final { 0.3 } else { 20.0 }).unwrap_err();
            assert!(failure.message.contains(says) && failure.is_final == is_final, "{script}: {failure:?}");
        }
        let missing = new("a=/no/such/program {spp} {out}").unwrap().run(1, 1, [1, 1], GRACE).unwrap_err();
        assert!(missing.is_final && missing.message.contains("/no/such/program cannot be started"), "{missing:?}");
    }
}
