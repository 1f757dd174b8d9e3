//! Mistakes in rough dielectrics.

use super::super::fault::PlantedFault;
use super::faulty::{Change, planted};
use super::rough::{Facets, Pair, Rough};
use etalon_stats::bsdf::{Bsdf, Direction};
use glam::DVec3;

fn glass() -> Rough {
    Rough { alpha: [0.3; 2], facets: Facets::Dielectric(1.5) }
}

/// Outside, inside below the critical angle of 41.8°, and inside beyond it.
const WOS: &[f64] = &[40.0, 150.0, 125.0];
const OUTSIDE: &[f64] = &[40.0];
const INSIDE: &[f64] = &[145.0];

/// The right value times a factor that depends on the facet.
fn value(m: &Rough, wo: Direction, wi: Direction, factor: fn(&Pair) -> f64) -> f64 {
    m.pair(wo, wi).map_or(0.0, |pair| m.eval(wo, wi, &[])[0] * factor(&pair))
}

/// The right pdf times a factor that depends on the facet.
fn pdf(m: &Rough, wo: Direction, wi: Direction, factor: impl Fn(&Pair) -> f64) -> f64 {
    m.pair(wo, wi).map_or(0.0, |pair| m.pdf(wo, wi) * factor(&pair))
}

fn eta2(pair: &Pair) -> f64 {
    if pair.is_reflection { 1.0 } else { pair.eta * pair.eta }
}

