//! What a scene that moves was like before, for light that its surfaces keep: poses of stretches of time that
//! matter alike ([`Glow::stretches`]).

use crate::bvh::TracedScene;
use crate::scene::{AnimatedScene, Glow, Light, Look, Scene, SceneError};
use rayon::prelude::*;

/// Poses of an animation at most, and the triangles of all poses: each takes memory as the scene does.
const POSES: usize = 48;
const TRIANGLES: usize = 4_000_000;

/// A scene at the moment of its glow, with what it was like before in so many poses at most, or as if it had
/// always been so without any; `pose` is the scene at a moment, seconds, with the same triangles.
///
/// # Errors
/// If there is no such pose, or as [`TracedScene::new`] and [`TracedScene::with_past`].
pub fn remembered(
    now: TracedScene,
    most: usize,
    pose: impl Fn(f32) -> Result<Scene, SceneError> + Sync,
) -> Result<TracedScene, SceneError> {
    let posed = |[from, at]: [f32; 2]| Ok((from, TracedScene::new(pose(at)?)?));
    let past: Result<Vec<_>, SceneError> = stretches(now.scene(), most).into_par_iter().map(posed).collect();
    now.with_past(past?)
}

/// What looks like `now`, posed as an animation has it at the moment of its glow, with what it was like
/// before where anything moves. The animation moves its own lights, too.
///
/// # Errors
/// If a vertex is nowhere at a moment, or as [`remembered`].
pub fn of_animation(animated: &AnimatedScene, now: &Scene) -> Result<TracedScene, SceneError> {
    let pose = |seconds: f32| {
        let mut scene = Scene { meshes: animated.at(seconds, 0.0)?.meshes, ..now.clone() };
        animated.light(&mut scene.lights, seconds);
        Ok(scene)
    };
    let scene = TracedScene::new(pose(Glow::of(now).moment)?)?;
    if animated.rigs.is_empty() { Ok(scene) } else { remembered(scene, POSES, pose) }
}

/// What [`of_animation`] has made, under other lights at all of its moments but for those that the animation
/// moves; `moment` is the one that is shown, seconds.
///
/// # Errors
/// As [`TracedScene::with_look`].
pub fn lit(
    animated: &AnimatedScene,
    traced: &TracedScene,
    lights: &[Light],
    moment: f32,
) -> Result<TracedScene, SceneError> {
    let under = |pose: &TracedScene, seconds: f32| {
        let mut lights = lights.to_vec();
        animated.light(&mut lights, seconds);
        pose.with_look(Look { lights, ..pose.scene().look() })
    };
    let poses = traced.past().iter().zip(stretches(traced.scene(), POSES));
    let past = poses.map(|((from, pose), [_, at])| Ok((*from, under(pose, at)?)));
    let past = past.collect::<Result<Vec<_>, SceneError>>()?;
    under(traced, moment)?.with_past(past)
}

fn stretches(scene: &Scene, most: usize) -> Vec<[f32; 2]> {
    let glow = Glow::of(scene);
    let count = (TRIANGLES / scene.triangle_count().max(1)).max(2).min(most);
    glow.stretches(glow.moment, count)
}
