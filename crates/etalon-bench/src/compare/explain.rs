//! What would explain the difference of two images: a turn, another order of channels, an exposure, a transfer function, a shift, a clamp.
//!
//! A mistake explains a difference if undoing it leaves nothing but noise. Noise is distinguished from differences by products of
//! the residual's means over blocks of pixels two blocks apart: their expectation is 0 for noise, whatever its distribution, also if a
//! filter correlates neighbouring pixels, and positive for a difference that goes on over several pixels. Differences of
//! neighbouring pixels give the variance of these products. Blocks with much noise have less weight: a factor of 1.1 shows in the sky
//! beside noisy shadows.

use etalon_core::math::Rgb;
use etalon_core::raster::{Image, linear_from_srgb, srgb_from_linear};
use etalon_stats::Extremes;
use serde::Serialize;
use std::cmp::Ordering;
use std::iter::StepBy;
use std::ops::Range;
use std::rc::Rc;

/// A mistake that image `a` may have, or two: undone, its difference from `b` is noise, next to nothing, or much less.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// What is wrong with `a`.
    pub mistake: String,
    /// What to do to `a`.
    pub change: String,
    /// Mean squared error after it, by that before; NaN where width and height were exchanged before.
    pub mse_left: f64,
    /// Whether what is left cannot be told from noise.
    pub leaves_noise: bool,
    /// Whether what is left is more than noise and rounding make.
    pub in_part: bool,
    /// Whether nothing is wrong except that `a` ends at a value, as integers do at 1.
    #[serde(skip)]
    pub is_clip_alone: bool,
    /// Whether the mistake says what undoes it.
    #[serde(skip)]
    is_obvious: bool,
    /// Whether two plain changes may explain more: for fitted exponents, and changes with a clamp.
    #[serde(skip)]
    is_tentative: bool,
}

impl Explanation {
    fn tentative(self) -> Self {
        Self { is_tentative: true, ..self }
    }

    /// The mistake, after "in part: " where undoing it leaves more than noise.
    pub fn headline(&self) -> String {
        format!("{}{}", if self.in_part { "in part: " } else { "" }, self.mistake)
    }

    /// The same, with what undoes it in brackets where that is not obvious.
    pub fn told(&self) -> String {
        let cure = if self.is_obvious { String::new() } else { format!(" ({})", self.change) };
        self.headline() + &cure
    }
}

/// Standard errors beyond which a difference is more than noise, and within which a residual is noise.
const BEYOND: f64 = 6.0;
const WITHIN: f64 = 4.0;
/// Standard errors by which a change with more freedom must leave less than a plain one.
const CLEARLY: f64 = 2.0;
/// A residual of this share of the difference need not be noise: it is what rounding to 8 bits and clamped noise leave.
const NEARLY_NOTHING: f64 = 0.005;
/// A residual of this share explains in part, if it is at most this share of the mean squared error, too.
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
/// The largest value that integers store.
const WHITE: f32 = 1.0;
/// Pixels that tell most wrong changes from right ones.
const SAMPLE: usize = 40_000;
/// Exponents are named 2.2 within this share: fits to noisy images are about as precise.
const NEAR: f64 = 0.01;

/// Changes of `a` that undo a mistake.
struct Change<'a> {
    mistake: String,
    cure: String,
    is_obvious: bool,
    /// A pixel of the changed image: images may be large, and most changes are told to be wrong by a part of it.
    pixel: Box<dyn Fn(usize, usize) -> Rgb + 'a>,
    value: Value,
}

type Value = Rc<dyn Fn(Rgb) -> Rgb>;

impl Change<'_> {
    fn image(&self, b: &Image) -> Image {
        Image::from_fn(b.width(), b.height(), &self.pixel)
    }

    fn explains(&self, mse_left: f64, [leaves_noise, in_part]: [bool; 2]) -> Explanation {
        let (mistake, change, is_obvious) = (self.mistake.clone(), self.cure.clone(), self.is_obvious);
        let (is_clip_alone, is_tentative) = (false, false);
        Explanation { mistake, change, mse_left, leaves_noise, in_part, is_clip_alone, is_obvious, is_tentative }
    }
}

/// What a change leaves.
struct Found {
    left: f64,
    error: f64,
    explanation: Explanation,
}

/// The values of A and of B above which nothing is known of them: infinite where they are not clipped.
#[derive(Clone, Copy)]
struct Clip {
    a: f32,
    b: f32,
}

impl Clip {
    /// The largest values that are known of both, in the changed image.
    fn after(self, value: &dyn Fn(Rgb) -> Rgb) -> Rgb {
        let of_a = if self.a.is_finite() { value(Rgb::splat(self.a)) } else { Rgb::INFINITY };
        of_a.min(Rgb::splat(self.b))
    }

    fn is_somewhere(self) -> bool {
        self.a.is_finite() || self.b.is_finite()
    }
}

fn clipped(p: Rgb, limit: Rgb) -> Rgb {
    if p.is_finite() { p.min(limit) } else { p }
}

/// Two images, and what is known of their difference before any change.
struct Pair<'a> {
    b: &'a Image,
    grid: &'a Grids,
    stored: [bool; 2],
    before: Vec<Structure>,
    /// The number of the grid by which the difference is most significant, and its sample.
    main: usize,
    sampled: f64,
    mse: f64,
}

/// What two images differ by.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// Noise, or nothing.
    Noise,
    Mistake(Explanation),
    /// Undoing some mistake leaves nothing but noise, which is too much to tell whether it is the one: the mean of A over that of B, with
    /// the half width of its interval of 95 %.
    Hidden([f64; 2]),
    /// Undoing each mistake leaves more than noise.
    Unknown,
}

impl Reason {
    pub fn explanation(self) -> Option<Explanation> {
        if let Self::Mistake(explanation) = self { Some(explanation) } else { None }
    }
}

