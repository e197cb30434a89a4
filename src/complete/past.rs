//! What a scene that moves was like before, for light that its surfaces keep.

use crate::props;
use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::past;
use deepshade_render::scene::{AnimatedScene, Scene, SceneError, SceneSource};

/// Whether a file has an animation.
fn moves(source: &SceneSource) -> Result<bool, SceneError> {
    match source {
        SceneSource::File(path) => Ok(Scene::animation_span(path)?.is_some()),
        SceneSource::Procedural(..) => Ok(false),
    }
}

/// A scene at the moment of its glow, with poses of the past where something in it moves: of stretches of
/// time that matter alike.
///
/// # Errors
/// If a file cannot be read any more, or a vertex is nowhere at a moment.
pub fn remembered(scene: TracedScene, source: &SceneSource, props: &props::Args) -> Result<TracedScene> {
    let sources = std::iter::once(source).chain(props.all().iter().map(|prop| &prop.source));
    if !sources.map(moves).collect::<Result<Vec<_>, _>>()?.contains(&true) {
        return Ok(scene);
    }
    let mut animated = AnimatedScene::load(source, 0.0)?;
    for prop in props.all() {
        animated.add(AnimatedScene::load(&prop.source, 0.0)?, prop.place());
    }
    Ok(past::of_animation(&animated, scene.scene())?)
}
