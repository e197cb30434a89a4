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
use glam::Vec3;
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
    /// Which of its lights animations move.
    rigged: Vec<bool>,
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
            rigged: rigged(&staged.animated),
            animated: staged.animated,
            props: args.props.clone(),
            traced: Mutex::new(None),
        })
    }

    /// The lights that hands have left, where they are this scene's: as many, and of the same kinds. Else its own.
    pub fn lights(&self, hands: Option<&[Light]>) -> Vec<Light> {
        let own = &self.animated.scene.lights;
        hands.filter(|hands| fit(hands, own)).unwrap_or(own).to_vec()
    }

    /// Whether an animation moves one of its lights, so that hands cannot.
    pub fn is_rigged(&self, light: usize) -> bool {
        self.rigged.get(light) == Some(&true)
    }

    /// For how long its animations last, seconds; 0 where nothing moves.
    pub fn moves_for(&self) -> f32 {
        self.animated.span().map_or(0.0, |[begin, end]| end - begin)
    }

    /// The scene at a moment, seconds, under these lights, but for those that animations move, ready for rays.
    ///
    /// # Errors
    /// If its file has gone meanwhile.
    pub fn traced(&self, time: f32, lights: &[Light]) -> Result<Arc<TracedScene>> {
        let traced = self.at(time)?;
        let mut lights = lights.to_vec();
        self.animated.light(&mut lights, time);
        if traced.scene().lights == lights {
            return Ok(traced);
        }
        let look = Look { lights, ..traced.scene().look() };
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

/// Whether lights are as many, and of the same kinds.
fn fit(some: &[Light], others: &[Light]) -> bool {
    let kinds = |lights: &[Light]| lights.iter().map(std::mem::discriminant).collect::<Vec<_>>();
    kinds(some) == kinds(others)
}

/// Which lights animations move: those that they bring back from elsewhere.
fn rigged(animated: &AnimatedScene) -> Vec<bool> {
    let away = |light: &Light| light.moved(|place| place + Vec3::ONE, |direction| -direction);
    let elsewhere: Vec<Light> = animated.scene.lights.iter().map(away).collect();
    let mut back = elsewhere.clone();
    let begin = animated.span().map_or(0.0, |[begin, _]| begin);
    animated.light(&mut back, begin);
    back.iter().zip(&elsewhere).map(|(back, elsewhere)| back != elsewhere).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_fit_where_they_are_as_many_and_of_the_same_kinds() {
        let point = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        let sun = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None };
        let dim = point.brighter(0.5);
        assert!(fit(&[point, sun], &[dim, sun]));
        assert!(!fit(&[point], &[point, sun]) && !fit(&[sun], &[point]));
    }
}
