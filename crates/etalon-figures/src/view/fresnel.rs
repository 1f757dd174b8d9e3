//! Drawings of reflectance curves: of one interface; of several media in one panel, with Schlick's error beside it; of Brewster's
//! angle and the critical angle over the index of refraction, and of those of named media.

use super::text::{capitalized, rounded};
use crate::figure::{Axis, Colour, Drawing, Marker, Panel, Plot, Point, Stroke, theme};
use etalon_bench::fresnel::{DielectricCurves, Row};
use etalon_bench::media::{AngleCurves, AnglesRow, MediaCurves, MediumCurves};
use etalon_bench::metal::{Channel, ConductorCurves};
use etalon_core::optics::dielectric::Reflectance;

pub(super) fn stroke(colour: crate::figure::Colour, dash: &'static [f64]) -> Stroke {
    Stroke { colour, width: theme::LINE, dash }
}

const ANGLE: &str = "angle of incidence /{θ} (degrees)";

fn angle_axis() -> Axis {
    Axis::linear(ANGLE).range(0.0, 90.0).every(15.0)
}

/// With room above 1 and below 0, where curves run along both.
fn share_axis() -> Axis {
    Axis::linear("share of the power").range(-0.04, 1.04).every(0.2)
}

/// Curves of one interface, from one medium to the other, and beside them Schlick's error.
pub fn dielectric(curves: &DielectricCurves, media: [&str; 2]) -> Drawing {
    let [absolute, relative] = schlick_errors(curves);
    Plot::new([shares(curves, media), absolute, relative]).frame_size(380.0, 310.0).draw()
}

/// The angles that a panel of an interface shows: to `beyond` degrees past the critical angle, after which nothing changes, rounded up to 5°.
fn shown_angles(curves: &DielectricCurves, beyond: f64) -> (Axis, f64) {
    match curves.critical_deg.map(|critical| ((critical + beyond) / 5.0).ceil() * 5.0) {
        Some(end) if end < 90.0 => {
            (Axis::linear(ANGLE).range(0.0, end).every(if end > 60.0 { 10.0 } else { 5.0 }), end)
        }
        _ => (angle_axis(), 90.0),
    }
}

/// Degrees beyond the critical angle that show total reflection.
const TOTAL: f64 = 12.0;

/// Lines at Brewster's angle and at the critical angle, if there are these, by their symbols or in words.
fn with_special_angles(panel: Panel, curves: &DielectricCurves, in_words: bool) -> Panel {
    let angles = [
        (curves.brewster_deg, "Brewster's angle", "/{θ}_{B}", theme::BREWSTER),
        (curves.critical_deg, "critical angle", "/{θ}_{c}", theme::CRITICAL),
    ];
    angles.into_iter().fold(panel, |panel, (degrees, name, symbol, colour)| match degrees {
        Some(at) => {
            let label = if in_words { format!("{name} {symbol} = {at:.2}°") } else { symbol.to_owned() };
            panel.vertical_above(at, label, Stroke { colour, width: theme::BOLD, dash: theme::DASHED })
        }
        None => panel,
    })
}

/// A side of an interface in words: air, or the medium with its index, unless that is its name.
fn side(eta: f64, medium: &str) -> String {
    let is_name = |name: &str| name.parse::<f64>().is_ok() || name.contains('=');
    match eta {
        1.0 => "air".into(),
        _ if is_name(medium) => format!("/{{η}} = {}", index(eta)),
        _ => format!("{medium} (/{{η}} = {})", index(eta)),
    }
}

/// Curves of one interface with its special angles.
fn shares(curves: &DielectricCurves, [from, into]: [&str; 2]) -> Panel {
    let title = format!("From {} into {}", side(curves.eta_i, from), side(curves.eta_t, into));
    let schlick = match (curves.critical_deg, curves.model) {
        (None, _) => "Schlick",
        (Some(_), "exact") => "Schlick, angle of refraction",
        (Some(_), _) => "Schlick, angle of incidence",
    };
    let (angle, end) = shown_angles(curves, TOTAL);
    let main = exact_curves(Panel::new(angle, share_axis()).title(title), &curves.rows);
    let main = Curve::Transmittance.line(main, Curve::Transmittance.label(), &curves.rows);
    let main = Curve::Schlick.line(main, schlick, &curves.rows).with_names_on_curves();
    let mut main = with_special_angles(main, curves, true);
    if let Some(critical) = curves.critical_deg {
        if curves.model == "exact" {
            let inside = curves.rows.iter().filter(|row| row.theta_deg <= critical);
            let points = points(inside, |row| curves.schlick_incident(row));
            main = main.line("Schlick, angle of incidence", stroke(theme::SCHLICK_INCIDENT, theme::LONG_DASH), points);
        }
        if curves.rows.last().is_some_and(|last| last.theta_deg > critical) {
            main = total_reflection(main, critical, end);
        }
    }
    main
}

