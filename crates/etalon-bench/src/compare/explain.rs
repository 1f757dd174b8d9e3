//! What would explain the difference of two images: a turn, another order of channels, an exposure, a transfer function, a shift, a clamp.
//!
//! An edit explains a difference if undoing it leaves nothing but noise. Noise is distinguished from differences by products of
//! the residual's means over blocks of pixels two blocks apart: their expectation is 0 for noise, whatever its distribution, also if a
//! filter correlates neighbouring pixels, and positive for a difference that goes on over several pixels. Differences of
//! neighbouring pixels give the variance of these products.

use etalon_core::math::Rgb;
use etalon_core::raster::{Image, linear_from_srgb, srgb_from_linear};
use etalon_stats::Extremes;
use serde::Serialize;
use std::cmp::Ordering;
use std::rc::Rc;

/// A change of image `a`, or two, after which its difference from `b` is noise, next to nothing, or much less.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// What to do to `a`.
    pub change: String,
    /// Mean squared error after it, by that before.
    pub mse_left: f64,
    /// Whether what is left cannot be told from noise.
    pub leaves_noise: bool,
    /// Whether what is left is more than noise and rounding make.
    pub in_part: bool,
}

impl Explanation {
    /// The change, after "in part: " where it leaves more than noise.
    #[must_use]
    pub fn told(&self) -> String {
        format!("{}{}", if self.in_part { "in part: " } else { "" }, self.change)
    }
}

/// A change without its reason: "undo the sRGB curve in A".
#[must_use]
pub fn without_reason(change: &str) -> &str {
    change.split_once(": ").map_or(change, |(change, _)| change)
}

/// Standard errors beyond which a difference is more than noise, and within which a residual is noise.
const BEYOND: f64 = 6.0;
const WITHIN: f64 = 4.0;
/// A residual of this share of the difference need not be noise: it is what rounding to 8 bits and clamped noise leave.
const NEARLY_NOTHING: f64 = 0.005;
/// A residual of this share is explained in part.
const LITTLE: f64 = 0.1;
/// A residual that may be larger than this share (its error counted twice) explains nothing: the images are too noisy, or
/// they differ otherwise as well.
const MOST_LEFT: f64 = 0.25;
/// First changes after which a second is tried.
const FIRST: usize = 2;
/// Largest shift that is tried, in pixels.
const FARTHEST: usize = 8;
/// Rows of an image that tell its shift, about.
const ROWS: usize = 100;
/// As many equal largest values are a clamp.
const CLAMPED: usize = 4;

