//! Hits against brute force, on both kinds of arithmetic; closed meshes without gaps; hostile triangles.

use super::*;
use crate::sampling::stream::{Independent, Stream};
use crate::scene::{Mesh, Rectangle, Sphere};
use glam::Vec3;
use std::f32::consts::TAU;
use std::time::Instant;

/// From −1 to 1.
fn random(i: u64, j: u64) -> f32 {
    (2.0 * Independent::new(11, i, j as u32).pair(0)[0] - 1.0) as f32
}

fn random_vec(i: u64, j: u64) -> Vec3 {
    Vec3::new(random(i, 3 * j), random(i, 3 * j + 1), random(i, 3 * j + 2))
}

/// A heap of triangles of sizes over three powers of ten.
fn heap(count: u64) -> Mesh {
    let corners = |i| [1, 2, 3].map(|j| random_vec(i, 0) + 10f32.powf(random(i, 30) * 1.5 - 1.5) * random_vec(i, j));
    let positions = (0..count).flat_map(corners).collect();
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(positions, vec![], triangles).unwrap()
}

/// A closed star-shaped surface around the origin, rough enough that its triangles are of all shapes.
fn star(rings: u32, spokes: u32) -> Mesh {
    let mut positions = vec![Vec3::Y, Vec3::NEG_Y];
    for ring in 1..rings {
        let (sin, cos) = (TAU / 2.0 * ring as f32 / rings as f32).sin_cos();
        for spoke in 0..spokes {
            let (z, x) = (TAU * spoke as f32 / spokes as f32).sin_cos();
            let radius = 1.0 + 0.5 * random(u64::from(ring), u64::from(spoke));
            positions.push(radius * Vec3::new(sin * x, cos, sin * z));
        }
    }
    let at = |ring: u32, spoke: u32| 2 + (ring - 1) * spokes + spoke % spokes;
    let mut triangles = vec![];
    for s in 0..spokes {
        triangles.push([0, at(1, s + 1), at(1, s)]);
        triangles.push([1, at(rings - 1, s), at(rings - 1, s + 1)]);
        for r in 1..rings - 1 {
            triangles.push([at(r, s), at(r, s + 1), at(r + 1, s)]);
            triangles.push([at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)]);
        }
    }
    Mesh::new(positions, vec![], triangles).unwrap()
}

fn portable(bvh: &Bvh) -> Bvh {
    let mut bvh = bvh.clone();
    #[cfg(target_arch = "x86_64")]
    {
        bvh.avx2 = None;
    }
    bvh
}

/// Rays of all kinds: anywhere, along axes and planes of the axes, starting far away and on the triangles.
fn rays(mesh: &Mesh, count: u64) -> Vec<Ray> {
    let ray = |i: u64| {
        let point = mesh.positions[i as usize % mesh.positions.len()];
        let origin = [2.0 * random_vec(i, 20), point, 1000.0 * random_vec(i, 20)][i as usize % 3];
        let towards = 0.5 * random_vec(i, 21) - origin;
        let signs = Vec3::new(1.0, -1.0, -0.0);
        let axis = [Vec3::X, -Vec3::X, Vec3::Y, Vec3::Z * signs, Vec3::new(1.0, -0.0, 1.0)][i as usize % 5];
        let (origin, direction) = match i % 4 {
            0 => (origin, axis),
            1 => (0.3 * random_vec(i, 22) * axis.cross(Vec3::ONE) + point * axis - 2.0 * axis, axis),
            _ => (origin, towards),
        };
        Ray { origin, direction: direction.normalize() }
    };
    (0..count).map(ray).collect()
}

/// Holds the hits of rays up to a distance to brute force, on both kinds of arithmetic. Coordinates are up to a few times `scale`. Returns
/// how many spheres, rectangles and meshes are hit.
fn assert_hits(shapes: &[Shape], scale: f32, rays: impl Iterator<Item = (Ray, f32)>) -> [u32; 3] {
    let bvh = Bvh::build(&shapes.iter().collect::<Vec<_>>());
    let (plain, brute_force) = (portable(&bvh), BruteForce::new(shapes));
    let mut hits = [0; 3];
    for (i, (ray, t_max)) in rays.enumerate() {
        let expected = brute_force.nearest(&ray, t_max);
        let known = |hit: Option<Hit>| hit.map(|hit| Hit { place: 0, ..hit });
        let found = bvh.nearest(&ray, t_max);
        assert_eq!(known(found), expected, "{scale:e} {i} {ray:?}");
        assert_eq!(plain.nearest(&ray, t_max), found);
        assert_eq!(bvh.occluded(&ray, t_max), expected.is_some());
        assert_eq!(plain.occluded(&ray, t_max), expected.is_some());
        let Some(hit) = found else { continue };
        assert!(bvh.nearest(&ray, hit.t).is_none_or(|nearer| nearer.t < hit.t), "the limit is excluded");
        match &shapes[hit.shape as usize] {
            Shape::Sphere(_) => hits[0] += 1,
            Shape::Rectangle(_) => hits[1] += 1,
            Shape::Mesh(mesh) => {
                hits[2] += 1;
                assert!(hit.t > 0.0 && hit.t < t_max && hit.u >= 0.0 && hit.v >= 0.0);
                let surface = bvh.surface(hit.place, hit.u, hit.v);
                assert_eq!(Some(surface), mesh.surface(hit.triangle, hit.u, hit.v));
                assert_eq!(bvh.triangle(hit.place), hit.triangle);
                let error = surface.point - (ray.origin + hit.t * ray.direction);
                assert!(error.length() < 8e-6 * (ray.origin.length() + 4.0 * scale), "{scale:e} {i} {error}");
            }
        }
    }
    hits
}

