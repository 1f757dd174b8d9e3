//! The geometry of lat-long maps: which texel belongs to which direction.
//!
//! Row 0 is the zenith (+y) and texel centres lie at +½. With v = y/H and u = x/W:
//!
//! * θ = π v, measured from +y;
//! * φ = 2π u with direction (sin θ cos φ, cos θ, sin θ sin φ): u = 0 looks along +x, ¼ along +z, ½ along −x, ¾ along −z.
//!
//! A texel is the region between its edges in θ and φ, and its radiance is constant there, so a row's solid angle is exact:
//! (cos θ₀ − cos θ₁) Δφ.

use crate::math::circular::{Circular, sin_cos_turns, turns};
use glam::DVec3;
use std::f64::consts::PI;

/// The geometry of a map of a given size.
#[derive(Debug, Clone)]
pub struct LatLong {
    width: usize,
    per_width: f64,
    rows: Vec<Row>,
}

/// One row of texels, written from its nearer pole so that nothing cancels at either: cos θ = pole · (1 − w),
/// where w goes from `start` to `start + extent` as θ grows.
#[derive(Debug, Clone, Copy)]
struct Row {
    start: f64,
    extent: f64,
    pole: f64,
    /// Solid angle of one texel, in steradian.
    solid_angle: f64,
    inverse_solid_angle: f64,
}

impl LatLong {
    /// The geometry of a map of `width` × `height` texels, at least one each.
    pub fn new(width: usize, height: usize) -> Self {
        let row = |y: usize| {
            let (t0, t1) = (PI * y as f64 / height as f64, PI * (y + 1) as f64 / height as f64);
            // cos t0 − cos t1 without the subtraction.
            let extent = 2.0 * libm::sin(0.5 * (t0 + t1)) * libm::sin(0.5 * (t1 - t0));
            let solid_angle = extent * 2.0 * PI / width as f64;
            let north = 2 * y < height;
            let half = if north { libm::sin(0.5 * t0) } else { libm::cos(0.5 * t0) };
            let (pole, extent) = if north { (1.0, extent) } else { (-1.0, -extent) };
            Row { start: 2.0 * half * half, extent, pole, solid_angle, inverse_solid_angle: 1.0 / solid_angle }
        };
        Self { width, per_width: 1.0 / width as f64, rows: (0..height).map(row).collect() }
    }

    #[inline]
    pub fn width(&self) -> usize {
        self.width
    }

    #[inline]
    pub fn height(&self) -> usize {
        self.rows.len()
    }

    /// Solid angle of a texel in row `y`, in steradian.
    #[inline]
    pub fn solid_angle(&self, y: usize) -> f64 {
        self.rows[y].solid_angle
    }

    /// One over [`LatLong::solid_angle`].
    #[inline]
    pub fn inverse_solid_angle(&self, y: usize) -> f64 {
        self.rows[y].inverse_solid_angle
    }

    /// The direction at `fx`, `fy` in (0, 1) inside texel (x, y); `fy` is uniform in solid angle, that is in cos θ.
    #[inline]
    pub fn direction_in_texel(&self, x: usize, y: usize, fx: f64, fy: f64) -> DVec3 {
        let row = &self.rows[y];
        direction((x as f64 + fx) * self.per_width, row.start + fy * row.extent, row.pole)
    }

    /// The inverse of [`LatLong::direction_in_texel`]: (x, y, fx, fy).
    pub fn texel_position(&self, direction: DVec3) -> (usize, usize, f64, f64) {
        let (px, _) = self.position(direction);
        let (x, y) = self.texel(direction);
        let row = &self.rows[y];
        let sin2 = direction.x * direction.x + direction.z * direction.z;
        // 1 − |cos θ| = sin² θ / (1 + |cos θ|); beyond the equator w is 2 minus that.
        let near = sin2 / (1.0 + direction.y.abs());
        let w = if direction.y * row.pole >= 0.0 { near } else { 2.0 - near };
        (x, y, (px - x as f64).clamp(0.0, 1.0), ((w - row.start) / row.extent).clamp(0.0, 1.0))
    }

    /// ∫ ω dω over texel (x, y), in closed form:
    /// ∫ sin²θ dθ · ∫ (cos φ, sin φ) dφ across, ∫ sin θ cos θ dθ · Δφ along the axis.
    pub fn moment(&self, x: usize, y: usize) -> DVec3 {
        let ([across, along], [cos_phi, sin_phi]) = (self.row_moment(y), self.column_axis(x));
        DVec3::new(across * cos_phi, along, across * sin_phi)
    }