/// Schlick's error of one interface: the difference, and over the exact reflectance.
fn schlick_errors(curves: &DielectricCurves) -> [Panel; 2] {
    let panel = |title: &str, label: &str, points: Vec<Point>| {
        let panel = Panel::new(shown_angles(curves, 0.0).0, Axis::linear(label)).title(title).horizontal(0.0, "");
        with_special_angles(panel.line("", stroke(theme::SCHLICK, theme::DASHED), points), curves, false)
    };
    let relative = |row: &Row| 100.0 * row.error() / row.exact.unpolarized();
    let whose = match curves.critical_deg {
        None => "",
        Some(_) if curves.model == "exact" => "\nwith the angle of refraction",
        Some(_) => "\nwith the angle of incidence",
    };
    [
        panel(&format!("Error of Schlick's approximation{whose}"), "Schlick − exact", points(&curves.rows, Row::error)),
        panel(
            &format!("Relative error of Schlick's approximation{whose}"),
            "(Schlick − exact) / exact (%)",
            points(&curves.rows, relative),
        ),
    ]
}

/// An index of refraction in as many digits as it is known to.
fn index(eta: f64) -> String {
    rounded(eta, 5).trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// From the critical angle to the end of the axis.
fn total_reflection(panel: Panel, critical: f64, end: f64) -> Panel {
    let middle = 0.5 * (critical + end);
    panel.shade(critical, end, theme::TOTAL_REFLECTION).note([middle, 0.6], "total reflection", theme::INK)
}

/// A value over the angle of incidence.
fn points<'a>(rows: impl IntoIterator<Item = &'a Row>, value: impl Fn(&Row) -> f64) -> Vec<Point> {
    rows.into_iter().map(|row| [row.theta_deg, value(row)]).collect()
}

fn exact_curves(panel: Panel, rows: &[Row]) -> Panel {
    let curves = [Curve::Parallel, Curve::Perpendicular, Curve::Unpolarized];
    curves.into_iter().fold(panel, |panel, curve| curve.line(panel, curve.label(), rows))
}

/// Exact, approximate and Schlick reflectance per channel, and the errors of both approximations.
pub fn metal(curves: &ConductorCurves) -> Drawing {
    // Metals reflect most of the light: the part of the axis where something happens, the same for all
    let rows = curves.channels.iter().flat_map(|c| c.rows.iter().map(move |row| (c, row)));
    let lowest = rows.map(|(c, row)| row.exact.parallel.min(c.approximate(row).parallel)).fold(1.0, f64::min);
    let ends = [(lowest * 10.0).floor() / 10.0, 1.0];
    let mut panels: Vec<Panel> = curves.channels.iter().map(|c| channel(&curves.metal, c, ends)).collect();
    panels.push(errors(curves));
    let panels: Vec<Panel> = panels.into_iter().map(Panel::with_names_on_curves).collect();
    Plot::grid(panels.chunks(2).map(|pair| (String::new(), pair.to_vec()))).frame_size(420.0, 320.0).draw()
}

fn channel(metal: &str, c: &Channel, [from, to]: [f64; 2]) -> Panel {
    let approximate = |of: fn(&Reflectance<f64>) -> f64| points(&c.rows, |row| of(&c.approximate(row)));
    let title = if c.name.contains("nm") {
        let [eta, k] = [c.eta, c.k].map(index);
        format!("{}, {}: /{{η}}\u{a0}=\u{a0}{eta}, /{{k}}\u{a0}=\u{a0}{k}", capitalized(metal), c.name)
    } else {
        c.name.clone()
    };
    let panel = Panel::new(angle_axis(), Axis::linear("reflectance").range(from, to)).title(title);
    let panel = exact_curves(panel, &c.rows)
        .line("/{R}_{∥} for ∣/{n}∣² ≫ 1", stroke(theme::R_PARALLEL, theme::DOTTED), approximate(|r| r.parallel))
        .line(
            "/{R}_{⊥} for ∣/{n}∣² ≫ 1",
            stroke(theme::R_PERPENDICULAR, theme::DOTTED),
            approximate(|r| r.perpendicular),
        )
        .line("/{R} for ∣/{n}∣² ≫ 1", stroke(theme::UNPOLARIZED, theme::DOTTED), approximate(Reflectance::unpolarized));
    Curve::Schlick
        .line(panel, Curve::Schlick.label(), &c.rows)
        .vertical(c.pseudo_brewster_deg, format!("pseudo-Brewster angle {:.1}°", c.pseudo_brewster_deg))
}

