//! Small sound files of every format: what the mutations start from.

use super::program::Actor;
use etalon::raster::{Image, Metadata, Rgb, write};
use etalon::render::film::{Film, Part, PathClasses, Splat};
use exr::meta::attribute::{Chromaticities, EnvironmentMap};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Layer, LayerAttributes, LineOrder, SmallVec,
    Vec2, WritableImage,
};
use image::ExtendedColorType;
use std::io::Cursor;
use std::path::Path;

/// Light over a wide range.
fn picture() -> Image {
    Image::from_fn(12, 6, |x, y| Rgb::new(x as f32 * 0.1, (y * y) as f32, (x as f32 - 6.0).exp()))
}

/// What the library writes into a file of this name.
fn written(name: &str, fill: impl Fn(&Path) -> etalon::Result<()>) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder for the seeds");
    let path = folder.path().join(name);
    fill(&path).expect("a seed is written");
    std::fs::read(&path).expect("a seed is read")
}

/// Pixels as the library writes them, and in all encodings that other programs use.
pub fn exr() -> Vec<Vec<u8>> {
    use Compression::{B44, DWAA, PIZ, PXR24, RLE, Uncompressed, ZIP1};
    let own = written("a.exr", |path| write(path, &picture(), &Metadata::default().with("note", "a seed")));
    let foreign = [Uncompressed, RLE, ZIP1, PIZ, PXR24, B44, DWAA(None)].into_iter().flat_map(|compression| {
        [Blocks::ScanLines, Blocks::Tiles(Vec2(5, 4))].map(|blocks| foreign_exr(compression, blocks))
    });
    [own, environment_exr(), grey_exr()].into_iter().chain(foreign).collect()
}

/// Layers beside the image, primaries of its own, and the mark of a cube map.
fn environment_exr() -> Vec<u8> {
    encoded_exr(&["R", "G", "B", "noise.R", "noise.G", "noise.B", "depth.Z"], |image| {
        image.layer_data.attributes.environment_map = Some(EnvironmentMap::Cube);
        image.attributes.chromaticities = Some(Chromaticities {
            red: Vec2(0.708, 0.292),
            green: Vec2(0.17, 0.797),
            blue: Vec2(0.131, 0.046),
            white: Vec2(0.3127, 0.329),
        });
    })
}

/// A single channel that is no colour, as a lat-long map.
fn grey_exr() -> Vec<u8> {
    encoded_exr(&["A", "Z"], |image| {
        image.layer_data.attributes.environment_map = Some(EnvironmentMap::LatitudeLongitude);
    })
}

fn encoded_exr(
    names: &[&str],
    change: impl FnOnce(&mut exr::prelude::Image<Layer<AnyChannels<FlatSamples>>>),
) -> Vec<u8> {
    let samples = || FlatSamples::F32((0..32).map(|i| i as f32 * 0.25).collect());
    let channels = names.iter().map(|&name| AnyChannel::new(name, samples())).collect();
    let channels = AnyChannels::sort(SmallVec::from_vec(channels));
    let layer = Layer::new(Vec2(8, 4), LayerAttributes::named("main"), Encoding::SMALL_LOSSLESS, channels);
    let mut image = exr::prelude::Image::from_layer(layer);
    change(&mut image);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).expect("an OpenEXR seed");
    bytes.into_inner()
}

