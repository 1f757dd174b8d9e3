//! A golden statue of increasing roughness: `roughness-0.005`, `-0.05`, `-0.25`, `-0.5`.

use crate::errata::Conventions;
use crate::gallery::prelude::*;
use crate::raster::ToneMap;
use crate::study::roughness::{self, StatueRender};
use crate::view::statue as view;

/// Standard errors by which two means may differ.
const SIGMAS: f64 = 4.0;

/// A statue of the metal of that symbol, with the bits of α.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Statue(&'static str, u32);

impl Statue {
    /// A statue of `metal` with roughness α.
    pub fn new(metal: &'static str, alpha: f32) -> Self {
        Self(metal, alpha.to_bits())
    }

    fn alpha(self) -> f32 {
        f32::from_bits(self.1)
    }
}

impl Study for Statue {
    type Output = StatueRender;

    fn run(self, inputs: &Inputs) -> Result<StatueRender> {
        let (scene, request) = inputs.statue(self.0, self.alpha())?;
        roughness::render_statue(&scene, &request, &inputs.settings())
    }
}

/// One figure for each α, each checked against the smoother one before it.
pub fn figures() -> Vec<Figure> {
    let figure = |id, alpha, smoother: Option<f32>, reproduces, beside| Figure {
        id,
        title: "Golden statue of increasing roughness",
        report: Report::Second,
        reproduces,
        shows: "The wider the distribution of microfacet normals, the wider and dimmer are the highlights.",
        beside: Some(beside),
        command: Some(format!("etalon render cornell-statue-au --alpha {alpha} -s 128 -l 1 -m 5 --tone report")),
        make: Box::new(move |inputs, studies| {
            let mut content = content(inputs, studies, Statue::new("Au", alpha), "gold")?;
            if let Some(smoother) = smoother {
                content.checks.push(dimmer(inputs, studies, alpha, smoother)?);
            }
            Ok(content)
        }),
    };
    vec![
        figure("roughness-0.005", 0.005, None, "Figure 2a, α = 0.005", "roughness-0.05"),
        figure("roughness-0.05", 0.05, Some(0.005), "Figure 2b, α = 0.05", "roughness-0.005"),
        figure("roughness-0.25", 0.25, Some(0.05), "Figure 2c, α = 0.25", "roughness-0.05"),
        figure("roughness-0.5", 0.5, Some(0.25), "Figure 2d, α = 0.5", "roughness-0.25"),
    ]
}

/// A statue, checked against a render with another way of sampling normals.
pub fn content(inputs: &Inputs, studies: &mut Studies, statue: Statue, metal: &str) -> Result<Content> {
    let shot = studies.get(statue, inputs)?;
    let (scene, request) = inputs.statue(statue.0, statue.alpha())?;
    let other = roughness::mean_by_all_normals(&scene, &request, &inputs.settings(), &shot.mask)?;
    let z = shot.statue.z(&other);
    let checks = vec![
        Check::equal("dropped samples", 0.0, shot.rendered.dropped.total() as f64),
        Check::within("statue by visible normals minus by all normals (standard errors)", 0.0, z, SIGMAS),
    ];
    let content = Content::new(view::image(&shot, metal), std::slice::from_ref(&shot.row), checks)?;
    Ok(content.with_image(&shot.rendered.image, ToneMap::By(Conventions::SECOND_REPORT)))
}

/// Rougher metal has dimmer highlights.
fn dimmer(inputs: &Inputs, studies: &mut Studies, alpha: f32, smoother: f32) -> Result<Check> {
    let [rough, smooth] = [alpha, smoother].map(|alpha| studies.get(Statue::new("Au", alpha), inputs));
    let ratio = rough?.row.brightest_percent / smooth?.row.brightest_percent;
    let name = format!("share of light in the brightest hundredth of the pixels, over that at α = {smoother}");
    Ok(Check::at_most(name, ratio, 1.0))
}
