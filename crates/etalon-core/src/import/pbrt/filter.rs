//! `PixelFilter`: the filter of the pixels, with the names and defaults of each version.

use super::params::Params;
use crate::error::Result;
use crate::import::number::Rule;
use crate::sampling::filter::RANGE;
use crate::scene::{FilterShape, PixelFilter};

/// A `PixelFilter`. The default radius of a Gaussian depends on the version of pbrt.
pub struct Filter {
    shape: FilterShape,
    radius: [Option<f64>; 2],
    /// Whether pbrt-v4 wrote it, where the names of parameters say so.
    v4: Option<bool>,
}

/// Radii and σ.
const PIXELS: Rule = Rule(|x| (RANGE[0]..=RANGE[1]).contains(&x), "from 0.01 to 16 pixels");
/// α of a σ within this range.
const ALPHA: Rule = Rule(|x| (0.002..=5000.0).contains(&x), "from 0.002 to 5000");

impl Filter {
    /// `PixelFilter`: pbrt-v4 has `xradius`, `yradius` and `sigma`, its predecessors `xwidth` and `ywidth`, which are radii, too, and
    /// `alpha` = 1/(2σ²).
    pub fn read(p: &Params, warnings: &mut Vec<String>) -> Result<Self> {
        let is_any_given = |names: [&str; 3]| names.iter().any(|name| p.has_type(name, "float"));
        let v4 = is_any_given(["xradius", "yradius", "sigma"]);
        let shape = match p.kind.as_str() {
            "box" => FilterShape::Box,
            "triangle" => FilterShape::Triangle,
            "gaussian" if v4 => FilterShape::Gaussian { sigma: p.float("sigma", &PIXELS)?.unwrap_or(0.5) },
            "gaussian" => {
                let alpha = p.float("alpha", &ALPHA)?.unwrap_or(2.0);
                FilterShape::Gaussian { sigma: (2.0 * alpha).sqrt().recip() }
            }
            "mitchell" | "sinc" => {
                let message = format!("{} has negative lobes: film positions cannot be sampled by it", p.owner);
                return Err(p.at.unsupported(message).with_hint("supported: box, triangle, gaussian"));
            }
            _ => return Err(p.unsupported_kind("box, triangle, gaussian")),
        };
        let names = if v4 { ["xradius", "yradius"] } else { ["xwidth", "ywidth"] };
        let radius = [p.float(names[0], &PIXELS)?, p.float(names[1], &PIXELS)?];
        p.finish(&[], warnings)?;
        let v4 = (v4 || is_any_given(["xwidth", "ywidth", "alpha"])).then_some(v4);
        Ok(Self { shape, radius, v4 })
    }

    /// The filter, where the film is pbrt-v4's or not.
    pub fn finish(self, film_is_v4: bool) -> Result<PixelFilter> {
        let usual = match self.shape {
            FilterShape::Box => 0.5,
            FilterShape::Triangle => 2.0,
            FilterShape::Gaussian { .. } if self.v4.unwrap_or(film_is_v4) => 1.5,
            FilterShape::Gaussian { .. } => 2.0,
        };
        PixelFilter::new(self.shape, self.radius.map(|radius| radius.unwrap_or(usual)))
    }
}
