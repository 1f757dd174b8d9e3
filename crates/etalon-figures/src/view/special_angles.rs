//! Drawing of Brewster's angle and the critical angle over the index of refraction, and of those of named media.

use crate::figure::{Axis, Colour, Drawing, Marker, Panel, Plot, Point, Stroke, theme};
use etalon_bench::special_angles::{AngleCurves, AnglesRow};

/// An angle: its label, its place in the rows, and how it is drawn.
struct Angle {
    label: String,
    of: fn(&AnglesRow) -> Option<f64>,
    colour: Colour,
    dash: &'static [f64],
    marker: Marker,
}

/// Curves over the index beside the angles of each medium.
pub fn drawing(angles: &AngleCurves) -> Drawing {
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
        .title("Over the index of refraction");
    let names = angles.media.iter().map(|row| match row.medium.strip_prefix("η = ") {
        Some(_) => format!("/{{η}} = {}", row.eta_t),
        None => format!("{} ({:.3})", row.medium, row.eta_t),
    });
    let mut media = Panel::new(degrees("angle (degrees)"), Axis::named("", names.collect::<Vec<_>>()))
        .title("Of some media (index at 587.56 nm)");
    for Angle { label, of, colour, dash, marker } in kinds {
        let at = |row: &AnglesRow| of(row).unwrap_or(f64::NAN);
        let line: Vec<Point> = angles.curves.iter().map(|row| [row.eta_t, at(row)]).collect();
        let marked: Vec<Point> = angles.media.iter().map(|row| [row.eta_t, at(row)]).collect();
        let named: Vec<Point> = angles.media.iter().enumerate().map(|(i, row)| [at(row), i as f64 + 0.5]).collect();
        let stroke = Stroke { colour, width: theme::BOLD, dash };
        curves = curves.line(label.clone(), stroke, line).markers(label, theme::INK, marker, marked);
        media = media.markers("", colour, marker, named);
    }
    Plot::new(if angles.media.is_empty() { vec![curves] } else { vec![curves, media] }).frame_size(400.0, 320.0).draw()
}
