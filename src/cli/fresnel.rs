//! `etalon fresnel`: reflectance curves of one interface, or of several media side by side, and their special angles.

use super::console::Console;
use super::global::{Global, Verdict, out};
use super::style::StyleArgs;
use super::values::{choice, model};
use clap::{ArgAction, Args};
use etalon_bench::media::Interface;
use etalon_bench::table::Table;
use etalon_bench::{fresnel, media as study, metal};
use etalon_core::errata::Formulas;
use etalon_core::error::{Error, Result};
use etalon_core::optics::media::{self, Medium};
use etalon_core::optics::{D_LINE_NM, metals};
use etalon_figures::figure::Drawing;
use etalon_figures::output;
use etalon_figures::view::fresnel::{self as view, CURVES, Curve};
use etalon_figures::view::text::rounded;
use serde::Serialize;

/// Plot the reflectance of dielectrics and metals over the angle of incidence
#[derive(Args)]
#[command(
    after_long_help = "Examples:\n  etalon fresnel --eta-i 1.45 --eta-t 1\n  etalon fresnel --metal Au\n  etalon \
                        fresnel water diamond --metal Au\n  etalon fresnel water diamond --show unpolarized,schlick,error\n  \
                        etalon fresnel glass --both\n  etalon fresnel --eta-t 0.2 --k 3.9\n  etalon fresnel --angles"
)]
#[command(next_help_heading = "Media", args = [out()])]
pub struct Fresnel {
    /// Media on the other side, by name or index (see --list)
    ///
    /// One is drawn with all its curves; several are drawn in one panel, at 587.56 nm.
    #[arg(value_name = "MEDIUM", allow_negative_numbers = true, conflicts_with_all = ["k", "eta_t"])]
    media: Vec<String>,
    /// Index of refraction where light comes from: a number, air or a dielectric
    #[arg(long, value_name = "ETA", default_value = "1", value_parser = index, allow_negative_numbers = true)]
    eta_i: Interface,
    /// Index of refraction on the other side: a number, air or a dielectric
    #[arg(long, value_name = "ETA", default_value = "1.45", value_parser = index, allow_negative_numbers = true)]
    eta_t: Interface,
    /// Metals, by symbol or name
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', action = ArgAction::Set)]
    #[arg(long_help = metal_help(), conflicts_with_all = ["k", "eta_t"])]
    metal: Vec<String>,
    /// Extinction coefficient: makes the other side a conductor of index ETA + iK
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    k: Option<f64>,
    /// List the media known by name, with their sources
    #[arg(long, conflicts_with_all = ["media", "metal", "k", "eta_i", "eta_t", "show", "both", "points", "model", "angles", "out"])]
    list: bool,
    /// Plot Brewster's angle and the critical angle over the index of refraction
    ///
    /// The angles of each MEDIUM are marked; by default those of all dielectrics of --list.
    #[arg(help_heading = "Curves", long, conflicts_with_all = ["metal", "k", "eta_t", "show", "model"])]
    angles: bool,
    /// The curves to draw, of each medium in one panel
    ///
    /// By default a single medium is drawn with all its curves, and several with `unpolarized`.
    #[arg(help_heading = "Curves", long, value_name = "CURVE,...", value_delimiter = ',', action = ArgAction::Set)]
    #[arg(value_parser = choice(CURVES))]
    show: Option<Vec<Curve>>,
    /// Draw light that enters a dielectric beside light that leaves it
    #[arg(help_heading = "Curves", long, conflicts_with_all = ["metal", "k", "angles"])]
    both: bool,
    /// Number of angles from 0 to 90 degrees; with --angles of indices
    #[arg(help_heading = "Curves", long, value_name = "N", default_value_t = 901)]
    points: usize,
    /// The correct formulas, or what the first report plots
    ///
    /// `report`: Schlick with the incident cosine on the exit side (an error of up to 0.97 beside the critical angle), curves
    /// ended at the critical angle.
    #[arg(help_heading = "Curves", long, value_parser = model(), default_value = "exact")]
    model: Formulas,
    #[command(flatten)]
    style: StyleArgs,
}

