//! Which network the user has chosen for which effect.

use super::State;
use crate::learned;
use crate::location::Location;
use crate::methods::LEARNED;
#[cfg(feature = "train")]
use crate::view::method_worker::Trained;
use anyhow::Result;
use deepshade_shaders::Effect;
use std::path::Path;
#[cfg(feature = "train")]
use std::path::PathBuf;

/// A network that a training under way is to make.
#[cfg(feature = "train")]
pub struct ExpectedNetwork {
    effect: Effect,
    folder: PathBuf,
    /// The one whose place it has taken, where the user had chosen one.
    before: Option<PathBuf>,
}

impl State {
    /// Shows what the network in a folder makes.
    ///
    /// # Errors
    /// If it is damaged.
    pub fn open_model(&mut self, folder: &Path) -> Result<()> {
        self.take_network(learned::spec(folder)?.effect, folder);
        Ok(())
    }

    /// Shows what a network makes of an effect, once there is one in a folder.
    fn take_network(&mut self, effect: Effect, folder: &Path) {
        self.networks.insert(effect, folder.to_owned());
        self.show.models_opened += 1;
        self.choose_effect(effect);
        // Whoever opens a network wants to see it, whatever else was stated.
        let is_shown = self.show.methods.contains(&LEARNED);
        if !is_shown && learned::is_network(folder) {
            self.switch(LEARNED);
        }
        #[cfg(feature = "train")]
        {
            self.awaits_network = !self.show.methods.contains(&LEARNED);
        }
    }

    /// Where the network in a folder is from: the address that was given, where it was fetched from there.
    pub fn location_of_network(&self, folder: &Path) -> Location {
        let is_fetched = self.fetched.as_deref() == Some(folder);
        let given = self.args.model.clone().filter(|_| is_fetched);
        given.unwrap_or_else(|| Location::Folder(folder.to_owned()))
    }
}

#[cfg(feature = "train")]
impl State {
    /// Shows what a training that has begun makes of an effect, once there is something in the folder of its
    /// run.
    pub fn begin_training(&mut self, effect: Effect, folder: &Path) {
        let before = self.networks.get(&effect).cloned();
        self.promised = Some(ExpectedNetwork { effect, folder: folder.to_owned(), before });
        self.take_network(effect, folder);
    }

    /// Knows that nobody is at the training any more: where it has left no network, the effect has the one
    /// that it had before. Whether something else is shown by that.
    pub fn end_training(&mut self) -> bool {
        let Some(ExpectedNetwork { effect, folder, before }) = self.promised.take() else { return false };
        // The user may have chosen another one meanwhile, or named this very folder before.
        let is_chosen = self.networks.get(&effect) == Some(&folder) && before.as_ref() != Some(&folder);
        if !is_chosen || learned::is_network(&folder) {
            return false;
        }
        match before {
            Some(before) => self.networks.insert(effect, before),
            None => self.networks.remove(&effect),
        };
        let is_shown = self.show.effect == effect;
        if is_shown {
            self.choose_effect(effect);
        }
        is_shown
    }

    /// Runs weights that the training run whose folder is the network's has come to; the first ones bring the
    /// method with them, where it was left out for want of any. Those for another effect are not run here.
    pub fn take_weights(&mut self, trained: Trained) {
        let effect = trained.0.spec.effect;
        if effect != self.show.effect {
            // A run that was not there yet was taken for one of this effect: its own finds it from now on.
            if let Some(folder) = self.networks.remove(&self.show.effect) {
                self.networks.insert(effect, folder);
            }
            return;
        }
        self.show.trained = Some(trained);
        if std::mem::take(&mut self.awaits_network) && !self.show.methods.contains(&LEARNED) {
            self.switch(LEARNED);
        }
    }
}
