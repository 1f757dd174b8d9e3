//! Variants of the microfacet models in f64: what else a BSDF of that name can be, with the words that say so.
//!
//! f = F D G / (4 cos θo cos θi) where light is reflected and (1 − F) D G |wo·wm| |wi·wm| / (cos θo cos θi (wo·wm + η wi·wm)²)
//! where it is refracted. Sources: Walter et al., EGSR 2007, eq. 20 and 21; masking: Heitz, JCGT 3(2), 2014; Schlick, Computer
//! Graphics Forum 13(3), 1994; Karis, "Real Shading in Unreal Engine 4", 2013; Cook & Torrance, 1982; Kelemen & Szirmay-Kalos, 2001.

use etalon_core::optics::microfacet::smith::g1_rational;
use etalon_core::optics::microfacet::{Beckmann, Distribution, Ggx, Microfacet};
use etalon_core::optics::{conductor, dielectric};
use etalon_stats::bsdf::{Direction, Pair};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, PI, SQRT_2};

/// What the facets are made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// A metal of this index of refraction and its imaginary part.
    Metal([f64; 2]),
    /// A metal by Schlick's formula, of this reflectance at normal incidence; if that is not known, it is fitted to the values.
    Schlick(Option<f64>),
    /// A dielectric of this index below the surface over that above.
    Dielectric(f64),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    pub distribution: Distribution,
    pub alpha: [f64; 2],
    pub material: Material,
}

/// Two directions, with the facet between them.
struct Facet {
    wo: Direction,
    wi: Direction,
    wm: Direction,
    /// |wo·wm| and |wi·wm|.
    cos_o: f64,
    cos_i: f64,
    /// The index on the far side of `wo` over that on its side.
    eta: f64,
    reflects: bool,
    /// wo·wm + η wi·wm.
    sum: f64,
}

impl Facet {
    /// The facet that reflects or refracts one direction to the other and faces both.
    fn between([wo, wi]: Pair, material: Material) -> Option<Self> {
        let index = if let Material::Dielectric(eta) = material { eta } else { 1.0 };
        let eta = if wo[2] > 0.0 { index } else { 1.0 / index };
        let (o, i) = (DVec3::from_array(wo), DVec3::from_array(wi));
        let reflects = wo[2] * wi[2] > 0.0;
        let is_possible = match material {
            Material::Dielectric(_) => wo[2] * wi[2] != 0.0,
            _ => wo[2] > 0.0 && wi[2] > 0.0,
        };
        let m = (if reflects { o + i } else { o + eta * i }).normalize();
        let m = if m.z < 0.0 { -m } else { m };
        let (to_wo, to_wi) = (o.dot(m), i.dot(m));
        let faces = to_wo * wo[2] > 0.0 && to_wi * wi[2] > 0.0;
        let (cos_o, cos_i) = (to_wo.abs().min(1.0), to_wi.abs().min(1.0));
        let facet = Self { wo, wi, wm: m.to_array(), cos_o, cos_i, eta, reflects, sum: to_wo + eta * to_wi };
        (is_possible && faces).then_some(facet)
    }
}

/// The distribution of normals of one width, without types.
enum Normals {
    Beckmann(Beckmann<f64>),
    Ggx(Ggx<f64>),
}

impl Normals {
    fn new(distribution: Distribution, alpha: [f64; 2]) -> Self {
        match distribution {
            Distribution::Beckmann => Self::Beckmann(Beckmann::anisotropic(alpha)),
            Distribution::Ggx => Self::Ggx(Ggx::anisotropic(alpha)),
        }
    }

    fn d(&self, wm: Direction) -> f64 {
        match self {
            Self::Beckmann(normals) => normals.d(wm),
            Self::Ggx(normals) => normals.d(wm),
        }
    }

    fn lambda(&self, w: Direction) -> f64 {
        match self {
            Self::Beckmann(normals) => normals.lambda(w),
            Self::Ggx(normals) => normals.lambda(w),
        }
    }

