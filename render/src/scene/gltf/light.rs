//! Lights and cameras of the nodes that a scene shows.
//!
//! glTF states light in photometric units: candela for points and spots, lux for directional lights, and
//! candela per square metre for emission (KHR_lights_punctual, KHR_materials_emissive_strength). All three
//! are taken as watts one to one. Dividing by 683 lm/W would scale every light of a scene alike, but files in
//! circulation write values near 1 for both lights and emission, so one to one keeps the ratio of lights to
//! emission that a file states, and gives radiances near 1.
//!
//! glTF's lights project no pictures. Those of a light here are said in its `extras`, by the index of one of
//! the file's textures, whose colours are taken as sRGB: a spot's `{"slide": 0}` is what its outer cone
//! projects; a directional light's `{"pattern": 0, "patternWidth": 4.0}` is a picture across the light, like
//! clouds, that repeats after so many metres. What else extras hold means nothing here.

use super::{
    super::{Camera, Light, SceneError, TextureId, texture::Encoding},
    document::File,
    node::{Hierarchy, label},
    texture::TextureList,
};
use glam::{Mat3, Mat4, Vec3};
use gltf::{
    json::{self, Value},
    khr_lights_punctual::{Kind, Light as FileLight},
};
use std::f32::consts::PI;

/// The lights that the scene shows; the textures that they project are added.
pub(super) fn lights(
    file: &File<'_>,
    hierarchy: &Hierarchy,
    textures: &mut TextureList,
) -> Result<Vec<Light>, SceneError> {
    let lights = hierarchy.nodes(file).filter_map(|(node, world)| Some((node.light()?, label(&node), world)));
    lights
        .map(|(light, node, world)| {
            let picture = |key: &str| picture(file, &light, key, textures);
            read_light(&light, world, picture)
                .map_err(|what| file.invalid(format!("the light of {node}: {what}")))
        })
        .collect()
}

/// What a light's extras say of a key, if they are an object.
fn extra(light: &FileLight<'_>, key: &str) -> Option<Value> {
    let extras: Value = json::deserialize::from_str(light.extras().as_ref()?.get()).ok()?;
    extras.get(key).cloned()
}

/// The texture that a key of a light's extras names.
fn picture(
    file: &File<'_>,
    light: &FileLight<'_>,
    key: &str,
    textures: &mut TextureList,
) -> Result<Option<TextureId>, String> {
    let Some(value) = extra(light, key) else { return Ok(None) };
    let index = value.as_u64().and_then(|index| usize::try_from(index).ok());
    let count = file.document.textures().len();
    let index = index.filter(|index| *index < count);
    let index = index.ok_or_else(|| format!("its {key} is {value}, none of the file's {count} textures"))?;
    Ok(textures.add(file, index, Encoding::Srgb))
}

/// The metres after which a directional light's pattern repeats.
fn pattern_width(light: &FileLight<'_>) -> Result<f32, String> {
    let value = extra(light, "patternWidth").unwrap_or_default();
    let width = value.as_f64().map(|width| width as f32).filter(|width| width.is_finite() && *width > 0.0);
    width.ok_or_else(|| format!("its patternWidth is {value}, not a width above 0"))
}

fn read_light(
    light: &FileLight<'_>,
    world: Mat4,
    picture: impl FnOnce(&str) -> Result<Option<TextureId>, String>,
) -> Result<Light, String> {
    let power = Vec3::from(light.color()) * light.intensity();
    let position = world.w_axis.truncate();
    let direction = (-world.z_axis.truncate()).try_normalize();
    if !power.is_finite() || !position.is_finite() {
        return Err("its power or place is not finite".to_owned());
    }
    // Lengths are not scaled by the node (KHR_lights_punctual).
    let range = light.range().unwrap_or(f32::INFINITY);
    if range.is_nan() || range <= 0.0 {
        return Err(format!("its range {range} is not above 0"));
    }
    let direction = || direction.ok_or_else(|| "it has no direction".to_owned());
    match light.kind() {
        Kind::Point => Ok(Light::Point { position, intensity: power, range }),
        Kind::Directional => {
            let pattern = match picture("pattern")? {
                Some(texture) => Some((texture, pattern_width(light)?)),
                None => None,
            };
            Ok(Light::Directional { direction: direction()?, irradiance: power, pattern })
        }
        Kind::Spot { inner_cone_angle: inner, outer_cone_angle: outer } => {
            // Angles that differ in the file's decimals may be the same in f32.
            if !(0.0..=outer).contains(&inner) || outer == 0.0 || outer > 0.5 * PI + 1e-4 {
                return Err(format!("cone angles {inner} and {outer} are not 0 <= inner < outer <= pi/2"));
            }
            // Of cones that are alike or nearly, the cosines may be the same; their edge is hard.
            let (cos_inner, cos_outer) = (inner.cos(), outer.cos().min(inner.cos().next_down()));
            let direction = direction()?;
            Ok(Light::Spot {
                position,
                direction,
                intensity: power,
                range,
                cos_inner,
                cos_outer,
                slide: picture("slide")?,
            })
        }
    }
}

/// The perspective cameras that the scene shows, with their names; orthographic ones are no pinhole cameras
/// and are left out. Aspect ratios are left to the image.
pub(super) fn cameras(file: &File<'_>, hierarchy: &Hierarchy) -> Result<Vec<(String, Camera)>, SceneError> {
    let mut cameras = Vec::new();
    for (node, world) in hierarchy.nodes(file) {
        let Some(index) = node.camera().map(|camera| camera.index()) else { continue };
        let camera = &file.document.as_json().cameras[index];
        let Some(perspective) = &camera.perspective else { continue };
        let error = |what: &str| file.invalid(format!("the camera of {} {what}", label(&node)));
        if !(perspective.yfov > 0.0 && perspective.yfov < PI) {
            return Err(error("has no field of view between 0 and pi"));
        }
        let rotation = rotation(world).ok_or_else(|| error("has no direction"))?;
        let name = node.name().map(str::to_owned).or(camera.name.clone());
        cameras.push((
            name.unwrap_or_else(|| format!("camera {index}")),
            Camera {
                position: world.w_axis.truncate(),
                rotation,
                vertical_fov: perspective.yfov,
                lens: None,
            },
        ));
    }
    Ok(cameras)
}

/// The rotation of a transform: its z and y axes made orthonormal, x to the right of them. Scale has no part
/// in it.
fn rotation(world: Mat4) -> Option<Mat3> {
    let finite = world.is_finite();
    let backward = world.z_axis.truncate().try_normalize().filter(|_| finite)?;
    let right = world.y_axis.truncate().cross(backward).try_normalize()?;
    Some(Mat3::from_cols(right, backward.cross(right), backward))
}
