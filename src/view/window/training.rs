//! A training run that the window follows: its weights are run from each checkpoint on.

use super::Window;
use crate::view::trainer::Trainer;
use crate::view::training::Training;
use anyhow::Result;
use deepshade_shaders::Effect;
use std::path::Path;

impl Window {
    /// The run whose folder is the network's, as it was heard of last.
    pub fn training_of_model(&self) -> Option<&Training> {
        let model = self.state.show.model.as_ref()?;
        self.training.as_ref().filter(|training| training.folder == *model)
    }

    /// After how many steps its newest checkpoint was saved.
    pub fn trained_step(&self) -> Option<usize> {
        self.training_of_model()?.checkpoint.as_ref().map(|(progress, _)| progress.step)
    }

    /// Begins the training that is wished for.
    ///
    /// # Errors
    /// As [`Trainer::begin`].
    pub fn begin_training(&self) -> Result<Trainer> {
        self.desk.train(&self.wish)
    }

    /// Looks at what a training makes that has begun.
    pub(super) fn training_began(&mut self, effect: Effect, folder: &Path) {
        self.trainer.iter_mut().for_each(|trainer| trainer.has_begun = true);
        self.state.begin_training(effect, folder);
        self.changed();
    }

    /// Says how a training has ended, and looks away from a folder that has come to nothing.
    pub(super) fn training_ended(&mut self, how: Result<String, String>) {
        self.trainer = None;
        if self.state.end_training() {
            self.changed();
        }
        match how {
            Ok(note) => self.say(note),
            Err(what) => self.refuse(what),
        }
    }

    /// Has the folder of the network followed, which may be a run's, and shows what its newest weights make; but for a film, which
    /// shows one thing.
    pub(super) fn follow(&mut self) {
        let newest = self.training_of_model().and_then(|training| training.checkpoint.as_ref());
        if let Some((_, trained)) = newest.filter(|_| self.recording.is_none()) {
            self.state.take_weights(trained.clone());
        }
        let model = &self.state.show.model;
        if self.followed == *model {
            return;
        }
        self.desk.follower.put(model.clone());
        self.followed.clone_from(model);
    }
}
