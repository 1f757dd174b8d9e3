//! Microfacet normals, sampled by the full distribution (NDF) or as visible from a direction (VNDF), each with its pdf per
//! solid angle of the normal.

mod slope;

use crate::math::circular::sin_cos_turns;
use crate::math::{Real, map_array};
use crate::optics::microfacet::{Beckmann, Ggx, Microfacet, Widths};

/// A distribution that normals can be sampled from: `u` is in \[0, 1)²; normals are unit vectors with z ≥ 0.
pub trait SampleNormals<T: Real>: Microfacet<T> {
    /// A normal with pdf D(m) cos θₘ: the full distribution of normals (NDF).
    fn sample_ndf(&self, u: [T; 2]) -> [T; 3];

    /// A normal with pdf D(m) max(0, wo·m) G₁(wo)/cos θₒ: the distribution of visible normals (VNDF), which has z ≥ 0.
    ///
    /// Every normal sampled faces `wo`, and the weight of a reflection is F G₂/G₁ ≤ 1.
    fn sample_vndf(&self, wo: [T; 3], u: [T; 2]) -> [T; 3];

    /// A normal visible from `wo`, zₒ > 0, by a distribution that leaves out normals whose reflections end below the surface,
    /// as far as that is known for the distribution. The pdf of the reflected direction is D(m)/4 times
    /// [`bounded_over_cos`](Self::bounded_over_cos).
    #[inline(always)]
    fn sample_bounded(&self, wo: [T; 3], u: [T; 2]) -> [T; 3] {
        self.sample_vndf(wo, u)
    }

    /// What takes the place of G₁(wo)/cos θₒ in the pdf of directions that normals of
    /// [`sample_bounded`](Self::sample_bounded) reflect to.
    #[inline(always)]
    fn bounded_over_cos(&self, wo: [T; 3]) -> T {
        self.g1_over_cos(wo)
    }

    #[inline(always)]
    fn pdf_ndf(&self, wm: [T; 3]) -> T {
        self.d(wm) * wm[2]
    }

    #[inline(always)]
    fn pdf_vndf(&self, wo: [T; 3], wm: [T; 3]) -> T {
        let facing = wo[0] * wm[0] + wo[1] * wm[1] + wo[2] * wm[2];
        self.d(wm) * facing.max(T::zero()) * self.g1_over_cos(wo)
    }
}

impl<T: Real> SampleNormals<T> for Beckmann<T> {
    #[inline(always)]
    fn sample_ndf(&self, u: [T; 2]) -> [T; 3] {
        let alpha = self.widths().along_x().to_f64();
        // Invert the distribution of tan² θ, 1 − exp(−tan²/α²). 1 − u is exact in f64; the bound avoids the logarithm of 0.
        polar_normal(self.widths(), -alpha * alpha * (1.0 - u[0].to_f64()).max(slope::LEAST).ln(), u[1])
    }

    /// Slopes of the surface stretched to α = 1 are independent along and across `wo`: the one across is normally
    /// distributed, the one along `wo` weighted by its visibility. Source: Heitz & d'Eon, "Importance Sampling
    /// Microfacet-Based BSDFs using the Distribution of Visible Normals", EGSR 2014.
    #[inline(always)]
    fn sample_vndf(&self, wo: [T; 3], u: [T; 2]) -> [T; 3] {
        // Stretch y, rotate to the azimuth of `wo`, and sample the slopes of the stretched surface.
        let (widths, alpha) = (self.widths(), self.widths().along_x().to_f64());
        let [x, y, z] = map_array(wo, Real::to_f64);
        let y = widths.stretch(y);
        let sin = (x * x + y * y).sqrt();
        let (cos_phi, sin_phi) = if sin > 0.0 { (x / sin, y / sin) } else { (1.0, 0.0) };
        let along = alpha * slope::visible(z, alpha * sin, u[0].to_f64());
        let across = alpha * slope::gaussian(u[1]).to_f64();
        // Rotate back, stretch y back, and turn slopes into a normal.
        let (sx, sy) = (along * cos_phi - across * sin_phi, widths.stretch(along * sin_phi + across * cos_phi));
        let inverse = 1.0 / (sx * sx + sy * sy + 1.0).sqrt();
        [T::from_f64(-sx * inverse), T::from_f64(-sy * inverse), T::from_f64(inverse)]
    }
}

impl<T: Real> SampleNormals<T> for Ggx<T> {
    #[inline(always)]
    fn sample_ndf(&self, u: [T; 2]) -> [T; 3] {
        // Invert the distribution of tan² θ, tan²/(α² + tan²).
        let (alpha, u0) = (self.widths().along_x().to_f64(), u[0].to_f64());
        polar_normal(self.widths(), alpha * alpha * u0 / (1.0 - u0).max(slope::LEAST), u[1])
    }

    #[inline(always)]
    fn sample_vndf(&self, wo: [T; 3], u: [T; 2]) -> [T; 3] {
        self.sample_cap(wo, T::one(), T::zero(), u)
    }

