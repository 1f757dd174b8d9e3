//! A node of the light tree: bounds of up to eight groups of lights, whose importances are evaluated together.

use super::bounds::{Group, LightBounds, cos_of_sum, sine};
use glam::Vec3;

/// Groups of a node.
pub const WIDTH: usize = 8;

/// One number per group.
type Lanes = [f32; WIDTH];

/// What is below a group: a node, or a light, which has the highest bit set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Child(u32);

impl Child {
    const LIGHT: u32 = 1 << 31;

    pub fn node(index: usize) -> Self {
        Self(index as u32)
    }

    pub fn light(index: u32) -> Self {
        Self(index | Self::LIGHT)
    }

    /// The index of the light, or else of the node.
    #[inline(always)]
    pub fn index(self) -> Result<usize, usize> {
        let index = (self.0 & !Self::LIGHT) as usize;
        if self.0 & Self::LIGHT == 0 { Err(index) } else { Ok(index) }
    }
}

/// Bounds of up to eight groups of lights.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub struct Node {
    /// Bounding spheres.
    centre: [Lanes; 3],
    radius: Lanes,
    /// Cones of normals, as in [`LightBounds`].
    axis: [Lanes; 3],
    cos_o: Lanes,
    sin_o: Lanes,
    /// Negative (−0 for 0) where the backs emit, too.
    cos_e: Lanes,
    /// Intensity over the greatest one in the node; 0 for groups that do not exist.
    weight: Lanes,
    pub children: [Child; WIDTH],
}

/// More than the rounding errors of a cosine here, so that no light is taken for invisible because of them.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// The least radius, whose square is a normal number.
const LEAST_RADIUS: f32 = 1e-18;

/// The greater of two numbers that are not NaN: one instruction, which `f32::max` is not.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The square root, or 0 of a negative number.
#[inline(always)]
fn root(x: f32) -> f32 {
    max(x, 0.0).sqrt()
}

impl Node {
    pub const EMPTY: Self = Self {
        centre: [[0.0; WIDTH]; 3],
        radius: [0.0; WIDTH],
        axis: [[0.0; WIDTH]; 3],
        cos_o: [1.0; WIDTH],
        sin_o: [0.0; WIDTH],
        cos_e: [0.0; WIDTH],
        weight: [0.0; WIDTH],
        children: [Child(0); WIDTH],
    };

    /// Sets group `i` to the bounds of lights whose [`Group`] is `group`; `greatest` is the intensity of the node's
    /// strongest one.
    pub fn set(&mut self, i: usize, group: &Group, greatest: f64, lights: impl Iterator<Item = LightBounds>) {
        let (centre, axis) = (0.5 * group.min + 0.5 * group.max, group.axis());
        let (mut cos_o, mut cos_e, mut two_sided) = (1f32, 1f32, false);
        for light in lights {
            cos_o = cos_o.min(cos_of_sum(axis.dot(light.axis).clamp(-1.0, 1.0), light.cos_o));
            cos_e = cos_e.min(light.cos_e);
            two_sided |= light.two_sided;
        }
        for (k, lanes) in self.centre.iter_mut().enumerate() {
            lanes[i] = centre[k];
        }
        for (k, lanes) in self.axis.iter_mut().enumerate() {
            lanes[i] = axis[k];
        }
        // The corner farthest from the centre, which is rounded.
        let radius = (centre - group.min).max(group.max - centre).length();
        self.radius[i] = (radius * (1.0 + ROUNDING)).max(LEAST_RADIUS);
        let cos_o = (cos_o - ROUNDING).max(-1.0);
        (self.cos_o[i], self.sin_o[i]) = (cos_o, sine(cos_o));
        self.cos_e[i] = if two_sided { -cos_e } else { cos_e };
        self.weight[i] = ((group.intensity / greatest) as f32).max(f32::MIN_POSITIVE);
    }