    /// The factors of [`LatLong::moment`] that the texels of row `y` share: of the columns' axes, and along +y.
    pub fn row_moment(&self, y: usize) -> [f64; 2] {
        let half_theta = 0.5 * PI / self.height() as f64;
        let half_phi = PI / self.width as f64;
        let middle = half_theta * (2 * y + 1) as f64;
        // Differences of sines between the edges are written as products.
        let across = half_theta - 0.5 * (2.0 * middle).cos() * (2.0 * half_theta).sin();
        let along = 0.5 * (2.0 * middle).sin() * (2.0 * half_theta).sin();
        [across * 2.0 * half_phi.sin(), along * 2.0 * half_phi]
    }

    /// Cosine and sine of the middle φ of column `x`.
    pub fn column_axis(&self, x: usize) -> [f64; 2] {
        let (sin_phi, cos_phi) = (PI / self.width as f64 * (2 * x + 1) as f64).sin_cos();
        [cos_phi, sin_phi]
    }

    /// A bounding cone of a block: its middle direction and the largest angle to it, or π where that may exceed 90°.
    ///
    /// With θₘ, φₘ the middle, cos d = cos θ cos θₘ + sin θ sin θₘ cos(φ − φₘ) falls with |φ − φₘ| up to 180°, and as
    /// a function of θ it is concave wherever it is positive. So within 90° of the middle the corners are farthest.
    pub fn cone(&self, Block { x0, y0, x1, y1 }: Block) -> (DVec3, f64) {
        let axis = self.direction(0.5 * (x0 + x1) as f64, 0.5 * (y0 + y1) as f64);
        let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)];
        let angle = |(x, y): (usize, usize)| axis.angle_between(self.direction(x as f64, y as f64));
        let reach = corners.into_iter().map(angle).fold(0.0, f64::max);
        let narrow = 2 * (x1 - x0) <= self.width && reach < 0.49 * PI;
        (axis, if narrow { reach * (1.0 + 1e-9) + 1e-12 } else { PI })
    }

    /// The direction at the continuous map position (x, y), in texels from the top left corner.
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        let (sin_theta, cos_theta) = (PI * y / self.height() as f64).sin_cos();
        let (sin_phi, cos_phi) = (2.0 * PI * x / self.width as f64).sin_cos();
        DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi)
    }

    /// The continuous map position of a direction (any length but 0): x in \[0, W), y in \[0, H\].
    #[inline]
    pub fn position(&self, d: DVec3) -> (f64, f64) {
        let theta = d.x.hypot(d.z).atan2(d.y);
        (turns(d.z, d.x) * self.width as f64, theta / PI * self.height() as f64)
    }

    /// The edges between rows and between columns in the chart of directions about +y, where areas are solid angles:
    /// those of rows as (1 − cos θ)/2, those of columns as turns from +z towards +x, the other way round than φ. Both
    /// ascend, strictly between 0 and 1.
    pub fn edges(&self) -> [Vec<f64>; 2] {
        let (width, height) = (self.width, self.height());
        let rows = (1..height).map(|y| (0.5 * PI * (y as f64 / height as f64)).sin().powi(2));
        // Column x starts at ¼ − x/W turns; the least of these that is not negative is (W mod 4)/4W.
        let columns = (0..width).map(|i| (4 * i + width % 4) as f64 / (4 * width) as f64);
        [rows.collect(), columns.filter(|turns| *turns > 0.0).collect()]
    }

    /// The texel that a direction falls into.
    #[inline]
    pub fn texel(&self, direction: DVec3) -> (usize, usize) {
        // Single precision, which errs by less than 10⁻⁶ of a turn, tells the texel unless an edge is as close.
        let d = direction.as_vec3();
        let half = f32::angle(d.z.abs(), d.x) * (0.5 / std::f32::consts::PI);
        let turns = if d.z < 0.0 { 1.0 - half } else { half };
        let theta = f32::angle((d.x * d.x + d.z * d.z).sqrt(), d.y) * (1.0 / std::f32::consts::PI);
        let (width, height) = (self.width as f32, self.height() as f32);
        let (x, y) = (turns * width, theta * height);
        let is_inside = |x: f32, margin: f32| (x - x.floor() - 0.5).abs() < 0.5 - margin;
        if is_inside(x, 1e-6 * width) && is_inside(y, 1e-6 * height) {
            return ((x as usize).min(self.width - 1), (y as usize).min(self.height() - 1));
        }
        self.texel_in_double_precision(direction)
    }

    #[cold]
    fn texel_in_double_precision(&self, direction: DVec3) -> (usize, usize) {
        let (x, y) = self.position(direction);
        ((x as usize).min(self.width - 1), (y as usize).min(self.height() - 1))
    }
}

