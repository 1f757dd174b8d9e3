//! Camera, film, filter (`PixelFilter`, with the names and defaults of each version), sampler and integrator, and the request
//! that they amount to.

use super::super::place::{ANGLE, ANY, At, POSITIVE, Rule, quote};
use super::super::transform::{self, in_range, in_size_range};
use super::params::Params;
use crate::error::Result;
use crate::sampling::filter::RANGE;
use crate::scene::{Camera, FilterShape, PixelFilter, Projection, Request};
use glam::DMat4;
use std::path::PathBuf;

/// Largest side of an image, and most pixels in it.
const MAX_SIDE: u32 = 1 << 16;
const MAX_PIXELS: usize = 1 << 28;
/// Most samples of any kind, and the deepest path.
pub const MAX_SAMPLES: u32 = 1 << 24;
const MAX_DEPTH: u32 = 1 << 16;

/// The options of a file, as far as it has set them. The last of two directives counts, as in pbrt.
#[derive(Default)]
pub struct Setup {
    camera: Option<View>,
    film: Option<Film>,
    filter: Option<Filter>,
    /// Samples per pixel, and whether such numbers are rounded up to powers of two.
    sampler: Option<(u32, bool)>,
    /// Depth, and whether each hit takes as many light samples as the light asks for, or one.
    integrator: Option<(u32, bool)>,
    /// Whether pbrt-v2 wrote the file: only it has a `SurfaceIntegrator`.
    pub v2: bool,
}

struct View {
    at: At,
    to_world: DMat4,
    /// The tangent of half the field of view; none: orthographic.
    tan: Option<f64>,
    aspect: Option<f64>,
    /// x from, x to, y from, y to on the screen.
    window: Option<[f64; 4]>,
}

struct Film {
    at: At,
    /// Whether pbrt-v4 wrote this.
    v4: bool,
    width: u32,
    height: u32,
    filename: Option<PathBuf>,
}

impl Setup {
    /// `Camera`, where the current transform takes the world to the camera.
    pub fn camera(&mut self, p: &Params, to_world: DMat4, warnings: &mut Vec<String>) -> Result<()> {
        const HALF: Rule = Rule(|x| x > 0.0 && x < 90.0, "between 0 and 90 degrees");
        let tan = match p.kind.as_str() {
            "orthographic" => None,
            "perspective" => {
                let fov = p.float("fov", &ANGLE)?.unwrap_or(90.0);
                Some(p.float("halffov", &HALF)?.unwrap_or(fov / 2.0).to_radians().tan())
            }
            _ => return Err(p.unsupported_kind("orthographic, perspective")),
        };
        p.only_float("lensradius", |x| x == 0.0, "0 (a pinhole)")?;
        let aspect = p.float("frameaspectratio", &POSITIVE)?;
        let window = p.numbers("screenwindow", &["float"], &ANY)?;
        if window.is_some_and(|[x0, x1, y0, y1]| x0 >= x1 || y0 >= y1) {
            let message = "screenwindow must be [left right bottom top] with left < right and bottom < top";
            return Err(p.place("screenwindow").input(message));
        }
        self.camera = Some(View { at: p.at.clone(), to_world, tan, aspect, window });
        p.finish(&["focaldistance", "shutteropen", "shutterclose"], warnings)
    }

    /// Whether pbrt-v4 wrote the file, as far as its film says.
    pub fn is_v4(&self) -> bool {
        self.film.as_ref().is_some_and(|film| film.v4)
    }

