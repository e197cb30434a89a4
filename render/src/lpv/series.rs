//! The end of the series of iterations.
//!
//! Light that walls and a medium send back and forth soon keeps its form: each iteration leaves the same
//! share of its energy on its way. From there on what iterations show is a geometric series, so that the last
//! one stands for all that would follow.

use super::propagation::{Energies, Kinds, MOST_KINDS};

/// Iterations of which the energy left on its way is looked at, before the last.
pub const LOOKED_AT: usize = 3;

/// The largest share that is believed: of light that is lost more slowly too little is shown.
const MOST: f32 = 0.995;

/// Light grows where its ratio is above 1 by more than this, which rounding may make of light that stays.
const GROWS: f32 = 1e-3;

/// By how much to multiply what the last iteration shows of each kind and colour, by the energies after the
/// three iterations before it.
pub fn weights(kinds: Kinds, after: &[Energies; LOOKED_AT]) -> Energies {
    let mut weights = [[1.0; 3]; MOST_KINDS];
    for (kind, of_kind) in weights.iter_mut().enumerate().take(kinds.count()) {
        for (colour, weight) in of_kind.iter_mut().enumerate() {
            *weight = weight_of(after.map(|energies| energies[kind][colour]));
        }
    }
    weights
}

/// The sum of a geometric series that begins with 1, by three members of another of the same ratio. Where
/// their ratios differ by more than a fifth of what is lost, nothing is known and it is 1; up to a tenth all
/// of the series counts.
fn weight_of([first, second, third]: [f32; LOOKED_AT]) -> f32 {
    if first <= 0.0 || second <= 0.0 || third < 0.0 {
        return 1.0;
    }
    let (before, after) = (second / first, third / second);
    if after > 1.0 + GROWS {
        return 1.0;
    }
    let ratio = after.min(MOST);
    let unsteady = (after - before).abs() / (1.0 - ratio);
    let known = (2.0 - 10.0 * unsteady).clamp(0.0, 1.0);
    1.0 + known * ratio / (1.0 - ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_a_geometric_series_is_found() {
        for ratio in [0.0f32, 0.3, 0.9, 0.99] {
            let weight = weight_of([5.0, 5.0 * ratio, 5.0 * ratio * ratio]);
            assert!((weight * (1.0 - ratio) - 1.0).abs() < 1e-3, "{ratio}: {weight}");
        }
    }

    #[test]
    fn nothing_is_added_where_the_ratio_is_not_known() {
        // Dark; light that is only now reaching the walls; light that grows; and none that is lost.
        for energies in [[0.0; 3], [1.0, 0.99, 0.9], [0.5, 1.0, 1.5], [1.0, 1.5, 2.25], [1.0, 0.5, -0.25]] {
            assert_eq!(weight_of(energies), 1.0, "{energies:?}");
        }
        assert!((weight_of([1.0; 3]) - 200.0).abs() < 1.0, "it is bounded");
    }
}
