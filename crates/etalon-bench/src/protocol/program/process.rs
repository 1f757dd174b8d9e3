//! A child process as a connection: one request in flight, every response within a time limit. Its process group ends when this
//! process ends, however that happens.
//!
//! Three threads serve the three pipes, so that the program may read, write and report errors in any order without a
//! deadlock; they hold at most one request, a few blocks of a response, and the end of standard error.

use super::connection::{Answer, Connection, END, protocol_error};
use etalon_core::error::{Error, Result};
use etalon_core::{files, interrupt};
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// How much of the end of standard error is kept, in bytes.
const STDERR_TAIL: usize = 8192;
/// Longest line of standard error that a message shows whole, in bytes.
const LONGEST_LINE: usize = 1000;
/// Time for a program to quit when asked, and for the end of its standard error to arrive.
const GRACE: Duration = Duration::from_secs(2);

/// What the first line of an answer begins with that ends the test with the text after it.
const REFUSAL: &str = "error ";

/// Interval at which interrupts are checked while waiting for a response.
const POLL: Duration = Duration::from_millis(50);

/// The words of a command, split as a shell would (quotes and backslashes; nothing is substituted). The files that they name are
/// inputs from now on. `parameter` is what the command was given as.
///
/// # Errors
/// [`Error::Parameter`] for a command without a word, with a quote that is not closed, or that begins with a variable as for a shell.
pub fn words(parameter: &'static str, command: &str) -> Result<Vec<String>> {
    let words = shlex::split(command).filter(|words| !words.is_empty()).ok_or_else(|| {
        Error::parameter(parameter, format!("{command:?} is no command"))
            .with_hint("give a program and its arguments, with quotes in pairs")
    })?;
    let is_name = |name: &str| {
        name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') && !name.starts_with(|c: char| c.is_ascii_digit())
    };
    if words[0].split_once('=').is_some_and(|(name, _)| !name.is_empty() && is_name(name)) {
        let message = format!("\"{}\" is no program, and no shell reads the command", words[0]);
        return Err(Error::parameter(parameter, message).with_hint(format!("`env {} ...` sets the variable", words[0])));
    }
    files::note_command(&words);
    Ok(words)
}

/// A running program. It is ended, with what it started, when this is dropped.
pub struct Process {
    /// The program in messages.
    name: String,
    child: Child,
    /// The program and its children; `None` once they were ended.
    group: Option<Group>,
    limit: Duration,
    requests: Sender<String>,
    answers: Receiver<Vec<u8>>,
    stderr: Receiver<Vec<u8>>,
    /// Whether it has answered nothing yet.
    is_new: bool,
    /// The violation after which no requests are sent.
    failure: Option<String>,
}

impl Process {
    /// Starts the program of `words`, which messages call `name`.
    pub fn start(name: &str, words: &[String], limit: Duration) -> Result<Self> {
        let mut start = Command::new(&words[0]);
        start.args(&words[1..]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // The group starts first, so that the program is always a member.
        let group = Group::start()?;
        group.add(&mut start);
        let mut child = start.spawn().map_err(|e| Error::io(Path::new(&words[0]), e))?;
        let (requests, to_write) = channel::<String>();
        let (read, answers) = sync_channel(2);
        let (to_keep, stderr) = channel();
        if let Some(mut stdin) = child.stdin.take() {
            thread::spawn(move || {
                // A program that does not read is detected by its missing response.
                while let Ok(request) = to_write.recv() {
                    if stdin.write_all(request.as_bytes()).and_then(|()| stdin.flush()).is_err() {
                        break;
                    }
                }
            });
        }
        if let Some(stdout) = child.stdout.take() {
            thread::spawn(move || forward(stdout, &read));
        }
        if let Some(pipe) = child.stderr.take() {
            // The receiver may be gone.
            thread::spawn(move || to_keep.send(tail(pipe)));
        }
        let group = Some(group);
        Ok(Self { name: name.to_owned(), child, group, limit, requests, answers, stderr, is_new: true, failure: None })
    }

    fn exchange(&mut self, request: String, most: usize) -> std::result::Result<String, String> {
        let deadline = Instant::now() + self.limit;
        // If the thread is gone, so is the program: the wait below reports it.
        let _ = self.requests.send(request);
        let mut answer = Answer::new(most);
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.answers.recv_timeout(left.min(POLL)) {
                Ok(block) => {
                    if let Some(text) = answer.add(&block)? {
                        return Ok(text);
                    }
                }
                Err(RecvTimeoutError::Timeout) if interrupt::requested() => {
                    return Err("it was interrupted".to_owned());
                }
                Err(RecvTimeoutError::Timeout) if left > POLL => {}
                Err(RecvTimeoutError::Timeout) => {
                    let (progress, limit) = (answer.progress(), self.limit.as_secs_f64());
                    return Err(match answer.is_empty() {
                        true => format!("it gave no answer within {limit} s"),
                        false => format!("it had answered {progress}, but not \"{END}\" within {limit} s"),
                    });
                }
                Err(RecvTimeoutError::Disconnected) => {
                    let ended = self.ended(Duration::from_millis(500)).map_or_else(
                        || "it closed its standard output".to_owned(),
                        |status| format!("it ended ({status})"),
                    );
                    return Err(format!("{ended} after {}", answer.progress()));
                }
            }
        }
    }