/// Reads an index of refraction, or the name of a dielectric, at the d line.
fn index(text: &str) -> std::result::Result<Interface, String> {
    let by_name = |_| match media::by_name(text) {
        Some(medium @ Medium::Dielectric(_)) => Ok(Interface::of(medium)),
        _ => Err("not a number, nor a dielectric of --list".to_owned()),
    };
    if text == "air" {
        Ok(Interface::dielectric(1.0))
    } else {
        text.parse().map(Interface::dielectric).or_else(by_name)
    }
}

fn metal_help() -> String {
    let [r, g, b] = metals::WAVELENGTHS_NM;
    let known: Vec<String> = metals::METALS.iter().map(|m| format!("{}: {}", m.symbol, m.source)).collect();
    format!("Metals, by symbol or name. One alone is drawn at {r}, {g} and {b} nm. {}", known.join("; "))
}

/// Curves of light that enters a medium, and with --both of light that leaves it.
#[derive(Serialize)]
struct Sides<T> {
    #[serde(flatten)]
    entering: T,
    #[serde(skip_serializing_if = "Option::is_none")]
    leaving: Option<T>,
}

impl<T> Sides<T> {
    fn all(&self) -> impl Iterator<Item = &T> {
        std::iter::once(&self.entering).chain(&self.leaving)
    }
}

/// The curves that --both draws by default.
const BOTH: [Curve; 7] = [
    Curve::Parallel,
    Curve::Perpendicular,
    Curve::Unpolarized,
    Curve::Transmittance,
    Curve::Schlick,
    Curve::Brewster,
    Curve::Critical,
];

/// An entry of `--list`.
#[derive(Serialize)]
struct Listed {
    name: String,
    kind: &'static str,
    eta: f64,
    k: f64,
    source: &'static str,
}