#[test]
fn hits_are_those_of_brute_force_on_every_processor() {
    let mesh = heap(700);
    let t_max = |i: usize| if i.is_multiple_of(3) { 1.0 } else { f32::INFINITY };
    let rays: Vec<_> = rays(&mesh, 4000).into_iter().enumerate().map(|(i, ray)| (ray, t_max(i))).collect();
    let [.., hits] = assert_hits(&[mesh.into()], 1.0, rays.into_iter());
    assert!((1000..3900).contains(&hits), "{hits}");
}

#[test]
fn batches_give_what_single_rays_give() {
    let mesh = heap(500);
    let bvh = Bvh::build(&[&Shape::from(mesh.clone())]);
    let rays = rays(&mesh, 300);
    let component = |f: fn(&Ray) -> Vec3, axis: usize| -> Vec<f32> { rays.iter().map(|r| f(r)[axis]).collect() };
    let origin = [0, 1, 2].map(|axis| component(|r| r.origin, axis));
    let direction = [0, 1, 2].map(|axis| component(|r| r.direction, axis));
    let t_max: Vec<f32> = (0..rays.len()).map(|i| [f32::INFINITY, 0.0, -1.0, f32::NAN, 0.7][i % 5]).collect();
    let batch = Rays {
        origin: [&origin[0], &origin[1], &origin[2]],
        direction: [&direction[0], &direction[1], &direction[2]],
        t_max: &t_max,
    };
    let (mut nearest, mut occluded) = (vec![None; rays.len()], vec![true; rays.len()]);
    bvh.nearest_many(batch, &mut nearest);
    bvh.occluded_many(batch, &mut occluded);
    for (i, ray) in rays.iter().enumerate() {
        assert_eq!(nearest[i], bvh.nearest(ray, t_max[i]));
        assert_eq!(occluded[i], nearest[i].is_some());
        assert!(nearest[i].is_none() || [0, 4].contains(&(i % 5)));
    }
    assert!(nearest.iter().flatten().count() > 20);
}

/// Rays from inside at corners and edges, where f32 cannot aim exactly: they go by either side of them.
#[test]
fn closed_meshes_have_no_gaps() {
    let mesh = star(40, 60);
    let bvh = Bvh::build(&[&Shape::from(mesh.clone())]);
    let mut escaped = 0;
    for i in 0..400_000u64 {
        let corners = mesh.facet((i % mesh.triangles.len() as u64) as u32).unwrap().0;
        let [a, b] = [corners[i as usize % 3], corners[(i as usize + 1) % 3]];
        let target = if i % 4 == 0 { a } else { a + 0.5 * (1.0 + random(i, 1)) * (b - a) };
        let origin = 0.1 * random_vec(i, 1);
        let ray = Ray { origin, direction: (target - origin).normalize() };
        escaped += u32::from(!bvh.occluded(&ray, f32::INFINITY));
        // The plain cube of directions: exact corners, edges and faces of boxes.
        let lattice = [i % 5, i / 5 % 5, i / 25 % 5].map(|k| k as f32 / 2.0 - 1.0);
        if i < 125 && lattice != [0.0; 3] {
            let ray = Ray { origin: Vec3::ZERO, direction: Vec3::from(lattice).normalize() };
            escaped += u32::from(!bvh.occluded(&ray, f32::INFINITY));
        }
    }
    assert_eq!(escaped, 0);
}

#[test]
fn of_triangles_at_one_distance_the_first_is_hit() {
    let square = Shape::Rectangle(Rectangle::new(Vec3::ZERO, Vec3::X, Vec3::Y).unwrap());
    let bvh = Bvh::build(&[&Shape::from(Mesh::default()), &square, &square]);
    let diagonal = Ray { origin: Vec3::new(0.5, 0.5, 3.0), direction: Vec3::NEG_Z };
    let hit = bvh.nearest(&diagonal, f32::INFINITY).unwrap();
    assert_eq!((hit.t, hit.shape, hit.triangle), (3.0, 1, 0));
}