    pub fn film(&mut self, p: &Params, warnings: &mut Vec<String>) -> Result<()> {
        let (v4, width, height) = match p.kind.as_str() {
            "image" => (false, 640, 480),
            "rgb" => (true, 1280, 720),
            _ => return Err(p.unsupported_kind("image, rgb")),
        };
        let width = p.integer("xresolution", 1..=MAX_SIDE)?.unwrap_or(width);
        let height = p.integer("yresolution", 1..=MAX_SIDE)?.unwrap_or(height);
        if width as usize * height as usize > MAX_PIXELS {
            return Err(p.at.input(format!("{width} x {height} pixels are more than {MAX_PIXELS}")));
        }
        p.only_float("scale", |x| x == 1.0, "1")?;
        // pbrt-v4 multiplies the image by iso/100 times the exposure time.
        let exposure = p.float("exposuretime", &POSITIVE)?.unwrap_or(1.0);
        let iso = p.float("iso", &POSITIVE)?.unwrap_or(100.0);
        if (iso * exposure / 100.0 - 1.0).abs() > 1e-6 {
            let message = format!("{}: iso {iso} with exposuretime {exposure} scales the image", p.owner);
            return Err(p.place(if iso == 100.0 { "exposuretime" } else { "iso" }).unsupported(message));
        }
        if let Some(sensor) = p.text("sensor")?.filter(|&sensor| sensor != "cie1931") {
            let message = format!("{}: the sensor {} is not supported, only \"cie1931\"", p.owner, quote(sensor));
            return Err(p.place("sensor").unsupported(message));
        }
        p.only_float("whitebalance", |x| x == 0.0, "0 (none)")?;
        let crop = p.numbers("cropwindow", &["float"], &ANY)?;
        if crop.is_some_and(|crop| crop != [0.0, 1.0, 0.0, 1.0]) {
            return Err(p.place("cropwindow").unsupported("a crop window is not supported"));
        }
        let filename = p.text("filename")?.map(PathBuf::from);
        self.film = Some(Film { at: p.at.clone(), v4, width, height, filename });
        p.finish(&["diagonal", "display", "savefp16"], warnings)
    }

    pub fn filter(&mut self, p: &Params, warnings: &mut Vec<String>) -> Result<()> {
        self.filter = Some(Filter::read(p, warnings)?);
        Ok(())
    }

    /// `Sampler`. The samples are those of this program; the count is the file's, rounded as its sampler would.
    pub fn sampler(&mut self, p: &Params, warnings: &mut Vec<String>) -> Result<()> {
        let per_side = 1..=1 << 12;
        let powers_of_two = matches!(p.kind.as_str(), "lowdiscrepancy" | "02sequence" | "maxmindist");
        let samples = match p.kind.as_str() {
            "stratified" => {
                let x = p.integer("xsamples", per_side.clone())?;
                x.zip(p.integer("ysamples", per_side)?).map(|(x, y)| x * y)
            }
            "lowdiscrepancy" | "02sequence" | "maxmindist" | "random" | "independent" | "halton" | "sobol"
            | "zsobol" | "paddedsobol" | "pmj02bn" | "bestcandidate" => p.integer("pixelsamples", 1..=MAX_SAMPLES)?,
            _ => {
                return Err(p.unsupported_kind(
                    "lowdiscrepancy, 02sequence, maxmindist, random, independent, halton, sobol, zsobol, paddedsobol, \
                     pmj02bn, bestcandidate, stratified",
                ));
            }
        };
        if samples.is_none() {
            warnings.push(p.at.warning(&format!("{} sets no number of samples: {DEFAULT_SAMPLES} per pixel", p.owner)));
        }
        p.only_false("samplepixelcenter")?;
        self.sampler = Some((samples.unwrap_or(DEFAULT_SAMPLES), powers_of_two));
        p.finish(&["seed", "randomization", "jitter", "dimensions"], warnings)
    }

    /// `SurfaceIntegrator` (pbrt-v2) or `Integrator`.
    ///
    /// Their depths differ: path tracing to `maxdepth` N ends with the N-th surface's direct light in pbrt-v3 and v4, and
    /// with that of the surface after it in v2. Direct lighting follows only mirrors and glass beyond the first surface.
    pub fn integrator(&mut self, p: &Params, v2: bool, warnings: &mut Vec<String>) -> Result<()> {
        self.v2 = v2;
        let depth = p.integer("maxdepth", 0..=MAX_DEPTH)?.unwrap_or(DEFAULT_DEPTH);
        self.integrator = Some(match p.kind.as_str() {
            "directlighting" => {
                let all_lights = match p.text("strategy")? {
                    None | Some("all") => true,
                    Some("one") => false,
                    _ => return Err(p.place("strategy").unsupported("strategy must be \"all\" or \"one\"")),
                };
                (1, all_lights)
            }
            "path" | "volpath" => (depth + u32::from(v2), false),
            // They estimate what path tracing does, except for Whitted's, which leaves out light between diffuse surfaces.
            kind if OTHER_INTEGRATORS.contains(&kind) => {
                warnings.push(p.at.warning(&format!("{}: read as \"path\"", p.owner)));
                (depth + u32::from(v2), false)
            }
            _ => {
                let others = OTHER_INTEGRATORS.join(", ");
                return Err(p.unsupported_kind(&format!("directlighting, path, volpath; as path: {others}")));
            }
        });
        for name in ["regularize", "visualizestrategies", "visualizeweights"] {
            p.only_false(name)?;
        }
        p.finish(&METHOD_SETTINGS, warnings)
    }

