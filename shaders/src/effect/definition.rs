//! What a row of the table of effects says.

use super::Effect;
use crate::{Attribute, GBuffer, Planes};

/// All that tells one effect from another.
#[derive(Debug)]
pub struct Definition {
    /// Which effect.
    pub effect: Effect,
    /// Its name on the command line, in recipes and in files.
    pub name: &'static str,
    /// It in words.
    pub title: &'static str,
    /// What its numbers are, as the book's table has it.
    pub meaning: &'static str,
    /// The unit of its numbers.
    pub unit: &'static str,
    /// Number of channels of its image.
    pub channels: usize,
    /// Its value where no surface is seen, which every method's image has there; `None` of effects that reach
    /// beyond the surface's pixel, as blur does, and have a value of their own there.
    pub background: Option<f32>,
    /// The least and the greatest number that an image can hold: shares are 0 to 1, light is never negative,
    /// a photograph ends at white, which is 1.
    pub range: [f32; 2],
    /// The image of whoever computes nothing, which a method must be better than.
    pub doing_nothing: DoingNothing,
    /// Which light it shows.
    pub lit_by: LitBy,
    /// Whether its image is direct light, [`Attribute::Light`], averaged over a neighbourhood, maybe with
    /// some of it hidden.
    pub filters_light: bool,
    /// Whether some of the light that its image filters is hidden.
    pub hides_light: bool,
    /// Whether it sends the light of one colour farther than that of another, so that the same weights of a
    /// neighbourhood's light cannot serve for all colours.
    pub parts_colours: bool,
    /// What changes it, beside scene and camera. What is not here is refused where it is asked for.
    pub listens_to: &'static [EffectSetting],
    /// Whether its pairs stay sound when they are turned and mirrored.
    pub turns: bool,
    /// What its pairs hold: what its network reads (thesis, Table 7.1), what its analytic methods read
    /// beside, and the validity mask, which is the last. Effects of the thesis' table are without albedo
    /// where it says so: what they compute is multiplied by the diffuse colour afterwards.
    pub attributes: &'static [Attribute],
    /// The key of a recipe's table `vary` that the effect is nothing without.
    pub needs: Option<&'static str>,
    /// The keys that change it, too.
    pub varies: &'static [&'static str],
}

/// What whoever computes nothing shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DoingNothing {
    /// 1 everywhere.
    White,
    /// 0 everywhere.
    Black,
    /// A layer of the g-buffer as it is, such as light before it is blurred.
    As(Attribute),
}

impl DoingNothing {
    /// What figures and tables call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Black => "black",
            Self::As(_) => "light",
        }
    }

    /// The image, `[channels, height, width]`, of a frame with a g-buffer; 0 where that lacks the layer.
    pub fn image(self, channels: usize, gbuffer: &GBuffer) -> Planes {
        let filled = |value| Planes::filled(channels, gbuffer.height(), gbuffer.width(), value);
        match self {
            Self::White => filled(1.0),
            Self::Black => filled(0.0),
            Self::As(attribute) => gbuffer.select(&[attribute]).unwrap_or_else(|_| filled(0.0)),
        }
    }
}

/// Which light an effect shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LitBy {
    /// None: it is geometry alone.
    Nothing,
    /// That of an environment.
    Environment,
    /// That of point, spot and directional lights. What emissive surfaces and an environment send to surfaces
    /// is left out.
    Lamps,
    /// All of it.
    All,
    /// All of it in truth; its methods see that of lamps.
    AllInTruth,
}

impl LitBy {
    /// In the words of the book's table.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Environment => "environment",
            Self::Lamps => "lamps",
            Self::All | Self::AllInTruth => "all lights",
        }
    }
}

/// What may be set of a frame beside scene and camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectSetting {
    /// How far the effect reaches.
    Radius,
    /// How long the shutter is open.
    Shutter,
    /// What fills the space between surfaces.
    Medium,
    /// How far light goes within materials.
    MeanFreePath,
    /// Aperture and focus.
    Lens,
    /// Which surfaces keep light.
    Phosphor,
    /// What is around the scene: shown, or lighting it.
    Environment,
}
