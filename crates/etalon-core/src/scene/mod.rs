//! What is rendered: camera, shapes, materials, light, and what a scene file asks of a render.

pub mod builtin;
pub mod bvh;
pub mod camera;
mod description;
pub mod light;
pub mod material;
pub mod mesh;
pub mod rectangle;
pub mod scattering;
pub mod sphere;
pub mod statue;
pub mod texture;

pub use crate::sampling::filter::{FilterShape, PixelFilter};
pub use bvh::{Bvh, FirstHit, Hit, Rays};
pub use camera::{Camera, Projection, Ray};
pub use description::{Object, Request, Scene, Shape};
pub use light::{Environment, Falloff, Light};
pub use material::{
    Conductor, Dielectric, Distribution, Emission, EmitterVisibility, Material, SMOOTH_ALPHA, Textured, least_alpha,
};
pub use mesh::{Mesh, Surface};
pub use rectangle::{Plane, Rectangle};
pub use scattering::{ScatterModel, VaryingBsdf};
pub use sphere::Sphere;
pub use texture::{ImageTexture, RoughnessScale, Texels, Texture, UvMapping, Wrap};