    #[inline(always)]
    fn sample_bounded(&self, wo: [T; 3], u: [T; 2]) -> [T; 3] {
        let (k, rest) = self.bound(wo);
        self.sample_cap(wo, k, rest, u)
    }

    /// 2/(k zₒ + t), t the length of the stretched `wo`; for k = 1 it is G₁(wo)/zₒ.
    #[inline(always)]
    fn bounded_over_cos(&self, wo: [T; 3]) -> T {
        let two = T::one() + T::one();
        let z = wo[2].abs();
        let slope2 = self.widths().along_x() * self.widths().along_x() * self.view2(wo);
        two / (self.bound(wo).0 * z + (z * z + slope2).sqrt())
    }
}

impl<T: Real> Ggx<T> {
    /// A normal by a point of the spherical cap that reflects towards `wo` on the surface stretched to α = 1.
    ///
    /// Let v be the stretched `wo` and h = c + v for a point c of the cap z ≥ −k v_z, k = 1 for all visible normals; `rest` is
    /// 1 − k. Then 1 − c_z = u (1 + k v_z) is sampled, and both sin θ_c and h_z follow from it without cancellation. Source:
    /// Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
    #[inline(always)]
    fn sample_cap(&self, wo: [T; 3], k: T, rest: T, u: [T; 2]) -> [T; 3] {
        let one = T::one();
        // Stretch `wo` to the hemisphere configuration.
        let (widths, alpha) = (self.widths(), self.widths().along_x());
        let v = normalize([alpha * wo[0], alpha * widths.stretch(wo[1]), wo[2]]);
        // Sample a point of the spherical cap, and add v to it.
        let (sin_phi, cos_phi) = sin_cos_turns(u[1].to_f64());
        let below_pole = u[0] * (one + k * v[2]);
        let sin = (below_pole * (one + one - below_pole)).max(T::zero()).sqrt();
        let x = sin * T::from_f64(cos_phi) + v[0];
        let y = sin * T::from_f64(sin_phi) + v[1];
        let z = (one - u[0]) * (one + v[2]) + u[0] * (v[2] * rest);
        // Unstretch the normal.
        normalize([alpha * x, alpha * widths.stretch(y), z])
    }

    /// k and 1 − k for the cap z ≥ −k v_z: the rest of the visible normals reflects `wo` to below the surface.
    ///
    /// With a = min(αx, αy, 1), s = 1 + sin θₒ: k = (1 − a²) s² / (s² + a² zₒ²). Source: Eto & Tokuyoshi, "Bounded VNDF
    /// Sampling for Smith-GGX Reflections", SIGGRAPH Asia 2023.
    #[inline(always)]
    fn bound(&self, wo: [T; 3]) -> (T, T) {
        let one = T::one();
        let [x, y] = self.widths().both();
        let a = x.min(y).min(one);
        let s = one + (wo[0] * wo[0] + wo[1] * wo[1]).sqrt();
        let (s2, az) = (s * s, a * wo[2]);
        let whole = s2 + az * az;
        ((one - a) * (one + a) * s2 / whole, a * a * (s2 + wo[2] * wo[2]) / whole)
    }
}

/// The normal that has that tan² θ on the isotropic surface, at an azimuth of `turns` · 2π there.
#[inline(always)]
fn polar_normal<T: Real>(widths: Widths<T>, tan2: f64, turns: T) -> [T; 3] {
    let (sin_phi, cos_phi) = sin_cos_turns(turns.to_f64());
    // tan² of the stretched slopes, such that an isotropic surface adds 0.
    let stretched = widths.stretch(sin_phi);
    let tan2_stretched = tan2 + tan2 * (stretched - sin_phi) * (stretched + sin_phi);
    let cos = 1.0 / (1.0 + tan2_stretched).sqrt();
    let sin = tan2.sqrt() * cos;
    [T::from_f64(sin * cos_phi), T::from_f64(sin * stretched), T::from_f64(cos)]
}

#[inline(always)]
fn normalize<T: Real>(w: [T; 3]) -> [T; 3] {
    let inverse = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt().recip();
    map_array(w, |x| x * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampled_normals_invert_their_distribution() {
        // The share of normals up to tan θ is 1 − exp(−tan²/α²) for Beckmann, tan²/(α² + tan²) for GGX.
        for u in [0.0, 0.1, 0.5, 0.999] {
            let tan2 = |w: [f64; 3]| (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2]);
            let (beckmann, ggx) = (Beckmann::new(0.3).sample_ndf([u, 0.2]), Ggx::new(0.3).sample_ndf([u, 0.2]));
            assert!((1.0 - (-tan2(beckmann) / 0.09).exp() - u).abs() < 1e-14);
            assert!((tan2(ggx) / (0.09 + tan2(ggx)) - u).abs() < 1e-14);
            let narrow = [u as f32, 0.2];
            for (double, single) in
                [(beckmann, Beckmann::new(0.3).sample_ndf(narrow)), (ggx, Ggx::new(0.3).sample_ndf(narrow))]
            {
                assert!((0..3).all(|i| (double[i] - f64::from(single[i])).abs() < 1e-5), "{double:?} {single:?}");
            }
        }
    }
}
