//! Pixel filters: what a pixel is the weighted mean of, and how film positions are sampled by that weight.
//!
//! A pixel with centre c has the value ∫ f(p − c) L(p) dp over film positions p, in pixels, where L is the radiance that the camera
//! sees there and f(x, y) = f₁(x) f₂(y) has integral 1. Film positions of pdf f have equal weights (filter importance
//! sampling), and the samples of a pixel belong to no other.
//!
//! Both axes have a table of f that is linear between its nodes. It is sampled and evaluated as it is, so that the pdf of a
//! sample is what light paths are weighted with. A box and a triangle are such tables; of a Gaussian the table has an error of at
//! most 6·10⁻⁵ of the value at the centre.
//!
//! Source: Ernst, Stamminger and Greiner, "Filter Importance Sampling", 2006; the formulas are those of pbrt.

use crate::error::{Error, Result};
use std::fmt;
use std::str::FromStr;

/// The shape of a filter along an axis; x is the distance from the centre in pixels, r the radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FilterShape {
    /// A constant.
    Box,
    /// r − |x|.
    Triangle,
    /// exp(−x²/(2σ²)) − exp(−r²/(2σ²)), which is 0 at the radius.
    Gaussian {
        /// σ in pixels.
        sigma: f64,
    },
}

/// A pixel filter: the product of two functions of that shape, one along each axis. By default, the box of one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelFilter {
    shape: FilterShape,
    /// Along x and y, in pixels; f is 0 beyond.
    radius: [f64; 2],
}

/// Smallest and largest radius and σ, in pixels.
pub const RANGE: [f64; 2] = [0.01, 16.0];

impl Default for PixelFilter {
    fn default() -> Self {
        Self { shape: FilterShape::Box, radius: [0.5; 2] }
    }
}

impl PixelFilter {
    /// A filter of that shape with these radii along x and y, in pixels.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a radius or a σ outside of [`RANGE`].
    pub fn new(shape: FilterShape, radius: [f64; 2]) -> Result<Self> {
        let [low, high] = RANGE;
        let sigma = if let FilterShape::Gaussian { sigma } = shape { sigma } else { low };
        for (name, value) in [("radius", radius[0]), ("radius", radius[1]), ("sigma", sigma)] {
            if !(low..=high).contains(&value) {
                let message = format!("a {name} of {value} is not from {low} to {high} pixels");
                return Err(Error::parameter("filter", message));
            }
        }
        Ok(Self { shape, radius })
    }

    /// Its shape along both axes.
    pub fn shape(&self) -> FilterShape {
        self.shape
    }

    /// Its radii along x and y, in pixels.
    pub fn radius(&self) -> [f64; 2] {
        self.radius
    }

    /// Tables along x and y.
    pub fn axes(&self) -> [FilterAxis; 2] {
        self.radius.map(|radius| FilterAxis::new(self.shape, radius))
    }
}

impl fmt::Display for PixelFilter {
    /// As [`PixelFilter::from_str`] reads it: `gaussian:1.5,0.5`; radii that differ as `2x1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.shape {
            FilterShape::Box => "box",
            FilterShape::Triangle => "triangle",
            FilterShape::Gaussian { .. } => "gaussian",
        };
        let [x, y] = self.radius;
        write!(f, "{name}:{x}")?;
        if x != y {
            write!(f, "x{y}")?;
        }
        if let FilterShape::Gaussian { sigma } = self.shape {
            write!(f, ",{sigma}")?;
        }
        Ok(())
    }
}

impl FromStr for PixelFilter {
    type Err = Error;