fn foreign_exr(compression: Compression, blocks: Blocks) -> Vec<u8> {
    let image = picture();
    let samples = |i: usize| image.pixels().iter().map(move |pixel| pixel[i]);
    let channels = AnyChannels::sort(SmallVec::from_vec(vec![
        AnyChannel::new("R", FlatSamples::F32(samples(0).collect())),
        AnyChannel::new("G", FlatSamples::F16(samples(1).map(half::f16::from_f32).collect())),
        AnyChannel::new("B", FlatSamples::F32(samples(2).collect())),
        AnyChannel::new("id.Y", FlatSamples::U32(samples(0).map(|v| v as u32).collect())),
    ]));
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let size = Vec2(image.width(), image.height());
    let layer = Layer::new(size, LayerAttributes::named("main"), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    exr::prelude::Image::from_layer(layer).write().to_buffered(&mut bytes).expect("an OpenEXR seed");
    bytes.into_inner()
}

pub fn hdr() -> Vec<Vec<u8>> {
    let own = written("a.hdr", |path| write(path, &picture(), &Metadata::default()));
    let old = b"#?RGBE\nEXPOSURE=2\nCOLORCORR=1 2 1\nFORMAT=32-bit_rle_rgbe\n\n+X 3 -Y 3\n\
                \x80\x40\x20\x81\x01\x01\x01\x02\x10\x20\x30\x80\x01\x01\x01\x02\x20\x10\x08\x7f\x01\x01\x01\x02";
    let primaries = b"#?RADIANCE\nPRIMARIES= .708 .292 .17 .797 .131 .046 .3127 .329\nFORMAT=32-bit_rle_rgbe\n\n\
                      -Y 1 +X 2\n\x80\x40\x20\x81\x10\x20\x30\x80";
    vec![own, old.to_vec(), primaries.to_vec()]
}

pub fn pfm() -> Vec<Vec<u8>> {
    let colour = written("a.pfm", |path| write(path, &picture(), &Metadata::default()));
    let others: [&[u8]; 3] = [
        b"Pf\n2 2\n1.5\n\x3f\x80\0\0\x40\0\0\0\x7f\xc0\0\0\xff\x80\0\0",
        b"PF\r\n1 1\r\n-1\r\n\n\0\x80\x3f\0\0\0\x40\0\0\x40\x40",
        b"Pf\n  2   1  \n -2.0 \t \n\n\n\n \0\0\x80\x3f",
    ];
    std::iter::once(colour).chain(others.map(<[u8]>::to_vec)).collect()
}

pub fn pnm() -> Vec<Vec<u8>> {
    let own = written("a.ppm", |path| write(path, &picture(), &Metadata::default()));
    let others: [&[u8]; 5] = [
        b"P1\n# a comment\n4 2\n0 1 0 1\n1 0 1 0\n",
        b"P2\n3 2\n15\n0 1 2\n13 14 15\n",
        b"P3 2 1 65535 1 2 3 65533 65534 65535\n",
        b"P4\n9 2\n\x55\x80\xaa\0",
        b"P5 2 2 255 \x01\x80\xfe\xff",
    ];
    std::iter::once(own).chain(others.map(<[u8]>::to_vec)).collect()
}

pub fn png() -> Vec<Vec<u8>> {
    let own = written("a.png", |path| write(path, &picture(), &Metadata::default()));
    let (grey, deep): (Vec<u8>, Vec<u8>) = ((0..64).collect(), (0..128).collect());
    let encoded = [(&grey, ExtendedColorType::L8), (&grey, ExtendedColorType::Rgba8), (&deep, ExtendedColorType::L16)];
    let others = encoded.map(|(bytes, kind)| {
        let mut out = Vec::new();
        let pixels = bytes.len() as u32 * 8 / u32::from(kind.bits_per_pixel());
        image::ImageEncoder::write_image(image::codecs::png::PngEncoder::new(&mut out), bytes, pixels / 4, 4, kind)
            .expect("a PNG seed");
        out
    });
    std::iter::once(own).chain(others).collect()
}

pub fn jpeg() -> Vec<Vec<u8>> {
    let bytes: Vec<u8> = (0..16 * 9 * 3).map(|i| (i * 7 % 256) as u8).collect();
    [(ExtendedColorType::Rgb8, 16), (ExtendedColorType::L8, 48)]
        .map(|(kind, width)| {
            let mut out = Vec::new();
            image::codecs::jpeg::JpegEncoder::new(&mut out).encode(&bytes, width, 9, kind).expect("a JPEG seed");
            out
        })
        .to_vec()
}

/// Parts of a render, with and without path classes and light from elsewhere, one of them interrupted.
pub fn part() -> Vec<Vec<u8>> {
    [(None, 0..3), (Some(PathClasses::up_to(1)), 2..8)]
        .map(|(classes, samples)| {
            let film = Film::new(5, 4, classes).expect("a small film");
            let film = if classes.is_some() { film.with_splats().expect("a small film") } else { film };
            let mut part = Part::new(film, 8, "fingerprint", Metadata::default().with("seconds", 0.5));
            while let Some(task) = part.next(samples.clone()) {
                part.film.accumulate(|row| {
                    for x in 0..5 {
                        task.left(row.samples(x)).for_each(|s| row.add(x, Rgb::splat(s as f32 - 1.0), &[Rgb::ONE; 4]));
                        row.splat(Splat { pixel: [x as u32, 0], class: 1, value: Rgb::ONE });
                    }
                });
            }
            written("a.exr", |path| part.save(path))
        })
        .to_vec()
}

pub fn ply() -> Vec<Vec<u8>> {
    let text = include_str!("seeds/mesh.ply");
    vec![text.into(), binary_ply("little", |x| x.to_le_bytes()), binary_ply("big", |x| x.to_be_bytes())]
}

/// A square, as a fan of two triangles.
fn binary_ply(endian: &str, bytes: fn(u32) -> [u8; 4]) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat binary_{endian}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    for corner in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0_f32]] {
        file.extend(corner.into_iter().flat_map(|x| bytes(x.to_bits())));
    }
    file.push(4);
    file.extend((0..4).flat_map(bytes));
    file
}