    fn g1(&self, w: Direction) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// α of an isotropic surface; the geometric mean of both otherwise.
    fn width(&self) -> f64 {
        let [x, y] = match self {
            Self::Beckmann(normals) => normals.widths().both(),
            Self::Ggx(normals) => normals.widths().both(),
        };
        (x * y).sqrt()
    }
}

/// Another number in place of each width, in D and in G.
type Width = (&'static str, [fn(f64) -> f64; 2]);

const SAME: fn(f64) -> f64 = |alpha| alpha;
const SQUARE: fn(f64) -> f64 = |alpha| alpha * alpha;
const ROOT: fn(f64) -> f64 = f64::sqrt;
const WIDER: fn(f64) -> f64 = |alpha| SQRT_2 * alpha;
const NARROWER: fn(f64) -> f64 = |alpha| FRAC_1_SQRT_2 * alpha;
const WIDTHS: [Width; 9] = [
    ("", [SAME, SAME]),
    ("α² where α is meant", [SQUARE, SQUARE]),
    ("√α where α is meant", [ROOT, ROOT]),
    ("√2 α where α is meant", [WIDER, WIDER]),
    ("α/√2 where α is meant", [NARROWER, NARROWER]),
    ("α² where α is meant, in the distribution of normals alone", [SQUARE, SAME]),
    ("√α where α is meant, in the distribution of normals alone", [ROOT, SAME]),
    ("α² where α is meant, in masking and shadowing alone", [SAME, SQUARE]),
    ("√α where α is meant, in masking and shadowing alone", [SAME, ROOT]),
];

/// G.
type Masking = (&'static str, fn(&Normals, &Facet) -> f64);

const CORRELATED: Masking = ("masking and shadowing of correlated heights", |normals, facet| {
    1.0 / (1.0 + normals.lambda(facet.wo) + normals.lambda(facet.wi))
});
const SEPARABLE: Masking = ("masking and shadowing as if separable, G₁(wo) G₁(wi)", |normals, facet| {
    normals.g1(facet.wo) * normals.g1(facet.wi)
});
const OTHER_MASKING: [Masking; 10] = [
    ("no masking and shadowing", |_, _| 1.0),
    ("masking of wo alone", |normals, facet| normals.g1(facet.wo)),
    ("shadowing of wi alone", |normals, facet| normals.g1(facet.wi)),
    ("Schlick's masking, k = α/2", |normals, facet| schlick_masking(0.5 * normals.width(), facet)),
    ("Schlick's masking, k = α √(2/π)", |normals, facet| {
        schlick_masking((2.0 / PI).sqrt() * normals.width(), facet)
    }),
    ("Schlick's masking, k = (√α + 1)²/8", |normals, facet| {
        schlick_masking((normals.width().sqrt() + 1.0).powi(2) / 8.0, facet)
    }),
    ("the masking of V-shaped grooves", |_, facet| {
        let groove = 2.0 * facet.wm[2] / facet.cos_o;
        (groove * facet.wo[2].abs()).min(groove * facet.wi[2].abs()).min(1.0)
    }),
    ("masking of correlated heights without roots", |normals, facet| {
        let ([o, i], alpha) = ([facet.wo, facet.wi].map(|w| w[2].abs()), normals.width());
        let visible = |z: f64| z * (1.0 - alpha) + alpha;
        2.0 * o * i / (i * visible(o) + o * visible(i))
    }),
    ("masking G = cos θo cos θi", |_, facet| (facet.wo[2] * facet.wi[2]).abs()),
    ("masking G = cos θo cos θi/(wo·wm)²", |_, facet| (facet.wo[2] * facet.wi[2]).abs() / facet.cos_o.powi(2)),
];
/// Walter's rational fits, which are of Beckmann's distribution.
const RATIONAL: Masking = ("the rational fit of G₁ in G₁(wo) G₁(wi)", |normals, facet| {
    let g1 = |w: Direction| {
        let tan = w[0].hypot(w[1]) / w[2].abs();
        g1_rational(1.0 / (normals.width() * tan))
    };
    g1(facet.wo) * g1(facet.wi)
});

fn schlick_masking(k: f64, facet: &Facet) -> f64 {
    let g1 = |z: f64| z.abs() / (z.abs() * (1.0 - k) + k);
    g1(facet.wo[2]) * g1(facet.wi[2])
}

/// F by which formula, of which cosine.
type Fresnel = (&'static str, Formula, fn(&Facet) -> f64);

#[derive(Clone, Copy, PartialEq)]
enum Formula {
    Exact,
    Schlick,
    /// Schlick's with a power of two in place of (1 − cos)⁵.
    PowerOfTwo,
    One,
}

/// What stands in place of (1 − cos)⁵ in Karis' form of Schlick's formula.
fn power_of_two(cos: f64) -> f64 {
    ((-5.55473 * cos - 6.98316) * cos).exp2()
}

impl Formula {
    /// g of F₀ (1 − g) + g, if the formula has this form.
    fn grazing(self, cos: f64) -> Option<f64> {
        match self {
            Self::Schlick => Some((1.0 - cos).powi(5)),
            Self::PowerOfTwo => Some(power_of_two(cos)),
            Self::Exact | Self::One => None,
        }
    }
}

const FRESNEL: [Fresnel; 7] = [
    ("the exact Fresnel reflectance", Formula::Exact, |facet| facet.cos_o),
    ("Schlick's Fresnel reflectance", Formula::Schlick, |facet| facet.cos_o),
    ("the exact Fresnel reflectance at cos θo in place of wo·wm", Formula::Exact, |facet| facet.wo[2].abs()),
    ("Schlick's Fresnel reflectance at cos θo in place of wo·wm", Formula::Schlick, |facet| facet.wo[2].abs()),
    ("Schlick's Fresnel reflectance at cos θm in place of wo·wm", Formula::Schlick, |facet| facet.wm[2]),
    ("Schlick's Fresnel reflectance with a power of two for (1 - cos)⁵", Formula::PowerOfTwo, |facet| facet.cos_o),
    ("a Fresnel reflectance of 1", Formula::One, |_| 1.0),
];

/// A factor of all values, by the cosines of both directions with the surface.
pub type Factor = (&'static str, fn(Pair, f64) -> f64);

/// What values may be multiplied by, given both directions and the index of the far side of `wo` over that of its side.
pub const FACTORS: [Factor; 5] = [
    ("", |_, _| 1.0),
    ("a factor cos θi too many", |[_, wi], _| wi[2].abs()),
    ("a factor cos θi missing", |[_, wi], _| 1.0 / wi[2].abs()),
    ("transmitted radiance without the factor 1/η²", |[wo, wi], eta| if wo[2] * wi[2] < 0.0 { eta * eta } else { 1.0 }),
    (
        "transmitted radiance with the factor 1/η² twice",
        |[wo, wi], eta| {
            if wo[2] * wi[2] < 0.0 { 1.0 / (eta * eta) } else { 1.0 }
        },
    ),
];

pub struct Candidate {
    /// How it differs from the model; none is the model itself.
    pub changes: Vec<&'static str>,
    /// f of each pair.
    pub values: Vec<f64>,
    /// What was found by fitting.
    pub fitted: Option<f64>,
}

/// F₀ of F₀ (1 − g) + g, for values that are `rest` times F and perhaps a constant: by least squares of
/// a (1 − g) + c g, F₀ = a/c. Where all g are about equal, the constant is 1.
fn fitted_f0(found: &[f64], rest: &[f64], grazing: &[f64]) -> f64 {
    let row = |((f, rest), g): ((&f64, &f64), &f64)| Some([*g, f / rest]).filter(|row| row[1].is_finite());
    let rows: Vec<[f64; 2]> = found.iter().zip(rest).zip(grazing).filter_map(row).collect();
    let sum = |f: &dyn Fn(f64, f64) -> f64| rows.iter().map(|[g, f_of_g]| f(*g, *f_of_g)).sum::<f64>();
    let (hh, hg, gg) = (sum(&|g, _| (1.0 - g) * (1.0 - g)), sum(&|g, _| (1.0 - g) * g), sum(&|g, _| g * g));
    let (hf, gf) = (sum(&|g, f| (1.0 - g) * f), sum(&|g, f| g * f));
    let determinant = hh * gg - hg * hg;
    let is_sloped = gg > 1e-3 * rows.len() as f64 && determinant > 1e-6 * hh * gg;
    let f0 = if is_sloped { (hf * gg - gf * hg) / (gf * hh - hf * hg) } else { (hf - hg) / hh };
    f0.clamp(0.0, 1.0)
}

/// The same without a constant, in the median over all pairs, which is of use also if the rest is wrong.
fn median_f0(found: &[f64], rest: &[f64], grazing: &[f64]) -> f64 {
    let one =
        |((f, rest), g): ((&f64, &f64), &f64)| Some((f / rest - g) / (1.0 - g)).filter(|f0| *g < 0.5 && f0.is_finite());
    let mut all: Vec<f64> = found.iter().zip(rest).zip(grazing).filter_map(one).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN).clamp(0.0, 1.0)
}

impl Surface {
    /// The masking of the model first, then all others.
    fn maskings(&self) -> Vec<Masking> {
        let metal = !matches!(self.material, Material::Dielectric(_));
        let first = if metal { [CORRELATED, SEPARABLE] } else { [SEPARABLE, CORRELATED] };
        let rational = Some(RATIONAL).filter(|_| self.distribution == Distribution::Beckmann);
        first.into_iter().chain(OTHER_MASKING).chain(rational).collect()
    }

    /// F of a facet.
    fn reflectance(&self, formula: Formula, cos: f64, eta: f64, f0: f64) -> f64 {
        match (formula, self.material) {
            (Formula::One, _) => 1.0,
            (Formula::Schlick, Material::Dielectric(_)) => dielectric::schlick(cos, eta),
            (Formula::PowerOfTwo, _) => f0 + (1.0 - f0) * power_of_two(cos),
            (Formula::Schlick, _) | (_, Material::Schlick(_)) => dielectric::schlick_polynomial(f0, cos),
            (Formula::Exact, Material::Metal([eta, k])) => conductor::fresnel(cos, eta, k).unpolarized(),
            (Formula::Exact, Material::Dielectric(_)) => dielectric::fresnel(cos, eta).unpolarized(),
        }
    }

    /// The model and its variants of at most `most` changes, in order of their number. `found` are the values from which an unknown
    /// reflectance is fitted.
    pub fn candidates(&self, pairs: &[Pair], found: &[f64], most: usize) -> Vec<Candidate> {
        let facets: Vec<Option<Facet>> = pairs.iter().map(|pair| Facet::between(*pair, self.material)).collect();
        let other = match self.distribution {
            Distribution::Beckmann => Distribution::Ggx,
            Distribution::Ggx => Distribution::Beckmann,
        };
        let (named, of_normals_alone) = match other {
            Distribution::Ggx => ("GGX's normals", "GGX's normals, masked as if Beckmann's"),
            Distribution::Beckmann => ("Beckmann's normals", "Beckmann's normals, masked as if GGX's"),
        };
        let own = self.distribution;
        let known = match self.material {
            Material::Metal([eta, k]) => conductor::normal_reflectance(eta, k),
            Material::Schlick(Some(f0)) => f0,
            _ => 0.0,
        };
        let fresnel: Vec<Fresnel> = match self.material {
            // Schlick's formula is the model then
            Material::Schlick(_) => FRESNEL.into_iter().filter(|(_, formula, _)| *formula != Formula::Exact).collect(),
            Material::Metal(_) => FRESNEL.into(),
            // Karis' form has no case for light from the denser side
            Material::Dielectric(_) => {
                FRESNEL.into_iter().filter(|(_, formula, _)| *formula != Formula::PowerOfTwo).collect()
            }
        };
        let mut all = Vec::new();
        let distributions = [("", own, own), (named, other, other), (of_normals_alone, other, own)];
        for (n, (normals_name, distribution, masked)) in distributions.into_iter().enumerate() {
            for (w, (width_name, width)) in WIDTHS.into_iter().enumerate() {
                let normals = Normals::new(distribution, self.alpha.map(width[0]));
                let masked = Normals::new(masked, self.alpha.map(width[1]));
                let d: Vec<f64> = facets.iter().map(|facet| facet.as_ref().map_or(0.0, |f| normals.d(f.wm))).collect();
                for (m, (masking_name, masking)) in self.maskings().into_iter().enumerate() {
                    let changed = [n, w, m].into_iter().filter(|i| *i > 0).count();
                    if changed > most {
                        continue;
                    }
                    let rest = |(facet, d): (&Option<Facet>, &f64)| {
                        let Some(facet) = facet else { return 0.0 };
                        let common = d * masking(&masked, facet) / (facet.wo[2] * facet.wi[2]).abs();
                        let spread = facet.cos_o * facet.cos_i / (facet.sum * facet.sum);
                        common * if facet.reflects { 0.25 } else { spread }
                    };
                    let rest: Vec<f64> = facets.iter().zip(&d).map(rest).collect();
                    for (f, (fresnel_name, formula, cosine)) in fresnel.iter().enumerate() {
                        if changed + usize::from(f > 0) > most {
                            continue;
                        }
                        let cosines: Vec<f64> = facets.iter().map(|facet| facet.as_ref().map_or(1.0, cosine)).collect();
                        let grazing: Option<Vec<f64>> = cosines.iter().map(|cos| formula.grazing(*cos)).collect();
                        let grazing = grazing.filter(|_| self.material == Material::Schlick(None));
                        let fit = if most == 0 { median_f0 } else { fitted_f0 };
                        let fitted = grazing.map(|grazing| fit(found, &rest, &grazing));
                        let f0 = fitted.unwrap_or(known);
                        let value = |((facet, rest), cos): ((&Option<Facet>, &f64), &f64)| {
                            let Some(facet) = facet else { return 0.0 };
                            let reflected = self.reflectance(*formula, *cos, facet.eta, f0);
                            rest * if facet.reflects { reflected } else { 1.0 - reflected }
                        };
                        let values = facets.iter().zip(&rest).zip(&cosines).map(value).collect();
                        let names = [(n, normals_name), (w, width_name), (m, masking_name), (f, fresnel_name)];
                        let changes = names.into_iter().filter(|(i, _)| *i > 0).map(|(_, name)| name).collect();
                        all.push(Candidate { changes, values, fitted });
                    }
                }
            }
        }
        all.sort_by_key(|candidate| candidate.changes.len());
        all
    }

    /// Pdfs per solid angle of the usual ways to sample directions, each with its name; that of the model first.
    pub fn pdfs(&self, pairs: &[Pair]) -> Vec<(&'static str, Vec<f64>)> {
        let normals = Normals::new(self.distribution, self.alpha);
        let of = |density: &dyn Fn(&Facet) -> f64| -> Vec<f64> {
            let pdf = |pair: &Pair| {
                let Some(facet) = Facet::between(*pair, self.material) else { return 0.0 };
                let jacobian = if facet.reflects {
                    0.25 / facet.cos_o
                } else {
                    facet.eta * facet.eta * facet.cos_i / (facet.sum * facet.sum)
                };
                let share = match self.material {
                    Material::Dielectric(_) => self.reflectance(Formula::Exact, facet.cos_o, facet.eta, 0.0),
                    _ => 1.0,
                };
                density(&facet) * jacobian * if facet.reflects { share } else { 1.0 - share }
            };
            pairs.iter().map(pdf).collect()
        };
        let visible = |f: &Facet| normals.g1(f.wo) * normals.d(f.wm) * f.cos_o / f.wo[2].abs();
        let all = |f: &Facet| normals.d(f.wm) * f.wm[2];
        let above = |density: fn(f64) -> f64| {
            pairs.iter().map(|[wo, wi]| if wo[2] * wi[2] > 0.0 { density(wi[2].abs()) } else { 0.0 }).collect()
        };
        vec![
            ("visible normals", of(&visible)),
            ("the full distribution of normals", of(&all)),
            ("the cosine", above(|cos| FRAC_1_PI * cos)),
            ("the uniform hemisphere", above(|_| 0.5 * FRAC_1_PI)),
        ]
    }
}
