//! The domains by name: what users choose from.

use super::{
    Barycentric, Circle, Directions, Discrete, Disk, Domain, HalfLine, Indexed, Line, Plane, Pole, Product, RealLine,
    Rectangle, Simplex, Square, Triangle, solid,
};
use crate::error::{Error, Result};
use std::sync::Arc;

/// A domain of a sampler, or a family of them.
pub struct Entry {
    /// What it is called: `disk`.
    pub name: &'static str,
    /// What may follow the name: `:RADIUS`, in brackets if it may be left out.
    pub parameters: &'static str,
    /// The coordinates of a point.
    pub coordinates: &'static str,
    /// What pdfs are a density per.
    pub measure: &'static str,
    /// A name with parameters.
    pub example: &'static str,
    /// Makes it from the parameters; else says what they should be.
    make: fn(&[f64]) -> std::result::Result<Named, &'static str>,
}

/// A domain that is chosen by name.
pub type Named = Arc<dyn Domain + Send>;

fn made(domain: impl Domain + Send + 'static) -> std::result::Result<Named, &'static str> {
    Ok(Arc::new(domain))
}

/// A domain without parameters.
fn alone(parameters: &[f64], domain: impl Domain + Send + 'static) -> std::result::Result<Named, &'static str> {
    if parameters.is_empty() { made(domain) } else { Err("no parameters") }
}

/// All domains.
pub const DOMAINS: [Entry; 17] = [
    Entry {
        name: "sphere",
        parameters: "",
        coordinates: "`x y z`, a unit vector",
        measure: "steradian",
        example: "sphere",
        make: |p| alone(p, Directions::sphere(Pole::Z)),
    },
    Entry {
        name: "hemisphere",
        parameters: "",
        coordinates: "`x y z`, a unit vector, z ≥ 0",
        measure: "steradian",
        example: "hemisphere",
        make: |p| alone(p, Directions::hemisphere(Pole::Z)),
    },
    Entry {
        name: "square",
        parameters: "",
        coordinates: "`x y`, both from 0 to 1",
        measure: "unit area",
        example: "square",
        make: |p| alone(p, Square),
    },
    Entry {
        name: "line",
        parameters: "",
        coordinates: "`x`, from 0 to 1",
        measure: "unit length",
        example: "line",
        make: |p| alone(p, Line::UNIT),
    },
    Entry {
        name: "interval",
        parameters: "[:FROM,TO]",
        coordinates: "`x`, from FROM (0) to TO (1)",
        measure: "unit length",
        example: "interval:-1,1",
        make: |p| match *p {
            [] => made(Line::UNIT),
            [from, to] if from < to && (to - from).is_finite() => made(Line { from, to }),
            _ => Err("two numbers, the lower first"),
        },
    },
    Entry {
        name: "half-line",
        parameters: "[:FROM[,WIDTH]]",
        coordinates: "`x` ≥ FROM (0); a WIDTH (1) below 0: `x` ≤ FROM",
        measure: "unit length",
        example: "half-line",
        make: |p| match *p {
            [] => made(HalfLine::POSITIVE),
            [from] => made(HalfLine { from, ..HalfLine::POSITIVE }),
            [from, width] if is_width(width.abs()) => made(HalfLine { from, width }),
            _ => Err("the end, and perhaps a width that is not 0"),
        },
    },
    Entry {
        name: "real",
        parameters: "[:PLACE[,WIDTH]]",
        coordinates: "`x`, any number; most are about WIDTH (1) from PLACE (0)",
        measure: "unit length",
        example: "real:1000,0.1",
        make: |p| match *p {
            [] => made(RealLine::UNIT),
            [place] => made(RealLine { place, ..RealLine::UNIT }),
            [place, width] if is_width(width) => made(RealLine { place, width }),
            _ => Err("a place, and perhaps a width above 0"),
        },
    },
    Entry {
        name: "plane",
        parameters: "[:WIDTH]",
        coordinates: "`x y`, any numbers; most are about WIDTH (1) from 0",
        measure: "unit area",
        example: "plane",
        make: |p| match *p {
            [] => made(Plane::UNIT),
            [width] if is_width(width) => {
                let axis = RealLine { place: 0.0, width };
                made(Product { x: axis, y: axis })
            }
            _ => Err("perhaps a width above 0"),
        },
    },
    Entry {
        name: "box",
        parameters: ":X0,X1,Y0,Y1[,…]",
        coordinates: "`x y`, from X0 to X1 and from Y0 to Y1; of two to six axes",
        measure: "unit area (volume)",
        example: "box:-1,1,0,2",
        make: |p| {
            let sides: Vec<Line> = p.chunks_exact(2).map(|ends| Line { from: ends[0], to: ends[1] }).collect();
            let measure: f64 = sides.iter().map(|side| side.to - side.from).product();
            match *sides {
                _ if p.len() % 2 > 0 || !measure.is_finite() || sides.iter().any(|side| side.from >= side.to) => None,
                [x, y] => Some(made(Rectangle { x, y })),
                _ if (3..=6).contains(&sides.len()) => Some(made(solid::cuboid(sides))),
                _ => None,
            }
            .unwrap_or(Err("four to twelve numbers, the lower end of each axis first"))
        },
    },
    Entry {
        name: "space",
        parameters: "[:WIDTH]",
        coordinates: "`x y z`, any numbers; most are about WIDTH (1) from 0",
        measure: "unit volume",
        example: "space",
        make: |p| match *p {
            [] => made(solid::space(1.0)),
            [width] if is_width(width) => made(solid::space(width)),
            _ => Err("perhaps a width above 0"),
        },
    },
    Entry {
        name: "ball",
        parameters: "[:RADIUS]",
        coordinates: "`x y z`, within RADIUS (1) of the origin",
        measure: "unit volume",
        example: "ball:2",
        make: |p| match *p {
            [] => made(solid::ball(1.0)),
            [radius] if is_width(radius) => made(solid::ball(radius)),
            _ => Err("perhaps a radius above 0"),
        },
    },
    Entry {
        name: "rotations",
        parameters: "",
        coordinates: "`x y z w`, a unit quaternion, w its real part; q and −q are one",
        measure: "share of all rotations (Haar's measure: the uniform pdf is 1)",
        example: "rotations",
        make: |p| alone(p, solid::rotations()),
    },
    Entry {
        name: "disk",
        parameters: "[:RADIUS]",
        coordinates: "`x y`, within RADIUS (1) of the origin",
        measure: "unit area",
        example: "disk:2",
        make: |p| match *p {
            [] => made(Disk::UNIT),
            [radius] if is_width(radius) => made(Disk { radius }),
            _ => Err("perhaps a radius above 0"),
        },
    },
    Entry {
        name: "circle",
        parameters: "",
        coordinates: "`x y`, a unit vector",
        measure: "radian",
        example: "circle",
        make: |p| alone(p, Circle),
    },
    Entry {
        name: "triangle",
        parameters: "[:NINE COORDINATES]",
        coordinates: "`b0 b1`, barycentric; with the corners' `x,y,z`: `x y z`",
        measure: "unit area (of `b0 b1`; ½ in all)",
        example: "triangle:0,0,0,2,0,0,0,1,1",
        make: |p| match *p {
            [] => made(Barycentric),
            [a, b, c, d, e, f, g, h, i] => {
                let triangle = Triangle { corners: [[a, b, c], [d, e, f], [g, h, i]] };
                let area = triangle.measure();
                if area > 0.0 && area.is_finite() {
                    made(triangle)
                } else {
                    Err("corners of a triangle that has an area")
                }
            }
            _ => Err("nine coordinates of three corners, or none"),
        },
    },
    Entry {
        name: "simplex",
        parameters: "[:K]",
        coordinates: "`b0 b1 b2`, from 0 to 1, of sum 1; K (3) of them, at most 7",
        measure: "unit area of `b0 b1` (½ in all); volume of all but the last (1/(K − 1)!)",
        example: "simplex",
        make: |p| match if p.is_empty() { Some(3) } else { whole(p, 7) } {
            Some(3) => made(Simplex),
            Some(weights) if weights > 3 => made(solid::simplex(weights)),
            _ => Err("a number from 3 to 7"),
        },
    },
    Entry {
        name: "discrete",
        parameters: ":N",
        coordinates: "`i`, a whole number from 0 to N − 1, N at most 2²⁰",
        measure: "outcome (its probability)",
        example: "discrete:6",
        make: |p| match whole(p, MOST_OUTCOMES) {
            Some(outcomes) => made(Discrete { outcomes }),
            None => Err("a number from 1 to 1048576"),
        },
    },
];

/// Most points of a finite set, and most indices beside points of another domain.
const MOST_OUTCOMES: usize = 1 << 20;
const MOST_INDICES: usize = 1 << 12;

/// Whether a width leaves room for far ends.
fn is_width(width: f64) -> bool {
    (1e-60..1e60).contains(&width)
}

/// The only parameter, if it is a whole number from 1 to `most`.
fn whole(parameters: &[f64], most: usize) -> Option<usize> {
    let &[n] = parameters else { return None };
    (n.fract() == 0.0 && n >= 1.0 && n <= most as f64).then_some(n as usize)
}

/// The names of all domains, in a sentence.
#[must_use]
pub fn known() -> String {
    let names: Vec<String> = DOMAINS.iter().map(|entry| format!("{}{}", entry.name, entry.parameters)).collect();
    format!("{}, or N*DOMAIN: an index below N and a point", names.join(", "))
}

/// The domain of this name: an [`Entry`]'s, its parameters after a colon; after `N*`, an [`Indexed`] one.
///
/// # Errors
/// [`Error::Parameter`] that says what is wrong with the name.
pub fn named(text: &str) -> Result<Named> {
    let wrong = |message: String| Error::Parameter { name: "domain", message, hint: None };
    if let Some((count, rest)) = text.split_once('*') {
        let domain = named(rest.trim())?;
        let count = count.trim().parse().ok().filter(|n| (1..=MOST_INDICES).contains(n));
        let count = count.ok_or_else(|| wrong(format!("{text:?} needs a number from 1 to {MOST_INDICES} before *")))?;
        let width = domain.point_at([0.5; 2]).coordinates().len();
        if domain.outcomes().is_some() || domain.parts() > 1 || width > 7 {
            return Err(wrong(format!("{text:?}: indices go with points of one to seven coordinates")));
        }
        return Ok(Arc::new(Indexed { count, domain }));
    }
    let (name, parameters) = text.split_once(':').map_or((text, None), |(name, rest)| (name, Some(rest)));
    let entry = DOMAINS.iter().find(|entry| entry.name == name);
    let entry = entry.ok_or_else(|| wrong(format!("unknown domain {text:?}")))?;
    let number = |word: &str| word.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let parameters: Option<Vec<f64>> = parameters.map_or(Some(Vec::new()), |all| all.split(',').map(number).collect());
    let of_numbers = |parameters: Vec<f64>| (entry.make)(&parameters);
    parameters.map_or(Err("numbers"), of_numbers).map_err(|wanted| wrong(format!("{text:?} needs {wanted}")))
}

#[cfg(test)]
mod tests {
    use super::super::chart::check_chart;
    use super::super::{ChartFunctions, Place, Point, place};
    use super::*;

    /// A domain of one or two dimensions by the functions of its chart.
    struct Flat<'a>(&'a dyn Domain);

    impl ChartFunctions for Flat<'_> {
        fn to_cube(&self, points: &[Point]) -> Result<Vec<Place>> {
            Ok(self.0.charts(points)?.iter().map(|at| place(at)).collect())
        }

        fn from_cube(&self, cube: &[Place]) -> Result<Vec<Point>> {
            self.0.points_at(&cube.iter().map(|at| [at[0], at[1]]).collect::<Vec<_>>())
        }

        fn jacobian(&self, cube: &[Place]) -> Result<Vec<f64>> {
            Ok(cube.iter().map(|at| self.0.jacobian([at[0], at[1]])).collect())
        }
    }

    #[test]
    fn every_domain_has_a_chart_that_is_right() {
        const MORE: [&str; 5] =
            ["box:0,1,-1,1,2,5", "box:0,1,0,1,0,1,0,1,0,1,-2,3", "simplex:4", "simplex:7", "2*simplex:7"];
        let more = MORE.map(str::to_owned);
        for (i, entry) in DOMAINS.iter().enumerate() {
            let names = [entry.example.to_owned(), entry.name.to_owned(), format!("3*{}", entry.example)];
            let names = names.into_iter().chain(more.iter().filter(|_| i == 0).cloned()).collect::<Vec<_>>();
            for name in names.iter().filter(|name| named(name).is_ok()) {
                let domain = named(name).unwrap();
                // A simplex has the area of two of its three coordinates.
                if domain.outcomes().is_none() && domain.space().is_none() && entry.name != "simplex" {
                    let dimension = 1 + usize::from(domain.is_plane());
                    check_chart(&Flat(&*domain), dimension, 1.0).unwrap_or_else(|error| panic!("{name}: {error}"));
                }
                domain.check().unwrap_or_else(|error| panic!("{name}: {error}"));
                let at = |x: f64| domain.point_at([x, 0.3]);
                assert_eq!(domain.point(at(0.4).coordinates()), Some(at(0.4)), "{name}");
                assert_eq!(domain.names().len(), at(0.4).coordinates().len(), "{name}");
                assert!(domain.same(at(0.4), at(0.4)) && !domain.same(at(0.1), at(0.9)), "{name}");
                assert!(domain.to_chart(at(0.0)).is_some() && domain.to_chart(at(1.0)).is_some(), "{name}");
                let outside = domain.point(&vec![f64::NAN; domain.names().len()]);
                assert!(outside.is_none_or(|outside| domain.to_chart(outside).is_none()), "{name}");
            }
            assert!(named(entry.example).is_ok(), "{}", entry.example);
        }
    }

    #[test]
    fn wrong_names_are_told() {
        let wrong = [
            "",
            "disc",
            "discrete",
            "discrete:",
            "discrete:0",
            "discrete:-1",
            "discrete:1.5",
            "discrete:99999999999999999999",
            "interval:1,0",
            "interval:1",
            "real:0,0",
            "real:nan",
            "box:0,1,0",
            "box:0,1,0,1,1,0",
            "box:0,1,0,1,0,1,0,1,0,1,0,1,0,1",
            "simplex:2",
            "simplex:8",
            "ball:0",
            "space:0",
            "rotations:1",
            "disk:-1",
            "triangle:0,0,0,1,1,1,2,2,2",
            "sphere:1",
            "0*disk",
            "99999*disk",
            "2*3*disk",
            "2*discrete:6",
            "x*disk",
        ];
        for name in wrong {
            assert!(named(name).is_err(), "{name}");
        }
    }
}
