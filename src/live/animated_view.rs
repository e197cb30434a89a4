//! A scene in motion, and how the camera goes: what the command lines of `render --animate` and `bench frame`
//! have in common.

use crate::arguments::within;
use crate::complete::{Additions, Wants, complete};
use crate::props;
use crate::radius::Space;
use crate::views::Viewpoint;
use anyhow::{Context, Result};
use deepshade_dataset::views::median_depth;
use deepshade_infer::TrainedUnder;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{AnimatedScene, Camera, SceneSource};
use deepshade_shaders::Effect;
use glam::{Mat3, Vec3};
use std::f32::consts::TAU;

/// A scene in motion.
#[derive(clap::Args, Default)]
#[command(next_help_heading = "Animation")]
pub struct Args {
    /// How far the camera goes around what it looks at, degrees, over the whole sequence; 0 by default.
    #[arg(long, value_parser = within(-36_000.0..=36_000.0), allow_hyphen_values = true)]
    orbit: Option<f32>,
    /// Frames of the sequence; 100 by default.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: Option<u32>,
    /// Frames a second of the animation; 25 by default.
    #[arg(long, value_parser = within(0.01..=1000.0))]
    fps: Option<f32>,
}

/// A scene with a way for the camera.
pub struct AnimatedView {
    /// The scene, with what the effect needs.
    pub animated: AnimatedScene,
    /// The camera of the first frame.
    pub camera: Camera,
    /// What was added to the scene, a sentence each.
    pub added: Vec<String>,
    /// Diagonal of the scene, metres.
    pub diagonal: f32,
    /// Median depth of what the first frame sees, metres, where it sees anything.
    pub depth: Option<f32>,
    pivot: Vec3,
    orbit: f32,
    frames: u32,
    fps: f32,
}

/// What a command wants to see of a scene.
pub struct ViewRequest<'a> {
    /// The scene.
    pub source: &'a SceneSource,
    /// When it begins, seconds.
    pub time: f32,
    /// What is computed: the scene is given what any of these needs.
    pub effects: &'a [Effect],
    /// Rows and columns.
    pub size: [usize; 2],
    /// What is put into it.
    pub props: &'a props::Args,
    /// From where the first frame is seen.
    pub viewpoint: &'a Viewpoint,
    /// What the command line gives the scene.
    pub additions: &'a Additions,
    /// Chooses views and added lights.
    pub seed: u32,
    /// The environment that the network knows by heart.
    pub learned: Option<&'a TrainedUnder>,
}

/// A scene by itself, with what effects need and nothing put into it, as a camera sees it.
///
/// # Errors
/// If the scene cannot be read, or there is no such camera or view.
pub fn plain(
    source: &SceneSource,
    viewpoint: &Viewpoint,
    effects: &[Effect],
    size: [usize; 2],
) -> Result<AnimatedView> {
    let request = ViewRequest {
        source,
        time: 0.0,
        effects,
        size,
        props: &props::Args::default(),
        viewpoint,
        additions: &Additions::default(),
        seed: 0,
        learned: None,
    };
    Args::default().open(&request)
}

impl Args {
    /// Frames of the sequence.
    pub fn frames(&self) -> u32 {
        self.frames.unwrap_or(100)
    }