fn errors(curves: &ConductorCurves) -> Panel {
    let colours = if curves.channels.len() == 1 { &[theme::UNPOLARIZED][..] } else { &theme::CHANNELS };
    let mut panel =
        Panel::new(angle_axis(), Axis::linear("error of /{R} unpolarized")).title("Errors of the approximations");
    for (c, &colour) in curves.channels.iter().zip(colours) {
        let approximate = |row: &Row| c.approximate(row).unpolarized() - row.exact.unpolarized();
        let name = if c.name.contains("nm") { format!("{}, ", c.name) } else { String::new() };
        panel = panel
            .line(format!("{name}∣/{{n}}∣² ≫ 1"), stroke(colour, theme::SOLID), points(&c.rows, approximate))
            .line(format!("{name}Schlick"), stroke(colour, theme::DASHED), points(&c.rows, Row::error));
    }
    panel
}

/// A curve that can be shown for each medium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    Unpolarized,
    Parallel,
    Perpendicular,
    Transmittance,
    Schlick,
    /// Schlick − exact, in a panel of its own.
    Error,
    /// A vertical line at the angle.
    Brewster,
    Critical,
}

/// All curves, with their names and what they are.
pub const CURVES: [(&str, &str, Curve); 8] = [
    ("unpolarized", "Reflectance of unpolarized light", Curve::Unpolarized),
    ("parallel", "Reflectance of parallel polarization", Curve::Parallel),
    ("perpendicular", "Reflectance of perpendicular polarization", Curve::Perpendicular),
    ("transmittance", "1 − R: refracted by a dielectric, absorbed by a metal", Curve::Transmittance),
    ("schlick", "Schlick's approximation of unpolarized light", Curve::Schlick),
    ("error", "Schlick − exact, in a panel of its own", Curve::Error),
    ("brewster", "A line at Brewster's angle, of a metal at the smallest R∥", Curve::Brewster),
    ("critical", "A line at the critical angle, if there is one", Curve::Critical),
];

impl Curve {
    /// Where it is a line at an angle: the angle of a medium, if it has one.
    fn angle(self, medium: &MediumCurves) -> Option<f64> {
        match self {
            Self::Brewster => medium.brewster_deg,
            Self::Critical => medium.critical_deg,
            _ => None,
        }
    }

    fn is_angle(self) -> bool {
        matches!(self, Self::Brewster | Self::Critical)
    }

    fn value(self, row: &Row) -> f64 {
        match self {
            Self::Unpolarized => row.exact.unpolarized(),
            Self::Parallel => row.exact.parallel,
            Self::Perpendicular => row.exact.perpendicular,
            Self::Transmittance => row.exact.transmittance(),
            Self::Schlick => row.schlick,
            Self::Error => row.error(),
            Self::Brewster | Self::Critical => f64::NAN,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Unpolarized => "/{R} unpolarized",
            Self::Parallel => "/{R}_{∥}",
            Self::Perpendicular => "/{R}_{⊥}",
            Self::Transmittance => "/{T} = 1 − /{R}",
            Self::Schlick => "Schlick",
            Self::Error => "Schlick − exact",
            Self::Brewster => "Brewster's angle /{θ}_{B}",
            Self::Critical => "critical angle /{θ}_{c}",
        }
    }

