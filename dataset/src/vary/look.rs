//! What objects look like in an image.

use super::draw::{between, between_ratios, purpose};
use super::{Props, Variation, Vary};
use crate::DatasetError;
use crate::random::{mix, uniform};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::box_mapping::box_map;
use deepshade_render::scene::medium::MediumError;
use deepshade_render::scene::{
    AlphaMode, Gloss, Look, Material, MaterialId, Scene, SceneError, TextureId, TextureSlot,
};
use glam::{Affine2, Vec2, Vec3};
use std::collections::{HashMap, hash_map::Entry};

/// Gives every object a material of its own, and texture coordinates where textures need them.
pub(super) fn prepare(scene: &mut Scene, vary: &Vary) {
    if !vary.dresses() {
        return;
    }
    let materials = scene.meshes.iter().map(|mesh| scene.material(mesh.material).clone()).collect();
    scene.materials = materials;
    for (index, mesh) in scene.meshes.iter_mut().enumerate() {
        mesh.material = MaterialId(index as u32);
        if vary.textures.is_some() {
            box_map(mesh);
        }
    }
}

/// Most textures of the pool in one image: more would fill the memory in scenes of many objects.
const MOST_TEXTURES: u64 = 64;

/// The look of an image of a scene that was prepared.
///
/// # Errors
/// If a texture cannot be read, or there can be no fog in the scene.
pub(super) fn look(
    scene: &TracedScene,
    vary: &Vary,
    variation: &Variation,
    props: &Props,
) -> Result<Look, DatasetError> {
    let mut look = scene.scene().look();
    let mut drawn = HashMap::new();
    let seed = u64::from(variation.seed);
    for (index, material) in look.materials.iter_mut().enumerate() {
        let words = |purpose: u64, which: u64| [seed, purpose, index as u64, which];
        let textured = vary.textures.is_some() && material.alpha == AlphaMode::Opaque;
        if vary.materials {
            let draw = |which: u64| uniform(&words(purpose::MATERIAL, which));
            paint(material, textured, draw);
        }
        if textured {
            let slot = mix(&words(purpose::TEXTURE, 0)) % MOST_TEXTURES;
            let chosen = mix(&[seed, purpose::POOL, slot]) % props.textures().len() as u64;
            let texture = match drawn.entry(chosen) {
                Entry::Occupied(entry) => *entry.get(),
                Entry::Vacant(entry) => {
                    look.textures.push(props.textures().texture(chosen as usize)?);
                    *entry.insert(TextureId(look.textures.len() as u32 - 1))
                }
            };
            cover(material, texture, uniform(&words(purpose::TEXTURE, 1)));
        }
        if let Some(range) = vary.mean_free_path {
            let draw = |which: u64| uniform(&words(purpose::MEAN_FREE_PATH, which));
            let longest = scene.diagonal() * between_ratios(range, draw(0));
            // Red goes farthest in skin, milk and wax.
            let shares = Vec3::new(1.0, between([0.2, 1.0], draw(1)), between([0.1, 1.0], draw(2)));
            material.mean_free_path = shares * longest;
        }
    }
    if let Some(lamp) = variation.lamp {
        look.lights = vec![lamp.light()];
    }
    if let Some(environment) = props.environment(seed) {
        look.environment = Some(environment.clone());
    }
    if let Some(fog) = variation.fog {
        let refused =
            |error: MediumError| SceneError::invalid(scene.scene().name.as_ref(), error.to_string());
        look.medium = Some(fog.medium(scene).map_err(refused)?.into());
    }
    Ok(look)
}

/// Draws the parameters of the Phong model, diffuse and specular colour and glossiness (thesis 7.3.1, which
/// does not say how they are distributed). The diffuse colour is paler where a texture brings colours; two
/// colours that reflect more than there is are dimmed alike until they reflect all of it.
fn paint(material: &mut Material, textured: bool, draw: impl Fn(u64) -> f32) {
    let colour = |first: u64, most_saturated: f32, brightness: [f32; 2]| {
        let hue = Vec3::from_array(std::array::from_fn(|channel| draw(first + 2 + channel as u64)));
        let saturation = most_saturated * draw(first + 1);
        between(brightness, draw(first)) * Vec3::ONE.lerp(hue / hue.max_element().max(1e-3), saturation)
    };
    let diffuse = if textured { colour(0, 0.3, [0.7, 1.0]) } else { colour(0, 0.8, [0.2, 0.9]) };
    let specular = colour(5, 0.8, [0.0, 0.9]);
    let dimmed = (diffuse + specular).max_element().max(1.0).recip();
    material.base_colour = (dimmed * diffuse).extend(material.base_colour.w);
    material.specular = Some(dimmed * specular);
    material.roughness = between([0.1, 1.0], draw(10));
    material.metallic_roughness_texture = None;
    material.gloss = Gloss::Phong;
}

/// Gives a material a texture, one to eight times as small as its coordinates say.
fn cover(material: &mut Material, texture: TextureId, share: f32) {
    let repeats = Affine2::from_scale(Vec2::splat(between_ratios([1.0, 8.0], share)));
    let (uv_set, transform) =
        material.base_colour_texture.map_or((0, Affine2::IDENTITY), |slot| (slot.uv_set, slot.transform));
    material.base_colour_texture = Some(TextureSlot { texture, uv_set, transform: repeats * transform });
}