/// The mistake, among a few that people make, after whose undoing `a` differs from `b` by noise alone, or two of them if one does not
/// do. Images of one size; `stored` says which are stored as integers, of an sRGB
/// curve: these are clipped at 1.
pub fn explain(a: &Image, b: &Image, stored: [bool; 2]) -> Reason {
    let grid = Grids::new(b, &[a, b]);
    let before = grid.structure(a, b);
    let significance = |of: &Structure| of.energy / of.error;
    let main = (0..before.len()).max_by(|&i, &j| significance(&before[i]).total_cmp(&significance(&before[j])));
    let Some(main) = main else { return Reason::Noise };
    let is_noise_alone = significance(&before[main]).partial_cmp(&BEYOND) != Some(Ordering::Greater);
    if is_noise_alone {
        // The same noise elsewhere?
        let is_b = |change: &Change| {
            b.pixels().iter().enumerate().all(|(i, p)| (change.pixel)(i % b.width(), i / b.width()) == *p)
        };
        let same = rearranged(a, b).into_iter().find(|change| a != b && is_b(change));
        return same.map_or(Reason::Noise, |change| Reason::Mistake(change.explains(0.0, [true, false])));
    }
    let sampled = grid.0[main].sampled_energy(b, &|x, y| a.get(x, y), Rgb::INFINITY);
    let pair = Pair { b, grid: &grid, stored, before, main, sampled, mse: mse(a, b) };
    // If A is clipped and B is not, the clipping is the mistake
    let of_stored = |is_clipped: bool| if is_clipped { WHITE } else { f32::INFINITY };
    let clip = Clip { a: of_stored(stored == [true; 2]), b: of_stored(stored[1]) };
    let is_open = |found: &Option<Found>| {
        found.as_ref().is_none_or(|Found { explanation, .. }| {
            // A curve that is nearly a power is not one, a constant light is no clamp, and what is left may be a shift, seen at edges
            let is_doubtful = explanation.is_tentative || explanation.mse_left > NEARLY_NOTHING;
            explanation.in_part || is_doubtful && !explanation.leaves_noise
        })
    };
    // Plain changes first: a change with more freedom, or two changes, leave less of any difference
    let singles = changes(a, b, &grid, clip);
    let mut found = pair.best(&singles, clip, |change| change);
    found = or_clearly_better(found, pair.best(&powers(&pair, a, clip), clip, Explanation::tentative));
    let leaves_noise = |found: &Option<Found>| found.as_ref().is_some_and(|found| found.explanation.leaves_noise);
    if !leaves_noise(&found)
        && let Some(top) = clamp_level(a, b)
    {
        let clip = Clip { a: top, ..clip };
        let clipped = Change {
            mistake: format!("A is clipped at {top}"),
            cure: format!("clamp B at {top}: no value of A is larger"),
            is_obvious: true,
            pixel: Box::new(|x, y| a.get(x, y)),
            value: Rc::new(|v| v),
        };
        let too = |of: Explanation| Explanation {
            mistake: format!("{}, and clipped at {top}", of.mistake),
            change: format!("{}, and clamp B: no value of A is larger than {top}", of.change),
            is_tentative: true,
            ..of
        };
        let of_clip = |explanation| Explanation { is_clip_alone: true, ..explanation };
        let alone =
            pair.try_one(&clipped, clip).map(|found| Found { explanation: of_clip(found.explanation), ..found });
        let with = alone.or_else(|| {
            let plain = pair.best(&changes(a, b, &grid, clip), clip, too);
            let with = or_clearly_better(plain, pair.best(&powers(&pair, a, clip), clip, too));
            // As of all that is two changes
            with.filter(|with| !with.explanation.in_part)
        });
        found = least(found.into_iter().chain(with));
    }
    // Factors of the channels, where what is found does not do
    if is_open(&found) {
        found = or_clearly_better(found, pair.best(by_channel(a, b, &grid, clip).as_slice(), clip, |change| change));
    }
    if is_open(&found) {
        // A wrong exposure hides that all else is right
        let with_factor = |change: &Change| grid.0[main].energy_with_factor(b, &change.pixel);
        let mut firsts: Vec<(f64, &Change)> = singles.iter().map(|first| (with_factor(first), first)).collect();
        firsts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let second = |(_, first): &(f64, &Change)| {
            let image = first.image(b);
            let both = |second: Explanation| Explanation {
                mistake: if first.mistake == second.mistake {
                    first.mistake.replace("once more", "twice more")
                } else {
                    format!("{}, and {}", first.mistake, second.mistake)
                },
                change: format!("{}, then {}", without_reason(&first.cure), second.change),
                is_obvious: first.is_obvious && second.is_obvious,
                ..second
            };
            let found = pair.best(&changes(&image, b, &grid, clip), clip, both);
            let found = or_clearly_better(found, pair.best(&powers(&pair, &image, clip), clip, both));
            if is_open(&found) {
                let factors = by_channel(&image, b, &grid, clip);
                return or_clearly_better(found, pair.best(factors.as_slice(), clip, both));
            }
            found
        };
        let two = least(firsts.iter().take(FIRST).filter_map(second));
        // Two changes have more freedom: they must explain all, and leave much less than one
        let most = found.as_ref().map_or(f64::INFINITY, |found| MOST_LEFT * found.left);
        found = two.filter(|two| !two.explanation.in_part && two.left <= most).or(found);
    }
    if let Some(found) = found {
        return Reason::Mistake(found.explanation);
    }
    let others = powers(&pair, a, clip).into_iter().chain(by_channel(a, b, &grid, clip));
    let is_open = singles.into_iter().chain(others).any(|change| pair.leaves_noise(&change, clip));
    if is_open { Reason::Hidden(grid.ratio_of_means(a, b)) } else { Reason::Unknown }
}

/// The turn or transposition of `a` after which it is as wide and high as `b`, and differs by noise or by next to nothing; `a` is as
/// wide as `b` is high, and as high as that is wide.
pub fn explain_turned(a: &Image, b: &Image) -> Option<Explanation> {
    let grid = Grids::new(b, &[b]);
    let turns = rearranged(a, b);
    if let Some(same) = turns.iter().find(|turn| turn.image(b) == *b) {
        return Some(same.explains(f64::NAN, [false, false]));
    }
    let left: Vec<Vec<Structure>> = turns.iter().map(|turn| grid.structure(&turn.image(b), b)).collect();
    let energy = |i: usize| left[i].iter().map(|of| of.energy).sum::<f64>();
    let best = (0..turns.len()).min_by(|&i, &j| energy(i).total_cmp(&energy(j)))?;
    let leaves_noise = left[best].iter().all(is_noise);
    // The others show how far a wrong turn is off
    let is_told = (0..turns.len()).filter(|i| *i != best).all(|other| {
        let pairs = || left[best].iter().zip(&left[other]);
        pairs().all(|(of, was)| is_noise(of) || of.energy <= NEARLY_NOTHING * was.energy)
            && pairs().any(|(_, was)| was.energy > BEYOND * was.error)
    });
    is_told.then(|| turns[best].explains(f64::NAN, [leaves_noise, false]))
}

/// Whether a residual cannot be told from noise.
fn is_noise(of: &Structure) -> bool {
    of.energy <= WITHIN * of.error
}

impl Pair<'_> {
    /// Whether a change leaves nothing but noise, much or little.
    fn leaves_noise(&self, change: &Change, clip: Clip) -> bool {
        let limit = clip.after(&*change.value);
        let clip = |image: Image| image.map(|p| clipped(p, limit));
        self.grid.0[self.main].sampled_energy(self.b, &change.pixel, limit) <= self.sampled
            && self.grid.structure(&clip(change.image(self.b)), &clip(self.b.clone())).iter().all(is_noise)
    }

    /// What a change leaves, if it explains the difference, or most of it.
    fn try_one(&self, change: &Change, clip: Clip) -> Option<Found> {
        let limit = clip.after(&*change.value);
        let main = &self.grid.0[self.main];
        // What makes a part of the image worse is no cure
        if main.sampled_energy(self.b, &change.pixel, limit) > self.sampled {
            return None;
        }
        let [a, b] = [change.image(self.b), self.b.clone()].map(|image| image.map(|p| clipped(p, limit)));
        let after = main.structure(&residual(&a, &b), b.width());
        if after.energy + 2.0 * after.error > MOST_LEFT * self.before[self.main].energy {
            return None;
        }
        let after = self.grid.structure(&a, &b);
        let is_within = |share: f64| {
            after.iter().zip(&self.before).all(|(of, was)| is_noise(of) || of.energy <= share * was.energy)
        };
        let [in_part, leaves_noise] = [!is_within(NEARLY_NOTHING), after.iter().all(is_noise)];
        let mse_left = mse(&a, &b) / self.mse;
        // What is told of it in numbers must be so, too; a factor multiplies noise
        let gain = f64::from(((change.value)(Rgb::ONE) - (change.value)(Rgb::ZERO)).max_element()).at_least(1.0);
        let most = if in_part { LITTLE } else { gain * gain };
        (is_within(LITTLE) && mse_left <= most).then(|| Found {
            left: after.iter().map(|of| of.energy).sum(),
            error: after.iter().map(|of| of.error).sum(),
            explanation: change.explains(mse_left, [leaves_noise, in_part]),
        })
    }

    fn best(&self, changes: &[Change], clip: Clip, told: impl Fn(Explanation) -> Explanation) -> Option<Found> {
        let found = least(changes.iter().filter_map(|change| self.try_one(change, clip)))?;
        Some(Found { explanation: told(found.explanation), ..found })
    }
}

