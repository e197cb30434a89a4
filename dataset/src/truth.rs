//! What a pair of an effect consists of: which attributes its g-buffer holds. The integrator of its target is
//! [`deepshade_render::path::integrator`]'s.

use deepshade_shaders::{Attribute, Effect};

/// The attributes that pairs of an effect hold: what its networks and its analytic methods read.
pub const fn attributes(effect: Effect) -> &'static [Attribute] {
    match effect {
        Effect::Ao => &[Attribute::Position, Attribute::Normal, Attribute::Valid],
        _ => unimplemented!(),
    }
}