/// A block of texels, \[x0, x1) × \[y0, y1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Block {
    pub x0: usize,
    pub y0: usize,
    /// Column after the last.
    pub x1: usize,
    /// Row after the last.
    pub y1: usize,
}

/// The direction at φ = 2π `turns` and cos θ = `pole` (1 − `w`).
#[inline(always)]
fn direction(turns: f64, w: f64, pole: f64) -> DVec3 {
    let sin_theta = (w * (2.0 - w)).max(0.0).sqrt();
    let (sin_phi, cos_phi) = sin_cos_turns(turns);
    DVec3::new(sin_theta * cos_phi, pole * (1.0 - w), sin_theta * sin_phi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_where_the_convention_says() {
        let g = LatLong::new(8, 4);
        for (d, x, y) in [
            (DVec3::X, 0.0, 2.0),
            (DVec3::Z, 2.0, 2.0),
            (DVec3::NEG_X, 4.0, 2.0),
            (DVec3::NEG_Z, 6.0, 2.0),
            (DVec3::Y, 0.0, 0.0),
            (DVec3::NEG_Y, 0.0, 4.0),
        ] {
            assert_eq!(g.position(d), (x, y));
        }
        assert_eq!(g.texel(DVec3::NEG_Y), (0, 3), "the nadir belongs to the last row");
    }

    #[test]
    fn solid_angles_add_up_to_the_sphere() {
        for (w, h) in [(1, 1), (2, 1), (3, 2), (1024, 512), (7, 1001)] {
            let g = LatLong::new(w, h);
            let sum: f64 = (0..h).map(|y| g.solid_angle(y) * w as f64).sum();
            assert!((sum - 4.0 * PI).abs() < 1e-12, "{w}x{h}: {sum}");
        }
    }

    #[test]
    fn directions_round_trip_to_the_borders_and_the_poles() {
        for (w, h) in [(1, 1), (2, 1), (3, 2), (1024, 512), (8192, 4096)] {
            let g = LatLong::new(w, h);
            let texels = [0, 1.min(h - 1), h / 2, h - 1].into_iter().flat_map(|y| [0, w / 3, w - 1].map(|x| (x, y)));
            let ends = [1e-9, 0.25, 0.5, 1.0 - 1e-9];
            for ((x, y), (fx, fy)) in
                texels.flat_map(|at| ends.iter().flat_map(move |&fx| ends.map(|fy| (at, (fx, fy)))))
            {
                let d = g.direction_in_texel(x, y, fx, fy);
                assert!((d.length() - 1.0).abs() < 1e-15);
                let (bx, by, bfx, bfy) = g.texel_position(d);
                assert_eq!((bx, by), (x, y), "{w}x{h} texel {x},{y} at {fx},{fy}");
                assert!((bfx - fx).abs() < 1e-8 && (bfy - fy).abs() < 1e-8, "{fx} {fy} came back {bfx} {bfy}");
            }
        }
    }

    #[test]
    fn single_precision_finds_the_texels_of_double_precision() {
        for (w, h) in [(1, 1), (3, 2), (1024, 512), (16_384, 8192)] {
            let g = LatLong::new(w, h);
            for i in 0..200_000 {
                let (u, v) = ((f64::from(i) * 0.618_033_988_749).fract(), (f64::from(i) + 0.5) / 200_000.0);
                let d = direction(u, 2.0 * v, 1.0);
                assert_eq!(g.texel(d), g.texel_in_double_precision(d), "{w}x{h} {d}");
            }
            // Any length will do.
            for length in [1e-300, 1e-30, 1e-20, 1e20, 1e30, 1e300] {
                let d = length * DVec3::new(0.48, -0.6, 0.64);
                assert_eq!(g.texel(d), g.texel_in_double_precision(d), "{w}x{h} {length}");
            }
        }
    }

    #[test]
    fn edges_are_where_the_texels_end() {
        for (w, h) in [(1, 1), (2, 1), (3, 2), (10, 10), (20, 8), (7, 5), (1024, 512)] {
            let g = LatLong::new(w, h);
            let [rows, columns] = g.edges();
            let below = |y: usize| 0.5 * (1.0 - g.direction(0.0, y as f64).y);
            let mut around: Vec<f64> = (0..w)
                .map(|x| g.direction(x as f64, 0.5 * h as f64))
                .map(|d| (d.x.atan2(d.z) / (2.0 * PI) + 1.0 + 1e-12).fract())
                .collect();
            around.sort_by(f64::total_cmp);
            around.retain(|turns| *turns > 1e-9);
            let close =
                |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-11);
            assert!(close(&rows, &(1..h).map(below).collect::<Vec<_>>()), "{w}x{h}: {rows:?}");
            assert!(close(&columns, &around), "{w}x{h}: {columns:?} and {around:?}");
        }
    }
}
