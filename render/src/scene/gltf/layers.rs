//! What extensions add to a material: the index of refraction, what passes through it, and the coat over it
//! (KHR_materials_ior, KHR_materials_transmission, KHR_materials_volume, KHR_materials_clearcoat).
//!
//! Whether a body is solid says its thickness factor; how thick it is at a point says the mesh, so that
//! thickness textures are not read.

use super::{
    document::File,
    material::{normal_slot, plain_slot},
    texture::TextureList,
};
use crate::scene::coat::Coat;
use crate::scene::texture::Encoding;
use crate::scene::transmission::{Transmission, Walls, absorption};
use gltf::json::{self, material::NormalTexture, texture::Info};
use serde::{Deserialize, de::DeserializeOwned};

/// What the extensions say.
#[derive(Debug)]
pub(super) struct Layers {
    /// Index of refraction, where they name one.
    pub ior: Option<f32>,
    pub transmission: Option<Transmission>,
    pub coat: Option<Coat>,
}

#[derive(Deserialize)]
struct Ior {
    #[serde(default = "usual_ior")]
    ior: f32,
}

fn usual_ior() -> f32 {
    1.5
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Transmitting {
    transmission_factor: f32,
    transmission_texture: Option<Info>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Volume {
    thickness_factor: f32,
    attenuation_distance: f32,
    attenuation_color: [f32; 3],
}

impl Default for Volume {
    fn default() -> Self {
        Self { thickness_factor: 0.0, attenuation_distance: f32::INFINITY, attenuation_color: [1.0; 3] }
    }
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<NormalTexture>,
}

/// Reads the layers of a material; their textures are added.
pub(super) fn read(
    file: &File<'_>,
    material: &json::Material,
    textures: &mut TextureList,
) -> Result<Layers, String> {
    Ok(Layers {
        ior: extension::<Ior>(material, "KHR_materials_ior")?.map(|of| checked_ior(of.ior)).transpose()?,
        transmission: transmission(file, material, textures)?,
        coat: coat(file, material, textures)?,
    })
}

/// What a material says by an extension.
fn extension<T: DeserializeOwned>(material: &json::Material, name: &str) -> Result<Option<T>, String> {
    let said = material.extensions.as_ref().and_then(|extensions| extensions.others.get(name));
    let read = said.map(|value| json::deserialize::from_value(value.clone()));
    read.transpose().map_err(|error| format!("{name}: {error}"))
}

/// Below 1 nothing refracts; 0 stands for what reflects all.
fn checked_ior(ior: f32) -> Result<f32, String> {
    let known = ior.is_finite() && (ior == 0.0 || ior >= 1.0);
    known.then_some(ior).ok_or_else(|| format!("its ior {ior} is neither 0 nor 1 or more"))
}

fn transmission(
    file: &File<'_>,
    material: &json::Material,
    textures: &mut TextureList,
) -> Result<Option<Transmission>, String> {
    let said = extension::<Transmitting>(material, "KHR_materials_transmission")?;
    let Some(Transmitting { transmission_factor: share, transmission_texture }) = said else {
        return Ok(None);
    };
    let walls = walls(&extension::<Volume>(material, "KHR_materials_volume")?.unwrap_or_default())?;
    let share = part(share, "transmissionFactor")?;
    let texture = linear(file, transmission_texture.as_ref(), textures)?;
    Ok((share > 0.0).then_some(Transmission { share, texture, walls }))
}

fn walls(volume: &Volume) -> Result<Walls, String> {
    let Volume { thickness_factor, attenuation_distance, attenuation_color } = *volume;
    if !thickness_factor.is_finite() || attenuation_distance.is_nan() || attenuation_distance <= 0.0 {
        let what = format!("a thickness of {thickness_factor} m, an attenuation in {attenuation_distance} m");
        return Err(format!("KHR_materials_volume: {what}"));
    }
    if thickness_factor <= 0.0 {
        return Ok(Walls::Thin);
    }
    let colour: glam::Vec3 = attenuation_color.into();
    if !colour.is_finite() {
        return Err("KHR_materials_volume: its attenuationColor is not finite".to_owned());
    }
    Ok(Walls::Solid { absorption: absorption(colour, attenuation_distance) })
}

fn coat(
    file: &File<'_>,
    material: &json::Material,
    textures: &mut TextureList,
) -> Result<Option<Coat>, String> {
    let said = extension::<Clearcoat>(material, "KHR_materials_clearcoat")?;
    let Some(said) = said.filter(|said| said.clearcoat_factor != 0.0) else { return Ok(None) };
    let normal = said.clearcoat_normal_texture.as_ref();
    Ok(Some(Coat {
        share: part(said.clearcoat_factor, "clearcoatFactor")?,
        texture: linear(file, said.clearcoat_texture.as_ref(), textures)?,
        roughness: part(said.clearcoat_roughness_factor, "clearcoatRoughnessFactor")?,
        roughness_texture: linear(file, said.clearcoat_roughness_texture.as_ref(), textures)?,
        normal_texture: normal.map_or(Ok(None), |info| normal_slot(file, info, textures))?,
    }))
}

/// A share, which is from 0 to 1.
fn part(value: f32, name: &str) -> Result<f32, String> {
    (0.0..=1.0).contains(&value).then_some(value).ok_or_else(|| format!("its {name} {value} is not 0 to 1"))
}

/// The slot of a texture of numbers.
fn linear(
    file: &File<'_>,
    info: Option<&Info>,
    textures: &mut TextureList,
) -> Result<Option<crate::scene::TextureSlot>, String> {
    info.map_or(Ok(None), |info| plain_slot(file, info, Encoding::Linear, textures))
}
