//! Traverses the nodes of the visual scene and collects camera, lights and objects.

use super::document::{Document, Element, elements, is};
use super::transform::View;
use super::{geometry, light, material, transform};
use crate::error::{Error, Result};
use crate::import::transform::{affine, directions};
use crate::memory;
use crate::scene::{Light, Object};
use glam::{DMat4, DVec3};

/// Deepest nesting of nodes, and most nodes, each counted as often as it is instanced.
const MAX_DEPTH: usize = 256;
const MAX_NODES: usize = 1 << 18;

#[derive(Default)]
pub struct Found<'a> {
    pub view: Option<View<'a>>,
    pub lights: Vec<Light>,
    pub objects: Vec<Object>,
}

impl Found<'_> {
    /// The box around all objects.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let boxes = self.objects.iter().filter_map(|object| light::bounds(&object.shape));
        boxes.reduce(|[a, b], [low, high]| [a.min(low), b.max(high)]).map(|ends| ends.map(|end| end.as_dvec3()))
    }
}

/// Collects the content of the file's scene.
pub fn walk<'a>(document: &Document<'a>) -> Result<Found<'a>> {
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
            if let Some(light) = light::light(document, light, to_world)? {
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
