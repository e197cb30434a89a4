//! What deepshade reads and others may have written, each as a function of bytes. libFuzzer changes the bytes
//! (`cargo xtask fuzz`), and so does a test (`tests/untrusted.rs`), which knows nothing of libFuzzer.
//!
//! Readers must give a value or an error: a panic, a giant allocation or a long wait is a fault. What is read
//! is looked at as its users do.

use deepshade_dataset::{Capture, Recipe};
use deepshade_glow::file::MaterialFile;
use deepshade_infer::{Model, Parity};
use deepshade_phosphor::fit::Measurement;
use deepshade_render::bvh::TracedScene;
use deepshade_render::exr_file;
use deepshade_render::scene::medium::DensityFile;
use deepshade_render::scene::{Bounds, Environment, Scene, Texture, gltf};
use deepshade_shaders::Attribute;
use glam::{Vec2, Vec3};
use std::path::Path;

/// Stands between the files of an input.
pub const SEPARATOR: &[u8] = b"\n----\n";

/// Most bytes that reading a file of some kilobytes may take. What asks for more ends the process, which is a
/// finding.
pub const MOST_BYTES: usize = 1 << 30;

/// Hierarchies are built over scenes of at most so many triangles: more would take the time of thousands of
/// inputs.
const FEW_TRIANGLES: usize = 64;

/// Something that is read.
pub struct Reader {
    /// As in the names of its target, corpus and figures.
    pub name: &'static str,
    /// The files that an input consists of. One that is empty is not there.
    files: &'static [&'static str],
    /// Reads a folder of these files: whether they are accepted.
    accepts: fn(&Path) -> bool,
}

/// All of them.
pub const READERS: [Reader; 13] = [
    Reader { name: "gltf", files: &["scene.gltf"], accepts: gltf },
    Reader { name: "obj", files: &["scene.obj", "scene.mtl", "texture.png"], accepts: obj },
    Reader { name: "ply", files: &["scene.ply"], accepts: ply },
    Reader { name: "exr", files: &["frame.exr"], accepts: exr },
    Reader { name: "texture", files: &["texture.png"], accepts: texture },
    Reader { name: "environment", files: &["sky.hdr"], accepts: environment },
    Reader {
        name: "model",
        files: &["net.json", "weights.safetensors", "parity.safetensors"],
        accepts: model,
    },
    Reader { name: "recipe", files: &["recipe.toml", "test.toml", "scene.obj"], accepts: recipe },
    Reader {
        name: "tum",
        files: &["camera.toml", "rgb.txt", "depth.txt", "groundtruth.txt", "0.png", "1.png"],
        accepts: capture,
    },
    Reader {
        name: "open3d",
        files: &["camera_intrinsic.json", "trajectory.log", "color/0.png", "depth/0.png"],
        accepts: capture,
    },
    Reader {
        name: "curves",
        files: &[
            "decay.csv",
            "spectrum.csv",
            "filters.csv",
            "camera.csv",
            "excitation.csv",
            "light.csv",
            "checker.csv",
            "checker-light.csv",
        ],
        accepts: curves,
    },
    Reader { name: "materials", files: &["materials.toml"], accepts: materials },
    Reader { name: "media", files: &["medium.toml", "density.vol", "density.npy"], accepts: media },
];

impl Reader {
    /// Lays an input's files into a folder and reads them: whether they are accepted.
    ///
    /// # Panics
    /// If the folder cannot be written to, or where the reader does.
    pub fn read(&self, folder: &Path, data: &[u8]) -> bool {
        let mut rest = data;
        for (index, name) in self.files.iter().enumerate() {
            let last = index + 1 == self.files.len();
            let end = if last { None } else { rest.windows(SEPARATOR.len()).position(|w| w == SEPARATOR) };
            let (file, after) =
                end.map_or((rest, &[][..]), |end| (&rest[..end], &rest[end + SEPARATOR.len()..]));
            lay(&folder.join(name), file);
            rest = after;
        }
        (self.accepts)(folder)
    }
}

