//! One target per kind of file: reads it and uses the result as the program does.

use etalon::envmap::EnvMap;
use etalon::envmap::info::Info;
use etalon::import::{self, SceneOptions, read_scene};
use etalon::optics::metals::GOLD;
use etalon::protocol::program::sampler::Client;
use etalon::protocol::program::{Answer, Connection, External, connect};
use etalon::protocol::sampler::Space;
use etalon::protocol::sampler::files::{GridDensity, SampleFile};
use etalon::raster::{ExrFile, ReadOptions};
use etalon::render::film::Part;
use etalon::render::{Settings, Silent, render};
use etalon::scene::{Request, Scene, builtin};
use etalon::{Error, Result};
use etalon_stats::bsdf::{Family, Pair};
use etalon_stats::{DOMAINS, Density, Protocol, SampleCount, Sampler, examine};
use std::path::Path;
use std::sync::Arc;

const SIZE: [usize; 2] = [4, 3];

/// Any image file, as an environment map.
pub fn image(path: &Path) -> Result<()> {
    let map = EnvMap::new(etalon::raster::read(path, ReadOptions { allow_ldr: true, ..ReadOptions::default() })?);
    let _ = Info::of(&map);
    Ok(())
}

/// A PNG file whose checksums are corrected first (chunks are length, type, data, checksum), so that the decoder goes on.
pub fn png(path: &Path) -> Result<()> {
    let mut bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let mut rest = bytes.get_mut(8..).unwrap_or_default();
    while let Some((length, tail)) = rest.split_first_chunk_mut::<4>() {
        let Some((data, tail)) = tail.split_at_mut_checked(4 + u32::from_be_bytes(*length) as usize) else { break };
        let Some((sum, tail)) = tail.split_first_chunk_mut::<4>() else { break };
        let mut crc = flate2::Crc::new();
        crc.update(data);
        *sum = crc.sum().to_be_bytes();
        rest = tail;
    }
    std::fs::remove_file(path).and_then(|()| std::fs::write(path, bytes)).map_err(|e| Error::io(path, e))?;
    image(path)
}

/// An OpenEXR file: all layers, then the image.
pub fn exr(path: &Path) -> Result<()> {
    ExrFile::open(path)?.layers()?;
    image(path)
}

/// A part of a render: all layers, then the part.
pub fn part(path: &Path) -> Result<()> {
    let _ = ExrFile::open(path).and_then(|file| file.layers());
    let mut part = Part::read(path)?;
    let (_, _) = (part.film.standard_error(), part.film.path_layers());
    let _ = part.next(0..u32::MAX);
    part.set_spp(u32::MAX)
}

/// A PLY or OBJ mesh, rendered as the statue.
pub fn mesh(path: &Path) -> Result<()> {
    let mut mesh = import::mesh::read(path, &mut Vec::new())?;
    assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == mesh.positions.len());
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    let _ = (0..mesh.triangles.len() as u32).filter_map(|i| mesh.tangent(i)).count();
    if mesh.normals.is_empty() {
        mesh.smooth();
    }
    let (scene, request) = builtin::cornell_statue(GOLD, 0.25, Some(mesh))?;
    let (scene, request) = scene.resized(request, SIZE);
    render_small(&scene, &request)
}

/// A scene file, rendered.
pub fn scene(path: &Path) -> Result<()> {
    let read = read_scene(path, &SceneOptions { resolution: Some(SIZE), allow_ldr: true, ..SceneOptions::default() })?;
    render_small(&read.scene, &read.request)
}

/// Camera settings beside a COLLADA scene.
pub fn settings(path: &Path) -> Result<()> {
    let options = SceneOptions { resolution: Some(SIZE), camera: Some(path), ..SceneOptions::default() };
    let read = read_scene(&path.with_file_name("scene.dae"), &options)?;
    render_small(&read.scene, &read.request)
}

