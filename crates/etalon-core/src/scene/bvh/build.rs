//! From a heap of primitives to a tree of boxes with eight children each, by the surface area heuristic.
//!
//! A box is split where the expected cost Σ area · ⌈count / 8⌉ of its halves is least, tried at the borders of 16 bins
//! of centroids along each axis. Source: Wald, "On fast construction of SAH-based bounding volume hierarchies",
//! *IEEE Symposium on Interactive Ray Tracing*, 2007. Of a node's boxes the largest is split until there are eight:
//! Wald, Benthin, Boulos, "Getting rid of packets", *IEEE Symposium on Interactive Ray Tracing*, 2008.

use super::lanes::WIDTH;
use glam::Vec3;
use rayon::prelude::*;

/// Borders between bins are where a box may be split.
const BINS: usize = 16;

/// Below this many levels boxes are halved by count, which bounds depth and time for primitives in any position.
const HEURISTIC_LEVELS: usize = 32;

/// Boxes with fewer primitives are not worth another thread.
const PARALLEL: usize = 4096;

/// An axis-parallel box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    pub min: Vec3,
    pub max: Vec3,
}

impl Bounds {
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    #[inline]
    pub fn with(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    #[inline]
    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Half the surface; 0 for what contains nothing.
    #[inline]
    fn half_area(self) -> f32 {
        let d = (self.max - self.min).max(Vec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    /// Twice the centre.
    #[inline]
    fn centre(self) -> Vec3 {
        self.min + self.max
    }
}

/// What a pack has eight of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Triangle,
    Sphere,
}

/// A primitive by the number of its shape and, in meshes and rectangles, of the triangle in it. Of two hits at the same
/// distance the lower one counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Id {
    pub shape: u32,
    pub triangle: u32,
}

/// A primitive to sort into the tree.
#[derive(Debug, Clone, Copy)]
pub struct Item {
    pub bounds: Bounds,
    pub kind: Kind,
    pub id: Id,
}

/// A tree, or a part of one.
#[derive(Debug)]
pub enum Branch {
    /// Up to [`WIDTH`] primitives of one kind.
    Leaf(Kind, Vec<Id>),
    /// Up to [`WIDTH`] boxes.
    Node(Vec<(Bounds, Branch)>),
}

/// The tree over `items`, whose order is lost. It does not depend on the number of threads.
pub fn build(items: &mut [Item]) -> Branch {
    branch(items, 0)
}

fn branch(items: &mut [Item], level: usize) -> Branch {
    if items.len() <= WIDTH {
        return leaf(items);
    }
    let many = items.len() >= PARALLEL;
    let whole = around(items);
    let mut parts = vec![(whole, items)];
    while parts.len() < WIDTH {
        let large = (0..parts.len()).filter(|&i| parts[i].1.len() > WIDTH);
        let Some(i) = large.max_by(|&a, &b| parts[a].0.half_area().total_cmp(&parts[b].0.half_area())) else { break };
        let (_, items) = parts.swap_remove(i);
        let middle = split(items, level);
        let (left, right) = items.split_at_mut(middle);
        parts.extend([(around(left), left), (around(right), right)]);
    }
    let grow = |(bounds, items)| (bounds, branch(items, level + 1));
    Branch::Node(if many { parts.into_par_iter().map(grow).collect() } else { parts.into_iter().map(grow).collect() })
}

/// Up to [`WIDTH`] items: a leaf, or one for each kind.
fn leaf(items: &mut [Item]) -> Branch {
    let middle = partition(items, |item| item.kind == Kind::Triangle);
    let (triangles, spheres) = items.split_at(middle);
    let of = |kind, items: &[Item]| Branch::Leaf(kind, items.iter().map(|i| i.id).collect());
    if spheres.is_empty() {
        of(Kind::Triangle, triangles)
    } else if triangles.is_empty() {
        of(Kind::Sphere, spheres)
    } else {
        let child = |kind, items| (around(items), of(kind, items));
        Branch::Node(vec![child(Kind::Triangle, triangles), child(Kind::Sphere, spheres)])
    }
}

fn around(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::EMPTY, |b, i| b.union(i.bounds))
}

/// Sorts `items` into two parts, neither empty, and returns where the second begins.
fn split(items: &mut [Item], level: usize) -> usize {
    let centres = items.iter().fold(Bounds::EMPTY, |b, i| b.with(i.bounds.centre()));
    if level < HEURISTIC_LEVELS
        && let Some((axis, border, bins)) = cheapest(items, centres)
    {
        let middle = partition(items, |item| bins.of(item)[axis] < border);
        if middle > 0 && middle < items.len() {
            return middle;
        }
    }
    let middle = items.len() / 2;
    let axis = (centres.max - centres.min).max_position();
    items.select_nth_unstable_by(middle, |a, b| a.bounds.centre()[axis].total_cmp(&b.bounds.centre()[axis]));
    middle
}

/// The equal slices into which the centroids are sorted.
#[derive(Clone, Copy)]
struct Bins {
    low: Vec3,
    scale: Vec3,
}

impl Bins {
    #[inline(always)]
    fn of(self, item: &Item) -> [usize; 3] {
        let place = (item.bounds.centre() - self.low) * self.scale;
        let bin = |p: f32| (p as usize).min(BINS - 1);
        [bin(place.x), bin(place.y), bin(place.z)]
    }
}

/// Axis, first bin of the upper part, and the bins of the cheapest split; `None` when all centroids are one.
fn cheapest(items: &[Item], centres: Bounds) -> Option<(usize, usize, Bins)> {
    let size = centres.max - centres.min;
    // A little less than the number of bins, so that the largest centroid stays inside.
    let scale = (BINS as f32 * (1.0 - 1e-6) / size).to_array().map(|s| if s.is_finite() { s } else { 0.0 });
    let bins = Bins { low: centres.min, scale: scale.into() };
    let mut slices = [[(Bounds::EMPTY, 0usize); BINS]; 3];
    for item in items {
        for (slices, bin) in slices.iter_mut().zip(bins.of(item)) {
            let slice = &mut slices[bin];
            *slice = (slice.0.union(item.bounds), slice.1 + 1);
        }
    }
    let cost = |(bounds, count): (Bounds, usize)| bounds.half_area() * count.div_ceil(WIDTH) as f32;
    let join = |a: &mut (Bounds, usize), b: &(Bounds, usize)| {
        *a = (a.0.union(b.0), a.1 + b.1);
        Some(*a)
    };
    let mut best = (f32::INFINITY, None);
    for (axis, slices) in slices.iter().enumerate() {
        let mut above = [(Bounds::EMPTY, 0); BINS];
        for (to, from) in above.iter_mut().rev().zip(slices.iter().rev().scan((Bounds::EMPTY, 0), join)) {
            *to = from;
        }
        for (border, below) in (1..).zip(slices[..BINS - 1].iter().scan((Bounds::EMPTY, 0), join)) {
            let total = cost(below) + cost(above[border]);
            if below.1 > 0 && above[border].1 > 0 && total < best.0 {
                best = (total, Some((axis, border, bins)));
            }
        }
    }
    best.1
}

/// Moves what is `first` to the front and returns how many these are.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..items.len() {
        if first(&items[i]) {
            items.swap(i, middle);
            middle += 1;
        }
    }
    middle
}
