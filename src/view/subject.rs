//! What the window shows: a scene with all that an effect needs of it, for the GPU and for rays.

use super::Args;
use crate::exposure_time;
use crate::live::stage::{self, Seen};
use crate::props;
use crate::view::pilot::Pilot;
use crate::views::Viewpoint;
use anyhow::Result;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::{AnimatedScene, Light, Look, SceneSource};
use deepshade_shaders::Effect;
use std::sync::{Arc, Mutex, PoisonError};

/// A scene with all that an effect needs of it.
pub struct Subject {
    /// Where it is from.
    pub source: SceneSource,
    /// The effect it was completed for.
    pub effect: Effect,
    /// The scene.
    pub animated: AnimatedScene,
    /// From where it is seen first.
    pub pilot: Pilot,
    /// What was added to the scene, a sentence each.
    pub added: Vec<String>,
    /// Diagonal of the scene, metres.
    pub diagonal: f32,
    props: props::Args,
    /// The scene for rays, at the moment that was asked for last.
    traced: Mutex<Option<(f32, Arc<TracedScene>)>>,
}

impl Subject {
    /// Reads a scene and completes it.
    ///
    /// # Errors
    /// If it cannot be read, or there is no such camera or view.
    pub fn load(args: &Args, source: &SceneSource, effect: Effect) -> Result<Self> {
        // Another scene than the one of the command line has other cameras.
        let elsewhere = Viewpoint::default();
        let viewpoint = if *source == args.scene { &args.viewpoint } else { &elsewhere };
        let seen = Seen {
            source,
            time: args.time,
            effects: &[effect],
            size: [args.height, args.width],
            props: &args.props,
            viewpoint,
            additions: &args.additions,
            seed: args.seed,
        };
        let staged = stage::Args::default().stage(&seen)?;
        Ok(Self {
            source: source.clone(),
            effect,
            pilot: Pilot::new(staged.camera, staged.distance()),
            added: staged.added,
            diagonal: staged.diagonal,
            animated: staged.animated,
            props: args.props.clone(),
            traced: Mutex::new(None),
        })
    }

    /// The scene at a moment, seconds, under these lights, ready for rays.
    ///
    /// # Errors
    /// If its file has gone meanwhile.
    pub fn traced(&self, time: f32, lights: &[Light]) -> Result<Arc<TracedScene>> {
        let traced = self.at(time)?;
        if traced.scene().lights == lights {
            return Ok(traced);
        }
        let look = Look { lights: lights.to_vec(), ..traced.scene().look() };
        Ok(Arc::new(traced.with_look(look)?))
    }

    fn at(&self, time: f32) -> Result<Arc<TracedScene>> {
        let mut kept = self.traced.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((moment, traced)) = kept.as_ref()
            && (*moment == time || self.animated.span().is_none())
        {
            return Ok(Arc::clone(traced));
        }
        let mut scene = match self.animated.span() {
            Some(_) => {
                exposure_time::Args::new(Some(time), None).scene(&self.source, &self.props, self.effect)?
            }
            None => self.animated.scene.clone(),
        };
        scene.set_look(self.animated.scene.look());
        let traced = Arc::new(TracedScene::new(scene)?);
        *kept = Some((time, Arc::clone(&traced)));
        Ok(traced)
    }
}
