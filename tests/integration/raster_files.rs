//! Image files: every writer against every reader, odd and damaged OpenEXR files, and real maps.

use etalon::math::Rgb;
use etalon::raster::{
    Image, Layer, Metadata, Precision, ReadOptions, WriteOptions, read, write, write_exr, write_with,
};
use etalon::{Error, Result};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, IntegerBounds, LayerAttributes, Levels,
    LineOrder, SmallVec, Vec2, WritableImage,
};
use std::path::{Path, PathBuf};

fn load(path: &Path) -> Result<Image> {
    read(path, ReadOptions::default())
}

/// The bits of all samples, so that NaN compares equal to itself.
fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels().iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

fn test_image(width: usize, height: usize) -> Image {
    Image::from_fn(width, height, |x, y| {
        let v = ((x * 7 + y * 13) % 101) as f32 / 9.0;
        Rgb::new(v, -0.5 * v + 1e-3, (v * 1.5).exp2() / 100.0)
    })
}

/// The folder of real files, where it exists.
fn assets() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    if !folder.is_dir() {
        println!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

// Writers against readers.

#[test]
fn exact_formats_go_there_and_back() {
    let dir = tempfile::tempdir().unwrap();
    let mut image = test_image(70, 37);
    image.set(3, 4, Rgb::new(f32::NAN, f32::NEG_INFINITY, -0.0));
    for name in ["a.exr", "b.pfm", "C.EXR"] {
        let path = dir.path().join(name);
        write(&path, &image, &Metadata::default()).unwrap();
        assert_eq!(bits(&load(&path).unwrap()), bits(&image), "{name}");
    }
    let path = dir.path().join("half.exr");
    let options = WriteOptions { precision: Precision::Half, ..WriteOptions::default() };
    write_with(&path, &image, &Metadata::default(), options).unwrap();
    let halves = image.map(|p| Rgb::from_array(p.to_array().map(|v| half::f16::from_f32(v).to_f32())));
    assert_eq!(bits(&load(&path).unwrap()), bits(&halves));
}

#[test]
fn halves_are_clamped_to_their_range() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let image = Image::from_pixels(2, 1, vec![Rgb::new(1e6, -1e6, 65519.0), Rgb::splat(f32::INFINITY)]);
    write_exr(&path, &[Layer { name: "", image: &image }], Precision::Half, &Metadata::default()).unwrap();
    let back = load(&path).unwrap();
    assert_eq!(back.pixels(), [Rgb::new(65504.0, -65504.0, 65504.0), Rgb::splat(f32::INFINITY)]);
}

#[test]
fn display_formats_need_the_flag_to_be_read() {
    let dir = tempfile::tempdir().unwrap();
    let image = Image::from_fn(32, 8, |x, y| Rgb::new(x as f32 / 31.0, y as f32 / 7.0, 0.5));
    for name in ["a.png", "a.ppm"] {
        let path = dir.path().join(name);
        write(&path, &image, &Metadata::default()).unwrap();
        assert!(matches!(load(&path), Err(Error::Unsupported { .. })));
        let back = read(&path, ReadOptions { allow_ldr: true, ..ReadOptions::default() }).unwrap();
        for (a, b) in image.pixels().iter().zip(back.pixels()) {
            assert!((*a - *b).abs().max_element() < 0.005, "{a} {b}");
        }
    }
}

#[test]
fn radiance_images_keep_seven_bits() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.hdr");
    let image = test_image(64, 9).map(Rgb::abs);
    write(&path, &image, &Metadata::default().with("seed", 7)).unwrap();
    for (a, b) in image.pixels().iter().zip(load(&path).unwrap().pixels()) {
        assert!((*a - *b).abs().max_element() <= a.max_element() / 256.0, "{a} {b}");
    }
}

#[test]
fn the_content_decides_not_the_name() {
    let dir = tempfile::tempdir().unwrap();
    let (exr, wrong) = (dir.path().join("a.exr"), dir.path().join("a.hdr"));
    write(&exr, &test_image(5, 4), &Metadata::default()).unwrap();
    std::fs::rename(&exr, &wrong).unwrap();
    assert_eq!(load(&wrong).unwrap(), test_image(5, 4));
}

