//! Several media side by side: their reflectance over the angle of incidence at one wavelength, and Brewster's angle and the
//! critical angle over the index of refraction.

use crate::fresnel::{self, Row, check_index, check_points};
use crate::metal;
use crate::table::Table;
use etalon_core::errata::Formulas;
use etalon_core::error::{Error, Result};
use etalon_core::optics::media::{self, Medium};
use etalon_core::optics::{D_LINE_NM, dielectric};
use serde::Serialize;

/// What light meets: a complex index, with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// The medium's name, or the index itself.
    pub name: String,
    /// What stands for it in the name of a file.
    pub short: String,
    /// Index of refraction.
    pub eta: f64,
    /// Extinction coefficient; 0 for a dielectric.
    pub k: f64,
    pub medium: Option<Medium>,
}

impl Interface {
    /// A dielectric without a name, except air.
    pub fn dielectric(eta: f64) -> Self {
        let name = if eta == 1.0 { "air".to_owned() } else { format!("η = {eta}") };
        Self { name, short: eta.to_string(), eta, k: 0.0, medium: None }
    }

    /// A medium of the registry at the d line.
    pub fn of(medium: Medium) -> Self {
        let short = match medium {
            Medium::Dielectric(dielectric) => dielectric.name,
            Medium::Metal(metal) => metal.symbol,
        };
        let [eta, k] = medium.index_d();
        Self { name: medium.name(), short: short.to_owned(), eta, k, medium: Some(medium) }
    }