fn least(found: impl Iterator<Item = Found>) -> Option<Found> {
    found.min_by(|a, b| a.left.total_cmp(&b.left))
}

/// The second, which has more freedom, only where it leaves clearly less.
fn or_clearly_better(plain: Option<Found>, free: Option<Found>) -> Option<Found> {
    let is_clear = |free: &Found| plain.as_ref().is_none_or(|plain| free.left + CLEARLY * free.error < plain.left);
    if free.as_ref().is_some_and(is_clear) { free } else { plain }
}

/// A change without its reason: "clamp B at 1".
fn without_reason(change: &str) -> &str {
    change.split_once(": ").map_or(change, |(change, _)| change)
}

fn residual(a: &Image, b: &Image) -> Vec<Rgb> {
    a.pixels().iter().zip(b.pixels()).map(|(p, q)| *p - *q).collect()
}

/// The mean over the pixels that are finite in both.
fn mse(a: &Image, b: &Image) -> f64 {
    let errors = a.pixels().iter().zip(b.pixels()).map(|(p, q)| (*p - *q).as_dvec3().length_squared());
    let (sum, count) = errors.filter(|e| e.is_finite()).fold((0.0, 0_usize), |(sum, n), e| (sum + e, n + 1));
    sum / count as f64
}

/// Decimals of a number with three digits that count.
fn decimals(value: f64) -> usize {
    (2.0 - value.abs().log10().floor()).within(0.0, 6.0) as usize
}

fn three_digits(value: f64) -> String {
    format!("{value:.0$}", decimals(value))
}

/// A number with three digits that count, and the half width of its interval, if that is not 0 in these digits: "1.11 ± 0.02".
pub fn with_interval(value: f64, half_width: f64) -> String {
    let half = format!("{half_width:.0$}", decimals(value));
    let is_known = half.contains(|c: char| ('1'..='9').contains(&c));
    three_digits(value) + &if is_known { format!(" ± {half}") } else { String::new() }
}

/// Turns of A, and its channels in another order; turns that make A as large as B.
fn rearranged<'a>(a: &'a Image, b: &Image) -> Vec<Change<'a>> {
    let last = [a.width() - 1, a.height() - 1];
    let is_like_b = (a.width(), a.height()) == (b.width(), b.height());
    let mut list: Vec<Change> = Vec::new();
    let mut add = |mistake: &str, cure: &str, pixel: Box<dyn Fn(usize, usize) -> Rgb + 'a>| {
        let value = Rc::new(|v| v);
        list.push(Change { mistake: mistake.into(), cure: cure.into(), is_obvious: true, pixel, value });
    };
    let mut moved = |mistake: &str, cure: &str, at: fn([usize; 2], [usize; 2]) -> [usize; 2]| {
        let pixel = move |x: usize, y: usize| {
            let [x, y] = at([x, y], last);
            a.get(x, y)
        };
        add(mistake, cure, Box::new(pixel));
    };
    if is_like_b {
        moved("A is mirrored left to right", "flip A left to right", |[x, y], [right, _]| [right - x, y]);
        moved("A is upside down", "flip A upside down", |[x, y], [_, down]| [x, down - y]);
        moved("A is turned by 180°", "rotate A by 180°", |[x, y], [right, down]| [right - x, down - y]);
    }
    if (a.width(), a.height()) == (b.height(), b.width()) {
        moved("rows and columns of A are exchanged", "transpose A: swap its rows and columns", |[x, y], _| [y, x]);
        moved("A is turned by 90° counterclockwise", "rotate A by 90° clockwise", |[x, y], [_, down]| [y, down - x]);
        moved("A is turned by 90° clockwise", "rotate A by 90° counterclockwise", |[x, y], [right, _]| {
            [right - y, x]
        });
        moved(
            "rows and columns of A are exchanged, and it is turned by 180°",
            "transpose A and rotate it by 180°",
            |[x, y], [right, down]| [right - y, down - x],
        );
    }
    if !is_like_b {
        return list;
    }
    for (mistake, cure, order) in [
        ("red and blue of A are exchanged", "swap red and blue of A", [2, 1, 0]),
        ("red and green of A are exchanged", "swap red and green of A", [1, 0, 2]),
        ("green and blue of A are exchanged", "swap green and blue of A", [0, 2, 1]),
        ("R, G, B of A are G, B, R of B", "rotate the channels of A: its R, G, B are G, B, R of B", [2, 0, 1]),
        ("R, G, B of A are B, R, G of B", "rotate the channels of A: its R, G, B are B, R, G of B", [1, 2, 0]),
    ] {
        let pixel = move |x: usize, y: usize| {
            let p = a.get(x, y);
            Rgb::from_array(order.map(|c| p[c]))
        };
        add(mistake, cure, Box::new(pixel));
    }
    list
}

/// A change of every value by itself.
fn by_value<'a>(
    a: &'a Image,
    mistake: String,
    cure: String,
    is_obvious: bool,
    f: impl Fn(Rgb) -> Rgb + 'static,
) -> Change<'a> {
    let value: Value = Rc::new(f);
    let of_pixel = value.clone();
    Change { mistake, cure, is_obvious, pixel: Box::new(move |x, y| of_pixel(a.get(x, y))), value }
}

