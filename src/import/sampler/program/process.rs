//! Another process, asked for lines: one request in flight, every answer within a time limit.
//!
//! Three threads keep the three pipes going, so that a program may read, write and complain in any order without either side
//! waiting for ever; none of them holds more than one request, a few blocks of an answer, or the end of the complaints.

use super::answer::{Answer, END};
use super::group::Group;
use super::peer::{Peer, fault};
use crate::error::{Error, Result};
use crate::interrupt;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// How much of the end of standard error is kept, in bytes.
const COMPLAINTS: usize = 8192;
/// Longest line of standard error that a message shows whole, in bytes.
const LONGEST_LINE: usize = 1000;
/// How long a program that was asked to quit may take, and the end of its complaints to come.
const GRACE: Duration = Duration::from_secs(2);

/// How long a request to stop may go unnoticed while an answer is waited for.
const ATTENTION: Duration = Duration::from_millis(50);

/// A running program. It is ended, with what it started, when this is dropped.
pub struct Process {
    command: String,
    child: Child,
    /// The program and what it starts; `None` once that was ended.
    group: Option<Group>,
    limit: Duration,
    requests: Sender<String>,
    answers: Receiver<Vec<u8>>,
    complaints: Receiver<Vec<u8>>,
    /// Why it can no longer be asked.
    broken: Option<String>,
}

impl Process {
    /// Starts `command`, split into words as a shell would (quotes and backslashes; nothing is substituted).
    pub fn start(command: &str, limit: Duration) -> Result<Self> {
        let words = shlex::split(command).filter(|words| !words.is_empty()).ok_or_else(|| {
            Error::parameter("exec", format!("{command:?} is no command"))
                .with_hint("give a program and its arguments, with quotes in pairs")
        })?;
        let mut start = Command::new(&words[0]);
        start.args(&words[1..]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // Started first, so that the program is never without it.
        let group = Group::start()?;
        group.add(&mut start);
        let mut child = start.spawn().map_err(|e| Error::io(Path::new(&words[0]), e))?;
        let (requests, to_write) = channel::<String>();
        let (read, answers) = sync_channel(2);
        let (complain, complaints) = channel();
        if let Some(mut stdin) = child.stdin.take() {
            thread::spawn(move || {
                // A program that does not listen is found out by what it does not answer.
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
        if let Some(stderr) = child.stderr.take() {
            // Nobody may be there to hear it.
            thread::spawn(move || complain.send(tail(stderr)));
        }
        let group = Some(group);
        Ok(Self { command: command.to_owned(), child, group, limit, requests, answers, complaints, broken: None })
    }

    fn exchange(&mut self, request: String, most: usize) -> std::result::Result<String, String> {
        let deadline = Instant::now() + self.limit;
        // If the thread is gone, so is the program, and there will be no answer.
        let _ = self.requests.send(request);
        let mut answer = Answer::new(most);
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.answers.recv_timeout(left.min(ATTENTION)) {
                Ok(block) => {
                    if let Some(text) = answer.add(&block)? {
                        return Ok(text);
                    }
                }
                Err(RecvTimeoutError::Timeout) if interrupt::requested() => {
                    return Err("it was interrupted".to_owned());
                }
                Err(RecvTimeoutError::Timeout) if left > ATTENTION => {}
                Err(RecvTimeoutError::Timeout) => {
                    let (progress, limit) = (answer.progress(), self.limit.as_secs_f64());
                    return Err(format!("it had answered {progress}, but not \"{END}\" within {limit} s"));
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

    /// Ends the program and says how it complained.
    fn end(&mut self) -> String {
        self.kill();
        // Something that left its group may hold the pipe open.
        let complaints = self.complaints.recv_timeout(GRACE).unwrap_or_default();
        last_line(&complaints).map_or_else(String::new, |line| format!("; its standard error ends with {line}"))
    }

    /// Ends the program, and what it started and left in its group, at once.
    fn kill(&mut self) {
        self.group = None;
        // It may have left the group; both fail only if it has ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Peer for Process {
    fn name(&self) -> &str {
        &self.command
    }

    fn ask(&mut self, request: String, most: usize) -> Result<String> {
        if let Some(why) = &self.broken {
            return Err(fault(&self.command, why.clone()));
        }
        let asked = request.lines().next().unwrap_or_default().to_owned();
        self.exchange(request, most).map_err(|what| {
            let why = format!("asked {asked:?}, {what}{}", self.end());
            self.broken = Some(why.clone());
            if interrupt::requested() { Error::Interrupted } else { fault(&self.command, why) }
        })
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.broken.is_some() {
            return;
        }
        // The thread that writes drops the pipe once the sender is gone.
        let _ = std::mem::replace(&mut self.requests, channel().0).send("quit\n".to_owned());
        self.ended(GRACE);
        self.kill();
    }
}

/// Passes blocks on until the pipe ends or nobody wants them.
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
fn last_line(bytes: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(bytes);
    let line = text.lines().map(str::trim).rfind(|line| !line.is_empty())?;
    let start = line.ceil_char_boundary(line.len().saturating_sub(LONGEST_LINE));
    Some(format!("{}{:?}", if start > 0 { "…" } else { "" }, &line[start..]))
}

/// Reads to the end and keeps the last bytes.
fn tail(mut from: impl Read) -> Vec<u8> {
    let (mut block, mut kept) = (vec![0; 1 << 12], Vec::new());
    while let Ok(length @ 1..) = from.read(&mut block) {
        kept.extend_from_slice(&block[..length]);
        let excess = kept.len().saturating_sub(COMPLAINTS);
        kept.drain(..excess);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
