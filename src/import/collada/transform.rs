//! The file's up axis, and the transforms of COLLADA's nodes.

use super::document::{Document, Element, elements, find};
use crate::error::Result;
use crate::import::place::quote;
use crate::import::rule::ANY;
use crate::import::transform::{affine, rotate};
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