    /// The camera and the request; `light_samples` is what the light asks for. `file` stands for the whole file.
    pub fn finish(
        self,
        light_samples: u32,
        file: &At,
        warnings: &mut Vec<String>,
    ) -> Result<(Camera, Request, Option<PathBuf>)> {
        let view = self
            .camera
            .ok_or_else(|| file.input("the file sets no camera").with_hint("put a Camera before WorldBegin"))?;
        let v4 = self.film.as_ref().filter(|film| film.v4);
        let filter = match (self.filter, v4) {
            (Some(filter), _) => filter.finish(v4.is_some())?,
            (None, None) => PixelFilter::default(),
            (None, Some(film)) => {
                let filter = PixelFilter::new(FilterShape::Gaussian { sigma: 0.5 }, [1.5; 2])?;
                warnings.push(film.at.warning(&format!("no PixelFilter: {filter}, as in pbrt-v4")));
                filter
            }
        };
        let mut missing = |what: &str, instead: &str| warnings.push(file.warning(&format!("no {what}: {instead}")));
        let film = self.film.unwrap_or_else(|| {
            missing("Film", "640 x 480 pixels, as in pbrt-v2 and v3");
            Film { at: file.clone(), v4: false, width: 640, height: 480, filename: None }
        });
        let (samples, powers_of_two) = self.sampler.unwrap_or_else(|| {
            missing("Sampler", &format!("{DEFAULT_SAMPLES} samples per pixel"));
            (DEFAULT_SAMPLES, false)
        });
        let (max_depth, all_lights) = self.integrator.unwrap_or_else(|| {
            missing("Integrator", &format!("path tracing to depth {DEFAULT_DEPTH}, as in pbrt-v3 and v4"));
            (DEFAULT_DEPTH, false)
        });
        let round = |n: u32| if powers_of_two { n.next_power_of_two() } else { n };
        let request = Request {
            width: film.width as usize,
            height: film.height as usize,
            spp: round(samples),
            light_samples: if all_lights { round(light_samples) } else { 1 },
            max_depth,
        };
        let aspect = f64::from(film.width) / f64::from(film.height);
        Ok((Camera { filter, ..view.camera(aspect)? }, request, film.filename))
    }
}

/// Integrators that path tracing stands in for.
const OTHER_INTEGRATORS: [&str; 8] =
    ["whitted", "simplepath", "simplevolpath", "randomwalk", "lightpath", "bdpt", "mlt", "sppm"];

/// Parameters of integrators that set how they sample, and not what they estimate.
const METHOD_SETTINGS: [&str; 15] = [
    "rrthreshold",
    "lightsampler",
    "lightsamplestrategy",
    "samplelights",
    "samplebsdf",
    "bootstrapsamples",
    "chains",
    "mutationsperpixel",
    "largestepprobability",
    "sigma",
    "iterations",
    "numiterations",
    "photonsperiteration",
    "imagewritefrequency",
    "radius",
];

const DEFAULT_SAMPLES: u32 = 16;
const DEFAULT_DEPTH: u32 = 5;

