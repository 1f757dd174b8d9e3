//! The BVH: rays per second on the statue, and against 10 to 10⁶ spheres and triangles; up to how many spheres trying
//! all of them is faster; the time to build the tree.

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use etalon::sampling::stream::{Independent, Stream};
use etalon::scene::statue::statue;
use etalon::scene::{Bvh, Camera, Mesh, Plane, Projection, Ray, Rays, Shape, Sphere};
use glam::{DVec3, Vec3};
use pulp::{Arch, Simd, WithSimd};
use std::array::from_fn;
use std::hint::black_box;

/// Rays per measurement, and per call.
const SIDE: usize = 256;
const CALL: usize = 256;

/// The rays of a camera, row by row.
fn coherent() -> Vec<Ray> {
    let projection = Projection::Perspective { tan_half_width: 0.2, tan_half_height: 0.2 };
    let camera = Camera::look_at(DVec3::new(0.0, 0.75, 3.2), DVec3::new(0.0, 0.5, 0.0), DVec3::Y, projection).unwrap();
    let at = |i: usize| (i as f64 + 0.5) / SIDE as f64;
    (0..SIDE * SIDE).map(|i| camera.ray(at(i % SIDE), at(i / SIDE))).collect()
}

/// A random direction.
fn direction([z, around]: [f64; 2]) -> Vec3 {
    let (sin, cos) = (std::f64::consts::TAU * around).sin_cos();
    let z = 1.0 - 2.0 * z;
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z).as_vec3()
}

/// Rays that leave random points of the surface in random directions of its outer side.
fn incoherent() -> Vec<Ray> {
    let mesh = statue();
    let ray = |i: usize| {
        let stream = Independent::new(1, i as u64, 0);
        let [a, u] = stream.pair(0);
        let triangle = (a * mesh.triangles.len() as f64) as u32;
        let surface = mesh.surface(triangle, 0.5 * u as f32, 0.25).unwrap();
        let plane = Plane::through(surface.point, surface.normal);
        let direction = direction(stream.pair(1));
        let outwards = direction * direction.dot(surface.normal).signum();
        Ray { origin: surface.point + plane.offset(surface.point) * surface.normal, direction: outwards }
    };
    (0..SIDE * SIDE).map(ray).collect()
}

/// A point in the unit cube and a direction.
fn random(seed: u64, i: usize) -> (Vec3, Vec3) {
    let stream = Independent::new(seed, i as u64, 0);
    let ([x, y], [z, _]) = (stream.pair(0), stream.pair(1));
    (DVec3::new(x, y, z).as_vec3(), direction(stream.pair(2)))
}

/// Rays between random points of the unit cube in random directions.
fn anywhere() -> Vec<Ray> {
    let ray = |i| {
        let (origin, direction) = random(2, i);
        Ray { origin, direction }
    };
    (0..SIDE * SIDE).map(ray).collect()
}

/// Spheres in the unit cube that fill a ninth of it, so that rays pass a few, whatever their number.
fn spheres(count: usize) -> Vec<Sphere> {
    let radius = 0.3 / (count as f32).cbrt();
    (0..count).map(|i| Sphere { centre: random(3, i).0, radius }).collect()
}

/// Triangles in the unit cube of about the size of the spheres.
fn triangles(count: usize) -> Mesh {
    let size = 0.5 / (count as f32).cbrt();
    let corners = |i| from_fn::<_, 3, _>(|corner| random(3, i).0 + size * random(4 + corner as u64, i).1);
    let positions = (0..count).flat_map(corners).collect();
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::new(positions, Vec::new(), triangles).unwrap()
}

/// Rays component by component, in calls.
struct Batches {
    origin: [Vec<f32>; 3],
    direction: [Vec<f32>; 3],
    t_max: Vec<f32>,
}

impl Batches {
    fn new(rays: &[Ray]) -> Self {
        let component = |f: fn(&Ray) -> Vec3, axis: usize| rays.iter().map(|r| f(r)[axis]).collect();
        Self {
            origin: from_fn(|axis| component(|r| r.origin, axis)),
            direction: from_fn(|axis| component(|r| r.direction, axis)),
            t_max: vec![f32::INFINITY; CALL],
        }
    }

    fn calls(&self) -> impl Iterator<Item = Rays<'_>> {
        (0..self.origin[0].len()).step_by(CALL).map(|start| Rays {
            origin: from_fn(|axis| &self.origin[axis][start..start + CALL]),
            direction: from_fn(|axis| &self.direction[axis][start..start + CALL]),
            t_max: &self.t_max,
        })
    }
}

