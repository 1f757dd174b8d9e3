//! The scene's shapes laid out for many rays at once: which one a ray meets first, and whether any is in its way.
//!
//! Rectangles and spheres are tried one after the other, each against all rays in one vectorized loop, which for the
//! few that a scene has is faster than any tree. Triangles stand in a bounding volume hierarchy of their own, built
//! only where there is a mesh.

use super::lanes::{Hits, LANES, Lane, NOTHING, Rays, at};
use super::solids::{Panel, Solid, Wall};
use super::wide::{Wide, wide};
use crate::math::Frame;
use crate::scene::bvh::{self, MeshBvh};
use crate::scene::{Light, Object, Rectangle, Scene, Shape, Sphere};
use glam::Vec3;
use pulp::Arch;

/// A surface where a ray has met it.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// In the world.
    pub position: Vec3,
    /// Unit normal of the outside.
    pub normal: Vec3,
    /// Unit normal for shading; that of the surface unless it is a smooth mesh.
    pub shading: Vec3,
    /// How far along the normal a ray must start to be off the surface despite rounding.
    pub offset: f32,
}

impl Surface {
    /// Whether the normal for shading is that of the surface.
    #[inline(always)]
    pub fn is_flat(&self) -> bool {
        self.shading == self.normal
    }

    /// The surface with its normal on the side of `wo`, and the normal for shading on the side of that.
    #[inline]
    #[must_use]
    pub fn facing(self, wo: Vec3) -> Self {
        let normal = if self.normal.dot(wo) < 0.0 { -self.normal } else { self.normal };
        let shading = if self.shading.dot(normal) < 0.0 { -self.shading } else { self.shading };
        Self { normal, shading, ..self }
    }

    /// The shading frame for `wo`: about the geometric normal where the shading normal faces away.
    #[inline]
    pub fn frame(&self, wo: Vec3) -> Frame {
        let same_side = self.shading.dot(wo) * self.normal.dot(wo) > 0.0;
        Frame::from_normal(if same_side { self.shading } else { self.normal })
    }

    /// The origin of a ray towards `wi`, offset against self-intersection.
    #[inline]
    pub fn ray_origin(&self, wi: Vec3) -> Vec3 {
        let side = if self.normal.dot(wi) < 0.0 { -1.0 } else { 1.0 };
        self.position + self.normal * (side * self.offset)
    }
}

/// The prepared shapes.
pub struct Geometry<'a> {
    objects: &'a [Object],
    walls: Vec<Wall>,
    spheres: Vec<(Sphere, u32)>,
    /// Per object, [`Surface::offset`].
    offsets: Vec<f32>,
    extent: f32,
    /// Those that can stand between two points of the scene: a wall with everything on one side cannot.
    blockers: Vec<Wall>,
    meshes: Option<Meshes>,
    arch: Arch,
}

/// The triangles of all meshes.
struct Meshes {
    tree: MeshBvh,
    /// A box around all of them, with a margin for rounding.
    bounds: [Vec3; 2],
    /// The object that each mesh is.
    object: Vec<u32>,
}

impl<'a> Geometry<'a> {
    /// Prepares the shapes; `with_meshes` says whether to build the tree of triangles if there are none.
    pub fn new(scene: &'a Scene, with_meshes: bool) -> Self {
        let objects = &scene.objects;
        let mut walls = Vec::new();
        let (mut spheres, mut blockers) = (Vec::new(), Vec::new());
        let (mut meshes, mut mesh_objects) = (Vec::new(), Vec::new());
        // A large mesh is looked through once.
        let hulls: Vec<Hull> = objects.iter().map(|object| hull(&object.shape)).collect();
        let places = places(scene, &hulls);
        for (i, object) in objects.iter().enumerate() {
            match &object.shape {
                Shape::Rectangle(rectangle) => {
                    let wall = Wall::new(rectangle, i as u32);
                    walls.push(wall);
                    if !places.as_ref().is_some_and(|places| encloses(rectangle, places)) {
                        blockers.push(wall);
                    }
                }
                Shape::Sphere(sphere) => spheres.push((*sphere, i as u32)),
                Shape::Mesh(mesh) => {
                    meshes.push(&**mesh);
                    mesh_objects.push(i as u32);
                }
            }
        }
        let offsets = hulls.iter().map(|hull| 16.0 * f32::EPSILON * extent(hull)).collect();
        let bounds = || hulls.iter().flatten();
        let low = bounds().fold(Vec3::INFINITY, |low, (p, radius)| low.min(p - radius));
        let high = bounds().fold(Vec3::NEG_INFINITY, |high, (p, radius)| high.max(p + radius));
        let meshes = with_meshes.then(|| Meshes {
            bounds: around(mesh_objects.iter().flat_map(|&i| &hulls[i as usize])),
            tree: MeshBvh::build(&meshes),
            object: mesh_objects,
        });
        Self { objects, walls, spheres, offsets, extent: (high - low).length(), blockers, meshes, arch: Arch::new() }
    }

