//! PLY: the polygon format of Greg Turk (Stanford, 1994), as text or binary. Its header says which elements follow, how many of
//! each, and of what numbers they are made.

use super::super::place::{At, quote};
use super::super::shape::{corner_uv, fan, point, unit_normals};
use crate::error::{Error, Place, Result};
use crate::memory;
use crate::scene::Mesh;
use glam::{Vec2, Vec3};
use std::path::Path;

/// Reads the file at `path`, whose content is `bytes`.
pub fn read(path: &Path, bytes: &[u8], warnings: &mut Vec<String>) -> Result<Mesh> {
    let header = Header::read(path, bytes)?;
    let find = |name: &str| header.elements.iter().find(|element| element.name == name);
    let points = find("vertex").ok_or_else(|| Error::input(path, "the header has no vertex element"))?.count;
    if find("face").is_none() {
        return Err(Error::unsupported(path, "the file has points, but no faces"));
    }
    let mut body = Body { path, bytes, position: header.body, encoding: header.encoding };
    let (mut mesh, mut vertices) = (Mesh::default(), Vertices::default());
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices = body.vertices(element)?,
            "face" => mesh.triangles = body.faces(element, points)?,
            // There may be any number of rows with nothing in them.
            _ if element.properties.is_empty() => {}
            _ => (0..element.count).try_for_each(|_| body.row(element, |_, _| Ok(())))?,
        }
    }
    let corners = if vertices.uv.is_empty() { 0 } else { mesh.triangles.len() };
    memory::grow(vertices.normals.len() * size_of::<Vec3>() + corners * size_of::<[Vec2; 3]>(), || {
        path.display().to_string()
    })?;
    mesh.normals = unit_normals(path, &vertices.normals, warnings);
    mesh.uv = corner_uv(&mesh.triangles, |i| vertices.uv.get(i as usize).copied());
    mesh.positions = vertices.positions;
    Ok(mesh)
}

/// What is read of the vertices.
#[derive(Default)]
struct Vertices {
    positions: Vec<Vec3>,
    /// Normals of any length; empty without.
    normals: Vec<[f64; 3]>,
    /// Empty without.
    uv: Vec<Vec2>,
}

/// The numbers of a vertex that are read, by the names that they go by.
const NAMES: [&[&str]; 8] =
    [&["x"], &["y"], &["z"], &["nx"], &["ny"], &["nz"], &["u", "s", "texture_u"], &["v", "t", "texture_v"]];

/// The numbers after the header, read from the front.
struct Body<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    position: usize,
    encoding: Encoding,
}

