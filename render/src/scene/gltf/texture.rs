//! Textures: images with a sampler, loaded once for each way in which materials read them (glTF 2.0, 3.8).

use super::{
    super::{
        SceneError, Texture, TextureId,
        decode::{self, Encoded, Image},
        texture::{Encoding, Wrap},
    },
    document::File,
};
use gltf::texture::WrappingMode;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The textures that materials read, in the order in which they were asked for.
#[derive(Debug, Default)]
pub(super) struct TextureList(Vec<Wanted>);

/// One way of reading an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Wanted {
    image: usize,
    encoding: Encoding,
    wrap: [Wrap; 2],
}

impl TextureList {
    /// The index of a texture of the file, read as `encoding`.
    pub fn add(&mut self, file: &File<'_>, texture: usize, encoding: Encoding) -> TextureId {
        let texture = file.document.textures().nth(texture).expect("texture indices are validated");
        let sampler = texture.sampler();
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(wrap);
        let wanted = Wanted { image: texture.source().index(), encoding, wrap };
        let known = self.0.iter().position(|known| *known == wanted);
        let index = known.unwrap_or_else(|| {
            self.0.push(wanted);
            self.0.len() - 1
        });
        TextureId(index as u32)
    }

    /// Reads and decodes all of them, each image once.
    pub fn load(self, file: &File<'_>) -> Result<Vec<Arc<Texture>>, SceneError> {
        let mut indices: Vec<_> = self.0.iter().map(|wanted| wanted.image).collect();
        indices.sort_unstable();
        indices.dedup();
        let encoded = indices.iter().map(|index| encoded(file, *index)).collect::<Result<Vec<_>, _>>()?;
        let images = decode::all(&encoded).map_err(|(place, what)| invalid(file, indices[place], &what))?;
        let images: BTreeMap<usize, Image> = indices.into_iter().zip(images).collect();
        let texture =
            |Wanted { image, encoding, wrap }| Arc::new(Texture::of(&images[&image], encoding, wrap));
        Ok(self.0.into_iter().map(texture).collect())
    }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    }
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
