//! Textures: their means in a furnace, and that nothing but them changes.

use super::*;
use etalon_core::bsdf::{Bsdf, CoatedDiffuse};
use etalon_core::scene::{ImageTexture, RoughnessScale, Texels, Texture, Textured, UvMapping, Wrap};
use glam::{DVec2, Vec2};

fn constant(value: f32) -> Texture {
    Texture::Constant(Rgb::splat(value))
}

/// 4 × 3 texels of different colours.
fn texels() -> Image {
    Image::from_fn(4, 3, |x, y| Rgb::new(0.1 + 0.2 * x as f32, 0.9 - 0.3 * y as f32, 0.5))
}

fn image_texture(image: Image, scale: f64) -> Texture {
    let mapping = UvMapping { scale: DVec2::splat(scale), offset: DVec2::ZERO };
    Texture::Image(ImageTexture {
        texels: Arc::new(Texels::new(image)),
        mapping,
        wrap: Wrap::Repeat,
        scale: 1.0,
        invert: false,
    })
}

fn checkerboard(squares: f64, textures: [Texture; 2]) -> Texture {
    let mapping = UvMapping { scale: DVec2::splat(squares), offset: DVec2::ZERO };
    Texture::Checkerboard { mapping, textures: Arc::new(textures) }
}

fn textured(base: Material) -> Textured {
    Textured { base, reflectance: None, transmittance: None, alpha: None }
}

fn material(textured: Textured) -> Material {
    Material::Textured(Arc::new(textured))
}

fn with_reflectance(base: Material, texture: Texture) -> Material {
    material(Textured { reflectance: Some(texture), ..textured(base) })
}

const WHITE: Material = Material::Diffuse { albedo: Rgb::ONE };

/// Surfaces with textures: of every kind of lobe, and on every shape.
pub fn materials() -> Vec<Material> {
    let image = || image_texture(texels(), 3.0);
    let roughness = || {
        let of = |texture| Texture::Alpha(RoughnessScale::SquareRoot, Arc::new(texture));
        Some([of(checkerboard(6.0, [constant(0.02), constant(0.3)])), of(constant(0.1))])
    };
    let metal = Conductor { two_sided: true, ..metal(0.5, Distribution::Ggx) };
    let glass = Material::Dielectric(Dielectric::rough(1.5, 0.5, Distribution::Ggx));
    let painted = with_reflectance(WHITE, image());
    let mixed = [(0.4, painted.clone()), (0.6, Material::Conductor(metal))];
    vec![
        painted,
        with_reflectance(Material::Mirror { reflectance: Rgb::ONE }, image()),
        with_reflectance(Material::from(Bsdf::CoatedDiffuse(CoatedDiffuse::new(Rgb::ONE, 1.5))), image()),
        material(Textured { alpha: roughness(), ..textured(Material::Conductor(metal)) }),
        material(Textured {
            transmittance: Some(checkerboard(8.0, [constant(1.0), image()])),
            alpha: roughness(),
            ..textured(glass)
        }),
        material(Textured { transmittance: Some(image()), ..textured(Material::Dielectric(Dielectric::clear(1.5))) }),
        Material::Mixture(Arc::new(mixed)),
    ]
}

/// The scene of many lights with textures on everything that emits no light.
pub fn many_textures() -> Scene {
    let mut scene = many_lights();
    scene.name = "many textures".into();
    scene.objects.retain(|object| object.emission.is_some() || matches!(object.shape, Shape::Rectangle(_)));
    for object in scene.objects.iter_mut().filter(|object| object.emission.is_none()) {
        object.material = with_reflectance(WHITE, checkerboard(40.0, [constant(0.2), image_texture(texels(), 20.0)]));
    }
    scene.objects.extend(balls(materials()));
    // A roof of two triangles with texture coordinates.
    let corners =
        vec![Vec3::new(0.9, 0.1, 0.9), Vec3::new(0.9, 0.1, 0.3), Vec3::new(0.9, 0.6, 0.6), Vec3::new(0.5, 0.1, 0.6)];
    let mesh = Mesh::new(corners, Vec::new(), vec![[0, 1, 2], [3, 0, 2]]).unwrap();
    let uv = vec![[Vec2::ZERO, Vec2::X, Vec2::ONE], [Vec2::Y, Vec2::new(-1.0, 2.0), Vec2::X]];
    scene.objects.push(Object::new(Mesh { uv, ..mesh }.into(), materials().remove(2)));
    scene
}