/// All plain changes, of one number at most, which is fitted to what is not clipped.
fn changes<'a>(a: &'a Image, b: &Image, grid: &Grids, clip: Clip) -> Vec<Change<'a>> {
    let mut list = rearranged(a, b);
    if let Some([dx, dy]) = shift(a, b, grid) {
        let (width, height) = (a.width(), a.height());
        let from = |at: usize, by: isize, length: usize| at.checked_add_signed(by).filter(|at| *at < length);
        let pixel = move |x, y| match (from(x, dx, width), from(y, dy, height)) {
            (Some(x), Some(y)) => a.get(x, y),
            _ => Rgb::NAN,
        };
        let towards = |by: isize, [less, more]: [&str; 2]| {
            let pixels = if by.abs() == 1 { "pixel" } else { "pixels" };
            (by != 0).then(|| format!("{} {pixels} {}", by.abs(), if by < 0 { less } else { more }))
        };
        let ways = [towards(dx, ["to the left", "to the right"]), towards(dy, ["up", "down"])];
        let ways: Vec<String> = ways.into_iter().flatten().collect();
        list.push(Change {
            mistake: format!("A is shifted by {}", ways.join(" and ")),
            cure: format!("shift A by {} pixels in x and {} in y", -dx, -dy),
            is_obvious: true,
            pixel: Box::new(pixel),
            value: Rc::new(|v| v),
        });
    }
    for (mistake, cure, f) in [
        ("A is encoded by sRGB once more than B", "undo the sRGB curve in A", linear_from_srgb as fn(f32) -> f32),
        ("A is decoded by sRGB once more than B", "apply the sRGB curve to A", srgb_from_linear),
    ] {
        list.push(by_value(a, mistake.into(), cure.into(), false, move |p| Rgb::from_array(p.to_array().map(f))));
    }
    if let Some(top) = clamp_level(b, a) {
        let (mistake, cure) = (format!("B is clipped at {top}"), format!("clamp A at {top}: no value of B is larger"));
        list.push(by_value(a, mistake, cure, true, move |p| clipped(p, Rgb::splat(top))));
    }
    if let Some([factor, ..]) = grid.factors(a, b, true, clip) {
        let brighter = 1.0 / f64::from(factor);
        let half_width = brighter * grid.half_width_of_log_factor(a, b, factor, clip);
        let mistake = format!("A is {} times as bright as B", with_interval(brighter, half_width));
        list.push(by_value(a, mistake, format!("multiply A by {factor:.4}"), false, move |p| p * factor));
    }
    if let Some(constant) = grid.constant(a, b) {
        let way = if constant < 0.0 { "above" } else { "below" };
        let mistake = format!("every value of A is {} {way} that of B", three_digits(f64::from(constant.abs())));
        list.push(by_value(a, mistake, format!("add {constant:.4} to A"), false, move |p| p + constant));
    }
    list
}

/// A factor for each channel.
fn by_channel<'a>(a: &'a Image, b: &Image, grid: &Grids, clip: Clip) -> Option<Change<'a>> {
    let factors @ [red, green, blue] = grid.factors(a, b, false, clip)?;
    let times = factors.map(|factor| three_digits(1.0 / f64::from(factor))).join(", ");
    let mistake = format!("R, G, B of A are {times} times as bright as those of B");
    let cure = format!("multiply R, G, B of A by {red:.4}, {green:.4}, {blue:.4}");
    Some(by_value(a, mistake, cure, false, move |p| p * Rgb::from_array(factors)))
}

/// Powers whose exponents are fitted: of the values, of those that integers store, and in place of the sRGB curve by which these are read.
fn powers<'a>(pair: &Pair, a: &'a Image, clip: Clip) -> Vec<Change<'a>> {
    let linear: fn(f32) -> f32 = |v| v.max(0.0);
    let stored: fn(f32) -> f32 = |v| srgb_from_linear(v.max(0.0));
    let same: fn(f32) -> f32 = |v| v;
    let mut list = Vec::new();
    let mut add = |from: fn(f32) -> f32, to: fn(f32) -> f32, words: fn(&str, &str) -> [String; 2]| {
        let raised =
            move |exponent: f64| move |p: Rgb| Rgb::from_array(p.to_array().map(|v| to(from(v).powf(exponent as f32))));
        let Some(fitted) = pair.grid.exponent(pair, a, from, clip, &|exponent, p| raised(exponent)(p)) else { return };
        let known = [(2.2, ["1/2.2", "2.2"]), (1.0 / 2.2, ["2.2", "1/2.2"])];
        let known = known.into_iter().find(|(known, _)| (fitted / known).ln().abs() < NEAR);
        let (exponent, text) = known.map_or_else(
            || (fitted, [1.0 / fitted, fitted].map(three_digits)),
            |(exponent, text)| (exponent, text.map(str::to_owned)),
        );
        let [mistake, cure] = words(&text[0], &text[1]);
        list.push(by_value(a, mistake, cure, false, raised(exponent)));
    };
    // For integers, a power of the stored values is nearly one of the values
    if pair.stored != [true; 2] {
        add(linear, same, |of_b, of_a| {
            let mistake = match of_a {
                "2.2" => "A is encoded by a gamma of 2.2 once more than B".into(),
                "1/2.2" => "A is decoded by a gamma of 2.2 once more than B".into(),
                _ => format!("A is B to the power of {of_b}"),
            };
            [mistake, format!("raise A to the power of {of_a}")]
        });
    }
    if pair.stored[0] {
        add(stored, same, |_, of_a| {
            let mistake = format!("A is stored with a gamma of {of_a}, not with the sRGB curve");
            [mistake, format!("decode A by a gamma of {of_a}")]
        });
    }
    if pair.stored == [true; 2] {
        add(stored, linear_from_srgb, |of_b, of_a| {
            let mistake = format!("the stored values of A are those of B to the power of {of_b}");
            [mistake, format!("raise those of A to the power of {of_a}")]
        });
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
/// Logarithms of the largest factor and of the largest exponent.
const LARGEST_LOG: f64 = 12.0;
const LARGEST_EXPONENT: f64 = 2.0;
/// Fits to images that are clipped by what the last fit says, and to powers of noisy pixels; and the change after which no other is needed.
const FITS: usize = 20;
const SETTLED: f64 = 1e-4;
/// Half of the interval over which a derivative is a difference.
const STEP: f64 = 1e-3;

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
    /// What the residual of each block is measured by: about the radiance of B around it, or more where there is much noise.
    levels: Vec<f64>,
    /// The least level.
    floor: f64,
    /// What a block counts in fits: 1, or less where there is much noise.
    weights: Vec<f64>,
    /// Rows of blocks from one of the sample to the next.
    step: usize,
}

/// Products of the residual's means over blocks, by the levels of the blocks: their mean, and its standard error if the residual is noise.
struct Structure {
    energy: f64,
    error: f64,
}

/// By block: the sums of values and the number of pixels, the squares of differences of neighbours and their number.
struct Sums {
    sums: Vec<[f32; 3]>,
    pixels: Vec<f64>,
    squares: Vec<[f32; 3]>,
    pairs: Vec<f64>,
}

/// Most blocks across an image, about, and the sides of the largest ones.
const BLOCKS: f64 = 50.0;
const SIDES: [usize; 2] = [2, 8];
/// The part of the image's level that keeps dark blocks from outweighing all others; and noise of this part of a block's level
/// makes its weight less.
const FLOOR: f64 = 0.1;
/// Standard errors of an interval of 95 %.
const INTERVAL: f64 = 1.96;
/// The neighbourhood that tells a block's level and noise: at least so many pixels wide, with at most so many blocks on each side.
const AROUND: usize = 14;
const FAR: usize = 3;
/// Larger relative residuals count as this: a few bright pixels are no more than any other.
const LARGEST: f64 = 1.0;

