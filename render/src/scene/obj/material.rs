//! MTL material libraries, and what their Phong materials become.
//!
//! Read are `Kd`, `d`, `Tr`, `Ke`, `Ks` and `Ns` as the width of the highlight, `map_Kd`, `map_d`, and of the extension
//! for physically based rendering `Pr`, `Pm`, `map_Ke` and `norm`. Left out are what the g-buffer has no channel for
//! (`Ka`, `Ni`, `Tf`, `illum`, `sharpness`, `Ps`, `Pc`, `Pcr`, `aniso`, `anisor`, `map_Ka`, `refl`), a highlight that
//! varies over a surface (`map_Ks`, `map_Ns`, `map_Pr`, `map_Pm`), and relief (`bump`, `map_Bump`, `disp`): those images
//! hold heights in units that the file does not state, where `norm` holds normals.

use super::{
    super::{
        AlphaMode, Material, SceneError, Texture, TextureId, TextureSlot,
        decode::{self, Image},
        file,
        texture::{Encoding, Wrap},
    },
    lines::check_colours,
};
use glam::{Affine2, Vec3};
use std::sync::Arc;
use std::{
    cell::RefCell,
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use tobj::LoadError;

/// Alpha below which a texel of a dissolve map is a hole.
const CUTOFF: f32 = 0.5;

/// Keywords of maps that the parser does not know.
const EMISSION_MAP: &str = "map_Ke";
const NORMAL_MAP: &str = "norm";

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
        let name = name.to_string_lossy().replace('\\', "/");
        let path = file::beside(&self.folder, Path::new(""), &name)
            .map_err(|what| self.remember(SceneError::invalid(&self.folder, what)))?;
        let text = text(&path).map_err(|error| self.remember(error))?;
        let parsed = tobj::load_mtl_buf(&mut text.as_bytes());
        let (mut materials, names) =
            parsed.map_err(|error| self.remember(SceneError::invalid(&path, error.to_string())))?;
        find_textures(&self.folder, &path, &mut materials).map_err(|error| self.remember(error))?;
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

/// Makes the texture names of the materials of a library, which is below the scene's folder, paths.
fn find_textures(folder: &Path, library: &Path, materials: &mut [tobj::Material]) -> Result<(), SceneError> {
    for tobj::Material { name, diffuse_texture, dissolve_texture, unknown_param, .. } in materials {
        for texture in [diffuse_texture, dissolve_texture].into_iter().flatten() {
            *texture = texture_path([folder, library], name, texture)?;
        }
        for map in [EMISSION_MAP, NORMAL_MAP] {
            if let Some(texture) = unknown_param.get_mut(map) {
                *texture = texture_path([folder, library], name, texture)?;
            }
        }
    }
    Ok(())
}

fn texture_path([folder, library]: [&Path; 2], material: &str, texture: &str) -> Result<String, SceneError> {
    let invalid = |what: String| SceneError::invalid(library, format!("material `{material}`: {what}"));
    if texture.starts_with('-') {
        return Err(invalid(format!("texture options are not supported: `{texture}`")));
    }
    let below = library.strip_prefix(folder).ok().and_then(Path::parent).unwrap_or(Path::new(""));
    let path = file::beside(folder, below, texture.replace('\\', "/")).map_err(invalid)?;
    Ok(path.to_string_lossy().into_owned())
}

/// The materials and textures of a scene. `obj` is named in errors.
pub(super) fn convert(
    obj: &Path,
    materials: &[tobj::Material],
) -> Result<(Vec<Material>, Vec<Arc<Texture>>), SceneError> {
    let mut textures = Textures::default();
    let converted = materials.iter().map(|material| {
        let invalid = |what: String| SceneError::invalid(obj, format!("material `{}` {what}", material.name));
        let converted = constants(material).map_err(invalid)?;
        let values = [converted.roughness, converted.metallic];
        if !converted.base_colour.is_finite() || !values.iter().all(|value| value.is_finite()) {
            return Err(invalid("holds a value that is not finite".to_owned()));
        }
        let map = |name: &str| material.unknown_param.get(name).map(String::as_str);
        let (colour, alpha) = (material.diffuse_texture.as_deref(), material.dissolve_texture.as_deref());
        Ok(Material {
            base_colour_texture: textures.slot(colour, alpha, Encoding::Srgb)?,
            emission_texture: textures.slot(map(EMISSION_MAP), None, Encoding::Srgb)?,
            normal_texture: textures.slot(map(NORMAL_MAP), None, Encoding::Linear)?.map(|slot| (slot, 1.0)),
            ..converted
        })
    });
    let converted = converted.collect::<Result<_, _>>()?;
    Ok((converted, textures.read))
}

/// The textures of a scene, each made once, of images that are read once.
#[derive(Default)]
struct Textures<'a> {
    known: Vec<(Option<&'a str>, Option<&'a str>, Encoding)>,
    read: Vec<Arc<Texture>>,
    images: BTreeMap<&'a str, Image>,
}