/// The change of `a`, among a few that people make by mistake, after which it differs from `b` by noise alone, or two of them if one does not
/// do; nothing if there is none, or if noise is all that they differ by. Images of one size.
#[must_use]
pub fn explain(a: &Image, b: &Image) -> Option<Explanation> {
    let grid = Grids::new(b);
    let before = grid.structure(a, b);
    let significance = |of: &Structure| of.energy / of.error;
    let main = (0..before.len()).max_by(|&i, &j| significance(&before[i]).total_cmp(&significance(&before[j])))?;
    let is_noise_alone = significance(&before[main]).partial_cmp(&BEYOND) != Some(Ordering::Greater);
    if is_noise_alone {
        // The same noise elsewhere?
        let same = rearranged(a).into_iter().find(|(_, image, _)| a != b && image() == *b);
        return same.map(|(change, ..)| Explanation { change, mse_left: 0.0, leaves_noise: true, in_part: false });
    }
    let left_of_main = |a: &Image, b: &Image| grid.0[main].structure(&residual(a, b), b.width());
    let try_one = |change: String, a: &Image, b: &Image| {
        let after = left_of_main(a, b);
        let is_small = after.energy + 2.0 * after.error <= MOST_LEFT * before[main].energy;
        let after = is_small.then(|| grid.structure(a, b))?;
        let is_noise = |of: &Structure| of.energy <= WITHIN * of.error;
        let is_within =
            |share: f64| after.iter().zip(&before).all(|(of, was)| is_noise(of) || of.energy <= share * was.energy);
        let [in_part, leaves_noise] = [!is_within(NEARLY_NOTHING), after.iter().all(is_noise)];
        // What two changes leave is compared by all of the residual
        let left: f64 = after.iter().map(|of| of.energy).sum();
        is_within(LITTLE).then(|| (left, Explanation { change, mse_left: mse(a, b), leaves_noise, in_part }))
    };
    let is_open = |found: &Option<Found>| found.as_ref().is_none_or(|(_, found)| found.in_part);
    // Factors of the channels, where what is found does not do
    let or_by_channel = |found: Option<Found>, first: &str, a: &Image| {
        if !is_open(&found) {
            return found;
        }
        let factors: Option<Vec<f32>> = (0..3).map(|c| grid.factor(a, b, &[c], None)).collect();
        let by_channel = factors.and_then(|factors| {
            let [red, green, blue] = [0, 1, 2].map(|c| factors[c]);
            let change = format!("{first}multiply R, G, B of A by {red:.4}, {green:.4}, {blue:.4}");
            try_one(change, &a.map(|p| p * Rgb::new(red, green, blue)), b)
        });
        least(found.into_iter().chain(by_channel))
    };
    // Plain changes first: a change with more freedom, or two changes, leave less of any difference
    let singles = candidates(a, b, &grid, None);
    let mut found = least(singles.iter().filter_map(|(change, image, _)| try_one(change.clone(), &image(), b)));
    let leaves_noise = |found: &Option<Found>| found.as_ref().is_some_and(|(_, found)| found.leaves_noise);
    if !leaves_noise(&found)
        && let Some(top) = clamp_level(a, b)
    {
        let clamp = |level: f32| clamped(b, level);
        let alone = try_one(format!("clamp B at {top}: no value of A is larger"), a, &clamp(top));
        let one = |(change, image, undo): Candidate<'_>| {
            let change = format!("{change}, and clamp B: no value of A is larger than {top}");
            try_one(change, &image(), &clamp(undo(top)))
        };
        let with = alone.or_else(|| least(candidates(a, b, &grid, Some(top)).into_iter().filter_map(one)));
        found = least(found.into_iter().chain(with));
    }
    found = or_by_channel(found, "", a);
    if is_open(&found) {
        // A wrong exposure hides that all else is right
        let with_factor = |image: Image| {
            let factor = grid.factor(&image, b, &[0, 1, 2], None).unwrap_or(1.0);
            left_of_main(&image.map(|p| p * factor), b).energy
        };
        let mut firsts: Vec<(f64, &Candidate)> = singles.iter().map(|first| (with_factor(first.1()), first)).collect();
        firsts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let second = |(_, (change, image, _)): &(f64, &Candidate)| {
            let image = image();
            let first = format!("{}, then ", without_reason(change));
            let all = candidates(&image, b, &grid, None);
            let all = all.into_iter().filter_map(|(change, of, _)| try_one(format!("{first}{change}"), &of(), b));
            or_by_channel(least(all), &first, &image)
        };
        let pair = least(firsts.iter().take(FIRST).filter_map(second));
        // Two changes have more freedom: they must explain all, and leave much less than one
        let most = found.as_ref().map_or(f64::INFINITY, |(left, _)| MOST_LEFT * left);
        found = pair.filter(|(left, pair)| !pair.in_part && *left <= most).or(found);
    }
    let (_, found) = found?;
    Some(Explanation { mse_left: found.mse_left / mse(a, b), ..found })
}

type Found = (f64, Explanation);

fn least(found: impl Iterator<Item = Found>) -> Option<Found> {
    found.min_by(|a, b| a.0.total_cmp(&b.0))
}

fn residual(a: &Image, b: &Image) -> Vec<Rgb> {
    a.pixels().iter().zip(b.pixels()).map(|(p, q)| *p - *q).collect()
}

fn mse(a: &Image, b: &Image) -> f64 {
    let errors = a.pixels().iter().zip(b.pixels()).map(|(p, q)| (*p - *q).as_dvec3().length_squared());
    errors.filter(|e| e.is_finite()).sum()
}