/// A square of side 2 in uniform light of radiance 1, seen from above, u to the right and v upwards.
fn plane(texture: Texture) -> (Scene, Request) {
    let square = Rectangle::new(Vec3::ZERO, Vec3::X, Vec3::NEG_Z).unwrap();
    let white = Image::from_pixels(1, 1, vec![Rgb::ONE]);
    let mut scene = floor(Vec::new(), Vec::new());
    scene.objects = vec![Object::new(Shape::Rectangle(square), with_reflectance(WHITE, texture))];
    scene.environment = Some(Environment::upright(Arc::new(EnvMap::new(white)), "test", 1.0));
    scene.camera = above(0.0, 0.0);
    scene.camera.projection = Projection::Orthographic { half_width: 1.0, half_height: 1.0 };
    (scene, Request { width: 12, height: 12, spp: 256, light_samples: 1, max_depth: 1 })
}

/// The largest difference of the means of 6 × 6 regions and channels from those of the texture, in standard errors: of the image's own
/// estimate, with the rounding of f32.
fn largest_z(scene: &Scene, request: &Request, settings: &Settings, texture: &Texture) -> f64 {
    let film = render(scene, request, settings, &Silent).unwrap().part.film;
    let (image, errors) = (film.image(), film.standard_error());
    let mut largest = 0.0f64;
    for (x, y) in (0..36).map(|i| (i % 6, i / 6)) {
        let mut expected = glam::DVec3::ZERO;
        const STEPS: usize = 64;
        for (i, j) in (0..STEPS * STEPS).map(|k| (k % STEPS, k / STEPS)) {
            let place = |i: usize, n: usize| (n as f32 + (i as f32 + 0.5) / STEPS as f32) / 6.0;
            expected += texture.at(Vec2::new(place(i, x), 1.0 - place(j, y))).as_dvec3() / (STEPS * STEPS) as f64;
        }
        let (mut found, mut variance) = (DVec3::ZERO, DVec3::ZERO);
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (x, y) = (2 * x + i, 2 * y + j);
            found += image.get(x, y).as_dvec3() / 4.0;
            variance += (errors.get(x, y).as_dvec3() / 4.0).powf(2.0);
        }
        // The sum over points of the texture is exact to 10⁻³ where it is smooth.
        let error = variance.map(f64::sqrt) + 1e-3 * expected;
        largest = largest.max(((found - expected) / error).abs().max_element());
    }
    largest
}

#[test]
fn a_plane_in_a_furnace_has_the_means_of_its_texture() {
    let board = checkerboard(6.0, [constant(0.2), Texture::Constant(Rgb::new(0.9, 0.5, 0.1))]);
    for texture in [board.clone(), image_texture(texels(), 1.0), image_texture(texels(), 2.5)] {
        let (scene, request) = plane(texture.clone());
        for kernel in [Kernel::Lanes, Kernel::Reference] {
            for sampling in [Sampling::Bsdf, Sampling::Mis] {
                let settings = Settings { kernel, sampling, stream: StreamKind::Independent, ..Settings::default() };
                let z = largest_z(&scene, &request, &settings, &texture);
                // 108 means: one in 10⁵ exceeds 5 by chance.
                assert!(z < 5.0, "{texture:?} {kernel:?} {sampling:?}: {z}");
            }
        }
    }
    // Faults: half a texel aside, upside-down, the other squares first.
    let settings = Settings { stream: StreamKind::Independent, ..Settings::default() };
    let flipped = image_texture(texels().flipped_vertically(), 1.0);
    let Texture::Image(mut shifted) = image_texture(texels(), 1.0) else { unreachable!() };
    shifted.mapping.offset = DVec2::new(0.125, 0.0);
    let exchanged = checkerboard(6.0, [Texture::Constant(Rgb::new(0.9, 0.5, 0.1)), constant(0.2)]);
    for (texture, faulty) in [
        (image_texture(texels(), 1.0), flipped),
        (image_texture(texels(), 1.0), Texture::Image(shifted)),
        (board, exchanged),
    ] {
        let (scene, request) = plane(faulty);
        let z = largest_z(&scene, &request, &settings, &texture);
        assert!(z > 10.0, "{texture:?}: {z}");
    }
}

#[test]
fn a_texel_and_the_turn_of_a_sphere_tell_renders_apart() {
    let (mut scene, request) = plane(image_texture(texels(), 1.0));
    let print = |scene: &Scene| crate::job::fingerprint(scene, &request, &Settings::default());
    let before = print(&scene);
    assert_eq!(before, print(&plane(image_texture(texels(), 1.0)).0));
    let mut other = texels();
    other.set(1, 2, Rgb::splat(0.25));
    assert_ne!(before, print(&plane(image_texture(other, 1.0)).0));
    assert_ne!(before, print(&plane(image_texture(texels(), 2.0)).0));
    scene.objects[0].meridians = [Vec3::Y, Vec3::NEG_X];
    assert_ne!(before, print(&scene));
}
