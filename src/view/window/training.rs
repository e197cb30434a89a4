//! Trainings that the window begins, and a training run that it follows: its weights are run from each
//! checkpoint on.

use super::Window;
use crate::output::message;
use crate::view::training_process::{TrainingOptions, TrainingProcess};
use crate::view::training_run::TrainingRun;
use anyhow::Context as _;
use deepshade_shaders::Effect;
use std::path::{Path, PathBuf};

/// Trainings that the window begins and follows.
#[derive(Default)]
pub struct Training {
    /// What the user wants to be trained.
    pub options: TrainingOptions,
    /// The training that they have begun, while it runs.
    pub process: Option<TrainingProcess>,
    /// What is known of a training run.
    pub run: Option<TrainingRun>,
    /// The network's folder that is followed.
    followed: Option<PathBuf>,
}

impl Window {
    /// The run whose folder is the network's, as far as it is known.
    pub fn training_of_model(&self) -> Option<&TrainingRun> {
        let model = self.state.show.model.as_ref()?;
        self.training.run.as_ref().filter(|run| run.folder == *model)
    }

    /// Begins the training that the user wants.
    pub fn begin_training(&mut self) {
        let sender = self.workers.sender.clone();
        let send = move |update| sender.send(update);
        let program = std::env::current_exe().context("the program's own file");
        match program.and_then(|program| TrainingProcess::begin(program, &self.training.options, send)) {
            Ok(process) => self.training.process = Some(process),
            Err(error) => self.set_error(message(&error)),
        }
    }

    /// Shows what a training makes that has begun.
    pub(super) fn training_began(&mut self, effect: Effect, folder: &Path) {
        self.state.begin_training(effect, folder);
        self.changed();
    }

    /// Says how a training has ended, and leaves a folder that has come to nothing.
    pub(super) fn training_ended(&mut self, how: Result<String, String>) {
        self.training.process = None;
        if self.state.end_training() {
            self.changed();
        }
        match how {
            Ok(note) => self.messages.set_note(note),
            Err(error) => self.set_error(error),
        }
    }

    /// Has the folder of the network followed, which may be a run's, and shows what its newest weights make;
    /// but for a film, which shows one thing.
    pub(super) fn follow_training(&mut self) {
        let newest = self.training_of_model().and_then(|run| run.checkpoint.as_ref());
        if let Some((_, trained)) = newest.filter(|_| self.recording.is_none()) {
            self.state.take_weights(trained.clone());
        }
        let model = &self.state.show.model;
        if self.training.followed == *model {
            return;
        }
        self.workers.training_run.put(model.clone());
        self.training.followed.clone_from(model);
    }
}
