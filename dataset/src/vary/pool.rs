//! The pool that objects are given textures from.

use crate::recipe::file_hash;
use crate::{DatasetError, random::mix};
use deepshade_render::scene::Texture;
use deepshade_render::scene::procedural::{Split, pattern};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Texels that stay in memory: 256 MiB.
const MOST_TEXELS: usize = 1 << 26;

/// Textures that are made or read when they are drawn; those that were drawn last stay in memory.
#[derive(Debug, Default)]
pub(super) struct Pool {
    sources: Vec<TextureSource>,
    recent: Mutex<Recent>,
}

/// Where a texture comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
enum TextureSource {
    /// A procedural pattern, by its seed.
    Pattern(u64),
    /// An image, with its BLAKE3 hash.
    Image(PathBuf, String),
}

/// Textures with their indices, the one that was drawn last at the end.
#[derive(Debug, Default)]
struct Recent(VecDeque<(usize, Arc<Texture>)>);

impl Pool {
    /// So many procedural patterns; those for training are not those for testing.
    pub fn patterns(count: usize, seed: u32, split: Split) -> Self {
        let split = u64::from(split == Split::Test);
        let pattern = |index: usize| TextureSource::Pattern(mix(&[u64::from(seed), split, index as u64]));
        Self { sources: (0..count).map(pattern).collect(), ..Self::default() }
    }

    /// All PNG and JPEG images of a folder and the folders in it, in the order of their paths.
    ///
    /// # Errors
    /// If it cannot be read or holds no image.
    pub fn folder(folder: &Path) -> Result<Self, DatasetError> {
        let mut images = Vec::new();
        add_images(folder, &mut images)?;
        if images.is_empty() {
            return Err(DatasetError::invalid(folder, "holds no PNG or JPEG image"));
        }
        images.sort();
        let hashed = |path: PathBuf| file_hash(&path).map(|hash| TextureSource::Image(path, hash));
        let sources = images.into_par_iter().map(hashed).collect::<Result<_, _>>()?;
        Ok(Self { sources, ..Self::default() })
    }

    /// BLAKE3 hash, in hexadecimal, of the images' hashes in their order.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for source in &self.sources {
            if let TextureSource::Image(_, hash) = source {
                hasher.update(hash.as_bytes());
            }
        }
        hasher.finalize().to_hex().to_string()
    }

    /// Number of textures.
    pub const fn len(&self) -> usize {
        self.sources.len()
    }

    /// The texture of an index.
    ///
    /// # Errors
    /// If its file is missing, damaged or not what it was.
    pub fn texture(&self, index: usize) -> Result<Arc<Texture>, DatasetError> {
        if let Some(texture) = self.recent(|recent| recent.get(index)) {
            return Ok(texture);
        }
        // Others may go on meanwhile; that two make the same texture does no harm.
        let texture = Arc::new(self.sources[index].load()?);
        self.recent(|recent| recent.put(index, &texture));
        Ok(texture)
    }

    fn recent<R>(&self, work: impl FnOnce(&mut Recent) -> R) -> R {
        work(&mut self.recent.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl TextureSource {
    fn load(&self) -> Result<Texture, DatasetError> {
        match self {
            Self::Pattern(seed) => Ok(pattern(*seed)),
            Self::Image(path, hash) if file_hash(path)? == *hash => Ok(Texture::load(path)?),
            Self::Image(path, _) => Err(DatasetError::invalid(path, "was changed while it was in use")),
        }
    }
}

impl Recent {
    fn get(&mut self, index: usize) -> Option<Arc<Texture>> {
        let place = self.0.iter().position(|(other, _)| *other == index)?;
        let found = self.0.remove(place)?;
        let texture = Arc::clone(&found.1);
        self.0.push_back(found);
        Some(texture)
    }

    fn put(&mut self, index: usize, texture: &Arc<Texture>) {
        if self.get(index).is_none() {
            self.0.push_back((index, Arc::clone(texture)));
        }
        let texels =
            |recent: &Self| recent.0.iter().map(|(_, texture)| texture.texels().len()).sum::<usize>();
        while self.0.len() > 1 && texels(self) > MOST_TEXELS {
            self.0.pop_front();
        }
    }
}

/// Adds all images of a folder and the folders in it. Links to folders are not followed, since they may lead
/// back.
fn add_images(folder: &Path, images: &mut Vec<PathBuf>) -> Result<(), DatasetError> {
    let io = |source| DatasetError::io(folder, source);
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let entry = entry.map_err(io)?;
        let path = entry.path();
        if entry.file_type().map_err(io)?.is_dir() {
            add_images(&path, images)?;
            continue;
        }
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        if ["png", "jpg", "jpeg"].contains(&ending.as_str()) {
            images.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_trained_on_is_not_tested_on() {
        let pool = |seed, split| Pool::patterns(512, seed, split);
        let train = pool(1, Split::Train);
        for other in [pool(1, Split::Test), pool(2, Split::Train)] {
            assert!(!other.sources.iter().any(|source| train.sources.contains(source)));
        }
        assert_eq!(train.sources, pool(1, Split::Train).sources);
    }

    /// Writes a small picture of one grey.
    fn picture(folder: &Path, name: &str, grey: u8) {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        image::GrayImage::from_pixel(4, 4, image::Luma([grey])).save(path).expect("written");
    }

    #[test]
    fn a_folder_of_classes_is_read_in_order_image_by_image() {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, grey) in
            [("woven/b.png", 30), ("woven/a.png", 20), ("dotted/fine/c.jpg", 10), ("z.PNG", 40)]
        {
            picture(folder.path(), name, grey);
        }
        std::fs::write(folder.path().join("woven/labels.txt"), "woven").expect("written");
        // Not read before it is drawn.
        std::fs::write(folder.path().join("zz.png"), "no image").expect("written");
        let pool = Pool::folder(folder.path()).expect("a pool");
        let grey = |index| pool.texture(index).expect("an image").texels()[0][0];
        assert_eq!((pool.len(), [0, 1, 2, 3].map(grey)), (5, [10, 20, 30, 40]));
        assert!(pool.texture(4).expect_err("damaged").to_string().contains("zz.png"));
        assert_eq!(Pool::folder(folder.path()).expect("a pool").hash(), pool.hash());

        picture(folder.path(), "woven/a.png", 21);
        assert_eq!(grey(1), 20, "still in memory");
        let late = Pool::folder(folder.path()).expect("a pool");
        assert_ne!(late.hash(), pool.hash());
        picture(folder.path(), "woven/a.png", 22);
        let error = late.texture(1).expect_err("another image").to_string();
        assert!(error.contains("a.png") && error.contains("changed"), "{error}");
    }

    #[test]
    fn what_was_drawn_last_stays_in_memory() {
        use deepshade_render::scene::{Encoding, Wrap};
        let edge = 4096;
        let large = |grey| {
            let texels = vec![[grey; 4]; edge * edge];
            Arc::new(Texture::new(edge, edge, texels, Encoding::Srgb, [Wrap::Repeat; 2]))
        };
        let mut recent = Recent::default();
        let texture = large(1);
        // Four fill the memory.
        (0..4).for_each(|index| recent.put(index, &texture));
        assert!(recent.get(0).is_some());
        recent.put(4, &texture);
        let held: Vec<usize> = recent.0.iter().map(|(index, _)| *index).collect();
        assert_eq!(held, [2, 3, 0, 4], "the one that was not drawn for longest is gone");
    }
}
