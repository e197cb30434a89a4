//! Which scene is in motion, and how the camera goes: what the command lines of `render --animate` and `bench frame`
//! have in common.

use crate::complete::{Additions, Wants, complete};
use crate::views;
use anyhow::{Context, Result, ensure};
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{AnimatedScene, Camera, SceneSource};
use deepshade_shaders::Effect;
use glam::{Mat3, Mat4, Quat, Vec3};
use std::f32::consts::TAU;
use std::str::FromStr;

/// A scene that is put into another one, written like `fox.gltf@0,0,1.5,0.02,90`.
#[derive(Clone, Debug, PartialEq)]
pub struct Prop {
    source: SceneSource,
    place: Vec3,
    scale: f32,
    /// Radians about the world's y axis.
    turn: f32,
}

impl FromStr for Prop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const FORM: &str = "expected SCENE@X,Y,Z[,SCALE[,DEGREES]], such as fox.gltf@0,0,1.5,0.02,90";
        let (source, numbers) = text.rsplit_once('@').ok_or(FORM)?;
        let number = |text: &str| text.trim().parse::<f32>().ok().filter(|value| value.is_finite());
        let numbers: Vec<f32> = numbers.split(',').map(number).collect::<Option<_>>().ok_or(FORM)?;
        let (place, scale, turn) = match numbers[..] {
            [x, y, z] => (Vec3::new(x, y, z), 1.0, 0.0),
            [x, y, z, scale] => (Vec3::new(x, y, z), scale, 0.0),
            [x, y, z, scale, degrees] => (Vec3::new(x, y, z), scale, degrees.to_radians()),
            _ => return Err(FORM.to_owned()),
        };
        if scale <= 0.0 {
            return Err(format!("a scale of {scale} leaves nothing"));
        }
        let source =
            source.parse().map_err(|error: deepshade_render::scene::SceneError| error.to_string())?;
        Ok(Self { source, place, scale, turn })
    }
}

/// Reads X,Y,Z.
fn point(text: &str) -> Result<Vec3, String> {
    let number = |text: &str| text.trim().parse::<f32>().ok().filter(|value| value.is_finite());
    let numbers: Option<Vec<f32>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
        _ => Err(format!("`{text}` is not X,Y,Z")),
    }
}

/// A scene in motion.
#[derive(clap::Args)]
#[command(next_help_heading = "Animation")]
pub struct Args {
    /// Puts another scene into this one: SCENE@X,Y,Z,SCALE,DEGREES, metres and degrees about the upward axis, of which the
    /// last one or two may be left out. May be
    /// given several times.
    #[arg(long, allow_hyphen_values = true)]
    put: Vec<Prop>,
    /// Where the camera stands: X,Y,Z, metres.
    #[arg(long, value_parser = point, requires = "look_at", allow_hyphen_values = true)]
    eye: Option<Vec3>,
    /// What it looks at: X,Y,Z, metres.
    #[arg(long, value_parser = point, requires = "eye", allow_hyphen_values = true)]
    look_at: Option<Vec3>,
    /// How far the camera goes around what it looks at, degrees, over the whole sequence; 0 by default.
    #[arg(long, value_parser = finite, allow_hyphen_values = true)]
    orbit: Option<f32>,
    /// Frames of the sequence; 100 by default.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: Option<u32>,
    /// Frames a second of the animation; 25 by default.
    #[arg(long, value_parser = crate::arguments::positive)]
    fps: Option<f32>,
}

/// Reads a number that is one.
fn finite(text: &str) -> Result<f32, String> {
    let number = text.parse::<f32>().ok().filter(|value| value.is_finite());
    number.ok_or_else(|| format!("`{text}` is not a number"))
}

/// A scene with a way for the camera.
pub struct Staged {
    /// The scene, with what the effect needs.
    pub animated: AnimatedScene,
    /// The camera of the first frame.
    pub camera: Camera,
    /// What was added to the scene, a sentence each.
    pub added: Vec<String>,
    /// Diagonal of the scene, metres.
    pub diagonal: f32,
    pivot: Vec3,
    orbit: f32,
    frames: u32,
    fps: f32,
}

/// What a command wants to see of a scene.
pub struct Seen<'a> {
    /// The scene.
    pub source: &'a SceneSource,
    /// When it begins, seconds.
    pub time: f32,
    /// What is computed: the scene is given what any of these needs.
    pub effects: &'a [Effect],
    /// Rows and columns.
    pub size: [usize; 2],
    /// One of the file's cameras.
    pub camera: Option<&'a str>,
    /// A sampled view, by its number.
    pub view: Option<usize>,
    /// What the command line gives the scene.
    pub additions: &'a Additions,
    /// Chooses views and added lights.
    pub seed: u32,
}

impl Args {
    /// Frames of the sequence.
    pub fn frames(&self) -> u32 {
        self.frames.unwrap_or(100)
    }

