//! Which samples of a render a film holds: ranges of sample numbers, the same for all pixels.

use std::fmt;
use std::ops::Range;

/// The samples of shard `i` (from 1) of `n`: as nearly equal numbers as can be, all `spp` samples together.
pub fn shard(i: u32, n: u32, spp: u32) -> Range<u32> {
    let end = |i: u32| (u64::from(i) * u64::from(spp) / u64::from(n.max(1))) as u32;
    end(i.saturating_sub(1).min(n))..end(i.min(n))
}

/// What a film holds of a render of [`spp`](Self::spp) samples for each pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ranges {
    spp: u32,
    /// Samples that every pixel has had: sorted, without gaps of length 0.
    done: Vec<Range<u32>>,
    /// Samples of which each pixel has had some, from the first on; how many, its count tells.
    begun: Option<Range<u32>>,
}

impl Ranges {
    /// Nothing of a render of `spp` samples.
    pub fn none(spp: u32) -> Self {
        Self { spp, done: Vec::new(), begun: None }
    }

    /// The samples of each pixel that make the whole render.
    pub fn spp(&self) -> u32 {
        self.spp
    }

    /// The ranges that every pixel has had.
    pub fn done(&self) -> &[Range<u32>] {
        &self.done
    }

    /// The range at which an interrupted render was.
    pub fn begun(&self) -> Option<Range<u32>> {
        self.begun.clone()
    }

    /// How many samples every pixel has had.
    pub fn samples(&self) -> u32 {
        self.done.iter().map(|r| r.end - r.start).sum()
    }

    pub fn is_complete(&self) -> bool {
        self.samples() == self.spp
    }

    /// The ranges that some pixel has not had (whole): what is not [`done`](Self::done).
    pub fn missing(&self) -> Vec<Range<u32>> {
        let starts = [0].into_iter().chain(self.done.iter().map(|r| r.end));
        let ends = self.done.iter().map(|r| r.start).chain([self.spp]);
        starts.zip(ends).map(|(start, end)| start..end).filter(|r| !r.is_empty()).collect()
    }

    /// Whether every pixel has had all samples of a range.
    pub fn have(&self, range: &Range<u32>) -> bool {
        range.is_empty() || self.done.iter().any(|r| r.start <= range.start && range.end <= r.end)
    }

    /// The same samples as some of a render of `spp`; `None` where they go beyond it.
    pub(super) fn of(self, spp: u32) -> Option<Self> {
        Some(Self { spp, ..self }).filter(Self::is_sound)
    }

    /// The number of samples with which a pixel is up to date.
    pub(super) fn target(&self) -> u32 {
        self.samples() + self.begun.as_ref().map_or(0, |r| r.end - r.start)
    }

    /// The range to work on: the one that was begun, or else the first missing one within `within`.
    pub(super) fn begin(&mut self, within: &Range<u32>) -> Option<Range<u32>> {
        if self.begun.is_none() {
            let overlaps = self.missing().into_iter().filter_map(|r| intersection(&r, within));
            self.begun = overlaps.into_iter().next();
        }
        self.begun.clone()
    }

    /// Says that all pixels have had the range that was begun.
    pub(super) fn finish(&mut self) {
        let begun = self.begun.take();
        self.insert(begun);
    }

    /// Samples that both hold, or began to.
    pub fn overlap(&self, other: &Self) -> Option<Range<u32>> {
        let held = |ranges: &Self| ranges.done.iter().cloned().chain(ranges.begun()).collect::<Vec<_>>();
        let theirs = held(other);
        held(self).iter().find_map(|mine| theirs.iter().find_map(|theirs| intersection(mine, theirs)))
    }

    /// Adds what `other` holds. There must be no overlap, and not more than one range that was only begun.
    pub(super) fn merge(&mut self, other: Self) {
        self.insert(other.done);
        self.begun = self.begun.take().or(other.begun);
    }

    fn insert(&mut self, ranges: impl IntoIterator<Item = Range<u32>>) {
        let mut all: Vec<Range<u32>> = std::mem::take(&mut self.done).into_iter().chain(ranges).collect();
        all.sort_by_key(|r| r.start);
        for range in all {
            match self.done.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => self.done.push(range),
            }
        }
    }

    /// Reads what `Display` wrote.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let (ranges, spp) = text.rsplit_once("of ")?;
        let (done, begun) = ranges.split_once("begun ").map_or((ranges, None), |(done, begun)| (done, Some(begun)));
        let range = |text: &str| {
            let (start, end) = text.trim().split_once("..")?;
            let range = start.parse().ok()?..end.parse().ok()?;
            (!range.is_empty()).then_some(range)
        };
        let begun = match begun {
            Some(text) => Some(range(text)?),
            None => None,
        };
        let mut parsed = Self::none(spp.parse().ok()?);
        parsed.insert(done.split_whitespace().map(range).collect::<Option<Vec<_>>>()?);
        parsed.begun = begun;
        parsed.is_sound().then_some(parsed)
    }

    /// Whether the ranges are apart from each other and within the render.
    fn is_sound(&self) -> bool {
        let mut all: Vec<Range<u32>> = self.done.iter().cloned().chain(self.begun()).collect();
        all.sort_by_key(|r| r.start);
        all.is_sorted_by(|a, b| a.end <= b.start) && all.last().is_none_or(|r| r.end <= self.spp)
    }
}

