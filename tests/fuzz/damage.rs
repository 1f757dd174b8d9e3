//! Damage to sound files: bytes that bolero chooses, read as a program of changes to a seed.

use std::ops::Range;

/// Longest input; seeds are shorter.
const LONGEST: usize = 1 << 15;

/// What stands in for a number in a text.
const NUMBERS: &str = "0 -0 1 -1 0.5 255 65536 2147483647 2147483648 4294967296 9223372036854775808 18446744073709551616 \
                       -6148914691236517207 1e38 1e308 1e-320 nan inf -inf";

/// What stands in for a number in a binary file, cut to its size.
const WORDS: [u64; 8] = [0, 1, 0x7f, 0x80, 0x7fff_ffff, 0x8000_0000, 0x7fc0_0000, u64::MAX];

/// The kinds of bytes that belong together: numbers, names, words, lines.
const KINDS: [fn(&u8) -> bool; 4] = [
    |byte| byte.is_ascii_digit() || b".+-".contains(byte),
    |byte| byte.is_ascii_alphanumeric() || *byte == b'_',
    |byte| !byte.is_ascii_whitespace() && *byte != b',',
    |byte| *byte != b'\n',
];

/// The file that `program` makes of one of the `seeds`, of which there is at least one.
pub fn damaged(seeds: &[Vec<u8>], program: &[u8]) -> Vec<u8> {
    let mut program = Program(program);
    let mut bytes = program.pick(seeds).clone();
    while let Some((&change, rest)) = program.0.split_first() {
        program.0 = rest;
        change_once(change, &mut bytes, seeds, &mut program);
        bytes.truncate(LONGEST);
    }
    bytes
}

fn change_once(change: u8, bytes: &mut Vec<u8>, seeds: &[Vec<u8>], program: &mut Program) {
    let at = program.place(bytes);
    let other = program.pick(seeds);
    match change % 11 {
        0 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << (program.byte() % 8)),
        1 => replace(bytes, at, 1, &[program.byte()]),
        2 => replace(bytes, at, usize::from(program.byte() % 5), &[(); 4].map(|()| program.byte())),
        3 => replace(bytes, at, usize::from(program.byte() % 64), &[]),
        // An extreme value of 1, 2, 4 or 8 bytes, in either order.
        4 => {
            let mut word = program.pick(&WORDS).to_le_bytes()[..1 << (program.byte() % 4)].to_vec();
            if program.byte().is_multiple_of(2) {
                word.reverse();
            }
            replace(bytes, at, word.len(), &word);
        }
        // A piece of a seed, put in or written over what was there.
        5 => {
            let piece: Vec<u8> = other[program.place(other)..].iter().copied().take(program.byte().into()).collect();
            replace(bytes, at, piece.len() * usize::from(program.byte() % 2), &piece);
        }
        // The beginning of this and the end of a seed.
        6 => {
            bytes.truncate(at);
            bytes.extend(&other[program.place(other)..]);
        }
        7 => bytes.truncate(at),
        8 => {
            let numbers: Vec<&str> = NUMBERS.split(' ').collect();
            run(bytes, KINDS[0], at)
                .into_iter()
                .for_each(|run| replace(bytes, run.start, run.len(), program.pick(&numbers).as_bytes()));
        }
        // One name, word or line for another.
        9 => {
            let kind = *program.pick(&KINDS);
            if let (Some(here), Some(there)) = (run(bytes, kind, at), run(other, kind, program.place(other))) {
                replace(bytes, here.start, here.len(), &other[there]);
            }
        }
        // One that is missing, or there twice, with the byte that ends it.
        _ => {
            if let Some(Range { start, end }) = run(bytes, *program.pick(&KINDS), at) {
                let whole = bytes[start..(end + 1).min(bytes.len())].to_vec();
                let twice = [&whole[..], &whole].concat();
                replace(bytes, start, whole.len(), if program.byte().is_multiple_of(2) { &[] } else { &twice });
            }
        }
    }
}

/// Puts `new` where the next `over` bytes are.
fn replace(bytes: &mut Vec<u8>, at: usize, over: usize, new: &[u8]) {
    bytes.splice(at..(at + over).min(bytes.len()), new.iter().copied());
}

/// The first longest run of bytes of a kind that ends behind a place.
fn run(bytes: &[u8], kind: fn(&u8) -> bool, at: usize) -> Option<Range<usize>> {
    let found = at + bytes[at..].iter().position(kind)?;
    let start = bytes[..found].iter().rposition(|byte| !kind(byte)).map_or(0, |last| last + 1);
    let length = bytes[found..].iter().position(|byte| !kind(byte));
    Some(start..length.map_or(bytes.len(), |length| found + length))
}

/// What is left to be read; zeros behind the end.
struct Program<'a>(&'a [u8]);

impl Program<'_> {
    fn byte(&mut self) -> u8 {
        let Some((&byte, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        byte
    }

    /// One of `from`, which has at most 256 and is not empty.
    fn pick<'b, T>(&mut self, from: &'b [T]) -> &'b T {
        &from[usize::from(self.byte()) % from.len()]
    }

    /// A place in `bytes`, or their end.
    fn place(&mut self, bytes: &[u8]) -> usize {
        (usize::from(self.byte()) << 8 | usize::from(self.byte())) % (bytes.len() + 1)
    }
}
