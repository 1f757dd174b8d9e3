//! The header of a PLY file: which elements follow, how many of each, and of what numbers they are made.

use crate::error::{Error, Result};
use crate::import::place::{At, quote};
use std::path::Path;

/// Most lines of a header.
const MAX_LINES: usize = 10_000;

/// How numbers are written after the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number: its size in a binary file in bytes, and the number from its bytes, the lowest first.
#[derive(Debug, Clone, Copy)]
pub struct Scalar {
    pub size: usize,
    pub number: fn([u8; 8]) -> f64,
}

impl Scalar {
    const fn new(size: usize, number: fn([u8; 8]) -> f64) -> Self {
        Self { size, number }
    }

    fn named(name: &str) -> Option<Self> {
        SCALARS.into_iter().find(|(names, _)| names.contains(&name)).map(|(_, scalar)| scalar)
    }
}

/// The types by their names.
const SCALARS: [([&str; 2], Scalar); 8] = [
    (["char", "int8"], Scalar::new(1, |b| f64::from(b[0] as i8))),
    (["uchar", "uint8"], Scalar::new(1, |b| f64::from(b[0]))),
    (["short", "int16"], Scalar::new(2, |b| f64::from(i16::from_le_bytes([b[0], b[1]])))),
    (["ushort", "uint16"], Scalar::new(2, |b| f64::from(u16::from_le_bytes([b[0], b[1]])))),
    (["int", "int32"], Scalar::new(4, |b| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]])))),
    (["uint", "uint32"], Scalar::new(4, |b| f64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])))),
    (["float", "float32"], Scalar::new(4, |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))),
    (["double", "float64"], Scalar::new(8, f64::from_le_bytes)),
];

/// One number of an element, or a list of them.
pub struct Property {
    /// For example `x`.
    pub name: String,
    /// Type of the value, or of the items of a list.
    pub scalar: Scalar,
    /// For a list, the type of its length, which comes first.
    pub length: Option<Scalar>,
}

/// A table in the file: rows that all have the same properties.
pub struct Element {
    /// For example `vertex`.
    pub name: String,
    /// How many there are.
    pub count: usize,
    /// In the order of the file.
    pub properties: Vec<Property>,
}

pub struct Header {
    pub encoding: Encoding,
    /// In the order of the file.
    pub elements: Vec<Element>,
    /// Where the numbers start.
    pub body: usize,
}

impl Element {
    /// Fewest bytes that a row takes. In text each number has a digit and, except for the last one in the file, a space.
    pub fn least_bytes(&self, encoding: Encoding) -> usize {
        let size = |p: &Property| if encoding == Encoding::Ascii { 2 } else { p.length.unwrap_or(p.scalar).size };
        self.properties.iter().map(size).sum()
    }
}

impl Header {
    /// Parses the header at the start of `bytes`.
    ///
    /// # Errors
    /// [`Error::Input`] for a malformed header, with its line.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self> {
        if !bytes.starts_with(b"ply\n") && !bytes.starts_with(b"ply\r") {
            return Err(Error::input(path, "the first line is not \"ply\": this is no PLY file"));
        }
        let mut header = Self { encoding: Encoding::Ascii, elements: Vec::new(), body: 0 };
        let mut has_format = false;
        for number in 1.. {
            let at = At::new(path.into(), number, 1);
            if number > MAX_LINES {
                return Err(at.input(format!("a header of more than {MAX_LINES} lines")));
            }
            let line = header.line(bytes).ok_or_else(|| at.input("the file ends before its header's end_header"))?;
            let line = String::from_utf8_lossy(line);
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words.as_slice() {
                ["end_header"] => break,
                [] | ["ply" | "comment" | "obj_info", ..] => {}
                ["format", encoding, "1.0"] => {
                    has_format = true;
                    header.encoding = match *encoding {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::LittleEndian,
                        "binary_big_endian" => Encoding::BigEndian,
                        other => return Err(at.unsupported(format!("the format {} is not supported", quote(other)))),
                    };
                }
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| at.input(format!("{} is no count", quote(count))))?;
                    if header.elements.iter().any(|element| element.name == *name) {
                        return Err(at.input(format!("a second element {}", quote(name))));
                    }
                    header.elements.push(Element { name: (*name).into(), count, properties: Vec::new() });
                }
                ["property", types @ .., name] => {
                    let named = |name: &str| {
                        Scalar::named(name).ok_or_else(|| at.input(format!("{} is no type of number", quote(name))))
                    };
                    let (length, scalar) = match types {
                        ["list", length, scalar] => (Some(named(length)?), named(scalar)?),
                        [scalar] => (None, named(scalar)?),
                        _ => return Err(at.input("a property is a type and a name, or a list, two types and a name")),
                    };
                    let element = header.elements.last_mut();
                    let element = element.ok_or_else(|| at.input("a property before the first element"))?;
                    element.properties.push(Property { name: (*name).into(), scalar, length });
                }
                _ => return Err(at.input(format!("{} is no line of a PLY header", quote(&line)))),
            }
        }
        if !has_format {
            return Err(Error::input(path, "the header has no format line"));
        }
        header.check_counts(path, bytes.len() - header.body)?;
        Ok(header)
    }

    /// Takes the next line, which ends in LF, CR LF or CR.
    fn line<'a>(&mut self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let rest = &bytes[self.body..];
        let end = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r')?;
        self.body += end + if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
        Some(&rest[..end])
    }

    /// Refuses counts larger than the file can hold, before memory is reserved for them.
    fn check_counts(&self, path: &Path, size: usize) -> Result<()> {
        let need = |element: &Element| element.count.checked_mul(element.least_bytes(self.encoding));
        let total = self.elements.iter().try_fold(0usize, |sum, element| sum.checked_add(need(element)?));
        // The last number of a text may have nothing after it.
        if total.is_some_and(|total| total <= size + 1) {
            return Ok(());
        }
        let claims: Vec<String> = self.elements.iter().map(|e| format!("{} {}", e.count, quote(&e.name))).collect();
        let message = format!("the header claims {}, but only {size} bytes follow", claims.join(", "));
        Err(Error::input(path, message).with_hint("the file is cut off or damaged: get it whole again"))
    }
}
