//! Textures: images with a sampler, loaded once for each way in which materials read them (glTF 2.0, 3.8).

use super::{
    super::{
        SceneError, Texture, TextureId,
        file::{self, Image},
        texture::{Encoding, Wrap},
    },
    document::File,
};
use gltf::texture::WrappingMode;
use rayon::prelude::*;
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
        let mut images: Vec<_> = self.0.iter().map(|wanted| wanted.image).collect();
        images.sort_unstable();
        images.dedup();
        let images: BTreeMap<usize, Image> = images
            .into_par_iter()
            .map(|index| Ok((index, read_image(file, index)?)))
            .collect::<Result<_, SceneError>>()?;
        let texture = |wanted: Wanted| {
            let Image { width, height, texels } = &images[&wanted.image];
            Arc::new(Texture::new(*width, *height, texels.clone(), wanted.encoding, wanted.wrap))
        };
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

/// Reads an image from a file, a data URI or a buffer view.
fn read_image(file: &File<'_>, index: usize) -> Result<Image, SceneError> {
    let json = &file.document.as_json().images[index];
    let in_file = json.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    let name = in_file.or(json.name.as_deref()).unwrap_or("embedded");
    let error = |what: String| file.invalid(format!("image {index} `{name}` {what}"));
    let decoded = match (&json.uri, json.buffer_view) {
        (Some(uri), _) => file::decode(&file.resource(uri)?),
        (None, Some(view)) => {
            let view = file.document.views().nth(view.value()).expect("buffer view indices are validated");
            file.view(&view).and_then(file::decode)
        }
        (None, None) => Err("has neither a URI nor a buffer view".to_owned()),
    };
    decoded.map_err(error)
}
