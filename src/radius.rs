//! How far an effect reaches: as far as is stated, else by a default, which is said.

use crate::complete::listeners;
use deepshade_infer::Reach;
use deepshade_shaders::Effect;

/// How far an effect reaches where no network says what it knows. `radius` is what networks read, and there is none.
pub const DEFAULT_REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.15, height: 512 };

/// What a default radius depends on.
#[derive(Clone, Copy, Debug)]
pub struct Space {
    /// Diagonal of the scene, metres.
    pub diagonal: f32,
    /// Rows of the image.
    pub height: usize,
}

/// The radius of some effects, metres: the one that is stated, else the default of the network that computes them, or of
/// methods without one; no farther than the scene, beyond which there is nothing. A default is said where one of the effects
/// listens to it.
pub fn wanted(stated: Option<f32>, reach: Option<Reach>, effects: &[Effect], space: Space) -> f32 {
    let radius = stated.unwrap_or_else(|| {
        let radius = reach.unwrap_or(DEFAULT_REACH).radius(space.diagonal, space.height);
        if effects.iter().any(|effect| listeners::RADIUS.contains(effect)) {
            note!("radius: {}, the default at {} rows", in_words(radius, space.diagonal), space.height);
        }
        radius
    });
    radius.min(space.diagonal)
}

/// A radius in metres and as a share of the diagonal.
pub fn in_words(radius: f32, diagonal: f32) -> String {
    format!("{radius:.3} m, {:.1} % of the diagonal", 100.0 * radius / diagonal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_radius_follows_one_rule_with_a_network_and_without() {
        for (height, radius) in [(64, 10.0), (256, 6.0), (512, 3.0), (1024, 1.5)] {
            for reach in [None, Some(DEFAULT_REACH)] {
                let found = wanted(None, reach, &[Effect::Ao], Space { diagonal: 20.0, height });
                assert!((found - radius).abs() < 1e-5, "{height} rows: {found}");
            }
        }
        let space = Space { diagonal: 20.0, height: 64 };
        assert_eq!(wanted(Some(0.3), None, &[Effect::Ao], space), 0.3);
        assert_eq!(
            wanted(Some(f32::INFINITY), None, &[Effect::Ao], space),
            20.0,
            "no farther than the scene"
        );
        assert_eq!(in_words(3.0, 20.0), "3.000 m, 15.0 % of the diagonal");
    }
}