    /// Reads the name of a medium, or an index of refraction.
    ///
    /// # Errors
    /// Neither a known name nor an index from 1e-6 to 1e6.
    pub fn named(text: &str) -> Result<Self> {
        if let Ok(eta) = text.parse() {
            fresnel::check_index("media", eta)?;
            return Ok(Self::dielectric(eta));
        }
        media::by_name(text).map(Self::of).ok_or_else(|| {
            let known: Vec<String> = media::all().map(|medium| Self::of(medium).short).collect();
            Error::parameter("media", format!("\"{text}\" is not a known medium"))
                .with_hint(format!("known media: {}; or give an index of refraction", known.join(", ")))
        })
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MediumCurves {
    pub name: String,
    /// Its index of refraction.
    pub eta: f64,
    /// Its extinction coefficient.
    pub k: f64,
    /// Where they were published, for a medium known by name.
    pub source: Option<&'static str>,
    /// Reflectance at normal incidence.
    pub r_normal: f64,
    /// Where the exact R∥ is smallest: Brewster's angle of a dielectric, the pseudo-Brewster angle of a metal; `None`
    /// without an interface (equal indices).
    pub brewster_deg: Option<f64>,
    /// Angle beyond which all light is reflected, if there is one.
    pub critical_deg: Option<f64>,
    /// Largest |Schlick − exact| over 0–90°.
    pub schlick_max_abs_error: f64,
    pub schlick_max_abs_error_deg: f64,
    #[serde(skip)]
    pub rows: Vec<Row>,
}

/// Several media, met by light from the same side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MediaCurves {
    /// What is on the side of the incident light.
    pub from: String,
    /// Its index of refraction.
    pub eta_i: f64,
    /// Wavelength in nanometres at which the media known by name have their indices.
    pub wavelength_nm: f64,
    /// In the order in which they were asked for.
    pub media: Vec<MediumCurves>,
}

pub fn csv(sides: &[MediaCurves]) -> Result<Vec<u8>> {
    let media = sides.iter().flat_map(|side| side.media.iter().map(move |medium| (&side.from, medium)));
    let rows = media.flat_map(|(from, medium)| medium.rows.iter().map(move |row| ([from, &medium.name], row)));
    Table::of(&rows.collect::<Vec<([&String; 2], &Row)>>())
        .field("medium", |(names, _)| names[1])
        .field("theta_deg", |(_, row)| row.theta_deg)
        .field("r_parallel", |(_, row)| row.exact.parallel)
        .field("r_perpendicular", |(_, row)| row.exact.perpendicular)
        .field("r_unpolarized", |(_, row)| row.exact.unpolarized())
        .field("transmittance", |(_, row)| row.exact.transmittance())
        .field("r_schlick", |(_, row)| row.schlick)
        .field("from", |(names, _)| names[0])
        .csv()
}

/// The largest number of media side by side: as many as have a colour of their own in a figure.
pub const MAX_MEDIA: usize = 7;

/// Computes the curves of each interface for light that comes from a dielectric.
///
/// # Errors
/// [`Error::Parameter`] for no medium, more than [`MAX_MEDIA`], one given twice, impossible indices and numbers of points.
pub fn curves(from: &Interface, interfaces: &[Interface], points: usize, formulas: Formulas) -> Result<MediaCurves> {
    if !(1..=MAX_MEDIA).contains(&interfaces.len()) {
        return Err(Error::parameter("media", format!("{} media cannot be drawn in one figure", interfaces.len()))
            .with_hint(format!("give 1 to {MAX_MEDIA}")));
    }
    check_distinct(interfaces)?;
    let media = interfaces.iter().map(|interface| one(from.eta, interface, points, formulas)).collect::<Result<_>>()?;
    Ok(MediaCurves { from: from.name.clone(), eta_i: from.eta, wavelength_nm: D_LINE_NM, media })
}

/// Refuses a medium that is given twice.
pub(super) fn check_distinct(interfaces: &[Interface]) -> Result<()> {
    for (i, interface) in interfaces.iter().enumerate() {
        if interfaces[..i].iter().any(|other| other.name == interface.name) {
            return Err(Error::parameter("media", format!("{} is given twice", interface.name)));
        }
    }
    Ok(())
}

fn one(eta_i: f64, interface: &Interface, points: usize, formulas: Formulas) -> Result<MediumCurves> {
    let Interface { name, eta, k, medium, .. } = interface.clone();
    let (rows, r_normal, brewster_deg, critical_deg, [schlick_max_abs_error, schlick_max_abs_error_deg]) = if k == 0.0 {
        let curves = fresnel::curves(eta_i, eta, points, formulas)?;
        let error = [curves.schlick_max_abs_error, curves.schlick_max_abs_error_deg];
        (curves.rows, curves.r_normal, curves.brewster_deg, curves.critical_deg, error)
    } else {
        let channel = metal::by_index(eta_i, eta, k, points)?.channels.swap_remove(0);
        let error = [channel.schlick_max_abs_error, channel.schlick_max_abs_error_deg];
        (channel.rows, channel.r_normal, Some(channel.pseudo_brewster_deg), None, error)
    };
    let source = medium.map(|medium| medium.source());
    Ok(MediumCurves {
        name,
        eta,
        k,
        source,
        r_normal,
        brewster_deg,
        critical_deg,
        schlick_max_abs_error,
        schlick_max_abs_error_deg,
        rows,
    })
}

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
pub fn special_angles(eta_i: f64, media: &[Interface], points: usize) -> Result<AngleCurves> {
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
    let mut marked: Vec<AnglesRow> = media.iter().map(|medium| angles_row(&medium.name, eta_i, medium.eta)).collect();
    marked.sort_by(|a, b| a.eta_t.total_cmp(&b.eta_t));
    Ok(AngleCurves {
        eta_i,
        wavelength_nm: D_LINE_NM,
        media: marked,
        curves: (0..points).map(|i| angles_row("", eta_i, index(i))).collect(),
    })
}

fn angles_row(medium: &str, eta_i: f64, eta_t: f64) -> AnglesRow {
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

    fn of(names: &[&str]) -> Result<MediaCurves> {
        let interfaces = names.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
        curves(&Interface::dielectric(1.0), &interfaces, 91, Formulas::Exact)
    }

    #[test]
    fn media_have_the_curves_of_their_indices() {
        let all = of(&["water", "1.5", "au"]).unwrap();
        let names: Vec<&str> = all.media.iter().map(|medium| medium.name.as_str()).collect();
        assert_eq!(names, ["water", "η = 1.5", "gold (Au)"]);
        for medium in &all.media {
            assert_eq!(medium.rows.len(), 91);
            let closed =
                ((medium.eta - 1.0).powi(2) + medium.k * medium.k) / ((medium.eta + 1.0).powi(2) + medium.k * medium.k);
            assert!((medium.r_normal - closed).abs() < 1e-14, "{}", medium.name);
            assert!((medium.rows[0].exact.unpolarized() - closed).abs() < 1e-14, "{}", medium.name);
            assert!((medium.rows[90].exact.unpolarized() - 1.0).abs() < 1e-12, "{}", medium.name);
        }
        assert!((all.media[1].brewster_deg.unwrap() - 56.309_932).abs() < 1e-6);
        assert_eq!((all.media[1].source, all.media[2].source), (None, Some("Johnson & Christy 1972")));
        // From inside of water: total reflection beyond 48.6°.
        let inside =
            curves(&Interface::named("water").unwrap(), &[Interface::dielectric(1.0)], 2, Formulas::Exact).unwrap();
        assert_eq!([&inside.from, &inside.media[0].name], ["water", "air"]);
        assert!((inside.media[0].critical_deg.unwrap() - 48.59).abs() < 0.01);
    }

    #[test]
    fn bad_media_are_refused() {
        let too_many = ["1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "1.8"];
        for bad in [&["unobtainium"][..], &["-1"], &["nan"], &["inf"], &[], &["gold", "Au"], &too_many] {
            assert!(of(bad).is_err(), "{bad:?}");
        }
    }

    fn angles_of(eta_i: f64, media: &[&str]) -> Result<AngleCurves> {
        let media = media.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
        special_angles(eta_i, &media, 161)
    }

    #[test]
    fn angles_of_media_and_of_all_indices() {
        let angles = angles_of(1.0, &["diamond", "1.45"]).unwrap();
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
        let angles = angles_of(1.5, &["water", "3"]).unwrap();
        let water = &angles.media[0];
        assert!((water.critical_deg.unwrap() - (water.eta_t / 1.5).asin().to_degrees()).abs() < 1e-12);
        assert!((water.brewster_deg.unwrap() - (water.eta_t / 1.5).atan().to_degrees()).abs() < 1e-12);
        assert_eq!(angles.curves.last().unwrap().eta_t, 3.0, "the curves reach every medium");
    }

    #[test]
    fn metals_and_bad_numbers_are_refused() {
        for bad in [&["Au"][..], &["water", "water"], &["0"]] {
            assert!(angles_of(1.0, bad).is_err(), "{bad:?}");
        }
        assert!(angles_of(f64::NAN, &[]).is_err() && special_angles(1.0, &[], 1).is_err());
    }
}
