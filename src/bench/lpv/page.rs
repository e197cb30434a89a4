//! Images beside truth in a folder, as PNG and EXR, and a page that shows them: the paper's Figure 5.

use super::alternatives::Alternatives;
use super::scores::{self, Row};
use crate::figures::write_atomically;
use crate::report::images::{shown, write_png};
use anyhow::{Result, ensure};
use askama::Template;
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::metrics::{exposed, exposure};
use deepshade_shaders::{Effect, Planes};
use std::path::{Path, PathBuf};

/// Name of the page.
const PAGE: &str = "index.html";
/// What pages say of themselves.
const MAKER: &str = "deepshade bench lpv";

/// What figures call each image, and what it shows.
const CAPTIONS: [(&str, &str); 8] = [
    ("shadow_map", "what the lamp lights alone"),
    ("plain", "with indirect light: plain light propagation volumes"),
    ("single", "with light that the medium scattered once"),
    ("marched", "with indirect light on surfaces and in the medium"),
    ("sum", "the sum of these"),
    ("paper", "with multiple scattering, the paper's scheme"),
    ("lpv", "with multiple scattering, ours"),
    ("truth", "all light, path traced"),
];

/// A folder that a page may be written to.
pub struct Page<'a>(&'a Path);

#[derive(Template)]
#[template(path = "bench/lpv/page.html")]
struct Shown<'a> {
    maker: &'static str,
    head: &'a [String],
    lines: &'a [Vec<String>],
    scenes: Vec<Sight<'a>>,
}

/// A scene on the page.
struct Sight<'a> {
    name: &'a str,
    /// File and caption of each image.
    images: Vec<(String, &'static str)>,
}

impl<'a> Page<'a> {
    /// The page of a folder that is empty or holds an earlier one.
    ///
    /// # Errors
    /// If it holds something else.
    pub fn new(folder: &'a Path) -> Result<Self> {
        let empty = std::fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
        let ours = std::fs::read_to_string(folder.join(PAGE)).is_ok_and(|page| page.contains(MAKER));
        ensure!(empty || ours, "{} holds something else: choose a new or an empty folder", folder.display());
        Ok(Self(folder))
    }

    /// Writes images, all of a scene at truth's exposure, and the page last.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, names: &[String], scenes: &[Alternatives], mean: &[Row]) -> Result<()> {
        let mut sights = Vec::new();
        for (number, (name, scene)) in names.iter().zip(scenes).enumerate() {
            let exposure = exposure(Effect::Path, &scene.truth);
            let mut images = Vec::new();
            for (image, caption) in CAPTIONS {
                let file = PathBuf::from(format!("{}", number + 1)).join(image);
                self.image(&file, scene.image(image), exposure, name)?;
                images.push((file.with_extension("png").display().to_string(), caption));
            }
            sights.push(Sight { name, images });
        }
        let table = scores::table(mean);
        let page = Shown { maker: MAKER, head: &table[0], lines: &table[1..], scenes: sights };
        write_atomically(&self.0.join(PAGE), page.render()?.as_bytes())
    }

    fn image(&self, file: &Path, image: &Planes, exposure: f32, scene: &str) -> Result<()> {
        let path = self.0.join(file);
        write_png(&path.with_extension("png"), &shown(&exposed(image, exposure)))?;
        let facts = [("scene", scene.to_owned()), ("exposure", exposure.to_string())];
        let facts: Metadata = facts.map(|(name, fact)| (name.to_owned(), fact)).into();
        let layer = Layer::image(Effect::Path.name(), image);
        Ok(exr_file::write(&path.with_extension("exr"), &[layer], &facts)?)
    }
}

impl Alternatives {
    /// An image by its name in figures; any other is truth.
    fn image(&self, name: &str) -> &Planes {
        self.images.iter().find(|(known, _)| *known == name).map_or(&self.truth, |(_, image)| image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_lie_beside_the_page_and_other_folders_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let planes = |value: f32| Planes::filled(3, 2, 4, value);
        let names = ["shadow_map", "plain", "single", "marched", "sum", "lpv", "paper"];
        let images = (1u8..).zip(names).map(|(i, name)| (name, planes(0.1 * f32::from(i)))).collect();
        let rows = vec![Row::new("lpv", &planes(0.6), &planes(0.8), &[true; 8])];
        let scene = Alternatives { truth: planes(0.8), images, rows };
        let page = Page::new(folder.path()).expect("an empty folder");
        page.write(&["hall <1>".to_owned()], std::slice::from_ref(&scene), &scene.rows).expect("files");
        let text = std::fs::read_to_string(folder.path().join(PAGE)).expect("a page");
        assert!(text.contains("hall &#60;1&#62;") && text.contains("0.750"), "{text}");
        for (name, _) in CAPTIONS {
            assert!(text.contains(&format!("1/{name}.png")), "{name}");
            let file = folder.path().join("1").join(name);
            let read = exr_file::read(&file.with_extension("exr")).expect("an image");
            let read = read.image(Effect::Path.name(), 3).expect("three planes");
            let off = (read.data()[0] - scene.image(name).data()[0]).abs();
            assert!(off < 1e-3 && file.with_extension("png").is_file(), "{name}: {off}");
        }
        assert!(Page::new(folder.path()).is_ok(), "it may be written anew");
        assert!(Page::new(&folder.path().join("1")).is_err(), "what is no page is left alone");
    }
}
