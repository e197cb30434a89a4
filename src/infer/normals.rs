//! Normals as networks read them, of those that a file writes in another way.

use super::contract::is_in_camera_space;
use super::space::{mapped, vectors};
use clap::ValueEnum;
use deepshade_shaders::{Attribute, GBuffer};
use glam::Vec3;

/// Layers that hold normals.
pub const LAYERS: [Attribute; 2] = [Attribute::Normal, Attribute::WorldNormal];

/// How normals are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Normals {
    /// As they are.
    Signed,
    /// From 0 to 1, which stands for -1 to 1.
    Unsigned,
    /// Of another length than 1, which is mended.
    Normalised,
    /// Of both sides of a surface; those that face away are turned.
    Turned,
    /// With the camera's x reversed, unlike positions.
    ReversedX,
    /// With the camera's y reversed, unlike positions.
    ReversedY,
    /// With the camera's z reversed, unlike positions.
    ReversedZ,
}

impl Normals {
    /// The layers that are mended so.
    pub const fn layers(self) -> &'static [Attribute] {
        match self {
            Self::Signed => &[],
            Self::Unsigned | Self::Normalised | Self::Turned => &LAYERS,
            Self::ReversedX | Self::ReversedY | Self::ReversedZ => &[Attribute::Normal],
        }
    }
}

/// The g-buffer with components of normals from -1 to 1, of a file that has them from 0 to 1. Of two layers
/// one that has negative components is not written so.
#[must_use]
pub fn signed(gbuffer: GBuffer) -> GBuffer {
    let is_negative = |layer: Attribute| {
        let values = vectors(&gbuffer, layer).unwrap_or_default();
        values.iter().any(|value| value.min_element() < -0.01)
    };
    let unsigned: Vec<Attribute> = LAYERS.into_iter().filter(|layer| !is_negative(*layer)).collect();
    let is_there = |layer: &Attribute| gbuffer.attributes().contains(layer);
    let layers = if unsigned.iter().any(is_there) { unsigned } else { LAYERS.to_vec() };
    // Where nothing is seen renderers leave 0, or what stands for it, nearly.
    let signed = |normal: Vec3| {
        let signed = 2.0 * normal - 1.0;
        if normal == Vec3::ZERO || signed.length() < 0.1 { Vec3::ZERO } else { signed }
    };
    layers.into_iter().fold(gbuffer, |gbuffer, layer| mapped(&gbuffer, layer, |_, normal| signed(normal)))
}

/// The g-buffer with unit normals that face the camera, as far as that is asked for.
#[must_use]
pub fn mended(gbuffer: GBuffer, how: &[Normals]) -> GBuffer {
    let has = |normals: Normals| how.contains(&normals);
    let sign = |normals: Normals| if has(normals) { -1.0 } else { 1.0 };
    let signs = Vec3::new(sign(Normals::ReversedX), sign(Normals::ReversedY), sign(Normals::ReversedZ));
    let gbuffer = mapped(&gbuffer, Attribute::Normal, |_, normal| signs * normal);
    let gbuffer = if has(Normals::Normalised) { of_unit_length(gbuffer) } else { gbuffer };
    if has(Normals::Turned) { turned(&gbuffer) } else { gbuffer }
}

fn of_unit_length(gbuffer: GBuffer) -> GBuffer {
    let normalised = |gbuffer: GBuffer, layer| mapped(&gbuffer, layer, |_, value| value.normalize_or_zero());
    LAYERS.into_iter().fold(gbuffer, normalised)
}

/// The g-buffer with the normals turned that face away. In world space those are told by the direction to
/// the camera, or else they are those that face away in camera space.
fn turned(gbuffer: &GBuffer) -> GBuffer {
    // Those that nobody reads may be in another space.
    let positions = vectors(gbuffer, Attribute::Position);
    let positions = positions.filter(|positions| is_in_camera_space(gbuffer, positions));
    let faces_away = |at: usize, normal: Vec3| match &positions {
        Some(positions) => normal.dot(positions[at]) > 0.0,
        None => normal.z < 0.0,
    };
    let normals = vectors(gbuffer, Attribute::Normal);
    let to_camera = vectors(gbuffer, Attribute::ToCamera);
    let world_faces_away = |at: usize, normal: Vec3| match (&to_camera, &normals) {
        (Some(to_camera), _) => normal.dot(to_camera[at]) < 0.0,
        (None, Some(normals)) => faces_away(at, normals[at]),
        (None, None) => false,
    };
    let turn = |normal: Vec3, is_away: bool| if is_away { -normal } else { normal };
    let world =
        mapped(gbuffer, Attribute::WorldNormal, |at, normal| turn(normal, world_faces_away(at, normal)));
    mapped(&world, Attribute::Normal, |at, normal| turn(normal, faces_away(at, normal)))
}
