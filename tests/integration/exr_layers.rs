//! OpenEXR layers, text attributes and integer channels: what is written is read, by others' conventions too.

use etalon::Error;
use etalon::math::Rgb;
use etalon::raster::{
    Channel, ExrFile, Image, Layer, Metadata, Precision, ReadOptions, Samples, read, write_exr, write_exr_channels,
};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, IntegerBounds, LayerAttributes, LineOrder,
    SmallVec, Vec2, WritableImage,
};
use std::path::Path;

fn ramp(scale: f32) -> Image {
    Image::from_fn(37, 50, |x, y| Rgb::new(x as f32, y as f32, 0.1) * scale)
}

/// Numbers with all bits in use.
fn number(i: usize) -> u32 {
    (i as u32).wrapping_mul(0x9e37_79b9)
}

/// A file of the `exr` crate with the given channels.
fn foreign(path: &Path, encoding: Encoding, window: Option<IntegerBounds>, channels: Vec<AnyChannel<FlatSamples>>) {
    let layer = exr::prelude::Layer::new(
        (37, 50),
        LayerAttributes::named("main"),
        encoding,
        AnyChannels::sort(SmallVec::from_vec(channels)),
    );
    let mut file = exr::prelude::Image::from_layer(layer);
    if let Some(window) = window {
        file.attributes.display_window = window;
    }
    file.write().to_file(path).unwrap();
}

fn floats(name: &str, scale: f32) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, FlatSamples::F32(ramp(scale).pixels().iter().map(|p| p.x).collect()))
}

fn integers(name: &str) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, FlatSamples::U32((0..37 * 50).map(number).collect()))
}

/// The integers of one channel.
fn unsigned(file: &ExrFile, name: &str) -> etalon::Result<Vec<u32>> {
    let set = |values: &mut Vec<u32>, _, pixel: usize, value| values[pixel] = value;
    file.unsigned(&[name.into()], || Ok(vec![0; 37 * 50]), set)
}

#[test]
fn layers_and_attributes_are_read_back() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let images = [ramp(1.0), ramp(2.0), ramp(-3.0)];
    let named = [("z", &images[1]), ("", &images[0]), ("a.b", &images[2])].map(|(name, image)| Layer { name, image });
    let metadata = Metadata::default().with("spp", 64).with("command", "render \u{e9} \"x\"").with("empty", "");
    write_exr(&path, &named, Precision::Float, &metadata).unwrap();
    let file = ExrFile::open(&path).unwrap();
    assert_eq!(file.metadata(), &metadata);
    assert_eq!(file.size().unwrap(), (37, 50));
    let [z, main, ab] = named.map(|l| (l.name.to_owned(), l.image.clone()));
    assert_eq!(file.layers().unwrap(), [main, ab, z]);
}

#[test]
fn integers_and_light_stand_side_by_side() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let image = ramp(0.5);
    let mut channels: Vec<Channel<'_>> = Layer { name: "", image: &image }.channels(Precision::Half).into();
    channels.push(Channel { name: "sums.n".into(), samples: Samples::Unsigned(Box::new(number)) });
    write_exr_channels(&path, (37, 50), channels, &Metadata::default()).unwrap();
    let file = ExrFile::open(&path).unwrap();
    assert_eq!(unsigned(&file, "sums.n").unwrap(), (0..37 * 50).map(number).collect::<Vec<_>>());
    let layers = file.layers().unwrap();
    assert_eq!(layers.len(), 1, "integers are no light");
    assert_eq!(layers[0].1, read(&path, ReadOptions::default()).unwrap());
    for name in ["R", "n", "sums.m"] {
        assert!(matches!(unsigned(&file, name), Err(Error::Input { .. })), "{name}");
    }
}

#[test]
fn layers_of_other_programs_are_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 9))] {
        for compression in [Compression::Uncompressed, Compression::RLE, Compression::ZIP16, Compression::PIZ] {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            let channels = vec![floats("depth.Z", 7.0), floats("R", 1.0), integers("id"), integers("cells.id")];
            foreign(&path, encoding, None, channels);
            let file = ExrFile::open(&path).unwrap();
            let grey = |scale: f32| ramp(scale).map(|p| Rgb::splat(p.x));
            assert_eq!(file.layers().unwrap(), [(String::new(), grey(1.0)), ("depth".into(), grey(7.0))]);
            assert_eq!(unsigned(&file, "cells.id").unwrap()[1849], number(1849));
        }
    }
}

#[test]
fn unreadable_files_are_errors_with_a_reason() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let open = || ExrFile::open(&path);
    // Cropped: layers are shown in their frame, integers are refused.
    foreign(
        &path,
        Encoding::FAST_LOSSLESS,
        Some(IntegerBounds::new((1, 0), (40, 20))),
        vec![integers("n"), floats("R", 1.0)],
    );
    let file = open().unwrap();
    assert!(matches!(unsigned(&file, "n"), Err(Error::Unsupported { .. })));
    let shown = &file.layers().unwrap()[0].1;
    assert_eq!((shown.width(), shown.height(), shown.get(0, 3).x, shown.get(36, 0).x), (40, 20, 1.0, 0.0));

    let many = (0..4097).map(|i| Channel { name: format!("c{i}"), samples: Samples::Half(Box::new(|_| 0.0)) });
    write_exr_channels(&path, (1, 1), many.collect(), &Metadata::default()).unwrap();
    assert!(matches!(open(), Err(Error::Limit { .. })));
    assert!(matches!(read(&path, ReadOptions::default()), Err(Error::Limit { .. })));

    for content in [&b""[..], b"P6", b"\x76\x2f\x31\x01", b"\x76\x2f\x31\x01\x02\0\0\0\0"] {
        std::fs::write(&path, content).unwrap();
        assert!(matches!(open(), Err(Error::Input { .. })), "{content:?}");
    }
    assert!(matches!(ExrFile::open(dir.path()), Err(Error::Input { .. })));
    assert!(matches!(ExrFile::open(&dir.path().join("gone.exr")), Err(Error::Io { .. })));
    assert!(write_exr_channels(&path, (1, 1), Vec::new(), &Metadata::default()).is_err());
}
