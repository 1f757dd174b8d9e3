//! What the reports claim: the list of all sentences and numbers that are tested, with the figures that show them.

use super::Text;

/// A constant for each claim: its place, what it says, the number that the report prints, the figures that show it, and a remark.
macro_rules! texts {
    ($($name:ident: $place:literal, $claim:literal
        $(, printed $number:literal)? $(, in [$($figure:literal),*])? $(, remark $remark:literal)?;)*) => {
        $(pub const $name: Text = Text {
            place: $place,
            claim: $claim,
            number: concat!($($number)?),
            evidence: &[$($($figure),*)?],
            remark: concat!($($remark)?),
        };)*
    };
}

// Formulas of the first report
texts! {
    BREWSTER: "Fig. 1", "Brewster's angle from η = 1 to 1.45.", printed "55.40771131249006", in ["fresnel-enter"];
    NO_PARALLEL: "Fig. 1", "The curve of parallel polarization goes to zero at Brewster's angle.", printed "55.40771131249006", in ["fresnel-enter", "fresnel-angles"];
    QUOTIENTS: "text", "R∥ and R⊥ are the squares of the printed quotients of η and cosines.", in ["fresnel-enter", "fresnel-exit"];
    CRITICAL: "Fig. 2", "The critical angle from η = 1.45 to 1.", printed "43.60281897270362", in ["fresnel-exit"];
    TRANSMITTANCE: "Fig. 1, 2", "Transmittance is 1 − R of unpolarized light.", in ["fresnel-enter", "fresnel-exit"];
    UPPER_BOUND: "Fig. 2", "Leaving glass, the critical angle is the upper bound of the angle of incidence.", printed "43.60281897270362", in ["fresnel-exit"];
    SCHLICK_INSIDE: "Fig. 2", "Schlick's approximation, leaving glass, by the cosine of incidence up to the critical angle.", in ["fresnel-exit", "audit"];
    SCHLICK_INDEX: "text", "Schlick's approximation needs no estimate of the index of refraction.", in ["fresnel-enter", "metals-table"];
    COMPLEX_INDEX: "text", "A function for a complex index is not needed here.", in ["fresnel-enter"];
}

// The first report's map
texts! {
    SIZE: "text", "The map has 512 rows and 1024 columns.", printed "(512, 1024, 3)", in ["envmap-samples-1024"];
    PROPOSAL: "text", "Of the proposals tried, uniform is the most appropriate, not Gaussian.", in ["proposal", "audit"];
    BRIGHTER_PIXELS: "text", "Pixels of higher intensity are easier to be sampled.", in ["envmap-samples-1024"];
    MIDDLE_ROWS: "text", "Pixels in the middle of the image are more likely than those at the edge: rows.", in ["envmap-samples-1024"];
    MIDDLE_COLUMNS: "text", "Pixels in the middle of the image are more likely than those at the edge: columns.", in ["envmap-samples-1024"];
    FOUR_CUTS: "text", "The cuts of both halves make 4 cuts.", printed "4 cuts", in ["median-cut-4"],
        remark "The sentence counts regions. Captions of Figures 7 to 10 count levels: 1, 2, 4 and 6 of them make 2, 4, 16 and 64 regions, by 1, 3, 15 and 63 cuts.";
    BALANCE: "Fig. 10", "Six cuts, of every region at its median pixel into halves of the same energy, make 64 regions.", printed "6 cuts",
        in ["median-cut-64"], remark "A cut falls between two texels.";
    CENTROIDS: "Fig. 7–11", "The median pixels of the last cut are centroids.", in ["median-cut-64", "median-cut-error"];
    FIGURES: "text", "The cuts are in Figures 7, 8, 14 and 15.", printed "7, 8, 14, 15", in ["median-cut-2", "median-cut-64"],
        remark "An error of print: they are Figures 7 to 10; 14 and 15 are spheres.";
    MORE_SAMPLES: "Fig. 12–15", "More samples take longer and have less noise.", printed "8 to 64 samples", in ["sphere-error", "sphere-8", "sphere-64"];
}