    /// `box`, `triangle` or `gaussian`, `:` and the radius, and for a Gaussian `,` and σ; without these, pbrt-v4's values: radii ½, 2
    /// and 1.5, σ ½.
    fn from_str(text: &str) -> Result<Self> {
        let wrong = || Error::parameter("filter", format!("\"{text}\" is not a filter like gaussian:1.5,0.5"));
        let number = |text: &str| text.parse::<f64>().map_err(|_| wrong());
        let (name, rest) = text.split_once(':').map_or((text, None), |(name, rest)| (name, Some(rest)));
        let (radius, sigma) = match rest.map(|rest| rest.split_once(',').ok_or(rest)) {
            None => (None, None),
            Some(Err(radius)) => (Some(radius), None),
            Some(Ok((radius, sigma))) => (Some(radius), Some(number(sigma)?)),
        };
        let (shape, usual) = match (name, sigma) {
            ("box", None) => (FilterShape::Box, 0.5),
            ("triangle", None) => (FilterShape::Triangle, 2.0),
            ("gaussian", sigma) => (FilterShape::Gaussian { sigma: sigma.unwrap_or(0.5) }, 1.5),
            _ => return Err(wrong()),
        };
        let radius = match radius {
            None => [usual; 2],
            Some(text) => match text.split_once('x') {
                Some((x, y)) => [number(x)?, number(y)?],
                None => [number(text)?; 2],
            },
        };
        Self::new(shape, radius)
    }
}

/// A filter along an axis: a table of its right half that is linear between nodes.
#[derive(Debug, Clone)]
pub struct FilterAxis {
    /// Distance of the nodes.
    step: f32,
    /// f at the nodes, from the centre to the radius.
    values: Vec<f32>,
    /// The integral of f over all that is farther from the centre than a node, on both sides: falls from 1 to 0.
    beyond: Vec<f32>,
}

/// Intervals of a Gaussian's table for each σ or, if that is longer, the radius: linear interpolation over h has an error of at most
/// h² max |f″| / 8.
const INTERVALS: f64 = 64.0;
/// Where a Gaussian ends at the latest, in units of σ: it has fallen below 10⁻¹³.
const FARTHEST: f64 = 8.0;

impl FilterAxis {
    pub fn new(shape: FilterShape, radius: f64) -> Self {
        let (radius, intervals) = match shape {
            FilterShape::Box | FilterShape::Triangle => (radius, 1.0),
            FilterShape::Gaussian { sigma } => {
                let radius = radius.min(FARTHEST * sigma);
                (radius, (INTERVALS * radius / sigma).max(INTERVALS).ceil())
            }
        };
        let step = radius / intervals;
        let value = |node: usize| {
            let x = step * node as f64;
            match shape {
                FilterShape::Box => 1.0,
                FilterShape::Triangle => radius - x,
                // The difference of two exponentials, without cancellation where σ is large.
                FilterShape::Gaussian { sigma } => {
                    let exponent = |x: f64| 0.5 * (x / sigma).powi(2);
                    -(-exponent(x)).exp() * (exponent(x) - exponent(radius)).exp_m1()
                }
            }
        };
        let values: Vec<f64> = (0..=intervals as usize).map(value).collect();
        // Integrate from the far end, so that small shares keep their digits.
        let mut beyond = vec![0.0; values.len()];
        for i in (0..values.len() - 1).rev() {
            beyond[i] = beyond[i + 1] + step * (values[i] + values[i + 1]);
        }
        let total = beyond[0];
        let normalized = |values: Vec<f64>| values.into_iter().map(|value| (value / total) as f32).collect();
        Self { step: step as f32, values: normalized(values), beyond: normalized(beyond) }
    }

    /// The distance from the centre beyond which f is 0.
    #[inline]
    pub fn radius(&self) -> f32 {
        self.step * (self.values.len() - 1) as f32
    }

    /// f at a distance from the centre: the pdf of [`FilterAxis::sample`], per pixel.
    #[inline]
    pub fn value(&self, x: f32) -> f32 {
        let place = x.abs() / self.step;
        let i = (place as usize).min(self.values.len() - 2);
        let within = (place - i as f32).min(1.0);
        self.values[i] + within * (self.values[i + 1] - self.values[i])
    }

