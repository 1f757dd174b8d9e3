//! Mistakes in rough conductors, anisotropic ones among them.

use super::super::fault::PlantedFault;
use super::faulty::{Change, planted};
use super::rough::{Facets, Rough};
use etalon_stats::bsdf::{Bsdf, BsdfSample, Direction};

fn metal() -> Rough {
    Rough { alpha: [0.4; 2], facets: Facets::Conductor(0.7) }
}

fn brushed() -> Rough {
    Rough { alpha: [0.1, 0.5], facets: Facets::Conductor(0.7) }
}

fn polished() -> Rough {
    Rough { alpha: [1e-4; 2], facets: Facets::Conductor(0.7) }
}

fn swapped(m: &Rough) -> Rough {
    Rough { alpha: [m.alpha[1], m.alpha[0]], ..*m }
}

/// The right value times a factor.
fn value(m: &Rough, wo: Direction, wi: Direction, factor: f64) -> f64 {
    m.eval(wo, wi, &[])[0] * factor
}

/// A sample whose normal comes from another distribution.
fn sampled_by(m: &Rough, other: &Rough, wo: Direction, u: &[f64]) -> Option<BsdfSample> {
    m.weighted(wo, m.scatter(wo, other.sample_normal(wo, [u[1], u[2]]), true).filter(|wi| wi[2] > 0.0)?)
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::{Pdf, PdfAndWeight, Sample, Value, ValueAndWeight, Weight};
    const WOS: &[f64] = &[60.0];
    let fault = |name, change, mistake| planted(name, metal, WOS, change, mistake);
    vec![
        fault(
            "whole/conductor/missing-jacobian",
            PdfAndWeight(|m, o, i| m.pair(o, i).map_or(0.0, |p| m.visible(o, &p))),
            "the pdf of the normal for that of the direction: 1/(4 wo·m) forgotten, weights with it",
        ),
        fault(
            "whole/conductor/jacobian-with-surface-normal",
            PdfAndWeight(|m, o, i| m.pair(o, i).map_or(0.0, |p| 0.25 * m.visible(o, &p) / o[2])),
            "1/(4 wo·n) for 1/(4 wo·m)",
        ),
        fault(
            "whole/conductor/masking-without-shadowing",
            ValueAndWeight(|m, o, i| value(m, o, i, m.g1(o) / m.g2(o, i))),
            "G₁(wo) for G₂: shadowing is left out, so that wo and wi differ",
        ),
        fault(
            "whole/conductor/separable-g2-in-values",
            Value(|m, o, i| value(m, o, i, m.g1(o) * m.g1(i) / m.g2(o, i))),
            "G₁ G₁ in values, and Smith's G₂ for correlated heights in weights",
        ),
        fault(
            "whole/conductor/pdf-without-masking",
            Pdf(|m, o, i| m.pdf(o, i) / m.g1(o)),
            "the pdf of visible normals without G₁",
        ),
        fault(
            "whole/conductor/wo-and-wi-exchanged-in-pdf",
            PdfAndWeight(|m, o, i| m.pdf(i, o)),
            "wo and wi exchanged in the pdf, weights divided by it",
        ),
        fault(
            "whole/conductor/ndf-pdf-for-vndf-samples",
            PdfAndWeight(|m, o, i| m.pair(o, i).map_or(0.0, |p| m.d(p.m) * p.m.z / (4.0 * p.cos_o))),
            "the pdf of the full distribution of normals with samples of the visible ones",
        ),
        fault("whole/conductor/cosine-twice", Weight(|_, _, s| s.weight[0] * s.wi[2]), "weights with cos θᵢ twice"),
        fault(
            "whole/conductor/cosine-missing",
            Weight(|m, o, s| m.eval(o, s.wi, &[])[0] / m.pdf(o, s.wi)),
            "weights without cos θᵢ",
        ),
        fault(
            "whole/conductor/cosine-in-values",
            ValueAndWeight(|m, o, i| value(m, o, i, i[2].max(0.0))),
            "values that contain cos θᵢ, which the caller multiplies again",
        ),
        fault(
            "whole/conductor/fresnel-at-the-normal",
            ValueAndWeight(|m, o, i| {
                m.pair(o, i).map_or(0.0, |p| m.value(o, i, &p, m.g2(o, i), m.fresnel(i[2].abs(), 1.0)))
            }),
            "F at the cosine of wi with the surface, for that with the facet",
        ),
        fault(
            "whole/conductor/roughness-squared-in-values",
            Value(|m, o, i| Rough { alpha: m.alpha.map(|a| a * a), ..*m }.eval(o, i, &[])[0]),
            "α² in values and α in samples: the remapping of a roughness applied in one place",
        ),
        fault(
            "whole/conductor/factor-4-missing",
            ValueAndWeight(|m, o, i| value(m, o, i, 4.0)),
            "1/4 left out of the Torrance–Sparrow formula: more light than arrives",
        ),
        fault(
            "whole/conductor/negative-fresnel",
            ValueAndWeight(|m, o, i| {
                m.pair(o, i).map_or(0.0, |p| m.value(o, i, &p, m.g2(o, i), 0.5 - p.cos_o.powi(6)))
            }),
            "a polynomial fit of F that is negative near normal incidence",
        ),
        fault(
            "whole/conductor/nan-at-wo",
            Value(|m, o, i| {
                let apart = (0..3).map(|k| (o[k] - i[k]).powi(2)).sum::<f64>().sqrt();
                value(m, o, i, apart * apart.recip())
            }),
            "a factor that is 0/0 where wi is wo",
        ),
        planted(
            "whole/anisotropic/alphas-swapped-in-pdf",
            brushed,
            &[50.0],
            PdfAndWeight(|m, o, i| swapped(m).pdf(o, i)),
            "α of x and y exchanged in the pdf, weights divided by it",
        ),
        planted(
            "whole/anisotropic/alphas-swapped-in-values",
            brushed,
            &[50.0],
            Value(|m, o, i| swapped(m).eval(o, i, &[])[0]),
            "α of x and y exchanged in values, with weights of the right one",
        ),
        planted(
            "whole/anisotropic/masking-by-one-alpha",
            brushed,
            &[70.0],
            Value(|m, o, i| value(m, o, i, Rough { alpha: [m.alpha[0]; 2], ..*m }.g2(o, i) / m.g2(o, i))),
            "G₂ by α of x alone, in values",
        ),
        planted(
            "whole/anisotropic/frame-flipped-at-normal-incidence",
            brushed,
            &[0.001],
            Sample(|m, o, u| sampled_by(m, &if o[2] > 0.999 { swapped(m) } else { *m }, o, u)),
            "another tangent frame near normal incidence, where the azimuth of wo is not defined",
        ),
        planted(
            "whole/conductor/alpha-clamped-in-values",
            polished,
            &[30.0],
            Value(|m, o, i| Rough { alpha: m.alpha.map(|a| a.max(1e-3)), ..*m }.eval(o, i, &[])[0]),
            "α clamped to 10⁻³ in values and not in samples",
        ),
        planted(
            "whole/conductor/alpha-clamped-in-samples",
            polished,
            &[30.0],
            Sample(|m, o, u| sampled_by(m, &Rough { alpha: m.alpha.map(|a| a.max(1e-3)), ..*m }, o, u)),
            "α clamped to 10⁻³ in samples and not in the pdf",
        ),
    ]
}
