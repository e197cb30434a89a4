//! What objects look like in an image.

use super::draw::{between, between_ratios, purpose};
use super::{Props, Variation, Vary};
use crate::random::{mix, uniform};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::box_mapping::box_map;
use deepshade_render::scene::{AlphaMode, Gloss, Look, Material, MaterialId, Scene, TextureId, TextureSlot};
use glam::{Affine2, Vec2, Vec3};

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

/// The look of an image of a scene that was prepared.
pub(super) fn look(scene: &TracedScene, vary: &Vary, variation: &Variation, props: &Props) -> Look {
    let mut look = scene.scene().look();
    let first = look.textures.len();
    look.textures.extend(props.textures().iter().cloned());
    let seed = u64::from(variation.seed);
    for (index, material) in look.materials.iter_mut().enumerate() {
        let words = |purpose: u64, which: u64| [seed, purpose, index as u64, which];
        let textured = vary.textures.is_some() && material.alpha == AlphaMode::Opaque;
        if vary.materials {
            let draw = |which: u64| uniform(&words(purpose::MATERIAL, which));
            paint(material, textured, draw);
        }
        if textured {
            let chosen = mix(&words(purpose::TEXTURE, 0)) % props.textures().len() as u64;
            let texture = TextureId((first as u64 + chosen) as u32);
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
    if let Some(environment) = props.environment() {
        look.environment = Some(environment.clone());
    }
    if let Some(fog) = variation.fog {
        look.medium = Some(fog.medium(scene).into());
    }
    look
}

/// Some of every colour is diffuse, since a bare metal is black but where it mirrors the one lamp.
const MOST_METALLIC: f32 = 0.9;

/// Draws colour, metalness and roughness; paler where a texture brings colours.
fn paint(material: &mut Material, textured: bool, draw: impl Fn(u64) -> f32) {
    let saturation = draw(0) * if textured { 0.3 } else { 0.8 };
    let value = between(if textured { [0.7, 1.0] } else { [0.2, 0.9] }, draw(1));
    let hue = Vec3::new(draw(2), draw(3), draw(4));
    let colour = value * Vec3::ONE.lerp(hue / hue.max_element().max(1e-3), saturation);
    material.base_colour = colour.extend(material.base_colour.w);
    material.metallic = if draw(5) < 0.5 { 0.0 } else { MOST_METALLIC * draw(6) };
    material.roughness = between([0.1, 1.0], draw(7));
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
