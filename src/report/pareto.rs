//! What nothing beats: the Pareto front of time and error.

/// Which of some points, each a cost and another, no other point is at least as good as in both and better in one. Points
/// that are alike stand or fall together; one with a cost that is no number stands never.
pub fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|index| points[*index].iter().all(|cost| !cost.is_nan())).collect();
    order.sort_by(|a, b| {
        let ([a0, a1], [b0, b1]) = (points[*a], points[*b]);
        a0.total_cmp(&b0).then(a1.total_cmp(&b1))
    });
    let mut front = vec![false; points.len()];
    let mut last: Option<[f64; 2]> = None;
    for index in order {
        let point = points[index];
        if last.is_none_or(|last| point[1] < last[1] || point == last) {
            front[index] = true;
            last = Some(point);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::random::random;

    /// Whether a point is at least as good as another in both costs, and better in one.
    fn beats(a: [f64; 2], b: [f64; 2]) -> bool {
        a[0] <= b[0] && a[1] <= b[1] && a != b
    }

    #[test]
    fn a_point_is_on_the_front_if_and_only_if_no_other_beats_it() {
        for seed in 0..300 {
            let count = seed % 12;
            // Few values, so that many costs are alike.
            let cost = |point: u32, axis: u32| f64::from((random(point, axis, seed, 0) * 6.0).floor());
            let points: Vec<[f64; 2]> = (0..count).map(|point| [cost(point, 0), cost(point, 1)]).collect();
            let found = front(&points);
            for (point, on_front) in points.iter().zip(&found) {
                let beaten = points.iter().any(|other| beats(*other, *point));
                assert_eq!(*on_front, !beaten, "{point:?} among {points:?}");
            }
            assert_eq!(found.contains(&true), count > 0, "somebody is best");
        }
    }

    #[test]
    fn what_is_no_number_is_never_best() {
        assert_eq!(front(&[[f64::NAN, 0.0], [1.0, f64::NAN], [2.0, 3.0]]), [false, false, true]);
        assert_eq!(front(&[[1.0, f64::INFINITY], [2.0, 1.0], [0.0, -0.0]]), [false, false, true]);
    }
}
