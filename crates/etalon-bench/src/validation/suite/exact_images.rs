//! The exact image of the white sphere under a map, for tests of renders.

use etalon_core::envmap::irradiance::IrradianceTree;
use etalon_core::scene::{Request, Scene};
use glam::DVec3;
use std::f64::consts::PI;

/// (1/π) E(n) of the sphere's map, averaged over each pixel by Gauss's rule of three points an axis.
pub fn lit_sphere_image(scene: &Scene, request: &Request) -> Vec<Option<f64>> {
    const NODES: [(f64, f64); 3] =
        [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];
    // Closer to the silhouette, three points an axis are not exact enough.
    const INSIDE: f64 = 0.9;
    let Some(environment) = &scene.environment else { return Vec::new() };
    let tree = IrradianceTree::new(&environment.map);
    let scale = f64::from(environment.scale.x) / PI;
    let size = request.width as f64;
    let radiance = |x: f64, y: f64| {
        let z2 = 1.0 - x * x - y * y;
        (z2 > 1.0 - INSIDE * INSIDE).then(|| tree.irradiance(DVec3::new(x, -y, z2.sqrt())).value.x * scale)
    };
    // Nodes of the quadrature in each pixel, in units of the radius.
    let at = |i: usize, node: f64| (2.0 * i as f64 + 1.0 + node) / size - 1.0;
    let pixel = |i: usize| {
        let (x, y) = (i % request.width, i / request.width);
        NODES.iter().try_fold(0.0, |sum, (u, wu)| {
            NODES.iter().try_fold(sum, |sum, (v, wv)| Some(sum + wu * wv * radiance(at(x, *u), at(y, *v))?))
        })
    };
    (0..request.width * request.height).map(pixel).collect()
}
