//! Errata: formulas that the two course reports print or their renderers compute wrongly, to show what the mistakes do.
//!
//! Nothing that renders uses them unless [`Conventions`] asks for it: tone mapping, environment maps, BSDFs and the renderer take
//! that struct as a parameter, and [`Conventions::CORRECT`] is its default. Here are only the formulas: scalars in, scalars
//! out, each beside what is right and the size of the error.

pub mod fresnel;
pub mod maps;
pub mod microfacet;
pub mod reflection;
pub mod refraction;
pub mod tone;

/// Which of the reports' conventions to follow: each `true` is a departure from the correct formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Conventions {
    /// Environment map: row h of H has the weight [`maps::row_weight`], 0 at both poles.
    pub rows_without_poles: bool,
    /// Environment map: a sampled texel stands for the direction of its upper left corner.
    pub texel_corners: bool,
    /// Metal: Fresnel reflectance at the angle of `wi` with the surface's normal instead of the microfacet's.
    ///
    /// Not reciprocal: f(wo, wi) and f(wi, wo) differ by up to 2 % for the blue of silver, 13 % for that of aluminium,
    /// 82 % for copper, 105 % for iron and 148 % for gold (grazing against the least reflective angle).
    pub fresnel_at_normal: bool,
    /// Metal: the approximation [`crate::optics::conductor::fresnel_approximate`], which drops sin² against η² + k²: an error
    /// below 0.007 for gold and copper.
    pub approximate_fresnel: bool,
    /// Metal: [`microfacet::lambda_with_pi`] in the shadowing term, which may then exceed 1.
    pub lambda_with_pi: bool,
    /// Glass: [`fresnel::schlick_incident_cosine`], of the cosine on `wo`'s side, dense or not, and 1 under total internal
    /// reflection.
    pub single_cosine_schlick: bool,
    /// 8-bit images: [`tone::encode`].
    pub truncated_tone: bool,
}

impl Conventions {
    /// The correct formulas.
    pub const CORRECT: Self = Self {
        rows_without_poles: false,
        texel_corners: false,
        fresnel_at_normal: false,
        approximate_fresnel: false,
        lambda_with_pi: false,
        single_cosine_schlick: false,
        truncated_tone: false,
    };

    /// The conventions of the first report (Fresnel curves, environment maps).
    pub const FIRST_REPORT: Self =
        Self { rows_without_poles: true, texel_corners: true, single_cosine_schlick: true, ..Self::CORRECT };

    /// The conventions of the second report (a path tracer).
    pub const SECOND_REPORT: Self = Self {
        fresnel_at_normal: true,
        approximate_fresnel: true,
        lambda_with_pi: true,
        single_cosine_schlick: true,
        truncated_tone: true,
        ..Self::CORRECT
    };

    /// Whether any formula of metal departs from the correct one.
    #[must_use]
    pub fn change_metal(&self) -> bool {
        self.fresnel_at_normal || self.approximate_fresnel || self.lambda_with_pi
    }
}