impl Grids {
    /// For images like `b`, whose noise is that of the images `noisy`.
    fn new(b: &Image, noisy: &[&Image]) -> Self {
        let side = ((b.pixels().len() as f64).sqrt() / BLOCKS).round() as usize;
        let mut sides = vec![SIDES[0], side.clamp(SIDES[0], SIDES[1])];
        sides.dedup();
        Self(sides.into_iter().map(|side| Grid::new(b, noisy, side)).collect())
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

    /// The factors of A's channels, or the one of all `together`, by which as many blocks are darker as brighter, of what is not
    /// clipped by them.
    fn factors(&self, a: &Image, b: &Image, together: bool, clip: Clip) -> Option<[f32; 3]> {
        let grid = self.largest();
        let fitted = |by: [f32; 3], is_sample: bool| {
            let by = Rgb::from_array(by);
            let limit = clip.after(&|p| p * by);
            let [of_a, of_b] = [(a, limit / by), (b, limit)].map(|(image, limit)| {
                if is_sample { grid.sampled_means(b, &|x, y| image.get(x, y), limit) } else { grid.means(image, limit) }
            });
            let fit = |channels: &[usize]| {
                let log = root([-LARGEST_LOG, LARGEST_LOG], |log| {
                    grid.balance(&of_a, &of_b, channels, |a| a * log.exp(), |_| 1.0)
                });
                log.map(|log| log.exp() as f32)
            };
            Some(if together { [fit(&[0, 1, 2])?; 3] } else { [fit(&[0])?, fit(&[1])?, fit(&[2])?] })
        };
        let mut factors = [1.0; 3];
        for _ in 0..if clip.is_somewhere() { FITS } else { 0 } {
            let last = factors;
            factors = fitted(last, true)?;
            if factors.iter().zip(last).all(|(new, old)| f64::from(new / old - 1.0).abs() < SETTLED) {
                break;
            }
        }
        fitted(factors, false)
    }

    /// The half width of the interval of 95 % of the logarithm of [`factors`](Self::factors) of all channels together, from the residual,
    /// block by block: channels share their noise.
    fn half_width_of_log_factor(&self, a: &Image, b: &Image, factor: f32, clip: Clip) -> f64 {
        let (grid, factor) = (self.largest(), f64::from(factor));
        let limit = clip.after(&|p| p * factor as f32);
        let (of_a, of_b) = (grid.means(a, limit / factor as f32), grid.means(b, limit));
        let balance = |log: f64| grid.balance(&of_a, &of_b, &[0, 1, 2], |a| a * factor * log.exp(), |_| 1.0);
        let slope = (balance(STEP) - balance(-STEP)) / (2.0 * STEP);
        let of_block = |((a, b), weight): ((&[f64; 3], &[f64; 3]), &f64)| {
            weight * (0..3).map(|c| grid.relative(factor * a[c], b[c])).sum::<f64>()
        };
        let values = of_a.iter().zip(&of_b).zip(&grid.weights).map(of_block).filter(|v| v.is_finite());
        INTERVAL * values.map(|v| v * v).sum::<f64>().sqrt() / slope.abs()
    }

    /// The mean of A over that of B, and half of its interval of 95 %, from what blocks differ from that ratio.
    fn ratio_of_means(&self, a: &Image, b: &Image) -> [f64; 2] {
        let [of_a, of_b] = [a, b].map(|image| self.largest().means(image, Rgb::INFINITY));
        let sum = |values: &[f64; 3]| values.iter().sum::<f64>();
        let pairs = of_a.iter().zip(&of_b).map(|(a, b)| [sum(a), sum(b)]);
        let pairs: Vec<[f64; 2]> = pairs.filter(|[a, b]| (a + b).is_finite()).collect();
        let [all_of_a, all_of_b] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>());
        let ratio = all_of_a / all_of_b;
        let squares: f64 = pairs.iter().map(|[a, b]| (a - ratio * b).powi(2)).sum();
        [ratio, INTERVAL * squares.sqrt() / all_of_b.abs()]
    }

    /// The same of a constant that is added.
    fn constant(&self, a: &Image, b: &Image) -> Option<f32> {
        let [of_a, of_b] = [a, b].map(|image| self.largest().means(image, Rgb::INFINITY));
        let most = of_a
            .iter()
            .chain(&of_b)
            .flatten()
            .fold(0.0_f64, |most, v| if v.is_finite() { most.at_least(v.abs()) } else { most });
        root([-most, most], |constant| self.largest().balance(&of_a, &of_b, &[0, 1, 2], |a| a + constant, |_| 1.0))
            .map(|c| c as f32)
    }

    /// The same of an exponent: `raised` is a pixel of A whose values, by `base`, are raised to it.
    fn exponent(
        &self,
        pair: &Pair,
        a: &Image,
        base: fn(f32) -> f32,
        clip: Clip,
        raised: &dyn Fn(f64, Rgb) -> Rgb,
    ) -> Option<f64> {
        let grid = self.largest();
        let b = pair.b;
        let log_of = |v: f64| f64::from(base(v as f32)).at_least(f64::from(f32::MIN_POSITIVE)).ln();
        // Means of blocks stand for their pixels first
        let [of_a, of_b] = [a, b].map(|image| grid.means(image, Rgb::INFINITY));
        let of_mean = |exponent: f64, v: f64| f64::from(raised(exponent, Rgb::splat(v as f32)).x);
        let log = root([-LARGEST_EXPONENT, LARGEST_EXPONENT], |log| {
            grid.balance(&of_a, &of_b, &[0, 1, 2], |v| of_mean(log.exp(), v), log_of)
        })?;
        let main = &self.0[pair.main];
        let pixel = |log: f64| move |x: usize, y: usize| raised(log.exp(), a.get(x, y));
        let limit = |log: f64| clip.after(&|p| raised(log.exp(), p));
        if main.sampled_energy(b, &pixel(log), limit(log)) > pair.sampled {
            return None;
        }
        // The mean of powers is not the power of the mean: the last steps are by pixels, along secants
        let of_a = grid.sampled_means(b, &|x, y| a.get(x, y), Rgb::INFINITY);
        let balance = |log: f64| {
            let of_power = grid.sampled_means(b, &pixel(log), limit(log));
            let of_b = grid.sampled_means(b, &|x, y| b.get(x, y), limit(log));
            let terms = of_power.iter().flatten().zip(of_b.iter().flatten()).zip(of_a.iter().flatten());
            let term = |(i, ((a, b), of_a)): (usize, ((&f64, &f64), &f64))| {
                grid.weight(i / 3, of_b.len()) * grid.relative(*a, *b) * log_of(*of_a)
            };
            terms.enumerate().map(term).filter(|term| term.is_finite()).sum::<f64>()
        };
        let (mut old, mut new) = (log, log + 0.01);
        let mut at_old = balance(old);
        for _ in 0..FITS {
            let at_new = balance(new);
            let step = at_new * (new - old) / (at_new - at_old);
            if !step.is_finite() || step.abs() > LARGEST_EXPONENT {
                return None;
            }
            (old, at_old, new) = (new, at_new, new - step);
            if step.abs() < SETTLED {
                break;
            }
        }
        Some(new.exp())
    }

    fn largest(&self) -> &Grid {
        &self.0[self.0.len() - 1]
    }
}

