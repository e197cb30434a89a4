//! The animation as a film: frame after frame at the animation's own times, however long each takes, as PNG
//! files and, where ffmpeg is installed, as a video.

use super::file_worker::FileTask;
use super::method_worker::Show;
use super::saved::free;
use super::state::Arrangement;
use super::window::Window;
use crate::report::images::write_png;
use anyhow::{Context, Result, ensure};
use eframe::egui::{ColorImage, DragValue, ProgressBar, Ui};
use image::{Rgb, RgbImage};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

/// The program that makes videos.
const FFMPEG: &str = "ffmpeg";
/// The video's name.
const VIDEO: &str = "film.mp4";
/// The most frames of a film.
const FRAMES: f32 = 1e5;
/// Frames that may wait for the disk.
const WAITING: usize = 8;

/// A film that is being recorded.
pub struct Recording {
    folder: PathBuf,
    /// Frames a second.
    rate: f32,
    /// The moment of the first frame, seconds.
    begin: f32,
    /// The frame that is wanted now, from 0.
    pub frame: u32,
    /// How many there will be.
    pub frames: u32,
    /// What is recorded; a film shows one thing.
    show: Show,
    /// The moment that is come back to.
    before: f32,
}

impl Recording {
    fn moment(&self) -> f32 {
        self.begin + self.frame as f32 / self.rate
    }
}

/// What the window shows of a frame.
pub struct Still {
    /// Pictures of one size, in their order.
    pub pictures: Vec<Arc<ColorImage>>,
    /// How they lie.
    pub arrangement: Arrangement,
    /// Where those that lie over each other end, as shares of the width.
    pub borders: Vec<f32>,
}

impl Still {
    /// Writes it as a PNG file.
    ///
    /// # Errors
    /// If that cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        write_png(path, &self.composed())
    }

    /// All pictures in one: over each other, or in a row.
    fn composed(&self) -> RgbImage {
        let [width, height] = self.pictures.first().map_or([1, 1], |picture| picture.size);
        let columns = match self.arrangement {
            Arrangement::Wipe => width,
            Arrangement::Tiles => width * self.pictures.len(),
        };
        RgbImage::from_fn(columns as u32, height as u32, |x, y| {
            let (x, y) = (x as usize, y as usize);
            let (picture, x) = match self.arrangement {
                Arrangement::Wipe => (self.under((x as f32 + 0.5) / width as f32), x),
                Arrangement::Tiles => (x / width, x % width),
            };
            let pixel = self.pictures.get(picture).and_then(|picture| picture.pixels.get(y * width + x));
            let [red, green, blue, _] = pixel.map_or([0; 4], |pixel| pixel.to_array());
            Rgb([red, green, blue])
        })
    }

    /// The picture that is seen at a share of the width.
    fn under(&self, share: f32) -> usize {
        self.borders.iter().filter(|border| **border <= share).count()
    }
}

/// A film whose frames are written.
pub struct Made {
    folder: PathBuf,
    rate: f32,
    frames: u32,
}

impl Made {
    /// Makes a video of it where there is a program for that. What is to be said.
    ///
    /// # Errors
    /// If that program fails; the frames are there all the same.
    pub fn video(&self) -> Result<String> {
        let (folder, frames) = (self.folder.display(), self.frames);
        let unfinished = format!("unfinished-{VIDEO}");
        let made = Command::new(FFMPEG)
            .args(["-y", "-loglevel", "error", "-framerate", &self.rate.to_string(), "-i", "%05d.png"])
            .args(["-frames:v", &frames.to_string()])
            // Most videos halve the resolution of colours, which takes even numbers of rows and columns.
            .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", &unfinished])
            .current_dir(&self.folder)
            .stdin(Stdio::null())
            .output();
        let output = match made {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Ok(format!(
                    "{frames} frames in {folder}; with {FFMPEG} installed there would be a video"
                ));
            }
            other => other.with_context(|| format!("{frames} frames in {folder}, but {FFMPEG}"))?,
        };
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.lines().last().unwrap_or("it does not say why");
        ensure!(output.status.success(), "{frames} frames in {folder}, but no video: {FFMPEG}: {last}");
        std::fs::rename(self.folder.join(unfinished), self.folder.join(VIDEO))
            .with_context(|| format!("{}", self.folder.join(VIDEO).display()))?;
        Ok(format!("{frames} frames and {VIDEO} in {folder}"))
    }
}

