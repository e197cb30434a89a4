//! Materials: metallic-roughness, with emissive strength, texture transforms and layers (glTF 2.0, 3.9).

use super::{
    super::{AlphaMode, Material, SceneError, TextureSlot, texture::Encoding},
    document::File,
    layers,
    texture::TextureList,
};
use glam::{Affine2, Vec3};
use gltf::json::{
    self,
    extensions::texture::TextureTransform,
    material::{AlphaMode as FileAlphaMode, NormalTexture},
    texture::Info,
    validation::Checked,
};

/// The name of the extension, where it is not part of the parsed JSON.
const TEXTURE_TRANSFORM: &str = "KHR_texture_transform";

/// All materials of a file, in its order, then the one of primitives without a material; their textures are
/// added.
pub(super) fn read(file: &File<'_>, textures: &mut TextureList) -> Result<Vec<Material>, SceneError> {
    let written = file.document.as_json().materials.iter().enumerate();
    let mut materials: Vec<_> = written
        .map(|(index, material)| read_one(file, index, material, textures))
        .collect::<Result<_, _>>()?;
    let mut primitives = file.document.meshes().flat_map(|mesh| mesh.primitives());
    if primitives.any(|primitive| primitive.material().index().is_none()) {
        materials.push(without_material());
    }
    Ok(materials)
}

/// The material of primitives without one: rough, white and no metal. By glTF's defaults it would be a metal
/// (3.7.2.1), which reflects no diffuse light.
fn without_material() -> Material {
    Material { name: "none".to_owned(), ..Material::default() }
}

fn read_one(
    file: &File<'_>,
    index: usize,
    material: &json::Material,
    textures: &mut TextureList,
) -> Result<Material, SceneError> {
    let name = material.name.clone().unwrap_or_else(|| format!("material {index}"));
    let base = &material.pbr_metallic_roughness;
    let extensions = material.extensions.as_ref();
    let strength = extensions.and_then(|extensions| extensions.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
    let error = |what: String| file.invalid(format!("material `{name}`: {what}"));
    let layers = layers::read(file, material, textures).map_err(error)?;
    let mut slot = |info: Option<&Info>, encoding| {
        info.map_or(Ok(None), |info| plain_slot(file, info, encoding, textures))
    };
    let read = Material {
        base_colour: base.base_color_factor.0.into(),
        base_colour_texture: slot(base.base_color_texture.as_ref(), Encoding::Srgb).map_err(error)?,
        metallic: base.metallic_factor.0,
        roughness: base.roughness_factor.0,
        metallic_roughness_texture: slot(base.metallic_roughness_texture.as_ref(), Encoding::Linear)
            .map_err(error)?,
        emission: Vec3::from(material.emissive_factor.0) * strength,
        emission_texture: slot(material.emissive_texture.as_ref(), Encoding::Srgb).map_err(error)?,
        normal_texture: material
            .normal_texture
            .as_ref()
            .map_or(Ok(None), |info| normal_slot(file, info, textures))
            .map_err(error)?,
        alpha: match material.alpha_mode {
            Checked::Valid(FileAlphaMode::Mask) => {
                AlphaMode::Mask(material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0))
            }
            Checked::Valid(FileAlphaMode::Blend) => AlphaMode::Blend,
            Checked::Valid(FileAlphaMode::Opaque) | Checked::Invalid => AlphaMode::Opaque,
        },
        name: name.clone(),
        ior: layers.ior.unwrap_or(Material::default().ior),
        transmission: layers.transmission,
        coat: layers.coat,
        ..Material::default()
    };
    let finite = read.base_colour.is_finite() && read.emission.is_finite();
    let finite = finite && read.metallic.is_finite() && read.roughness.is_finite();
    finite.then_some(read).ok_or_else(|| error("holds a value that is not finite".to_owned()))
}

/// The slot of a texture other than a normal map, if it has an image.
pub(super) fn plain_slot(
    file: &File<'_>,
    info: &Info,
    encoding: Encoding,
    textures: &mut TextureList,
) -> Result<Option<TextureSlot>, String> {
    let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.clone());
    slot(file, info.index.value(), info.tex_coord, transform.unwrap_or_default(), encoding, textures)
}

/// The slot of a normal map, if it has an image, with the map's strength.
pub(super) fn normal_slot(
    file: &File<'_>,
    info: &NormalTexture,
    textures: &mut TextureList,
) -> Result<Option<(TextureSlot, f32)>, String> {
    let transform = info.extensions.as_ref().and_then(|extensions| extensions.others.get(TEXTURE_TRANSFORM));
    let transform = match transform {
        Some(value) => {
            json::deserialize::from_value(value.clone()).map_err(|error| format!("normal map: {error}"))?
        }
        None => TextureTransform::default(),
    };
    let slot = slot(file, info.index.value(), info.tex_coord, transform, Encoding::Linear, textures)?;
    if !info.scale.is_finite() {
        return Err("the strength of its normal map is not finite".to_owned());
    }
    Ok(slot.map(|slot| (slot, info.scale)))
}

fn slot(
    file: &File<'_>,
    texture: usize,
    uv_set: u32,
    transform: TextureTransform,
    encoding: Encoding,
    textures: &mut TextureList,
) -> Result<Option<TextureSlot>, String> {
    let uv_set = transform.tex_coord.unwrap_or(uv_set) as usize;
    let transform = affine(&transform);
    if !transform.is_finite() {
        return Err(format!("{TEXTURE_TRANSFORM} holds a value that is not finite"));
    }
    let count = file.document.textures().len();
    if texture >= count {
        return Err(format!("reads texture {texture} of {count}"));
    }
    if uv_set > 1 {
        textures.leave_out(texture, uv_set);
        return Ok(None);
    }
    let texture = textures.add(file, texture, encoding);
    Ok(texture.map(|texture| TextureSlot { texture, uv_set, transform }))
}

/// What KHR_texture_transform does to coordinates: scale, then rotate, then move. With v pointing down, as in
/// glTF, its counter-clockwise angle is a clockwise one in (u, v); Khronos' TextureTransformMultiTest shows
/// the sense.
fn affine(transform: &TextureTransform) -> Affine2 {
    Affine2::from_scale_angle_translation(
        transform.scale.0.into(),
        -transform.rotation.0,
        transform.offset.0.into(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use json::extensions::texture::{
        TextureTransformOffset, TextureTransformRotation, TextureTransformScale,
    };

    #[test]
    fn a_texture_transform_scales_then_rotates_then_moves() {
        let transform = TextureTransform {
            offset: TextureTransformOffset([0.5, 0.25]),
            rotation: TextureTransformRotation(std::f32::consts::FRAC_PI_2),
            scale: TextureTransformScale([2.0, 3.0]),
            ..TextureTransform::default()
        };
        let moved = affine(&transform).transform_point2(Vec2::new(0.1, 0.2));
        assert!((moved - Vec2::new(0.5 + 0.6, 0.25 - 0.2)).length() < 1e-6, "{moved}");
    }
}
