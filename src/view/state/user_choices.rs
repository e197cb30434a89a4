//! What the user and the command line have stated, which stays stated when another effect is shown.

use crate::learned;
use crate::methods::{self, LEARNED, TRUTH};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use std::collections::HashMap;
use std::path::Path;

/// Methods and a radius that were asked for.
#[derive(Default)]
pub struct UserChoices {
    /// Of each effect the methods that were stated while it was shown.
    methods: HashMap<Effect, Vec<&'static str>>,
    /// Those that were stated last, of whatever effect.
    newest: Vec<&'static str>,
    /// Metres, or infinite.
    radius: Option<f32>,
}

impl UserChoices {
    /// Keeps the methods that were stated for an effect.
    pub fn state_methods(&mut self, effect: Effect, methods: &[&'static str]) {
        self.methods.insert(effect, methods.to_vec());
        methods.clone_into(&mut self.newest);
    }

    /// Keeps a radius, or that there is to be the usual one.
    pub const fn state_radius(&mut self, radius: Option<f32>) {
        self.radius = radius;
    }

    /// The methods of an effect that is shown from now on: those that were stated for it, else those that it
    /// has of what was stated last. Nothing where none was. The trained network is among them only where
    /// there `is_network`.
    pub fn methods(&self, effect: Effect, is_network: bool) -> Option<Vec<&'static str>> {
        let can_be = |name: &&'static str| *name != LEARNED || is_network;
        if let Some(methods) = self.methods.get(&effect) {
            return Some(methods.iter().copied().filter(can_be).collect());
        }
        let known = methods::names_of(effect).into_iter();
        let shared: Vec<&str> = known.filter(|name| self.newest.contains(name)).filter(can_be).collect();
        (!shared.is_empty()).then_some(shared)
    }

    /// The radius of an effect that is shown from now on, where it has one and one was stated.
    pub fn radius(&self, effect: Effect) -> Option<f32> {
        self.radius.filter(|_| effect.listens_to(EffectSetting::Radius))
    }
}

/// The first two methods of an effect; the trained network only where there `is_network`.
pub fn first_methods(effect: Effect, is_network: bool) -> Vec<&'static str> {
    let there = |name: &&str| *name != TRUTH && (*name != LEARNED || is_network);
    methods::names_of(effect).into_iter().filter(there).take(2).collect()
}

/// Whether there is a network for an effect: in a folder, or where none is named in the usual one.
pub fn is_network(model: Option<&Path>, effect: Effect) -> bool {
    learned::is_network(&model.map_or_else(|| learned::usual_folder(effect), Path::to_owned))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_stated_for_one_effect_is_shown_of_others_that_have_it() {
        let mut stated = UserChoices::default();
        assert_eq!((stated.methods(Effect::Ao, true), stated.radius(Effect::Ao)), (None, None));
        stated.state_methods(Effect::Ao, &["hbao", "surfel"]);
        assert_eq!(stated.methods(Effect::Gi, true), Some(vec!["surfel"]));
        assert_eq!(stated.methods(Effect::Dof, true), None, "it has neither");
        stated.state_methods(Effect::Gi, &["ssgi"]);
        assert_eq!(stated.methods(Effect::Ao, true), Some(vec!["hbao", "surfel"]), "as it was left");
        stated.state_methods(Effect::Ao, &["learned", "gtao"]);
        let of = |is_network| stated.methods(Effect::Ao, is_network).expect("stated");
        assert_eq!((of(true), of(false)), (vec!["learned", "gtao"], vec!["gtao"]));
        // Nothing is shown where the user has put all away.
        stated.state_methods(Effect::Ao, &[]);
        assert_eq!(stated.methods(Effect::Ao, true), Some(Vec::new()));
    }

    #[test]
    fn a_stated_radius_is_that_of_every_effect_that_has_one() {
        let mut stated = UserChoices::default();
        stated.state_radius(Some(0.5));
        assert_eq!((stated.radius(Effect::Ao), stated.radius(Effect::Gi)), (Some(0.5), Some(0.5)));
        assert_eq!(stated.radius(Effect::Aa), None);
        stated.state_radius(None);
        assert_eq!(stated.radius(Effect::Ao), None);
    }
}
