//! The one list of effects. An effect is a quantity at a pixel; a method is one way to compute it.

use crate::names;
use serde::{Deserialize, Serialize};

/// A quantity at a pixel that methods compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Ambient occlusion: the cosine-weighted share of directions of the upper hemisphere that nothing blocks within
    /// a radius; 1 is open (thesis 7.4).
    Ao,
    /// Directional occlusion: irradiance, divided by pi, from the environment map in the directions that nothing blocks
    /// within a radius, RGB (thesis 7.4).
    Do,
    /// Diffuse indirect light: irradiance, divided by pi, of light that was reflected diffusely once within a radius,
    /// RGB. Times the diffuse colour it is the indirect radiance (thesis 7.4).
    Gi,
    /// Glossy indirect light: the radiance that a surface's specular lobe reflects to the eye of light that was reflected
    /// diffusely once within a radius, RGB (thesis 4.3).
    Glossy,
    /// Image-based lighting: radiance reflected from an environment map that nothing blocks, by the Phong model, RGB.
    Ibl,
    /// Subsurface scattering in screen space: direct light gathered from the image's other pixels by Christensen's
    /// normalised diffusion, RGB.
    Sss,
    /// Subsurface scattering as it is: direct light that random walks below the surface bring out again, radiance, RGB.
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
    /// Phosphorescence: what the surface that is seen gives back of light of lamps that it kept, radiance, RGB (thesis 8.3).
    Phosphor,
    /// Diffuse light of phosphorescence: irradiance, divided by pi, of what surfaces within a radius give back of light of
    /// lamps that they kept, RGB.
    PhosphorGi,
    /// All light, radiance, RGB.
    Path,
    /// The look of photographs, radiance, RGB: all light, in a setting that a network learns by heart (thesis 7.4).
    Real,
}

impl Effect {
    /// Every effect.
    pub const ALL: [Self; 18] = [
        Self::Ao,
        Self::Do,
        Self::Gi,
        Self::Glossy,
        Self::Ibl,
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

    /// Its name on the command line, in recipes and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ao => "ao",
            Self::Do => "do",
            Self::Gi => "gi",
            Self::Glossy => "glossy",
            Self::Ibl => "ibl",
            Self::Sss => "sss",
            Self::Subsurface => "subsurface",
            Self::Dof => "dof",
            Self::MotionBlur => "motion-blur",
            Self::Aa => "aa",
            Self::Multi => "multi",
            Self::FogDirect => "fog-direct",
            Self::FogIndirect => "fog-indirect",
            Self::FogMultiple => "fog-multiple",
            Self::Phosphor => "phosphor",
            Self::PhosphorGi => "phosphor-gi",
            Self::Path => "path",
            Self::Real => "real",
        }
    }

    /// Number of channels of its image.
    pub const fn channels(self) -> usize {
        match self {
            Self::Ao => 1,
            _ => 3,
        }
    }

    /// Its value where no surface is seen, which every method's image has there; `None` for effects that reach beyond
    /// the surface's pixel, as blur does, and have a value of their own there.
    pub const fn background(self) -> Option<f32> {
        match self {
            Self::Ao => Some(1.0),
            Self::Do
            | Self::Gi
            | Self::Glossy
            | Self::Ibl
            | Self::Sss
            | Self::Subsurface
            | Self::Phosphor
            | Self::PhosphorGi => Some(0.0),
            Self::Dof
            | Self::MotionBlur
            | Self::Aa
            | Self::Multi
            | Self::FogDirect
            | Self::FogIndirect
            | Self::FogMultiple
            | Self::Path
            | Self::Real => None,
        }
    }

    /// The least and the greatest number that an image can hold: shares are 0 to 1, light is never negative.
    pub const fn range(self) -> [f32; 2] {
        match self {
            Self::Ao => [0.0, 1.0],
            _ => [0.0, f32::INFINITY],
        }
    }

    /// Whether it shows direct light of a scene's lights only: what the environment and shining surfaces send
    /// is left out.
    pub const fn lit_by_lamps_alone(self) -> bool {
        match self {
            Self::Sss
            | Self::Subsurface
            | Self::Dof
            | Self::MotionBlur
            | Self::Aa
            | Self::Multi
            | Self::Phosphor
            | Self::PhosphorGi => true,
            Self::Ao
            | Self::Do
            | Self::Gi
            | Self::Glossy
            | Self::Ibl
            | Self::FogDirect
            | Self::FogIndirect
            | Self::FogMultiple
            | Self::Path
            | Self::Real => false,
        }
    }

    /// Whether some of the light that its image filters is hidden.
    pub const fn hides_light(self) -> bool {
        match self {
            Self::Multi => true,
            Self::Aa
            | Self::Ao
            | Self::Do
            | Self::Dof
            | Self::Gi
            | Self::Glossy
            | Self::Ibl
            | Self::MotionBlur
            | Self::Sss
            | Self::Subsurface
            | Self::FogDirect
            | Self::FogIndirect
            | Self::FogMultiple
            | Self::Phosphor
            | Self::PhosphorGi
            | Self::Path
            | Self::Real => false,
        }
    }

    /// Whether it sends the light of one colour farther than that of another, so that the same weights of the light of a
    /// neighbourhood cannot serve for all colours.
    pub const fn parts_colours(self) -> bool {
        match self {
            Self::Sss | Self::Subsurface => true,
            Self::Aa
            | Self::Ao
            | Self::Do
            | Self::Dof
            | Self::Gi
            | Self::Glossy
            | Self::Ibl
            | Self::MotionBlur
            | Self::Multi
            | Self::FogDirect
            | Self::FogIndirect
            | Self::FogMultiple
            | Self::Phosphor
            | Self::PhosphorGi
            | Self::Path
            | Self::Real => false,
        }
    }

    /// Whether its image is direct light, [`Attribute::Light`](crate::Attribute::Light), averaged over a neighbourhood, maybe
    /// with some of it hidden.
    pub const fn filters_light(self) -> bool {
        match self {
            Self::Sss | Self::Dof | Self::MotionBlur | Self::Aa | Self::Multi => true,
            Self::Ao
            | Self::Do
            | Self::Gi
            | Self::Glossy
            | Self::Ibl
            | Self::Subsurface
            | Self::FogDirect
            | Self::FogIndirect
            | Self::FogMultiple
            | Self::Phosphor
            | Self::PhosphorGi
            | Self::Path
            | Self::Real => false,
        }
    }

    /// What the numbers of its image mean.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Ao => "open share of the hemisphere",
            Self::Do | Self::Gi | Self::PhosphorGi => "irradiance / pi",
            _ => "radiance",
        }
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
