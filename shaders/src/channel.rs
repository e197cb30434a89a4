//! The one list of g-buffer channels: EXR layer names, WGSL constants, network input order and docs derive
//! from it.
//!
//! The attributes are those of Nalbach's thesis (7.3.1), plus object id, emission and a validity mask.

use serde::{Deserialize, Serialize};

/// How an attribute's components change when an image is rotated or mirrored (thesis 7.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeKind {
    /// A point or vector in camera space: x and y turn with the image.
    CameraVector,
    /// A point or vector in world space: stays as it is.
    WorldVector,
    /// Red, green and blue.
    Colour,
    /// A number without direction.
    Scalar,
    /// Direction in [0, pi) and length of a movement in the image plane: the direction turns with the image.
    Motion,
    /// A number without direction at several scales, pixels.
    Scales,
    /// A direction that back and forth are the same of, as a vector at twice its angle.
    DoubledAngle,
}

/// One physical quantity of a g-buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Attribute {
    /// `Ps`: position in camera space, metres.
    Position,
    /// `Ns`: unit shading normal in camera space, facing the camera.
    Normal,
    /// `Nw`: unit shading normal in world space, facing the camera.
    WorldNormal,
    /// `Ds`: depth, `-Ps.z`, metres.
    Depth,
    /// `Dfocal`: signed distance to the plane in focus, metres, positive beyond it; 0 without a lens.
    FocalDistance,
    /// Radius of the circle of confusion that the lens makes of the point, pixels, never negative:
    /// `|Dfocal| B / Ds`.
    CircleOfConfusion,
    /// `Dfocal B`, the one number of blur that the thesis feeds a network (7.4), beside `Ds`; metres times
    /// pixels. `B` belongs to the lens and is the same all over an image: the radius in pixels of the circle
    /// of confusion of what is infinitely far away.
    Blurriness,
    /// `Cw`: unit direction to the camera in world space.
    ToCamera,
    /// `Rdiff`: diffuse colour (albedo).
    Diffuse,
    /// `Rspec`: specular colour.
    Specular,
    /// `Rgloss`: glossiness, `1 - roughness`.
    Glossiness,
    /// `Rscatt`: mean free path of each colour channel, metres.
    MeanFreePath,
    /// `L`: direct light, radiance.
    Light,
    /// `Ldiff`: direct light reflected diffusely, radiance.
    DiffuseLight,
    /// `F`: movement in the image plane during exposure; direction in [0, pi), from x to the right towards y
    /// up, and length in pixels.
    Motion,
    /// Object id, whole numbers from 0, modulo 2048 so that half floats hold them exactly.
    ObjectId,
    /// Emitted radiance.
    Emission,
    /// 1 where a surface was hit, 0 elsewhere.
    Valid,
    /// Share of the hemisphere that is open, 0 to 1, as a cheap method estimates it.
    Openness,
    /// The same before the method's blur.
    RawOpenness,
    /// The effect's image, of effects of light, as a cheap method makes it.
    Estimate,
    /// Depth against its means over some pixels, over the effect's radius, compressed to (-1, 1). It follows
    /// from `Position` and the radius, as the next two do.
    Relief,
    /// Logarithm of the effect's radius in pixels at the point, to the base of 2, divided by 8.
    PixelRadius,
    /// Distance to the image's nearest border over the radius in pixels, at most 1.
    Border,
    /// `Blurriness / Depth` in eights of pixels, within -8 and 8: the signed radius of the circle of
    /// confusion, positive beyond focus.
    SignedCircle,
    /// `Motion` in eights of pixels as a vector at twice its angle, so that opposite directions are one and
    /// the same, and near ones are near: `length (cos 2a, sin 2a)`.
    Movement,
    /// Logarithm of `MeanFreePath` in pixels at the point, to the base of 2, divided by 8.
    FreePathPixels,
}

impl Attribute {
    /// Every attribute of a g-buffer, in file order.
    pub const ALL: [Self; 18] = [
        Self::Position,
        Self::Normal,
        Self::WorldNormal,
        Self::Depth,
        Self::FocalDistance,
        Self::CircleOfConfusion,
        Self::Blurriness,
        Self::ToCamera,
        Self::Diffuse,
        Self::Specular,
        Self::Glossiness,
        Self::MeanFreePath,
        Self::Light,
        Self::DiffuseLight,
        Self::Motion,
        Self::ObjectId,
        Self::Emission,
        Self::Valid,
    ];

    /// What is made for a network to read; `Estimate` may take a scene. Renderers need not give it.
    pub const MADE: [Self; 9] = [
        Self::Openness,
        Self::RawOpenness,
        Self::Estimate,
        Self::Relief,
        Self::PixelRadius,
        Self::Border,
        Self::SignedCircle,
        Self::Movement,
        Self::FreePathPixels,
    ];

