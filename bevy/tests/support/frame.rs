//! A scene and a view of it, in deepshade and as a file for Bevy.

use super::glb;
use deepshade_render::bvh::TracedScene;
use deepshade_render::path::{self, Sampling, Shot};
use deepshade_render::scene::{Camera, Scene, SceneSource};
use deepshade_render::{gbuffer, metrics};
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes};
use glam::Vec3;
use std::error::Error;
use std::path::Path;

/// What is compared with truth where a surface is seen.
pub const ATTRIBUTES: [Attribute; 3] = [Attribute::Position, Attribute::Normal, Attribute::Valid];

/// Where a camera stands and what it looks at, world space, metres.
pub type View = [[f32; 3]; 2];

/// A scene as a glTF file has it, and a view of it.
pub struct Frame {
    /// The scene, ready for rays.
    pub scene: TracedScene,
    /// The camera.
    pub camera: Camera,
    /// Rows and columns.
    pub size: [usize; 2],
}

impl Frame {
    /// A scene by its name, such as `playground:1` or a file's, written as `file` unless it is one, seen as
    /// `view` says.
    ///
    /// # Errors
    /// If there is no such scene, or the file cannot be written.
    pub fn new(
        source: &SceneSource,
        file: &Path,
        view: View,
        size: [usize; 2],
    ) -> Result<Self, Box<dyn Error>> {
        if let SceneSource::Procedural(..) = source {
            glb::write(&source.scene(0.0)?, file)?;
        }
        // Both read the same file.
        let scene = TracedScene::new(Scene::load(file, 0.0)?)?;
        let [eye, target] = view.map(Vec3::from_array);
        let camera = Camera::look_at(eye, target);
        Ok(Self { scene, camera, size })
    }

    /// What the camera sees, by rays.
    pub fn gbuffer(&self) -> GBuffer {
        gbuffer::render(&self.scene, &self.camera, self.size[0], self.size[1], &ATTRIBUTES)
    }

    /// Path-traced openness.
    pub fn truth(&self, radius: f32, samples: u32) -> Planes {
        let shot = Shot::new(&self.scene, &self.camera, self.size, radius);
        path::render(Effect::Ao, &shot, Sampling::one(samples, 1)).mean
    }
}

/// How alike an image is to truth, with the background where no surface is seen: structural similarity and
/// mean difference.
pub fn scores(image: &Planes, truth: &Planes, seen: &[bool]) -> [f64; 2] {
    let shown = image.data().iter().zip(seen).map(|(value, seen)| if *seen { *value } else { 1.0 });
    let shown = Planes::from_data(1, image.height(), image.width(), shown.collect());
    let pairs = shown.data().iter().zip(truth.data());
    let sum: f64 = pairs.map(|(a, b)| f64::from((a - b).abs())).sum();
    [metrics::ssim(&shown, truth), sum / truth.data().len() as f64]
}

/// The largest difference of two images, infinite where a value is no number, and the share of their values
/// that differ by more than `most`.
pub fn differences(a: &Planes, b: &Planes, most: f32) -> [f64; 2] {
    let off = |(a, b): (&f32, &f32)| {
        let off = (a - b).abs();
        if off.is_nan() { f32::INFINITY } else { off }
    };
    let off: Vec<f32> = a.data().iter().zip(b.data()).map(off).collect();
    let largest = off.iter().copied().fold(0.0, f32::max);
    let stray = off.iter().filter(|off| **off > most).count();
    [f64::from(largest), stray as f64 / off.len() as f64]
}