impl Fresnel {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        if self.list {
            list(console);
            return Ok(Verdict::Good);
        }
        let mut interfaces = self.media.iter().map(|name| Interface::named(name)).collect::<Result<Vec<_>>>()?;
        if self.angles {
            return self.angles(&interfaces, global, console);
        }
        for name in &self.metal {
            interfaces.push(Interface::of(Medium::Metal(metal::find(name)?)));
        }
        if self.model != Formulas::Exact && (self.k.is_some() || interfaces.iter().any(|other| other.k > 0.0)) {
            return Err(Error::parameter("model", "the first report plots no metals")
                .with_hint("the second report's approximation is always plotted beside the exact curves"));
        }
        let is_equal = |other: &&Interface| other.k == 0.0 && other.eta == self.eta_i.eta;
        let unnamed = [self.eta_t.clone()];
        let others = if interfaces.is_empty() && self.k.is_none() { &unnamed[..] } else { &interfaces };
        if let Some(equal) = others.iter().find(is_equal) {
            let eta = rounded(self.eta_i.eta, 5);
            console.warn(&format!("{}: both sides have the index {eta}, so that nothing is reflected", equal.name));
        }
        if self.both && (others.len() != 1 || others[0].k > 0.0) {
            return Err(Error::parameter("both", "light enters and leaves one dielectric")
                .with_hint("give one medium: `etalon fresnel glass --both`"));
        }
        let has_curves = self.show.is_some() || self.both;
        match &*interfaces {
            [] if !has_curves => match self.k {
                Some(k) => {
                    let curves = metal::by_index(self.eta_i.eta, self.eta_t.eta, k, self.points)?;
                    self.metal(&curves, "-index", global, console)
                }
                None => self.dielectric(&self.eta_t, "", global, console),
            },
            [] => {
                let mut interface = self.eta_t.clone();
                if let Some(k) = self.k {
                    interface = Interface { name: format!("η = {}, k = {k}", interface.eta), k, ..interface };
                }
                self.side_by_side(&[interface], "", global, console)
            }
            [only] if !has_curves => {
                let name = format!("-{}", only.short);
                match only.medium {
                    Some(Medium::Metal(metal)) => {
                        let curves = metal::of_metal(self.eta_i.eta, metal, self.points)?;
                        self.metal(&curves, &name, global, console)
                    }
                    _ => self.dielectric(only, &name, global, console),
                }
            }
            several => {
                let names: String = several.iter().map(|interface| format!("-{}", interface.short)).collect();
                self.side_by_side(several, &names, global, console)
            }
        }
    }

    /// Writes the figure and its table; `name` is what they are about.
    fn write(&self, name: &str, drawing: &Drawing, table: &[u8], global: &Global) -> Result<output::Written> {
        let target = global.target();
        let stem = target.stem(&format!("fresnel{name}"), "", &output::STUDY)?;
        Ok(target.written(output::write(&stem, drawing, &self.style.style()?, table)?))
    }

    fn side_by_side(
        &self,
        interfaces: &[Interface],
        names: &str,
        global: &Global,
        console: &Console,
    ) -> Result<Verdict> {
        let curves = |from, interfaces: &[_]| study::curves(from, interfaces, self.points, self.model);
        let leaving = self.both.then(|| curves(&interfaces[0], std::slice::from_ref(&self.eta_i))).transpose()?;
        let curves = Sides { entering: curves(&self.eta_i, interfaces)?, leaving };
        let sides: Vec<_> = curves.all().cloned().collect();
        let (usual, ending) = if self.both { (&BOTH[..], "-both") } else { (&[Curve::Unpolarized][..], "") };
        let drawing = view::of_media(&sides, self.show.as_deref().unwrap_or(usual));
        // Where light comes from tells the two sides of one medium apart
        let name = |from: &str, medium: &str| match self.both {
            true => format!("{from} to {medium}"),
            false => medium.to_owned(),
        };
        let of_side = |side: &study::MediaCurves| {
            side.media.iter().map(|medium| (name(&side.from, &medium.name), medium.clone())).collect::<Vec<_>>()
        };
        let written = self.write(&format!("{names}{ending}"), &drawing, &study::csv(&sides)?, global)?;
        console.saved(&curves, &written, || {
            let angle = |a: Option<f64>| a.map_or("none".into(), |a| format!("{a:.2}°"));
            Table::of(&sides.iter().flat_map(of_side).collect::<Vec<_>>())
                .words("medium", |(name, _)| name)
                .numbers("eta", |(_, c)| format!("{:.4}", c.eta))
                .numbers("k", |(_, c)| format!("{:.4}", c.k))
                .numbers("R at 0°", |(_, c)| format!("{:.5}", c.r_normal))
                .numbers("Brewster", |(_, c)| angle(c.brewster_deg))
                .numbers("critical", |(_, c)| angle(c.critical_deg))
                .numbers("largest error of Schlick", |(_, c)| {
                    format!("{:.4} at {:.1}°", c.schlick_max_abs_error, c.schlick_max_abs_error_deg)
                })
                .text_with(|(_, c), line| {
                    line + &c.source.map_or(String::new(), |source| format!("  index: {source}\n"))
                })
        });
        Ok(Verdict::Good)
    }

    fn angles(&self, media: &[Interface], global: &Global, console: &Console) -> Result<Verdict> {
        let all = || media::DIELECTRICS.iter().map(|dielectric| Interface::of(Medium::Dielectric(dielectric)));
        let marked = if media.is_empty() { all().collect() } else { media.to_vec() };
        let angles = study::special_angles(self.eta_i.eta, &marked, self.points)?;
        let rows: Vec<_> = angles.curves.iter().chain(&angles.media).cloned().collect();
        let names: String = media.iter().map(|interface| format!("-{}", interface.short)).collect();
        let drawing = view::of_special_angles(&angles);
        let written = self.write(&format!("-angles{names}"), &drawing, &output::csv(&rows)?, global)?;
        console.saved(&angles, &written, || {
            let angle = |a: Option<f64>| a.map_or("none".into(), |a| format!("{a:.6}°"));
            Table::of(&angles.media)
                .words("medium", |row| &row.medium)
                .numbers("eta", |row| format!("{:.4}", row.eta_t))
                .numbers("Brewster", |row| angle(row.brewster_deg))
                .numbers("from inside", |row| angle(row.brewster_reverse_deg))
                .numbers("critical", |row| angle(row.critical_deg))
                .text()
        });
        Ok(Verdict::Good)
    }

    fn dielectric(&self, interface: &Interface, name: &str, global: &Global, console: &Console) -> Result<Verdict> {
        let curves = fresnel::curves(self.eta_i.eta, interface.eta, self.points, self.model)?;
        let written =
            self.write(name, &view::dielectric(&curves, [&self.eta_i.name, &interface.name]), &curves.csv()?, global)?;
        console.saved(&curves, &written, || {
            let angle = |a: Option<f64>| a.map_or("none".into(), |a| format!("{a:.6}°"));
            let source = interface.medium.map_or(String::new(), |medium| format!("  ({})", medium.source()));
            // An index from a dispersion formula has no more digits than its source.
            let index = |eta: f64| {
                let [exact, short] = [eta.to_string(), format!("{eta:.4}")];
                if source.is_empty() || exact.len() < short.len() { exact } else { short }
            };
            let [eta_i, eta_t] = [curves.eta_i, curves.eta_t].map(index);
            let at = |error: f64, theta: f64| format!("{error:.6} at {theta:.2}°");
            let lines = [
                ("reflectance at normal incidence", format!("{:.9} (both components)", curves.r_normal)),
                ("Brewster angle", angle(curves.brewster_deg)),
                ("critical angle", angle(curves.critical_deg)),
                (
                    "Schlick's largest absolute error",
                    at(curves.schlick_max_abs_error, curves.schlick_max_abs_error_deg),
                ),
                (
                    "Schlick's largest relative error",
                    at(curves.schlick_max_rel_error, curves.schlick_max_rel_error_deg),
                ),
            ];
            let lines = Table::of(&lines).words("", |line| line.0).words("", |line| &line.1).text();
            format!("eta {eta_i} -> {eta_t}{source}\n{lines}")
        });
        Ok(Verdict::Good)
    }

    fn metal(
        &self,
        curves: &metal::ConductorCurves,
        name: &str,
        global: &Global,
        console: &Console,
    ) -> Result<Verdict> {
        let written = self.write(name, &view::metal(curves), &curves.csv()?, global)?;
        if let Some(c) = curves.channels.iter().find(|c| c.eta * c.eta + c.k * c.k < 5.0) {
            console.warn(&format!(
                "{}: the second report's approximation is unusable for eta² + k² = {:.1} < 5",
                c.name,
                c.eta * c.eta + c.k * c.k
            ));
        }
        console.saved(curves, &written, || {
            let source = curves.source.map_or(String::new(), |source| format!(", η and k: {source}"));
            let mut text = format!("{}{source}\n", curves.metal);
            for c in &curves.channels {
                text += &format!(
                    "{}: eta {} k {}, reflectance at normal incidence {:.6}, pseudo-Brewster angle {:.3}°,\n  \
                     largest error: approximation {:.5} at {:.1}°, Schlick {:.5} at {:.1}°\n",
                    c.name,
                    c.eta,
                    c.k,
                    c.r_normal,
                    c.pseudo_brewster_deg,
                    c.approximate_max_abs_error,
                    c.approximate_max_abs_error_deg,
                    c.schlick_max_abs_error,
                    c.schlick_max_abs_error_deg
                );
            }
            text
        });
        Ok(Verdict::Good)
    }
}

fn list(console: &Console) {
    let listed = |medium: Medium| {
        let [eta, k] = medium.index_d();
        let kind = match medium {
            Medium::Dielectric(_) => "dielectric",
            Medium::Metal(_) => "metal",
        };
        Listed { name: medium.name(), kind, eta, k, source: medium.source() }
    };
    let list: Vec<Listed> = media::all().map(listed).collect();
    console.result(&std::collections::BTreeMap::from([("media", &list)]), || {
        Table::of(&list)
            .words("medium", |m| &m.name)
            .words("kind", |m| m.kind)
            .numbers("n", |m| format!("{:.4}", m.eta))
            .numbers("k", |m| format!("{:.4}", m.k))
            .words(format!("source (n and k at {D_LINE_NM} nm)"), |m| m.source)
            .text()
    });
}