    fn dash(self) -> &'static [f64] {
        match self {
            Self::Unpolarized | Self::Error | Self::Brewster | Self::Critical => theme::SOLID,
            Self::Parallel => theme::DASHED,
            Self::Perpendicular => theme::DOTTED,
            Self::Transmittance => theme::DASH_DOT,
            Self::Schlick => theme::LONG_DASH,
        }
    }

    /// The same where there is one medium, as in its own figure.
    fn dash_of_one(self) -> &'static [f64] {
        match self {
            Self::Parallel | Self::Perpendicular => theme::SOLID,
            Self::Schlick => theme::DASHED,
            other => other.dash(),
        }
    }

    /// Adds the curve where there is one medium.
    fn line(self, panel: Panel, label: &str, rows: &[Row]) -> Panel {
        panel.line(label, stroke(self.colour(), self.dash_of_one()), points(rows, |row| self.value(row)))
    }

    /// The colour where there is one medium, whose curves differ by colour, too.
    fn colour(self) -> Colour {
        match self {
            Self::Unpolarized => theme::UNPOLARIZED,
            Self::Parallel => theme::R_PARALLEL,
            Self::Perpendicular => theme::R_PERPENDICULAR,
            Self::Transmittance => theme::TRANSMITTANCE,
            Self::Schlick | Self::Error => theme::SCHLICK,
            Self::Brewster => theme::BREWSTER,
            Self::Critical => theme::CRITICAL,
        }
    }
}

/// The curves `show` of all media, for each side that light comes from: the colour tells the medium, the dash pattern the curve.
pub fn of_media(sides: &[MediaCurves], show: &[Curve]) -> Drawing {
    let panels: Vec<Panel> = sides.iter().flat_map(|curves| panels_of_media(curves, show)).collect();
    Plot::new(panels).frame_size(420.0, 320.0).draw()
}

fn panels_of_media(curves: &MediaCurves, show: &[Curve]) -> Vec<Panel> {
    let (angles, show): (Vec<Curve>, Vec<Curve>) = show.iter().partition(|curve| curve.is_angle());
    let shares: Vec<Curve> = show.iter().copied().filter(|curve| *curve != Curve::Error).collect();
    let panel = |show: &[Curve], y: Axis| with_angles(panel(curves, show, y), curves, &angles);
    let mut panels = Vec::new();
    let from = side(curves.eta_i, &curves.from);
    let side = match &*curves.media {
        [only] if only.k == 0.0 => format!("From {from} into {}", side(only.eta, &only.name)),
        [only] if only.source.is_some() => format!("From {from} into {} at {:.2} nm", only.name, curves.wavelength_nm),
        [only] => format!("From {from} into {}", only.name),
        _ if *shares == [Curve::Unpolarized] => format!("Reflectance, light from {from}"),
        _ => format!("Light from {from}"),
    };
    if let [only] = *shares {
        let axis = Axis::linear(axis_name(only)).range(0.0, 1.0);
        panels.push(panel(&shares, axis).title(side.clone()));
    } else if !shares.is_empty() || !show.contains(&Curve::Error) {
        panels.push(panel(&shares, share_axis()).title(side.clone()));
    }
    if show.contains(&Curve::Error) {
        let title = if shares.is_empty() { side } else { "Error of Schlick's approximation".to_owned() };
        let axis = Axis::linear(axis_name(Curve::Error));
        panels.push(panel(&[Curve::Error], axis).title(title).horizontal(0.0, ""));
    }
    panels
}

/// Lines at angles of each medium.
fn with_angles(panel: Panel, curves: &MediaCurves, angles: &[Curve]) -> Panel {
    let is_single = curves.media.len() == 1;
    let lines = curves.media.iter().enumerate().flat_map(|(i, medium)| {
        angles.iter().filter_map(move |curve| {
            let at = curve.angle(medium)?;
            // A metal has a least R∥ that is not 0, and no Brewster's angle
            let [long, short] = match curve {
                Curve::Brewster if medium.k > 0.0 => ["least /{R}_{∥}"; 2],
                Curve::Brewster => [curve.label(), "/{θ}_{B}"],
                _ => [curve.label(), "/{θ}_{c}"],
            };
            let colour = if is_single { curve.colour() } else { theme::series(i).colour };
            let name = &medium.name;
            let label = if is_single { format!("{long} = {at:.2}°") } else { format!("{name}, {short} = {at:.1}°") };
            Some((at, label, Stroke::solid(colour, theme::THIN)))
        })
    });
    let panel = lines.fold(panel, |panel, (at, label, stroke)| panel.vertical_above(at, label, stroke));
    match &*curves.media {
        [MediumCurves { critical_deg: Some(critical), .. }] if angles.contains(&Curve::Critical) => {
            total_reflection(panel, *critical, 90.0)
        }
        _ => panel,
    }
}