impl Window {
    /// Begins to record the animation into a folder that is free; where time has no end, as many seconds of
    /// it as the user has chosen.
    fn begin_recording(&mut self, [begin, end]: [f32; 2]) {
        let rate = self.state.film_rate;
        let seconds = if end.is_finite() { end - begin } else { self.state.film_seconds };
        let frames = (seconds * rate).round();
        if !(1.0..=FRAMES).contains(&frames) {
            return self.set_error(format!("{rate} frames a second: {frames} frames of {seconds} s"));
        }
        self.state.playing = false;
        self.recording = Some(Recording {
            folder: free(&self.files.folder, "film", ""),
            rate,
            begin,
            frame: 0,
            frames: frames as u32,
            show: self.state.show.clone(),
            before: self.state.time,
        });
    }

    /// Ends a film before its time; its frames stay.
    pub fn stop_recording(&mut self) {
        if let Some(recording) = self.recording.take() {
            self.state.time = recording.before;
        }
    }

    /// Keeps the picture if it is the film's next frame, and goes on to the one after it.
    pub fn record_frame(&mut self) {
        let Some(recording) = &self.recording else { return };
        if recording.show != self.state.show {
            self.stop_recording();
            return self.set_error("the film has ended: something else is shown now".to_owned());
        }
        self.state.playing = false;
        self.state.time = recording.moment();
        let path = recording.folder.join(format!("{:05}.png", recording.frame));
        let Some(picture) = self.results.picture.clone() else { return };
        if !self.is_as_wanted() || self.files.pending >= WAITING {
            return;
        }
        let shown = picture.images.iter().chain(&picture.inspected);
        let (names, pictures): (Vec<&str>, Vec<_>) =
            shown.map(|image| (image.name.as_str(), Arc::clone(&image.picture))).unzip();
        let borders = self.state.look.borders(&names);
        self.send(FileTask::Frame(
            Still { pictures, arrangement: self.state.look.arrangement, borders },
            path,
        ));
        let Some(recording) = &mut self.recording else { return };
        recording.frame += 1;
        if recording.frame < recording.frames {
            self.state.time = recording.moment();
            return;
        }
        let Recording { folder, rate, frames, .. } = recording;
        let made = Made { folder: folder.clone(), rate: *rate, frames: *frames };
        self.send(FileTask::Film(made));
        self.stop_recording();
    }
}

/// The button that records, and how far a film is.
pub fn show(ui: &mut Ui, window: &mut Window, timeline: [f32; 2]) {
    if let Some(recording) = &window.recording {
        let share = recording.frame as f32 / recording.frames as f32;
        let text = format!("frame {} of {}", recording.frame, recording.frames);
        ui.add(ProgressBar::new(share).text(text)).on_hover_text("frames that are written");
        if ui.button("stop recording").on_hover_text("frames that are written stay").clicked() {
            window.stop_recording();
        }
        return;
    }
    ui.horizontal_wrapped(|ui| {
        let state = &mut window.state;
        let rate = DragValue::new(&mut state.film_rate).range(1.0..=240.0).suffix(" frames/s");
        ui.add(rate).on_hover_text("of the film");
        if timeline[1].is_infinite() {
            let seconds = DragValue::new(&mut state.film_seconds).range(0.1..=3600.0).speed(0.1).suffix(" s");
            ui.add(seconds).on_hover_text("how long the film is");
        }
        let hint = "every frame of the animation as PNG, and a video where ffmpeg is installed";
        if ui.button("record").on_hover_text(hint).clicked() {
            window.begin_recording(timeline);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Color32;

    fn still(arrangement: Arrangement) -> RgbImage {
        let plain = |colour| Arc::new(ColorImage::filled([4, 2], colour));
        let pictures = vec![plain(Color32::RED), plain(Color32::GREEN), plain(Color32::BLUE)];
        Still { pictures, arrangement, borders: vec![0.25, 0.75] }.composed()
    }

    #[test]
    fn frames_are_composed_as_they_lie_in_the_window() {
        let (red, green, blue) = ([255, 0, 0], [0, 255, 0], [0, 0, 255]);
        let row = |picture: &RgbImage| {
            picture.rows().next().map(|row| row.map(|pixel| pixel.0).collect::<Vec<_>>())
        };
        let wipe = still(Arrangement::Wipe);
        assert_eq!((wipe.dimensions(), row(&wipe)), ((4, 2), Some(vec![red, green, green, blue])));
        let tiles = still(Arrangement::Tiles);
        let expected: Vec<[u8; 3]> = [red, green, blue].into_iter().flat_map(|colour| [colour; 4]).collect();
        assert_eq!((tiles.dimensions(), row(&tiles)), ((12, 2), Some(expected)));
    }
}