    /// How the program ended, if it does so within `grace`: its pipes are closed before its end can be seen.
    fn ended(&mut self, grace: Duration) -> Option<ExitStatus> {
        let deadline = Instant::now() + grace;
        loop {
            match self.child.try_wait() {
                Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(2)),
                ended => return ended.ok().flatten(),
            }
        }
    }

    /// Ends the program; returns the last line of its standard error for a message.
    fn end(&mut self) -> String {
        self.kill();
        // A process that left the group may hold the pipe open.
        let stderr = self.stderr.recv_timeout(GRACE).unwrap_or_default();
        last_line(&stderr).map_or_else(String::new, |line| format!("; its standard error ends with {line}"))
    }

    /// Ends the program, and what it started and left in its group, at once.
    fn kill(&mut self) {
        self.group = None;
        // It may have left the group; both fail only if it has ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Connection for Process {
    fn name(&self) -> &str {
        &self.name
    }

    fn ask(&mut self, request: String, most: usize) -> Result<String> {
        if let Some(why) = &self.failure {
            return Err(protocol_error(&self.name, why.clone()));
        }
        let asked = request.lines().next().unwrap_or_default().to_owned();
        let why = match self.exchange(request, most) {
            Ok(answer) => match answer.strip_prefix(REFUSAL) {
                None => {
                    self.is_new = false;
                    return Ok(answer);
                }
                Some(text) => {
                    self.kill();
                    text.trim_ascii().to_owned()
                }
            },
            Err(what) => {
                let when = if self.is_new { "at the first request," } else { "asked" };
                format!("{when} {asked:?}, {what}{}", self.end())
            }
        };
        self.failure = Some(why.clone());
        Err(if interrupt::requested() { Error::Interrupted } else { protocol_error(&self.name, why) })
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.failure.is_some() {
            return;
        }
        // The thread that writes drops the pipe once the sender is gone.
        let _ = std::mem::replace(&mut self.requests, channel().0).send("quit\n".to_owned());
        self.ended(GRACE);
        self.kill();
    }
}

/// Forwards blocks until the pipe ends or the receiver is gone.
fn forward(mut from: impl Read, to: &SyncSender<Vec<u8>>) {
    let mut block = vec![0; 1 << 16];
    while let Ok(length @ 1..) = from.read(&mut block) {
        if to.send(block[..length].to_vec()).is_err() {
            break;
        }
    }
}

/// The last line that is not empty, quoted, control characters escaped; of a very long one only the end, where most
/// messages say what is wrong.
pub fn last_line(bytes: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(bytes);
    let line = text.lines().map(str::trim).rfind(|line| !line.is_empty())?;
    let start = line.ceil_char_boundary(line.len().saturating_sub(LONGEST_LINE));
    Some(format!("{}{:?}", if start > 0 { "…" } else { "" }, &line[start..]))
}

/// Reads to the end and keeps the last bytes.
pub fn tail(mut from: impl Read) -> Vec<u8> {
    let (mut block, mut tail) = (vec![0; 1 << 12], Vec::new());
    while let Ok(length @ 1..) = from.read(&mut block) {
        tail.extend_from_slice(&block[..length]);
        let excess = tail.len().saturating_sub(STDERR_TAIL);
        tail.drain(..excess);
    }
    tail
}

