//! OBJ: the text format of Wavefront's Advanced Visualizer, as far as polygons go.

use crate::error::{Error, Result};
use crate::import::place::{At, finite, quote};
use crate::import::shape::{corner_uv, fan, point, unit_normals};
use crate::memory;
use crate::scene::Mesh;
use glam::{Vec2, Vec3};
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Reads the file at `path`, whose content is `bytes`. Materials and groups are not read.
pub fn read(path: &Path, bytes: &[u8], warnings: &mut Vec<String>) -> Result<Mesh> {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => {
            // Each wrong byte becomes a character of three.
            memory::request(3 * bytes.len(), || path.display().to_string())?;
            String::from_utf8_lossy(bytes)
        }
    };
    let (mut parts, mut statement) = (Parts::default(), Vec::new());
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim_end();
        for text in line.trim_end_matches('\\').split_ascii_whitespace() {
            let word = Word { text, line, number: number + 1, path };
            memory::push(&mut statement, word, || word.at(1).to_string())?;
        }
        // A backslash continues a statement on the next line.
        if !line.ends_with('\\') {
            parts.statement(&statement)?;
            statement.clear();
        }
    }
    parts.statement(&statement)?;
    if parts.triangles.is_empty() {
        return Err(Error::unsupported(path, "the file has no faces"));
    }
    for (word, number) in &parts.left_out {
        warnings.push(At::new(path.into(), *number, 1).warning(&format!("{} is left out", quote(word))));
    }
    parts.mesh(path, warnings)
}

/// A word of the file, and its position.
#[derive(Clone, Copy)]
struct Word<'a> {
    text: &'a str,
    line: &'a str,
    number: usize,
    path: &'a Path,
}

impl Word<'_> {
    fn error(&self, message: String) -> Error {
        let column = self.line[..self.text.as_ptr() as usize - self.line.as_ptr() as usize].chars().count() + 1;
        self.at(column).input(message)
    }

    fn at(&self, column: usize) -> At {
        At::new(self.path.into(), self.number, column)
    }

    fn number(&self) -> Result<f64> {
        finite(self.text).map_err(|wrong| self.error(wrong))
    }

    /// A place in a list of `count`: counted from 1, or back from the end.
    fn index(&self, text: &str, count: usize, what: &str) -> Result<u32> {
        let index = match text.parse::<i64>() {
            Ok(index) if index > 0 => index - 1,
            Ok(index) if index < 0 => count as i64 + index,
            _ => {
                return Err(
                    self.error(format!("{} is not a {what}: it is counted from 1 or back from -1", quote(text)))
                );
            }
        };
        let known = u32::try_from(index).ok().filter(|&index| (index as usize) < count);
        known.ok_or_else(|| self.error(format!("{what} {text} does not exist: there are {count} so far")))
    }
}

#[derive(Clone, Copy)]
struct Corner {
    point: u32,
    uv: Option<u32>,
    normal: Option<u32>,
}

#[derive(Default)]
struct Parts<'a> {
    points: Vec<Vec3>,
    uv: Vec<Vec2>,
    normals: Vec<[f64; 3]>,
    triangles: Vec<[Corner; 3]>,
    /// Kinds of statements that were not read, and the line of the first of each.
    left_out: BTreeMap<&'a str, usize>,
}