fn axis_name(only: Curve) -> &'static str {
    match only {
        Curve::Unpolarized => "reflectance of unpolarized light",
        Curve::Parallel => "reflectance of parallel polarization",
        Curve::Perpendicular => "reflectance of perpendicular polarization",
        Curve::Transmittance => "1 − reflectance of unpolarized light",
        Curve::Schlick => "reflectance by Schlick's approximation",
        Curve::Error => "Schlick − exact, of unpolarized light",
        Curve::Brewster | Curve::Critical => "",
    }
}

fn panel(curves: &MediaCurves, show: &[Curve], y: Axis) -> Panel {
    let mut panel = Panel::new(angle_axis(), y);
    for (i, medium) in curves.media.iter().enumerate() {
        for curve in show {
            let label = match (curves.media.len(), show.len()) {
                (_, 1) => medium.name.clone(),
                (1, _) => curve.label().to_owned(),
                _ => format!("{}, {}", medium.name, curve.label()),
            };
            let stroke = match curves.media.len() {
                1 => stroke(curve.colour(), curve.dash_of_one()),
                _ => stroke(theme::series(i).colour, curve.dash()),
            };
            panel = panel.line(label, stroke, points(&medium.rows, |row| curve.value(row)));
        }
    }
    panel.with_names_on_curves()
}

/// An angle: its label, its place in the rows, and how it is drawn.
struct Angle {
    label: String,
    of: fn(&AnglesRow) -> Option<f64>,
    colour: Colour,
    dash: &'static [f64],
    marker: Marker,
}

/// Curves over the index beside the angles of each medium.
pub fn of_special_angles(angles: &AngleCurves) -> Drawing {
    let kinds = [
        Angle {
            label: format!("Brewster's angle /{{θ}}_{{B}}, light from /{{η}} = {}", angles.eta_i),
            of: |row| row.brewster_deg,
            colour: theme::BREWSTER,
            dash: theme::SOLID,
            marker: Marker::Disc,
        },
        Angle {
            label: "Brewster's angle, light from the medium".into(),
            of: |row| row.brewster_reverse_deg,
            colour: theme::BREWSTER,
            dash: theme::DASHED,
            marker: Marker::Square,
        },
        Angle {
            label: "critical angle /{θ}_{c}, light from the denser side".into(),
            of: |row| row.critical_deg,
            colour: theme::CRITICAL,
            dash: theme::SOLID,
            marker: Marker::Diamond,
        },
    ];
    let degrees = |label| Axis::linear(label).range(0.0, 90.0).every(15.0);
    let mut curves = Panel::new(Axis::linear("index of refraction /{η} of the medium"), degrees("angle (degrees)"))
        .title("Special angles over the index of refraction");
    let names = angles.media.iter().map(|row| match row.medium.strip_prefix("η = ") {
        Some(_) => format!("/{{η}} = {}", row.eta_t),
        None => format!("{} ({:.3})", row.medium, row.eta_t),
    });
    let mut media = Panel::new(degrees("angle (degrees)"), Axis::named("", names.collect::<Vec<_>>()))
        .title("Special angles of some media (index at 587.56 nm)");
    for Angle { label, of, colour, dash, marker } in kinds {
        let at = |row: &AnglesRow| of(row).unwrap_or(f64::NAN);
        let line: Vec<Point> = angles.curves.iter().map(|row| [row.eta_t, at(row)]).collect();
        let marked: Vec<Point> = angles.media.iter().map(|row| [row.eta_t, at(row)]).collect();
        let named: Vec<Point> = angles.media.iter().enumerate().map(|(i, row)| [at(row), i as f64 + 0.5]).collect();
        let stroke = Stroke { colour, width: theme::BOLD, dash };
        curves = curves.line(label.clone(), stroke, line).markers(label.clone(), colour, marker, marked);
        media = media.markers(label, colour, marker, named);
    }
    let curves = curves.with_names_on_curves();
    Plot::new(if angles.media.is_empty() { vec![curves] } else { vec![curves, media] }).frame_size(400.0, 320.0).draw()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_has_its_index_once() {
        let sides = [side(1.0, "glass"), side(1.45, "η = 1.45"), side(1.45, "1.45"), side(1.5, "glass")];
        assert_eq!(sides, ["air", "/{η} = 1.45", "/{η} = 1.45", "glass (/{η} = 1.5)"]);
    }
}
