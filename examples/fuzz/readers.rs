//! Who is fuzzed: for each reader its seeds, and what a user would do with what it reads.

use super::{program, samplers, seeds};
use etalon::Result;
use etalon::envmap::EnvMap;
use etalon::envmap::info::Info;
use etalon::import::{SceneOptions, mesh, read_scene};
use etalon::raster::{ExrFile, ReadOptions, read};
use etalon::render::film::Part;
use etalon::render::{Settings, Silent, render};
use etalon::scene::{Request, Scene, builtin};
use std::path::Path;

/// A reader of files. To add one, add a row to [`READERS`].
pub struct Reader {
    pub name: &'static str,
    pub extension: &'static str,
    /// Small sound files.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Mends checksums after the damage: else most inputs would end there.
    pub seal: fn(&mut [u8]),
    /// Reads the file and uses what it holds.
    pub read: fn(&Path) -> Result<()>,
}

/// All readers.
pub const READERS: [Reader; 15] = [
    Reader { name: "exr", extension: "exr", seeds: seeds::exr, seal: as_it_is, read: exr },
    Reader { name: "hdr", extension: "hdr", seeds: seeds::hdr, seal: as_it_is, read: image },
    Reader { name: "pfm", extension: "pfm", seeds: seeds::pfm, seal: as_it_is, read: image },
    Reader { name: "pnm", extension: "ppm", seeds: seeds::pnm, seal: as_it_is, read: image },
    Reader { name: "png", extension: "png", seeds: seeds::png, seal: seal_png, read: image },
    Reader { name: "jpeg", extension: "jpg", seeds: seeds::jpeg, seal: as_it_is, read: image },
    Reader { name: "part", extension: "exr", seeds: seeds::part, seal: as_it_is, read: part },
    Reader { name: "ply", extension: "ply", seeds: seeds::ply, seal: as_it_is, read: statue },
    Reader { name: "obj", extension: "obj", seeds: seeds::obj, seal: as_it_is, read: statue },
    Reader { name: "pbrt", extension: "pbrt", seeds: seeds::pbrt, seal: as_it_is, read: scene },
    Reader { name: "collada", extension: "dae", seeds: seeds::collada, seal: as_it_is, read: scene },
    Reader { name: "settings", extension: "txt", seeds: seeds::settings, seal: as_it_is, read: settings },
    Reader { name: "samples", extension: "csv", seeds: seeds::samples, seal: as_it_is, read: samplers::samples },
    Reader { name: "grid", extension: "csv", seeds: seeds::grid, seal: as_it_is, read: samplers::grid },
    Reader { name: "protocol", extension: "txt", seeds: seeds::protocol, seal: as_it_is, read: program::read },
];

/// Files that inputs refer to, beside them.
pub const COMPANIONS: [(&str, &[u8]); 5] = [
    ("mesh.ply", include_bytes!("seeds/mesh.ply")),
    ("more.pbrt", include_bytes!("seeds/more.pbrt")),
    ("scene.dae", include_bytes!("seeds/scene.dae")),
    ("samples.csv", include_bytes!("seeds/samples.csv")),
    ("grid.csv", include_bytes!("seeds/grid.csv")),
];

fn as_it_is(_: &mut [u8]) {}

/// The checksum of every chunk (length, type, data, checksum) whose length is sound.
fn seal_png(bytes: &mut [u8]) {
    let mut rest = bytes.get_mut(8..).unwrap_or_default();
    while let Some((length, tail)) = rest.split_first_chunk_mut::<4>() {
        let Some((data, tail)) = tail.split_at_mut_checked(4 + u32::from_be_bytes(*length) as usize) else { return };
        let Some((sum, tail)) = tail.split_first_chunk_mut::<4>() else { return };
        let mut crc = flate2::Crc::new();
        crc.update(data);
        *sum = crc.sum().to_be_bytes();
        rest = tail;
    }
}

const SIZE: [usize; 2] = [4, 3];

fn image(path: &Path) -> Result<()> {
    let map = EnvMap::new(read(path, ReadOptions { allow_ldr: true })?);
    let _ = Info::of(&map);
    Ok(())
}

fn exr(path: &Path) -> Result<()> {
    ExrFile::open(path)?.layers()?;
    image(path)
}

fn part(path: &Path) -> Result<()> {
    let mut part = Part::read(path)?;
    let (_, _) = (part.film.standard_error(), part.film.path_layers());
    let _ = part.next(0..u32::MAX);
    part.set_spp(u32::MAX)
}

fn statue(path: &Path) -> Result<()> {
    let mut mesh = mesh::read(path, &mut Vec::new())?;
    if mesh.normals.is_empty() {
        mesh.smooth();
    }
    match builtin::by_name("cornell-statue-au", Some(mesh))? {
        Some((scene, request)) => {
            let (scene, request) = scene.resized(request, SIZE);
            picture(&scene, &request)
        }
        None => Ok(()),
    }
}

fn scene(path: &Path) -> Result<()> {
    let read = read_scene(path, SceneOptions { resolution: Some(SIZE), allow_ldr: true, ..SceneOptions::default() })?;
    picture(&read.scene, &read.request)
}

fn settings(path: &Path) -> Result<()> {
    let options = SceneOptions { resolution: Some(SIZE), camera: Some(path), ..SceneOptions::default() };
    let read = read_scene(&path.with_file_name("scene.dae"), options)?;
    picture(&read.scene, &read.request)
}

/// What was read must be fit to be rendered.
fn picture(scene: &Scene, request: &Request) -> Result<()> {
    let request = Request { spp: 1, light_samples: 1, max_depth: request.max_depth.min(4), ..*request };
    render(scene, &request, &Settings::default(), &Silent).map(drop)
}
