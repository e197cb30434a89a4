//! What Phong materials become, and the images that they read.

use super::library::MtlMaterial;
use super::map::Map;
use crate::scene::decode::{self, Image};
use crate::scene::file;
use crate::scene::texture::{Encoding, Wrap};
use crate::scene::{AlphaMode, Material, SceneError, Texture, TextureId, TextureSlot};
use glam::Vec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Alpha below which a texel of a dissolve map is a hole.
const CUTOFF: f32 = 0.5;

/// A library's materials.
pub(super) struct Library {
    pub path: PathBuf,
    pub materials: Vec<MtlMaterial>,
}

/// Materials and textures of some libraries, in their order.
///
/// # Errors
/// If an image is damaged.
pub(super) fn convert(libraries: &[Library]) -> Result<(Vec<Material>, Vec<Arc<Texture>>), SceneError> {
    let mut textures = Textures::default();
    let mut converted = Vec::new();
    for stated in libraries.iter().flat_map(|library| &library.materials) {
        let [colour, alpha] = [&stated.diffuse_map, &stated.dissolve_map].map(Option::as_ref);
        let [emission, normal] = [&stated.emission_map, &stated.normal_map].map(Option::as_ref);
        let strength = normal.map_or(1.0, |normal| normal.strength);
        converted.push(Material {
            base_colour_texture: textures.slot(colour, alpha, Encoding::Srgb)?,
            emission_texture: textures.slot(emission, None, Encoding::Srgb)?,
            normal_texture: textures.slot(normal, None, Encoding::Linear)?.map(|slot| (slot, strength)),
            ..constants(stated)
        });
    }
    Ok((converted, textures.read))
}

/// What a texture is made of: one image's colours, another's alpha, and how it is read.
#[derive(PartialEq)]
struct Kind {
    colour: Option<PathBuf>,
    alpha: Option<Alpha>,
    encoding: Encoding,
    wrap: Wrap,
}

/// An image whose texels are opacity, or transparency.
#[derive(PartialEq)]
struct Alpha {
    path: PathBuf,
    is_inverse: bool,
}

/// The textures of a scene, each made once, of images that are read once.
#[derive(Default)]
struct Textures {
    known: Vec<Kind>,
    read: Vec<Arc<Texture>>,
    images: BTreeMap<PathBuf, Image>,
}

impl Textures {
    /// A texture of one image's colours and another's alpha, if there is either, placed as the first of them.
    fn slot(
        &mut self,
        colour: Option<&Map>,
        alpha: Option<&Map>,
        encoding: Encoding,
    ) -> Result<Option<TextureSlot>, SceneError> {
        let Some(Map { placement, .. }) = colour.or(alpha) else { return Ok(None) };
        let wrap = if placement.is_clamped { Wrap::Clamp } else { Wrap::Repeat };
        let kind = Kind {
            colour: colour.map(|map| map.path.clone()),
            alpha: alpha.map(|map| Alpha { path: map.path.clone(), is_inverse: map.is_inverse }),
            encoding,
            wrap,
        };
        let index = self.known.iter().position(|known| *known == kind).unwrap_or(self.known.len());
        if index == self.known.len() {
            let image = self.image(kind.colour.as_deref(), kind.alpha.as_ref())?;
            self.read.push(Arc::new(Texture::of(&image, encoding, [wrap; 2])));
            self.known.push(kind);
        }
        let texture = TextureId(index as u32);
        Ok(Some(TextureSlot { texture, uv_set: 0, transform: placement.transform() }))
    }

    /// One image's colours, white without one, with another as its alpha.
    fn image(&mut self, colour: Option<&Path>, alpha: Option<&Alpha>) -> Result<Image, SceneError> {
        let white = Image { width: 1, height: 1, texels: [[255; 4]].into() };
        let colour = colour.map(|path| self.read_image(path)).transpose()?;
        let Some(Alpha { path, is_inverse }) = alpha else { return Ok(colour.unwrap_or(white)) };
        let alpha = self.read_image(path)?;
        let [width, height] =
            colour.as_ref().map_or([alpha.width, alpha.height], |colour| [colour.width, colour.height]);
        decode::check(width, height).map_err(|what| SceneError::invalid(path, what))?;
        Ok(with_alpha(&colour.unwrap_or(white), &alpha, *is_inverse, [width, height]))
    }

