//! `Texture`: constants, images, checkerboards, products and mixes over (u, v); parameters that name one; the textures that
//! a file has named so far, and the images that they share.

use crate::error::{Error, Result};
use crate::import::pbrt::lexer::Lexer;
use crate::import::pbrt::params::Params;
use crate::import::pbrt::reader::Reader;
use crate::import::place::{At, FRACTION, Rule, quote};
use crate::math::{Rgb, mean_rgb};
use crate::memory;
use crate::raster::{ReadOptions, read_with_notes};
use crate::scene::{ImageTexture, Texels, Texture, UvMapping, Wrap};
use glam::DVec2;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Most textures inside a texture, each counted as often as it is named.
const MAX_PARTS: usize = 64;

const VALUE: Rule = Rule(|x| (0.0..=1e9).contains(&x), "from 0 to 1e9");
const COORDINATE: Rule = Rule(|x| (-1e9..=1e9).contains(&x), "from -1e9 to 1e9");

impl Reader<'_> {
    /// `Texture "name" "spectrum|float" "class"`.
    pub(super) fn texture(&mut self, at: At, lexer: &mut Lexer) -> Result<()> {
        let name = lexer.text("Texture", &at, "a name")?;
        let owner = format!("Texture {}", quote(&name));
        let values = match lexer.text(&owner, &at, "its type")?.as_str() {
            "spectrum" | "color" => Values::Spectrum,
            "float" => Values::Float,
            other => return Err(at.input(format!("{owner}: the type {} is not spectrum or float", quote(other)))),
        };
        let p = Params::read(lexer, &owner, at)?;
        let named = match p.kind.as_str() {
            "constant" => self.operand(&p, "value", values, 1.0)?,
            "imagemap" => Named { texture: Texture::Image(self.image_texture(&p, values)?), parts: 1 },
            "checkerboard" => {
                if p.integer("dimension", 2..=3)? == Some(3) {
                    return Err(p
                        .place("dimension")
                        .unsupported(format!("{}: only 2 dimensions are supported", p.owner)));
                }
                let mapping = mapping(&p)?;
                let operands = [self.operand(&p, "tex1", values, 1.0)?, self.operand(&p, "tex2", values, 0.0)?];
                compose(&p, operands, |textures| Texture::Checkerboard { mapping, textures })?
            }
            "scale" => {
                // pbrt-v4's names, and pbrt-v3's.
                let operands = if p.has("tex") || p.has("scale") {
                    [self.operand(&p, "tex", values, 1.0)?, self.operand(&p, "scale", Values::Float, 1.0)?]
                } else {
                    [self.operand(&p, "tex1", values, 1.0)?, self.operand(&p, "tex2", values, 1.0)?]
                };
                compose(&p, operands, Texture::Scale)?
            }
            "mix" => {
                let amount = self.operand(&p, "amount", Values::Float, 0.5)?;
                let [low, high] = amount.texture.range();
                if !(low >= 0.0 && high <= 1.0) {
                    return Err(out_of_range(&p, "amount", [low, high]));
                }
                let operands = [self.operand(&p, "tex1", values, 0.0)?, self.operand(&p, "tex2", values, 1.0)?, amount];
                compose(&p, operands, Texture::Mix)?
            }
            _ => return Err(p.unsupported_kind("constant, imagemap, checkerboard, scale, mix")),
        };
        // Filters other than the bilinear one: mip maps.
        p.finish(&["maxanisotropy", "trilinear", "aamode"], &mut self.warnings)?;
        memory::insert(&mut self.textures.named, (values, name), named, || p.at.to_string())
    }

    /// A parameter of a texture: numbers, or another texture.
    fn operand(&self, p: &Params, name: &'static str, values: Values, missing: f32) -> Result<Named> {
        if let Some(named) = self.named(p, name, values)? {
            return Ok(named);
        }
        let constant = match values {
            Values::Spectrum => p.rgb(name, &VALUE)?,
            Values::Float => p.float(name, &VALUE)?.map(|value| Rgb::splat(value as f32)),
        };
        Ok(Named { texture: Texture::Constant(constant.unwrap_or(Rgb::splat(missing))), parts: 1 })
    }

    /// The texture that a parameter names, if it does.
    fn named(&self, p: &Params, name: &'static str, values: Values) -> Result<Option<Named>> {
        let Some(texture) = p.texture(name)? else { return Ok(None) };
        if let Some(known) = self.textures.named.get(&(values, texture.to_owned())) {
            return Ok(Some(known.clone()));
        }
        let what = if values == Values::Float { "float" } else { "spectrum" };
        Err(p.place(name).input(format!("{}: no {what} texture named {}", p.owner, quote(texture))))
    }

    /// The texture of values from 0 to 1 that a parameter of a material names, if it does.
    pub(super) fn fraction(&self, p: &Params, name: &'static str, values: Values) -> Result<Option<Texture>> {
        let Some(Named { texture, .. }) = self.named(p, name, values)? else { return Ok(None) };
        match texture.range() {
            [low, high] if low >= 0.0 && high <= 1.0 => Ok(Some(texture)),
            range => Err(out_of_range(p, name, range)),
        }
    }

    /// A colour from 0 to 1 of a material: what it is without textures, and its texture if it is not constant.
    pub(super) fn colour(&self, p: &Params, name: &'static str, missing: Rgb) -> Result<(Rgb, Option<Texture>)> {
        Ok(match self.fraction(p, name, Values::Spectrum)? {
            Some(Texture::Constant(colour)) => (colour, None),
            // No lobe vanishes with it.
            Some(texture) => (Rgb::ONE, Some(texture)),
            None => (p.rgb(name, &FRACTION)?.unwrap_or(missing), None),
        })
    }

    fn image_texture(&mut self, p: &Params, values: Values) -> Result<ImageTexture> {
        let one_of = |name: &'static str, known: &str| {
            let given = p.text(name)?.unwrap_or_default().to_ascii_lowercase();
            if given.is_empty() || known.split(' ').any(|known| known == given) {
                return Ok(given);
            }
            let message = format!("{}: {name} {} is not supported", p.owner, quote(&given));
            Err(p.place(name).unsupported(message).with_hint(format!("supported: {known}")))
        };
        let wrap = match one_of("wrap", "repeat black clamp")?.as_str() {
            "black" => Wrap::Black,
            "clamp" => Wrap::Clamp,
            _ => Wrap::Repeat,
        };
        let filter = one_of("filter", "bilinear trilinear ewa")?;
        let encoding = one_of("encoding", "srgb linear")?;
        if !matches!(filter.as_str(), "" | "bilinear") {
            self.warnings.push(p.place("filter").warning(&format!("{}: filtered as bilinear", p.owner)));
        }
        // `gamma` is pbrt-v3's.
        let is_linear = encoding == "linear" || encoding.is_empty() && p.flag("gamma")? == Some(false);
        let (scale, invert) = (p.float("scale", &VALUE)?.unwrap_or(1.0) as f32, p.flag("invert")?.unwrap_or(false));
        let mapping = mapping(p)?;
        let at = p.place("filename");
        let name = p.text("filename")?.ok_or_else(|| at.input(format!("{} needs a \"string filename\"", p.owner)))?;
        let key = (self.folder.join(name), values, is_linear);
        let texels = match self.textures.texels.get(&key) {
            Some(known) => Arc::clone(known),
            None => self.read_texels(key, at)?,
        };
        Ok(ImageTexture { texels, mapping, wrap, scale, invert })
    }

    /// The texels of an image that has not been read before.
    fn read_texels(&mut self, key: TexelsKey, at: &At) -> Result<Arc<Texels>> {
        let (path, values, is_linear) = &key;
        let options = ReadOptions { allow_ldr: true, is_linear: *is_linear };
        let (image, notes) = read_with_notes(path, options).map_err(|e| at.cannot_read(e))?;
        self.warnings.extend(notes);
        let pixels = image.pixels().len() as u64;
        self.textures.pixels = self.textures.pixels.checked_sub(pixels).ok_or_else(|| {
            Error::limit(path, format!("with this, the scene's textures exceed {MAX_TEXTURE_PIXELS} pixels"))
        })?;
        let is_usable = |texel: &Rgb| texel.is_finite() && texel.min_element() >= 0.0;
        if let Some(bad) = image.pixels().iter().position(|texel| !is_usable(texel)) {
            let (x, y) = (bad % image.width(), bad / image.width());
            let message = format!("the pixel ({x}, {y}) is {}", image.pixels()[bad]);
            return Err(Error::input(path, message).with_hint("textures need finite values that are not negative"));
        }
        // A number is the mean of the channels, as in pbrt-v4.
        let image = match values {
            Values::Spectrum => image,
            Values::Float => image.map(|texel| Rgb::splat(mean_rgb(texel) as f32)),
        };
        let texels = Arc::new(Texels::new(image));
        self.textures.texels.insert(key, Arc::clone(&texels));
        Ok(texels)
    }
}

