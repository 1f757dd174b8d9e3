//! Exact irradiance from a map: E(n) = ∫ L(ω) max(n·ω, 0) dω, with a bound on its error.
//!
//! A block of texels wholly above the horizon of n contributes n·M₁, where M₁ = ∫ L ω dω over the block is known in
//! closed form; one wholly below contributes nothing. Only blocks on the horizon are subdivided, down to texels. One of
//! flux F and angular radius ρ that is not subdivided contributes between max(n·M₁, 0) and Fρ/2 more; it is estimated as if
//! its cosines were uniform, and the uncertainties add up to a bound. The actual errors have either sign and are a few 10⁻⁶
//! of the whole; see the tests.

use super::latlong::{Block, LatLong};
use super::map::EnvMap;
use glam::DVec3;
use std::f64::consts::PI;

/// An irradiance with a bound of its error.
#[derive(Debug, Clone, Copy)]
pub struct Irradiance {
    /// ∫ L max(n·ω, 0) dω per channel.
    pub value: DVec3,
    /// Upper bound of the error of each channel.
    pub error: DVec3,
}

/// A bright texel on the horizon is cut into this number of parts each way.
const PARTS: usize = 8;

/// The tree of blocks of a map.
pub struct IrradianceTree {
    geometry: LatLong,
    nodes: Vec<Node>,
    /// A block on the horizon is subdivided only while its bound exceeds this share of the whole flux.
    tolerance: f64,
    total: DVec3,
}

#[derive(Default)]
struct Node {
    /// ∫ L ω dω, one vector per channel.
    moments: [DVec3; 3],
    flux: DVec3,
    axis: DVec3,
    /// sin of the angular radius around `axis`; 2 (never wholly on one side) for radii of 90° and more.
    sin_radius: f64,
    radius: f64,
    /// Children are `first..first + count`; a texel has none, and `first` is its number in reading order.
    first: u32,
    count: u32,
}

impl IrradianceTree {
    /// Prepares a map. Memory: about 200 bytes per texel.
    pub fn new(map: &EnvMap) -> Self {
        let (width, height) = (map.geometry().width(), map.geometry().height());
        let mut tree =
            Self { geometry: map.geometry().clone(), nodes: Vec::new(), tolerance: 1e-7, total: DVec3::ZERO };
        let whole = Block { x0: 0, y0: 0, x1: width, y1: height };
        tree.nodes.push(Node::default());
        tree.nodes[0] = tree.build(map, whole);
        tree.total = tree.nodes[0].flux;
        tree
    }

    /// The irradiance of a surface with unit normal `n`.
    pub fn irradiance(&self, n: DVec3) -> Irradiance {
        let mut value = DVec3::ZERO;
        let mut error = DVec3::ZERO;
        let limit = self.tolerance * self.total.element_sum();
        let mut stack = vec![0u32];
        while let Some(i) = stack.pop() {
            let node = &self.nodes[i as usize];
            let height = n.dot(node.axis);
            // Wholly below the horizon, or wholly above it?
            if height <= -node.sin_radius {
                continue;
            }
            let linear = DVec3::new(n.dot(node.moments[0]), n.dot(node.moments[1]), n.dot(node.moments[2]));
            if height >= node.sin_radius {
                value += linear;
                continue;
            }
            // On the horizon: subdivide it while the bound of its error is too large.
            let bound = 0.5 * node.radius * node.flux;
            if bound.element_sum() > limit && node.count == 0 {
                value += self.texel_on_horizon(node, n);
                // The horizon cuts at most 2·PARTS − 1 of the PARTS² parts. In each the error of the mean cosine is at most a quarter
                // of the part's radius, for cosines that are uniform there.
                error += bound / (PARTS * PARTS) as f64;
            } else if bound.element_sum() <= limit {
                // Assume cosines uniform over ± the half side of a square of that radius, which has the same variance.
                let reach = node.flux * (node.sin_radius.min(1.0) * std::f64::consts::FRAC_1_SQRT_2);
                let x = (linear / reach.max(DVec3::splat(f64::MIN_POSITIVE))).clamp(DVec3::NEG_ONE, DVec3::ONE);
                value += reach * (DVec3::ONE + x) * (DVec3::ONE + x) * 0.25;
                error += bound;
            } else {
                stack.extend(node.first..node.first + node.count);
            }
        }
        Irradiance { value, error }
    }

    /// ∫ L max(n·ω, 0) dω over one texel by the midpoint rule.
    fn texel_on_horizon(&self, node: &Node, n: DVec3) -> DVec3 {
        let (x, y) = (node.first as usize % self.geometry.width(), node.first as usize / self.geometry.width());
        let at = |i: usize| (i as f64 + 0.5) / PARTS as f64;
        let cosines = (0..PARTS * PARTS)
            .map(|i| n.dot(self.geometry.direction_in_texel(x, y, at(i % PARTS), at(i / PARTS))).max(0.0));
        node.flux * cosines.sum::<f64>() / (PARTS * PARTS) as f64
    }