impl<'a> Textures<'a> {
    /// A texture of one image's colours and another's alpha, if there is either.
    fn slot(
        &mut self,
        colour: Option<&'a str>,
        alpha: Option<&'a str>,
        encoding: Encoding,
    ) -> Result<Option<TextureSlot>, SceneError> {
        let wanted = (colour, alpha, encoding);
        if wanted.0.or(wanted.1).is_none() {
            return Ok(None);
        }
        let index = self.known.iter().position(|known| *known == wanted).unwrap_or(self.known.len());
        if index == self.known.len() {
            let image = self.image(colour, alpha)?;
            self.read.push(Arc::new(Texture::of(&image, encoding, [Wrap::Repeat; 2])));
            self.known.push(wanted);
        }
        let texture = TextureId(index as u32);
        Ok(Some(TextureSlot { texture, uv_set: 0, transform: Affine2::IDENTITY }))
    }

    /// One image's colours, white without one, with another as its alpha.
    fn image(&mut self, colour: Option<&'a str>, alpha: Option<&'a str>) -> Result<Image, SceneError> {
        let white = Image { width: 1, height: 1, texels: [[255; 4]].into() };
        let colour = colour.map(|path| self.read_image(path)).transpose()?;
        let Some(path) = alpha else { return Ok(colour.unwrap_or(white)) };
        let alpha = self.read_image(path)?;
        let [width, height] =
            colour.as_ref().map_or([alpha.width, alpha.height], |colour| [colour.width, colour.height]);
        decode::check(width, height).map_err(|what| SceneError::invalid(Path::new(path), what))?;
        Ok(with_alpha(&colour.unwrap_or(white), &alpha, width, height))
    }

    fn read_image(&mut self, path: &'a str) -> Result<Image, SceneError> {
        if let Some(image) = self.images.get(path) {
            return Ok(image.clone());
        }
        let place = Path::new(path);
        let image = decode::decode(&file::read(place)?).map_err(|what| SceneError::invalid(place, what))?;
        self.images.insert(path, image.clone());
        Ok(image)
    }
}

/// What a material says without textures; the error says which value is no number.
fn constants(material: &tobj::Material) -> Result<Material, String> {
    let transparency = || material.unknown_param.get("Tr").and_then(|text| text.parse::<f32>().ok());
    let alpha = material.dissolve.or_else(|| transparency().map(|value| 1.0 - value)).unwrap_or(1.0);
    let emission_unless_stated = if material.unknown_param.contains_key(EMISSION_MAP) { 1.0 } else { 0.0 };
    Ok(Material {
        name: material.name.clone(),
        base_colour: Vec3::from(material.diffuse.unwrap_or([1.0; 3])).extend(alpha),
        metallic: number(material, "Pm")?.unwrap_or(0.0),
        roughness: number(material, "Pr")?.unwrap_or_else(|| roughness(material)),
        emission: Vec3::from(material.emissive.unwrap_or([emission_unless_stated; 3])),
        alpha: match (&material.dissolve_texture, alpha) {
            (Some(_), _) => AlphaMode::Mask(CUTOFF),
            (None, alpha) if alpha < 1.0 => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        },
        ..Material::default()
    })
}

/// A number that the parser does not know the meaning of.
fn number(material: &tobj::Material, keyword: &str) -> Result<Option<f32>, String> {
    let parse = |text: &String| text.parse().map_err(|_| format!("has the {keyword} `{text}`, no number"));
    material.unknown_param.get(keyword).map(parse).transpose()
}

/// Perceptual roughness from a Phong exponent n: the microfacet width alpha is sqrt(2 / (n + 2)) (Walter et al. 2007,
/// "Microfacet Models for Refraction"), and glTF's roughness its square root. No highlight is as rough as can be.
fn roughness(material: &tobj::Material) -> f32 {
    let has_highlight = material.specular.is_some_and(|specular| specular.iter().any(|value| *value > 0.0));
    let exponent = material.shininess.filter(|_| has_highlight).unwrap_or(0.0);
    (2.0 / (exponent.max(0.0) + 2.0)).powf(0.25)
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
        let colour = Image { width: 1, height: 1, texels: [[1, 2, 3, 255]].into() };
        let grey = Image { width: 2, height: 1, texels: [[10, 0, 0, 255], [20, 0, 0, 255]].into() };
        assert_eq!(with_alpha(&colour, &grey, 2, 1).texels[..], [[1, 2, 3, 10], [1, 2, 3, 20]]);
        let cut = Image { width: 2, height: 1, texels: [[10, 0, 0, 0], [20, 0, 0, 255]].into() };
        assert_eq!(with_alpha(&colour, &cut, 2, 1).texels[..], [[1, 2, 3, 0], [1, 2, 3, 255]]);
    }
}
