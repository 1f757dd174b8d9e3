//! Damage: the same number always makes the same input from the same seeds.

use etalon::sampling::stream::{Independent, Stream};
use std::ops::Range;

/// Longest input; seeds are shorter.
const LONGEST: usize = 1 << 15;
/// Most changes to one input.
const MOST_CHANGES: usize = 6;

/// What stands in for a number in a text.
const NUMBERS: [&str; 20] = [
    "",
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "255",
    "65536",
    "2147483647",
    "2147483648",
    "4294967296",
    "9223372036854775808",
    "18446744073709551616",
    "340282366920938463463374607431768211456",
    "1e38",
    "1e308",
    "1e-320",
    "nan",
    "inf",
    "-inf",
];

/// What stands in for a number in a binary file, cut to its size.
const WORDS: [u64; 10] =
    [0, 1, 2, 0x7f, 0x80, 0x7fff_ffff, 0x8000_0000, 0x7fc0_0000, 0x7fff_ffff_ffff_ffff, 0xffff_ffff_ffff_ffff];

/// The input that these random numbers make: one of the `seeds`, changed in one to [`MOST_CHANGES`] places.
pub fn input(seeds: &[Vec<u8>], stream: Independent) -> Vec<u8> {
    let mut random = Random { stream, used: 0 };
    let mut bytes = random.pick(seeds).clone();
    for _ in 0..=random.below(MOST_CHANGES) {
        let other = random.pick(seeds);
        change(&mut bytes, other, &mut random);
    }
    bytes.truncate(LONGEST);
    bytes
}

/// Changes one place; `other` gives what is put in.
fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    match random.below(13) {
        0 => {
            if let Some(byte) = random.place(bytes) {
                *byte ^= 1 << random.below(8);
            }
        }
        1 => {
            let value = random.byte();
            if let Some(byte) = random.place(bytes) {
                *byte = value;
            }
        }
        2 => {
            let new: Vec<u8> = (0..=random.below(8)).map(|_| random.byte()).collect();
            replace(bytes, random.range(bytes.len(), 1), &new);
        }
        3 => replace(bytes, random.range(bytes.len(), 64), &[]),
        // A piece of this or another file, put in or written over what was there.
        4 | 5 => {
            let piece = other[random.range(other.len(), 64)].to_vec();
            let at = random.below(bytes.len() + 1);
            let over = if random.below(2) == 0 { 0 } else { piece.len() };
            replace(bytes, at..at + over, &piece);
        }
        // The beginning of this and the end of another.
        6 => {
            bytes.truncate(random.below(bytes.len() + 1));
            bytes.extend(&other[random.below(other.len() + 1)..]);
        }
        7 => bytes.truncate(random.below(bytes.len() + 1)),
        8 => {
            let is_digit = |byte: u8| byte.is_ascii_digit() || b".+-".contains(&byte);
            if let Some(number) = run(bytes, is_digit, random) {
                replace(bytes, number, random.pick(&NUMBERS).as_bytes());
            }
        }
        9 => binary_number(bytes, random),
        // A line, removed or put elsewhere once more.
        10 => {
            if let Some(line) = run(bytes, |byte| byte != b'\n', random) {
                let text = [&bytes[line.clone()], b"\n"].concat();
                if random.below(2) == 0 {
                    replace(bytes, line.start..line.end + 1, &[]);
                } else {
                    let at = random.below(bytes.len() + 1);
                    let start = bytes[..at].iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
                    replace(bytes, start..start, &text);
                }
            }
        }
        // A word and what separates it from the next, once more: a key or a column too many.
        11 => {
            if let Some(word) = run(bytes, |byte| !byte.is_ascii_whitespace() && byte != b',', random) {
                let text = bytes[word.start..(word.end + 1).min(bytes.len())].to_vec();
                replace(bytes, word.start..word.start, &text);
            }
        }
        // One name for another.
        _ => {
            let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
            if let (Some(here), Some(there)) = (run(bytes, is_letter, random), run(other, is_letter, random)) {
                replace(bytes, here, &other[there]);
            }
        }
    }
}

/// Writes an extreme value of 1, 2, 4 or 8 bytes, in either order.
fn binary_number(bytes: &mut Vec<u8>, random: &mut Random) {
    let size = 1 << random.below(4);
    let mut word = random.pick(&WORDS).to_le_bytes()[..size].to_vec();
    if random.below(2) == 0 {
        word.reverse();
    }
    let at = random.below(bytes.len() + 1);
    replace(bytes, at..at + size, &word);
}

/// Puts `new` where `old` was; what of `old` is beyond the end does not matter.
fn replace(bytes: &mut Vec<u8>, old: Range<usize>, new: &[u8]) {
    let end = old.end.min(bytes.len());
    bytes.splice(old.start.min(end)..end, new.iter().copied());
}

/// A longest run of bytes of a kind, if there is one behind a place chosen at random.
fn run(bytes: &[u8], kind: impl Fn(u8) -> bool, random: &mut Random) -> Option<Range<usize>> {
    let from = random.below(bytes.len() + 1);
    let found = from + bytes[from..].iter().position(|&byte| kind(byte))?;
    let start = bytes[..found].iter().rposition(|&byte| !kind(byte)).map_or(0, |last| last + 1);
    let end = bytes[found..].iter().position(|&byte| !kind(byte)).map_or(bytes.len(), |length| found + length);
    Some(start..end)
}

/// Random choices for one input.
struct Random {
    stream: Independent,
    used: u32,
}

impl Random {
    /// A number below `count`; 0 if there is none.
    fn below(&mut self, count: usize) -> usize {
        self.used += 1;
        (self.stream.pair(self.used)[0] * count as f64) as usize
    }

    fn byte(&mut self) -> u8 {
        self.below(256) as u8
    }

    fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.below(from.len())]
    }

    fn place<'a>(&mut self, bytes: &'a mut [u8]) -> Option<&'a mut u8> {
        let at = self.below(bytes.len());
        bytes.get_mut(at)
    }

    /// A range of at most `longest` of `count` places.
    fn range(&mut self, count: usize, longest: usize) -> Range<usize> {
        let start = self.below(count + 1);
        start..(start + self.below(longest + 1)).min(count)
    }
}
