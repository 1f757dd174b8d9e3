//! `etalon fresnel`: reflectance curves.

use super::console::Console;
use super::global::{Global, Verdict, out};
use super::values::model;
use crate::errata::Conventions;
use crate::error::{Error, Result};
use crate::optics::metals;
use crate::output;
use crate::study::{fresnel, metal};
use crate::view::fresnel as view;
use clap::Args;

/// Plot the reflectance of a dielectric or a metal over the angle of incidence
#[derive(Args)]
#[command(after_long_help = "Examples:\n  etalon fresnel\n  etalon fresnel --eta-i 1.45 --eta-t 1\n  etalon fresnel \
                        --metal Au\n  etalon fresnel --eta-t 0.2 --k 3.9")]
#[command(next_help_heading = "Media", args = [out()])]
pub struct Fresnel {
    /// Index of refraction on the side that the light comes from
    #[arg(long, value_name = "ETA", default_value_t = 1.0, allow_negative_numbers = true)]
    eta_i: f64,
    /// Index of refraction on the other side
    #[arg(long, value_name = "ETA", default_value_t = 1.45, allow_negative_numbers = true)]
    eta_t: f64,
    /// A metal, by symbol or name
    #[arg(long, value_name = "NAME", long_help = metal_help(), conflicts_with_all = ["k", "eta_i", "eta_t"])]
    metal: Option<String>,
    /// Extinction coefficient: makes the other side a conductor of index ETA + iK
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    k: Option<f64>,
    /// Number of angles from 0 to 90 degrees
    #[arg(long, value_name = "N", default_value_t = 901)]
    points: usize,
    /// The correct formulas, or what the first report plots
    ///
    /// `report`: Schlick with the incident cosine on the exit side (an error of up to 0.97 beside the critical angle), curves
    /// ended at the critical angle.
    #[arg(long, value_parser = model(), default_value = "exact")]
    model: Conventions,
}

fn metal_help() -> String {
    let [r, g, b] = metals::WAVELENGTHS_NM;
    let known: Vec<String> = metals::METALS.iter().map(|m| format!("{}: {}", m.symbol, m.source)).collect();
    format!("A metal at {r}, {g} and {b} nm, by symbol or name. {}", known.join("; "))
}

impl Fresnel {
    pub fn run(&self, global: &Global, console: &Console) -> Result<Verdict> {
        match (&self.metal, self.k) {
            (Some(name), _) => self.metal(&metal::by_name(name, self.points)?, name, global, console),
            (None, Some(k)) => {
                let curves = metal::by_index(self.eta_i, self.eta_t, k, self.points)?;
                self.metal(&curves, "index", global, console)
            }
            (None, None) => self.dielectric(global, console),
        }
    }

    fn dielectric(&self, global: &Global, console: &Console) -> Result<Verdict> {
        let curves = fresnel::curves(self.eta_i, self.eta_t, self.points, self.model)?;
        let target = global.target(&[]);
        let stem = target.stem("fresnel", "", &output::STUDY)?;
        let files = output::write(&stem, &view::dielectric(&curves), &output::table(&curves.rows)?)?;
        let written = target.written(files);
        console.saved(&curves, &written, || {
            let angle = |a: Option<f64>| a.map_or("none".into(), |a| format!("{a:.6}°"));
            format!(
                "eta {} -> {}\nreflectance at normal incidence  {:.9} (both components)\nBrewster angle                   {}\n\
                 critical angle                   {}\nSchlick's largest absolute error {:.6} at {:.2}°\n\
                 Schlick's largest relative error {:.6} at {:.2}°\n",
                curves.eta_i,
                curves.eta_t,
                curves.r_normal,
                angle(curves.brewster_deg),
                angle(curves.critical_deg),
                curves.schlick_max_abs_error,
                curves.schlick_max_abs_error_deg,
                curves.schlick_max_rel_error,
                curves.schlick_max_rel_error_deg,
            )
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
        if self.model != Conventions::CORRECT {
            return Err(Error::parameter("model", "the first report plots no metals")
                .with_hint("the second report's approximation is always plotted beside the exact curves"));
        }
        let rows: Vec<_> = curves.channels.iter().flat_map(|c| c.rows.iter().cloned()).collect();
        let target = global.target(&["metal"]);
        let stem = target.stem(&format!("fresnel-{name}"), "", &output::STUDY)?;
        let written = target.written(output::write(&stem, &view::metal(curves), &output::table(&rows)?)?);
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
