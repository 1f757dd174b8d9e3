//! PLY: the polygon format of Greg Turk (Stanford, 1994), as text or binary.

use super::ply_header::{Element, Encoding, Header, Scalar};
use crate::error::{Error, Place, Result};
use crate::import::place::{At, quote};
use crate::import::shape::{corner_uv, fan, point, unit_normals};
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