fn intersection(a: &Range<u32>, b: &Range<u32>) -> Option<Range<u32>> {
    let common = a.start.max(b.start)..a.end.min(b.end);
    (!common.is_empty()).then_some(common)
}

/// Ranges separated by blanks, as in a message.
pub fn list(ranges: &[Range<u32>]) -> String {
    ranges.iter().map(|r| format!("{}..{}", r.start, r.end)).collect::<Vec<_>>().join(" ")
}

impl fmt::Display for Ranges {
    /// For example `0..16 32..48 begun 48..64 of 64`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for range in &self.done {
            write!(f, "{}..{} ", range.start, range.end)?;
        }
        if let Some(range) = &self.begun {
            write!(f, "begun {}..{} ", range.start, range.end)?;
        }
        write!(f, "of {}", self.spp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_all_samples_once() {
        for (n, spp) in [(1, 64), (3, 64), (7, 5), (64, 64), (1000, 999), (u32::MAX, u32::MAX), (3, u32::MAX)] {
            assert_eq!((shard(1, n, spp).start, shard(n, n, spp).end), (0, spp));
            for i in 1..n.min(2000) {
                let (one, next) = (shard(i, n, spp), shard(i + 1, n, spp));
                assert_eq!(one.end, next.start);
                assert!(one.len().abs_diff(next.len()) <= 1, "{i} of {n}, {spp}");
            }
        }
        assert_eq!(shard(2, 4, 10), 2..5);
    }

    #[test]
    fn ranges_join_and_gaps_are_named() {
        let mut ranges = Ranges::none(64);
        assert_eq!(list(&ranges.missing()), "0..64");
        for range in [32..48, 0..16, 16..20] {
            assert_eq!(ranges.begin(&range), Some(range));
            assert_eq!(ranges.begin(&(0..64)), ranges.begun(), "the range that was begun comes first");
            ranges.finish();
        }
        assert_eq!((ranges.done(), ranges.samples()), (&[0..20, 32..48][..], 36));
        assert_eq!(ranges.missing(), [20..32, 48..64]);
        assert_eq!(ranges.begin(&(10..40)), Some(20..32));
        ranges.finish();
        assert_eq!(ranges.begin(&(0..48)), None);
        assert_eq!(ranges.begin(&(0..64)), Some(48..64));
        ranges.finish();
        assert!(ranges.is_complete() && ranges.missing().is_empty());
        assert_eq!(ranges.to_string(), "0..64 of 64");
    }

    #[test]
    fn ranges_are_had_as_a_whole_and_can_be_of_more() {
        let ranges = Ranges::parse("0..16 32..48 begun 48..60 of 64").unwrap();
        for (range, expected) in [(0..16, true), (33..48, true), (15..17, false), (16..32, false), (48..49, false)] {
            assert_eq!(ranges.have(&range), expected, "{range:?}");
        }
        assert!(ranges.have(&(70..70)));
        assert_eq!(ranges.clone().of(100).unwrap().to_string(), "0..16 32..48 begun 48..60 of 100");
        assert!(ranges.clone().of(60).is_some() && ranges.of(59).is_none());
    }

    #[test]
    fn texts_can_be_read_back() {
        for text in ["of 64", "0..64 of 64", "0..16 32..48 begun 48..64 of 64", "begun 0..1 of 1"] {
            assert_eq!(Ranges::parse(text).map(|r| r.to_string()).as_deref(), Some(text));
        }
        for text in [
            "",
            "64",
            "0..65 of 64",
            "0..8 4..12 of 64",
            "8..4 of 64",
            "0..0 of 4",
            "0..8 begun 7..9 of 64",
            "-1..2 of 4",
        ] {
            assert_eq!(Ranges::parse(text), None, "{text}");
        }
    }

    #[test]
    fn overlaps_are_found() {
        let of = |text: &str| Ranges::parse(text).unwrap();
        let a = of("0..16 32..48 of 64");
        assert_eq!(a.overlap(&of("16..32 begun 48..64 of 64")), None);
        assert_eq!(a.overlap(&of("10..20 of 64")), Some(10..16));
        assert_eq!(of("begun 40..50 of 64").overlap(&a), Some(40..48));
    }
}
