//! Splits a pbrt file into words, quoted strings, numbers and brackets, each with its position.
//!
//! White space separates; `#` starts a comment that runs to the end of its line. Lines end in LF, CR LF or CR. Columns
//! count characters of UTF-8. Strings end on the line where they start and know the escapes `\n \t \r \b \f \\ \" \'`.

use crate::error::Result;
use crate::files::without_bom;
use crate::import::place::{At, quote};
use crate::memory;
use std::path::Path;
use std::rc::Rc;

#[derive(Debug, Clone, PartialEq)]
pub enum Token<'a> {
    /// A directive, `true` or `false`.
    Word(&'a str),
    /// A quoted string, its escapes resolved.
    Text(String),
    Number(f64),
    Open,
    Close,
}

impl Token<'_> {
    pub fn describe(&self) -> String {
        match self {
            Token::Word(word) => quote(word),
            Token::Text(text) => format!("the string {}", quote(text)),
            Token::Number(number) => format!("the number {number}"),
            Token::Open => "\"[\"".into(),
            Token::Close => "\"]\"".into(),
        }
    }
}

/// About what a token leaves in memory, in bytes.
const TOKEN_BYTES: usize = 128;

/// Reads tokens one by one, with one token of look-ahead.
pub struct Lexer<'a> {
    bytes: &'a [u8],
    position: usize,
    line: usize,
    column: usize,
    path: Rc<Path>,
    ahead: Option<(Token<'a>, At)>,
}

impl<'a> Lexer<'a> {
    pub fn new(bytes: &'a [u8], path: Rc<Path>) -> Self {
        Self { bytes: without_bom(bytes), position: 0, line: 1, column: 1, path, ahead: None }
    }

    /// The next token and its place; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<(Token<'a>, At)>> {
        match self.ahead.take() {
            Some(token) => Ok(Some(token)),
            None => self.scan(),
        }
    }

    /// The next token without taking it.
    pub fn peek(&mut self) -> Result<Option<&Token<'a>>> {
        if self.ahead.is_none() {
            self.ahead = self.scan()?;
        }
        Ok(self.ahead.as_ref().map(|(token, _)| token))
    }

    /// The next token, which `owner` (at `at`) needs: `expected` says what it should be.
    pub fn require(&mut self, owner: &str, at: &At, expected: &str) -> Result<(Token<'a>, At)> {
        self.next()?.ok_or_else(|| at.input(format!("the file ends where {owner} needs {expected}")))
    }

    /// The quoted string that `owner` needs.
    pub fn text(&mut self, owner: &str, at: &At, expected: &str) -> Result<String> {
        match self.require(owner, at, expected)? {
            (Token::Text(text), _) => Ok(text),
            (token, at) => {
                Err(at.input(format!("{owner} needs {expected} in double quotes, not {}", token.describe())))
            }
        }
    }

    /// The `N` numbers that `owner` needs, with or without brackets around them.
    pub fn numbers<const N: usize>(&mut self, owner: &str, at: &At) -> Result<[f64; N]> {
        let expected = format!("{N} numbers");
        let bracket = matches!(self.peek()?, Some(Token::Open));
        if bracket {
            self.next()?;
        }
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = match self.require(owner, at, &expected)? {
                (Token::Number(value), _) => value,
                (token, at) => return Err(at.input(format!("{owner} needs {expected}, not {}", token.describe()))),
            };
        }
        if bracket {
            let (token, at) = self.require(owner, at, "a closing bracket")?;
            if token != Token::Close {
                return Err(at.input(format!("{owner} needs {expected} and then \"]\", not {}", token.describe())));
            }
        }
        Ok(numbers)
    }

    fn at(&self) -> At {
        At::new(self.path.clone(), self.line, self.column)
    }

    fn bump(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.position)?;
        self.position += 1;
        let line_end = byte == b'\n' || byte == b'\r' && self.bytes.get(self.position) != Some(&b'\n');
        if line_end {
            self.line += 1;
            self.column = 1;
        } else if byte & 0xc0 != 0x80 {
            // The first byte of a character; those that continue it do not count.
            self.column += 1;
        }
        Some(byte)
    }

    fn scan(&mut self) -> Result<Option<(Token<'a>, At)>> {
        while let Some(&byte) = self.bytes.get(self.position) {
            if byte == b'#' {
                while !matches!(self.bytes.get(self.position), None | Some(b'\n' | b'\r')) {
                    self.bump();
                }
            } else if is_space(byte) {
                self.bump();
            } else {
                let at = self.at();
                memory::grow(TOKEN_BYTES, || at.to_string())?;
                let token = match byte {
                    b'"' => Token::Text(self.string(&at)?),
                    b'[' => Token::Open,
                    b']' => Token::Close,
                    _ => self.word(&at)?,
                };
                if matches!(token, Token::Open | Token::Close) {
                    self.bump();
                }
                return Ok(Some((token, at)));
            }
        }
        Ok(None)
    }

    fn string(&mut self, start: &At) -> Result<String> {
        let mut text = Vec::new();
        self.bump();
        loop {
            let at = self.at();
            match self.bump() {
                Some(b'"') => break,
                Some(b'\\') => match self.bump().map(|c| (c, unescape(c))) {
                    Some((_, Some(c))) => memory::push(&mut text, c, || start.to_string())?,
                    Some((b'\n' | b'\r', None)) | None => return Err(unclosed(start)),
                    Some((_, None)) => {
                        return Err(at
                            .input("a backslash that starts no known escape")
                            .with_hint("write / in file names, or \\\\ for a backslash"));
                    }
                },
                Some(b'\n' | b'\r') | None => return Err(unclosed(start)),
                Some(byte) => memory::push(&mut text, byte, || start.to_string())?,
            }
        }
        String::from_utf8(text).map_err(|_| start.input("this string is not UTF-8"))
    }

    fn word(&mut self, at: &At) -> Result<Token<'a>> {
        let start = self.position;
        let ends = |byte: &u8| is_space(*byte) || matches!(byte, b'"' | b'[' | b']' | b'#');
        while self.bytes.get(self.position).is_some_and(|byte| !ends(byte)) {
            self.bump();
        }
        let bytes = &self.bytes[start..self.position];
        let ascii = std::str::from_utf8(bytes).ok().filter(|text| text.is_ascii());
        let token = match ascii {
            Some(text) if text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) => {
                // "inf" and "nan", which `parse` would take, are no numbers of the format.
                let digits = text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
                text.parse().ok().filter(|value: &f64| digits && value.is_finite()).map(Token::Number)
            }
            Some(text) if text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') => Some(Token::Word(text)),
            _ => None,
        };
        token.ok_or_else(|| {
            let text = String::from_utf8_lossy(&bytes[..bytes.len().min(240)]);
            at.input(format!("{} is neither a word nor a finite number", quote(&text)))
        })
    }
}

