//! Walks through a pbrt file and those that it includes, and keeps what their directives set until the scene is whole.

use super::lexer::{Lexer, Token};
use super::params::Params;
use super::setup::Setup;
use super::texture::Textures;
use crate::error::{Error, Result};
use crate::files::read_bounded;
use crate::import::place::At;
use crate::import::{Imported, MAX_WARNINGS, SceneOptions, further_warnings};
use crate::math::Rgb;
use crate::scene::{Emission, Environment, Light, Material, Object, Scene};
use glam::DMat4;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Most bytes of text in a scene, all its files together (a file counts each time it is included, and at least [`LEAST_BYTES`]).
const MAX_BYTES: u64 = 64 << 20;
/// What a file counts at least: opening one takes as long as reading so much.
pub(super) const LEAST_BYTES: u64 = 4 << 10;
/// Deepest chain of files that include one another, and deepest nesting of blocks.
const MAX_FILES_DEEP: usize = 32;
const MAX_BLOCKS_DEEP: usize = 1024;
/// Most bytes in a scene's mesh files, all together (a file counts each time it is named).
pub const MAX_MESH_BYTES: u64 = 512 << 20;

/// The albedo of shapes before the file sets a material.
pub const GREY: Rgb = Rgb::splat(0.5);

pub struct Reader<'a> {
    pub(super) options: &'a SceneOptions<'a>,
    /// Where the first file lies: names in all files are relative to it, as in pbrt.
    pub(super) folder: PathBuf,
    /// The files being read now, each included by the one before it.
    open: Vec<PathBuf>,
    bytes: u64,
    /// Before, in or after the world block.
    pub(super) stage: Stage,
    pub(super) state: State,
    blocks: Vec<Block>,
    pub(super) systems: HashMap<String, DMat4>,
    pub(super) materials: HashMap<String, Material>,
    pub(super) textures: Textures,
    pub(super) setup: Setup,
    pub(super) objects: Vec<Object>,
    /// Lights so far, without those at infinity.
    pub(super) lights: Vec<Light>,
    pub(super) environment: Option<Environment>,
    /// The most samples that a light asks for at each hit.
    pub(super) light_samples: Option<u32>,
    /// How many more bytes of mesh files, and of shapes that are repeated, may be read.
    pub(super) mesh_bytes: u64,
    /// The shapes of each object that `ObjectInstance` repeats.
    pub(super) instanced: HashMap<String, Rc<[Part]>>,
    /// The object between `ObjectBegin` and `ObjectEnd`: its name, and its shapes so far.
    pub(super) recording: Option<(String, Vec<Part>)>,
    pub(super) warnings: Vec<String>,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Stage {
    Options,
    World,
    Done,
}

/// What `AttributeBegin` saves.
#[derive(Clone)]
pub(super) struct State {
    /// Object to world.
    pub(super) transform: DMat4,
    pub(super) material: Material,
    /// Emission of the shapes that follow.
    pub(super) emission: Option<Emission>,
    pub(super) reversed: bool,
}

/// A shape of an object for `ObjectInstance`, with the state that it was given in.
pub(super) type Part = (Params, State);

/// A block that is open, with what it gives back at its end.
struct Block {
    opener: &'static str,
    at: At,
    saved: State,
}

impl<'a> Reader<'a> {
    pub fn scene(path: &Path, options: &'a SceneOptions<'a>) -> Result<Imported> {
        let mut reader = Self {
            options,
            folder: path.parent().unwrap_or(Path::new("")).into(),
            open: Vec::new(),
            bytes: 0,
            stage: Stage::Options,
            state: State {
                transform: DMat4::IDENTITY,
                material: Material::Diffuse { albedo: GREY },
                emission: None,
                reversed: false,
            },
            blocks: Vec::new(),
            systems: HashMap::new(),
            materials: HashMap::new(),
            textures: Textures::default(),
            setup: Setup::default(),
            objects: Vec::new(),
            lights: Vec::new(),
            environment: None,
            light_samples: None,
            mesh_bytes: MAX_MESH_BYTES,
            instanced: HashMap::new(),
            recording: None,
            warnings: Vec::new(),
        };
        reader.file(path, None)?;
        reader.finish(path)
    }

