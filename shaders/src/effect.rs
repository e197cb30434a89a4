//! The one list of effects. An effect is a quantity at a pixel; a method is one way to compute it.

mod definition;
mod table;

use crate::{Attribute, GBuffer, Planes, names};
pub use definition::{Definition, DoingNothing, EffectSetting, LitBy};
use serde::{Deserialize, Serialize};
use table::TABLE;

/// A quantity at a pixel that methods compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Ambient occlusion: the cosine-weighted share of directions of the upper hemisphere that nothing blocks
    /// within a radius; 1 is open (thesis 7.4).
    Ao,
    /// Directional occlusion: irradiance, divided by pi, from the environment map in the directions that
    /// nothing blocks within a radius, RGB (thesis 7.4).
    Do,
    /// Diffuse indirect light: irradiance, divided by pi, of light that was reflected diffusely once within a
    /// radius, RGB. Times the diffuse colour it is the indirect radiance (thesis 7.4).
    Gi,
    /// Glossy indirect light: the radiance that a surface's specular lobe reflects to the eye of light that
    /// was reflected diffusely once within a radius, RGB (thesis 4.3).
    Glossy,
    /// Image-based lighting: radiance reflected from an environment map that nothing blocks, by the Phong
    /// model, RGB.
    Ibl,
    /// The same from the directions that nothing blocks within a radius, RGB.
    OccludedIbl,
    /// Subsurface scattering in screen space: direct light gathered from the image's other pixels by
    /// Christensen's normalised diffusion, RGB.
    Sss,
    /// Subsurface scattering as it is: direct light that random walks below the surface bring out again,
    /// radiance, RGB.
    Subsurface,
    /// Depth of field: direct light, averaged over a thin lens, radiance, RGB.
    Dof,
    /// Motion blur: direct light, averaged over the time of exposure, radiance, RGB.
    MotionBlur,
    /// Anti-aliasing: direct light, averaged over each pixel, radiance, RGB.
    Aa,
    /// Direct light times ambient occlusion, averaged over a thin lens, radiance, RGB.
    Multi,
    /// Light that went from a light to the medium to the eye, radiance, RGB.
    FogDirect,
    /// Light that went from a light to a surface to the medium to the eye, radiance, RGB.
    FogIndirect,
    /// Light of every other path with a vertex in the medium, radiance, RGB.
    FogMultiple,
    /// Phosphorescence: what the surface that is seen gives back of light of lamps that it kept, radiance,
    /// RGB (thesis 8.3).
    Phosphor,
    /// Diffuse light of phosphorescence: irradiance, divided by pi, of what surfaces within a radius give
    /// back of light of lamps that they kept, RGB.
    PhosphorGi,
    /// All light, radiance, RGB.
    Path,
    /// The look of photographs, radiance, RGB: all light, in a setting that a network learns by heart (thesis
    /// 7.4).
    Real,
}

impl Effect {
    /// Every effect.
    pub const ALL: [Self; 19] = [
        Self::Ao,
        Self::Do,
        Self::Gi,
        Self::Glossy,
        Self::Ibl,
        Self::OccludedIbl,
        Self::Sss,
        Self::Subsurface,
        Self::Dof,
        Self::MotionBlur,
        Self::Aa,
        Self::Multi,
        Self::FogDirect,
        Self::FogIndirect,
        Self::FogMultiple,
        Self::Phosphor,
        Self::PhosphorGi,
        Self::Path,
        Self::Real,
    ];

    /// Its row of the table.
    pub const fn definition(self) -> &'static Definition {
        &TABLE[self as usize]
    }

    /// Its name on the command line, in recipes and in files.
    pub const fn name(self) -> &'static str {
        self.definition().name
    }

    /// Number of channels of its image.
    pub const fn channels(self) -> usize {
        self.definition().channels
    }

    /// Its value where no surface is seen: see [`Definition::background`].
    pub const fn background(self) -> Option<f32> {
        self.definition().background
    }

    /// The least and the greatest number that its image can hold.
    pub const fn range(self) -> [f32; 2] {
        self.definition().range
    }

    /// What the numbers of its image mean.
    pub const fn unit(self) -> &'static str {
        self.definition().unit
    }

    /// Whether it shows light of lamps alone: see [`LitBy::Lamps`].
    pub fn is_lit_by_lamps_alone(self) -> bool {
        self.lit_by() == LitBy::Lamps
    }

    /// The image of whoever computes nothing, `[channels, height, width]`: see [`DoingNothing`].
    pub fn doing_nothing(self, gbuffer: &GBuffer) -> Planes {
        self.definition().doing_nothing.image(self.channels(), gbuffer)
    }

    /// What its pairs hold: see [`Definition::attributes`].
    pub const fn attributes(self) -> &'static [Attribute] {
        self.definition().attributes
    }

    /// Whether it is nothing without a key of a recipe's table `vary`: see [`Definition::needs`].
    pub fn needs(self, key: &str) -> bool {
        self.definition().needs == Some(key)
    }

    /// Which light it shows.
    pub const fn lit_by(self) -> LitBy {
        self.definition().lit_by
    }

    /// Whether a setting changes it.
    pub fn listens_to(self, setting: EffectSetting) -> bool {
        self.definition().listens_to.contains(&setting)
    }
}

impl std::fmt::Display for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Effect {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|effect| effect.name() == name).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|effect| effect.name()).collect();
            let meant = names::did_you_mean(name, known.iter().copied());
            format!("no effect `{name}`{meant}; there are {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_its_effect_s_own_and_agrees_with_itself() {
        for (effect, row) in Effect::ALL.into_iter().zip(&TABLE) {
            assert_eq!(effect, row.effect);
            assert_eq!(effect.definition().name.parse::<Effect>(), Ok(effect));
            let twice = |i: usize| row.attributes[..i].contains(&row.attributes[i]);
            assert!(!(0..row.attributes.len()).any(twice), "{effect}");
            assert_eq!(row.attributes.last(), Some(&Attribute::Valid), "{effect}");
            if let DoingNothing::As(attribute) = row.doing_nothing {
                assert!(row.attributes.contains(&attribute), "{effect}: {attribute:?}");
                assert_eq!(attribute.width(), row.channels, "{effect}");
            }
            assert!(
                !row.filters_light || row.doing_nothing == DoingNothing::As(Attribute::Light),
                "{effect}"
            );
            assert!(!row.hides_light || row.filters_light, "{effect}");
            assert!(row.needs.is_none_or(|needed| !row.varies.contains(&needed)), "{effect}");
        }
    }

    #[test]
    fn doing_nothing_is_one_number_or_the_light_that_is_there() {
        for effect in Effect::ALL {
            let attributes = effect.attributes().to_vec();
            let width: usize = attributes.iter().map(|attribute| attribute.width()).sum();
            let gbuffer = GBuffer::new(attributes, Planes::filled(width, 8, 8, 0.5));
            let value = match effect.definition().doing_nothing {
                DoingNothing::White => 1.0,
                DoingNothing::Black => 0.0,
                DoingNothing::As(_) => 0.5,
            };
            let expected = Planes::filled(effect.channels(), 8, 8, value);
            assert_eq!(effect.doing_nothing(&gbuffer), expected, "{effect}");
        }
    }
}