    /// The nearest object of the first `count` rays.
    pub fn nearest(&self, rays: &Rays, count: usize, hits: &mut Hits) {
        hits.t[..count].fill(f32::INFINITY);
        hits.object[..count].fill(NOTHING);
        for wall in &self.walls {
            let object = wall.object;
            match &wall.panel {
                Panel::X(solid) => wide(self.arch, Nearest { solid, object, rays, count, hits }),
                Panel::Y(solid) => wide(self.arch, Nearest { solid, object, rays, count, hits }),
                Panel::Z(solid) => wide(self.arch, Nearest { solid, object, rays, count, hits }),
                Panel::Tilted(solid) => wide(self.arch, Nearest { solid, object, rays, count, hits }),
            }
        }
        for (sphere, object) in &self.spheres {
            wide(self.arch, Nearest { solid: sphere, object: *object, rays, count, hits });
        }
        if let Some(meshes) = &self.meshes {
            let mut reach = [0.0; LANES];
            wide(self.arch, Reach { bounds: meshes.bounds, rays, count, limit: &hits.t, reach: &mut reach });
            let mut found = [None; LANES];
            meshes.tree.nearest_many(limited(rays, &reach, count), &mut found[..count]);
            for (i, hit) in found[..count].iter().enumerate() {
                if let Some(hit) = hit {
                    hits.t[i] = hit.t;
                    hits.object[i] = meshes.object[meshes.tree.mesh_of(hit.triangle) as usize];
                    hits.place[i] = hit.place;
                    (hits.u[i], hits.v[i]) = (hit.u, hit.v);
                }
            }
        }
    }

    /// Sets `blocked[i]` to nonzero where an object other than `light` is nearer than `limit[i]` along ray i.
    pub fn occluded(&self, rays: &Rays, count: usize, limit: &Lane, light: u32, blocked: &mut [u32; LANES]) {
        blocked[..count].fill(0);
        for wall in self.blockers.iter().filter(|wall| wall.object != light) {
            match &wall.panel {
                Panel::X(solid) => wide(self.arch, Blocked { solid, rays, count, limit, blocked }),
                Panel::Y(solid) => wide(self.arch, Blocked { solid, rays, count, limit, blocked }),
                Panel::Z(solid) => wide(self.arch, Blocked { solid, rays, count, limit, blocked }),
                Panel::Tilted(solid) => wide(self.arch, Blocked { solid, rays, count, limit, blocked }),
            }
        }
        for (sphere, _) in self.spheres.iter().filter(|(_, object)| *object != light) {
            wide(self.arch, Blocked { solid: sphere, rays, count, limit, blocked });
        }
        if let Some(meshes) = &self.meshes {
            let mut reach = [0.0; LANES];
            wide(self.arch, Reach { bounds: meshes.bounds, rays, count, limit, reach: &mut reach });
            for (reach, &blocked) in reach[..count].iter_mut().zip(blocked.iter()) {
                // A ray that is stopped already needs no tree.
                *reach = if blocked == 0 { *reach } else { 0.0 };
            }
            let mut found = [false; LANES];
            meshes.tree.occluded_many(limited(rays, &reach, count), &mut found[..count]);
            for i in 0..count {
                blocked[i] |= u32::from(found[i]);
            }
        }
    }

    /// The diagonal of the box around all objects.
    pub fn extent(&self) -> f32 {
        self.extent
    }

    /// [`Surface::offset`] of an object.
    #[inline]
    pub fn offset(&self, object: u32) -> f32 {
        self.offsets[object as usize]
    }

    /// The surface that ray `i` has hit.
    #[inline(always)]
    pub fn surface(&self, rays: &Rays, hits: &Hits, i: usize) -> Surface {
        let id = hits.object[i] as usize;
        let (origin, direction) = (at(&rays.origin, i), at(&rays.direction, i));
        let position = origin + hits.t[i] * direction;
        let offset = self.offsets[id];
        match &self.objects[id].shape {
            Shape::Rectangle(r) => {
                let normal = r.normal();
                // Back onto the plane: the error of the position no longer depends on t.
                let position = position - normal * normal.dot(position - r.centre());
                Surface { position, normal, shading: normal, offset }
            }
            Shape::Sphere(s) => {
                let normal = (origin - s.centre + hits.t[i] * direction).normalize();
                Surface { position: s.centre + s.radius * normal, normal, shading: normal, offset }
            }
            Shape::Mesh(_) => {
                // Without a tree no mesh is ever hit.
                let Some(Meshes { tree, .. }) = &self.meshes else {
                    return Surface { position, normal: -direction, shading: -direction, offset };
                };
                let s = tree.surface(hits.place[i], hits.u[i], hits.v[i]);
                Surface { position: s.point, normal: s.normal, shading: s.shading, offset }
            }
        }
    }
}