/// A group of processes, all of which are killed when this is dropped, and also when this process ends without dropping it: by
/// a signal, even SIGKILL, or in a crash.
///
/// The group's leader is a shell that waits at a pipe whose other end only this process holds; when that end closes, the shell
/// kills its group. The leader is started before any member and waited for after the group was killed, so that at no moment
/// a member is without it, and the number of the group is not used again meanwhile.
///
/// A process that leaves the group (`setsid`, `setpgid`) is not ended. Where there are no process groups, none is.
#[derive(Debug)]
pub struct Group {
    #[cfg(unix)]
    leader: std::process::Child,
}

#[cfg(unix)]
impl Group {
    /// Starts the leader.
    ///
    /// # Errors
    /// [`Error::Io`] where there is no shell.
    pub fn start() -> Result<Self> {
        use std::os::unix::process::CommandExt;
        use std::process::Stdio;
        const SHELL: &str = "/bin/sh";
        // A member that signals its whole group, or reads from a terminal in the background, must not end or stop the leader.
        const WAIT: &str = "trap '' HUP INT QUIT TERM USR1 USR2 TSTP TTIN TTOU; read -r line; kill -KILL 0";
        let mut shell = Command::new(SHELL);
        shell.args(["-c", WAIT]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).process_group(0);
        let leader = shell.spawn().map_err(|e| {
            let needed = "it is needed to end other programs with this one";
            Error::io(SHELL.as_ref(), std::io::Error::new(e.kind(), format!("{e}; {needed}")))
        })?;
        Ok(Self { leader })
    }

    /// Makes the process that `command` starts a member.
    pub fn add(&self, command: &mut Command) {
        std::os::unix::process::CommandExt::process_group(command, self.id());
    }

    /// The number of the group, which is that of its leader: process numbers fit.
    fn id(&self) -> i32 {
        self.leader.id() as i32
    }
}

#[cfg(unix)]
impl Drop for Group {
    fn drop(&mut self) {
        use nix::sys::signal::{Signal, killpg};
        // Both fail only if a member has killed the leader, and then there may be nothing left to kill.
        let _ = killpg(nix::unistd::Pid::from_raw(self.id()), Signal::SIGKILL);
        let _ = self.leader.wait();
    }
}

#[cfg(not(unix))]
impl Group {
    /// Does nothing: there are no process groups.
    pub fn start() -> Result<Self> {
        Ok(Self {})
    }

    /// Does nothing.
    pub fn add(&self, _: &mut Command) {}
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;
    use std::process::Child;

    #[test]
    fn the_last_line_is_shown_to_its_end() {
        let shown = |text: &str| last_line(text.as_bytes()).unwrap_or_default();
        let reason = format!("ValueError: {} must be less than 2**32", "x".repeat(900));
        assert_eq!(shown(&format!("Traceback:\n  File\n{reason}\r\n \n\n")), format!("{reason:?}"));
        let end = shown(&format!("first\n{}{reason}", "é".repeat(700)));
        assert!(end.starts_with("…\"é") && end.ends_with("2**32\"") && end.len() < LONGEST_LINE + 10, "{end}");
        assert_eq!(shown("\x1b[31mred\x1b[0m \u{202e}\0"), "\"\\u{1b}[31mred\\u{1b}[0m \\u{202e}\\0\"");
        assert_eq!((last_line(b""), last_line(b"\n \n")), (None, None));
    }

    fn member(group: &Group, script: &str) -> Child {
        let mut command = Command::new("sh");
        group.add(command.args(["-c", script]));
        command.spawn().unwrap()
    }

    #[test]
    fn each_group_ends_by_itself() {
        let (one, two) = (Group::start().unwrap(), Group::start().unwrap());
        let [mut first, mut second] = [&one, &two].map(|group| member(group, "sleep 1000; :"));
        drop(one);
        assert_eq!(first.wait().unwrap().signal(), Some(9));
        assert_eq!(second.try_wait().unwrap(), None);
        drop(two);
        assert_eq!(second.wait().unwrap().signal(), Some(9));
    }

    #[test]
    fn a_group_ends_when_the_pipe_closes() {
        let mut group = Group::start().unwrap();
        let mut member = member(&group, "trap '' HUP INT TERM; while :; do sleep 1000; done");
        // What the system does when this process ends.
        drop(group.leader.stdin.take());
        assert_eq!(member.wait().unwrap().signal(), Some(9));
    }
}
