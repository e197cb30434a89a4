//! Which cameras have no learned ambient occlusion though they ask for it.

use crate::LearnedError;
use bevy::ecs::entity::EntityHashMap;
use bevy::log::error;
use bevy::prelude::{Entity, Resource};

/// In the render world: why cameras have no learned ambient occlusion though they ask for it.
#[derive(Debug, Default, Resource)]
pub struct LearnedFailures(EntityHashMap<String>);

impl LearnedFailures {
    /// Why a camera, an entity of the render world, has none.
    pub fn of(&self, view: Entity) -> Option<&str> {
        self.0.get(&view).map(String::as_str)
    }

    /// Each camera's cause.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        self.0.values().map(String::as_str)
    }

    /// Remembers a cause, and logs it where it is a new one.
    pub(crate) fn tell(&mut self, view: Entity, error: &LearnedError) {
        let text = error.to_string();
        if self.of(view) != Some(&text) {
            error!("LearnedAmbientOcclusion: {text}");
            self.0.insert(view, text);
        }
    }

    /// Forgets a camera that has what it asks for, or asks no more.
    pub(crate) fn forget(&mut self, view: Entity) {
        self.0.remove(&view);
    }

    /// Forgets all cameras but these.
    pub(crate) fn keep(&mut self, views: impl Fn(Entity) -> bool) {
        self.0.retain(|view, _| views(*view));
    }
}