    fn read_image(&mut self, path: &Path) -> Result<Image, SceneError> {
        if let Some(image) = self.images.get(path) {
            return Ok(image.clone());
        }
        let image = decode::decode(&file::read(path)?).map_err(|what| SceneError::invalid(path, what))?;
        self.images.insert(path.to_owned(), image.clone());
        Ok(image)
    }
}

/// What a material says without textures.
fn constants(stated: &MtlMaterial) -> Material {
    let alpha = stated.dissolve.unwrap_or(1.0);
    let emission_unless_stated = if stated.emission_map.is_some() { Vec3::ONE } else { Vec3::ZERO };
    Material {
        name: stated.name.clone(),
        base_colour: stated.diffuse.unwrap_or(Vec3::ONE).extend(alpha),
        metallic: stated.metallic.unwrap_or(0.0),
        roughness: stated.roughness.unwrap_or_else(|| roughness(stated)),
        emission: stated.emission.unwrap_or(emission_unless_stated),
        alpha: match (&stated.dissolve_map, alpha) {
            (Some(_), _) => AlphaMode::Mask(CUTOFF),
            (None, alpha) if alpha < 1.0 => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        },
        ..Material::default()
    }
}

/// Perceptual roughness from a Phong exponent n: the microfacet width alpha is sqrt(2 / (n + 2)) (Walter et
/// al. 2007, "Microfacet Models for Refraction"), and glTF's roughness its square root. No highlight is as
/// rough as can be.
fn roughness(stated: &MtlMaterial) -> f32 {
    let has_highlight = stated.specular.is_some_and(|specular| specular.max_element() > 0.0);
    let exponent = stated.exponent.filter(|_| has_highlight).unwrap_or(0.0);
    (2.0 / (exponent.max(0.0) + 2.0)).powf(0.25)
}

/// The colours of one image with the alpha of another, or its red where that is opaque throughout, or what
/// they lack of 1.
fn with_alpha(colour: &Image, alpha: &Image, is_inverse: bool, [width, height]: [usize; 2]) -> Image {
    let channel = if alpha.texels.iter().any(|texel| texel[3] < 255) { 3 } else { 0 };
    let nearest = |image: &Image, x: usize, y: usize| {
        image.texels[y * image.height / height * image.width + x * image.width / width]
    };
    let texel = |index: usize| {
        let (x, y) = (index % width, index / width);
        let [r, g, b, _] = nearest(colour, x, y);
        let value = nearest(alpha, x, y)[channel];
        [r, g, b, if is_inverse { 255 - value } else { value }]
    };
    Image { width, height, texels: (0..width * height).map(texel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sharp_highlight_is_smooth_and_none_is_rough() {
        let stated = |specular, exponent| MtlMaterial {
            specular: Some(Vec3::splat(specular)),
            exponent: Some(exponent),
            ..MtlMaterial::default()
        };
        assert_eq!(roughness(&stated(0.0, 100.0)), 1.0);
        assert!((roughness(&stated(0.5, 30.0)) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn a_dissolve_map_becomes_alpha() {
        let colour = Image { width: 1, height: 1, texels: [[1, 2, 3, 255]].into() };
        let grey = Image { width: 2, height: 1, texels: [[10, 0, 0, 255], [20, 0, 0, 255]].into() };
        assert_eq!(with_alpha(&colour, &grey, false, [2, 1]).texels[..], [[1, 2, 3, 10], [1, 2, 3, 20]]);
        assert_eq!(with_alpha(&colour, &grey, true, [2, 1]).texels[..], [[1, 2, 3, 245], [1, 2, 3, 235]]);
        let cut = Image { width: 2, height: 1, texels: [[10, 0, 0, 0], [20, 0, 0, 255]].into() };
        assert_eq!(with_alpha(&colour, &cut, false, [2, 1]).texels[..], [[1, 2, 3, 0], [1, 2, 3, 255]]);
    }
}