impl<'a> Parts<'a> {
    fn statement(&mut self, words: &[Word<'a>]) -> Result<()> {
        let [first, rest @ ..] = words else { return Ok(()) };
        let what = || first.at(1).to_string();
        match first.text {
            "v" => {
                let coordinates = three(first, rest)?;
                let point = point(coordinates).ok_or_else(|| first.error("a vertex that is out of range".into()))?;
                memory::push(&mut self.points, point, what)?;
            }
            "vn" => memory::push(&mut self.normals, three(first, rest)?, what)?,
            "f" => self.face(first, rest)?,
            "vt" => {
                let [u, v @ ..] = rest else { return Err(first.error("\"vt\" needs a number".into())) };
                let v = v.first().map_or(Ok(0.0), Word::number)?;
                memory::push(&mut self.uv, Vec2::new(u.number()? as f32, v as f32), what)?;
            }
            // Without effect on a shape.
            "g" | "o" | "s" => {}
            "usemtl" | "mtllib" | "l" | "p" => {
                self.left_out.entry(first.text).or_insert(first.number);
            }
            "call" | "csh" | "curv" | "curv2" | "surf" | "cstype" | "vp" => {
                return Err(first.error(format!("{} is not supported", quote(first.text))));
            }
            other => return Err(first.error(format!("{} is no statement of an OBJ file", quote(other)))),
        }
        Ok(())
    }

    fn face(&mut self, first: &Word, words: &[Word]) -> Result<()> {
        if words.len() < 3 {
            return Err(first.error(format!("a face of {} corners", words.len())));
        }
        let what = || first.at(1).to_string();
        let mut corners = Vec::new();
        for word in words {
            // point, point/texture, point/texture/normal or point//normal.
            let mut parts = word.text.splitn(3, '/');
            let point = word.index(parts.next().unwrap_or_default(), self.points.len(), "vertex")?;
            let uv = parts.next().filter(|text| !text.is_empty());
            let uv = uv.map(|text| word.index(text, self.uv.len(), "texture coordinate")).transpose()?;
            let normal = parts.next().map(|text| word.index(text, self.normals.len(), "normal")).transpose()?;
            memory::push(&mut corners, Corner { point, uv, normal }, what)?;
        }
        fan(&corners).try_for_each(|triangle| memory::push(&mut self.triangles, triangle, what))
    }

    fn mesh(self, path: &Path, warnings: &mut Vec<String>) -> Result<Mesh> {
        let what = || path.display().to_string();
        let of_triangle = size_of::<[u32; 3]>() + if self.uv.is_empty() { 0 } else { size_of::<[Vec2; 3]>() };
        memory::grow(self.triangles.len() * of_triangle + self.normals.len() * size_of::<Vec3>(), what)?;
        let corners = || self.triangles.iter().flatten();
        let all = corners().all(|corner| corner.normal.is_some());
        if !all && corners().any(|corner| corner.normal.is_some()) {
            warnings.push(format!("{}: some corners have no normal: all normals are left out", path.display()));
        }
        let normals = if all { unit_normals(path, &self.normals, warnings) } else { Vec::new() };
        let uv = corner_uv(&self.triangles, |corner| Some(self.uv[corner.uv? as usize]));
        if normals.is_empty() {
            let triangles = self.triangles.iter().map(|corners| corners.map(|corner| corner.point)).collect();
            return Ok(Mesh { positions: self.points, normals, triangles, uv });
        }
        // A vertex for each pair of point and normal that occurs.
        let (mut mesh, mut known) = (Mesh { uv, ..Mesh::default() }, HashMap::new());
        for corners in &self.triangles {
            let mut triangle = [0; 3];
            for (vertex, &Corner { point, normal, .. }) in triangle.iter_mut().zip(corners) {
                *vertex = match known.get(&(point, normal)) {
                    Some(&vertex) => vertex,
                    None => {
                        let new = mesh.positions.len() as u32;
                        memory::insert(&mut known, (point, normal), new, what)?;
                        memory::push(&mut mesh.positions, self.points[point as usize], what)?;
                        memory::push(&mut mesh.normals, normals[normal.unwrap_or_default() as usize], what)?;
                        new
                    }
                };
            }
            mesh.triangles.push(triangle);
        }
        Ok(mesh)
    }
}

/// The first three numbers of a statement. A vertex may have a weight or a colour after them.
fn three(first: &Word, words: &[Word]) -> Result<[f64; 3]> {
    let [x, y, z, ..] = words else {
        return Err(first.error(format!("{} needs 3 numbers, not {}", quote(first.text), words.len())));
    };
    Ok([x.number()?, y.number()?, z.number()?])
}
