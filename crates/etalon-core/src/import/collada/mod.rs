//! Reads scenes in the COLLADA 1.4 dialect of the rendering course whose renderer the second report used.
//!
//! | element | what becomes of it |
//! |---|---|
//! | `asset/up_axis` | turned so that y is up |
//! | `node` with `matrix`, or `translate`, `rotate`, `scale`; `instance_node` | the product of the transforms |
//! | `camera` | the last one gives direction and field of view; its position follows from the scene's size, as in the course's renderer, unless a settings file gives it |
//! | `light`: `area`, `point`, `directional`, `ambient` | a rectangle; a point without falloff; a direction; the upper hemisphere, itself invisible |
//! | `light`: `spot` | left out with a warning: it is black in the course's renderer |
//! | `effect`: `phong/diffuse`; of the profile `CGL`: `emission`, `mirror`, `refraction`, `glass`, `microfacet` | the same, `microfacet` with Beckmann's distribution |
//! | `geometry`: `sphere` of the profile `CGL`, or the first `polylist` or `triangles` of a mesh | shaded smoothly across all edges; two triangles that make up a rectangle become one |
//!
//! Only lights illuminate; emitting meshes are merely visible. An area light that no emitting mesh overlaps is visible, too.
//!
//! Source: the format's specification (Khronos, COLLADA 1.4.1, 2008), and how the course's renderer reads it.

mod document;
mod geometry;
mod material;
mod settings;
mod transform;

pub use transform::WINDOW;

use super::transform::{affine, directions};
use super::{Imported, SceneOptions};
use crate::error::{Error, Place, Result};
use crate::files::{read_bounded, without_bom};
use crate::memory;
use crate::scene::{Environment, Light, Object, Request, Scene};
use document::{Document, Element, elements, is};
use glam::{DMat4, DVec3};
use std::path::Path;
use transform::View;

/// Most bytes in a file.
const MAX_BYTES: u64 = 128 << 20;

/// Reads the scene at `path`. The file asks for no samples or depth: the request has the course renderer's defaults,
/// one of each. The camera fits the request's size only.
///
/// # Errors
/// What is wrong or not supported in the file or in the settings, with its place.
pub fn read(path: &Path, options: &SceneOptions) -> Result<Imported> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = std::str::from_utf8(without_bom(&bytes))
        .map_err(|e| Error::input(path, "not UTF-8").at(Place::Byte(e.valid_up_to() as u64)))?;
    let xml = document::parse(text, path)?;
    let document = Document::new(&xml, path)?;
    let mut found = walk(&document)?;
    let (camera, size) = match options.camera {
        Some(path) => settings::read(path).map(|(camera, window)| (camera, options.resolution.unwrap_or(window)))?,
        None => {
            let size = options.resolution.unwrap_or(transform::WINDOW);
            let view = found.view.as_ref().ok_or_else(|| {
                Error::input(path, "the scene has no camera").with_hint("give a file of camera settings")
            })?;
            let bounds = found.bounds().ok_or_else(|| Error::input(path, "the scene has nothing to look at"))?;
            (view.place(&document, bounds, size)?, size)
        }
    };
    let lights = material::show_area_lights(found.lights, &mut found.objects);
    let environment = options.environment.clone().map(|(map, name)| Environment::upright(map, name, 1.0));
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let scene = Scene { name, camera, objects: found.objects, lights, environment };
    let request = Request { width: size[0], height: size[1], spp: 1, light_samples: 1, max_depth: 1 };
    Ok(Imported { scene, request, output: None, warnings: document.into_warnings() })
}

/// Deepest nesting of nodes, and most nodes, each counted as often as it is instanced.
const MAX_DEPTH: usize = 256;
const MAX_NODES: usize = 1 << 18;

#[derive(Default)]
struct Found<'a> {
    view: Option<View<'a>>,
    lights: Vec<Light>,
    objects: Vec<Object>,
}