/// A change in words, what makes the changed image (one at a time: images may be large), and what it does to a value.
type Candidate<'a> = (String, Box<dyn Fn() -> Image + 'a>, Box<dyn Fn(f32) -> f32 + 'a>);

/// Turns of A, and its channels in another order.
fn rearranged(a: &Image) -> Vec<Candidate<'_>> {
    let (right, down) = (a.width() - 1, a.height() - 1);
    let mut list: Vec<Candidate> = Vec::new();
    let mut moved = |change: &str, at: fn([usize; 2], [usize; 2]) -> [usize; 2]| {
        let image = move || {
            Image::from_fn(a.width(), a.height(), |x, y| {
                let [x, y] = at([x, y], [right, down]);
                a.get(x, y)
            })
        };
        list.push((change.into(), Box::new(image), Box::new(|v| v)));
    };
    moved("flip A left to right", |[x, y], [right, _]| [right - x, y]);
    moved("flip A upside down", |[x, y], [_, down]| [x, down - y]);
    moved("rotate A by 180°", |[x, y], [right, down]| [right - x, down - y]);
    if right == down {
        moved("transpose A: swap its rows and columns", |[x, y], _| [y, x]);
        moved("rotate A by 90° clockwise", |[x, y], [right, _]| [y, right - x]);
        moved("rotate A by 90° counterclockwise", |[x, y], [right, _]| [right - y, x]);
        moved("transpose A and rotate it by 180°", |[x, y], [right, _]| [right - y, right - x]);
    }
    for (change, order) in [
        ("swap red and blue of A", [2, 1, 0]),
        ("swap red and green of A", [1, 0, 2]),
        ("swap green and blue of A", [0, 2, 1]),
        ("rotate the channels of A: its R, G, B are G, B, R of B", [2, 0, 1]),
        ("rotate the channels of A: its R, G, B are B, R, G of B", [1, 2, 0]),
    ] {
        let image = move || a.map(|p| Rgb::from_array(order.map(|c| p[c])));
        list.push((change.into(), Box::new(image), Box::new(|v| v)));
    }
    list
}

/// All single changes; of a B that will be clamped to what they make of `top`, if there is one.
fn candidates<'a>(a: &'a Image, b: &Image, grid: &Grids, top: Option<f32>) -> Vec<Candidate<'a>> {
    let mut list = rearranged(a);
    if let Some([dx, dy]) = shift(a, b, grid) {
        let (width, height) = (a.width(), a.height());
        let from = |at: usize, by: isize, length: usize| at.checked_add_signed(by).filter(|at| *at < length);
        let image = move || {
            Image::from_fn(width, height, |x, y| match (from(x, dx, width), from(y, dy, height)) {
                (Some(x), Some(y)) => a.get(x, y),
                _ => Rgb::NAN,
            })
        };
        let change = format!("shift A by {} pixels in x and {} in y", -dx, -dy);
        list.push((change, Box::new(image), Box::new(|v| v)));
    }
    let mut by_value = |change: String, f: Box<dyn Fn(f32) -> f32>| {
        let f = Rc::new(f);
        let of_image = f.clone();
        let image = move || a.map(|p| Rgb::from_array(p.to_array().map(|v| of_image(v))));
        list.push((change, Box::new(image), Box::new(move |v| f(v))));
    };
    for (change, f) in [
        ("undo the sRGB curve in A: its values are encoded, those of B linear", linear_from_srgb as fn(f32) -> f32),
        ("apply the sRGB curve to A: it is undone once more than in B", srgb_from_linear),
        ("undo a gamma of 2.2 in A: its values are encoded, those of B linear", |v| v.max(0.0).powf(2.2)),
        ("apply a gamma of 2.2 to A: it is undone once more than in B", |v| v.max(0.0).powf(1.0 / 2.2)),
    ] {
        by_value(change.into(), Box::new(f));
    }
    if let Some(top) = clamp_level(b, a) {
        by_value(
            format!("clamp A at {top}: no value of B is larger"),
            Box::new(move |v| if v > top { top } else { v }),
        );
    }
    if let Some(factor) = grid.factor(a, b, &[0, 1, 2], top) {
        by_value(format!("multiply A by {factor:.4}"), Box::new(move |v| v * factor));
    }
    if let Some(constant) = grid.constant(a, b) {
        by_value(format!("add {constant:.4} to A"), Box::new(move |v| v + constant));
    }
    list
}