    /// A signed distance from the centre, which grows with `u` in \[0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        // The share of f that is farther away, and the interval where it ends.
        let share = 1.0 - (2.0 * u - 1.0).abs();
        let i = self.beyond.partition_point(|&beyond| beyond > share).max(1) - 1;
        let within = (self.beyond[i] - share) / (self.beyond[i] - self.beyond[i + 1]);
        // Inside, the pdf is linear from a to b, and its integral a quadratic.
        let [a, b] = [self.values[i], self.values[i + 1]];
        let t = within * (a + b) / (a + (a * a + within * (b * b - a * a)).max(0.0).sqrt());
        (self.step * (i as f32 + t)).copysign(u - 0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filters() -> Vec<PixelFilter> {
        let names = ["box", "box:2.5", "triangle", "triangle:0.3", "gaussian", "gaussian:2x1,0.5", "gaussian:16,0.01"];
        let mut all: Vec<PixelFilter> = names.iter().map(|name| name.parse().unwrap()).collect();
        all.push("gaussian:0.5,16".parse().unwrap());
        all
    }

    #[test]
    fn the_table_has_integral_1_and_the_formula_of_its_filter() {
        for filter in filters() {
            for (axis, radius) in filter.axes().iter().zip(filter.radius()) {
                let radius = radius.min(f64::from(axis.radius()));
                let (n, mut sum, mut worst) = (100_000, 0.0, 0.0f64);
                let formula = |x: f64| match filter.shape() {
                    FilterShape::Box => 0.5 / radius,
                    FilterShape::Triangle => (radius - x) / (radius * radius),
                    FilterShape::Gaussian { sigma } => {
                        let g = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
                        // The integral of exp(−x²/(2σ²)) over ±r is σ √(2π) erf(r/(σ√2)).
                        let whole = sigma * std::f64::consts::TAU.sqrt() * libm::erf(radius / sigma / 2f64.sqrt());
                        (g(x) - g(radius)) / (whole - 2.0 * radius * g(radius))
                    }
                };
                for i in 0..n {
                    let x = radius * (f64::from(i) + 0.5) / f64::from(n);
                    let value = f64::from(axis.value(x as f32));
                    assert_eq!(axis.value(-x as f32), axis.value(x as f32), "{filter}");
                    sum += 2.0 * value * radius / f64::from(n);
                    worst = worst.max((value - formula(x)).abs());
                }
                assert!((sum - 1.0).abs() < 1e-5, "{filter}: {sum}");
                assert!(worst < 6.1e-5 * formula(0.0), "{filter}: {}", worst / formula(0.0));
            }
        }
        let unit = &PixelFilter::default().axes()[0];
        assert!([0.0, 0.2, 0.5].iter().all(|&x| unit.value(x) == 1.0) && unit.radius() == 0.5);
    }

    #[test]
    fn samples_have_the_pdf() {
        for filter in filters() {
            for axis in filter.axes() {
                let n = 1 << 16;
                let mut last = f32::NEG_INFINITY;
                let places: Vec<f32> =
                    (0..=n).map(|i| axis.sample((i as f32 / n as f32).min(1.0f32.next_down()))).collect();
                for (i, &x) in places.iter().enumerate() {
                    assert!(x.abs() <= axis.radius() * 1.000_001 && x >= last, "{filter}: {x} after {last}");
                    last = x;
                    // Equal steps of u are equal shares of the integral.
                    if i > 0 && i < places.len() - 1 && axis.value(x) > 0.1 * axis.value(0.0) {
                        let share = axis.value(0.5 * (x + places[i - 1])) * (x - places[i - 1]);
                        assert!((share * n as f32 - 1.0).abs() < 0.02, "{filter}: {share} at {x}");
                    }
                }
                assert_eq!(axis.sample(0.5), 0.0);
                assert!(axis.sample(0.0) < -0.999 * axis.radius());
            }
        }
    }

    #[test]
    fn names_are_read_back() {
        for filter in filters() {
            assert_eq!(filter.to_string().parse::<PixelFilter>().unwrap(), filter);
        }
        assert_eq!("box".parse::<PixelFilter>().unwrap(), PixelFilter::default());
        assert_eq!("gaussian".parse::<PixelFilter>().unwrap().to_string(), "gaussian:1.5,0.5");
        let with_boxes = "mitchell Box box: box:0 box:17 box:nan box:1,1 triangle:-1";
        let gaussians = "gaussian:1,0 gaussian:1,x gaussian:1x gaussian:inf,1 gaussian:1,1,1 gaussian:,1 gaussian:2,";
        for bad in with_boxes.split(' ').chain(gaussians.split(' ')).chain([""]) {
            assert!(bad.parse::<PixelFilter>().is_err(), "{bad}");
        }
    }
}
