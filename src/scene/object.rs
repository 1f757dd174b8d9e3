//! Objects: a shape, its material, and the light that it emits.

use super::{Emission, Material, Mesh, Rectangle, Sphere};
use std::sync::Arc;

/// A shape, its material, and whether it emits light.
#[derive(Debug, Clone)]
pub struct Object {
    /// Its surface, in the world.
    pub shape: Shape,
    /// How the surface scatters light.
    pub material: Material,
    /// The light that the surface gives off; `None` for most.
    pub emission: Option<Emission>,
}

impl Object {
    /// An object that emits no light.
    #[must_use]
    pub fn new(shape: Shape, material: Material) -> Self {
        Self { shape, material, emission: None }
    }
}

/// A shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A whole sphere.
    Sphere(Sphere),
    /// A flat rectangle.
    Rectangle(Rectangle),
    /// Triangles; a mesh may be shared by objects.
    Mesh(Arc<Mesh>),
}
