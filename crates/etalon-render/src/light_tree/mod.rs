//! The light tree: which of many lights to sample at a point, at a cost that grows with the logarithm of their number.
//!
//! Sources: Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", *Proc. ACM
//! Comput. Graph. Interact. Tech.* 1(2), 2018; Pharr, Jakob & Humphreys, *Physically Based Rendering*, 4th edition,
//! section 12.6. Nodes here have up to eight groups instead of two: their importances are computed with vectors, and
//! the tree is a third as deep.
//!
//! Memory per light: 16 bytes for its trail, and 110 to 170 bytes of nodes (384 bytes each) when there are many lights.

mod bounds;
mod build;
mod node;

#[cfg(test)]
mod tests;

pub use bounds::LightBounds;

use super::lanes::{BLOCK, NONE};
use build::{Built, build};
use glam::Vec3;
use node::{Importances, Node, WIDTH};

#[derive(Debug, Clone)]
pub struct LightTree {
    /// Parents first. Without lights, the root has no groups.
    nodes: Vec<Node>,
    /// For each light the groups to which it belongs, three bits each from the root on; none for a light of intensity
    /// 0.
    trails: Vec<Option<u64>>,
}

impl LightTree {
    /// About the memory of a light: its trail, and its part of a node of several.
    pub const LIGHT_BYTES: usize = size_of::<Option<u64>>() + 4 * size_of::<Node>() / 9;

    /// The tree of fewer than 2³¹ lights.
    pub fn new(lights: &[LightBounds]) -> Self {
        let Built { nodes, trails } = build(lights);
        Self { nodes, trails }
    }

    /// The tree as seen from a point. With a normal, only light from its side matters; without one, light from
    /// everywhere.
    #[inline(always)]
    pub fn at(&self, point: Vec3, normal: Option<Vec3>) -> LightTreeAt<'_> {
        LightTreeAt { tree: self, point, normal, root: self.nodes[0].importances(point, normal) }
    }
}

/// A sample on its way down the tree.
#[derive(Debug, Clone, Copy)]
struct Descent {
    node: u32,
    probability: f32,
    /// The random number for the rest of the way.
    u: f32,
}

impl Descent {
    /// At the root.
    #[inline(always)]
    fn new(u: f32) -> Self {
        Self { node: 0, probability: 1.0, u }
    }
}

/// Where a step down the tree leads.
#[derive(Debug, Clone, Copy)]
enum Found {
    /// To a light, with its probability.
    Light(u32, f32),
    /// To where no light arrives from.
    Nothing,
    Node(Descent),
}

/// A light tree as seen from a point. It keeps what all lights sampled there have in common: the importances at the
/// root.
#[derive(Clone, Copy)]
pub struct LightTreeAt<'a> {
    tree: &'a LightTree,
    point: Vec3,
    normal: Option<Vec3>,
    root: Importances,
}

impl LightTreeAt<'_> {
    /// A light, and its probability, which is the [`pmf`](Self::pmf) to the last bit.
    ///
    /// `None` if no light reaches the point, as far as the bounds say. The bounds of a group may allow light that those
    /// of all of its lights exclude: probabilities then sum to less than 1, and the rest is `None`, too.
    ///
    /// Each light belongs to one interval of `u`, and neighbouring intervals to neighbouring lights. Stratified `u`
    /// therefore gives samples stratified over the lights.
    #[inline(always)]
    pub fn sample(&self, u: f32) -> Option<(u32, f32)> {
        let mut descent = Descent::new(u);
        loop {
            match self.descend(descent) {
                Found::Light(light, probability) => return Some((light, probability)),
                Found::Nothing => return None,
                Found::Node(next) => descent = next,
            }
        }
    }

    /// Goes from a node of the tree to the one below that is sampled, or to a light.
    ///
    /// Descents do not depend on each other: a processor that takes a step of each of many in turn overlaps them, which it
    /// cannot do with the steps of one.
    #[inline(always)]
    fn descend(&self, descent: Descent) -> Found {
        let node = &self.tree.nodes[descent.node as usize];
        let importances = if descent.node == 0 { self.root } else { node.importances(self.point, self.normal) };
        let Some((i, share, u)) = importances.sample(descent.u) else { return Found::Nothing };
        let probability = descent.probability * share;
        match node.children[i].index() {
            // Not 0 by underflow.
            Ok(light) => Found::Light(light as u32, probability.max(f32::MIN_POSITIVE)),
            Err(next) => Found::Node(Descent { node: next as u32, probability, u }),
        }
    }

    /// [`sample`](Self::sample) for a block of shading points. On entry `probability` holds their random numbers, on return the
    /// probability of the chosen light; `light` is [`NONE`] where no light can contribute. All points descend the tree together.
    #[inline(always)]
    pub fn sample_each(places: &[Self; BLOCK], light: &mut [u32], probability: &mut [f32]) {
        let mut count = light.len().min(probability.len()).min(BLOCK);
        let (mut descents, mut left) = ([Descent::new(0.0); BLOCK], [0; BLOCK]);
        for i in 0..count {
            (descents[i], left[i]) = (Descent::new(probability[i]), i);
        }
        while count > 0 {
            let mut still = 0;
            for k in 0..count {
                let i = left[k] % BLOCK;
                left[still] = i;
                match places[i].descend(descents[i]) {
                    Found::Light(number, p) => (light[i], probability[i]) = (number, p),
                    Found::Nothing => (light[i], probability[i]) = (NONE, 1.0),
                    Found::Node(descent) => {
                        descents[i] = descent;
                        still += 1;
                    }
                }
            }
            count = still;
        }
    }

    /// The probability that [`sample`](Self::sample) selects a light; 0 only if the light does not reach the point.
    #[inline(always)]
    pub fn pmf(&self, light: u32) -> f32 {
        let Some(mut trail) = self.tree.trails[light as usize] else { return 0.0 };
        let (mut node, mut importances, mut probability) = (&self.tree.nodes[0], self.root, 1.0);
        loop {
            let i = (trail % WIDTH as u64) as usize;
            let Some(share) = importances.share(i) else { return 0.0 };
            probability *= share;
            match node.children[i].index() {
                Ok(_) => return probability.max(f32::MIN_POSITIVE),
                Err(next) => (node, trail) = (&self.tree.nodes[next], trail / WIDTH as u64),
            }
            importances = node.importances(self.point, self.normal);
        }
    }
}
