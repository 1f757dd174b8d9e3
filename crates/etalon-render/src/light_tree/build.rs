//! Building the light tree.

use super::bounds::{Group, LightBounds};
use super::node::{Child, Node, WIDTH};
use glam::Vec3;
use std::ops::Range;

/// The tree's nodes, parents first and at least one, and for each light its trail: the groups to which it belongs,
/// three bits each from the root on. A light of intensity 0 has no place in the tree.
pub struct Built {
    pub nodes: Vec<Node>,
    pub trails: Vec<Option<u64>>,
}

/// Candidates for a split along an axis are the boundaries of this many intervals.
const BINS: usize = 12;

/// Deeper than this, lights are split into equal halves: no input makes the tree deeper than a trail is long, 21
/// levels.
const COSTED_LEVELS: u32 = 10;

/// Some lights, and their bounds.
struct Part {
    range: Range<usize>,
    group: Group,
}

struct Builder<'a> {
    lights: &'a [LightBounds],
    /// Indices of the lights, sorted as the build goes on.
    order: Vec<u32>,
    built: Built,
}

/// Builds the tree of fewer than 2³¹ lights, top down: a group is split by the least sum of costs, and the costliest
/// group of a node first. One thread builds it, so that the result does not depend on their number.
pub fn build(lights: &[LightBounds]) -> Built {
    let order: Vec<u32> = (0..lights.len() as u32).filter(|i| lights[*i as usize].intensity > 0.0).collect();
    let built = Built { nodes: Vec::new(), trails: vec![None; lights.len()] };
    let mut builder = Builder { lights, order, built };
    let all = builder.part(0..builder.order.len());
    builder.node(all, 0, 0);
    builder.built
}

impl Builder<'_> {
    fn light(&self, i: usize) -> &LightBounds {
        &self.lights[self.order[i] as usize]
    }

    fn part(&self, range: Range<usize>) -> Part {
        let group = range.clone().fold(Group::EMPTY, |group, i| group.with(self.light(i)));
        Part { range, group }
    }

    /// Adds the node of some lights, which follow `trail`, and all nodes below it; returns its index.
    fn node(&mut self, all: Part, level: u32, trail: u64) -> usize {
        let index = self.built.nodes.len();
        // Its place, before those of the nodes below.
        self.built.nodes.push(Node::EMPTY);
        let by_cost = level < COSTED_LEVELS;
        let is_last = all.range.len() <= WIDTH;
        let mut parts = if is_last { all.range.map(|i| self.part(i..i + 1)).collect() } else { vec![all] };
        while parts.len() < WIDTH {
            let key = |part: &Part| if by_cost { part.group.cost() } else { part.range.len() as f64 };
            let several = parts.iter().enumerate().filter(|(_, part)| part.range.len() > 1);
            let Some((next, _)) = several.max_by(|a, b| key(a.1).total_cmp(&key(b.1))) else { break };
            let range = parts[next].range.clone();
            let middle = self.split(range.clone(), by_cost);
            let halves = [range.start..middle, middle..range.end].map(|half| self.part(half));
            parts.splice(next..=next, halves);
        }
        let greatest = parts.iter().fold(0.0, |greatest: f64, part| greatest.max(part.group.intensity));
        let mut node = Node::EMPTY;
        for (i, part) in parts.into_iter().enumerate() {
            node.set(i, &part.group, greatest, part.range.clone().map(|i| *self.light(i)));
            let trail = trail | (i as u64) << (3 * level);
            node.children[i] = if part.range.len() == 1 {
                let light = self.order[part.range.start];
                self.built.trails[light as usize] = Some(trail);
                Child::light(light)
            } else {
                Child::node(self.node(part, level + 1, trail))
            };
        }
        self.built.nodes[index] = node;
        index
    }

    /// Sorts at least two lights into two groups that are not empty; returns where the second one begins.
    fn split(&mut self, range: Range<usize>, by_cost: bool) -> usize {
        let middle = range.start + range.len() / 2;
        if !by_cost {
            return middle;
        }
        let centroid = |light: &LightBounds| 0.5 * light.min + 0.5 * light.max;
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for i in range.clone() {
            let centre = centroid(self.light(i));
            (min, max) = (min.min(centre), max.max(centre));
        }
        let count = range.len().min(BINS);
        // Zero along an axis on which all lights lie at one place; they then share its first interval.
        let scale = (max - min).map(|extent| if extent > 0.0 { count as f32 / extent } else { 0.0 });
        let bin = |light: &LightBounds| {
            let place = (centroid(light) - min) * scale;
            place.to_array().map(|place| (place as usize).min(count - 1))
        };
        let mut bins = [[Group::EMPTY; BINS]; 3];
        for i in range.clone() {
            let light = self.light(i);
            for (bins, place) in bins.iter_mut().zip(bin(light)) {
                bins[place] = bins[place].with(light);
            }
        }
        let mut best: Option<(f64, usize, usize)> = None;
        for (axis, bins) in bins.iter().enumerate() {
            let mut above = [0.0; BINS];
            let mut group = Group::EMPTY;
            for i in (1..count).rev() {
                group = group.union(bins[i]);
                above[i] = if group.intensity > 0.0 { group.cost() } else { f64::INFINITY };
            }
            let mut group = Group::EMPTY;
            for i in 1..count {
                group = group.union(bins[i - 1]);
                let below = if group.intensity > 0.0 { group.cost() } else { f64::INFINITY };
                let cost = below + above[i];
                if cost < best.map_or(f64::INFINITY, |best| best.0) {
                    best = Some((cost, axis, i));
                }
            }
        }
        let Some((_, axis, boundary)) = best else { return middle };
        let (lights, order) = (self.lights, &mut self.order[range.clone()]);
        let mut below = 0;
        for i in 0..order.len() {
            if bin(&lights[order[i] as usize])[axis] < boundary {
                order.swap(i, below);
                below += 1;
            }
        }
        range.start + below
    }
}