#[test]
fn layers_and_metadata_are_what_another_reader_finds() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let (main, sums) = (test_image(40, 20), test_image(40, 20).map(|p| p * p));
    let layers = [Layer { name: "squares", image: &sums }, Layer { name: "", image: &main }];
    let metadata = Metadata::default().with("spp", 64).with("command", "etalon render \u{e9}").with("seed", "1");
    write_exr(&path, &layers, Precision::Float, &metadata).unwrap();
    assert_eq!(load(&path).unwrap(), main);

    use exr::prelude::{ReadChannels, ReadLayers};
    let file = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .pedantic()
        .from_file(&path)
        .unwrap();
    let channels = &file.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(names, ["B", "G", "R", "squares.B", "squares.G", "squares.R"]);
    let greens: Vec<f32> = channels[4].sample_data.values_as_f32().collect();
    assert_eq!(greens, sums.pixels().iter().map(|p| p.y).collect::<Vec<_>>());

    let bytes = std::fs::read(&path).unwrap();
    let find = |text: &str| bytes.windows(text.len()).position(|w| w == text.as_bytes()).expect(text);
    assert!(find("software\0string") < find("spp\0string") && find("spp\0string") < find("command\0string"));
    assert!(find("render \u{e9}") < find("seed\0string"));
}

#[test]
fn impossible_layers_and_names_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let (small, large) = (Image::new(1, 1), Image::new(2, 1));
    let layer = |name, image| Layer { name, image };
    for layers in [
        &[][..],
        &[layer("", &small), layer("b", &large)],
        &[layer("b", &small), layer("b", &small)],
        &[layer("two words", &small)],
    ] {
        let result = write_exr(&path, layers, Precision::Float, &Metadata::default());
        assert!(matches!(result, Err(Error::Parameter { .. })));
    }
    for name in ["", "channels", "a name", "an_attribute_name_of_32_letters_"] {
        let result = write(&path, &small, &Metadata::default().with(name, 1));
        assert!(matches!(result, Err(Error::Parameter { .. })), "{name}");
    }
    assert!(!path.exists());
}

// OpenEXR files as others write them, made with the `exr` crate.

/// A file of R, G, B (and half A) with the given encoding and windows.
fn foreign_exr(path: &Path, image: &Image, encoding: Encoding, position: (i32, i32), display: IntegerBounds) {
    let samples = |i: usize| FlatSamples::F32(image.pixels().iter().map(|p| p[i]).collect());
    let alpha = FlatSamples::F16(vec![half::f16::ONE; image.pixels().len()]);
    let channels = AnyChannels::sort(SmallVec::from_vec(vec![
        AnyChannel::new("R", samples(0)),
        AnyChannel::new("G", samples(1)),
        AnyChannel::new("B", samples(2)),
        AnyChannel::new("A", alpha),
    ]));
    let size = Vec2(image.width(), image.height());
    let attributes = LayerAttributes::named("main").with_position(Vec2(position.0, position.1));
    let layer = exr::prelude::Layer::new(size, attributes, encoding, channels);
    let mut file = exr::prelude::Image::from_layer(layer);
    file.attributes.display_window = display;
    file.write().to_file(path).unwrap();
}

fn window(x: i32, y: i32, width: usize, height: usize) -> IntegerBounds {
    IntegerBounds::new((x, y), (width, height))
}

#[test]
fn every_compression_and_tiling_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    // Smooth, so that the lossy methods are close.
    let image = Image::from_fn(75, 70, |x, y| {
        Rgb::new(1.0 + x as f32 / 75.0, 1.0 + y as f32 / 70.0, 2.0 - (x * y) as f32 / 5250.0)
    });
    use Compression::{B44, B44A, DWAA, DWAB, PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    for (compression, error) in [
        (Uncompressed, 0.0),
        (RLE, 0.0),
        (ZIP1, 0.0),
        (ZIP16, 0.0),
        (PIZ, 0.0),
        (PXR24, 1e-4),
        (B44, 0.0),
        (B44A, 0.0),
        (DWAA(None), 0.02),
        (DWAB(None), 0.02),
    ] {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 32)), Blocks::Tiles(Vec2(100, 100))] {
            for line_order in [LineOrder::Increasing, LineOrder::Decreasing] {
                foreign_exr(&path, &image, Encoding { compression, blocks, line_order }, (0, 0), window(0, 0, 75, 70));
                let back = load(&path).unwrap();
                let worst = image.pixels().iter().zip(back.pixels()).map(|(a, b)| (*a - *b).abs().max_element());
                let worst = worst.fold(0.0, f32::max);
                assert!(worst <= error, "{compression}, {blocks:?}, {line_order:?}: {worst}");
            }
        }
    }
}

