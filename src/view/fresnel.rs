//! Drawings of reflectance curves.

use crate::figure::{Axis, Drawing, Panel, Plot, Point, Stroke, theme};
use crate::study::{fresnel, metal};

fn stroke(colour: crate::figure::Colour, dash: &'static [f64]) -> Stroke {
    Stroke { colour, width: theme::LINE, dash }
}

fn angle_axis() -> Axis {
    Axis::linear("angle of incidence /{θ} (degrees)").range(0.0, 90.0).every(15.0)
}

/// Curves of one interface, and beside them Schlick's error.
pub fn dielectric(curves: &fresnel::DielectricCurves) -> Drawing {
    let of = |f: fn(&fresnel::DielectricRow) -> f64| -> Vec<Point> {
        curves.rows.iter().map(|r| [r.theta_deg, f(r)]).collect()
    };
    let title = format!("from /{{η}} = {} into /{{η}} = {}", curves.eta_i, curves.eta_t);
    let mut main = Panel::new(angle_axis(), Axis::linear("share of the power").range(0.0, 1.0))
        .title(title)
        .line("/{R}_{∥}", stroke(theme::R_PARALLEL, theme::SOLID), of(|r| r.r_parallel))
        .line("/{R}_{⊥}", stroke(theme::R_PERPENDICULAR, theme::SOLID), of(|r| r.r_perpendicular))
        .line("/{R} unpolarized", stroke(theme::UNPOLARIZED, theme::SOLID), of(|r| r.r_unpolarized))
        .line("/{T} = 1 − /{R}", stroke(theme::TRANSMITTANCE, theme::DASH_DOT), of(|r| r.transmittance))
        .line("Schlick", stroke(theme::SCHLICK, theme::DASHED), of(|r| r.r_schlick));
    if let Some(brewster) = curves.brewster_deg {
        main = main.vertical(brewster, format!("/{{θ}}_{{B}} = {brewster:.2}°"));
    }
    if let Some(critical) = curves.critical_deg {
        main = main.vertical(critical, format!("/{{θ}}_{{c}} = {critical:.2}°"));
    }
    let relative = of(|r| if r.r_unpolarized > 0.0 { (r.r_schlick - r.r_unpolarized) / r.r_unpolarized } else { 0.0 });
    let errors = Panel::new(angle_axis(), Axis::linear("error"))
        .title("Schlick against exact")
        .line("absolute", stroke(theme::SCHLICK, theme::SOLID), of(|r| r.r_schlick - r.r_unpolarized))
        .line("relative", stroke(theme::RELATIVE_ERROR, theme::DASHED), relative)
        .horizontal(0.0, "");
    Plot::new([main, errors]).draw()
}

/// Exact, approximate and Schlick reflectance per channel, and the errors of both approximations.
pub fn metal(curves: &metal::ConductorCurves) -> Drawing {
    // Panels of one row share a legend; the second row need not repeat it.
    let mut panels: Vec<Panel> =
        curves.channels.iter().enumerate().map(|(i, c)| channel(&curves.metal, c, i < 2)).collect();
    panels.push(errors(curves));
    let rows = panels.chunks(2).map(|pair| Plot::new(pair.to_vec()).frame_size(350.0, 240.0).draw());
    Drawing::stacked(rows.collect(), 0.0, 2.0)
}

fn channel(metal: &str, c: &metal::Channel, legend: bool) -> Panel {
    let label = |text: &'static str| if legend { text } else { "" };
    let of =
        |f: fn(&metal::ConductorRow) -> f64| -> Vec<Point> { c.rows.iter().map(|r| [r.theta_deg, f(r)]).collect() };
    // Metals reflect most of the light: show the part of the axis where something happens.
    let lowest = of(|r| r.r_parallel.min(r.r_parallel_approximate)).iter().map(|p| p[1]).fold(1.0, f64::min);
    let title = if c.name.contains("nm") {
        format!("{metal}, {}: /{{η}} = {}, /{{k}} = {}", c.name, c.eta, c.k)
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
        .vertical(c.pseudo_brewster_deg, format!("{:.1}°", c.pseudo_brewster_deg))
}

fn errors(curves: &metal::ConductorCurves) -> Panel {
    let colours = if curves.channels.len() == 1 { &[theme::UNPOLARIZED][..] } else { &theme::CHANNELS };
    let mut panel = Panel::new(angle_axis(), Axis::linear("error of /{F}")).title("approximations against exact");
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