/// Measures nearest hits and any hits.
fn both(group: &mut BenchmarkGroup<WallTime>, name: &str, bvh: &Bvh, rays: &Batches) {
    group.throughput(Throughput::Elements((SIDE * SIDE) as u64));
    group.bench_function(format!("nearest, {name}"), |b| {
        let mut hits = [None; CALL];
        b.iter(|| rays.calls().for_each(|call| bvh.nearest_many(call, black_box(&mut hits))));
    });
    group.bench_function(format!("occluded, {name}"), |b| {
        let mut hits = [false; CALL];
        b.iter(|| rays.calls().for_each(|call| bvh.occluded_many(call, black_box(&mut hits))));
    });
}

fn on_statue(c: &mut Criterion) {
    let bvh = Bvh::build(&[&Shape::from(statue())]);
    let mut group = c.benchmark_group("statue");
    group.sample_size(20);
    for (name, rays) in [("coherent", coherent()), ("incoherent", incoherent())] {
        both(&mut group, name, &bvh, &Batches::new(&rays));
    }
    group.finish();
}

fn by_number(c: &mut Criterion) {
    let rays = Batches::new(&anywhere());
    let mut group = c.benchmark_group("many");
    group.sample_size(10);
    for count in (1..=6).map(|power| 10usize.pow(power)) {
        let shapes: Vec<Shape> = spheres(count).into_iter().map(Shape::Sphere).collect();
        both(&mut group, &format!("{count} spheres"), &Bvh::build(&shapes.iter().collect::<Vec<_>>()), &rays);
        let mesh = Shape::from(triangles(count));
        both(&mut group, &format!("{count} triangles"), &Bvh::build(&[&mesh]), &rays);
    }
    group.finish();
}

/// All spheres, each against all rays of a call in a loop that vectorizes, as the renderer does it with a few.
struct EachInTurn<'a> {
    spheres: &'a [Sphere],
    rays: Rays<'a>,
    t: &'a mut [f32; CALL],
    object: &'a mut [u32; CALL],
}

impl WithSimd for EachInTurn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { spheres, rays, t, object } = self;
        let fixed = |lane: &[f32]| -> [f32; CALL] { lane.try_into().unwrap() };
        let ([ox, oy, oz], [dx, dy, dz]) = (rays.origin.map(fixed), rays.direction.map(fixed));
        t.fill(f32::INFINITY);
        for (number, sphere) in (0..).zip(spheres) {
            for i in 0..CALL {
                let found = sphere.distance(Vec3::new(ox[i], oy[i], oz[i]), Vec3::new(dx[i], dy[i], dz[i]));
                let hit = (found >= 0.0) & (found < t[i]);
                t[i] = if hit { found } else { t[i] };
                object[i] = if hit { number } else { object[i] };
            }
        }
    }
}

fn few(c: &mut Criterion) {
    let (rays, arch) = (Batches::new(&anywhere()), Arch::new());
    let mut group = c.benchmark_group("few");
    group.sample_size(20);
    for count in [2, 4, 8, 16, 32, 64, 128] {
        let spheres = spheres(count);
        let shapes: Vec<Shape> = spheres.iter().copied().map(Shape::Sphere).collect();
        both(
            &mut group,
            &format!("{count} spheres in the tree"),
            &Bvh::build(&shapes.iter().collect::<Vec<_>>()),
            &rays,
        );
        group.bench_function(format!("nearest, {count} spheres one by one"), |b| {
            let (mut t, mut object) = ([0.0; CALL], [0; CALL]);
            b.iter(|| {
                for rays in rays.calls() {
                    arch.dispatch(EachInTurn { spheres: &spheres, rays, t: &mut t, object: &mut object });
                    black_box((&mut t, &mut object));
                }
            });
        });
    }
    group.finish();
}

fn build(c: &mut Criterion) {
    let mesh = Shape::from(statue());
    let mut group = c.benchmark_group("statue-build");
    group.sample_size(10);
    group.bench_function("mesh", |b| b.iter(statue));
    group.bench_function("tree", |b| b.iter(|| Bvh::build(&[black_box(&mesh)])));
    group.finish();
}

criterion_group!(benches, on_statue, by_number, few, build);
criterion_main!(benches);
