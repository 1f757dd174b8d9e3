//! Drawing of the reflectance of several media in one panel, and of Schlick's error beside it.

use super::fresnel::{angle_axis, stroke};
use crate::figure::{Axis, Colour, Drawing, Panel, Plot, Point, theme};
use etalon_bench::media::{MediaCurves, MediumRow};

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
}

/// All curves, with their names and what they are.
pub const CURVES: [(&str, &str, Curve); 6] = [
    ("unpolarized", "Reflectance of unpolarized light", Curve::Unpolarized),
    ("parallel", "Reflectance of parallel polarization", Curve::Parallel),
    ("perpendicular", "Reflectance of perpendicular polarization", Curve::Perpendicular),
    ("transmittance", "1 − R: refracted by a dielectric, absorbed by a metal", Curve::Transmittance),
    ("schlick", "Schlick's approximation of unpolarized light", Curve::Schlick),
    ("error", "Schlick − exact, in a panel of its own", Curve::Error),
];

impl Curve {
    fn value(self, row: &MediumRow) -> f64 {
        match self {
            Self::Unpolarized => row.r_unpolarized,
            Self::Parallel => row.r_parallel,
            Self::Perpendicular => row.r_perpendicular,
            Self::Transmittance => row.transmittance,
            Self::Schlick => row.r_schlick,
            Self::Error => row.r_schlick - row.r_unpolarized,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::Unpolarized => "/{R}",
            Self::Parallel => "/{R}_{∥}",
            Self::Perpendicular => "/{R}_{⊥}",
            Self::Transmittance => "1 − /{R}",
            Self::Schlick => "Schlick",
            Self::Error => "Schlick − exact",
        }
    }

    fn dash(self) -> &'static [f64] {
        match self {
            Self::Unpolarized | Self::Error => theme::SOLID,
            Self::Parallel => theme::DASHED,
            Self::Perpendicular => theme::DOTTED,
            Self::Transmittance => theme::DASH_DOT,
            Self::Schlick => theme::LONG_DASH,
        }
    }

    /// The colour where there is one medium, whose curves differ by colour, too.
    fn colour(self) -> Colour {
        match self {
            Self::Unpolarized => theme::UNPOLARIZED,
            Self::Parallel => theme::R_PARALLEL,
            Self::Perpendicular => theme::R_PERPENDICULAR,
            Self::Transmittance => theme::TRANSMITTANCE,
            Self::Schlick | Self::Error => theme::SCHLICK,
        }
    }
}

/// The curves `show` of all media: the colour tells the medium, the dash pattern the curve.
pub fn drawing(curves: &MediaCurves, show: &[Curve]) -> Drawing {
    let shares: Vec<Curve> = show.iter().copied().filter(|curve| *curve != Curve::Error).collect();
    let mut panels = Vec::new();
    let side = match &*curves.media {
        [only] => format!("From /{{η}} = {} into {}", curves.eta_i, only.name),
        _ => format!("Light from /{{η}} = {}", curves.eta_i),
    };
    if let [only] = *shares {
        let axis = Axis::linear(axis_name(only)).range(0.0, 1.0);
        panels.push(panel(curves, &shares, axis).title(side.clone()));
    } else if !shares.is_empty() {
        panels.push(panel(curves, &shares, Axis::linear("share of the power").range(0.0, 1.0)).title(side.clone()));
    }
    if show.contains(&Curve::Error) {
        let title = if shares.is_empty() { side } else { "Schlick's error".to_owned() };
        let axis = Axis::linear(axis_name(Curve::Error));
        panels.push(panel(curves, &[Curve::Error], axis).title(title).horizontal(0.0, ""));
    }
    Plot::new(panels).frame_size(420.0, 320.0).draw()
}

fn axis_name(only: Curve) -> &'static str {
    match only {
        Curve::Unpolarized => "reflectance of unpolarized light",
        Curve::Parallel => "reflectance of parallel polarization",
        Curve::Perpendicular => "reflectance of perpendicular polarization",
        Curve::Transmittance => "1 − reflectance of unpolarized light",
        Curve::Schlick => "reflectance by Schlick's approximation",
        Curve::Error => "Schlick − exact, of unpolarized light",
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
            let colour = if curves.media.len() == 1 { curve.colour() } else { theme::series(i).colour };
            let points: Vec<Point> = medium.rows.iter().map(|r| [r.theta_deg, curve.value(r)]).collect();
            panel = panel.line(label, stroke(colour, curve.dash()), points);
        }
    }
    panel
}
