//! Drawings of reflectance curves.

use super::text::capitalized;
use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use etalon_bench::{fresnel, metal};

pub(super) fn stroke(colour: crate::figure::Colour, dash: &'static [f64]) -> Stroke {
    Stroke { colour, width: theme::LINE, dash }
}

pub(super) fn angle_axis() -> Axis {
    Axis::linear("angle of incidence /{θ} (degrees)").range(0.0, 90.0).every(15.0)
}

/// Curves of one interface, and beside them Schlick's error.
pub fn dielectric(curves: &fresnel::DielectricCurves) -> Drawing {
    let of = |f: fn(&fresnel::DielectricRow) -> f64| -> Vec<Point> {
        curves.rows.iter().map(|r| [r.theta_deg, f(r)]).collect()
    };
    let title = format!("From /{{η}} = {} into /{{η}} = {}", curves.eta_i, curves.eta_t);
    let schlick = match (curves.critical_deg, curves.model) {
        (None, _) => "Schlick",
        (Some(_), "exact") => "Schlick, angle of refraction",
        (Some(_), _) => "Schlick, angle of incidence",
    };
    // Room above 1 and below 0, where curves run along both
    let share = Axis::linear("share of the power").range(-0.04, 1.04).every(0.2);
    let mut main = Panel::new(angle_axis(), share)
        .title(title)
        .line("/{R}_{∥}", stroke(theme::R_PARALLEL, theme::SOLID), of(|r| r.r_parallel))
        .line("/{R}_{⊥}", stroke(theme::R_PERPENDICULAR, theme::SOLID), of(|r| r.r_perpendicular))
        .line("/{R} unpolarized", stroke(theme::UNPOLARIZED, theme::SOLID), of(|r| r.r_unpolarized))
        .line("/{T} = 1 − /{R}", stroke(theme::TRANSMITTANCE, theme::DASH_DOT), of(|r| r.transmittance))
        .line(schlick, stroke(theme::SCHLICK, theme::DASHED), of(|r| r.r_schlick));
    let special = |colour| Stroke { colour, width: theme::BOLD, dash: theme::DASHED };
    if let Some(brewster) = curves.brewster_deg {
        let label = format!("Brewster's angle /{{θ}}_{{B}} = {brewster:.2}°");
        main = main.vertical_above(brewster, label, special(theme::BREWSTER));
    }
    if let Some(critical) = curves.critical_deg {
        if curves.model == "exact" {
            let inside = curves.rows.iter().filter(|row| row.theta_deg <= critical);
            let points: Vec<Point> = inside.map(|row| [row.theta_deg, row.r_schlick_incident]).collect();
            main = main.line("Schlick, angle of incidence", stroke(theme::SCHLICK, theme::SOLID), points);
        }
        let label = format!("critical angle /{{θ}}_{{c}} = {critical:.2}°");
        main = main.vertical_above(critical, label, special(theme::CRITICAL));
        if curves.rows.last().is_some_and(|last| last.theta_deg > critical) {
            main = total_reflection(main, critical);
        }
    }
    let error = |r: &fresnel::DielectricRow| r.r_schlick - r.r_unpolarized;
    let relative = |r: &fresnel::DielectricRow| 100.0 * error(r) / r.r_unpolarized;
    let panel = |title: &str, label: &str, points: Vec<Point>| {
        let panel = Panel::new(angle_axis(), Axis::linear(label)).title(title).horizontal(0.0, "");
        panel.line("", stroke(theme::SCHLICK, theme::DASHED), points)
    };
    let points = |f: &dyn Fn(&fresnel::DielectricRow) -> f64| -> Vec<Point> {
        curves.rows.iter().map(|r| [r.theta_deg, f(r)]).collect()
    };
    let whose = if curves.model == "exact" && curves.critical_deg.is_some() { " (angle of refraction)" } else { "" };
    let absolute = panel(&format!("Schlick's error{whose}"), "Schlick − exact", points(&error));
    let relative =
        panel(&format!("Schlick's relative error{whose}"), "(Schlick − exact) / exact (%)", points(&relative));
    Plot::new([main, absolute, relative]).frame_size(350.0, 290.0).draw()
}

