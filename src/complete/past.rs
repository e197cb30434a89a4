//! What a scene that moves was like before, for light that its surfaces keep.

use crate::props;
use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{AnimatedScene, Glow, Scene, SceneError, SceneSource};

/// Poses at most, and the triangles of all of them: each takes memory as the scene does.
const POSES: usize = 48;
const TRIANGLES: usize = 4_000_000;

/// Whether a file has an animation.
///
/// # Errors
/// If it cannot be read.
pub fn moves(source: &SceneSource) -> Result<bool, SceneError> {
    match source {
        SceneSource::File(path) => Ok(Scene::animation_span(path)?.is_some()),
        SceneSource::Procedural(..) => Ok(false),
    }
}

/// A scene at the moment of its glow, with poses of the past where something in it moves: of stretches of time that matter alike.
///
/// # Errors
/// If a file cannot be read any more, or triangles come and go as the scene moves.
pub fn remembered(scene: TracedScene, source: &SceneSource, props: &props::Args) -> Result<TracedScene> {
    let sources = std::iter::once(source).chain(props.all().iter().map(|prop| &prop.source));
    if !sources.map(moves).collect::<Result<Vec<_>, _>>()?.contains(&true) {
        return Ok(scene);
    }
    let mut animated = AnimatedScene::load(source, 0.0)?;
    for prop in props.all() {
        animated.add(AnimatedScene::load(&prop.source, 0.0)?, prop.place());
    }
    let glow = Glow::of(scene.scene());
    let count = (TRIANGLES / scene.scene().triangle_count().max(1)).clamp(2, POSES);
    let pose = |[from, at]: [f32; 2]| {
        let mut posed = animated.at(at, 0.0)?;
        let mut look = scene.scene().look();
        animated.light(&mut look.lights, at);
        posed.set_look(look);
        Ok((from, TracedScene::new(posed)?))
    };
    let past = glow.stretches(glow.moment, count).into_iter().map(pose).collect::<Result<Vec<_>>>()?;
    Ok(scene.with_past(past)?)
}
