//! The transport of the protocol: a request, a response. A response arrives as bytes in blocks of any size, and is split into
//! lines, the last of which is `end`.

use etalon_core::error::{Error, Result};
use etalon_core::import::place::quote;
use std::path::Path;

/// The external program: a process, or recorded responses.
pub trait Connection: Send {
    /// The program's name in messages.
    fn name(&self) -> &str;

    /// Sends `request`, whose first line is the command, and returns the lines of the response, at most `most`.
    ///
    /// # Errors
    /// [`Error::Input`] with the program's name, where the [`Answer`](super::Answer) is late or malformed.
    fn ask(&mut self, request: String, most: usize) -> Result<String>;
}

/// Asks `verb` for `count` lines and reads the words of each by `read`; `expected` says in a message what a line should be.
pub fn ask<T>(
    connection: &mut dyn Connection,
    [verb, expected]: [&str; 2],
    count: usize,
    request: String,
    read: impl Fn(&[&str]) -> Option<T>,
) -> Result<Vec<T>> {
    let answer = connection.ask(request.clone(), count)?;
    let wrong = |message| protocol_error(connection.name(), format!("asked \"{verb} {count}\", {message}"));
    let mut values = Vec::with_capacity(count);
    for (i, line) in answer.lines().enumerate() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        values.push(read(&words).ok_or_else(|| {
            let asked = request.lines().nth(i + 1).map_or_else(String::new, |asked| format!(" (for {})", quote(asked)));
            let (number, line) = (i + 1, quote(line));
            wrong(format!("line {number} of the answer is {line}{asked}, not {expected}"))
        })?);
    }
    if values.len() == count { Ok(values) } else { Err(wrong(format!("it answered only {} lines", values.len()))) }
}

pub fn protocol_error(name: &str, message: impl Into<String>) -> Error {
    Error::input(Path::new(name), message)
}

/// The last line of a response.
pub const END: &str = "end";
/// Longest line of a response, in bytes.
const LINE: usize = 1024;

/// A response that has arrived in part.
#[derive(Debug)]
pub struct Answer {
    /// Most lines before the last.
    most: usize,
    bytes: Vec<u8>,
    /// Where the line begins that has not ended yet.
    start: usize,
    lines: usize,
}

impl Answer {
    /// An empty response of at most `most` lines, and then `end`.
    pub fn new(most: usize) -> Self {
        Self { most, bytes: Vec::new(), start: 0, lines: 0 }
    }

    /// Whether nothing has arrived.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    pub fn lines(&self) -> usize {
        self.lines
    }

    /// What has arrived, for a message: how many lines, and the last one.
    pub fn progress(&self) -> String {
        let lines = match self.lines {
            1 => "1 line".to_owned(),
            n => format!("{n} lines"),
        };
        match self.bytes.trim_ascii().rsplit(|&byte| byte == b'\n').next() {
            Some(last @ [_, ..]) => format!("{lines}, at last {}", shown(last)),
            _ => lines,
        }
    }

    /// Takes the next block. Returns the lines without `end` once that has arrived, and begins anew; nothing may follow it in
    /// its block.
    ///
    /// # Errors
    /// The violation, as the predicate of a sentence about the program.
    pub fn add(&mut self, block: &[u8]) -> std::result::Result<Option<String>, String> {
        let mut scanned = self.bytes.len();
        self.bytes.extend_from_slice(block);
        while let Some(length) = self.bytes[scanned..].iter().position(|&byte| byte == b'\n') {
            let line = &self.bytes[self.start..scanned + length];
            if line.len() > LINE {
                return Err(self.too_long(line));
            }
            scanned += length + 1;
            let line = line.trim_ascii();
            if line == END.as_bytes() {
                let rest = &self.bytes[scanned..];
                if !rest.is_empty() {
                    return Err(format!("it went on after \"{END}\" with {}", shown(rest)));
                }
                self.bytes.truncate(self.start);
                let done = std::mem::replace(self, Self::new(self.most));
                return String::from_utf8(done.bytes)
                    .map(Some)
                    .map_err(|_| "it answered with bytes that are not UTF-8".to_owned());
            }
            if self.lines == self.most {
                let most = self.most;
                return Err(format!("it answered {} where \"{END}\" belongs, after {most} lines", shown(line)));
            }
            (self.start, self.lines) = (scanned, self.lines + 1);
        }
        let line = &self.bytes[self.start..];
        if line.len() > LINE { Err(self.too_long(line)) } else { Ok(None) }
    }

    fn too_long(&self, line: &[u8]) -> String {
        format!("line {} of the answer is longer than {LINE} bytes: {}", self.lines + 1, shown(line))
    }
}

/// The beginning of the response, quoted.
fn shown(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]);
    quote(text.lines().next().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The answer that arrives in blocks of `size` bytes.
    fn arrived(bytes: &[u8], size: usize, most: usize) -> std::result::Result<Option<String>, String> {
        let mut answer = Answer::new(most);
        bytes.chunks(size).map(|block| answer.add(block)).find(|step| !matches!(step, Ok(None))).unwrap_or(Ok(None))
    }

    #[test]
    fn blocks_may_be_cut_anywhere() {
        for size in 1..20 {
            let text = "0.5 é\r\n\n none \n".to_owned();
            assert_eq!(arrived("0.5 é\r\n\n none \n end \r\n".as_bytes(), size, 3), Ok(Some(text)), "{size}");
            assert_eq!(arrived(b"1\nend", size, 3), Ok(None));
            let refused = |bytes: &[u8], most, why: &str| {
                let found = arrived(bytes, size, most).unwrap_err();
                assert!(found.contains(why), "{size}: {found}");
            };
            refused(b"1\n2\nend\n", 1, "\"2\" where \"end\" belongs, after 1 lines");
            refused(b"\xff\nend\n", 1, "not UTF-8");
            refused(&[b'1'; LINE + 20], 1, "line 1 of the answer is longer");
        }
        let mut answer = Answer::new(1);
        let mut add = |block: &str| answer.add(block.as_bytes());
        assert_eq!(
            (add("1\nend\n"), add("2\ne"), add("nd\n")),
            (Ok(Some("1\n".into())), Ok(None), Ok(Some("2\n".into())))
        );
        assert!(arrived(b"end\n1", 5, 1).unwrap_err().contains("went on after \"end\" with \"1\""));
    }

    #[test]
    fn the_last_line_is_known() {
        let mut answer = Answer::new(9);
        let mut after = |block: &[u8]| answer.add(block).map(|_| answer.progress()).unwrap();
        assert_eq!(after(b""), "0 lines");
        assert_eq!(after(b"Loa"), "0 lines, at last \"Loa\"");
        assert_eq!(after(b"ding\r\n"), "1 line, at last \"Loading\"");
        assert_eq!(after(b"1\n\n"), "3 lines, at last \"1\"");
    }

    #[test]
    fn a_line_of_the_longest_length_is_not_too_long() {
        let line = [&[b'1'; LINE][..], b"\n"].concat();
        for size in [7, 2 * LINE] {
            let answer = [&line[..], b"end\n"].concat();
            assert_eq!(arrived(&answer, size, 1), Ok(Some(String::from_utf8(line.clone()).unwrap())));
            // Spaces count wherever blocks are cut.
            assert!(arrived(&[b" ", &answer[..]].concat(), size, 1).unwrap_err().contains("longer than 1024"));
        }
    }
}
