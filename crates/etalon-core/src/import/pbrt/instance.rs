//! `ObjectBegin`, `ObjectEnd` and `ObjectInstance`: an object's shapes are kept, and read again for each instance.

use super::params::Params;
use super::reader::{MAX_MESH_BYTES, Reader, State};
use crate::error::Result;
use crate::import::imported::MAX_WARNINGS;
use crate::import::place::{At, quote};
use crate::import::transform;
use crate::memory;
use std::rc::Rc;

impl Reader<'_> {
    /// `ObjectBegin`: the shapes up to `ObjectEnd` belong to the object `name`.
    pub(super) fn begin_object(&mut self, name: String, at: At) -> Result<()> {
        if self.recording.is_some() {
            return Err(at.input("ObjectBegin inside of an object"));
        }
        self.recording = Some((name, Vec::new()));
        self.begin("ObjectBegin", at)
    }

    pub(super) fn end_object(&mut self, at: &At) -> Result<()> {
        self.state = self.end("ObjectBegin", "ObjectEnd", at)?;
        if let Some((name, parts)) = self.recording.take() {
            memory::insert(&mut self.instanced, name, parts.into(), || at.to_string())?;
        }
        Ok(())
    }

    /// A shape of the scene, or of the object that is open. Light sources do not repeat, as in pbrt.
    pub(super) fn shape_or_part(&mut self, params: Params) -> Result<()> {
        let Some((_, parts)) = &mut self.recording else { return self.shape(&params) };
        if self.state.emission.is_some() {
            return Err(params.at.unsupported("an area light in an object for ObjectInstance is not supported"));
        }
        let what = params.at.clone();
        memory::push(parts, (params, self.state.clone()), || what.to_string())
    }

    /// `ObjectInstance`: the object's shapes once more, in the current coordinate system. Each takes the memory of a shape that is
    /// written out, so that together they have the limit of mesh files.
    pub(super) fn instance(&mut self, name: &str, at: &At) -> Result<()> {
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