/// Renders a scene with one sample per pixel: a scene that was read must be fit to be rendered.
fn render_small(scene: &Scene, request: &Request) -> Result<()> {
    let request = Request { spp: 1, light_samples: 1, max_depth: request.max_depth.min(4), ..*request };
    render(scene, &request, &Settings::default(), &Silent).map(drop)
}

/// A CSV file of samples, against a fixed grid.
pub fn samples(path: &Path) -> Result<()> {
    files(path, &path.with_file_name("grid.csv"))
}

/// A grid of pdf values, against fixed samples.
pub fn grid(path: &Path) -> Result<()> {
    files(&path.with_file_name("samples.csv"), path)
}

/// Tests samples against a grid over every domain; good if one of the tests can be done.
fn files(samples: &Path, grid: &Path) -> Result<()> {
    // Too brief for a verdict, but it uses everything that was read.
    let brief = Protocol { samples: SampleCount::Fixed(1), cells: 2, ..Protocol::default() };
    let test = |space: Space| {
        let density = Arc::new(GridDensity::read_csv(space.clone(), grid)?);
        let sampler = SampleFile::open(samples, Arc::clone(&density))?;
        examine(space.domain(), &sampler, &*density, &brief, 0)?;
        Ok(())
    };
    let names = DOMAINS.iter().map(|entry| entry.example).chain(["discrete:3"]);
    let spaces = names.filter_map(|name| name.parse().ok());
    spaces.map(test).reduce(Result::or).unwrap_or(Ok(()))
}

/// Recorded responses of a program to requests for samples, their pdf and their inverse, or for what a BSDF has, in blocks as
/// from a pipe.
pub fn protocol(path: &Path) -> Result<()> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let blocks: Vec<Vec<u8>> = bytes.split(|&byte| byte == b'\x0c').map(<[u8]>::to_vec).collect();
    match connect(Record(blocks.into_iter()), None)? {
        External::Sampler(client) => ask_sampler(&client),
        External::Bsdf(program) => Ok(ask_bsdf(&program)?),
    }
}

fn ask_bsdf(family: &dyn Family) -> etalon_stats::Result<()> {
    let defaults: Vec<f64> = family.parameters().iter().map(|parameter| parameter.value).collect();
    let bsdf = family.with(&defaults)?;
    let properties = bsdf.properties();
    let wos = [[0.6, 0.0, 0.8]; 4];
    bsdf.delta_lobes(&wos)?;
    let samples = bsdf.sample(&wos, &vec![0.5; wos.len() * properties.dimension])?;
    let pairs: Vec<Pair> = samples.iter().flatten().map(|sample| [wos[0], sample.wi]).collect();
    bsdf.pdf(&pairs)?;
    bsdf.eval(&pairs, &vec![0.5; pairs.len() * properties.eval_dimension])?;
    Ok(())
}

struct Record(std::vec::IntoIter<Vec<u8>>);

impl Connection for Record {
    fn name(&self) -> &str {
        "record"
    }

    fn ask(&mut self, _: String, most: usize) -> Result<String> {
        let violation = |what| Error::input(Path::new("record"), what);
        let mut answer = Answer::new(most);
        for block in self.0.by_ref() {
            if let Some(text) = answer.add(&block).map_err(violation)? {
                return Ok(text);
            }
        }
        Err(violation(format!("it ended after {} lines of an answer", answer.lines())))
    }
}

fn ask_sampler(program: &Client) -> Result<()> {
    let (mut samples, mut pdfs) = (Vec::new(), Vec::new());
    match program.dimension() {
        0 => program.sample_seeded(4, 1, &mut samples)?,
        dimension => program.sample(&vec![0.5; 4 * dimension], &mut samples)?,
    }
    let points: Vec<_> = samples.iter().flatten().map(|sample| sample.point).collect();
    program.pdf(&points, &mut pdfs)?;
    let space = program.space();
    space.domain().charts(&points)?;
    space.domain().per_chart_area(&[[0.5; 2]], &mut [1.0])?;
    for point in points {
        program.invert(point)?;
    }
    Ok(())
}