    /// The node of a block of texels, its descendants appended.
    fn build(&mut self, map: &EnvMap, block: Block) -> Node {
        let Block { x0, y0, x1, y1 } = block;
        if x1 - x0 == 1 && y1 - y0 == 1 {
            return Node::texel(map, x0, y0);
        }
        // Halve each side that is longer than one texel, but do not cut long strips into slivers.
        let (w, h) = (x1 - x0, y1 - y0);
        let xs = if 2 * w >= h && w > 1 { vec![x0, x0 + w / 2, x1] } else { vec![x0, x1] };
        let ys = if 2 * h >= w && h > 1 { vec![y0, y0 + h / 2, y1] } else { vec![y0, y1] };
        let block_at = |x: &[usize], y: &[usize]| Block { x0: x[0], y0: y[0], x1: x[1], y1: y[1] };
        let children: Vec<Block> = ys.windows(2).flat_map(|y| xs.windows(2).map(move |x| block_at(x, y))).collect();
        let first = self.nodes.len();
        self.nodes.resize_with(first + children.len(), Node::default);
        for (i, &child) in children.iter().enumerate() {
            self.nodes[first + i] = self.build(map, child);
        }
        Node::parent(&self.nodes[first..], children.len(), first, map.geometry().cone(block))
    }
}

impl Node {
    fn with_cone(mut self, (axis, radius): (DVec3, f64)) -> Self {
        self.axis = axis;
        self.radius = radius;
        self.sin_radius = if radius < 0.5 * PI { radius.sin() } else { 2.0 };
        self
    }

    fn texel(map: &EnvMap, x: usize, y: usize) -> Self {
        let radiance = map.texel(x, y).as_dvec3();
        let moment = map.geometry().moment(x, y);
        Self {
            moments: [moment * radiance.x, moment * radiance.y, moment * radiance.z],
            flux: radiance * map.geometry().solid_angle(y),
            first: (y * map.geometry().width() + x) as u32,
            ..Self::default()
        }
        .with_cone(map.geometry().cone(Block { x0: x, y0: y, x1: x + 1, y1: y + 1 }))
    }

    fn parent(children: &[Node], count: usize, first: usize, cone: (DVec3, f64)) -> Self {
        let mut node = Self { first: first as u32, count: count as u32, ..Self::default() }.with_cone(cone);
        for child in &children[..count] {
            node.flux += child.flux;
            for c in 0..3 {
                node.moments[c] += child.moments[c];
            }
        }
        node
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::raster::Image;

    fn normals() -> impl Iterator<Item = DVec3> {
        (0..50).map(|i| {
            let (y, phi) = (1.0 - (f64::from(i) + 0.5) / 25.0, f64::from(i) * 2.399_963);
            let r = (1.0 - y * y).sqrt();
            DVec3::new(r * phi.cos(), y, r * phi.sin())
        })
    }

    #[test]
    fn a_constant_map_gives_pi() {
        for (w, h) in [(64, 32), (7, 5), (256, 128)] {
            let tree = IrradianceTree::new(&EnvMap::new(Image::from_fn(w, h, |_, _| Rgb::new(1.0, 2.0, 0.0))));
            for n in normals() {
                let e = tree.irradiance(n);
                let expected = PI * DVec3::new(1.0, 2.0, 0.0);
                assert!((e.value - expected).abs().cmple(e.error + 1e-12).all(), "{w}x{h} {n}: {e:?}");
            }
        }
    }

    #[test]
    fn irradiance_agrees_with_brute_force_within_its_bound() {
        let value =
            |x: usize, y: usize| Rgb::new(((x * 7 + y * 5) % 9) as f32, if (x, y) == (20, 6) { 1e4 } else { 0.0 }, 1.0);
        let map = EnvMap::new(Image::from_fn(32, 16, value));
        let tree = IrradianceTree::new(&map);
        let g = map.geometry();
        for n in normals() {
            let mut sum = DVec3::ZERO;
            const FINE: usize = 24;
            for (x, y) in (0..16).flat_map(|y| (0..32).map(move |x| (x, y))) {
                let cell = map.texel(x, y).as_dvec3() * g.solid_angle(y) / (FINE * FINE) as f64;
                for i in 0..FINE * FINE {
                    let at = |k: usize| (k as f64 + 0.5) / FINE as f64;
                    sum += cell * n.dot(g.direction_in_texel(x, y, at(i % FINE), at(i / FINE))).max(0.0);
                }
            }
            let e = tree.irradiance(n);
            assert!((e.value - sum).abs().cmple(e.error + 2e-4 * sum).all(), "{n}: {e:?} against {sum}");
        }
    }

    #[test]
    fn the_relative_error_is_below_1e_5() {
        let lights = |x: usize, y: usize| if x % 97 == 5 && y % 61 == 20 { 300.0 } else { 0.1 + (x % 7) as f32 * 0.05 };
        let mut tree = IrradianceTree::new(&EnvMap::new(Image::from_fn(512, 256, |x, y| Rgb::splat(lights(x, y)))));
        for n in normals() {
            let quick = tree.irradiance(n).value.x;
            tree.tolerance = 0.0;
            let slow = tree.irradiance(n).value.x;
            tree.tolerance = 1e-7;
            assert!((quick / slow - 1.0).abs() < 1e-5, "{n}: {quick} against {slow}");
        }
    }
}