impl Grid {
    fn new(b: &Image, noisy: &[&Image], side: usize) -> Self {
        let (columns, rows) = ((b.width() / side).max(1), (b.height() / side).max(1));
        let block = |i: usize| {
            let [x, y] = [i % b.width() / side, i / b.width() / side];
            (x < columns && y < rows).then_some((y * columns + x) as u32)
        };
        let of_pixel = (0..b.pixels().len()).map(block).collect();
        let mut grid = Self {
            side,
            columns,
            rows,
            of_pixel,
            levels: vec![0.0; columns * rows],
            floor: 0.0,
            weights: Vec::new(),
            step: b.pixels().len().div_ceil(SAMPLE).max(1),
        };
        let (levels, floor) = grid.levels_of(b);
        (grid.levels, grid.floor) = ((0..levels.len()).map(|block| grid.around(&levels, block)).collect(), floor);
        grid.weights = grid.noise(noisy).into_iter().map(|noise| 1.0 / (1.0 + noise / (FLOOR * FLOOR))).collect();
        grid.levels.iter_mut().zip(&grid.weights).for_each(|(level, weight)| *level /= weight.sqrt());
        grid
    }

    /// The radiance of each block above the floor, and the floor.
    fn levels_of(&self, image: &Image) -> (Vec<f64>, f64) {
        let (mut levels, mut counts) = (vec![0.0; self.levels.len()], vec![0.0; self.levels.len()]);
        for (i, p) in image.pixels().iter().enumerate() {
            if let Some(block) = self.block(i).filter(|_| p.is_finite()) {
                levels[block] += p.as_dvec3().abs().element_sum() / 3.0;
                counts[block] += 1.0;
            }
        }
        levels
            .iter_mut()
            .zip(counts)
            .for_each(|(level, count)| *level = if count > 0.0 { *level / count } else { 0.0 });
        // A small light does not raise the level of the image
        let typical = (levels.iter().map(|level| level.sqrt()).sum::<f64>() / levels.len() as f64).powi(2);
        levels.iter_mut().for_each(|level| *level += FLOOR * typical);
        (levels, FLOOR * typical)
    }

    /// The mean of the blocks around one. What weighs a block must not depend on its own noise, nor on that of the blocks two apart: noise of a
    /// skewed distribution would have another mean by its weights.
    fn around(&self, values: &[f64], block: usize) -> f64 {
        let (x, y) = (block % self.columns, block / self.columns);
        let reach = (1..FAR).find(|reach| (2 * reach + 1) * self.side >= AROUND).unwrap_or(FAR);
        let near = |at: usize, end: usize| at.saturating_sub(reach)..(at + reach + 1).min(end);
        let is_of_pair = |i: usize, j: usize| matches!((i.abs_diff(x), j.abs_diff(y)), (0, 0) | (2, 0) | (0, 2));
        let (mut sum, mut count) = (0.0, 0.0);
        for (j, i) in near(y, self.rows).flat_map(|j| near(x, self.columns).map(move |i| (j, i))) {
            if !is_of_pair(i, j) {
                sum += values[j * self.columns + i];
                count += 1.0;
            }
        }
        if count > 0.0 { sum / count } else { values[block] }
    }

    /// The variance of the mean of each block relative to its squared level, the sum over the images, by the differences of neighbours in the
    /// blocks around it. Relative to its own level, each image counts alike whatever its exposure, and bright samples alike in both.
    fn noise(&self, images: &[&Image]) -> Vec<f64> {
        let mut noise = vec![0.0; self.levels.len()];
        for image in images {
            let sums = self.sums(image.pixels(), image.width());
            let variance = |block: usize| {
                let squares = sums.squares[block].iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
                let variance = 0.5 * squares / sums.pairs[block] / sums.pixels[block];
                if variance.is_finite() { variance } else { 0.0 }
            };
            let variances: Vec<f64> = (0..noise.len()).map(variance).collect();
            let (levels, _) = self.levels_of(image);
            for (block, noise) in noise.iter_mut().enumerate() {
                let relative = self.around(&variances, block) / self.around(&levels, block).powi(2);
                *noise += if relative.is_finite() { relative } else { 0.0 };
            }
        }
        noise
    }

    /// The means of the blocks, of values that are clipped at a limit; NaN without a finite pixel.
    fn means(&self, image: &Image, limit: Rgb) -> Vec<[f64; 3]> {
        let mut sums = vec![([0.0; 3], 0.0); self.levels.len()];
        for (i, p) in image.pixels().iter().enumerate() {
            if let Some(block) = self.block(i).filter(|_| p.is_finite()) {
                let p = p.min(limit);
                (0..3).for_each(|c| sums[block].0[c] += f64::from(p[c]));
                sums[block].1 += 1.0;
            }
        }
        sums.into_iter().map(|(sum, n)| sum.map(|v| v / n)).collect()
    }

    /// The rows of blocks of which the sample consists.
    fn sampled_rows(&self) -> StepBy<Range<usize>> {
        (0..self.rows).step_by(self.step)
    }

    /// The weight of the i-th of `count` blocks, which are all or those of the sample.
    fn weight(&self, i: usize, count: usize) -> f64 {
        let step = if count == self.weights.len() { 1 } else { self.step };
        self.weights[i / self.columns * step * self.columns + i % self.columns]
    }

    /// The means of the blocks in a few rows of blocks, of pixels of an image as large as `b`.
    fn sampled_means(&self, b: &Image, pixel: &dyn Fn(usize, usize) -> Rgb, limit: Rgb) -> Vec<[f64; 3]> {
        let of_block = |row: usize, column: usize| {
            let (mut sum, mut count) = (glam::DVec3::ZERO, 0.0);
            for y in row * self.side..((row + 1) * self.side).min(b.height()) {
                for x in column * self.side..((column + 1) * self.side).min(b.width()) {
                    let p = pixel(x, y);
                    if p.is_finite() {
                        sum += p.min(limit).as_dvec3();
                        count += 1.0;
                    }
                }
            }
            (sum / count).to_array()
        };
        self.sampled_rows().flat_map(|row| (0..self.columns).map(move |column| of_block(row, column))).collect()
    }

    /// The energy of [`structure`](Self::structure) in the sample.
    fn sampled_energy(&self, b: &Image, pixel: &dyn Fn(usize, usize) -> Rgb, limit: Rgb) -> f64 {
        let of_a = self.sampled_means(b, pixel, limit);
        let of_b = self.sampled_means(b, &|x, y| b.get(x, y), limit);
        self.energy_of_means(&of_a, &of_b, 1.0)
    }

    /// The same after the best factor.
    fn energy_with_factor(&self, b: &Image, pixel: &dyn Fn(usize, usize) -> Rgb) -> f64 {
        let of_a = self.sampled_means(b, pixel, Rgb::INFINITY);
        let of_b = self.sampled_means(b, &|x, y| b.get(x, y), Rgb::INFINITY);
        let log =
            root([-LARGEST_LOG, LARGEST_LOG], |log| self.balance(&of_a, &of_b, &[0, 1, 2], |a| a * log.exp(), |_| 1.0));
        self.energy_of_means(&of_a, &of_b, log.map_or(1.0, f64::exp))
    }

