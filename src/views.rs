//! Which views of a scene a command works on: the cameras that its file brings, or sampled ones.

mod outside;

use crate::arguments::place;
use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::builder::RangedU64ValueParser;
use deepshade_dataset::views::whole::is_place;
use deepshade_dataset::views::{inside_geometry, sample_view};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{Camera, SceneSource};
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// What helps where no view is fit.
const STATE_ONE: &str = "--eye X,Y,Z and --look-at X,Y,Z state a view";

/// A camera with a name.
#[derive(Clone, Debug)]
pub struct View {
    /// What the page calls it.
    pub name: String,
    /// The camera.
    pub camera: Camera,
}

/// From where a scene is seen.
#[derive(clap::Args, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Viewpoint {
    /// One of the file's cameras, by its name.
    #[arg(long)]
    camera: Option<String>,
    /// A view sampled in the scene, by its number, of which any draws one.
    #[arg(long, conflicts_with = "camera")]
    view: Option<usize>,
    /// Where the camera stands: X,Y,Z, metres.
    #[arg(long, value_parser = place, requires = "look_at", conflicts_with_all = ["camera", "view"], allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// What it looks at: X,Y,Z, metres.
    #[arg(long, value_parser = place, requires = "eye", allow_hyphen_values = true)]
    look_at: Option<Vec3>,
}

/// Which views of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    /// So many sampled ones.
    Sampled(usize),
    /// These.
    Stated(Vec<Viewpoint>),
}

/// Which views; without any of these, the file's own cameras, or where it has none one sampled view of a
/// place that people stand in, such as a room, and one from outside of all else.
#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    viewpoint: Viewpoint,
    /// So many views sampled in the scene.
    #[arg(long, value_parser = RangedU64ValueParser::<usize>::new().range(1..=1000), conflicts_with_all = ["camera", "view", "eye"])]
    views: Option<usize>,
    /// Chooses sampled views, and all other random numbers; 0 by default.
    #[arg(long)]
    pub seed: Option<u32>,
}

impl Viewpoint {
    /// Where a camera stands that looks at a point.
    pub fn looking(eye: Vec3, target: Vec3) -> Self {
        Self { eye: Some(eye), look_at: Some(target), ..Self::default() }
    }

    /// One of the file's cameras.
    #[cfg(feature = "view")]
    pub fn named(camera: &str) -> Self {
        Self { camera: Some(camera.to_owned()), ..Self::default() }
    }

    /// A view sampled in the scene, by its number.
    pub fn sampled(view: usize) -> Self {
        Self { view: Some(view), ..Self::default() }
    }

    /// Whether one thing is stated, and whole.
    ///
    /// # Errors
    /// If not.
    pub fn check(&self) -> Result<()> {
        let one = match (&self.camera, self.view, self.eye, self.look_at) {
            (Some(_), None, None, None) | (None, Some(_), None, None) => true,
            (None, None, Some(eye), Some(target)) => eye.is_finite() && target.is_finite(),
            _ => false,
        };
        ensure!(
            one,
            "a view is a `camera`, the number of a `view`, or an `eye` with what it is to `look_at`"
        );
        Ok(())
    }

    /// The view that is stated, else that of the file's first camera, or the first one of a scene that brings
    /// none.
    ///
    /// # Errors
    /// If the file has no camera of the name asked for, there is no direction to look in, or no view of the
    /// scene can be found.
    pub fn of(&self, source: &SceneSource, scene: &TracedScene, size: [usize; 2], seed: u32) -> Result<View> {
        Ok(match self.stated(scene, size, seed)? {
            Some(view) => view,
            None => match scene.scene().cameras.first() {
                Some(camera) => view(camera),
                None => first(source, scene, size, seed)?,
            },
        })
    }

    fn stated(&self, scene: &TracedScene, size: [usize; 2], seed: u32) -> Result<Option<View>> {
        if let (Some(eye), Some(target)) = (self.eye, self.look_at) {
            ensure!(eye.distance(target) > 0.0, "--eye and --look-at are the same point");
            let name = format!("{}, from {eye} to {target}", scene.scene().name);
            return Ok(Some(View { name, camera: Camera::look_at(eye, target) }));
        }
        if let Some(name) = &self.camera {
            return named(&scene.scene().cameras, name).map(Some);
        }
        self.view.map(|index| sampled(scene, size, seed, index)).transpose()
    }
}

