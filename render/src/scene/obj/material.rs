//! MTL material libraries, and what their Phong materials become.

use super::{
    super::{
        AlphaMode, Material, SceneError, Texture, TextureId, TextureSlot,
        file::{self, Image},
        texture::{Encoding, Wrap},
    },
    lines::check_colours,
};
use glam::{Affine2, Vec3};
use std::{
    cell::RefCell,
    path::{Path, PathBuf},
};
use tobj::LoadError;

/// Alpha below which a texel of a dissolve map is a hole.
const CUTOFF: f32 = 0.5;

/// Reads the material libraries of an OBJ file and remembers the first failure, which the parser has no words for.
pub(super) struct Library {
    folder: PathBuf,
    failure: RefCell<Option<SceneError>>,
}

impl Library {
    pub fn new(obj: &Path) -> Self {
        let folder = obj.parent().unwrap_or(Path::new("")).to_owned();
        Self { folder, failure: RefCell::new(None) }
    }

    /// Reads one library; texture names become paths, from the library's folder.
    pub fn read(&self, name: &Path) -> tobj::MTLLoadResult {
        let path = self.folder.join(name.to_string_lossy().replace('\\', "/"));
        let text = text(&path).map_err(|error| self.remember(error))?;
        let parsed = tobj::load_mtl_buf(&mut text.as_bytes());
        let (mut materials, names) =
            parsed.map_err(|error| self.remember(SceneError::invalid(&path, error.to_string())))?;
        find_textures(&path, &mut materials).map_err(|error| self.remember(error))?;
        Ok((materials, names))
    }

    /// Keeps an error for [`Self::failure`]; the parser gets one without words.
    fn remember(&self, error: SceneError) -> LoadError {
        self.failure.borrow_mut().get_or_insert(error);
        LoadError::GenericFailure
    }

    /// The first failure, if there was one.
    pub fn failure(self) -> Result<(), SceneError> {
        self.failure.into_inner().map_or(Ok(()), Err)
    }
}

/// The text of a library, whose colours were looked at.
fn text(path: &Path) -> Result<String, SceneError> {
    let text = String::from_utf8_lossy(&file::read(path)?).into_owned();
    check_colours(&text).map_err(|what| SceneError::invalid(path, what))?;
    Ok(text)
}

/// Makes the texture names of a library's materials paths.
fn find_textures(library: &Path, materials: &mut [tobj::Material]) -> Result<(), SceneError> {
    let folder = library.parent().unwrap_or(Path::new(""));
    for material in materials {
        for texture in [&mut material.diffuse_texture, &mut material.dissolve_texture].into_iter().flatten() {
            if texture.starts_with('-') {
                let what =
                    format!("material `{}`: texture options are not supported: `{texture}`", material.name);
                return Err(SceneError::invalid(library, what));
            }
            *texture = folder.join(texture.replace('\\', "/")).to_string_lossy().into_owned();
        }
    }
    Ok(())
}

/// The materials and textures of a scene. `obj` is named in errors.
pub(super) fn convert(
    obj: &Path,
    materials: &[tobj::Material],
) -> Result<(Vec<Material>, Vec<Texture>), SceneError> {
    let mut known: Vec<(Option<&str>, Option<&str>)> = Vec::new();
    let mut textures = Vec::new();
    let mut converted = Vec::new();
    for material in materials {
        let maps = (material.diffuse_texture.as_deref(), material.dissolve_texture.as_deref());
        let mut base_colour_texture = None;
        if maps != (None, None) {
            let index = known.iter().position(|other| *other == maps).unwrap_or(known.len());
            if index == known.len() {
                textures.push(texture(maps.0, maps.1)?);
                known.push(maps);
            }
            let texture = TextureId(index as u32);
            base_colour_texture = Some(TextureSlot { texture, uv_set: 0, transform: Affine2::IDENTITY });
        }
        let converted_one = Material { base_colour_texture, ..constants(material) };
        if !converted_one.base_colour.is_finite() || !converted_one.roughness.is_finite() {
            let what = format!("material `{}` holds a value that is not finite", material.name);
            return Err(SceneError::invalid(obj, what));
        }
        converted.push(converted_one);
    }
    Ok((converted, textures))
}