pub fn faults() -> Vec<PlantedFault> {
    use Change::{AdjointValue, AdjointWeight, CarriedPdf, Pdf, PdfAndWeight, Sample, Value, ValueAndWeight, Weight};
    let fault = |name, degrees, change, mistake| planted(name, glass, degrees, change, mistake);
    vec![
        fault(
            "whole/dielectric/missing-reflection-jacobian",
            WOS,
            PdfAndWeight(|m, o, i| pdf(m, o, i, |p| if p.is_reflection { 4.0 * p.cos_o } else { 1.0 })),
            "the pdf of reflections without 1/(4 wo·m)",
        ),
        fault(
            "whole/dielectric/transmission-jacobian-of-wo",
            WOS,
            PdfAndWeight(|m, o, i| pdf(m, o, i, |p| if p.is_reflection { 1.0 } else { p.cos_o / p.cos_i })),
            "|wo·m| for |wi·m| in the Jacobian of refraction",
        ),
        fault(
            "whole/dielectric/transmission-jacobian-without-index",
            WOS,
            Pdf(|m, o, i| pdf(m, o, i, |p| 1.0 / eta2(p))),
            "η² left out of the Jacobian of refraction",
        ),
        fault(
            "whole/dielectric/half-vector-not-oriented",
            WOS,
            Value(|m, o, i| {
                let up = m.eta(o) > 1.0 || o[2] * i[2] > 0.0;
                if up { m.eval(o, i, &[])[0] } else { 0.0 }
            }),
            "the half vector of a refraction inside the glass points down, where D is 0",
        ),
        fault(
            "whole/dielectric/inverted-half-vector",
            OUTSIDE,
            Value(|m, o, i| {
                let inverted = Rough { facets: Facets::Dielectric(1.0 / m.index()), ..*m };
                if o[2] * i[2] > 0.0 { m.eval(o, i, &[])[0] } else { inverted.eval(o, i, &[])[0] }
            }),
            "η of the wrong side in the half vector of a refraction",
        ),
        fault(
            "whole/dielectric/total-reflection-lost",
            INSIDE,
            Sample(|m, o, u| {
                let normal = m.sample_normal(o, [u[1], u[2]]);
                let cos = normal.dot(DVec3::from_array(o)).abs().min(1.0);
                m.sample(o, u).filter(|_| m.fresnel(cos, m.eta(o)) < 1.0)
            }),
            "no sample where a facet reflects all light, as if refraction had failed",
        ),
        fault(
            "whole/dielectric/lobe-chosen-at-the-normal",
            OUTSIDE,
            Sample(|m, o, u| {
                let reflects = u[0] < m.fresnel(o[2].abs(), m.eta(o));
                let wi = m.scatter(o, m.sample_normal(o, [u[1], u[2]]), reflects)?;
                m.weighted(o, wi).filter(|_| (wi[2] * o[2] > 0.0) == reflects)
            }),
            "the lobe chosen by F at the surface's normal, and weighted by F at the facet's",
        ),
        fault(
            "whole/dielectric/lobes-chosen-with-equal-probability",
            OUTSIDE,
            Sample(|m, o, u| {
                let wi = m.scatter(o, m.sample_normal(o, [u[1], u[2]]), u[0] < 0.5)?;
                m.weighted(o, wi).filter(|_| (wi[2] * o[2] > 0.0) == (u[0] < 0.5))
            }),
            "both lobes chosen with probability ½, and weighted as if by Fresnel",
        ),
        fault(
            "whole/dielectric/pdf-without-lobe-probability",
            OUTSIDE,
            PdfAndWeight(|m, o, i| pdf(m, o, i, |p| 1.0 / m.share(p))),
            "the pdf of the lobe without the probability of choosing it",
        ),
        fault(
            "whole/dielectric/radiance-not-scaled",
            OUTSIDE,
            ValueAndWeight(|m, o, i| value(m, o, i, eta2)),
            "1/η² of refracted radiance left out, in values and weights",
        ),
        fault(
            "whole/dielectric/radiance-scaled-twice",
            INSIDE,
            ValueAndWeight(|m, o, i| value(m, o, i, |p| 1.0 / eta2(p))),
            "1/η² of refracted radiance twice, in values and weights",
        ),
        fault(
            "whole/dielectric/radiance-scaled-in-values-alone",
            OUTSIDE,
            Weight(|m, o, s| s.weight[0] * m.pair(o, s.wi).map_or(1.0, |p| eta2(&p))),
            "1/η² in values and not in weights",
        ),
        fault(
            "whole/dielectric/radiance-scaled-by-the-inverse",
            INSIDE,
            ValueAndWeight(|m, o, i| value(m, o, i, |p| eta2(p) * eta2(p))),
            "refracted radiance times η² for 1/η²",
        ),
        fault(
            "whole/dielectric/fresnel-at-the-normal",
            OUTSIDE,
            ValueAndWeight(|m, o, i| {
                let f = |p: Pair| {
                    let f = m.fresnel(o[2].abs(), p.eta);
                    m.value(o, i, &p, m.g2(o, i), if p.is_reflection { f } else { 1.0 - f })
                };
                m.pair(o, i).map_or(0.0, f)
            }),
            "F at the cosine of wo with the surface, for that with the facet",
        ),
        fault(
            "whole/dielectric/fresnel-of-the-other-side",
            OUTSIDE,
            Value(|m, o, i| {
                let f = |p: Pair| {
                    let f = m.fresnel(p.cos_i.min(1.0), p.eta);
                    m.value(o, i, &p, m.g2(o, i), if p.is_reflection { f } else { 1.0 - f })
                };
                m.pair(o, i).map_or(0.0, f)
            }),
            "F at wi·m with the index for wo, which differ in refraction",
        ),
        fault(
            "whole/dielectric/backfacing-facets",
            OUTSIDE,
            Value(|m, o, i| m.unoriented(o, i).map_or(0.0, |p| m.value(o, i, &p, m.g2(o, i), m.share(&p)))),
            "light refracted by facets that one of the directions does not see",
        ),
        fault(
            "whole/dielectric/wrong-side-kept",
            OUTSIDE,
            Sample(|m, o, u| {
                let normal = m.sample_normal(o, [u[1], u[2]]);
                let cos = normal.dot(DVec3::from_array(o)).abs().min(1.0);
                let reflects = u[0] < m.fresnel(cos, m.eta(o));
                let mut wi = m.scatter(o, normal, reflects)?;
                wi[2] = wi[2].abs() * if reflects { o[2].signum() } else { -o[2].signum() };
                m.weighted(o, wi)
            }),
            "directions on the wrong side mirrored to the right one instead of dropped",
        ),
        fault(
            "whole/dielectric/adjoint-as-radiance",
            OUTSIDE,
            AdjointValue(|m, o, i| m.eval(o, i, &[])[0]),
            "the same values for importance as for radiance",
        ),
        fault(
            "whole/dielectric/adjoint-weight-as-radiance",
            INSIDE,
            AdjointWeight(|_, _, s| s.weight[0]),
            "the same weights for importance as for radiance",
        ),
        fault(
            "whole/dielectric/reverse-pdf",
            OUTSIDE,
            CarriedPdf(|m, o, i| m.pdf(i, o)),
            "a sample carries the pdf of the reverse direction",
        ),
    ]
}