#[test]
fn of_a_mip_map_the_full_resolution_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let level = |size: usize| FlatSamples::F32(vec![size as f32; size * size]);
    let levels = || Levels::Mip {
        rounding_mode: exr::math::RoundingMode::Down,
        level_data: vec![level(8), level(4), level(2), level(1)],
    };
    let channels = ["B", "G", "R"].map(|name| AnyChannel {
        name: name.into(),
        sample_data: levels(),
        quantize_linearly: false,
        sampling: Vec2(1, 1),
    });
    let encoding = Encoding { blocks: Blocks::Tiles(Vec2(3, 3)), ..Encoding::SMALL_LOSSLESS };
    let channels = AnyChannels::sort(SmallVec::from_vec(channels.to_vec()));
    let layer = exr::prelude::Layer::new((8, 8), LayerAttributes::named("m"), encoding, channels);
    exr::prelude::Image::from_layer(layer).write().to_file(&path).unwrap();
    assert_eq!(load(&path).unwrap(), Image::new(8, 8).map(|_| Rgb::splat(8.0)));
}

#[test]
fn the_display_window_is_the_image() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let image = test_image(20, 40);
    let scan_lines = Encoding::SMALL_LOSSLESS;
    let tiles = Encoding { blocks: Blocks::Tiles(Vec2(8, 8)), ..Encoding::FAST_LOSSLESS };
    for encoding in [scan_lines, tiles] {
        // Data in the middle of a larger frame: black around it.
        foreign_exr(&path, &image, encoding, (-5, 3), window(-10, 0, 30, 50));
        let framed = load(&path).unwrap();
        let expected = Image::from_fn(30, 50, |x, y| {
            let inside = (5..25).contains(&x) && (3..43).contains(&y);
            if inside { image.get(x - 5, y - 3) } else { Rgb::ZERO }
        });
        assert_eq!(framed, expected);
        // Data around a smaller frame: cut off.
        foreign_exr(&path, &image, encoding, (0, -7), window(4, 10, 11, 12));
        assert_eq!(load(&path).unwrap(), Image::from_fn(11, 12, |x, y| image.get(x + 4, y + 17)));
        // Nothing in common: no image at all.
        foreign_exr(&path, &image, encoding, (0, 0), window(20, 0, 5, 5));
        assert!(load(&path).unwrap_err().to_string().contains("outside the display window"));
    }
}

#[test]
fn unsigned_channels_and_single_channels_are_grey() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let channel = AnyChannel::new("depth.id", FlatSamples::U32(vec![0, 1, 70_000, 16_777_216]));
    let channels = AnyChannels::sort(SmallVec::from_vec(vec![channel]));
    let layer = exr::prelude::Layer::new((2, 2), LayerAttributes::named("m"), Encoding::FAST_LOSSLESS, channels);
    exr::prelude::Image::from_layer(layer).write().to_file(&path).unwrap();
    let values = [0.0, 1.0, 70_000.0, 16_777_216.0].map(Rgb::splat);
    assert_eq!(load(&path).unwrap().pixels(), values);
}

// Damage.

#[test]
fn a_file_cut_off_anywhere_is_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a");
    for name in ["a.exr", "a.hdr", "a.pfm"] {
        let whole = dir.path().join(name);
        write(&whole, &test_image(24, 33), &Metadata::default()).unwrap();
        let bytes = std::fs::read(&whole).unwrap();
        for length in (0..bytes.len()).step_by(7).chain([bytes.len() - 1]) {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let error = load(&path).expect_err(&format!("{length} of {} bytes of {name}", bytes.len()));
            assert!(matches!(error, Error::Input { .. }), "{error}");
        }
    }
}

