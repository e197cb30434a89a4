//! Images beside truth in a folder, as PNG and EXR, and a page that shows them: the paper's Figure 5.

use super::alternatives::Alternatives;
use super::scores::{self, Row};
use anyhow::Result;
use askama::Template;
use deepshade::shared::arguments;
use deepshade::shared::figures::write_atomically;
use deepshade::shared::methods::TRUTH;
use deepshade::shared::pictures::{shown, write_png};
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::metrics::{exposed, exposure};
use deepshade_shaders::{Effect, Planes};
use std::path::{Path, PathBuf};

/// Name of the page.
const PAGE: &str = "index.html";
/// What pages say of themselves.
const MAKER: &str = "deepshade-studies lpv";

/// What figures call each image, and what it shows.
const CAPTIONS: [(&str, &str); 8] = [
    ("shadow_map", "what the lamp lights alone"),
    ("plain", "with indirect light: plain light propagation volumes"),
    ("single", "with light that the medium scattered once, by gpu-epipolar"),
    ("marched", "with indirect light on surfaces and in the medium"),
    ("sum", "the sum of these"),
    ("paper", "with multiple scattering, the paper's scheme"),
    ("lpv", "with multiple scattering, ours"),
    (TRUTH, "all light, path traced"),
];

/// A folder that is ready for a page.
pub struct Page<'a>(&'a Path);

#[derive(Template)]
#[template(path = "lpv/page.html")]
struct ImagesPage<'a> {
    maker: &'static str,
    head: &'a [String],
    lines: &'a [Vec<String>],
    scenes: Vec<SceneImages<'a>>,
}

/// A scene on the page.
struct SceneImages<'a> {
    name: &'a str,
    /// File and caption of each image.
    images: Vec<(String, &'static str)>,
}

impl<'a> Page<'a> {
    /// The page of a folder, as [`arguments::page_folder`] says.
    ///
    /// # Errors
    /// As that.
    pub fn new(folder: &'a Path) -> Result<Self> {
        arguments::page_folder(folder, PAGE, MAKER)?;
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
            sights.push(SceneImages { name, images });
        }
        let table = scores::table(mean);
        let page = ImagesPage { maker: MAKER, head: &table[0], lines: &table[1..], scenes: sights };
        write_atomically(&self.0.join(PAGE), page.render()?.as_bytes())
    }

    fn image(&self, file: &Path, image: &Planes, exposure: f32, scene: &str) -> Result<()> {
        let path = self.0.join(file);
        write_png(&path.with_extension("png"), &shown(&exposed(image, exposure)))?;
        let facts = [("scene", scene.to_owned()), ("exposure", exposure.to_string())];
        let facts: Metadata = facts.map(|(name, fact)| (name.to_owned(), fact)).into();
        let layer = Layer::image(Effect::Path.name(), image).in_full();
        Ok(exr_file::write(&path.with_extension("exr"), &[layer], &facts)?)
    }
}

impl Alternatives {
    /// An image by its name in figures, or truth.
    fn image(&self, name: &str) -> &Planes {
        let known = self.images.iter().find(|(known, _)| *known == name).map(|(_, image)| image);
        known.or_else(|| (name == TRUTH).then_some(&self.truth)).expect("all that have a caption are made")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_lie_beside_the_page_and_other_folders_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let planes = |value: f32| Planes::filled(3, 2, 4, value);
        let values = [
            ("shadow_map", 0.1),
            ("plain", 0.2),
            ("single", 0.3),
            ("marched", 0.4),
            // More than half floats hold.
            ("sum", 1e5),
            ("lpv", 0.6),
            ("paper", 0.7),
        ];
        let images = values.map(|(name, value)| (name, planes(value))).into();
        let rows = vec![Row::new("lpv", &planes(0.6), &planes(0.8), &[true; 8])];
        let scene = Alternatives { truth: planes(0.8), images, rows };
        let page = Page::new(folder.path()).expect("an empty folder");
        page.write(&["hall <1>".to_owned()], std::slice::from_ref(&scene), &scene.rows).expect("files");
        let text = std::fs::read_to_string(folder.path().join(PAGE)).expect("a page");
        assert!(text.contains("hall &#60;1&#62;") && text.contains("0.750"), "{text}");
        assert_eq!(CAPTIONS.len(), values.len() + 1);
        for (name, value) in values.into_iter().chain([("truth", 0.8)]) {
            assert!(text.contains(&format!("1/{name}.png")), "{name}");
            let file = folder.path().join("1").join(name);
            let read = exr_file::read(&file.with_extension("exr")).expect("an image");
            let read = read.image(Effect::Path.name(), 3).expect("three planes");
            assert!(read.data()[0] == value && file.with_extension("png").is_file(), "{name}");
        }
        assert!(Page::new(folder.path()).is_ok(), "it may be written anew");
        assert!(Page::new(&folder.path().join("1")).is_err(), "what is no page is left alone");
        let page = folder.path().join(PAGE);
        let error = Page::new(&page).err().expect("it is a file").to_string();
        assert!(error.contains(PAGE) && page.is_file(), "{error}");
    }
}