// What the second report sees at each depth
texts! {
    LIGHT_ALONE: "Fig. 1a", "Depth 0 shows the area light alone.", in ["depth-0"];
    WALLS: "Fig. 1b", "Depth 1 shows walls and floor.", in ["depth-1"];
    LIGHT_IN_MIRROR: "Fig. 1b", "Depth 1 shows the light in the mirror sphere.", in ["depth-1"];
    LIGHT_ON_GLASS: "Fig. 1b", "Depth 1 shows the light on the glass sphere.", in ["depth-1"];
    CEILING: "Fig. 1c", "Depth 2 adds the ceiling.", in ["depth-2"];
    WALLS_IN_MIRROR: "Fig. 1c", "Depth 2 adds the walls in the mirror sphere.", in ["depth-2"];
    GLASS_IN_MIRROR: "Fig. 1c", "Depth 2 adds light, outside of glass, mirror, eye.", in ["depth-2"];
    WALLS_ON_GLASS: "Fig. 1c", "Depth 2 adds the walls, faintly, on the outside of the glass.", in ["depth-2"];
    WHITE_SPOT: "Fig. 1c", "Depth 2 adds a faint white spot on the left of the glass: light, mirror, outside of glass.", in ["depth-2"],
        remark "Not judged: path classes of D and S do not tell the mirror from the glass.";
    CEILING_IN_MIRROR: "Fig. 1d", "Depth 3 adds the ceiling in the mirror sphere.", in ["depth-3"];
    WALLS_THROUGH_GLASS: "Fig. 1d", "Depth 3 adds the walls through the glass sphere.", in ["depth-3"];
    CAUSTIC: "Fig. 1d", "Depth 3 adds the caustic under the glass sphere.", in ["depth-3"];
    REFLECTION_GONE: "Fig. 1d", "At depth 3 the faint reflection of floor and walls on the glass is gone.",
        in ["depth-3"], remark "The same light is there; what comes through the glass outshines it.";
    REFRACTION: "Fig. 1d", "Refraction by the glass sphere is much more intense than reflection.", in ["depth-3"];
    GLASS_IN_MIRROR_WALLS: "Fig. 1e", "Depth 4 adds the walls through the glass, in the mirror.", in ["depth-4"];
    CAUSTIC_IN_MIRROR: "Fig. 1e", "Depth 4 adds the caustic in the mirror.", in ["depth-4"],
        remark "Not judged: its light in the render is a few bright pixels of noise.";
    BLUE_WALL: "Fig. 1e", "Depth 4 adds a spot at the bottom of the blue wall: light, mirror, into and out of the glass, wall.", in ["depth-4"],
        remark "Not judged: path classes of D and S do not tell the mirror from the glass.";
    CAUSTIC_ON_GLASS: "Fig. 1e", "Depth 4 adds the caustic on the outside of the glass.", in ["depth-4"];
    NOTHING_ELSE: "Fig. 1f", "Depth 5 adds no other significant feature.", in ["depth-5", "depth-differences"];
    GLAZING: "Fig. 1g", "Depth 100 adds a glazing on the top of the glass sphere.", in ["depth-100"];
    GLAZING_OUTSIDE: "Fig. 1g", "The glazing is reflection by the outside near grazing incidence.", in ["depth-100"],
        remark "Not judged: path classes of D and S do not tell reflection by the outside of the glass from reflection inside it.";
    INCREASES: "Fig. 1", "The overall intensity increases at every step.", in ["depth-differences", "error-depth"];
}

// Formulas and indices of the second report
texts! {
    AMPLITUDE: "text", "The reflectance is the square of the amplitude r.", in ["fresnel-enter", "fresnel-exit"];
    SYMMETRY: "text", "r is symmetric under exchange of the materials.", in ["fresnel-enter", "fresnel-exit", "audit"],
        remark "It is symmetric between the two angles of a refracted path, which differ.";
    IRON: "Table 1", "Iron at 614, 549 and 466 nm.", printed "2.8851 + 3.0449i, 2.9500 + 2.9300i, 2.6500 + 2.8095i", in ["metals-table", "iron"];
    APPROXIMATION: "text", "The conductor formulas for |n|² ≫ 1 do for these metals.", in ["metals-table", "audit"];
    DENSITY: "text", "D is a probability density of normals.", printed "α = 0.005, 0.05, 0.25, 0.5", in ["audit"],
        remark "D cos θ is the density, and what the printed inversion samples.";
    HALF_VECTOR: "text", "4 eᵣ·h = 2 |eᵣ + eᵢ|.";
}

// The second report's statues
texts! {
    DIFFUSE: "Fig. 2", "The higher the roughness, the more diffuse the dragon.", printed "α = 0.005, 0.05, 0.25, 0.5", in ["roughness-0.005", "roughness-0.5"];
    BLACK_REGIONS: "Fig. 2a", "At low roughness there are black regions, where the dragon mirrors the observer's side.", in ["roughness-0.005", "roughness-0.5"];
    BLUE_REGIONS: "Fig. 2a", "At low roughness there are blue regions, where the dragon mirrors the blue wall.", in ["roughness-0.005", "roughness-0.5"];
    GOLDEN: "Fig. 2d", "At high roughness the colour is almost that of gold.", in ["roughness-0.5", "roughness-0.005"];
    BLACK_LINE: "Fig. 3b", "Hemisphere sampling shows a black line around the bunny.", in ["sampling-error", "sampling-hemisphere"];
    EXPLANATION: "Fig. 3b", "The line is black because half-vectors lie about 45° off the normal, where D is exponentially small.",
        in ["sampling-error"], remark "Few samples carry all of the light: noise, and not darkness.";
    LESS_NOISE: "Fig. 3", "Importance sampling reduces the noise overall.", in ["sampling-error", "sampling-importance"];
}