    fn energy_of_means(&self, of_a: &[[f64; 3]], of_b: &[[f64; 3]], factor: f64) -> f64 {
        let (mut energy, mut count) = (0.0, 0.0);
        for (i, row) in self.sampled_rows().enumerate() {
            let relative = |column: usize, c: usize| {
                let at = i * self.columns + column;
                let difference = factor * of_a[at][c] - of_b[at][c];
                (difference / self.levels[row * self.columns + column]).within(-LARGEST, LARGEST)
            };
            for column in 0..self.columns.saturating_sub(2) {
                for c in 0..3 {
                    let product = relative(column, c) * relative(column + 2, c);
                    if product.is_finite() {
                        energy += product;
                        count += 1.0;
                    }
                }
            }
        }
        energy / count
    }

    /// The sum over the blocks of the difference of B and changed A by their sum, which treats both alike and in which no block,
    /// however bright, has more weight than others without noise, except for the `weight` that its value in A has.
    fn balance(
        &self,
        of_a: &[[f64; 3]],
        of_b: &[[f64; 3]],
        channels: &[usize],
        change: impl Fn(f64) -> f64,
        weight: impl Fn(f64) -> f64,
    ) -> f64 {
        let of_block = |(i, (a, b)): (usize, (&[f64; 3], &[f64; 3]))| {
            let values = channels.iter().map(|&c| self.relative(change(a[c]), b[c]) * weight(a[c]));
            self.weight(i, of_a.len()) * values.filter(|v| v.is_finite()).sum::<f64>()
        };
        of_a.iter().zip(of_b).enumerate().map(of_block).sum()
    }

    fn relative(&self, a: f64, b: f64) -> f64 {
        (b - a) / (a.abs() + b.abs() + 2.0 * self.floor)
    }

    fn block(&self, pixel: usize) -> Option<usize> {
        self.of_pixel[pixel].map(|block| block as usize)
    }

    fn sums(&self, values: &[Rgb], width: usize) -> Sums {
        let blocks = self.levels.len();
        let (mut sums, mut squares) = (vec![[0.0_f32; 3]; blocks], vec![[0.0_f32; 3]; blocks]);
        let (mut pixels, mut pairs) = (vec![0.0_f64; blocks], vec![0.0_f64; blocks]);
        for (i, r) in values.iter().enumerate() {
            let Some(block) = self.block(i).filter(|_| r.is_finite()) else { continue };
            pixels[block] += 1.0;
            (0..3).for_each(|c| sums[block][c] += r[c]);
            // Neighbours in the block itself
            let is_own = |other: &usize| *other < values.len() && self.of_pixel[*other] == self.of_pixel[i];
            let right = Some(i + 1).filter(|right| right % width > 0);
            let own = right.into_iter().chain([i + width]).filter(is_own).map(|other| values[other]);
            for other in own.filter(|other| other.is_finite()) {
                pairs[block] += 1.0;
                (0..3).for_each(|c| squares[block][c] += (r[c] - other[c]).powi(2));
            }
        }
        Sums { sums, pixels, squares, pairs }
    }