/// What a material says without textures.
fn constants(material: &tobj::Material) -> Material {
    let transparency = || material.unknown_param.get("Tr").and_then(|text| text.parse::<f32>().ok());
    let alpha = material.dissolve.or_else(|| transparency().map(|value| 1.0 - value)).unwrap_or(1.0);
    Material {
        name: material.name.clone(),
        base_colour: Vec3::from(material.diffuse.unwrap_or([1.0; 3])).extend(alpha),
        roughness: roughness(material),
        emission: Vec3::from(material.emissive.unwrap_or([0.0; 3])),
        alpha: match (&material.dissolve_texture, alpha) {
            (Some(_), _) => AlphaMode::Mask(CUTOFF),
            (None, alpha) if alpha < 1.0 => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        },
        ..Material::default()
    }
}

/// Perceptual roughness from a Phong exponent n: the microfacet width alpha is sqrt(2 / (n + 2)) (Walter et al. 2007,
/// "Microfacet Models for Refraction"), and glTF's roughness its square root. No highlight is as rough as can be.
fn roughness(material: &tobj::Material) -> f32 {
    let has_highlight = material.specular.is_some_and(|specular| specular.iter().any(|value| *value > 0.0));
    let exponent = material.shininess.filter(|_| has_highlight).unwrap_or(0.0);
    (2.0 / (exponent.max(0.0) + 2.0)).powf(0.25)
}

/// The base colour texture of a diffuse map, with a dissolve map as its alpha.
fn texture(diffuse: Option<&str>, dissolve: Option<&str>) -> Result<Texture, SceneError> {
    let white = Image { width: 1, height: 1, texels: vec![[255; 4]] };
    let colour = diffuse.map(read_image).transpose()?;
    let alpha = dissolve.map(read_image).transpose()?;
    let image = match (colour, alpha) {
        (Some(colour), None) => colour,
        (Some(colour), Some(alpha)) => with_alpha(&colour, &alpha, colour.width, colour.height),
        (None, Some(alpha)) => with_alpha(&white, &alpha, alpha.width, alpha.height),
        (None, None) => white,
    };
    Ok(Texture::new(image.width, image.height, image.texels, Encoding::Srgb, [Wrap::Repeat; 2]))
}

fn read_image(path: &str) -> Result<Image, SceneError> {
    let path = Path::new(path);
    file::decode(&file::read(path)?).map_err(|what| SceneError::invalid(path, what))
}

/// The colours of one image with the alpha of another, or its red where that is opaque throughout.
fn with_alpha(colour: &Image, alpha: &Image, width: usize, height: usize) -> Image {
    let channel = if alpha.texels.iter().any(|texel| texel[3] < 255) { 3 } else { 0 };
    let nearest = |image: &Image, x: usize, y: usize| {
        image.texels[y * image.height / height * image.width + x * image.width / width]
    };
    let texel = |index: usize| {
        let (x, y) = (index % width, index / width);
        let [r, g, b, _] = nearest(colour, x, y);
        [r, g, b, nearest(alpha, x, y)[channel]]
    };
    Image { width, height, texels: (0..width * height).map(texel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sharp_highlight_is_smooth_and_none_is_rough() {
        let material = |specular, shininess| tobj::Material {
            specular: Some(specular),
            shininess: Some(shininess),
            ..tobj::Material::default()
        };
        assert_eq!(roughness(&material([0.0; 3], 100.0)), 1.0);
        assert!((roughness(&material([0.5; 3], 30.0)) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn a_dissolve_map_becomes_alpha() {
        let colour = Image { width: 1, height: 1, texels: vec![[1, 2, 3, 255]] };
        let grey = Image { width: 2, height: 1, texels: vec![[10, 0, 0, 255], [20, 0, 0, 255]] };
        assert_eq!(with_alpha(&colour, &grey, 2, 1).texels, [[1, 2, 3, 10], [1, 2, 3, 20]]);
        let cut = Image { width: 2, height: 1, texels: vec![[10, 0, 0, 0], [20, 0, 0, 255]] };
        assert_eq!(with_alpha(&colour, &cut, 2, 1).texels, [[1, 2, 3, 0], [1, 2, 3, 255]]);
    }
}