#[test]
fn a_header_that_promises_more_than_the_file_holds_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    write(&path, &test_image(8, 8), &Metadata::default()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let find = |text: &[u8]| bytes.windows(text.len()).position(|w| w == text).unwrap() + text.len();
    let data = find(b"dataWindow\0box2i\0\x10\0\0\0");
    let display = find(b"displayWindow\0box2i\0\x10\0\0\0");
    for (width, height) in [(30_000, 8), (16_000, 16_000), (1 << 29, 1 << 29), (65_536, 1), (0, 0)] {
        let mut changed = bytes.clone();
        for at in [data, display] {
            changed[at + 8..at + 12].copy_from_slice(&(width - 1_i32).to_le_bytes());
            changed[at + 12..at + 16].copy_from_slice(&(height - 1_i32).to_le_bytes());
        }
        std::fs::write(&path, &changed).unwrap();
        let result = load(&path);
        assert!(matches!(result, Err(Error::Input { .. } | Error::Limit { .. })), "{width}x{height}: {result:?}");
    }
    let mut changed = bytes.clone();
    changed[display + 8..display + 16].copy_from_slice(&[15_999_i32, 15_999].map(i32::to_le_bytes).concat());
    std::fs::write(&path, &changed).unwrap();
    assert!(load(&path).unwrap_err().to_string().contains("display window"));
}

#[test]
fn a_false_table_of_blocks_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    write(&path, &test_image(20, 40), &Metadata::default()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let mut cursor = std::io::Cursor::new(&bytes);
    exr::meta::MetaData::read_from_buffered(&mut cursor, false).unwrap();
    let table = cursor.position() as usize;
    let first = u64::from_le_bytes(bytes[table..table + 8].try_into().unwrap());
    for (entry, expected) in [
        (0, "never written"),
        (first, "not where the table says"),
        (u64::MAX, "beyond the end"),
        (bytes.len() as u64 - 2, "beyond the end"),
    ] {
        let mut changed = bytes.clone();
        changed[table + 8..table + 16].copy_from_slice(&entry.to_le_bytes());
        std::fs::write(&path, &changed).unwrap();
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains("block 2 of 3") && error.contains(expected), "{error}");
    }
}

#[test]
fn a_compression_of_the_future_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    write(&path, &Image::new(20, 20), &Metadata::default()).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let name = b"compression\0compression\0\x01\0\0\0";
    let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len();
    for (method, expected) in [(13, "compression number 13"), (10, "HTJ2K256")] {
        bytes[at] = method;
        std::fs::write(&path, &bytes).unwrap();
        let error = load(&path).unwrap_err();
        assert!(matches!(error, Error::Unsupported { .. }) && error.to_string().contains(expected), "{error}");
        assert!(error.hint().unwrap().contains("-z zip"));
    }
}

/// The counters at the start of a DWA block say how much memory its streams take: they must not be trusted.
#[test]
fn false_sizes_in_a_dwa_block_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let encoding =
        Encoding { compression: Compression::DWAB(None), blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    foreign_exr(&path, &test_image(40, 40), encoding, (0, 0), window(0, 0, 40, 40));
    let bytes = std::fs::read(&path).unwrap();
    let mut cursor = std::io::Cursor::new(&bytes);
    exr::meta::MetaData::read_from_buffered(&mut cursor, false).unwrap();
    // After the table with its one entry come the row, the length, and the counters, of which the first is a version.
    let counters = cursor.position() as usize + 8 + 8;
    for counter in 1..=9 {
        for value in [u64::MAX, i64::MAX as u64, 1 << 45, 1 << 31] {
            let mut changed = bytes.clone();
            changed[counters + 8 * counter..][..8].copy_from_slice(&value.to_le_bytes());
            std::fs::write(&path, &changed).unwrap();
            let error = load(&path).expect_err(&format!("counter {counter} = {value}"));
            assert!(error.to_string().contains("contradicts the header"), "{error}");
        }
    }
}

// Real files.

#[test]
fn odd_but_sound_files_are_read_right() {
    let Some(assets) = assets() else { return };
    let grey = load(&assets.join("hostile/exr/GrayRampsDiagonal.exr")).unwrap();
    assert!(grey.pixels().iter().all(|p| p.x == p.y && p.y == p.z));
    let rings = load(&assets.join("hostile/exr/BrightRingsNanInf.exr")).unwrap();
    assert!(rings.pixels().iter().any(|p| p.is_nan()) && rings.pixels().iter().any(|p| p.x == f32::INFINITY));
    let little = load(&assets.join("hostile/other/hopper.pfm")).unwrap();
    let big = load(&assets.join("hostile/other/hopper_be.pfm")).unwrap();
    assert_eq!(big, little.map(|p| p * 2.5), "the scale of the second file is 2.5");
    let pointer = load(&assets.join("hostile/other/lfs-pointer.exr")).unwrap_err();
    assert!(pointer.hint().unwrap().contains("git lfs pull"));
}
