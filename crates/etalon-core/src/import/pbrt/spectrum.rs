//! Spectra in parameters: turned into RGB or an index of refraction, as the parameter means it.

use super::params::{Param, Params};
use crate::error::Result;
use crate::files::{read_bounded, without_bom};
use crate::import::place::{finite, quote};
use crate::optics::D_LINE_NM;
use crate::optics::colorimetry::{ILLUMINANTS, black_body, light_rgb, reflectance_rgb, rgb_of_chromaticity};
use crate::optics::media::{DIELECTRICS, Dielectric};
use crate::optics::metals::{self, METALS};
use std::path::Path;

/// Most bytes in a file of a spectrum.
const MAX_BYTES: u64 = 1 << 20;

/// What the spectra of a directive are.
#[derive(Clone, Copy, PartialEq)]
pub enum Meaning {
    /// Emission, scaled to a luminance of 1.
    Light,
    /// Reflectances, and the indices `eta` and `k`.
    Material,
}

/// A spectrum that a file names, or gives by samples.
enum Spectrum {
    /// A metal's `eta` or `k`, which the name says, in the three channels.
    Metal(&'static str, [f64; 3]),
    Glass(&'static Dielectric),
    /// Chromaticity.
    Illuminant([f64; 2]),
    Samples(Samples),
}

/// Wavelengths in nanometres, ascending, and values; linear between them and 0 outside, as in pbrt-v4.
struct Samples(Vec<[f64; 2]>);

impl Samples {
    fn new(numbers: &[f64]) -> std::result::Result<Self, String> {
        let (samples, rest) = numbers.as_chunks();
        if samples.is_empty() || !rest.is_empty() {
            return Err(format!("needs pairs of wavelength and value, not {} numbers", numbers.len()));
        }
        if let Some([a, b]) = samples.windows(2).map(|pair| [pair[0][0], pair[1][0]]).find(|[a, b]| a >= b) {
            return Err(format!("must have ascending wavelengths, not {b} after {a}"));
        }
        match samples.iter().flatten().find(|number| !(0.0..=1e30).contains(*number)) {
            Some(bad) => Err(format!("must have numbers from 0 to 1e30, not {bad}")),
            None => Ok(Self(samples.to_vec())),
        }
    }

    fn covers(&self, nm: f64) -> bool {
        self.0.first().zip(self.0.last()).is_some_and(|(first, last)| (first[0]..=last[0]).contains(&nm))
    }

    fn at(&self, nm: f64) -> f64 {
        let above = self.0.partition_point(|sample| sample[0] < nm);
        match (above.checked_sub(1).map(|below| self.0[below]), self.0.get(above)) {
            (Some(below), Some(above)) => below[1] + (nm - below[0]) / (above[0] - below[0]) * (above[1] - below[1]),
            (None, Some(first)) if first[0] == nm => first[1],
            _ => 0.0,
        }
    }

    fn is_constant(&self) -> bool {
        self.0.iter().all(|sample| sample[1] == self.0[0][1])
    }
}

impl Params {
    /// Replaces spectra and black bodies among the parameters by what the renderer computes with: RGB; for the `eta` and `k`
    /// of metals the values at the three channels' wavelengths, for the `eta` of others that of the d line. Names of files
    /// are relative to `folder`; `v4` says whether pbrt-v4 wrote the file.
    pub fn resolve_spectra(
        &mut self,
        meaning: Meaning,
        v4: bool,
        folder: &Path,
        warnings: &mut Vec<String>,
    ) -> Result<()> {
        let is_metal = matches!(self.kind.as_str(), "metal" | "conductor");
        for (name, param) in &mut self.given {
            let values = match (param.type_name.as_str(), meaning) {
                // An amount of light from a spectrum depends on the version; colours do not.
                ("spectrum" | "blackbody", Meaning::Light) if !v4 => {
                    let message = format!("{}: {} of pbrt-v2 and v3 is not supported", self.owner, param.label);
                    return Err(param
                        .at
                        .unsupported(message)
                        .with_hint("give it as rgb, or the Film of pbrt-v4, \"rgb\""));
                }
                ("blackbody", Meaning::Light) => param.black_body(&self.owner, warnings)?.to_vec(),
                ("spectrum", Meaning::Light) => param.light(&self.owner, folder, warnings)?.to_vec(),
                ("spectrum", Meaning::Material) if ["eta", "k"].contains(&name.as_str()) => {
                    param.index(name, is_metal, &self.owner, folder, warnings)?
                }
                ("spectrum", Meaning::Material) => param.reflectance(&self.owner, folder, warnings)?.to_vec(),
                _ => continue,
            };
            param.type_name = if values.len() == 1 { "float" } else { "rgb" }.into();
            (param.numbers, param.texts) = (values, Vec::new());
        }
        Ok(())
    }
}

impl Param {
    /// Black bodies have no amount in pbrt-v4, either: they have a luminance of 1.
    fn black_body(&self, owner: &str, warnings: &mut Vec<String>) -> Result<[f64; 3]> {
        match *self.numbers {
            [kelvin] if (1e3..=1e9).contains(&kelvin) => {
                let rgb = light_rgb(|nm| black_body(kelvin, nm));
                let rgb = rgb.ok_or_else(|| self.at.input(format!("{owner}: {} has no visible light", self.label)))?;
                Ok(self.in_gamut(rgb, f64::INFINITY, owner, warnings))
            }
            [kelvin] => {
                let message = format!("{owner}: {} must be from 1000 to 1e9 kelvin, not {kelvin}", self.label);
                Err(self.at.input(message))
            }
            _ => {
                let message = format!("{owner}: {} needs 1 number, not {}", self.label, self.numbers.len());
                Err(self.at.input(message).with_hint("scale is a parameter of its own in pbrt-v4"))
            }
        }
    }

    fn light(&self, owner: &str, folder: &Path, warnings: &mut Vec<String>) -> Result<[f64; 3]> {
        let rgb = match self.spectrum(owner, folder)? {
            Spectrum::Illuminant(chromaticity) => rgb_of_chromaticity(chromaticity),
            Spectrum::Samples(samples) => light_rgb(|nm| samples.at(nm))
                .ok_or_else(|| self.at.input(format!("{owner}: {} has no visible light", self.label)))?,
            Spectrum::Metal(..) | Spectrum::Glass(_) => return Err(self.misplaced(owner, "light")),
        };
        Ok(self.in_gamut(rgb, f64::INFINITY, owner, warnings))
    }

    fn reflectance(&self, owner: &str, folder: &Path, warnings: &mut Vec<String>) -> Result<[f64; 3]> {
        let Spectrum::Samples(samples) = self.spectrum(owner, folder)? else {
            return Err(self.misplaced(owner, "a reflectance"));
        };
        if let Some([nm, bad]) = samples.0.iter().find(|sample| sample[1] > 1.0) {
            return Err(self.at.input(format!("{owner}: {} must be from 0 to 1, not {bad} at {nm} nm", self.label)));
        }
        Ok(self.in_gamut(reflectance_rgb(|nm| samples.at(nm)), 1.0, owner, warnings))
    }

    /// `eta` or `k`: in the three channels, or one number.
    fn index(
        &self,
        name: &str,
        in_channels: bool,
        owner: &str,
        folder: &Path,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<f64>> {
        let places = if in_channels { &metals::WAVELENGTHS_NM[..] } else { &[D_LINE_NM] };
        let list = places.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let (values, constant) = match self.spectrum(owner, folder)? {
            Spectrum::Metal(quantity, values) if in_channels && quantity == name => (values.to_vec(), false),
            Spectrum::Glass(glass) if name == "eta" => (places.iter().map(|&nm| glass.index(nm)).collect(), false),
            Spectrum::Samples(samples) => {
                if !places.iter().all(|&nm| samples.covers(nm)) {
                    let message = format!("{owner}: {} does not cover the wavelengths {list} nm", self.label);
                    return Err(self.at.input(message));
                }
                (places.iter().map(|&nm| samples.at(nm)).collect(), samples.is_constant())
            }
            _ => return Err(self.misplaced(owner, &format!("the {name} of this material"))),
        };
        if !constant {
            let without = if in_channels { "" } else { ", without dispersion" };
            warnings.push(self.at.warning(&format!("{owner}: {} is taken at {list} nm{without}", self.label)));
        }
        Ok(values)
    }

    /// The spectrum that the parameter names, reads from a file, or lists.
    fn spectrum(&self, owner: &str, folder: &Path) -> Result<Spectrum> {
        let wrong = |what: String| self.at.input(format!("{owner}: {} {what}", self.label));
        let [name] = &*self.texts else {
            let single = self.texts.is_empty();
            let samples = if single { Samples::new(&self.numbers) } else { Err("needs one name".into()) };
            return samples.map(Spectrum::Samples).map_err(wrong);
        };
        if !self.numbers.is_empty() {
            return Err(wrong("needs a name or numbers, not both".into()));
        }
        if let Some(known) = named(name) {
            return Ok(known);
        }
        // pbrt's own names are no files, whatever lies in the folder.
        let families = ["metal-", "glass-", "stdillum-", "illum-"];
        let path = folder.join(name);
        if families.iter().any(|family| name.starts_with(family)) || !path.is_file() {
            let known: Vec<&str> = DIELECTRICS.iter().filter_map(|glass| glass.spectrum).collect();
            let metals: Vec<&str> = METALS.iter().map(|metal| metal.symbol).collect();
            let message = format!("{owner}: the spectrum {} is not known, and no file", quote(name));
            return Err(self.at.unsupported(message).with_hint(format!(
                "known: metal-X-eta and metal-X-k (X: {}), {}, stdillum-A, -D50, -D65, -F1 to -F12, illum-acesD60",
                metals.join(", "),
                known.join(", ")
            )));
        }
        let bytes = read_bounded(&path, MAX_BYTES).map_err(|e| self.at.cannot_read(e))?;
        let text = String::from_utf8_lossy(without_bom(&bytes));
        let words = text.lines().flat_map(|line| line.split('#').next().unwrap_or_default().split_ascii_whitespace());
        let numbers = words.map(finite).collect::<std::result::Result<Vec<_>, _>>();
        let samples = numbers.and_then(|numbers| Samples::new(&numbers));
        samples.map(Spectrum::Samples).map_err(|what| wrong(format!("({}) {what}", path.display())))
    }

    fn misplaced(&self, owner: &str, what: &str) -> crate::error::Error {
        let name = self.texts.first().map_or("", String::as_str);
        self.at.unsupported(format!("{owner}: the spectrum {} is not known as {what}", quote(name)))
    }

    /// The colour with its channels from 0 to `most`, and a warning where that changes more than rounding.
    fn in_gamut(&self, rgb: [f64; 3], most: f64, owner: &str, warnings: &mut Vec<String>) -> [f64; 3] {
        let clamped = rgb.map(|channel| channel.clamp(0.0, most));
        if rgb.iter().zip(clamped).any(|(before, after)| (before - after).abs() > 1e-6) {
            let message = format!("{owner}: the colour of {} is outside of sRGB: clamped", self.label);
            warnings.push(self.at.warning(&message));
        }
        clamped
    }
}

/// A spectrum by pbrt-v4's name.
fn named(name: &str) -> Option<Spectrum> {
    if let Some(glass) = DIELECTRICS.iter().find(|glass| glass.spectrum == Some(name)) {
        return Some(Spectrum::Glass(glass));
    }
    if let Some((_, chromaticity)) = ILLUMINANTS.iter().find(|(known, _)| *known == name) {
        return Some(Spectrum::Illuminant(*chromaticity));
    }
    let (symbol, quantity) = name.strip_prefix("metal-")?.split_once('-')?;
    let metal = METALS.iter().find(|metal| metal.symbol == symbol)?;
    match quantity {
        "eta" => Some(Spectrum::Metal("eta", metal.eta)),
        "k" => Some(Spectrum::Metal("k", metal.k)),
        _ => None,
    }
}