    fn finish(mut self, path: &Path) -> Result<Imported> {
        let file = At::file(Rc::from(path));
        if self.stage == Stage::Options {
            return Err(file.input("the file has no WorldBegin").with_hint("a scene is needed, not a part of one"));
        }
        self.all_closed()?;
        if self.environment.is_none() && self.options.environment.is_some() {
            self.warnings.push(file.warning("no light names a map: the given environment is not used"));
        }
        let light_samples = self.light_samples.unwrap_or(1);
        let (camera, request, output) = self.setup.finish(light_samples, &file, &mut self.warnings)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let (objects, lights, environment) = (self.objects, self.lights, self.environment);
        let scene = Scene { name, camera, objects, lights, environment };
        Ok(Imported { scene, request, output, warnings: self.warnings })
    }

    /// Reads one file; `from` is the directive that names it, if any.
    fn file(&mut self, path: &Path, from: Option<&At>) -> Result<()> {
        let bytes = read_bounded(path, MAX_BYTES).map_err(|e| match from {
            Some(at) => at.cannot_read(e),
            None => e,
        })?;
        self.bytes += LEAST_BYTES.max(bytes.len() as u64);
        if self.bytes > MAX_BYTES {
            return Err(Error::limit(path, format!("with this, the scene's files exceed {} MiB", MAX_BYTES >> 20)));
        }
        self.open.push(path.canonicalize().map_err(|e| Error::io(path, e))?);
        let mut lexer = Lexer::new(&bytes, Rc::from(path));
        while let Some((token, at)) = lexer.next()? {
            let Token::Word(directive) = token else {
                return Err(at.input(format!("expected a directive, not {}", token.describe())));
            };
            self.directive(directive, at, &mut lexer)?;
            if self.warnings.len() > MAX_WARNINGS {
                self.warnings.truncate(MAX_WARNINGS);
                self.warnings.push(further_warnings(path));
            }
        }
        self.open.pop();
        Ok(())
    }

    /// Reads the file `name` for the directive `Include` or `Import`.
    pub(super) fn include(&mut self, directive: &str, name: &str, at: &At) -> Result<()> {
        let path = self.folder.join(name);
        if self.open.len() >= MAX_FILES_DEEP {
            return Err(at.input(format!("more than {MAX_FILES_DEEP} files include one another")));
        }
        // A file that cannot be found fails with a better message when it is read.
        if path.canonicalize().is_ok_and(|path| self.open.contains(&path)) {
            return Err(at.input(format!("{} includes itself", path.display())));
        }
        if directive == "Include" {
            return self.file(&path, Some(at));
        }
        // Import: what the file sets ends with it, and it sees no blocks but its own.
        let (state, blocks) = (self.state.clone(), std::mem::take(&mut self.blocks));
        self.file(&path, Some(at))?;
        self.all_closed()?;
        (self.state, self.blocks) = (state, blocks);
        Ok(())
    }

    /// Opens a block: what the directives set will come back at its end.
    pub(super) fn begin(&mut self, opener: &'static str, at: At) -> Result<()> {
        if self.blocks.len() >= MAX_BLOCKS_DEEP {
            return Err(at.input(format!("more than {MAX_BLOCKS_DEEP} blocks inside one another")));
        }
        self.blocks.push(Block { opener, at, saved: self.state.clone() });
        Ok(())
    }

    /// Closes the block that `opener` must have opened, and gives what it saved.
    pub(super) fn end(&mut self, opener: &str, closer: &str, at: &At) -> Result<State> {
        match self.blocks.pop() {
            Some(block) if block.opener == opener => Ok(block.saved),
            Some(block) => Err(at.input(format!("{closer} where {} is still open", block.opener))),
            None => Err(at.input(format!("{closer} without {opener}"))),
        }
    }

    /// Refuses blocks that are still open.
    pub(super) fn all_closed(&self) -> Result<()> {
        match self.blocks.last() {
            Some(block) => Err(block.at.input(format!("this {} is never closed", block.opener))),
            None => Ok(()),
        }
    }
}