impl Args {
    /// One view, and what chooses random numbers.
    #[cfg(feature = "view")]
    pub const fn one(viewpoint: Viewpoint, seed: u32) -> Self {
        Self { viewpoint, views: None, seed: Some(seed) }
    }

    /// The views of a scene, for images of `[height, width]`.
    ///
    /// # Errors
    /// As [`Viewpoint::of`], and if a camera stands inside of geometry.
    pub fn of(&self, source: &SceneSource, scene: &TracedScene, size: [usize; 2]) -> Result<Vec<View>> {
        views(self.choice().as_ref(), source, scene, size, self.seed.unwrap_or(0))
    }

    /// The views that are stated, if some are.
    pub fn choice(&self) -> Option<Choice> {
        let one = (self.viewpoint != Viewpoint::default()).then(|| vec![self.viewpoint.clone()]);
        one.map(Choice::Stated).or(self.views.map(Choice::Sampled))
    }
}

/// The views of a scene that are chosen, for images of `[height, width]`; else its file's own cameras, or one
/// view where it has none.
///
/// # Errors
/// As [`Viewpoint::of`], and if a camera stands inside of geometry.
pub fn views(
    choice: Option<&Choice>,
    source: &SceneSource,
    scene: &TracedScene,
    size: [usize; 2],
    seed: u32,
) -> Result<Vec<View>> {
    let own = &scene.scene().cameras;
    let several = |count: usize| -> Result<Vec<View>> {
        (0..count).map(|index| sampled(scene, size, seed, index)).collect()
    };
    let views: Vec<View> = match choice {
        Some(Choice::Sampled(count)) => several(*count)?,
        Some(Choice::Stated(viewpoints)) => viewpoints
            .iter()
            .map(|viewpoint| viewpoint.of(source, scene, size, seed))
            .collect::<Result<_>>()?,
        None if own.is_empty() => vec![first(source, scene, size, seed)?],
        None => own.iter().map(view).collect(),
    };
    for View { name, camera } in &views {
        ensure!(
            !inside_geometry(scene, camera.position),
            "camera `{name}` stands inside of geometry; {STATE_ONE}"
        );
    }
    Ok(views)
}

/// The view of a scene that brings none: a sampled one of a place, where one is fit for use, else one from
/// outside. All families are places.
fn first(source: &SceneSource, scene: &TracedScene, size: [usize; 2], seed: u32) -> Result<View> {
    let place = matches!(source, SceneSource::Procedural(..)) || is_place(scene);
    let sampled = place.then(|| sampled(scene, size, seed, 0));
    if let Some(Ok(view)) = sampled {
        return Ok(view);
    }
    let name = &scene.scene().name;
    let camera = outside::from_outside(scene, size);
    let camera = camera.with_context(|| format!("no view shows anything of scene `{name}`; {STATE_ONE}"))?;
    Ok(View { name: format!("{name}, from outside"), camera })
}

/// A view that a dataset could hold.
fn sampled(scene: &TracedScene, size: [usize; 2], seed: u32, index: usize) -> Result<View> {
    let camera = sample_view(scene, size, seed, 0, index);
    let camera = camera.map_err(|error| anyhow!("{error}; {STATE_ONE}"))?;
    Ok(View { name: format!("{}, view {index}", scene.scene().name), camera })
}

