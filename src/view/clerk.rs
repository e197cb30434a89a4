//! The thread that writes and reads files for the window, one errand after the other, so that the window never waits for
//! a disk.

use super::caught::caught;
use super::desk::News;
use super::film::{self, Still};
use super::layers::Opened;
use super::pictures::rgb;
use super::saved::{self, Moment};
use crate::output::message;
use crate::report::images::write_png;
use anyhow::Result;
use eframe::egui::ColorImage;
use std::path::PathBuf;
use std::sync::{Arc, mpsc};

/// Something to be done with files. Every one is answered by one [`News::Errand`].
pub enum Errand {
    /// What was shown at a moment into a folder, or into one that is free.
    Save(Box<Moment>, Option<PathBuf>),
    /// A picture of the window into a file, or into one that is free.
    Shot(Arc<ColorImage>, Option<PathBuf>),
    /// Reads an EXR file.
    Open(PathBuf),
    /// A frame of a film.
    Frame(Still, PathBuf),
    /// A video of the film's frames.
    Film(film::Made),
}

/// What came of an errand.
pub enum Done {
    /// Nothing needs to be said.
    Quietly,
    /// This is to be said.
    Said(String),
    /// A file was read.
    Opened(Opened),
}

/// Runs errands until nobody can send any more.
pub fn run(errands: mpsc::Receiver<Errand>, tell: &dyn Fn(News)) {
    for errand in errands {
        let done = caught(errand.doing(), || errand.run());
        tell(News::Errand(done.map_err(|error| message(&error))));
    }
}

impl Errand {
    const fn doing(&self) -> &'static str {
        match self {
            Self::Save(..) | Self::Shot(..) => "saving",
            Self::Open(_) => "opening an EXR file",
            Self::Frame(..) | Self::Film(_) => "recording",
        }
    }

    fn run(&self) -> Result<Done> {
        Ok(match self {
            Self::Save(moment, folder) => {
                let folder = folder.clone().unwrap_or_else(|| saved::free("view", ""));
                saved::save(moment, &folder)?;
                Done::Said(format!("saved in {}", folder.display()))
            }
            Self::Shot(image, path) => {
                let path = path.clone().unwrap_or_else(|| saved::free("window", ".png"));
                write_png(&path, &rgb(image))?;
                Done::Said(format!("the window is in {}", path.display()))
            }
            Self::Open(path) => Done::Opened(Opened::read(path)?),
            Self::Frame(still, path) => {
                still.write(path)?;
                Done::Quietly
            }
            Self::Film(made) => Done::Said(made.video()?),
        })
    }
}
