//! Brewster's angle and the critical angle over the index of refraction.

use super::fresnel::{check_index, check_points};
use super::media::{Interface, check_distinct};
use etalon_core::error::{Error, Result};
use etalon_core::optics::{D_LINE_NM, dielectric};
use serde::Serialize;

/// The angles at one interface. Field names are the CSV columns.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct AnglesRow {
    /// The medium on the other side, for a marked one; empty for a point of the curves.
    pub medium: String,
    /// Index of refraction on the other side.
    pub eta_t: f64,
    /// Brewster's angle of light from the near side, atan(`eta_t`/`eta_i`); `None` without an interface (equal indices).
    pub brewster_deg: Option<f64>,
    /// Brewster's angle of light from the other side, atan(`eta_i`/`eta_t`).
    pub brewster_reverse_deg: Option<f64>,
    /// The critical angle of light from the denser side, asin of the lower index over the higher one.
    pub critical_deg: Option<f64>,
}

/// Both angles over the index of the other side, and those of some media.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AngleCurves {
    /// Index of refraction on the near side.
    pub eta_i: f64,
    /// Wavelength in nanometres at which the media known by name have their indices.
    pub wavelength_nm: f64,
    /// The marked media, by growing index.
    pub media: Vec<AnglesRow>,
    /// Points of the curves, by growing index.
    #[serde(skip)]
    pub curves: Vec<AnglesRow>,
}

/// The curves reach at least from 1 to this index, a little more than that of diamond.
const HIGHEST: f64 = 2.6;

/// Computes the curves for light that comes from index `eta_i`, or goes back there, at `points` indices of the other side
/// from 1 to 2.6, or further where `media` or `eta_i` lie beyond.
///
/// # Errors
/// [`Error::Parameter`] for impossible indices and numbers of points, and for a medium that absorbs or is given twice.
pub fn curves(eta_i: f64, media: &[Interface], points: usize) -> Result<AngleCurves> {
    check_index("eta_i", eta_i)?;
    check_points(points)?;
    check_distinct(media)?;
    if let Some(metal) = media.iter().find(|medium| medium.k > 0.0) {
        return Err(Error::parameter("media", format!("{} absorbs light", metal.name))
            .with_hint("only transparent media have Brewster's and a critical angle"));
    }
    let indices = || media.iter().map(|medium| medium.eta).chain([eta_i]);
    let (from, to) = (indices().fold(1.0, f64::min), indices().fold(HIGHEST, f64::max));
    let index = |i: usize| from + (to - from) * i as f64 / (points - 1) as f64;
    let mut marked: Vec<AnglesRow> = media.iter().map(|medium| row(&medium.name, eta_i, medium.eta)).collect();
    marked.sort_by(|a, b| a.eta_t.total_cmp(&b.eta_t));
    Ok(AngleCurves {
        eta_i,
        wavelength_nm: D_LINE_NM,
        media: marked,
        curves: (0..points).map(|i| row("", eta_i, index(i))).collect(),
    })
}

fn row(medium: &str, eta_i: f64, eta_t: f64) -> AnglesRow {
    let brewster = |eta: f64| (eta != 1.0).then(|| dielectric::brewster(eta).to_degrees());
    AnglesRow {
        medium: medium.to_owned(),
        eta_t,
        brewster_deg: brewster(eta_t / eta_i),
        brewster_reverse_deg: brewster(eta_i / eta_t),
        critical_deg: dielectric::critical(eta_i.min(eta_t) / eta_i.max(eta_t)).map(f64::to_degrees),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(eta_i: f64, media: &[&str]) -> Result<AngleCurves> {
        let media = media.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
        curves(eta_i, &media, 161)
    }

    #[test]
    fn angles_of_media_and_of_all_indices() {
        let angles = of(1.0, &["diamond", "1.45"]).unwrap();
        let [_, diamond] = &angles.media[..] else { panic!() };
        assert!((diamond.critical_deg.unwrap() - 24.4).abs() < 0.1, "{diamond:?}");
        assert_eq!((angles.curves[0].brewster_deg, angles.curves[0].critical_deg), (None, None), "no interface");
        assert_eq!((angles.curves[0].eta_t, angles.curves[160].eta_t), (1.0, 2.6));
        for row in &angles.curves[1..] {
            let both = row.brewster_deg.unwrap() + row.brewster_reverse_deg.unwrap();
            assert!((both - 90.0).abs() < 1e-12, "{row:?}");
            assert!(row.critical_deg.unwrap() > row.brewster_reverse_deg.unwrap());
        }
    }

    #[test]
    fn the_near_side_may_be_denser() {
        let angles = of(1.5, &["water", "3"]).unwrap();
        let water = &angles.media[0];
        assert!((water.critical_deg.unwrap() - (water.eta_t / 1.5).asin().to_degrees()).abs() < 1e-12);
        assert!((water.brewster_deg.unwrap() - (water.eta_t / 1.5).atan().to_degrees()).abs() < 1e-12);
        assert_eq!(angles.curves.last().unwrap().eta_t, 3.0, "the curves reach every medium");
    }

    #[test]
    fn metals_and_bad_numbers_are_refused() {
        for bad in [&["Au"][..], &["water", "water"], &["0"]] {
            assert!(of(1.0, bad).is_err(), "{bad:?}");
        }
        assert!(of(f64::NAN, &[]).is_err() && curves(1.0, &[], 1).is_err());
    }
}