/// The largest value of A, if several values are equal to it and B has larger ones.
fn clamp_level(a: &Image, b: &Image) -> Option<f32> {
    let values = |image: &'_ Image| {
        image.pixels().iter().flat_map(|p| p.to_array()).filter(|v| v.is_finite()).collect::<Vec<f32>>()
    };
    let (of_a, of_b) = (values(a), values(b));
    let top = of_a.iter().copied().reduce(f32::max)?;
    let is_clamped = top > 0.0 && of_a.iter().filter(|v| **v == top).count() >= CLAMPED;
    (is_clamped && of_b.iter().any(|v| *v > top)).then_some(top)
}

/// Where a falling function is 0; nothing where it has one sign.
fn root([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> f64) -> Option<f64> {
    let has_root = f(low) > 0.0 && f(high) < 0.0;
    if !has_root {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        *(if f(middle) > 0.0 { &mut low } else { &mut high }) = middle;
    }
    Some(0.5 * (low + high))
}

/// Steps that leave a millionth of an interval's width, and less.
const HALVINGS: usize = 40;
/// Logarithm of the largest factor.
const LARGEST_LOG: f64 = 12.0;
/// Fits of a factor to an image that is clamped by what the last fit says.
const CLAMPED_FITS: usize = 8;

/// An image with no value above `top`.
fn clamped(image: &Image, top: f32) -> Image {
    image.map(|p| if p.is_finite() { p.min(Rgb::splat(top)) } else { p })
}

/// The pixels by which [`shift`] moves, the one with the least error of the grey values; none if that is 0.
fn shift(a: &Image, b: &Image, grid: &Grids) -> Option<[isize; 2]> {
    let (width, height) = (b.width() as isize, b.height() as isize);
    let grey = |image: &Image| image.pixels().iter().map(|p| p.element_sum()).collect::<Vec<f32>>();
    let (of_a, of_b) = (grey(a), grey(b));
    let weights = grid.pixel_weights(b);
    let farthest = FARTHEST.min(b.width() / 4).min(b.height() / 4) as isize;
    let error = |[dx, dy]: [isize; 2]| {
        let (mut sum, mut count) = (0.0_f64, 0_usize);
        for y in (farthest..height - farthest).step_by(height as usize / ROWS + 1) {
            let row = |y: isize, x: isize| {
                ((y * width + x + farthest) as usize)..((y * width + x + width - farthest) as usize)
            };
            let pairs = of_a[row(y + dy, dx)].iter().zip(&of_b[row(y, 0)]).zip(&weights[row(y, 0)]);
            let errors = pairs.map(|((p, q), w)| ((p - q) * w).abs().min(1.0));
            let (s, n) = errors.filter(|e| !e.is_nan()).fold((0.0, 0), |(s, n), e| (s + e * e, n + 1));
            sum += f64::from(s);
            count += n;
        }
        sum / count as f64
    };
    let all = (-farthest..=farthest).flat_map(|dy| (-farthest..=farthest).map(move |dx| [dx, dy]));
    let best = all.map(|by| (error(by), by)).filter(|(e, _)| !e.is_nan()).min_by(|a, b| a.0.total_cmp(&b.0))?.1;
    (best != [0, 0]).then_some(best)
}

/// Blocks of pixels: of 2 by 2 for edges, and larger ones for what changes slowly, whose noise is less.
struct Grids(Vec<Grid>);

struct Grid {
    side: usize,
    columns: usize,
    rows: usize,
    /// The block of each pixel; none beyond the last whole block.
    of_pixel: Vec<Option<u32>>,
    /// What the residual of each block is measured by: about the radiance of B there.
    levels: Vec<f64>,
    /// The least level.
    floor: f64,
}

/// Products of the residual's means over blocks, by the levels of the blocks: their mean, and its standard error if the residual is noise.
struct Structure {
    energy: f64,
    error: f64,
}

/// Most blocks across an image, about, and the sides of the largest ones.
const BLOCKS: f64 = 50.0;
const SIDES: [usize; 2] = [2, 8];
/// The part of the image's level that keeps dark blocks from outweighing all others.
const FLOOR: f64 = 0.1;
/// Larger relative residuals count as this: a few bright pixels are no more than any other.
const LARGEST: f64 = 1.0;

impl Grids {
    fn new(b: &Image) -> Self {
        let side = ((b.pixels().len() as f64).sqrt() / BLOCKS).round() as usize;
        let mut sides = vec![SIDES[0], side.clamp(SIDES[0], SIDES[1])];
        sides.dedup();
        Self(sides.into_iter().map(|side| Grid::new(b, side)).collect())
    }

    fn structure(&self, a: &Image, b: &Image) -> Vec<Structure> {
        let residual = residual(a, b);
        self.0.iter().map(|grid| grid.structure(&residual, b.width())).collect()
    }

    /// One over the level, for each pixel.
    fn pixel_weights(&self, b: &Image) -> Vec<f32> {
        let grid = self.largest();
        let (width, height) = (b.width(), b.height());
        let at = |x: usize, y: usize| {
            (y / grid.side).min(grid.rows - 1) * grid.columns + (x / grid.side).min(grid.columns - 1)
        };
        (0..height)
            .flat_map(|y| (0..width).map(move |x| [x, y]))
            .map(|[x, y]| (1.0 / grid.levels[at(x, y)]) as f32)
            .collect()
    }

    /// The factor of A by which as many blocks are darker as brighter; if B is clamped, so it is by the factor of that value.
    fn factor(&self, a: &Image, b: &Image, channels: &[usize], top: Option<f32>) -> Option<f32> {
        let of_a = self.largest().means(a);
        let mut factor = 1.0_f32;
        for _ in 0..if top.is_some() { CLAMPED_FITS } else { 1 } {
            let of_b = self.largest().means(&top.map_or(b.clone(), |top| clamped(b, top * factor)));
            let log = root([-LARGEST_LOG, LARGEST_LOG], |log| {
                self.largest().balance(&of_a, &of_b, channels, |a| a * log.exp())
            })?;
            factor = log.exp() as f32;
        }
        Some(factor)
    }

    /// The same of a constant that is added.
    fn constant(&self, a: &Image, b: &Image) -> Option<f32> {
        let [of_a, of_b] = [a, b].map(|image| self.largest().means(image));
        let most = of_a
            .iter()
            .chain(&of_b)
            .flatten()
            .fold(0.0_f64, |most, v| if v.is_finite() { most.at_least(v.abs()) } else { most });
        root([-most, most], |constant| self.largest().balance(&of_a, &of_b, &[0, 1, 2], |a| a + constant))
            .map(|c| c as f32)
    }

    fn largest(&self) -> &Grid {
        &self.0[self.0.len() - 1]
    }
}

impl Grid {
    fn new(b: &Image, side: usize) -> Self {
        let (columns, rows) = ((b.width() / side).max(1), (b.height() / side).max(1));
        let block = |i: usize| {
            let [x, y] = [i % b.width() / side, i / b.width() / side];
            (x < columns && y < rows).then_some((y * columns + x) as u32)
        };
        let of_pixel = (0..b.pixels().len()).map(block).collect();
        let mut grid = Self { side, columns, rows, of_pixel, levels: vec![0.0; columns * rows], floor: 0.0 };
        let mut counts = vec![0.0; columns * rows];
        for (i, p) in b.pixels().iter().enumerate() {
            if let Some(block) = grid.block(i).filter(|_| p.is_finite()) {
                grid.levels[block] += p.as_dvec3().abs().element_sum() / 3.0;
                counts[block] += 1.0;
            }
        }
        grid.levels
            .iter_mut()
            .zip(counts)
            .for_each(|(level, count)| *level = if count > 0.0 { *level / count } else { 0.0 });
        // A small light does not raise the level of the image
        let typical = (grid.levels.iter().map(|level| level.sqrt()).sum::<f64>() / grid.levels.len() as f64).powi(2);
        grid.floor = FLOOR * typical;
        grid.levels.iter_mut().for_each(|level| *level += FLOOR * typical);
        grid
    }

    /// The means of the blocks; NaN without a finite pixel.
    fn means(&self, image: &Image) -> Vec<[f64; 3]> {
        let mut sums = vec![([0.0; 3], 0.0); self.levels.len()];
        for (i, p) in image.pixels().iter().enumerate() {
            if let Some(block) = self.block(i).filter(|_| p.is_finite()) {
                (0..3).for_each(|c| sums[block].0[c] += f64::from(p[c]));
                sums[block].1 += 1.0;
            }
        }
        sums.into_iter().map(|(sum, n)| sum.map(|v| v / n)).collect()
    }

    /// The sum over the blocks of the difference of B and changed A by their sum, which treats both alike and in which no block,
    /// however bright, has more weight than others.
    fn balance(&self, of_a: &[[f64; 3]], of_b: &[[f64; 3]], channels: &[usize], change: impl Fn(f64) -> f64) -> f64 {
        let relative = |a: f64, b: f64| (b - a) / (a.abs() + b.abs() + 2.0 * self.floor);
        let blocks = of_a.iter().zip(of_b);
        let values =
            blocks.flat_map(|(a, b)| channels.iter().map(move |&c| [a[c], b[c]])).map(|[a, b]| relative(change(a), b));
        values.filter(|v| v.is_finite()).sum()
    }

    fn block(&self, pixel: usize) -> Option<usize> {
        self.of_pixel[pixel].map(|block| block as usize)
    }

    fn structure(&self, residual: &[Rgb], width: usize) -> Structure {
        let blocks = self.levels.len();
        // By block: sums of the residual and its number of pixels, squares of differences of neighbours and their number
        let (mut sums, mut squares) = (vec![[0.0_f32; 3]; blocks], vec![[0.0_f32; 3]; blocks]);
        let (mut pixels, mut pairs) = (vec![0.0_f64; blocks], vec![0.0_f64; blocks]);
        for (i, r) in residual.iter().enumerate() {
            let Some(block) = self.block(i).filter(|_| r.is_finite()) else { continue };
            pixels[block] += 1.0;
            (0..3).for_each(|c| sums[block][c] += r[c]);
            let right = residual.get(i + 1).filter(|_| (i + 1) % width > 0);
            for other in [right, residual.get(i + width)].into_iter().flatten().filter(|other| other.is_finite()) {
                pairs[block] += 1.0;
                (0..3).for_each(|c| squares[block][c] += (r[c] - other[c]).powi(2));
            }
        }
        // The mean of a block by its level, and the variance of that
        let relative = |block: usize, c: usize| {
            let (n, level) = (pixels[block], self.levels[block]);
            let mean = f64::from(sums[block][c]) / n / level;
            let variance = 0.5 * f64::from(squares[block][c]) / pairs[block] / n / (level * level);
            (n > 0.0 && pairs[block] > 0.0)
                .then(|| [mean.within(-LARGEST, LARGEST), variance.at_most(LARGEST * LARGEST)])
        };
        let (mut energy, mut error, mut count) = (0.0, 0.0, 0.0);
        for c in 0..3 {
            let means: Vec<_> = (0..blocks).map(|block| relative(block, c)).collect();
            let mut variance = 0.0;
            for block in 0..blocks {
                let (x, y) = (block % self.columns, block / self.columns);
                let right = (x + 2 < self.columns).then_some(block + 2);
                let below = (y + 2 < self.rows).then_some(block + 2 * self.columns);
                for other in [right, below].into_iter().flatten() {
                    if let (Some([m, v]), Some([other_m, other_v])) = (means[block], means[other]) {
                        energy += m * other_m;
                        variance += v * other_v;
                        count += 1.0;
                    }
                }
            }
            // Channels share their noise: their errors add up
            error += variance.sqrt();
        }
        Structure { energy: energy / count, error: error / count }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use etalon_core::scene::{Request, builtin};
    use etalon_render::{Settings, Silent, render};

    type Edit = (&'static str, fn(&Image) -> Image);

    fn values(image: &Image, f: impl Fn(f32) -> f32) -> Image {
        image.map(|p| Rgb::from_array(p.to_array().map(&f)))
    }

    fn moved(image: &Image, at: impl Fn(usize, usize) -> [usize; 2]) -> Image {
        Image::from_fn(image.width(), image.height(), |x, y| {
            let [x, y] = at(x, y);
            image.get(x % image.width(), y % image.height())
        })
    }

    /// Parts of the change that undoes each edit.
    const EDITS: [Edit; 16] = [
        ("upside down", |a| a.clone().flipped_vertically()),
        ("left to right", |a| moved(a, |x, y| [a.width() - 1 - x, y])),
        ("rotate A by 180°", |a| moved(a, |x, y| [a.width() - 1 - x, a.height() - 1 - y])),
        ("red and blue", |a| a.map(|p| Rgb::new(p.z, p.y, p.x))),
        ("rotate the channels", |a| a.map(|p| Rgb::new(p.y, p.z, p.x))),
        ("multiply A by", |a| a.map(|p| 2.0 * p)),
        ("multiply A by", |a| a.map(|p| p / std::f32::consts::PI)),
        ("multiply A by", |a| a.map(|p| 1.1 * p)),
        ("multiply R, G, B", |a| a.map(|p| p * Rgb::new(1.2, 1.0, 0.9))),
        ("undo the sRGB", |a| values(a, srgb_from_linear)),
        ("undo the sRGB curve in A: its values are encoded, those of B linear, and clamp B", |a| {
            values(a, |v| srgb_from_linear(v.min(1.0)))
        }),
        ("apply the sRGB", |a| values(a, linear_from_srgb)),
        ("clamp B at 1", |a| values(a, |v| v.min(1.0))),
        ("add -0.0", |a| a.map(|p| p + Rgb::splat(0.05))),
        ("shift A by -1 pixels in x and 0 in y", |a| moved(a, |x, y| [x + a.width() - 1, y])),
        ("shift A by 3 pixels in x and -2 in y", |a| moved(a, |x, y| [x + 3, y + a.height() - 2])),
    ];

    /// Two edits at once, written down before any was tried, and parts of the changes that undo them. The last five had no part in the choice
    /// of constants.
    const PAIRS: [(Edit, &str); 10] = [
        (("left to right", |a| encoded(&moved(a, |x, y| [a.width() - 1 - x, y]))), "sRGB"),
        (("red and blue", |a| a.map(|p| 0.5 * Rgb::new(p.z, p.y, p.x))), "multiply A by"),
        (
            ("rotate A by 180°", |a| {
                let turned = moved(a, |x, y| [a.width() - 1 - x, a.height() - 1 - y]);
                values(&turned, |v| v.max(0.0).powf(1.0 / 2.2))
            }),
            "gamma of 2.2",
        ),
        (("undo the sRGB", |a| encoded(&a.map(|p| 2.0 * p))), "multiply A by"),
        (
            ("shift A by 3 pixels in x and -2 in y", |a| moved(a, |x, y| [x + 3, y + a.height() - 2]).map(|p| 1.2 * p)),
            "multiply A by",
        ),
        (("upside down", |a| a.clone().flipped_vertically().map(|p| Rgb::new(p.z, p.y, p.x))), "red and blue"),
        (("apply the sRGB", |a| moved(&values(a, linear_from_srgb), |x, y| [a.width() - 1 - x, y])), "left to right"),
        (("rotate the channels", |a| a.map(|p| Rgb::new(p.y, p.z, p.x) + Rgb::splat(0.05))), "add -0.0"),
        (("shift A by -1 pixels in x and 0 in y", |a| encoded(&moved(a, |x, y| [x + a.width() - 1, y]))), "sRGB"),
        (("upside down", |a| a.clone().flipped_vertically().map(|p| p * Rgb::new(1.2, 1.0, 0.9))), "multiply R, G, B"),
    ];

    fn encoded(image: &Image) -> Image {
        values(image, srgb_from_linear)
    }

    /// What no edit explains: the radiance is changed by a factor that depends on the place.
    const BIASES: [fn(f32, f32) -> f32; 3] = [
        |x, y| if x < 0.5 && y < 0.5 { 1.15 } else { 1.0 },
        |x, _| 1.0 + 0.15 * x,
        |x, _| if x < 0.6 { 1.1 } else { 1.0 },
    ];

    #[test]
    #[ignore = "takes seconds: cargo test -- --ignored"]
    fn edits_of_noisy_renders_are_named_and_nothing_else_is() {
        // With light above 1, which a clamp changes
        for (mut scene, request) in [builtin::cornell_lambert(), builtin::cornell_spheres()] {
            scene.camera.filter = "box".parse().unwrap();
            let image = |seed: u64, spp: u32| {
                let request = Request { width: 96, height: 72, spp, light_samples: 1, ..request };
                render(&scene, &request, &Settings { seed, ..Settings::usual() }, &Silent).unwrap().image
            };
            let a = image(1, 64);
            for b in [image(2, 64), image(3, 256)] {
                for (expected, edit) in EDITS {
                    let found = explain(&edit(&a), &b);
                    let is_named = found.as_ref().is_some_and(|found| found.change.contains(expected));
                    assert!(
                        is_named && found.as_ref().unwrap().leaves_noise,
                        "{}: {found:?}, not {expected}",
                        scene.name
                    );
                }
                for ((expected, edit), also) in PAIRS {
                    let found = explain(&edit(&a), &b);
                    let is_named = found.as_ref().is_some_and(|found| {
                        found.change.contains(expected) && found.change.contains(also) && !found.in_part
                    });
                    assert!(is_named, "{}: {found:?}, not {expected} and {also}", scene.name);
                }
                let place = |x: usize, y: usize| [x as f32 / 96.0, y as f32 / 72.0];
                for (i, bias) in BIASES.into_iter().enumerate() {
                    let biased = Image::from_fn(96, 72, |x, y| {
                        let [u, v] = place(x, y);
                        a.get(x, y) * bias(u, v)
                    });
                    assert_eq!(explain(&biased, &b), None, "{}, bias {i}", scene.name);
                }
                assert_eq!(explain(&a, &b), None, "{}: noise", scene.name);
                assert_eq!(explain(&image(4, 4), &b), None, "{}: more noise", scene.name);
            }
            assert_eq!(explain(&a, &a), None);
        }
    }

    #[test]
    fn without_noise_what_is_left_is_nothing() {
        let image = Image::from_fn(24, 16, |x, y| {
            let (x, y) = (x as f32, y as f32);
            Rgb::new(0.1 + 0.03 * x, 0.2 + 0.02 * y, 0.9 - 0.001 * x * y)
        });
        let found = explain(&image, &image.map(|p| 1.21 * p)).unwrap();
        assert!(found.change == "multiply A by 1.2100" && found.mse_left < 1e-6 && found.leaves_noise, "{found:?}");
        // A square image may be transposed; one that is black or has no numbers is not explained
        let square = Image::from_fn(20, 20, |x, y| image.get(x, y % 16));
        let transposed = Image::from_fn(20, 20, |x, y| square.get(y, x));
        assert!(explain(&transposed, &square).unwrap().change.starts_with("transpose A"));
        for nothing in [Image::new(24, 16), image.map(|_| Rgb::NAN)] {
            assert_eq!((explain(&image, &nothing), explain(&nothing, &image)), (None, None));
        }
        assert_eq!(explain(&Image::new(1, 1), &Image::new(1, 1).map(|_| Rgb::ONE)), None);
    }
}
