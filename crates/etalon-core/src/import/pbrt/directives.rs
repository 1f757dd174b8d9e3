//! The directives: where in a file each is allowed, and its effect. The shapes of `ObjectBegin` are kept, and read again for each
//! `ObjectInstance`.

use super::super::place::{At, quote};
use super::super::{MAX_WARNINGS, transform};
use super::lexer::{Lexer, Token};
use super::params::Params;
use super::reader::{MAX_MESH_BYTES, Reader, Stage, State};
use super::spectrum::Meaning;
use crate::error::Result;
use crate::memory;
use glam::{DMat4, DVec3};
use std::rc::Rc;

/// Directives that belong before `WorldBegin`, and after it; those of neither list are allowed anywhere.
const OPTIONS: &str = "Camera Film Sampler PixelFilter SurfaceIntegrator Integrator Accelerator VolumeIntegrator Renderer \
                       Option WorldBegin";
const CONTENT: &str = "WorldEnd AttributeBegin AttributeEnd Material MakeNamedMaterial NamedMaterial Texture Shape LightSource \
                       AreaLightSource ObjectBegin ObjectEnd ObjectInstance";

impl Reader<'_> {
    /// Executes the directive `name` at `at`; its arguments come from `lexer`.
    pub(super) fn directive(&mut self, name: &str, at: At, lexer: &mut Lexer) -> Result<()> {
        let is_one_of = |names: &str| names.split(' ').any(|known| known == name);
        match self.stage {
            Stage::Done => {
                return Err(at
                    .unsupported(format!("{} after WorldEnd: only one image per file is supported", quote(name)))
                    .with_hint("split the file at its WorldEnd"));
            }
            Stage::World if is_one_of(OPTIONS) => {
                return Err(at.input(format!("{name} belongs before WorldBegin")));
            }
            Stage::Options if is_one_of(CONTENT) => {
                return Err(at.input(format!("{name} belongs after WorldBegin")));
            }
            _ => {}
        }
        match name {
            "Include" | "Import" => {
                let file = lexer.text(name, &at, "a file name")?;
                self.include(name, &file, &at)?;
            }
            "WorldBegin" => {
                self.state.transform = DMat4::IDENTITY;
                self.systems.insert("world".into(), DMat4::IDENTITY);
                self.stage = Stage::World;
            }
            "WorldEnd" => {
                self.all_closed()?;
                self.stage = Stage::Done;
            }
            "AttributeBegin" => self.begin("AttributeBegin", at)?,
            "AttributeEnd" => self.state = self.end("AttributeBegin", name, &at)?,
            "TransformBegin" => self.begin("TransformBegin", at)?,
            "TransformEnd" => self.state.transform = self.end("TransformBegin", name, &at)?.transform,
            "ReverseOrientation" => self.state.reversed = !self.state.reversed,
            "CoordinateSystem" => {
                let system = lexer.text(name, &at, "a name")?;
                memory::insert(&mut self.systems, system, self.state.transform, || at.to_string())?;
            }
            "ColorSpace" => {
                let space = lexer.text(name, &at, "a name")?;
                if space != "srgb" {
                    return Err(at.unsupported(format!("ColorSpace {} is not supported, only srgb", quote(&space))));
                }
            }
            "ObjectBegin" => {
                let object = lexer.text(name, &at, "a name")?;
                self.begin_object(object, at)?;
            }
            "ObjectEnd" => self.end_object(&at)?,
            "ObjectInstance" => {
                let object = lexer.text(name, &at, "a name")?;
                self.instance(&object, &at)?;
            }
            "Option" => option(&Params::single(lexer, name, at)?, &mut self.warnings)?,
            "Texture" => self.texture(at, lexer)?,
            "MediumInterface" => only_vacuum(name, &at, lexer)?,
            "MakeNamedMedium" => {
                let medium = Params::read(lexer, name, at)?;
                self.warnings.push(medium.at.warning(&format!("{}: refused where it is used", medium.owner)));
            }
            "NamedMaterial" => {
                let wanted = lexer.text(name, &at, "a name")?;
                let known = self.materials.get(&wanted).cloned();
                self.state.material = known.ok_or_else(|| at.input(format!("no material named {}", quote(&wanted))))?;
            }
            _ if is_one_of(OPTIONS) || is_one_of(CONTENT) => {
                self.with_parameters(name, Params::read(lexer, name, at)?)?;
            }
            _ => self.state.transform = transform::checked(self.transform(name, &at, lexer)?, &at)?,
        }
        Ok(())
    }

    fn with_parameters(&mut self, name: &str, mut params: Params) -> Result<()> {
        let warnings = &mut self.warnings;
        match name {
            "Camera" => {
                let to_world = self.state.transform.inverse();
                self.systems.insert("camera".into(), to_world);
                self.setup.camera(&params, to_world, warnings)
            }
            "Film" => self.setup.film(&params, warnings),
            "Sampler" => self.setup.sampler(&params, warnings),
            "PixelFilter" => self.setup.filter(&params, warnings),
            "SurfaceIntegrator" => self.setup.integrator(&params, true, warnings),
            "Integrator" => self.setup.integrator(&params, false, warnings),
            "Renderer" if params.kind != "sampler" => Err(params.unsupported_kind("sampler")),
            "Material" => {
                params.resolve_spectra(Meaning::Material, self.setup.is_v4(), &self.folder, warnings)?;
                self.material(&params).map(|material| self.state.material = material)
            }
            "MakeNamedMaterial" => {
                let kind = params.text("type")?.map(str::to_owned);
                let kind = kind.ok_or_else(|| params.at.input(format!("{} needs a \"string type\"", params.owner)))?;
                params.owner = format!("{} of type {}", params.owner, quote(&kind));
                let material_name = std::mem::replace(&mut params.kind, kind);
                params.resolve_spectra(Meaning::Material, self.setup.is_v4(), &self.folder, warnings)?;
                let material = self.material(&params)?;
                memory::insert(&mut self.materials, material_name, material, || params.at.to_string())
            }
            "Shape" => self.shape_or_part(params),
            "AreaLightSource" | "LightSource" => {
                params.resolve_spectra(Meaning::Light, self.setup.is_v4(), &self.folder, warnings)?;
                if name == "LightSource" { self.light(&params) } else { self.area_light(&params) }
            }
            _ => {
                warnings.push(params.at.warning(&format!("{} cannot change this image: left out", params.owner)));
                Ok(())
            }
        }
    }

    /// The current transform after a directive, which multiplies it from the right, as in pbrt.
    fn transform(&self, name: &str, at: &At, lexer: &mut Lexer) -> Result<DMat4> {
        let step = match name {
            "Identity" => return Ok(DMat4::IDENTITY),
            "Transform" => return Ok(DMat4::from_cols_array(&lexer.numbers(name, at)?)),
            "CoordSysTransform" => {
                let system = lexer.text(name, at, "a name")?;
                let known = self.systems.get(&system).copied();
                return known.ok_or_else(|| at.input(format!("no coordinate system named {}", quote(&system))));
            }
            "ConcatTransform" => DMat4::from_cols_array(&lexer.numbers(name, at)?),
            "Translate" => DMat4::from_translation(DVec3::from_array(lexer.numbers(name, at)?)),
            "Scale" => DMat4::from_scale(DVec3::from_array(lexer.numbers(name, at)?)),
            "Rotate" => {
                let [degrees, x, y, z] = lexer.numbers(name, at)?;
                let rotation = transform::rotate(degrees, DVec3::new(x, y, z));
                rotation.ok_or_else(|| at.input("Rotate needs an axis that is not 0 0 0"))?
            }
            "LookAt" => {
                let [ex, ey, ez, tx, ty, tz, ux, uy, uz] = lexer.numbers(name, at)?;
                let (eye, target, up) = (DVec3::new(ex, ey, ez), DVec3::new(tx, ty, tz), DVec3::new(ux, uy, uz));
                transform::look_at(eye, target, up).ok_or_else(|| {
                    at.input(
                        "LookAt needs an eye, a target apart from it, and an up that does not point along the view",
                    )
                })?
            }
            _ => return Err(unknown(name, at)),
        };
        Ok(self.state.transform * step)
    }

    /// `ObjectBegin`: the shapes up to `ObjectEnd` belong to the object `name`.
    fn begin_object(&mut self, name: String, at: At) -> Result<()> {
        if self.recording.is_some() {
            return Err(at.input("ObjectBegin inside of an object"));
        }
        self.recording = Some((name, Vec::new()));
        self.begin("ObjectBegin", at)
    }

    fn end_object(&mut self, at: &At) -> Result<()> {
        self.state = self.end("ObjectBegin", "ObjectEnd", at)?;
        if let Some((name, parts)) = self.recording.take() {
            memory::insert(&mut self.instanced, name, parts.into(), || at.to_string())?;
        }
        Ok(())
    }

    /// A shape of the scene, or of the object that is open. Light sources do not repeat, as in pbrt.
    fn shape_or_part(&mut self, params: Params) -> Result<()> {
        let Some((_, parts)) = &mut self.recording else { return self.shape(&params) };
        if self.state.emission.is_some() {
            return Err(params.at.unsupported("an area light in an object for ObjectInstance is not supported"));
        }
        let what = params.at.clone();
        memory::push(parts, (params, self.state.clone()), || what.to_string())
    }

    /// `ObjectInstance`: the object's shapes once more, in the current coordinate system. Each takes the memory of a shape that is
    /// written out, so that together they have the limit of mesh files.
    fn instance(&mut self, name: &str, at: &At) -> Result<()> {
        if self.recording.is_some() {
            return Err(at.input("ObjectInstance inside of an object"));
        }
        let known = self.instanced.get(name).map(Rc::clone);
        let parts = known.ok_or_else(|| at.input(format!("no object named {}", quote(name))))?;
        let (saved, known_warnings) = (self.state.clone(), self.warnings.len());
        for (params, state) in &*parts {
            let transform = transform::checked(saved.transform * state.transform, at)?;
            self.state = State { transform, ..state.clone() };
            self.mesh_bytes = self.mesh_bytes.checked_sub(params.bytes()).ok_or_else(|| {
                let message = format!("with this, the scene's instances exceed {} MiB", MAX_MESH_BYTES >> 20);
                at.limit(format!("{}: {message}", quote(name)))
            })?;
            self.shape(params)?;
        }
        self.state = saved;
        // What one instance has said, the others need not repeat.
        for warning in self.warnings.split_off(known_warnings) {
            if self.warnings.len() <= MAX_WARNINGS && !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        Ok(())
    }
}