/// What there is to hit, one by one: spheres by [`Sphere::distance`], triangles each in a tree of its own.
struct BruteForce {
    primitives: Vec<(u32, u32, Result<Sphere, Bvh>)>,
}

impl BruteForce {
    fn new(shapes: &[Shape]) -> Self {
        let mut primitives = vec![];
        for (number, shape) in (0..).zip(shapes) {
            let single = |corners: [Vec3; 3]| {
                let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
                Err(Bvh::build(&[&Shape::from(mesh)]))
            };
            match shape {
                Shape::Sphere(sphere) if sphere.bounds().is_some() => primitives.push((number, 0, Ok(*sphere))),
                Shape::Sphere(_) => {}
                Shape::Rectangle(rectangle) => {
                    let [a, b, c, d] = rectangle.corners();
                    primitives.extend([(number, 0, single([a, b, c])), (number, 1, single([a, c, d]))]);
                }
                Shape::Mesh(mesh) => {
                    let facets = (0..mesh.triangles.len() as u32).filter_map(|i| Some((i, mesh.facet(i)?.0)));
                    primitives.extend(facets.map(|(i, corners)| (number, i, single(corners))));
                }
            }
        }
        Self { primitives }
    }

    fn nearest(&self, ray: &Ray, t_max: f32) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for (shape, triangle, primitive) in &self.primitives {
            let limit = nearest.map_or(t_max, |hit| hit.t);
            let hit = match primitive {
                Ok(sphere) => {
                    let t = sphere.distance(ray.origin, ray.direction);
                    (t < limit).then_some(Hit { t, ..Hit::default() })
                }
                Err(single) => single.nearest(ray, limit),
            };
            nearest = hit.map(|hit| Hit { shape: *shape, triangle: *triangle, ..hit }).or(nearest);
        }
        nearest
    }
}

/// Shapes of all kinds, some of them twice, of sizes over three powers of ten times `scale`.
fn mixture(count: u64, scale: f32) -> Vec<Shape> {
    let shape = |i: u64| {
        let size = scale * 10f32.powf(random(i, 30) * 1.5 - 1.5);
        let centre = scale * random_vec(i, 0);
        match i % 4 {
            0 => Shape::from(Mesh {
                positions: (1..7).map(|j| centre + size * random_vec(i, j)).collect(),
                triangles: vec![[0, 1, 2], [3, 4, 5], [0, 2, 4]],
                ..Mesh::default()
            }),
            1 => {
                let (x, y) = random_vec(i, 1).normalize().any_orthonormal_pair();
                Shape::Rectangle(Rectangle::new(centre, size * x, 0.3 * size * y).unwrap())
            }
            _ => Shape::Sphere(Sphere { centre, radius: 0.5 * size }),
        }
    };
    (0..count).map(|i| shape(if i % 10 == 9 { i / 2 } else { i })).collect()
}

#[test]
fn mixtures_are_hit_as_by_brute_force() {
    for (count, scale) in [(1, 1.0), (7, 1.0), (60, 1e-12), (400, 1.0), (400, 1e12)] {
        let shapes = mixture(count, scale);
        let ray = |i: u64| {
            // From among the shapes, from far away, and from the edge of a sphere past it.
            let target = scale * random_vec(i, 41);
            let origin = [1.0, 3.0, 1000.0][i as usize % 3] * scale * random_vec(i, 40);
            let ray = match (&shapes[i as usize % shapes.len()], i % 2) {
                (Shape::Sphere(s), 0) => {
                    let across = random_vec(i, 42).cross(origin - s.centre).normalize();
                    let rim = s.centre + s.radius * (1.0 + random(i, 43) * 1e-6) * across;
                    Ray { origin, direction: (rim - origin).normalize() }
                }
                _ => Ray { origin, direction: (target - origin).normalize() },
            };
            (ray, if i.is_multiple_of(5) { scale } else { f32::INFINITY })
        };
        let hits = assert_hits(&shapes, scale, (0..4000).map(ray));
        assert!(count < 400 || hits.iter().all(|&hits| hits > 100), "{hits:?}");
    }
}