impl Found<'_> {
    /// The box around all objects.
    fn bounds(&self) -> Option<[DVec3; 2]> {
        let boxes = self.objects.iter().filter_map(|object| object.shape.bounds());
        boxes.reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]).map(|ends| ends.map(|end| end.as_dvec3()))
    }
}

/// Collects the content of the file's scene.
fn walk<'a>(document: &Document<'a>) -> Result<Found<'a>> {
    let up = transform::up_axis(document)?;
    let instance = document.require(document.root(), "scene/instance_visual_scene")?;
    let scene = document.follow(instance, "url", "visual_scene")?;
    let mut walker = Walker {
        document,
        found: Found::default(),
        open: Vec::new(),
        nodes: MAX_NODES,
        budget: geometry::MAX_TRIANGLES,
    };
    walker.children(scene, &up)?;
    Ok(walker.found)
}

struct Walker<'a, 'd> {
    document: &'d Document<'a>,
    found: Found<'a>,
    /// The nodes on the path to the current one, the outermost first.
    open: Vec<Element<'a>>,
    /// How many more nodes are allowed, and how many more vertices and triangles.
    nodes: usize,
    budget: usize,
}

impl<'a> Walker<'a, '_> {
    fn children(&mut self, parent: Element<'a>, to_world: &DMat4) -> Result<()> {
        for child in elements(parent) {
            if is(child, "node") {
                self.node(child, child, to_world)?;
            } else if is(child, "instance_node") {
                self.node(self.document.follow(child, "url", "node")?, child, to_world)?;
            }
        }
        Ok(())
    }

    /// One node; `from` is the element that it is reached by.
    fn node(&mut self, node: Element<'a>, from: Element<'a>, parent: &DMat4) -> Result<()> {
        let (document, at) = (self.document, || self.document.at(from));
        if self.open.contains(&node) {
            return Err(at().input("this node contains itself"));
        }
        if self.open.len() >= MAX_DEPTH {
            return Err(at().input(format!("more than {MAX_DEPTH} nodes inside one another")));
        }
        let limit = || Error::limit(document.path(), format!("more than {MAX_NODES} nodes"));
        self.nodes = self.nodes.checked_sub(1).ok_or_else(limit)?;
        let to_world = affine(*parent * transform::local(document, node)?, || document.at(node))?;
        self.instance(node, &to_world)?;
        self.open.push(node);
        self.children(node, &to_world)?;
        self.open.pop();
        Ok(())
    }

    /// What a node holds: its first camera, else its first light, else its first geometry.
    fn instance(&mut self, node: Element<'a>, to_world: &DMat4) -> Result<()> {
        let kinds = ["instance_camera", "instance_light", "instance_geometry"];
        let first = kinds.iter().find_map(|kind| elements(node).find(|child| is(*child, kind)));
        for child in elements(node).filter(|child| Some(*child) != first) {
            let name = child.tag_name().name();
            if name.starts_with("instance_") && name != "instance_node" {
                self.document.warn(child, &format!("<{name}> left out: a node holds one camera, light or geometry"));
            }
        }
        let (Some(instance), document) = (first, self.document) else { return Ok(()) };
        if is(instance, "instance_camera") {
            let camera = document.follow(instance, "url", "camera")?;
            self.found.view = Some(View::read(document, camera, to_world)?);
        } else if is(instance, "instance_light") {
            let light = document.follow(instance, "url", "light")?;
            if let Some(light) = material::light(document, light, to_world)? {
                memory::push(&mut self.found.lights, light, || document.at(instance).to_string())?;
            }
        } else {
            let geometry = document.follow(instance, "url", "geometry")?;
            let shape = geometry::shape(document, geometry, to_world, &mut self.budget)?;
            let (material, emission) = material::surface(document, instance)?;
            let [_, _, axis] = directions(to_world);
            let object = Object { emission, axis, ..Object::new(shape, material) };
            memory::push(&mut self.found.objects, object, || document.at(instance).to_string())?;
        }
        Ok(())
    }
}
