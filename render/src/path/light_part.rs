//! Parts of an effect's light, for whoever wants them one by one.

use deepshade_shaders::Effect;

/// Which light of an effect a picture holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightPart {
    /// All of it, as the effect is defined.
    #[default]
    All,
    /// Of `path`: what is seen shines itself.
    Emitted,
    /// Of `path`: light that was reflected or scattered once.
    Direct,
    /// Of `path`: light that was reflected or scattered twice.
    FirstIndirect,
    /// Of `path`: light that was reflected or scattered more often.
    Rest,
}

impl LightPart {
    /// Every part.
    pub const ALL: [Self; 5] = [Self::All, Self::Emitted, Self::Direct, Self::FirstIndirect, Self::Rest];

    /// Its name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Emitted => "emitted",
            Self::Direct => "direct",
            Self::FirstIndirect => "first-indirect",
            Self::Rest => "rest",
        }
    }

    /// The part of an effect that has a name.
    ///
    /// # Errors
    /// If there is none; the error names those that there are.
    pub fn named(name: &str, effect: Effect) -> Result<Self, String> {
        let parts = || Self::ALL.into_iter().filter(|part| part.is_of(effect));
        parts().find(|part| part.name() == name).ok_or_else(|| {
            let known: Vec<_> = parts().map(Self::name).collect();
            format!("{effect} has no part `{name}`; there is {}", known.join(", "))
        })
    }

    /// Whether an effect has such a part.
    pub fn is_of(self, effect: Effect) -> bool {
        match self {
            Self::All => true,
            Self::Emitted | Self::Direct | Self::FirstIndirect | Self::Rest => effect == Effect::Path,
        }
    }
}

impl std::fmt::Display for LightPart {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::proving::{floor, quad, traced};
    use crate::path::{Sampling, Shot, render};
    use crate::scene::{Camera, Material};
    use glam::Vec3;

    #[test]
    fn parts_of_all_light_add_up_to_it() {
        let lamp = quad([(-1., -1.), (-1., 1.), (1., 1.), (1., -1.)].map(|(x, z)| Vec3::new(x, 2.0, z)));
        let shining = Material { emission: Vec3::splat(2.0), ..Material::default() };
        let scene = traced(vec![floor(), lamp], shining);
        let camera = Camera::look_at(Vec3::new(4.0, 1.0, 0.0), Vec3::new(0.0, 1.0, 0.0));
        let image = |part| {
            let shot = Shot { part, ..Shot::new(&scene, &camera, [8, 8], 1.0) };
            render(Effect::Path, &shot, Sampling::one(64, 1)).mean
        };
        let whole = image(LightPart::All);
        let parts =
            [LightPart::Emitted, LightPart::Direct, LightPart::FirstIndirect, LightPart::Rest].map(image);
        for (i, all) in whole.data().iter().enumerate() {
            let sum: f32 = parts.iter().map(|part| part.data()[i]).sum();
            assert!((sum - all).abs() <= 1e-4 * all.max(1.0), "{sum} is not {all}");
        }
        assert!(parts.iter().all(|part| part.data().iter().any(|value| *value > 0.0)));
    }

    #[test]
    fn parts_belong_to_effects() {
        for part in LightPart::ALL {
            assert_eq!(LightPart::named(part.name(), Effect::Path), Ok(part));
            assert_eq!(part.is_of(Effect::Ao), part == LightPart::All);
        }
        let refused = |name| LightPart::named(name, Effect::Gi).expect_err("none of its parts");
        assert_eq!(refused("rest"), "gi has no part `rest`; there is all");
        assert!(LightPart::Direct.is_of(Effect::Path));
    }
}
