//! Which cameras have not what they ask for.

use crate::LearnedError;
use crate::effect::LearnedEffect;
use bevy::log::error;
use bevy::platform::collections::HashMap;
use bevy::prelude::{Entity, Resource};

/// In the render world: why cameras have no learned ambient occlusion or depth of field though they ask for
/// it.
#[derive(Debug, Default, Resource)]
pub struct LearnedFailures(HashMap<(Entity, &'static str), String>);

impl LearnedFailures {
    /// Why a camera, an entity of the render world, has not all that it asks for.
    pub fn of(&self, view: Entity) -> impl Iterator<Item = &str> {
        let of_view = self.0.iter().filter(move |((other, _), _)| *other == view);
        of_view.map(|(_, text)| text.as_str())
    }

    /// Each camera's causes.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        self.0.values().map(String::as_str)
    }

    /// Remembers a cause, and logs it where it is a new one.
    pub(crate) fn tell<E: LearnedEffect>(&mut self, view: Entity, error: &LearnedError) {
        let text = error.to_string();
        let key = (view, E::COMPONENT);
        if self.0.get(&key) != Some(&text) {
            error!("{}: {text}", E::COMPONENT);
            self.0.insert(key, text);
        }
    }

    /// Forgets why a camera had not what it now has.
    pub(crate) fn forget<E: LearnedEffect>(&mut self, view: Entity) {
        self.0.remove(&(view, E::COMPONENT));
    }

    /// Forgets all cameras but these, which still ask.
    pub(crate) fn keep<E: LearnedEffect>(&mut self, views: impl Fn(Entity) -> bool) {
        self.0.retain(|(view, component), _| *component != E::COMPONENT || views(*view));
    }
}