    fn structure(&self, residual: &[Rgb], width: usize) -> Structure {
        let blocks = self.levels.len();
        let Sums { sums, pixels, squares, pairs } = self.sums(residual, width);
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

    const FLOATS: [bool; 2] = [false; 2];

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
        ("undo the sRGB curve in A, and clamp B", |a| values(a, |v| srgb_from_linear(v.min(1.0)))),
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
            "power of 2.2",
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
    fn skewed_noise_is_noise() {
        use etalon_core::sampling::stream::{Independent, Stream};
        // One pixel in twenty has nearly all of the light, as of a small light that is met by chance
        let dots = |seed: u64| {
            Image::from_fn(240, 200, |x, y| {
                let [u, _] = Independent::new(seed, (240 * y + x) as u64, 0).pair(0);
                Rgb::splat(if u < 0.05 { 5.05 } else { 0.05 })
            })
        };
        let smooth = Image::from_fn(240, 200, |_, _| Rgb::splat(0.3));
        for seed in 1..9 {
            assert_eq!(explain(&smooth, &dots(seed), FLOATS), Reason::Noise, "seed {seed}, the reference has it");
            assert_eq!(explain(&dots(seed), &smooth, FLOATS), Reason::Noise, "seed {seed}");
            assert_eq!(explain(&dots(seed), &dots(99), FLOATS), Reason::Noise, "seed {seed}, both have it");
        }
    }

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
                    let found = explain(&edit(&a), &b, FLOATS).explanation();
                    let is_named = found.as_ref().is_some_and(|found| found.change.contains(expected));
                    assert!(
                        is_named && found.as_ref().unwrap().leaves_noise,
                        "{}: {found:?}, not {expected}",
                        scene.name
                    );
                }
                for ((expected, edit), also) in PAIRS {
                    let found = explain(&edit(&a), &b, FLOATS).explanation();
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
                    assert_eq!(explain(&biased, &b, FLOATS).explanation(), None, "{}, bias {i}", scene.name);
                }
                assert_eq!(explain(&a, &b, FLOATS).explanation(), None, "{}: noise", scene.name);
                assert_eq!(explain(&image(4, 4), &b, FLOATS).explanation(), None, "{}: more noise", scene.name);
            }
            assert_eq!(explain(&a, &a, FLOATS).explanation(), None);
        }
    }

    /// A gradient with texture and noise of 5 %, and a light of 20 times its radiance.
    fn textured(seed: u64) -> Image {
        use etalon_core::sampling::stream::{Independent, Stream};
        Image::from_fn(96, 72, |x, y| {
            let [u, v] = Independent::new(seed, (96 * y + x) as u64, 0).pair(0).map(|u| 1.0 + 0.17 * (u as f32 - 0.5));
            let (s, t) = (x as f32 / 96.0, y as f32 / 72.0);
            let texture = 0.3 + 0.2 * (20.0 * s).sin() * (13.0 * t).cos();
            let light = if (30..40).contains(&x) && y < 6 { 12.0 } else { 0.0 };
            Rgb::new(u * (texture + 0.4 * s), v * (texture + 0.3 * t), u * (0.9 * texture + 0.1)) + Rgb::splat(light)
        })
    }

    /// A sky with next to no noise above a ground whose noise is as large as its radiance.
    fn noisy_ground(seed: u64, factor: f32) -> Image {
        use etalon_core::sampling::stream::{Independent, Stream};
        Image::from_fn(64, 48, |x, y| {
            let noise = Independent::new(seed, (64 * y + x) as u64, 0).pair(0).map(|u| 3.4 * (u as f32 - 0.5));
            let noise = Rgb::new(noise[0], noise[0], noise[1]) * if y < 16 { 0.01 } else { 1.0 };
            (Rgb::ONE + noise) * factor * (0.2 + x as f32 / 64.0) * Rgb::new(0.4, 0.5, 0.7)
        })
    }

    #[test]
    fn a_factor_is_named_that_shows_where_there_is_little_noise() {
        for factor in [0.9, 1.1, 1.3] {
            let found = explain(&noisy_ground(1, factor), &noisy_ground(2, 1.0), FLOATS).explanation().unwrap();
            assert!(found.mistake.starts_with(&format!("A is {factor}")) && found.leaves_noise, "{found:?}");
        }
        assert_eq!(explain(&noisy_ground(1, 1.0), &noisy_ground(2, 1.0), FLOATS), Reason::Noise);
    }

    #[test]
    fn what_noise_hides_is_not_said_to_be_no_mistake() {
        // Noise everywhere: the factor is told from 1, and not from a constant
        let noisy = |seed: u64, factor: f32| {
            use etalon_core::sampling::stream::{Independent, Stream};
            Image::from_fn(64, 48, |x, y| {
                // Exponentially distributed, as few samples of a light are
                let u = Independent::new(seed, (64 * y + x) as u64, 0).pair(0)[0] as f32;
                Rgb::splat(factor * -(1.0 - u).ln())
            })
        };
        for factor in [1.1f32, 1.15, 1.2, 1.3, 1.5, 1.8] {
            let (a, b) = (noisy(1, factor), noisy(2, 1.0));
            assert_ne!(explain(&a, &b, FLOATS), Reason::Unknown, "{factor}");
            let [ratio, half_width] = Grids::new(&b, &[&a, &b]).ratio_of_means(&a, &b);
            assert!(
                (ratio - f64::from(factor)).abs() < 2.0 * half_width && half_width < 0.1 * ratio,
                "{ratio} ± {half_width}"
            );
        }
        // A part that is brighter, which no change undoes
        let b = textured(2);
        let a = textured(1);
        let part = Image::from_fn(96, 72, |x, y| a.get(x, y) * if x < 48 && y < 36 { 1.5 } else { 1.0 });
        assert_eq!(explain(&part, &b, FLOATS), Reason::Unknown);
    }

    #[test]
    fn exponents_are_fitted_and_nothing_is_told_that_leaves_more() {
        let b = textured(2);
        for (exponent, expected) in [
            (1.0 / 1.3, "A is B to the power of 0.77"),
            (1.0 / 1.5, "A is B to the power of 0.66"),
            (1.0 / 1.8, "A is B to the power of 0.55"),
            (1.0 / 2.2, "A is encoded by a gamma of 2.2 once more than B"),
            (2.2, "A is decoded by a gamma of 2.2 once more than B"),
            (1.6, "A is B to the power of 1."),
        ] {
            let found = explain(&values(&textured(1), |v| v.powf(exponent)), &b, FLOATS).explanation().unwrap();
            assert!(found.mistake.starts_with(expected) && found.leaves_noise, "{exponent}: {found:?}");
        }
        // A curve that no change undoes, of images with a light that makes most of the squared error
        let curves: [fn(f32) -> f32; 4] =
            [|v| v / (1.0 + v), |v| v.powf(0.7) + 0.1, |v| if v < 1.0 { v.sqrt() } else { v }, |v| v * v.min(1.0)];
        for (i, curve) in curves.into_iter().enumerate() {
            if let Reason::Mistake(found) = explain(&values(&textured(1), curve), &b, FLOATS) {
                assert!(found.mse_left <= if found.in_part { LITTLE } else { 1.0 }, "{i}: {found:?}");
            }
        }
    }

    #[test]
    fn integers_are_compared_where_neither_image_is_clipped() {
        let stored = |image: &Image, f: &dyn Fn(f32) -> f32| {
            values(image, |v| linear_from_srgb((srgb_from_linear(f(v)).clamp(0.0, 1.0) * 255.0).round() / 255.0))
        };
        let (a, b) = (textured(1).map(|p| 1.4 * p), stored(&textured(2).map(|p| 1.4 * p), &|v| v));
        let mistake = |f: &dyn Fn(f32) -> f32| {
            let found = explain(&stored(&a, f), &b, [true; 2]);
            found.explanation().map(|found| found.mistake).unwrap_or_default()
        };
        for (expected, f) in [
            ("A is 1.1", (|v| 1.1 * v) as fn(f32) -> f32),
            ("A is 0.8", |v| 0.8 * v),
            ("A is 2.", |v| 2.0 * v),
            ("A is stored with a gamma of 1.8", |v| linear_from_srgb(v.clamp(0.0, 1.0).powf(1.0 / 1.8))),
            ("the stored values of A are those of B to the power of 1.2", |v| {
                linear_from_srgb(srgb_from_linear(v.clamp(0.0, 1.0)).powf(1.25))
            }),
        ] {
            let found = mistake(&f);
            assert!(found.starts_with(expected), "{found:?}, not {expected}");
        }
        assert_eq!(mistake(&|v| v), "");
        // Floats against integers: the factor is that of what is not clipped
        let floats = |factor: f32| {
            let found = explain(&a.map(|p| factor * p), &b, [false, true]);
            found.explanation().map(|found| found.mistake).unwrap_or_default()
        };
        for factor in [0.5, 2.0, 3.0] {
            assert!(floats(factor).starts_with(&format!("A is {factor:.2}")), "{factor}: {}", floats(factor));
        }
        let bright = [1, 2].map(|seed| textured(seed).map(|p| 4.0 * p));
        let found = explain(&bright[0], &stored(&bright[1], &|v| v), [false, true]).explanation().unwrap();
        assert_eq!(found.mistake, "B is clipped at 1");
    }

    #[test]
    fn turns_are_found_where_width_and_height_are_exchanged() {
        let (a, b) = (textured(1), textured(2));
        let [right, down] = [a.width() - 1, a.height() - 1];
        let turned = |at: &dyn Fn(usize, usize) -> [usize; 2]| {
            let image = Image::from_fn(a.height(), a.width(), |x, y| {
                let [x, y] = at(x, y);
                a.get(x, y)
            });
            explain_turned(&image, &b).map(|found| found.mistake)
        };
        let clockwise = turned(&|x, y| [y, down - x]);
        assert_eq!(clockwise.as_deref(), Some("A is turned by 90° clockwise"));
        let counterclockwise = turned(&|x, y| [right - y, x]);
        assert_eq!(counterclockwise.as_deref(), Some("A is turned by 90° counterclockwise"));
        assert_eq!(turned(&|x, y| [y, x]).as_deref(), Some("rows and columns of A are exchanged"));
        // Another image
        assert_eq!(turned(&|x, y| [(y + 40) % 96, x]), None);
    }

    #[test]
    fn without_noise_what_is_left_is_nothing() {
        let image = Image::from_fn(24, 16, |x, y| {
            let (x, y) = (x as f32, y as f32);
            Rgb::new(0.1 + 0.03 * x, 0.2 + 0.02 * y, 0.9 - 0.001 * x * y)
        });
        let found = explain(&image, &image.map(|p| 1.21 * p), FLOATS).explanation().unwrap();
        assert!(found.change == "multiply A by 1.2100" && found.mse_left < 1e-6 && found.leaves_noise, "{found:?}");
        // A square image may be transposed; one that is black or has no numbers is not explained
        let square = Image::from_fn(20, 20, |x, y| image.get(x, y % 16));
        let transposed = Image::from_fn(20, 20, |x, y| square.get(y, x));
        assert!(explain(&transposed, &square, FLOATS).explanation().unwrap().change.starts_with("transpose A"));
        for nothing in [Image::new(24, 16), image.map(|_| Rgb::NAN)] {
            assert_eq!(
                (explain(&image, &nothing, FLOATS).explanation(), explain(&nothing, &image, FLOATS).explanation()),
                (None, None)
            );
        }
        assert_eq!(explain(&Image::new(1, 1), &Image::new(1, 1).map(|_| Rgb::ONE), FLOATS).explanation(), None);
    }
}