/// The first `count` rays up to the given distances.
fn limited<'a>(rays: &'a Rays, t_max: &'a Lane, count: usize) -> bvh::Rays<'a> {
    let part = |lanes: &'a [Lane; 3]| lanes.each_ref().map(|lane| &lane[..count]);
    bvh::Rays { origin: part(&rays.origin), direction: part(&rays.direction), t_max: &t_max[..count] }
}

/// The loop over all rays that looks for the nearest hit.
struct Nearest<'a, S> {
    solid: &'a S,
    object: u32,
    rays: &'a Rays,
    count: usize,
    hits: &'a mut Hits,
}

impl<S: Solid> Wide for Nearest<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { solid, object, rays, count, hits } = self;
        let (t, objects) = (&mut hits.t, &mut hits.object);
        for i in 0..count.min(LANES) {
            let found = solid.distance(at(&rays.origin, i), at(&rays.direction, i));
            let hit = (found >= 0.0) & (found < t[i]);
            t[i] = if hit { found } else { t[i] };
            objects[i] = if hit { object } else { objects[i] };
        }
    }
}

/// The loop over all rays that looks for any hit.
struct Blocked<'a, S> {
    solid: &'a S,
    rays: &'a Rays,
    count: usize,
    limit: &'a Lane,
    blocked: &'a mut [u32; LANES],
}

impl<S: Solid> Wide for Blocked<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { solid, rays, count, limit, blocked } = self;
        for i in 0..count.min(LANES) {
            let found = solid.distance(at(&rays.origin, i), at(&rays.direction, i));
            blocked[i] |= u32::from((found >= 0.0) & (found < limit[i]));
        }
    }
}

/// The loop over all rays that asks which of them reach the box around the meshes: `reach` is the distance up to which
/// the tree is to be searched, 0 if not at all.
struct Reach<'a> {
    bounds: [Vec3; 2],
    rays: &'a Rays,
    count: usize,
    limit: &'a Lane,
    reach: &'a mut Lane,
}

impl Wide for Reach<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { bounds: [low, high], rays, count, limit, reach } = self;
        for i in 0..count.min(LANES) {
            let (origin, inverse) = (at(&rays.origin, i), at(&rays.direction, i).recip());
            let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
            // 0 · ∞ on the face of a slab is NaN, which max and min pass over.
            let near = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z)).max(0.0);
            let far = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z)).min(limit[i]);
            reach[i] = if near <= far { limit[i] } else { 0.0 };
        }
    }
}

/// Spheres that together reach as far as a shape in all directions: itself, or the corners of it or of the box around it.
type Hull = Vec<(Vec3, f32)>;

fn hull(shape: &Shape) -> Hull {
    match shape {
        Shape::Sphere(s) => vec![(s.centre, s.radius)],
        Shape::Rectangle(r) => r.corners().map(|corner| (corner, 0.0)).into(),
        Shape::Mesh(mesh) => {
            let corner = |ends: [Vec3; 2], i: usize| Vec3::new(ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z);
            mesh.bounds().map_or(Vec::new(), |ends| (0..8).map(|i| (corner(ends, i), 0.0)).collect())
        }
    }
}

/// The box around the points of meshes, grown by more than the rounding of a ray's distances to it.
fn around<'a>(points: impl Iterator<Item = &'a (Vec3, f32)>) -> [Vec3; 2] {
    let ends = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let [low, high] = points.fold(ends, |[low, high], (p, _)| [low.min(*p), high.max(*p)]);
    let margin = 1e-4 * (high - low).max_element() + 1e-5 * low.abs().max(high.abs()).max_element();
    [low - margin, high + margin]
}

/// Largest coordinate of a shape, which its points are rounded to.
fn extent(hull: &Hull) -> f32 {
    hull.iter().fold(0.0, |largest, (p, radius)| largest.max(radius + p.abs().max_element()))
}

/// Everything that rays start from or end at; `None` if some go to infinity.
fn places(scene: &Scene, hulls: &[Hull]) -> Option<Hull> {
    let mut all = hulls.concat();
    // Of a film that parallel rays start from, the corners.
    let film = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    all.extend(film.map(|[x, y]| (scene.camera.ray(x, y).origin, 0.0)));
    for light in &scene.lights {
        match light {
            Light::Rectangle { rectangle, .. } => all.extend(rectangle.corners().map(|corner| (corner, 0.0))),
            Light::Point { position, .. } => all.push((*position, 0.0)),
            Light::Directional { .. } | Light::Hemisphere { .. } => return None,
        }
    }
    scene.environment.is_none().then_some(all)
}

/// Whether all places lie on one side of a rectangle's plane: it then cuts no line between two of them.
fn encloses(rectangle: &Rectangle, places: &Hull) -> bool {
    let normal = rectangle.normal();
    let height = normal.dot(rectangle.centre());
    let mut sides = [true; 2];
    for &(p, radius) in places {
        let distance = normal.dot(p) - height;
        let slack = 64.0 * f32::EPSILON * (height.abs() + radius + p.length());
        sides[0] &= distance - radius >= -slack;
        sides[1] &= distance + radius <= slack;
    }
    sides[0] || sides[1]
}