    /// The first option that is given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--put", !self.put.is_empty()),
            ("--eye", self.eye.is_some()),
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
    pub fn stage(&self, seen: &Seen<'_>) -> Result<Staged> {
        let load = |source: &SceneSource| {
            AnimatedScene::load(source, seen.time).with_context(|| format!("scene {source}"))
        };
        let mut animated = load(seen.source)?;
        for Prop { source, place, scale, turn } in &self.put {
            let turn = Quat::from_rotation_y(*turn);
            let place = Mat4::from_scale_rotation_translation(Vec3::splat(*scale), turn, *place);
            animated.add(load(source)?, place);
        }
        let traced = TracedScene::new(animated.scene.clone())?;
        let camera = match (self.eye, self.look_at) {
            (Some(eye), Some(target)) => {
                ensure!(eye.distance(target) > 0.0, "--eye and --look-at are the same point");
                Camera::look_at(eye, target)
            }
            _ => views::one(&traced, seen.size, seen.camera, seen.view, seen.seed)?.camera,
        };
        let (mut traced, mut camera, mut added) = (traced, camera, Vec::new());
        for effect in seen.effects {
            let wants = Wants {
                effect: *effect,
                size: seen.size,
                additions: seen.additions,
                seed: seen.seed,
                animated: animated.span().is_some(),
            };
            let completed = complete(&traced, &camera, &wants)?;
            (traced, camera) = (completed.scene, completed.camera);
            added.extend(completed.added);
        }
        animated.scene.set_look(traced.scene().look());
        let forward = -camera.rotation.z_axis;
        let hit = traced.hit(camera.position, forward, f32::INFINITY);
        let distance = hit.map_or(0.5 * traced.diagonal(), |hit| hit.distance);
        Ok(Staged {
            animated,
            pivot: camera.position + forward * distance,
            camera,
            added,
            diagonal: traced.diagonal(),
            orbit: self.orbit.unwrap_or(0.0).to_radians(),
            frames: self.frames(),
            fps: self.fps.unwrap_or(25.0),
        })
    }
}

impl Staged {
    /// When a frame is, seconds after the beginning.
    pub fn seconds(&self, frame: u32) -> f32 {
        frame as f32 / self.fps
    }

    /// A frame's moment in the animation, which begins again when it is over.
    pub fn time(&self, frame: u32, first: f32) -> f32 {
        let time = first + self.seconds(frame);
        match self.animated.span() {
            Some([begin, end]) if end > begin && time > end => begin + (time - begin).rem_euclid(end - begin),
            _ => time,
        }
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
    fn props_say_where_they_stand() {
        let prop: Prop = "a@b/fox.gltf@0,-1,1.5,0.02,90".parse().expect("a prop");
        let turn = std::f32::consts::FRAC_PI_2;
        let source = "a@b/fox.gltf".parse().expect("a file");
        assert_eq!(prop, Prop { source, place: Vec3::new(0.0, -1.0, 1.5), scale: 0.02, turn });
        assert!("stairs:7@0,0,0".parse::<Prop>().is_ok());
        for (wrong, said) in [
            ("fox.gltf", "expected"),
            ("fox.gltf@1,2", "expected"),
            ("fox.gltf@1,2,x", "expected"),
            ("fox.gltf@1,2,3,0", "scale"),
            ("fox@1,2,3", "neither a scene file"),
        ] {
            let error = wrong.parse::<Prop>().expect_err("no prop");
            assert!(error.contains(said), "{wrong}: {error}");
        }
    }

    #[test]
    fn the_camera_goes_around_what_it_looks_at() {
        use clap::Parser as _;
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            args: Args,
            #[command(flatten)]
            additions: Additions,
        }
        let line = Line::try_parse_from(["deepshade", "--orbit", "90", "--frames", "9"]).expect("a line");
        let source = "room:1".parse().expect("a scene");
        let seen = Seen {
            source: &source,
            time: 0.0,
            effects: &[Effect::Aa],
            size: [32, 48],
            camera: None,
            view: None,
            additions: &line.additions,
            seed: 0,
        };
        let staged = line.args.stage(&seen).expect("a room");
        let from_pivot = |frame: u32| staged.camera(frame).position - staged.pivot;
        let flat = |way: Vec3| Vec3::new(way.x, 0.0, way.z);
        for frame in 0..9 {
            let camera = staged.camera(frame);
            let seen = camera.to_camera(staged.pivot);
            assert!(seen.truncate().length() < 1e-3 && seen.z < 0.0, "frame {frame} looks elsewhere: {seen}");
            assert!((from_pivot(frame).length() - from_pivot(0).length()).abs() < 1e-3);
        }
        let angle = flat(from_pivot(0)).angle_between(flat(from_pivot(3)));
        assert!((angle.to_degrees() - 30.0).abs() < 0.1, "{angle}");
        assert_eq!(staged.time(50, 0.0), 2.0, "nothing is animated");
    }
}
