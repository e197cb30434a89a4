//! Which views of a scene a command works on: the cameras that its file brings, or sampled ones.

use anyhow::{Result, bail, ensure};
use clap::builder::RangedU64ValueParser;
use deepshade_dataset::views::{inside_geometry, sample_view};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;

/// A camera with a name.
#[derive(Clone, Debug)]
pub struct View {
    /// What the page calls it.
    pub name: String,
    /// The camera.
    pub camera: Camera,
}

/// Which views; without any of these, the file's own cameras, or one sampled view where it has none.
#[derive(clap::Args)]
pub struct Args {
    /// One of the file's cameras, by its name.
    #[arg(long, conflicts_with = "views")]
    camera: Option<String>,
    /// So many views sampled in the scene.
    #[arg(long, value_parser = RangedU64ValueParser::<usize>::new().range(1..=1000))]
    views: Option<usize>,
    /// Chooses sampled views, and all other random numbers.
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
}

impl Args {
    /// The views of a scene, for images of `[height, width]`.
    ///
    /// # Errors
    /// If the file has no camera of the name asked for, a camera stands inside of geometry, or no view of the scene
    /// can be found.
    pub fn of(&self, scene: &TracedScene, size: [usize; 2]) -> Result<Vec<View>> {
        let own = &scene.scene().cameras;
        let views = match (&self.camera, self.views) {
            (Some(name), _) => vec![named(own, name)?],
            (None, None) if !own.is_empty() => own.iter().map(view).collect(),
            (None, count) => return sampled(scene, size, self.seed, count.unwrap_or(1)),
        };
        for View { name, camera } in &views {
            ensure!(!inside_geometry(scene, camera.position), "camera `{name}` stands inside of geometry");
        }
        Ok(views)
    }
}

/// One view: a camera of the file by its name or its first one, or the sampled view of an index.
///
/// # Errors
/// If the file has no camera of the name asked for, or no view of the scene can be found.
pub fn one(
    scene: &TracedScene,
    size: [usize; 2],
    camera: Option<&str>,
    index: Option<usize>,
    seed: u32,
) -> Result<View> {
    let own = &scene.scene().cameras;
    match (camera, index) {
        (Some(name), _) => named(own, name),
        (None, None) if !own.is_empty() => Ok(view(&own[0])),
        (None, index) => {
            let index = index.unwrap_or(0);
            let camera = sample_view(scene, size, seed, 0, index)?;
            Ok(View { name: format!("{}, view {index}", scene.scene().name), camera })
        }
    }
}

/// Views that a dataset could hold.
fn sampled(scene: &TracedScene, size: [usize; 2], seed: u32, count: usize) -> Result<Vec<View>> {
    (0..count)
        .map(|index| {
            let camera = sample_view(scene, size, seed, 0, index)?;
            Ok(View { name: format!("{}, view {index}", scene.scene().name), camera })
        })
        .collect()
}

fn named(cameras: &[(String, Camera)], wanted: &str) -> Result<View> {
    let names: Vec<&str> = cameras.iter().map(|(name, _)| name.as_str()).collect();
    match cameras.iter().find(|(name, _)| name == wanted) {
        Some(camera) => Ok(view(camera)),
        None if names.is_empty() => {
            bail!("no camera `{wanted}`: the scene brings none, without --camera views are sampled in it")
        }
        None => bail!("no camera `{wanted}`; the scene brings {}", names.join(", ")),
    }
}

fn view((name, camera): &(String, Camera)) -> View {
    View { name: name.clone(), camera: *camera }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::procedural::Family;
    use glam::Vec3;

    const SIZE: [usize; 2] = [32, 32];

    fn scene() -> TracedScene {
        let mut scene = Family::ALL[0].scene(1);
        let centre = scene.bounds().centre();
        scene.cameras = ["left", "right"]
            .map(|name| (name.to_owned(), Camera::look_at(centre + Vec3::X * 1000.0, centre)))
            .to_vec();
        TracedScene::new(scene).expect("a scene")
    }

    fn args(camera: Option<&str>, views: Option<usize>) -> Args {
        Args { camera: camera.map(str::to_owned), views, seed: 3 }
    }

    #[test]
    fn the_files_cameras_come_before_sampled_ones() {
        let scene = scene();
        let names = |args: Args| -> Vec<String> {
            args.of(&scene, SIZE).expect("views").into_iter().map(|view| view.name).collect()
        };
        assert_eq!(names(args(None, None)), ["left", "right"]);
        assert_eq!(names(args(Some("right"), None)), ["right"]);
        assert_eq!(names(args(None, Some(2))).len(), 2);
    }

    #[test]
    fn a_camera_that_is_not_there_is_named_with_those_that_are() {
        let error = args(Some("middle"), None).of(&scene(), SIZE).expect_err("no such camera");
        assert_eq!(error.to_string(), "no camera `middle`; the scene brings left, right");
    }
}