/// `Option` of pbrt-v4: flags that change what is computed may only be off; the rest has no effect on the expected image.
fn option(p: &Params, warnings: &mut Vec<String>) -> Result<()> {
    for name in ["disablepixeljitter", "disablewavelengthjitter", "disabletexturefiltering", "forcediffuse"] {
        p.only_false(name)?;
    }
    p.finish(
        &[
            "displacementedgescale",
            "msereferenceimage",
            "msereferenceout",
            "pixelstats",
            "rendercoordsys",
            "seed",
            "wavefront",
        ],
        warnings,
    )
}

/// `MediumInterface`: the medium inside, and the one outside if it is another. The empty name is vacuum.
fn only_vacuum(name: &str, at: &At, lexer: &mut Lexer) -> Result<()> {
    let inside = lexer.text(name, at, "a medium")?;
    let outside =
        if let Some(Token::Text(_)) = lexer.peek()? { lexer.text(name, at, "a medium")? } else { String::new() };
    match [inside, outside].iter().find(|medium| !medium.is_empty()) {
        Some(medium) => Err(at
            .unsupported(format!("{name}: the medium {} is not supported", quote(medium)))
            .with_hint("leave the MediumInterface out to render without it")),
        None => Ok(()),
    }
}

/// A directive of pbrt that is not supported, or no directive at all.
fn unknown(name: &str, at: &At) -> crate::error::Error {
    let hint = match name {
        "ActiveTransform" | "TransformTimes" => "nothing moves here: leave it out",
        "Volume" => "there are no media here: leave it out",
        "Attribute" => "leave it out, or give its parameters where they are needed",
        _ => return at.input(format!("{} is not a directive of pbrt", quote(name))),
    };
    at.unsupported(format!("{name} is not supported")).with_hint(hint)
}
