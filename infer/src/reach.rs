//! Running a network at another radius or resolution than it was trained for (thesis 7.5.1).

use serde::{Deserialize, Serialize};

/// What a network was trained to reach: fixed by its training data, adjusted by scaling what it reads.
///
/// A network is a function of pixels. In an image N times as high as the training images the pixels that it
/// reaches cover 1/N of the world that they covered there. The thesis therefore divides the effect's radius
/// by N ([`Reach::radius`]): it keeps its size in pixels, not in the world. The program's default is
/// `diagonal_share` of the scene at every height. Whatever radius is wanted, positions are multiplied by the
/// trained over the wanted one, so that it looks to the network like the one it knows
/// ([`Reach::position_scale`]); with the thesis' radius that is N times as much as at the trained height.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// Radius of the effect in the units in which the network reads positions.
    pub radius: f32,
    /// Radius of the effect as a share of the scene's diagonal at the trained height.
    pub diagonal_share: f32,
    /// Height of the training frames, pixels (before crops are cut out of them).
    pub height: usize,
}

/// Most of the diagonal that a radius is in images lower than the training images: with half of it, a point
/// in the middle is reached by the whole scene.
const MOST_OF_DIAGONAL: f32 = 0.5;

impl Reach {
    /// The radius, in metres, that the thesis gives a scene with this diagonal in an image of this height.
    /// Where images are lower than the training images it grows up to half the diagonal, or up to the trained
    /// share where that is more.
    pub fn radius(&self, diagonal: f32, height: usize) -> f32 {
        let share = self.diagonal_share * self.height as f32 / height as f32;
        diagonal * share.min(self.diagonal_share.max(MOST_OF_DIAGONAL))
    }

    /// The factor that camera-space positions in metres are multiplied by before the network reads them, so
    /// that an effect of `radius` metres looks like the trained one. Training and every way of running use
    /// it.
    pub fn position_scale(&self, radius: f32) -> f32 {
        self.radius / radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    #[test]
    fn a_taller_image_scales_positions_by_n() {
        let at_trained = REACH.position_scale(REACH.radius(20.0, 512));
        let at_double = REACH.position_scale(REACH.radius(20.0, 1024));
        assert!((at_double / at_trained - 2.0).abs() < 1e-6);
    }

    #[test]
    fn a_low_image_reaches_no_further_than_all_of_the_scene() {
        assert!((REACH.radius(20.0, 256) - 2.0).abs() < 1e-6);
        assert_eq!(REACH.radius(20.0, 16), 10.0);
        let wide = Reach { diagonal_share: 0.8, ..REACH };
        assert_eq!((wide.radius(20.0, 512), wide.radius(20.0, 16)), (16.0, 16.0));
    }

    #[test]
    fn a_wider_radius_shrinks_positions() {
        assert!((REACH.position_scale(4.0) - 0.25).abs() < 1e-7);
    }
}
