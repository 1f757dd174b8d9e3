//! The camera that the course's renderer places itself: of the file's camera only direction and field of view count.

use super::document::{Document, Element, find};
use crate::error::Result;
use crate::import::rule::{ANGLE, Rule};
use crate::import::transform::in_range;
use crate::scene::{Camera, Projection};
use glam::{DMat4, DVec3};

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
