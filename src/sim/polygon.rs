//! Convex polygons in a plane: the hull of points, and one polygon cut to another.

/// x, y.
pub(super) type Point = [f64; 2];

/// The convex hull, counter-clockwise (Andrew's monotone chain).
pub(super) fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut hull = half_hull(points.iter());
    hull.extend(half_hull(points.iter().rev()));
    hull
}

/// The lower half of the hull of sorted points, without its last point (which begins the other half).
fn half_hull<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Point> {
    let mut half: Vec<Point> = Vec::new();
    for &point in points {
        while let [.., before, last] = half[..] {
            if side(before, last, point) > 0.0 {
                break;
            }
            half.pop();
        }
        half.push(point);
    }
    half.pop();
    half
}

/// The part of a convex `polygon` within a convex, counter-clockwise `window` (Sutherland and Hodgman).
pub(super) fn clip(polygon: &[Point], window: &[Point]) -> Vec<Point> {
    let mut kept = polygon.to_vec();
    for (&from, &to) in window.iter().zip(window.iter().cycle().skip(1)) {
        let mut inside = Vec::with_capacity(kept.len() + 1);
        for (&a, &b) in kept.iter().zip(kept.iter().cycle().skip(1)) {
            let (side_a, side_b) = (side(from, to, a), side(from, to, b));
            if side_a >= 0.0 {
                inside.push(a);
            }
            if (side_a > 0.0 && side_b < 0.0) || (side_a < 0.0 && side_b > 0.0) {
                let share = side_a / (side_a - side_b);
                inside.push([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
            }
        }
        kept = inside;
    }
    kept
}

/// Positive where `point` lies to the left of the line from `from` to `to`.
fn side(from: Point, to: Point, point: Point) -> f64 {
    (to[0] - from[0]) * (point[1] - from[1]) - (to[1] - from[1]) * (point[0] - from[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_leaves_out_what_lies_within() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let mut points = square.to_vec();
        points.extend([[1.0, 1.0], [1.0, 0.0]]);
        assert_eq!(hull(points), square);
    }

    #[test]
    fn a_square_is_cut_to_the_window() {
        let window = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let shifted = window.map(|[x, y]| [x + 1.0, y + 1.0]);
        let mut cut = clip(&shifted, &window);
        cut.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        assert_eq!(cut, [[1.0, 1.0], [1.0, 2.0], [2.0, 1.0], [2.0, 2.0]]);
        let apart = window.map(|[x, y]| [x + 3.0, y]);
        assert!(clip(&apart, &window).is_empty());
    }
}
