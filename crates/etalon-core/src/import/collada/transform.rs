//! The file's up axis, and the transforms of COLLADA's nodes; and the camera that the course's renderer places itself: of the file's
//! camera only direction and field of view count.

use super::document::{Document, Element, elements, find};
use crate::error::Result;
use crate::import::place::{ANGLE, ANY, Rule, quote};
use crate::import::transform::{affine, in_range, rotate};
use crate::scene::{Camera, Projection};
use glam::{DMat3, DMat4, DVec3};

/// Takes the file's space to the world, y up: z up goes (x, y, z) → (−x, z, y), x up (x, y, z) → (y, x, −z).
pub fn up_axis(document: &Document) -> Result<DMat4> {
    let node = document.require(document.root(), "asset/up_axis")?;
    let matrix = match node.text().unwrap_or_default().trim() {
        "Y_UP" => DMat3::IDENTITY,
        "Z_UP" => DMat3::from_cols(DVec3::NEG_X, DVec3::Z, DVec3::Y),
        "X_UP" => DMat3::from_cols(DVec3::Y, DVec3::X, DVec3::NEG_Z),
        other => {
            return Err(document.at(node).input(format!("the up axis is X_UP, Y_UP or Z_UP, not {}", quote(other))));
        }
    };
    Ok(DMat4::from_mat3(matrix))
}

/// A node's own transform: its matrix if it has one, which replaces all else, otherwise the product of its rotations,
/// translations and scales in the file's order.
pub fn local<'a>(document: &Document<'a>, node: Element<'a>) -> Result<DMat4> {
    if let Some(node) = find(node, "matrix") {
        return matrix(document, node);
    }
    let mut product = DMat4::IDENTITY;
    for child in elements(node) {
        let step = match child.tag_name().name() {
            "translate" => DMat4::from_translation(DVec3::from_array(document.exactly(child, &ANY)?)),
            "scale" => DMat4::from_scale(DVec3::from_array(document.exactly(child, &ANY)?)),
            "rotate" => {
                let [x, y, z, degrees] = document.exactly(child, &ANY)?;
                rotate(degrees, DVec3::new(x, y, z))
                    .ok_or_else(|| document.at(child).input("<rotate> needs an axis that is not 0 0 0"))?
            }
            name @ ("lookat" | "skew") => {
                return Err(document.at(child).unsupported(format!("<{name}> is not supported")));
            }
            _ => continue,
        };
        product = affine(product * step, || document.at(child))?;
    }
    Ok(product)
}

/// 16 numbers row by row, for column vectors.
///
/// Some of the course's files have 15. Their renderer reads them from the first on and looks at three rows only, so the
/// first 12 numbers count, wherever the missing one belongs.
fn matrix<'a>(document: &Document<'a>, node: Element<'a>) -> Result<DMat4> {
    const LAST_ROW: [f64; 4] = [0.0, 0.0, 0.0, 1.0];
    let mut numbers = document.numbers(node)?;
    let count = numbers.len();
    if count == 15 {
        let message = "<matrix> has 15 numbers, not 16: the first 12 are taken for its first three rows, as in the course's \
                       renderer, and 0 0 0 1 for the last one";
        document.warn(node, message);
        numbers.truncate(12);
        numbers.extend(LAST_ROW);
    }
    let Ok(numbers) = <[f64; 16]>::try_from(numbers.as_slice()) else {
        return Err(document.at(node).input(format!("<matrix> needs 16 numbers, not {count}")));
    };
    let matrix = DMat4::from_cols_array(&numbers).transpose();
    if matrix.row(3).to_array() != LAST_ROW {
        let row = &numbers[12..];
        let message = format!("<matrix> of 16 numbers with the last row {row:?}: a projective transform");
        return Err(document.at(node).unsupported(message).with_hint("the last row must be 0 0 0 1"));
    }
    affine(matrix, || document.at(node))
}

/// The window that fields of view are fitted to before the image's size is known, in pixels.
pub const WINDOW: [usize; 2] = [800, 600];
const DEFAULT_XFOV: f64 = 50.0;
const ASPECT: Rule = Rule(|x| (1e-6..=1e6).contains(&x), "from 1e-6 to 1e6");

pub struct View<'a> {
    node: Element<'a>,
    /// From the world's origin to the point one unit ahead of the camera.
    ahead: DVec3,
    /// Tangents of half the fields of view.
    tan_half: [f64; 2],
}

impl<'a> View<'a> {
    /// Reads a `<camera>` element in a node.
    pub fn read(document: &Document<'a>, node: Element<'a>, to_world: &DMat4) -> Result<Self> {
        let technique = document.require(node, "optics/technique_common")?;
        let Some(lens) = find(technique, "perspective") else {
            return Err(document.at(technique).unsupported("only <perspective> cameras are supported"));
        };
        let tan_half_of = |node| -> Result<f64> {
            let [degrees] = document.exactly(node, &ANGLE)?;
            Ok((f64::to_radians(degrees) * 0.5).tan())
        };
        let x = find(lens, "xfov").map_or(Ok((DEFAULT_XFOV.to_radians() * 0.5).tan()), tan_half_of)?;
        let y = match find(lens, "yfov") {
            Some(node) => tan_half_of(node)?,
            None => {
                let node = document.require(lens, "aspect_ratio")?;
                let [aspect] = document.exactly(node, &ASPECT)?;
                x / aspect
            }
        };
        Ok(Self { node, ahead: to_world.transform_point3(DVec3::NEG_Z), tan_half: [x, y] })
    }

    /// The camera for an image of this size that looks at the middle of `bounds`, from a distance of 1.5 diagonals.
    ///
    /// The fields of view are widened to fill the [`WINDOW`]; an image of another size shows more or less at the same
    /// scale in pixels. The course's renderer does the same.
    pub fn place(&self, document: &Document<'a>, bounds: [DVec3; 2], size: [usize; 2]) -> Result<Camera> {
        let [low, high] = bounds;
        let (target, distance) = ((low + high) * 0.5, 1.5 * low.distance(high));
        let away = |direction: DVec3| target + direction * distance;
        let position = self.ahead.try_normalize().map(away).filter(|&position| in_range(position));
        let [width, height] = WINDOW.map(|side| side as f64);
        let [x, y] = self.tan_half;
        let per_pixel = y.max(x * height / width) / height;
        let [tan_half_width, tan_half_height] = size.map(|side| side as f64 * per_pixel);
        let projection = Projection::Perspective { tan_half_width, tan_half_height };
        let camera = position.and_then(|position| Camera::look_at(position, target, DVec3::Y, projection));
        camera.ok_or_else(|| {
            let at = document.at(self.node);
            at.input("this camera's direction is vertical or none, or the scene has no size")
                .with_hint("turn its node, or give a file of camera settings")
        })
    }
}