pub fn obj() -> Vec<Vec<u8>> {
    vec![include_bytes!("seeds/mesh.obj").to_vec()]
}

pub fn pbrt() -> Vec<Vec<u8>> {
    let files: [&[u8]; 4] = [
        include_bytes!("seeds/v2.pbrt"),
        include_bytes!("seeds/v4.pbrt"),
        include_bytes!("seeds/more.pbrt"),
        include_bytes!("seeds/conductor.pbrt"),
    ];
    files.map(<[u8]>::to_vec).to_vec()
}

pub fn collada() -> Vec<Vec<u8>> {
    vec![include_bytes!("seeds/scene.dae").to_vec(), include_bytes!("seeds/unlit.dae").to_vec()]
}

pub fn settings() -> Vec<Vec<u8>> {
    vec![include_bytes!("seeds/camera.txt").to_vec()]
}

pub fn samples() -> Vec<Vec<u8>> {
    let others: [&[u8]; 4] = [
        b"\xef\xbb\xbfphi,theta\r\n0.1,0.2\r\n-3,1.5\r\n1e1,3.1\r\n0,0\r\n1,2\r\n2,1\r\n3,0.5\r\n0.5,0.7\r\n",
        b"x, y, z, pdf\n0.5, 0.25, 0.8291562, 1\n1.0, 0, 0, 0.5\n0x1.8p-1, 0.125, -0.6495191, 1.5\n0, -1, 0, 1\n",
        b"pdf,i\n0.2,0\n0.5,1\n0.3,2\n0.2,0\n",
        b"X\n0.5\n1\n\n0x1p-3\n6e-1\n",
    ];
    std::iter::once(&include_bytes!("seeds/samples.csv")[..]).chain(others).map(<[u8]>::to_vec).collect()
}

pub fn grid() -> Vec<Vec<u8>> {
    let others: [&[u8]; 3] =
        [b"0.2\n0.5\n0.3\n", b"1, 0, 2.5\n\n0.125, 1e-3, 0x1p-2\n", b"1e300, 0x1.fffffffffffffp1023\n0, 5e-324\n"];
    std::iter::once(&include_bytes!("seeds/grid.csv")[..]).chain(others).map(<[u8]>::to_vec).collect()
}

/// What programs say in a short test.
pub fn protocol() -> Vec<Vec<u8>> {
    let actors = [
        Actor {
            greeting: "\u{feff}etalon 1 domain=line dimension=1 invert=yes mass=0x1p0\r\n0.25 0.125\r",
            sample: &["0.5 0.875", "atom 0.25", "0.1", "0x1p-1 8.75e-1"],
            pdf: &["0.875", " 0x1.cp-1\r"],
            invert: &["none", "none", "none", "0.25"],
        },
        Actor {
            greeting: "etalon 1 domain=square invert=yes name=hex",
            sample: &["0x1p-1\t0x1p-3\r", "0x1p-1 0x1p-2 0x1p+0\r"],
            pdf: &["0x1p+0\r"],
            invert: &["none\r", "0x1p-1 0x1p-3\r"],
        },
        Actor {
            greeting: "etalon 1 domain=hemisphere dimension=0 mass=at-most-1\n0 0 1 0.5",
            sample: &["none", "0.6 0 0.8 0.07957747154594767", "atom 0 0 1"],
            pdf: &["0.07957747154594767"],
            invert: &[],
        },
        Actor {
            greeting: "etalon 1 domain=discrete:6 dimension=3",
            sample: &["2", "5 0.2", "0"],
            pdf: &["0.2", "0.1"],
            invert: &[],
        },
        Actor {
            greeting: "etalon 1 domain=sphere dimension=2 name=extreme",
            sample: &["0 -1 0", "-1 0 0 -inf", "0 0 -1 1e999", "1e-200 0 1"],
            pdf: &["1e308", "inf", "-1", "1e-320", "0"],
            invert: &[],
        },
    ];
    let records = actors.map(|actor| actor.record().expect("an actor answers"));
    // One change to the first line may make it too long.
    let wide = [&[b' '; 960][..], &records[1]].concat();
    records.into_iter().chain([wide]).collect()
}
