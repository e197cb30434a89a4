//! Materials as the GPU reads them.

use super::texture::Textures;
use crate::bvh::VISIBLE_OPACITY;
use crate::scene::{AlphaMode, Gloss, Material, TextureSlot};
use deepshade_shaders::gpu::{self, GpuError, RasterPass};
use deepshade_shaders::wgsl::uniforms::MaterialRecord;
use glam::Affine2;

/// What a material is on the GPU. Blended surfaces are there where a camera's rays see them: from half
/// opacity on.
pub fn record(material: &Material) -> MaterialRecord {
    let limit = match material.alpha {
        AlphaMode::Opaque => f32::MIN,
        AlphaMode::Mask(cutoff) => cutoff,
        AlphaMode::Blend => VISIBLE_OPACITY,
    };
    let gloss = match material.gloss {
        Gloss::Microfacets => 0.0,
        Gloss::Phong => 1.0,
        Gloss::None => 2.0,
    };
    let [base_linear, base_rest] = slot(material.base_colour_texture);
    let [gloss_linear, gloss_rest] = slot(material.metallic_roughness_texture);
    let [normal_linear, normal_rest] = slot(material.normal_texture.map(|(slot, _)| slot));
    let [emission_linear, emission_rest] = slot(material.emission_texture);
    MaterialRecord {
        base: material.base_colour.to_array(),
        factors: [material.metallic, material.roughness, limit, material.dielectric_specular()],
        emission: material
            .emission
            .extend(material.normal_texture.map_or(0.0, |(_, scale)| scale))
            .to_array(),
        specular: material.specular.map_or([0.0; 4], |colour| {
            colour.clamp(glam::Vec3::ZERO, glam::Vec3::ONE).extend(1.0).to_array()
        }),
        gloss_path: [gloss, material.mean_free_path.x, material.mean_free_path.y, material.mean_free_path.z],
        base_linear,
        base_rest,
        gloss_linear,
        gloss_rest,
        normal_linear,
        normal_rest,
        emission_linear,
        emission_rest,
    }
}

/// The transform of a slot's coordinates, and which set they are.
fn slot(slot: Option<TextureSlot>) -> [[f32; 4]; 2] {
    let (transform, set) = slot.map_or((Affine2::IDENTITY, 0), |slot| (slot.transform, slot.uv_set));
    let [a, b, c, d, x, y] = transform.to_cols_array();
    [[a, b, c, d], [x, y, set as f32, 0.0]]
}

/// What a raster pass reads of a material: bind group 1. A shadow map's pass knows of alpha alone.
///
/// # Errors
/// If the device refuses.
pub fn bind(
    device: &wgpu::Device,
    pass: &RasterPass,
    material: &Material,
    textures: &Textures,
    alpha_alone: bool,
) -> Result<wgpu::BindGroup, GpuError> {
    let record = gpu::uniform(device, "material", &record(material))?;
    let slots = [
        material.base_colour_texture,
        material.metallic_roughness_texture,
        material.normal_texture.map(|(slot, _)| slot),
        material.emission_texture,
    ];
    let mut resources = vec![(0, record.as_entire_binding())];
    for (index, slot) in (0..).zip(slots).take(if alpha_alone { 1 } else { 4 }) {
        let (view, sampler) = textures.get(slot.map(|slot| slot.texture.0 as usize));
        resources.push((1 + index, wgpu::BindingResource::TextureView(view)));
        resources.push((5 + index, wgpu::BindingResource::Sampler(sampler)));
    }
    pass.bind(device, 1, resources)
}
