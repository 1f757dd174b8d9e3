//! Lines and areas cut to the frame, exactly: a curve that leaves the frame ends at its edge and in its own direction.
//!
//! Works on positions along both axes ([`super::axis::Span::position`]), where the frame is the unit square.

use super::shapes::Point;

/// The parts of a line that lie inside the unit square. A point that is not finite breaks the line.
pub(super) fn line(points: &[Point]) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((a, b)) = segment(pair[0], pair[1]) else {
            open = false;
            continue;
        };
        match parts.last_mut() {
            Some(part) if open => part.push(b),
            _ => parts.push(vec![a, b]),
        }
        open = b == pair[1];
    }
    parts
}

/// The part of a segment inside the unit square (Liang and Barsky, 1984).
fn segment(a: Point, b: Point) -> Option<(Point, Point)> {
    if !a.iter().chain(&b).all(|v| v.is_finite()) {
        return None;
    }
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let step = b[axis] - a[axis];
        if step == 0.0 {
            if !(0.0..=1.0).contains(&a[axis]) {
                return None;
            }
            continue;
        }
        let (t0, t1) = (-a[axis] / step, (1.0 - a[axis]) / step);
        start = start.max(t0.min(t1));
        end = end.min(t0.max(t1));
    }
    // Ends inside stay as they are, bit for bit
    let at = |t: f64| [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t].map(|v: f64| v.clamp(0.0, 1.0));
    let inside = |p: Point| p.iter().all(|v| (0.0..=1.0).contains(v));
    (start <= end).then(|| (if inside(a) { a } else { at(start) }, if inside(b) { b } else { at(end) }))
}

/// The part of a polygon inside the unit square (Sutherland and Hodgman, 1974); empty when there is none.
pub(super) fn polygon(points: Vec<Point>) -> Vec<Point> {
    let mut points = points;
    for (axis, limit, sign) in [(0, 0.0, 1.0), (0, 1.0, -1.0), (1, 0.0, 1.0), (1, 1.0, -1.0)] {
        let depth = |p: &Point| sign * (p[axis] - limit);
        let mut kept = Vec::with_capacity(points.len() + 4);
        for (i, b) in points.iter().enumerate() {
            let a = &points[(i + points.len() - 1) % points.len()];
            let (da, db) = (depth(a), depth(b));
            if (da < 0.0) != (db < 0.0) {
                let t = da / (da - db);
                let mut crossing = [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t];
                crossing[axis] = limit;
                kept.push(crossing);
            }
            if db >= 0.0 {
                kept.push(*b);
            }
        }
        points = kept;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_edge_and_broken_at_gaps() {
        let parts = line(&[[-0.5, 0.5], [0.5, 0.5], [0.5, 2.5], [0.8, 2.5], [0.8, -1.0]]);
        assert_eq!(parts, [vec![[0.0, 0.5], [0.5, 0.5], [0.5, 1.0]], vec![[0.8, 1.0], [0.8, 0.0]]]);
        let parts = line(&[[0.1, 0.1], [0.2, 0.2], [0.3, f64::NAN], [0.4, 0.4], [0.5, 0.5]]);
        assert_eq!(parts, [vec![[0.1, 0.1], [0.2, 0.2]], vec![[0.4, 0.4], [0.5, 0.5]]]);
        for nothing in [&[[0.5, f64::INFINITY], [0.5, 0.5]][..], &[[0.5, 0.5]], &[]] {
            assert!(line(nothing).is_empty(), "{nothing:?}");
        }
    }

    #[test]
    fn polygons_are_cut_at_the_edge() {
        let mut cut = polygon(vec![[-1.0, 0.25], [2.0, 0.25], [2.0, 0.75], [-1.0, 0.75]]);
        cut.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(cut, [[0.0, 0.25], [0.0, 0.75], [1.0, 0.25], [1.0, 0.75]]);
        assert!(polygon(vec![[2.0, 2.0], [3.0, 2.0], [3.0, 3.0]]).is_empty() && polygon(Vec::new()).is_empty());
    }
}