    /// The importances of the groups at a point with this normal, from whose side alone light matters.
    ///
    /// Source: Conty Estevez & Kulla 2018, section 4.2: intensity over squared distance, times the greatest cosines on
    /// either end that the bounds allow. It is 0 only where the bounds exclude that light arrives.
    #[inline(always)]
    pub fn importances(&self, point: Vec3, normal: Option<Vec3>) -> Importances {
        // Without a normal, every direction counts as the normal.
        let (normal, least_cos_i) = normal.map_or((Vec3::ZERO, 1.0), |normal| (normal, 0.0));
        let mut importances = [0.0; WIDTH];
        for i in 0..WIDTH {
            let (x, y, z) = (point.x - self.centre[0][i], point.y - self.centre[1][i], point.z - self.centre[2][i]);
            let d2 = max(x * x + y * y + z * z, LEAST_RADIUS * LEAST_RADIUS);
            let margin = ROUNDING * (x.abs() + y.abs() + z.abs());
            // Cosines and sines are multiplied by the distance d or, after a difference, by d². First, half the angle
            // that the bounding sphere subtends.
            let radius = self.radius[i];
            let (cos_b, is_inside) = (root(d2 - radius * radius), radius * radius >= d2);
            // Angle between the axis and the direction from the group to the point, minus the cone of normals.
            let along = x * self.axis[0][i] + y * self.axis[1][i] + z * self.axis[2][i];
            let cos_w = max(along, along * 1f32.copysign(self.cos_e[i])) + margin;
            let sin_w = root(d2 - cos_w * cos_w);
            let cos_x = cos_w * self.cos_o[i] + sin_w * self.sin_o[i];
            let sin_x = sin_w * self.cos_o[i] - cos_w * self.sin_o[i];
            // Least angle between a normal of the group and a direction from the group to the point.
            let is_zero = is_inside | (sin_x <= 0.0) | (sin_x * cos_b <= cos_x * radius);
            let cos_l = if is_zero { d2 } else { cos_x * cos_b + sin_x * radius };
            // Least angle at the point.
            let cos_c = margin - (x * normal.x + y * normal.y + z * normal.z);
            let sin_c = root(d2 - cos_c * cos_c);
            let is_zero = is_inside | (sin_c * cos_b <= cos_c * radius);
            let cos_i = if is_zero { d2 } else { cos_c * cos_b + sin_c * radius };
            let scale = 1.0 / d2;
            let (cos_l, cos_i) = (cos_l * scale + ROUNDING, max(cos_i * scale + ROUNDING, least_cos_i));
            // 1/d² is limited to its mean over the volume of the bounding sphere, seen from the centre: 3/r².
            let importance = self.weight[i] * cos_l * cos_i / max(d2, radius * radius * (1.0 / 3.0));
            let can_arrive = (cos_l > self.cos_e[i].abs()) & (cos_i > 0.0) & (self.weight[i] > 0.0);
            importances[i] = if can_arrive { max(importance, f32::MIN_POSITIVE) } else { 0.0 };
        }
        Importances(importances)
    }
}

/// Random numbers have 24 bits, so that 0 stands for all of \[0, 2⁻²⁴). The middle of that interval replaces it:
/// otherwise 0 would select the first group however improbable it is.
const LEAST: f32 = 1.0 / (1 << 25) as f32;

/// Importances of a node's groups at a point.
#[derive(Debug, Clone, Copy)]
pub struct Importances(Lanes);

impl Importances {
    /// Sums of the first 0, 1, … 8 importances. They do not decrease, and two neighbours are equal if the importance
    /// between is 0.
    #[inline(always)]
    fn sums(&self) -> [f32; WIDTH + 1] {
        let a = &self.0;
        let (a01, a23, a45, a67) = (a[0] + a[1], a[2] + a[3], a[4] + a[5], a[6] + a[7]);
        let a03 = a01 + a23;
        [0.0, a[0], a01, a01 + a[2], a03, a03 + a[4], a03 + a45, a03 + (a45 + a[6]), a03 + (a45 + a67)]
    }

    /// A group, its share of the sum, and a new random number: the position of `u` inside the group. `None` if all
    /// importances are 0.
    #[inline(always)]
    pub fn sample(&self, u: f32) -> Option<(usize, f32, f32)> {
        let sums = self.sums();
        let total = sums[WIDTH];
        if total <= 0.0 {
            return None;
        }
        // The group whose share of the sum contains u; one of importance 0 has none.
        let at = (u.max(LEAST) * total).min(total.next_down());
        let mut i = 0;
        for upper in &sums[1..WIDTH] {
            i += usize::from(at >= *upper);
        }
        Some((i, self.0[i] / total, (at - sums[i]) / self.0[i]))
    }

    /// The share of a group; `None` if its importance is 0.
    #[inline(always)]
    pub fn share(&self, i: usize) -> Option<f32> {
        (self.0[i] > 0.0).then(|| self.0[i] / self.sums()[WIDTH])
    }
}