/// A texture of other textures.
fn compose<const N: usize>(
    p: &Params,
    operands: [Named; N],
    of: impl FnOnce(Arc<[Texture; N]>) -> Texture,
) -> Result<Named> {
    let parts = 1 + operands.iter().map(|operand| operand.parts).sum::<usize>();
    if parts > MAX_PARTS {
        return Err(p.at.unsupported(format!("{} is made of more than {MAX_PARTS} textures", p.owner)));
    }
    Ok(Named { texture: of(Arc::new(operands.map(|operand| operand.texture))), parts })
}

/// How (u, v) becomes (s, t).
fn mapping(p: &Params) -> Result<UvMapping> {
    if let Some(other) = p.text("mapping")?.filter(|&mapping| mapping != "uv") {
        let message = format!("{}: the mapping {} is not supported, only \"uv\"", p.owner, quote(other));
        return Err(p.place("mapping").unsupported(message));
    }
    let number = |name, missing| Ok::<_, Error>(p.float(name, &COORDINATE)?.unwrap_or(missing));
    Ok(UvMapping {
        scale: DVec2::new(number("uscale", 1.0)?, number("vscale", 1.0)?),
        offset: DVec2::new(number("udelta", 0.0)?, number("vdelta", 0.0)?),
    })
}

fn out_of_range(p: &Params, name: &str, [low, high]: [f32; 2]) -> Error {
    let message = format!("{}: the texture of {name} has values from {low} to {high}", p.owner);
    p.place(name).input(message).with_hint("they must be from 0 to 1: change the texture's scale")
}

/// Most pixels in a scene's images for textures, all together: 3 GiB.
pub const MAX_TEXTURE_PIXELS: u64 = 1 << 28;

pub struct Textures {
    pub named: HashMap<(Values, String), Named>,
    /// The images that have been read.
    pub texels: HashMap<TexelsKey, Arc<Texels>>,
    /// How many more pixels may be read.
    pub pixels: u64,
}

/// A texture, and how many textures it is made of.
#[derive(Clone)]
pub struct Named {
    pub texture: Texture,
    pub parts: usize,
}

/// Whether a texture is of colours or of numbers; a name may stand for one of each.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Values {
    Spectrum,
    Float,
}

/// What identifies the texels of an image: its file, what they are, and whether its codes are linear.
pub type TexelsKey = (PathBuf, Values, bool);

impl Default for Textures {
    fn default() -> Self {
        Self { named: HashMap::new(), texels: HashMap::new(), pixels: MAX_TEXTURE_PIXELS }
    }
}