impl Body<'_> {
    fn vertices(&mut self, element: &Element) -> Result<Vertices> {
        let has = |names: &[&str]| element.properties.iter().any(|p| names.contains(&&*p.name) && p.length.is_none());
        if let Some(missing) = NAMES[..3].iter().find(|names| !has(names)) {
            return Err(Error::input(self.path, format!("the vertices have no {}", missing[0])));
        }
        let [with_normals, with_uv] = [&NAMES[3..6], &NAMES[6..]].map(|slots| slots.iter().all(|names| has(names)));
        let slots: Vec<Option<usize>> =
            element.properties.iter().map(|p| NAMES.iter().position(|names| names.contains(&&*p.name))).collect();
        let path = self.path;
        let what = || path.display().to_string();
        let mut vertices = Vertices::default();
        for _ in 0..element.count {
            let (start, mut row) = (self.position, [0.0; 8]);
            self.row(element, |property, value| {
                if let Some(slot) = slots[property] {
                    row[slot] = value;
                }
                Ok(())
            })?;
            let [x, y, z, nx, ny, nz, u, v] = row;
            let position = point([x, y, z])
                .ok_or_else(|| self.error(start, format!("a vertex at {x} {y} {z} is not finite or out of range")))?;
            memory::push(&mut vertices.positions, position, what)?;
            if with_normals {
                memory::push(&mut vertices.normals, [nx, ny, nz], what)?;
            }
            if with_uv {
                memory::push(&mut vertices.uv, Vec2::new(u as f32, v as f32), what)?;
            }
        }
        Ok(vertices)
    }

    /// The faces, cut into triangles; their corners are below `points`.
    fn faces(&mut self, element: &Element, points: usize) -> Result<Vec<[u32; 3]>> {
        let is_corners = |name: &str| name == "vertex_indices" || name == "vertex_index";
        let corners = element.properties.iter().position(|p| is_corners(&p.name) && p.length.is_some());
        let corners = corners.ok_or_else(|| Error::input(self.path, "the faces have no list vertex_indices"))?;
        let path = self.path;
        let what = || path.display().to_string();
        let (mut triangles, mut face) = (Vec::new(), Vec::new());
        for _ in 0..element.count {
            let (start, mut bad) = (self.position, None);
            face.clear();
            self.row(element, |property, value| {
                if property == corners {
                    if !(value.fract() == 0.0 && (0.0..points as f64).contains(&value)) {
                        bad = Some(value);
                    }
                    memory::push(&mut face, value as u32, what)?;
                }
                Ok(())
            })?;
            if let Some(bad) = bad {
                return Err(self.error(start, format!("vertex {bad} of {points}, counted from 0, does not exist")));
            }
            if face.len() < 3 {
                return Err(self.error(start, format!("a face of {} corners", face.len())));
            }
            fan(&face).try_for_each(|triangle| memory::push(&mut triangles, triangle, what))?;
        }
        Ok(triangles)
    }

    /// Reads a row and gives each of its values with the number of its property.
    fn row(&mut self, element: &Element, mut take: impl FnMut(usize, f64) -> Result<()>) -> Result<()> {
        for (number, property) in element.properties.iter().enumerate() {
            let Some(length) = property.length else {
                take(number, self.value(property.scalar)?)?;
                continue;
            };
            let start = self.position;
            let length = self.value(length)?;
            // One too long runs into the file's end.
            if !(length >= 0.0 && length.fract() == 0.0) {
                return Err(self.error(start, format!("a list of {length} numbers")));
            }
            for _ in 0..length as u64 {
                take(number, self.value(property.scalar)?)?;
            }
        }
        Ok(())
    }

    fn value(&mut self, scalar: Scalar) -> Result<f64> {
        match self.encoding {
            Encoding::Ascii => self.word(),
            Encoding::LittleEndian => self.binary(scalar, false),
            Encoding::BigEndian => self.binary(scalar, true),
        }
    }

    fn word(&mut self) -> Result<f64> {
        let rest = &self.bytes[self.position..];
        let skipped = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let word = &rest[skipped..];
        let word = &word[..word.iter().take_while(|byte| !byte.is_ascii_whitespace()).count()];
        let start = self.position + skipped;
        self.position = start + word.len();
        let text = std::str::from_utf8(word).ok().filter(|text| !text.is_empty());
        text.and_then(|text| text.parse().ok()).ok_or_else(|| match word {
            [] => self.cut_off(),
            _ => self.error(start, format!("{} is not a number", quote(&String::from_utf8_lossy(word)))),
        })
    }

    fn binary(&mut self, scalar: Scalar, big: bool) -> Result<f64> {
        let bytes = self.bytes.get(self.position..self.position + scalar.size).ok_or_else(|| self.cut_off())?;
        self.position += scalar.size;
        let mut number = [0; 8];
        number[..scalar.size].copy_from_slice(bytes);
        if big {
            number[..scalar.size].reverse();
        }
        Ok((scalar.number)(number))
    }

    fn cut_off(&self) -> Error {
        let message = "the file ends before all that its header claims";
        self.error(self.bytes.len(), message.into()).with_hint("it is cut off or damaged: get it whole again")
    }

    /// The error at an offset: of a text its line and column.
    fn error(&self, offset: usize, message: String) -> Error {
        if self.encoding != Encoding::Ascii {
            return Error::input(self.path, message).at(Place::Byte(offset as u64));
        }
        let spaces = self.bytes[offset..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let (before, after) = self.bytes.split_at(offset + spaces);
        // Lines end in LF, CR LF or CR.
        let next = |i: usize| before.get(i + 1).or(after.first());
        let ends = |&(i, byte): &(usize, &u8)| *byte == b'\n' || *byte == b'\r' && next(i) != Some(&b'\n');
        let lines = before.iter().enumerate().filter(ends).count();
        let start = before.iter().rposition(|&byte| byte == b'\n' || byte == b'\r').map_or(0, |end| end + 1);
        let column = String::from_utf8_lossy(&before[start..]).chars().count() + 1;
        At::new(self.path.into(), lines + 1, column).input(message)
    }
}

/// Most lines of a header.
const MAX_LINES: usize = 10_000;

/// How numbers are written after the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number: its size in a binary file in bytes, and the number from its bytes, the lowest first.
#[derive(Debug, Clone, Copy)]
struct Scalar {
    size: usize,
    number: fn([u8; 8]) -> f64,
}

impl Scalar {
    const fn new(size: usize, number: fn([u8; 8]) -> f64) -> Self {
        Self { size, number }
    }

    fn named(name: &str) -> Option<Self> {
        SCALARS.into_iter().find(|(names, _)| names.contains(&name)).map(|(_, scalar)| scalar)
    }
}

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
struct Property {
    /// For example `x`.
    name: String,
    /// Type of the value, or of the items of a list.
    scalar: Scalar,
    /// For a list, the type of its length, which comes first.
    length: Option<Scalar>,
}

/// A table in the file: rows that all have the same properties.
struct Element {
    /// For example `vertex`.
    name: String,
    count: usize,
    /// In the order of the file.
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    /// In the order of the file.
    elements: Vec<Element>,
    /// Where the numbers start.
    body: usize,
}

impl Element {
    /// Fewest bytes that a row takes. In text each number has a digit and, except for the last one in the file, a space.
    fn least_bytes(&self, encoding: Encoding) -> usize {
        let size = |p: &Property| if encoding == Encoding::Ascii { 2 } else { p.length.unwrap_or(p.scalar).size };
        self.properties.iter().map(size).sum()
    }
}

impl Header {
    /// Parses the header at the start of `bytes`.
    ///
    /// # Errors
    /// [`Error::Input`] for a malformed header, with its line.
    fn read(path: &Path, bytes: &[u8]) -> Result<Self> {
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
