//! What several crates ask of lists: what lies in the middle, and which few stand for many.

/// The median: the middle one of the sorted values; of an even number, the mean of the two in the middle.
///
/// # Panics
/// If there is no value.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

/// The smallest of the values that `share` of them do not exceed: 0.95 for the 95th percentile.
///
/// # Panics
/// If there is no value.
pub fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values[rank.clamp(1, values.len()) - 1]
}

/// Indices of at most `wanted` of `count` things, ascending, evenly spread from the first on.
pub fn spread(count: usize, wanted: usize) -> Vec<usize> {
    (0..count).filter(|index| is_in_spread(*index, count, wanted)).collect()
}

/// Whether an index below `count` is among those of [`spread`]: the share of `wanted` reaches a whole number
/// there.
pub const fn is_in_spread(index: usize, count: usize, wanted: usize) -> bool {
    wanted >= count || (index * wanted).next_multiple_of(count) < (index + 1) * wanted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_of_the_sorted() {
        assert_eq!(median(vec![9.0, 1.0, 3.0]), 3.0);
        assert_eq!(median(vec![9.0, 1.0, 3.0, 4.0]), 3.5);
        assert_eq!(median(vec![7.0]), 7.0);
    }

    #[test]
    fn a_quantile_is_the_smallest_that_enough_do_not_exceed() {
        let values: Vec<f64> = (1..=20).rev().map(f64::from).collect();
        assert_eq!(
            [0.0, 0.5, 0.95, 0.96, 1.0].map(|share| quantile(values.clone(), share)),
            [1.0, 10.0, 19.0, 20.0, 20.0]
        );
        assert_eq!(quantile(vec![7.0], 0.95), 7.0);
    }

    #[test]
    fn what_is_spread_is_even_and_never_twice() {
        assert_eq!(spread(10, 3), [0, 3, 6]);
        assert_eq!(spread(2, 5), [0, 1]);
        assert_eq!(spread(7, 7), [0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(spread(0, 3), [0; 0]);
        assert_eq!(spread(5, 0), [0; 0]);
        for (count, wanted) in [(1000, 137), (13, 12), (97, 1)] {
            let expected: Vec<usize> = (0..wanted).map(|i| i * count / wanted).collect();
            assert_eq!(spread(count, wanted), expected);
        }
    }
}