fn named(cameras: &[(String, Camera)], wanted: &str) -> Result<View> {
    let names: Vec<&str> = cameras.iter().map(|(name, _)| name.as_str()).collect();
    match cameras.iter().find(|(name, _)| name == wanted) {
        Some(camera) => Ok(view(camera)),
        None if names.is_empty() => {
            bail!(
                "no camera `{wanted}`: the scene brings none, and where none is asked for views are sampled in it"
            )
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
    use deepshade_render::scene::{Material, Mesh, Scene};

    const SIZE: [usize; 2] = [32, 32];

    /// Where scenes are from that are judged by what they are.
    fn file() -> SceneSource {
        SceneSource::File("scene.gltf".into())
    }

    fn scene() -> TracedScene {
        let mut scene = Family::ALL[0].scene(1);
        let centre = scene.bounds().centre();
        scene.cameras = ["left", "right"]
            .map(|name| (name.to_owned(), Camera::look_at(centre + Vec3::X * 1000.0, centre)))
            .to_vec();
        TracedScene::new(scene).expect("a scene")
    }

    fn args(camera: Option<&str>, views: Option<usize>) -> Args {
        let viewpoint = Viewpoint { camera: camera.map(str::to_owned), ..Viewpoint::default() };
        Args { viewpoint, views, seed: Some(3) }
    }

    #[test]
    fn the_files_cameras_come_before_sampled_ones() {
        let scene = scene();
        let names = |args: Args| -> Vec<String> {
            args.of(&file(), &scene, SIZE).expect("views").into_iter().map(|view| view.name).collect()
        };
        assert_eq!(names(args(None, None)), ["left", "right"]);
        assert_eq!(names(args(Some("right"), None)), ["right"]);
        assert_eq!(names(args(None, Some(2))).len(), 2);
    }

    #[test]
    fn a_stated_view_comes_before_all_others() {
        let scene = scene();
        let target = scene.bounds().centre();
        let eye = target + Vec3::new(0.0, 500.0, 900.0);
        let viewpoint = Viewpoint { eye: Some(eye), look_at: Some(target), ..Viewpoint::default() };
        let views = Args { viewpoint: viewpoint.clone(), views: None, seed: Some(3) }
            .of(&file(), &scene, SIZE)
            .expect("a view");
        assert_eq!(views.len(), 1);
        let camera = views[0].camera;
        assert_eq!(camera.position, eye);
        assert!(camera.to_camera(target).truncate().length() < 1e-2, "it looks elsewhere");
        let third = Viewpoint { view: Some(2), ..Viewpoint::default() };
        let third = third.of(&file(), &scene, SIZE, 3).expect("a view");
        let sampled = args(None, Some(3)).of(&file(), &scene, SIZE).expect("views");
        assert_eq!((third.name, third.camera), (sampled[2].name.clone(), sampled[2].camera));
        let nowhere = Viewpoint { look_at: viewpoint.eye, ..viewpoint };
        let error = nowhere.of(&file(), &scene, SIZE, 3).expect_err("no direction").to_string();
        assert!(error.contains("the same point"), "{error}");
    }

    /// Squares that lie above each other and face upwards, each 4 m wide, which no sampled view is fit for.
    fn squares(count: usize) -> TracedScene {
        let square = |index: usize| {
            let corner = |(x, z)| Vec3::new(x, 0.2 * index as f32, z);
            let positions = [(-2.0, -2.0), (-2.0, 2.0), (2.0, 2.0), (2.0, -2.0)].map(corner).to_vec();
            Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
        };
        let meshes: Vec<Mesh> = (0..count).map(square).collect();
        let materials = vec![Material::default()];
        TracedScene::new(Scene { meshes: meshes.into(), materials, ..Scene::default() }).expect("squares")
    }

    #[test]
    fn a_scene_of_which_no_sampled_view_is_fit_is_seen_from_outside_and_asked_for_names_the_option() {
        for count in [1, 2] {
            let scene = squares(count);
            let views = args(None, None).of(&file(), &scene, SIZE).expect("a view");
            assert!(views[0].name.ends_with("from outside"), "{}", views[0].name);
            for corner in scene.bounds().corners() {
                let seen = views[0].camera.to_camera(corner);
                assert!((seen / seen.z).truncate().abs().max_element() < 0.5, "all of it: {seen}");
            }
        }
        let error =
            format!("{:#}", args(None, Some(1)).of(&file(), &squares(1), SIZE).expect_err("none is fit"));
        assert!(error.contains("--eye") && error.contains("none of 2048"), "{error}");
    }

    #[test]
    fn a_family_is_stood_in_as_ever() {
        for family in Family::ALL {
            let (source, scene) = (SceneSource::Procedural(family, 1), family.scene(1));
            let scene = TracedScene::new(scene).expect("a scene");
            let view = args(None, None).of(&source, &scene, SIZE).expect("a view").remove(0);
            let sampled = args(None, Some(1)).of(&source, &scene, SIZE).expect("a view").remove(0);
            assert_eq!((view.name, view.camera), (sampled.name, sampled.camera), "{}", family.name());
        }
    }

    #[test]
    fn a_camera_that_is_not_there_is_named_with_those_that_are() {
        let error = args(Some("middle"), None).of(&file(), &scene(), SIZE).expect_err("no such camera");
        assert_eq!(error.to_string(), "no camera `middle`; the scene brings left, right");
    }
}
