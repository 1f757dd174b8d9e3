//! What the second report sees appear at each maximum depth.

use super::events::Event::{self, BlueWall, Ceiling, Diffuse, Mirror, Reflected, Refracted};

/// Something that the report sees appear at a depth.
pub struct Feature {
    /// Of the image.
    pub depth: u32,
    /// Figure of the report.
    pub place: &'static str,
    /// In its words.
    pub claim: &'static str,
    /// The class, from the eye.
    pub events: &'static [Event],
    /// Its colour or place.
    pub and: And,
    /// Title of its picture, if the claim is about a place.
    pub picture: Option<&'static str>,
    /// Figures that show it.
    pub evidence: &'static [&'static str],
}

/// What else is claimed.
#[derive(Clone, Copy, PartialEq)]
pub enum And {
    /// No more.
    Nothing,
    /// It is white, and left of the middle of the object that shows it.
    WhiteAndLeft,
    /// It is below the middle of the object that shows it.
    Low,
}

/// The features in the order of the report.
pub fn features() -> Vec<Feature> {
    let at = |depth: u32, place, claim, events| {
        let evidence: &'static [&'static str] = match depth {
            1 => &["depth-1"],
            2 => &["depth-2", "claims-places"],
            3 => &["depth-3", "claims-places"],
            _ => &["depth-4", "claims-places"],
        };
        Feature { depth, place, claim, events, and: And::Nothing, picture: None, evidence }
    };
    let (b, c, d, e) = ("Fig. 1b", "Fig. 1c", "Fig. 1d", "Fig. 1e");
    vec![
        at(1, b, "Depth 1 shows walls and floor.", &[Diffuse]),
        at(1, b, "Depth 1 shows the light in the mirror sphere.", &[Mirror]),
        at(1, b, "Depth 1 shows the light on the glass sphere.", &[Reflected]),
        at(2, c, "Depth 2 adds the ceiling.", &[Ceiling, Diffuse]),
        at(2, c, "Depth 2 adds the walls in the mirror sphere.", &[Mirror, Diffuse]),
        at(2, c, "Depth 2 adds light, outside of glass, mirror, eye.", &[Mirror, Reflected]),
        at(2, c, "Depth 2 adds the walls, faintly, on the outside of the glass.", &[Reflected, Diffuse]),
        Feature {
            and: And::WhiteAndLeft,
            picture: Some("white spot on the left of the glass sphere"),
            ..at(
                2,
                c,
                "Depth 2 adds a faint white spot on the left of the glass: light, mirror, outside of glass.",
                &[Reflected, Mirror],
            )
        },
        at(3, d, "Depth 3 adds the ceiling in the mirror sphere.", &[Mirror, Ceiling, Diffuse]),
        at(3, d, "Depth 3 adds the walls through the glass sphere.", &[Refracted, Refracted, Diffuse]),
        at(3, d, "Depth 3 adds the caustic under the glass sphere.", &[Diffuse, Refracted, Refracted]),
        at(4, e, "Depth 4 adds the walls through the glass, in the mirror.", &[Mirror, Refracted, Refracted, Diffuse]),
        Feature {
            picture: Some("caustic in the mirror"),
            ..at(4, e, "Depth 4 adds the caustic in the mirror.", &[Mirror, Diffuse, Refracted, Refracted])
        },
        Feature {
            and: And::Low,
            picture: Some("spot on the blue wall"),
            ..at(
                4,
                e,
                "Depth 4 adds a spot at the bottom of the blue wall: light, mirror, into and out of the glass, wall.",
                &[BlueWall, Refracted, Refracted, Mirror],
            )
        },
        Feature {
            picture: Some("caustic on the outside of the glass"),
            ..at(
                4,
                e,
                "Depth 4 adds the caustic on the outside of the glass.",
                &[Reflected, Diffuse, Refracted, Refracted],
            )
        },
    ]
}
