//! OBJ: the text format of Wavefront's Advanced Visualizer, as far as polygons go.

use crate::error::{Error, Result};
use crate::import::number::finite;
use crate::import::place::{At, quote};
use crate::import::shape::{corner_uv, fan, point, unit_normals};
use crate::scene::Mesh;
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Reads the file at `path`, whose content is `bytes`. Materials and groups are not read.
pub fn read(path: &Path, bytes: &[u8], warnings: &mut Vec<String>) -> Result<Mesh> {
    let text = String::from_utf8_lossy(bytes);
    let (mut parts, mut statement) = (Parts::default(), Vec::new());
    for (number, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim_end();
        let words = line.trim_end_matches('\\').split_ascii_whitespace();
        statement.extend(words.map(|text| Word { text, line, number: number + 1, path }));
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
    Ok(parts.mesh(path, warnings))
}

/// A word of the file, and its position.
struct Word<'a> {
    text: &'a str,
    line: &'a str,
    number: usize,
    path: &'a Path,
}

impl Word<'_> {
    fn error(&self, message: String) -> Error {
        let column = self.line[..self.text.as_ptr() as usize - self.line.as_ptr() as usize].chars().count() + 1;
        At::new(self.path.into(), self.number, column).input(message)
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
        match first.text {
            "v" => {
                let coordinates = three(first, rest)?;
                self.points
                    .push(point(coordinates).ok_or_else(|| first.error("a vertex that is out of range".into()))?);
            }
            "vn" => self.normals.push(three(first, rest)?),
            "f" => self.face(first, rest)?,
            "vt" => {
                let [u, v @ ..] = rest else { return Err(first.error("\"vt\" needs a number".into())) };
                let v = v.first().map_or(Ok(0.0), Word::number)?;
                self.uv.push(Vec2::new(u.number()? as f32, v as f32));
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
        let mut corners = Vec::with_capacity(words.len());
        for word in words {
            // point, point/texture, point/texture/normal or point//normal.
            let mut parts = word.text.splitn(3, '/');
            let point = word.index(parts.next().unwrap_or_default(), self.points.len(), "vertex")?;
            let uv = parts.next().filter(|text| !text.is_empty());
            let uv = uv.map(|text| word.index(text, self.uv.len(), "texture coordinate")).transpose()?;
            let normal = parts.next().map(|text| word.index(text, self.normals.len(), "normal")).transpose()?;
            corners.push(Corner { point, uv, normal });
        }
        let numbers: Vec<u32> = (0..corners.len() as u32).collect();
        self.triangles.extend(fan(&numbers).map(|triangle| triangle.map(|i| corners[i as usize])));
        Ok(())
    }

    fn mesh(self, path: &Path, warnings: &mut Vec<String>) -> Mesh {
        let corners = || self.triangles.iter().flatten();
        let all = corners().all(|corner| corner.normal.is_some());
        if !all && corners().any(|corner| corner.normal.is_some()) {
            warnings.push(format!("{}: some corners have no normal: all normals are left out", path.display()));
        }
        let normals = if all { unit_normals(path, &self.normals, warnings) } else { Vec::new() };
        let uv = corner_uv(&self.triangles, |corner| Some(self.uv[corner.uv? as usize]));
        if normals.is_empty() {
            let triangles = self.triangles.iter().map(|corners| corners.map(|corner| corner.point)).collect();
            return Mesh { positions: self.points, normals, triangles, uv };
        }
        // A vertex for each pair of point and normal that occurs.
        let (mut mesh, mut known) = (Mesh { uv, ..Mesh::default() }, HashMap::new());
        for corners in &self.triangles {
            let triangle = corners.map(|Corner { point, normal, .. }| {
                *known.entry((point, normal)).or_insert_with(|| {
                    mesh.positions.push(self.points[point as usize]);
                    mesh.normals.push(normals[normal.unwrap_or_default() as usize]);
                    mesh.positions.len() as u32 - 1
                })
            });
            mesh.triangles.push(triangle);
        }
        mesh
    }
}

/// The first three numbers of a statement. A vertex may have a weight or a colour after them.
fn three(first: &Word, words: &[Word]) -> Result<[f64; 3]> {
    let [x, y, z, ..] = words else {
        return Err(first.error(format!("{} needs 3 numbers, not {}", quote(first.text), words.len())));
    };
    Ok([x.number()?, y.number()?, z.number()?])
}