fn unclosed(start: &At) -> crate::error::Error {
    start.input("this string has no closing quote on its line")
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

fn unescape(byte: u8) -> Option<u8> {
    Some(match byte {
        b'n' => b'\n',
        b't' => b'\t',
        b'r' => b'\r',
        b'b' => 8,
        b'f' => 12,
        b'\\' | b'"' | b'\'' => byte,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(bytes: &[u8]) -> Result<Vec<(Token<'_>, String)>> {
        let mut lexer = Lexer::new(bytes, Rc::from(Path::new("a")));
        let mut all = Vec::new();
        while let Some((token, at)) = lexer.next()? {
            all.push((token, at.warning("")));
        }
        Ok(all)
    }

    fn fails(bytes: &[u8], start: &str) {
        let message = tokens(bytes).unwrap_err().to_string();
        assert!(message.starts_with(start), "{message}");
    }

    #[test]
    fn tokens_carry_their_place() {
        let text = "\u{feff}Größe\"\u{e9}\"[\r\n 1# ]\r-.5]";
        fails(text.as_bytes(), "a:1:1: \"Größe\" is neither");
        let text = &text.replace("Größe", "Film");
        let found = tokens(text.as_bytes()).unwrap();
        let expected = [
            (Token::Word("Film"), "a:1:1: "),
            (Token::Text("é".into()), "a:1:5: "),
            (Token::Open, "a:1:8: "),
            (Token::Number(1.0), "a:2:2: "),
            (Token::Number(-0.5), "a:3:1: "),
            (Token::Close, "a:3:4: "),
        ];
        assert_eq!(found, expected.map(|(token, at)| (token, at.to_string())));
    }

    #[test]
    fn numbers_of_every_spelling() {
        for (text, value) in [("1e-3", 1e-3), ("-.5", -0.5), ("1.", 1.0), ("+2", 2.0), ("1.E+2", 100.0), ("-0", 0.0)] {
            assert_eq!(tokens(text.as_bytes()).unwrap()[0].0, Token::Number(value), "{text}");
        }
        for text in ["1e999", "-inf", "+nan", "1..2", "-", "1e", "0x10", "1,2", "--1", "1f", "."] {
            fails(text.as_bytes(), &format!("a:1:1: \"{text}\" is neither"));
        }
    }

    #[test]
    fn strings_and_their_escapes() {
        assert_eq!(tokens(br#""a\"\\\t#[""#).unwrap()[0].0, Token::Text("a\"\\\t#[".into()));
        fails(b"\n \"abc", "a:2:2: this string has no closing quote");
        fails(b"\"abc\n\"", "a:1:1: this string has no closing quote");
        fails(b"\"abc\\", "a:1:1: this string has no closing quote");
        fails(b"\"abc\\\n\"", "a:1:1: this string has no closing quote");
        fails(b"\"C:\\Users\"", "a:1:4: a backslash");
        fails(b"\"\xff\"", "a:1:1: this string is not UTF-8");
        assert!(tokens(b"# Latin-1 \xe9 in a comment").unwrap().is_empty());
    }

    #[test]
    fn long_or_binary_words_make_short_messages() {
        for bytes in [vec![0xffu8; 1 << 20], vec![b'$'; 1 << 20], vec![b'1'; 1 << 20], vec![0; 1 << 20]] {
            assert!(tokens(&bytes).unwrap_err().to_string().len() < 500);
        }
    }
}
