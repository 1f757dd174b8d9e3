//! What a map holds: size, range, mean, flux, contrast, and how concentrated its light is.

use super::map::EnvMap;
use crate::math::mean_rgb;
use glam::DVec3;
use serde::Serialize;

/// Statistics of a map. mean_rgb is (R + G + B)/3; sums run over the cleaned texels in f64.
#[derive(Debug, Clone, Serialize)]
pub struct Info {
    /// Texels in a row.
    pub width: usize,
    pub height: usize,
    /// Smallest finite channel value, as stored; `None` when there is none.
    pub min: Option<f32>,
    /// Largest finite channel value, as stored.
    pub max: Option<f32>,
    pub mean_rgb: [f64; 3],
    /// Mean over the sphere.
    pub solid_angle_mean_rgb: [f64; 3],
    /// ∫ L dω over the sphere, the radiance unit times steradian.
    pub flux_rgb: [f64; 3],
    /// Texels with a NaN or infinite channel (taken as 0).
    pub nonfinite: usize,
    /// Texels with a negative channel (taken as 0).
    pub negative: usize,
    /// Largest mean_rgb over its solid-angle mean; 0 for a black map.
    pub peak_to_mean: f64,
    /// (Σ E)² / Σ E² over the texels' energies E = mean_rgb × solid angle: the number of equally bright texels in
    /// which light would be as concentrated.
    pub effective_texels: f64,
    /// Texel with the largest mean_rgb (the first in reading order).
    pub peak: (usize, usize),
    /// Elevation of that texel's centre above the horizon, degrees.
    pub peak_elevation_deg: f64,
    /// Share of the energy that comes from above the horizon.
    pub upper_share: f64,
    /// Share of the energy within 2° of the brightest texel.
    pub peak_share: f64,
}

impl Info {
    /// The statistics of a map, in one pass over its texels.
    pub fn of(map: &EnvMap) -> Self {
        let g = map.geometry();
        let (width, height) = (g.width(), g.height());
        let (mut sum, mut flux) = (DVec3::ZERO, DVec3::ZERO);
        let (mut energy, mut energy2, mut upper) = (0.0, 0.0, 0.0);
        let (mut peak, mut peak_mean) = ((0, 0), -1.0);
        for y in 0..height {
            let solid_angle = g.solid_angle(y);
            let mut row = DVec3::ZERO;
            for (x, &texel) in map.image().row(y).iter().enumerate() {
                row += texel.as_dvec3();
                let i = mean_rgb(texel);
                let e = i * solid_angle;
                energy2 += e * e;
                if i > peak_mean {
                    (peak, peak_mean) = ((x, y), i);
                }
            }
            let row_energy = row.element_sum() / 3.0 * solid_angle;
            energy += row_energy;
            // The middle row of an odd map is half above the horizon.
            let above = (height as f64 / 2.0 - y as f64).clamp(0.0, 1.0);
            upper += above * row_energy;
            sum += row;
            flux += row * solid_angle;
        }
        let sphere = 4.0 * std::f64::consts::PI;
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 0.0 };
        let finite = |v: f32| v.is_finite().then_some(v);
        Self {
            width,
            height,
            min: finite(map.found().min),
            max: finite(map.found().max),
            mean_rgb: (sum / (width * height) as f64).to_array(),
            solid_angle_mean_rgb: (flux / sphere).to_array(),
            flux_rgb: flux.to_array(),
            nonfinite: map.found().nonfinite,
            negative: map.found().negative,
            peak_to_mean: ratio(peak_mean, energy / sphere),
            effective_texels: ratio(energy * energy, energy2),
            peak,
            peak_elevation_deg: 90.0 - 180.0 * (peak.1 as f64 + 0.5) / height as f64,
            upper_share: ratio(upper, energy),
            peak_share: ratio(energy_near(map, peak, 2f64.to_radians()), energy),
        }
    }

    /// Why this map is probably stored upside-down, if it seems to be.
    ///
    /// Two cases are suspected: an altered copy of the Grace Cathedral probe, by its size, flux and brightest texel, and an
    /// outdoor map whose sun (more than a tenth of all light within 2°) is below the horizon.
    pub fn upside_down(&self) -> Option<String> {
        if self.seems_grace_upside_down() {
            return Some(
                "it has the light of the Grace Cathedral probe, whose windows are above the horizon, below it".into(),
            );
        }
        // On a coarse map a single bright texel need not be the sun.
        (self.height >= 32 && self.peak_share > 0.1 && self.peak_elevation_deg < -5.0).then(|| {
            format!(
                "{:.0} % of the light comes from one spot {:.0}° below the horizon, where no sun stands",
                100.0 * self.peak_share,
                -self.peak_elevation_deg
            )
        })
    }

    fn seems_grace_upside_down(&self) -> bool {
        const FLUX: [f64; 3] = [0.281_32, 0.155_77, 0.192_89];
        let close = self.flux_rgb.iter().zip(FLUX).all(|(a, b)| (a / b - 1.0).abs() < 1e-3);
        close && (self.width, self.height, self.peak) == (1024, 512, (502, 382))
    }
}

/// Energy of the texels whose centres lie within `radius` of a texel's centre.
fn energy_near(map: &EnvMap, (x, y): (usize, usize), radius: f64) -> f64 {
    let g = map.geometry();
    let centre = g.direction_in_texel(x, y, 0.5, 0.5);
    let reach = (radius / std::f64::consts::PI * g.height() as f64).ceil() as usize;
    let cos_radius = radius.cos();
    let mut energy = 0.0;
    for y in y.saturating_sub(reach)..(y + reach + 1).min(g.height()) {
        for x in 0..g.width() {
            if g.direction_in_texel(x, y, 0.5, 0.5).dot(centre) >= cos_radius {
                energy += map.energy(x, y);
            }
        }
    }
    energy
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::raster::Image;
    use std::f64::consts::PI;

    #[test]
    fn a_constant_map() {
        let info = Info::of(&EnvMap::new(Image::from_fn(64, 33, |_, _| Rgb::new(1.0, 2.0, 3.0))));
        for (c, expected) in [1.0, 2.0, 3.0].into_iter().enumerate() {
            assert!((info.flux_rgb[c] - 4.0 * PI * expected).abs() < 1e-10);
            assert!((info.solid_angle_mean_rgb[c] - expected).abs() < 1e-12);
            assert!((info.mean_rgb[c] - expected).abs() < 1e-12);
        }
        assert!((info.peak_to_mean - 1.0).abs() < 1e-12);
        assert!((info.upper_share - 0.5).abs() < 1e-12);
        assert_eq!((info.min, info.max), (Some(1.0), Some(3.0)));
        assert_eq!(info.upside_down(), None);
    }

    #[test]
    fn one_bright_texel() {
        let sun = |x, y| if (x, y) == (5, 20) { Rgb::ONE } else { Rgb::ZERO };
        let info = Info::of(&EnvMap::new(Image::from_fn(64, 32, sun)));
        assert_eq!(info.peak, (5, 20));
        assert!((info.effective_texels - 1.0).abs() < 1e-12);
        assert!(info.upside_down().unwrap().contains("below the horizon"));
    }

    #[test]
    fn black_maps_and_maps_of_nothing_finite_have_statistics() {
        let black = Info::of(&EnvMap::new(Image::new(2, 1)));
        assert_eq!((black.peak_to_mean, black.effective_texels, black.upper_share), (0.0, 0.0, 0.0));
        let nan = Info::of(&EnvMap::new(Image::from_pixels(1, 1, vec![Rgb::NAN])));
        assert_eq!((nan.min, nan.max, nan.nonfinite), (None, None, 1));
    }
}