/// What happens beyond the critical angle.
fn total_reflection(panel: Panel, critical: f64) -> Panel {
    let lines = [
        (0.74, "total internal reflection"),
        (0.65, "/{R} = 1,  /{T} = 0"),
        (0.50, "outside: an evanescent"),
        (0.41, "wave, which decays"),
        (0.32, "exponentially and carries"),
        (0.23, "no power away"),
    ];
    let middle = 0.5 * (critical + 90.0);
    let panel = panel.shade(critical, 90.0, theme::TOTAL_REFLECTION);
    lines.into_iter().fold(panel, |panel, (y, text)| panel.note([middle, y], text, theme::INK))
}

/// Exact, approximate and Schlick reflectance per channel, and the errors of both approximations.
pub fn metal(curves: &metal::ConductorCurves) -> Drawing {
    // The channels have one legend, below the last of them
    let is_last = |i: usize| i + 1 == curves.channels.len();
    let channels = curves.channels.iter().enumerate();
    let mut panels: Vec<Panel> = channels.map(|(i, c)| channel(&curves.metal, c, is_last(i))).collect();
    panels.push(errors(curves));
    Plot::grid(panels.chunks(2).map(|pair| (String::new(), pair.to_vec()))).draw()
}

fn channel(metal: &str, c: &metal::Channel, legend: bool) -> Panel {
    let label = |text: &'static str| if legend { text } else { "" };
    let of =
        |f: fn(&metal::ConductorRow) -> f64| -> Vec<Point> { c.rows.iter().map(|r| [r.theta_deg, f(r)]).collect() };
    // Metals reflect most of the light: show the part of the axis where something happens.
    let lowest = of(|r| r.r_parallel.min(r.r_parallel_approximate)).iter().map(|p| p[1]).fold(1.0, f64::min);
    let title = if c.name.contains("nm") {
        format!("{}, {}: /{{η}} = {}, /{{k}} = {}", capitalized(metal), c.name, c.eta, c.k)
    } else {
        c.name.clone()
    };
    Panel::new(angle_axis(), Axis::linear("reflectance").range((lowest * 10.0).floor() / 10.0, 1.0))
        .title(title)
        .line(label("/{R}_{∥}"), stroke(theme::R_PARALLEL, theme::SOLID), of(|r| r.r_parallel))
        .line(label("/{R}_{⊥}"), stroke(theme::R_PERPENDICULAR, theme::SOLID), of(|r| r.r_perpendicular))
        .line(label("/{F}"), stroke(theme::UNPOLARIZED, theme::SOLID), of(|r| r.r_unpolarized))
        .line(label("/{R}_{∥} approximate"), stroke(theme::R_PARALLEL, theme::DOTTED), of(|r| r.r_parallel_approximate))
        .line(
            label("/{R}_{⊥} approximate"),
            stroke(theme::R_PERPENDICULAR, theme::DOTTED),
            of(|r| r.r_perpendicular_approximate),
        )
        .line(label("/{F} approximate"), stroke(theme::UNPOLARIZED, theme::DOTTED), of(|r| r.r_unpolarized_approximate))
        .line(label("Schlick"), stroke(theme::SCHLICK, theme::DASHED), of(|r| r.r_schlick))
        .vertical(c.pseudo_brewster_deg, format!("pseudo-Brewster angle {:.1}°", c.pseudo_brewster_deg))
}

fn errors(curves: &metal::ConductorCurves) -> Panel {
    let colours = if curves.channels.len() == 1 { &[theme::UNPOLARIZED][..] } else { &theme::CHANNELS };
    let mut panel = Panel::new(angle_axis(), Axis::linear("error of /{F}")).title("Errors of the approximations");
    for (c, &colour) in curves.channels.iter().zip(colours) {
        let of = |f: fn(&metal::ConductorRow) -> f64| -> Vec<Point> {
            c.rows.iter().map(|r| [r.theta_deg, f(r) - r.r_unpolarized]).collect()
        };
        let name = if c.name.contains("nm") { c.name.as_str() } else { "" };
        panel = panel
            .line(format!("approximate {name}"), stroke(colour, theme::SOLID), of(|r| r.r_unpolarized_approximate))
            .line(format!("Schlick {name}"), stroke(colour, theme::DASHED), of(|r| r.r_schlick));
    }
    panel
}