    /// What it follows from, with the effect's radius and no method: attributes that a renderer gives; none
    /// of what a renderer gives itself, and of estimates.
    pub const fn made_of(self) -> &'static [Self] {
        match self {
            Self::Relief | Self::PixelRadius | Self::Border => &[Self::Position],
            Self::SignedCircle => &[Self::Blurriness, Self::Depth],
            Self::Movement => &[Self::Motion],
            Self::FreePathPixels => &[Self::MeanFreePath, Self::Position],
            _ => &[],
        }
    }

    /// The layer's name in an EXR file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Normal => "normal",
            Self::WorldNormal => "world_normal",
            Self::Depth => "depth",
            Self::FocalDistance => "focal_distance",
            Self::CircleOfConfusion => "circle_of_confusion",
            Self::Blurriness => "blurriness",
            Self::ToCamera => "to_camera",
            Self::Diffuse => "diffuse",
            Self::Specular => "specular",
            Self::Glossiness => "glossiness",
            Self::MeanFreePath => "mean_free_path",
            Self::Light => "light",
            Self::DiffuseLight => "diffuse_light",
            Self::Motion => "motion",
            Self::ObjectId => "object_id",
            Self::Emission => "emission",
            Self::Valid => "valid",
            Self::Openness => "openness",
            Self::RawOpenness => "raw_openness",
            Self::Estimate => "estimate",
            Self::Relief => "relief",
            Self::PixelRadius => "pixel_radius",
            Self::Border => "border",
            Self::SignedCircle => "signed_circle",
            Self::Movement => "movement",
            Self::FreePathPixels => "free_path_pixels",
        }
    }

    /// How the components turn with the image.
    pub const fn kind(self) -> AttributeKind {
        match self {
            Self::Position | Self::Normal => AttributeKind::CameraVector,
            Self::WorldNormal | Self::ToCamera => AttributeKind::WorldVector,
            Self::Diffuse
            | Self::Specular
            | Self::MeanFreePath
            | Self::Light
            | Self::DiffuseLight
            | Self::Emission
            | Self::Estimate
            | Self::FreePathPixels => AttributeKind::Colour,
            Self::Motion => AttributeKind::Motion,
            Self::Depth
            | Self::FocalDistance
            | Self::CircleOfConfusion
            | Self::Blurriness
            | Self::Glossiness
            | Self::ObjectId
            | Self::Valid
            | Self::Openness
            | Self::RawOpenness
            | Self::PixelRadius
            | Self::Border
            | Self::SignedCircle => AttributeKind::Scalar,
            Self::Relief => AttributeKind::Scales,
            Self::Movement => AttributeKind::DoubledAngle,
        }
    }

    /// Names of the components, as they follow the dot in an EXR channel name; a scalar's channel is the bare
    /// name.
    pub const fn components(self) -> &'static [&'static str] {
        match self.kind() {
            AttributeKind::CameraVector | AttributeKind::WorldVector => &["X", "Y", "Z"],
            AttributeKind::Colour => &["R", "G", "B"],
            AttributeKind::Motion => &["direction", "length"],
            AttributeKind::Scales => &["4", "16", "64"],
            AttributeKind::DoubledAngle => &["X", "Y"],
            AttributeKind::Scalar => &[""],
        }
    }

    /// Number of channels.
    pub const fn width(self) -> usize {
        self.components().len()
    }

    /// The attribute's channels, in order.
    pub fn channels(self) -> impl Iterator<Item = Channel> {
        (0..self.width()).map(move |component| Channel { attribute: self, component })
    }
}

/// One plane of a g-buffer: a component of an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Channel {
    /// The quantity.
    pub attribute: Attribute,
    /// Which of its components, from 0.
    pub component: usize,
}

impl std::fmt::Display for Channel {
    /// The EXR channel name, such as `position.X` or `depth`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let component = self.attribute.components()[self.component];
        match component {
            "" => f.write_str(self.attribute.name()),
            component => write!(f, "{}.{component}", self.attribute.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_channel_has_a_name_of_its_own() {
        let names: Vec<String> = Attribute::ALL
            .iter()
            .chain(&Attribute::MADE)
            .flat_map(|a| a.channels())
            .map(|c| c.to_string())
            .collect();
        let distinct: HashSet<&String> = names.iter().collect();
        assert_eq!(names.len(), distinct.len());
        assert!(names.contains(&"position.X".to_owned()));
        assert!(names.contains(&"depth".to_owned()));
    }
}
