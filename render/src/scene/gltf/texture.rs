//! Textures: images with a sampler, loaded once for each way in which materials read them (glTF 2.0, 3.8).

use super::{
    super::{
        SceneError, Texture, TextureId,
        decode::{self, Encoded, Image},
        texture::{Encoding, Filter, Wrap},
    },
    document::File,
};
use gltf::json;
use gltf::texture::{MagFilter, WrappingMode};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Endings of images that extensions of glTF bring, and that are not read here.
const UNREAD_ENDINGS: [&str; 5] = [".webp", ".avif", ".ktx", ".basis", ".dds"];

/// The extension that brings KTX2 images.
const BASISU: &str = "KHR_texture_basisu";

/// The textures that materials read, in the order in which they were asked for.
#[derive(Debug, Default)]
pub(super) struct TextureList {
    wanted: Vec<TextureUse>,
    /// Textures of the file that were asked for and have no image that can be read.
    without_image: BTreeSet<usize>,
    /// Textures that are placed by coordinates that are not read, with the number of those.
    placed_otherwise: BTreeSet<(usize, usize)>,
}

/// One way of reading an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct TextureUse {
    image: usize,
    encoding: Encoding,
    wrap: [Wrap; 2],
    filter: Filter,
}

impl TextureList {
    /// The index of a texture of the file, read as `encoding`; `None` of one without an image that can be
    /// read, which [`TextureList::without_image`] names.
    pub fn add(&mut self, file: &File<'_>, texture: usize, encoding: Encoding) -> Option<TextureId> {
        let texture = file.document.textures().nth(texture).expect("texture indices are validated");
        let sampler = texture.sampler();
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(wrap);
        // Rays see single texels or means of four. There are no smaller copies to choose among, so that
        // `minFilter` alone says nothing.
        let filter = match sampler.mag_filter() {
            Some(MagFilter::Nearest) => Filter::Nearest,
            Some(MagFilter::Linear) | None => Filter::Linear,
        };
        let Some(image) = image_of(file, texture.index()) else {
            self.without_image.insert(texture.index());
            return None;
        };
        let wanted = TextureUse { image, encoding, wrap, filter };
        let known = self.wanted.iter().position(|known| *known == wanted);
        let index = known.unwrap_or_else(|| {
            self.wanted.push(wanted);
            self.wanted.len() - 1
        });
        Some(TextureId(index as u32))
    }

    /// Leaves out a texture that is placed by other texture coordinates than sets 0 and 1.
    pub fn leave_out(&mut self, texture: usize, uv_set: usize) {
        self.placed_otherwise.insert((texture, uv_set));
    }

    /// What was left out for how it is placed: a sentence a texture.
    pub fn placed_otherwise(&self) -> impl Iterator<Item = String> {
        self.placed_otherwise.iter().map(|(texture, set)| {
            format!(
                "texture {texture} is placed by texture coordinates {set} and left out: sets 0 and 1 are read"
            )
        })
    }

    /// What was asked for and is not there: a sentence a texture.
    pub fn without_image<'a>(&'a self, file: &'a File<'_>) -> impl Iterator<Item = String> + 'a {
        self.without_image.iter().map(|index| {
            let texture = &file.document.as_json().textures[*index];
            let others = texture.extensions.iter().flat_map(|extensions| extensions.others.keys());
            let others: Vec<&str> = others.map(String::as_str).filter(|name| *name != BASISU).collect();
            let why = match others.as_slice() {
                [] => "has no PNG, JPEG or KTX2 image".to_owned(),
                _ => format!("has its image by {}, which is not supported,", others.join(" and ")),
            };
            format!("texture {index} {why} and is left out")
        })
    }

    /// Reads and decodes all of them, each image once.
    pub fn load(self, file: &File<'_>) -> Result<Vec<Arc<Texture>>, SceneError> {
        let mut indices: Vec<_> = self.wanted.iter().map(|wanted| wanted.image).collect();
        indices.sort_unstable();
        indices.dedup();
        let encoded = indices.iter().map(|index| encoded(file, *index)).collect::<Result<Vec<_>, _>>()?;
        let images = decode::all(&encoded).map_err(|(place, what)| invalid(file, indices[place], &what))?;
        let images: BTreeMap<usize, Image> = indices.into_iter().zip(images).collect();
        let texture = |TextureUse { image, encoding, wrap, filter }| {
            Arc::new(Texture::of(&images[&image], encoding, wrap).with_filter(filter))
        };
        Ok(self.wanted.into_iter().map(texture).collect())
    }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    }
}

/// The image of a texture: its own, as others have only what was lost in compression; else one by
/// KHR_texture_basisu. `None` where neither is of a kind that is read.
fn image_of(file: &File<'_>, texture: usize) -> Option<usize> {
    let json = file.document.as_json();
    let texture = &json.textures[texture];
    let basisu = texture.extensions.as_ref().and_then(|extensions| extensions.others.get(BASISU));
    let packed = basisu.and_then(|said| usize::try_from(said.get("source")?.as_u64()?).ok());
    // Of a texture without a source the JSON names an image beyond all.
    let mut images = [Some(texture.source.value()), packed].into_iter().flatten();
    images.find(|image| json.images.get(*image).is_some_and(is_read))
}

/// Whether an image is of a kind that is read, as far as its name and type say.
fn is_read(image: &json::Image) -> bool {
    let uri = image.uri.as_deref().unwrap_or_default().to_ascii_lowercase();
    let kind = image.mime_type.as_ref().map_or("", |kind| kind.0.as_str());
    let data = uri.strip_prefix("data:image/").and_then(|rest| rest.split([';', ',']).next());
    let is_data = |kind: &str| data == Some(kind);
    let unread =
        |ending: &str| uri.ends_with(ending) || kind.ends_with(&ending[1..]) || is_data(&ending[1..]);
    !UNREAD_ENDINGS.into_iter().any(unread)
}

/// An image of a file, a data URI or a buffer view.
fn encoded<'a>(file: &'a File<'_>, index: usize) -> Result<Encoded<'a>, SceneError> {
    let json = &file.document.as_json().images[index];
    let encoded = match (&json.uri, json.buffer_view) {
        (Some(uri), _) => Encoded::new(file.resource(uri)?),
        (None, Some(view)) => {
            let view = file.document.views().nth(view.value()).expect("buffer view indices are validated");
            file.view(&view).and_then(Encoded::new)
        }
        (None, None) => Err("has neither a URI nor a buffer view".to_owned()),
    };
    encoded.map_err(|what| invalid(file, index, &what))
}

/// An error about an image.
fn invalid(file: &File<'_>, index: usize, what: &str) -> SceneError {
    let json = &file.document.as_json().images[index];
    let in_file = json.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    let name = in_file.or(json.name.as_deref()).unwrap_or("embedded");
    file.invalid(format!("image {index} `{name}` {what}"))
}
