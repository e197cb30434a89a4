//! The thread that writes and reads files, one task after the other, so that the window never waits for a
//! disk.

use super::catch_panic::catch_panic;
use super::design::written::{GLOW, WANTED, Written};
use super::display_image::{DisplayImage, rgb};
use super::film::{self, Still};
use super::layers::{Choice, Opened};
use super::saved::{self, Snapshot};
use super::workers::{SendUpdate, Update};
use crate::output::message;
use crate::report::images::write_png;
use anyhow::Result;
use eframe::egui::ColorImage;
use std::path::PathBuf;
use std::sync::{Arc, mpsc};

/// Something to be done with files. Each is answered by one [`Update::File`].
pub enum FileTask {
    /// Writes what was shown at a moment into a folder.
    Save(Box<Snapshot>, PathBuf),
    /// Writes what was designed into a folder.
    Design(Box<Written>, PathBuf),
    /// Writes an image of the window.
    Screenshot(Arc<ColorImage>, PathBuf),
    /// Reads an EXR file.
    Open(PathBuf),
    /// Makes images of an EXR file's layers.
    Layers(Box<Choice>),
    /// Writes a frame of a film.
    Frame(Still, PathBuf),
    /// Makes a video of the film's frames.
    Film(film::Made),
}

/// What came of a task.
pub enum FileResult {
    /// Nothing needs to be said.
    Silent,
    /// A note for the user.
    Note(String),
    /// A file was read.
    Opened(Opened),
    /// Images of layers, or why there are none.
    Layers(Box<Choice>, Result<Vec<DisplayImage>>),
}

/// Does tasks until the channel is closed.
pub fn run(tasks: mpsc::Receiver<FileTask>, send: SendUpdate<'_>) {
    for task in tasks {
        let done = catch_panic(task.name(), || task.run());
        send(Update::File(done.map_err(|error| message(&error))));
    }
}

impl FileTask {
    const fn name(&self) -> &'static str {
        match self {
            Self::Save(..) | Self::Design(..) | Self::Screenshot(..) => "saving",
            Self::Open(_) | Self::Layers(_) => "opening an EXR file",
            Self::Frame(..) | Self::Film(_) => "recording",
        }
    }

    fn run(&self) -> Result<FileResult> {
        Ok(match self {
            Self::Save(snapshot, folder) => {
                saved::save(snapshot, folder)?;
                FileResult::Note(format!("saved in {}", folder.display()))
            }
            Self::Design(written, folder) => {
                written.write(folder)?;
                FileResult::Note(format!("{WANTED} and {GLOW} are in {}", folder.display()))
            }
            Self::Screenshot(image, path) => {
                write_png(path, &rgb(image))?;
                FileResult::Note(format!("the window is in {}", path.display()))
            }
            Self::Open(path) => FileResult::Opened(Opened::read(path)?),
            Self::Layers(choice) => FileResult::Layers(choice.clone(), choice.images()),
            Self::Frame(still, path) => {
                still.write(path)?;
                FileResult::Silent
            }
            Self::Film(made) => FileResult::Note(made.video()?),
        })
    }
}