#[test]
fn spheres_are_hit_from_inside_and_on_their_surface() {
    let sphere = |z: f32, radius: f32| Shape::Sphere(Sphere { centre: z * Vec3::Z, radius });
    // Spheres in one another, some of them twice.
    let shapes = [sphere(0.0, 3.0), sphere(0.0, 1.0), sphere(0.0, 1.0), sphere(1.0, 2.0), sphere(1.0, 2.0)];
    let bvh = Bvh::build(&shapes.each_ref());
    let along = |z: f32| bvh.nearest(&Ray { origin: z * Vec3::Z, direction: Vec3::Z }, f32::INFINITY);
    let found = |z: f32| along(z).map(|hit| (hit.t, hit.shape));
    assert_eq!(found(-5.0), Some((2.0, 0)));
    assert_eq!(found(-2.0), Some((1.0, 1)), "two spheres at once");
    assert_eq!(found(0.0), Some((1.0, 1)), "from the centre");
    assert_eq!(found(-3.0), Some((0.0, 0)), "t = 0 counts");
    assert_eq!(found(2.5), Some((0.5, 0)), "three spheres at once");
    assert_eq!(found(4.0), None);
}

/// Rays into the diagonal of rectangles and their inside, where f32 cannot aim exactly.
#[test]
fn rectangles_have_no_gaps() {
    for i in 0..200u64 {
        let (x, y) = random_vec(i, 0).normalize().any_orthonormal_pair();
        let rectangle = Rectangle::new(3.0 * random_vec(i, 1), x, 10f32.powf(random(i, 9)) * y).unwrap();
        let bvh = Bvh::build(&[&Shape::Rectangle(rectangle)]);
        let [a, _, c, _] = rectangle.corners();
        let side = (3.0 + random(i, 11)) * rectangle.normal();
        for j in 0..500 {
            let target = a.lerp(c, 0.5 + 0.49 * random(i, 100 + j));
            let origin = target + side + 3.0 * random_vec(i, 1000 + j).reject_from(side);
            let ray = Ray { origin, direction: (target - origin).normalize() };
            let hit = bvh.nearest(&ray, f32::INFINITY).unwrap();
            assert!((hit.t - target.distance(origin)).abs() < 1e-5 * (hit.t + a.distance(c)), "{i} {j} {hit:?}");
        }
    }
}

#[test]
fn rays_beside_triangles_miss() {
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z };
    assert_eq!(Bvh::build(&[]).nearest(&ray, f32::INFINITY), None);
    assert!(!Bvh::build(&[&Shape::from(Mesh::default())]).occluded(&ray, f32::INFINITY));
    // No area, no such vertex, no such place: beside a sound triangle, none is hit.
    let positions = vec![
        Vec3::new(-1.0, -1.0, 5.0),
        Vec3::new(1.0, -1.0, 5.0),
        Vec3::new(0.0, 1.0, 5.0),
        Vec3::new(0.0, -1.0, 2.0),
        Vec3::new(0.0, 1.0, 2.0),
        Vec3::new(f32::NAN, 0.0, 1.0),
        Vec3::INFINITY,
    ];
    let triangles = vec![[3, 4, 3], [3, 3, 3], [3, 4, 9], [3, 4, 5], [3, 4, 6], [0, 1, 2]];
    let mut shapes = vec![Shape::from(Mesh { positions, triangles, ..Mesh::default() })];
    for (centre, radius) in [(Vec3::Z, 0.0), (Vec3::Z, f32::NAN), (Vec3::Z, f32::INFINITY), (Vec3::NAN, 1.0)] {
        shapes.push(Shape::Sphere(Sphere { centre, radius }));
    }
    let far = 1e16 * Vec3::X;
    shapes.extend(Rectangle::new(Vec3::Z, far, Vec3::Y).map(Shape::Rectangle));
    let bvh = Bvh::build(&shapes.iter().collect::<Vec<_>>());
    let hit = bvh.nearest(&ray, f32::INFINITY).unwrap();
    assert_eq!((hit.t, hit.shape, hit.triangle), (5.0, 0, 5));
    let nan = Ray { origin: Vec3::NAN, direction: Vec3::NAN };
    assert_eq!(bvh.nearest(&nan, f32::INFINITY), None);
}

/// Triangles on which a search for near neighbours takes quadratic time, and boxes inside one another.
#[test]
fn degenerate_triangles_are_built_and_traced_quickly() {
    let count = 100_000;
    let sizes: [fn(u32) -> f32; 3] = [|_| 1.0, |i| 1.0 + i as f32 * 1e-5, |i| 1.0005f32.powi(i as i32 - 50_000)];
    for size in sizes {
        let positions = (0..count)
            .flat_map(|i| [Vec3::new(-1.0, -1.0, -1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::Y].map(|p| size(i) * p))
            .collect();
        let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let start = Instant::now();
        let bvh = Bvh::build(&[&Shape::from(Mesh { positions, triangles, ..Mesh::default() })]);
        let ray = Ray { origin: Vec3::new(0.0, 1e-3, 9.0), direction: Vec3::NEG_Z };
        let _ = bvh.nearest(&ray, f32::INFINITY);
        assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
    }
}