impl View {
    /// The camera, for a film that is `film_aspect` times as wide as high.
    ///
    /// Camera space has x to the right, y up and z ahead. Its scales go into the screen window, which spans ±1 on the
    /// film's shorter side unless the file says otherwise.
    fn camera(&self, film_aspect: f64) -> Result<Camera> {
        let Some((frame, scales)) = transform::axes(&self.to_world) else {
            return Err(self.at.unsupported("a sheared camera is not supported"));
        };
        let aspect = self.aspect.unwrap_or(film_aspect);
        let (w, h) = if aspect > 1.0 { (aspect, 1.0) } else { (1.0, 1.0 / aspect) };
        let [x0, x1, y0, y1] = self.window.unwrap_or([-w, w, -h, h]);
        let tan = self.tan.map(|tan| tan / scales.z);
        let half = [0.5 * (x1 - x0) * scales.x, 0.5 * (y1 - y0) * scales.y].map(|half| half * tan.unwrap_or(1.0));
        let off = [0.5 * (x0 + x1) * scales.x, 0.5 * (y0 + y1) * scales.y];
        let (right, up, forward) = (frame.x_axis, frame.y_axis, frame.z_axis);
        let mut position = self.to_world.w_axis.truncate();
        let projection = match tan {
            None => {
                position += off[0] * right + off[1] * up;
                Projection::Orthographic { half_width: half[0], half_height: half[1] }
            }
            Some(_) if off != [0.0; 2] => {
                return Err(self.at.unsupported("a perspective screenwindow must be symmetric"));
            }
            Some(_) => Projection::Perspective { tan_half_width: half[0], tan_half_height: half[1] },
        };
        if !in_range(position) || !half.into_iter().all(in_size_range) {
            return Err(self.at.input("the camera's place or window is out of range"));
        }
        Ok(Camera { position, right, up, forward, projection, filter: PixelFilter::default() })
    }
}

/// A `PixelFilter`. The default radius of a Gaussian depends on the version of pbrt.
pub struct Filter {
    shape: FilterShape,
    radius: [Option<f64>; 2],
    /// Whether pbrt-v4 wrote it, where the names of parameters say so.
    v4: Option<bool>,
}

/// Radii and σ.
const PIXELS: Rule = Rule(|x| (RANGE[0]..=RANGE[1]).contains(&x), "from 0.01 to 16 pixels");
/// α of a σ within this range.
const ALPHA: Rule = Rule(|x| (0.002..=5000.0).contains(&x), "from 0.002 to 5000");

impl Filter {
    /// `PixelFilter`: pbrt-v4 has `xradius`, `yradius` and `sigma`, its predecessors `xwidth` and `ywidth`, which are radii, too, and
    /// `alpha` = 1/(2σ²).
    pub fn read(p: &Params, warnings: &mut Vec<String>) -> Result<Self> {
        let is_any_given = |names: [&str; 3]| names.iter().any(|name| p.has_type(name, "float"));
        let v4 = is_any_given(["xradius", "yradius", "sigma"]);
        let shape = match p.kind.as_str() {
            "box" => FilterShape::Box,
            "triangle" => FilterShape::Triangle,
            "gaussian" if v4 => FilterShape::Gaussian { sigma: p.float("sigma", &PIXELS)?.unwrap_or(0.5) },
            "gaussian" => {
                let alpha = p.float("alpha", &ALPHA)?.unwrap_or(2.0);
                FilterShape::Gaussian { sigma: (2.0 * alpha).sqrt().recip() }
            }
            "mitchell" | "sinc" => {
                let message = format!("{} has negative lobes: film positions cannot be sampled by it", p.owner);
                return Err(p.at.unsupported(message).with_hint("supported: box, triangle, gaussian"));
            }
            _ => return Err(p.unsupported_kind("box, triangle, gaussian")),
        };
        let names = if v4 { ["xradius", "yradius"] } else { ["xwidth", "ywidth"] };
        let radius = [p.float(names[0], &PIXELS)?, p.float(names[1], &PIXELS)?];
        p.finish(&[], warnings)?;
        let v4 = (v4 || is_any_given(["xwidth", "ywidth", "alpha"])).then_some(v4);
        Ok(Self { shape, radius, v4 })
    }

    /// The filter, where the film is pbrt-v4's or not.
    pub fn finish(self, film_is_v4: bool) -> Result<PixelFilter> {
        let usual = match self.shape {
            FilterShape::Box => 0.5,
            FilterShape::Triangle => 2.0,
            FilterShape::Gaussian { .. } if self.v4.unwrap_or(film_is_v4) => 1.5,
            FilterShape::Gaussian { .. } => 2.0,
        };
        PixelFilter::new(self.shape, self.radius.map(|radius| radius.unwrap_or(usual)))
    }
}