fn lay(path: &Path, bytes: &[u8]) {
    if bytes.is_empty() {
        let _ = std::fs::remove_file(path);
        return;
    }
    if std::fs::write(path, bytes).is_err() {
        std::fs::create_dir_all(path.parent().expect("a folder's file")).expect("a folder");
        std::fs::write(path, bytes).expect("a writable folder");
    }
}

fn gltf(folder: &Path) -> bool {
    let path = folder.join("scene.gltf");
    if let Ok(Some(rig)) = gltf::rig(&path) {
        let _ = [f32::NEG_INFINITY, 0.5, 1e30].map(|time| rig.pose(time));
    }
    Scene::load_moving(&path, 0.5, 0.25).is_ok_and(traced)
}

fn ply(folder: &Path) -> bool {
    Scene::load(&folder.join("scene.ply"), 0.0).is_ok_and(traced)
}

fn obj(folder: &Path) -> bool {
    Scene::load(&folder.join("scene.obj"), 0.0).is_ok_and(traced)
}

/// Whether rays can meet a scene, as far as it is a small one.
fn traced(scene: Scene) -> bool {
    if scene.triangle_count() > FEW_TRIANGLES {
        return true;
    }
    TracedScene::new(scene).is_ok_and(|traced| {
        let (centre, away) = (traced.bounds().centre(), traced.bounds().max + Vec3::ONE);
        let hit = traced.hit(away, (centre - away).normalize_or(Vec3::NEG_Z), f32::INFINITY);
        hit.is_none_or(|hit| !hit.distance.is_nan())
    })
}

fn exr(folder: &Path) -> bool {
    let Ok(image) = exr_file::read(&folder.join("frame.exr")) else { return false };
    let attributes: Vec<Attribute> = Attribute::ALL.into_iter().filter(|of| image.has(*of)).collect();
    if let (Ok(gbuffer), Ok(windows)) = (image.gbuffer(&attributes), image.windows(&attributes)) {
        let planes = gbuffer.planes();
        assert_eq!([planes.height(), planes.width()], [windows.data.height, windows.data.width]);
    }
    let _ = (image.gbuffer(&Attribute::ALL), image.colour(), image.image("target.ao", 1));
    true
}

fn texture(folder: &Path) -> bool {
    Texture::load(&folder.join("texture.png")).is_ok_and(|texture| {
        let middle = texture.sample(Vec2::splat(0.5));
        middle.min_element() >= 0.0 && middle.max_element() <= 1.0
    })
}

fn environment(folder: &Path) -> bool {
    Environment::load(&folder.join("sky.hdr")).is_ok_and(|sky| {
        let sample = sky.sample(Vec2::new(0.3, 0.6));
        assert!(sample.is_none_or(|sample| sample.radiance.is_finite() && sample.density > 0.0));
        sky.mean().is_finite()
    })
}

fn model(folder: &Path) -> bool {
    Model::load(folder).is_ok_and(|model| {
        assert!(model.weights.fit(&model.spec));
        let _ = Parity::load(folder, &model.spec);
        true
    })
}

fn recipe(folder: &Path) -> bool {
    Recipe::load(&folder.join("recipe.toml")).is_ok()
}

fn capture(folder: &Path) -> bool {
    Capture::open(folder).is_ok_and(|capture| capture.frame(capture.count() - 1).is_ok())
}

fn curves(folder: &Path) -> bool {
    Measurement::read(folder, |path| Ok(exr_file::read_colour(path)?.0)).is_ok()
}

fn materials(folder: &Path) -> bool {
    MaterialFile::read(&folder.join("materials.toml")).is_ok_and(|file| !file.text().is_empty())
}

fn media(folder: &Path) -> bool {
    let path = folder.join("medium.toml");
    let unit = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
    // Making weather takes seconds, and follows from a few numbers that were checked.
    let made = std::fs::read_to_string(&path).is_ok_and(|text| text.contains("weather"));
    DensityFile::read(&path).is_ok_and(|file| made || file.grid(unit, 0.0).is_ok())
}
