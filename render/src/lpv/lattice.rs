//! The 26 neighbours of a cell, and the share of all directions that each stands for: the weights of
//! Lebedev's rule of 26 points (1976), with which sums over neighbours are integrals over the sphere for
//! polynomials up to the seventh degree. So what two bands say of energy and flux is kept exactly.

use glam::{IVec3, Vec3};
use std::sync::LazyLock;

/// Kinds of neighbours: across a face, an edge and a corner.
pub const CLASSES: usize = 3;

/// How many neighbours there are of each kind.
pub const COUNTS: [f32; CLASSES] = [6.0, 12.0, 8.0];

/// Share of all directions that one of each kind stands for.
pub const SHARES: [f32; CLASSES] = [1.0 / 21.0, 4.0 / 105.0, 9.0 / 280.0];

/// How far away they are, cells.
pub const DISTANCES: [f32; CLASSES] = [1.0, std::f32::consts::SQRT_2, 1.732_050_8];

/// Neighbours of which one of each opposite pair is counted.
pub const LINKS: usize = 13;

/// One neighbour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Where it is, cells.
    pub offset: IVec3,
    /// The way there, a unit vector.
    pub direction: Vec3,
    /// Its kind.
    pub class: usize,
}

impl Neighbour {
    /// The one on the other side.
    #[must_use]
    pub fn opposite(self) -> Self {
        Self { offset: -self.offset, direction: -self.direction, ..self }
    }
}

/// All of them; x changes fastest. The last [`LINKS`] are the opposites of the first, in reverse.
pub fn neighbours() -> impl ExactSizeIterator<Item = Neighbour> {
    static ALL: LazyLock<Vec<Neighbour>> = LazyLock::new(|| {
        let offset = |i: i32| IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
        let others = (0..27).map(offset).filter(|offset| *offset != IVec3::ZERO);
        let neighbour = |offset: IVec3| Neighbour {
            offset,
            direction: offset.as_vec3().normalize(),
            class: offset.length_squared() as usize - 1,
        };
        others.map(neighbour).collect()
    });
    ALL.iter().copied()
}

/// The mean over all directions of what is the same for neighbours of a kind.
pub fn mean(of_class: impl Fn(usize) -> f32) -> f32 {
    (0..CLASSES).map(|class| COUNTS[class] * SHARES[class] * of_class(class)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_neighbours_are_integrals_over_the_sphere() {
        let axis = Vec3::new(0.3, -0.5, 0.81).normalize();
        for (power, mean) in
            [(0, 1.0), (1, 0.0), (2, 1.0 / 3.0), (3, 0.0), (4, 0.2), (5, 0.0), (6, 1.0 / 7.0)]
        {
            let sum: f32 = neighbours().map(|n| SHARES[n.class] * n.direction.dot(axis).powi(power)).sum();
            assert!((sum - mean).abs() < 1e-6, "power {power}: {sum}");
        }
        // The eighth degree is beyond the rule.
        let sum: f32 = neighbours().map(|n| SHARES[n.class] * n.direction.x.powi(8)).sum();
        assert!((sum - 1.0 / 9.0).abs() > 1e-3, "{sum}");
    }

    #[test]
    fn the_last_are_the_opposites_of_the_first() {
        let all: Vec<_> = neighbours().collect();
        assert_eq!(all.len(), 2 * LINKS);
        assert!((0..LINKS).all(|i| all[i].offset == -all[2 * LINKS - 1 - i].offset));
    }
}
