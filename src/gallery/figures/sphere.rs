//! The white sphere under the environment map: `sphere-8`, `sphere-16`, `sphere-32`, `sphere-64`.

use crate::gallery::map::MapInfo;
use crate::gallery::prelude::*;
use crate::raster::ToneMap;
use crate::scene::builtin::SPHERE_ENV_SCALE;
use crate::study::sphere::{Exact, PBRT_RMSE, render_sphere};
use crate::view::sphere as view;

/// The exact image at a width in pixels.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct ExactImage(pub usize);

impl Study for ExactImage {
    type Output = Exact;

    fn run(self, inputs: &Inputs) -> Result<Exact> {
        Ok(Exact::new(&inputs.map.map, f64::from(SPHERE_ENV_SCALE), self.0))
    }
}

/// Four numbers of samples per pixel.
pub fn figures() -> Vec<Figure> {
    let sphere = |id, spp, reproduces, beside| Figure {
        id,
        title: "The sphere under the map, and its error",
        report: Report::First,
        reproduces,
        shows: "A white diffuse sphere under the map, and the error of each pixel against the exact integral: noise, which \
                decreases with the number of samples.",
        beside: Some(beside),
        command: Some(format!("etalon render sphere-env --envmap {{map}} -s {spp} -l 4")),
        make: Box::new(move |inputs, studies| content(inputs, studies, spp)),
    };
    vec![
        sphere("sphere-8", 8, "Figure 12, 8 samples", "sphere-64"),
        sphere("sphere-16", 16, "Figure 13, 16 samples", "sphere-8"),
        sphere("sphere-32", 32, "Figure 14, 32 samples", "sphere-16"),
        sphere("sphere-64", 64, "Figure 15, 64 samples", "sphere-32"),
    ]
}

fn content(inputs: &Inputs, studies: &mut Studies, spp: u32) -> Result<Content> {
    let exact = studies.get(ExactImage(inputs.effort.of(511, 127)), inputs)?;
    let shot = render_sphere(&inputs.map, spp, &exact, &inputs.settings())?;
    let mut checks = vec![
        Check::within("relative bias", 0.0, shot.row.rel_bias, 2e-3),
        Check::equal("dropped samples", 0.0, shot.rendered.dropped.total() as f64),
    ];
    // PBRT's errors were measured on the Grace map: no other map's can be compared with them.
    let grace = studies.get(MapInfo, inputs)?.is_grace();
    let pbrt = PBRT_RMSE.iter().find(|(n, _)| *n == spp).filter(|_| grace);
    if let Some((_, rmse)) = pbrt {
        checks.push(Check::at_most("relative RMSE (half of PBRT-v2's)", shot.row.rel_rmse, rmse / 2.0));
    }
    let content = Content::new(view::shot(&shot)?, &[shot.row], checks)?;
    Ok(content.with_image(&shot.rendered.image, ToneMap::LinearMax))
}