    /// The first option that is given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--orbit", self.orbit.is_some()),
            ("--frames", self.frames.is_some()),
            ("--fps", self.fps.is_some()),
        ];
        options.into_iter().find_map(|(option, given)| given.then_some(option))
    }

    /// The scene with everything in it, and where the camera begins.
    ///
    /// # Errors
    /// If a scene cannot be read, or there is no such camera or view.
    pub fn open(&self, request: &ViewRequest<'_>) -> Result<AnimatedView> {
        let load = |source: &SceneSource| {
            AnimatedScene::load(source, request.time).with_context(|| format!("scene {source}"))
        };
        let mut animated = load(request.source)?;
        for prop in request.props.all() {
            animated.add(load(&prop.source)?, prop.place());
        }
        let traced = TracedScene::new(animated.scene.clone())?;
        let camera = request.viewpoint.of(request.source, &traced, request.size, request.seed)?.camera;
        let (mut traced, mut camera, mut added) = (traced, camera, Vec::new());
        for effect in request.effects {
            let wants = Wants {
                effect: *effect,
                size: request.size,
                additions: request.additions,
                seed: request.seed,
                learned: request.learned,
                animated: animated.span().is_some(),
                time: request.time,
            };
            let completed = complete(&traced, &camera, &wants)?;
            (traced, camera) = (completed.scene, completed.camera);
            added.extend(completed.added);
        }
        animated.scene.set_look(traced.scene().look());
        let forward = -camera.rotation.z_axis;
        let hit = traced.hit(camera.position, forward, f32::INFINITY);
        let distance = hit.map_or(0.5 * traced.diagonal(), |hit| hit.distance);
        Ok(AnimatedView {
            animated,
            pivot: camera.position + forward * distance,
            camera,
            added,
            diagonal: traced.diagonal(),
            depth: median_depth(&traced, &camera, request.size),
            orbit: self.orbit.unwrap_or(0.0).to_radians(),
            frames: self.frames(),
            fps: self.fps.unwrap_or(25.0),
        })
    }
}

impl AnimatedView {
    /// What a default radius depends on: it stays that of the first frame wherever the camera goes.
    pub const fn space(&self) -> Space {
        Space { diagonal: self.diagonal, depth: self.depth }
    }

    /// When a frame is, seconds after the beginning.
    pub fn seconds(&self, frame: u32) -> f32 {
        frame as f32 / self.fps
    }

    /// A frame's moment in the animation, which begins again when it is over; but not where surfaces keep
    /// light, whose time goes on.
    pub fn time(&self, frame: u32, first: f32) -> f32 {
        let time = first + self.seconds(frame);
        match self.animated.span().filter(|_| self.animated.scene.glow.is_none()) {
            Some([begin, end]) if end > begin && time > end => begin + (time - begin).rem_euclid(end - begin),
            _ => time,
        }
    }

    /// Distance of what the camera looks at first, metres.
    #[cfg(any(feature = "view", target_arch = "wasm32"))]
    pub fn distance(&self) -> f32 {
        self.pivot.distance(self.camera.position)
    }

    /// Where the camera is: on a circle around what it looked at first.
    pub fn camera(&self, frame: u32) -> Camera {
        let turn = Mat3::from_rotation_y((self.orbit * frame as f32 / self.frames as f32).rem_euclid(TAU));
        Camera {
            position: self.pivot + turn * (self.camera.position - self.pivot),
            rotation: turn * self.camera.rotation,
            ..self.camera
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_goes_around_what_it_looks_at() {
        use clap::Parser as _;
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            args: Args,
        }
        let line = Line::try_parse_from(["deepshade", "--orbit", "90", "--frames", "9"]).expect("a line");
        let source = "room:1".parse().expect("a scene");
        let request = ViewRequest {
            source: &source,
            time: 0.0,
            effects: &[Effect::Aa],
            size: [32, 48],
            props: &props::Args::default(),
            viewpoint: &Viewpoint::default(),
            additions: &Additions::default(),
            seed: 0,
            learned: None,
        };
        let animated_view = line.args.open(&request).expect("a room");
        let from_pivot = |frame: u32| animated_view.camera(frame).position - animated_view.pivot;
        let flat = |way: Vec3| Vec3::new(way.x, 0.0, way.z);
        for frame in 0..9 {
            let camera = animated_view.camera(frame);
            let seen = camera.to_camera(animated_view.pivot);
            assert!(seen.truncate().length() < 1e-3 && seen.z < 0.0, "frame {frame} looks elsewhere: {seen}");
            assert!((from_pivot(frame).length() - from_pivot(0).length()).abs() < 1e-3);
        }
        let angle = flat(from_pivot(0)).angle_between(flat(from_pivot(3)));
        assert!((angle.to_degrees() - 30.0).abs() < 0.1, "{angle}");
        assert_eq!(animated_view.time(50, 0.0), 2.0, "nothing is animated");
    }
}
