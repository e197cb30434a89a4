//! What is asked of a design: a file (TOML).

use crate::views::Viewpoint;
use anyhow::{Context, Result, anyhow, bail, ensure};
use deepshade_glow::spectrum::Bands;
use deepshade_glow::spectrum::lights::Light;
use deepshade_phosphor::design::{MAX_STATES, Reach};
use deepshade_render::scene::SceneSource;
use deepshade_render::scene::glow::Schedule;
use deepshade_render::scene::glow::file::{LampTimes, schedules};
use deepshade_shaders::names::with_meant;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The most frames of an animation: as long as an hour of 25 a second.
const MOST_FRAMES: usize = 90_000;

/// A design that is asked for.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// The scene; a file is relative to this one.
    pub scene: SceneSource,
    /// States of the materials.
    #[serde(default = "one")]
    pub states: usize,
    /// What materials are described in.
    #[serde(default = "rgb")]
    pub bands: Bands,
    /// Frames of the animation, and how many a second; it begins in the dark, at second 0.
    pub frames: usize,
    pub fps: f32,
    /// Whether colours include what the surface reflects of the lamps' light towards the camera of `view`.
    #[serde(default)]
    pub reflected: bool,
    /// The spectrum of all lamps, whose colours in the scene then say how bright they are and no more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<Light>,
    /// When lamps shine; those of which nothing is said, always.
    #[serde(default)]
    pub lamps: Vec<LampTimes>,
    /// Where something is wanted.
    #[serde(rename = "place")]
    pub places: Vec<WantedPlace>,
    /// How far designs spread to materials alike; only to those of the places where it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<Spread>,
    /// From where pictures are made.
    #[serde(default)]
    pub view: Viewpoint,
}

/// A place of the scene.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct WantedPlace {
    /// Where, metres, in the first frame: what surface is next to it. It goes where that goes.
    pub at: Vec3,
    /// How it should look.
    pub keys: Vec<WantedKey>,
}

/// A wanted colour.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct WantedKey {
    /// When, seconds.
    pub time: f32,
    /// Radiance: linear RGB, or a value for each of the eight bands.
    pub colour: Vec<f64>,
}

/// How far designs spread: over these differences of materials' places and colours affinity falls to 1/e.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// Metres.
    pub distance: f64,
    /// Of linear RGB.
    pub colour: f64,
}

const fn one() -> usize {
    1
}

const fn rgb() -> Bands {
    Bands::Rgb
}

impl Task {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// If it cannot be read, or says what makes no sense.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(&text, folder).with_context(|| path.display().to_string())
    }

    /// The text of a file that says this.
    #[cfg(feature = "view")]
    pub fn text(&self) -> String {
        toml::to_string(self).expect("tables of numbers and text")
    }

    /// A file's text, in a folder.
    fn parse(text: &str, folder: &Path) -> Result<Self> {
        let mut task: Self = toml::from_str(text).map_err(|error| anyhow!(with_meant(&error.to_string())))?;
        if let SceneSource::File(file) = &mut task.scene {
            *file = folder.join(&*file);
        }
        task.check()?;
        Ok(task)
    }

    fn check(&self) -> Result<()> {
        self.check_lamps()?;
        let Self { states, frames, fps, .. } = self;
        ensure!((1..=MAX_STATES).contains(states), "`states` is {states}: 1 or {MAX_STATES} can be designed");
        ensure!((2..=MOST_FRAMES).contains(frames), "`frames` is {frames}, not 2 to {MOST_FRAMES}");
        ensure!(fps.is_finite() && *fps > 0.0, "`fps` is {fps}: frames a second, above 0");
        ensure!(!self.places.is_empty(), "no [[place]]: a design needs one at least");
        if let Some(Spread { distance, colour }) = self.spread {
            let sound = [distance, colour].iter().all(|reach| reach.is_finite() && *reach > 0.0);
            ensure!(sound, "[spread]: `distance` and `colour` are above 0");
        }
        for place in &self.places {
            ensure!(place.at.is_finite(), "a place at {}", place.at);
            ensure!(!place.keys.is_empty(), "the place at {} has no keys", place.at);
            let wanted = place.keys.iter().flat_map(|key| &key.colour);
            ensure!(wanted.into_iter().any(|value| *value != 0.0), "at {}: all keys are black", place.at);
            for (index, key) in place.keys.iter().enumerate() {
                let count = key.colour.len();
                ensure!(
                    count == 3 || count == self.bands.count(),
                    "at {}, second {}: a colour of {count} values; there are red, green and blue{}",
                    place.at,
                    key.time,
                    if self.bands == Bands::Eight { ", or eight bands" } else { "" }
                );
                let sound = key.colour.iter().all(|value| value.is_finite() && *value >= 0.0);
                ensure!(
                    sound,
                    "at {}, second {}: the colour {:?}, not finite numbers that are at least 0",
                    place.at,
                    key.time,
                    key.colour
                );
                ensure!(
                    self.frame(key.time).is_some(),
                    "at {}: a key at second {}; the frames are from second 0 to {}",
                    place.at,
                    key.time,
                    self.seconds(frames - 1)
                );
                let same = |other: &&WantedKey| self.frame(other.time) == self.frame(key.time);
                if let Some(other) = place.keys[..index].iter().find(same) {
                    let (one, two) = (other.time, key.time);
                    bail!("at {}: keys at seconds {one} and {two} are at the same frame", place.at);
                }
            }
        }
        Ok(())
    }

    fn check_lamps(&self) -> Result<()> {
        self.schedules()?;
        let mut switched = self.lamps.iter().filter_map(|lamps| lamps.on.first());
        if let Some([from, _]) = switched.find(|[from, _]| *from < 0.0) {
            bail!("[[lamps]]: on from second {from}; a design begins in the dark at second 0");
        }
        Ok(())
    }

    /// When lamps shine.
    ///
    /// # Errors
    /// If times are not in order, or a lamp is named twice.
    pub fn schedules(&self) -> Result<Vec<Schedule>> {
        schedules(self.lamps.clone()).map_err(anyhow::Error::msg)
    }

    /// When a frame is, seconds.
    pub fn seconds(&self, frame: usize) -> f32 {
        frame as f32 / self.fps
    }

    /// The frame next to a moment, if there is one.
    pub fn frame(&self, seconds: f32) -> Option<usize> {
        let frame = (seconds * self.fps).round();
        (frame >= 0.0 && frame < self.frames as f32).then_some(frame as usize)
    }

    /// A key's radiance in the task's bands.
    pub fn radiance(&self, key: &WantedKey) -> Vec<f64> {
        match key.colour[..] {
            [red, green, blue] => self.bands.of_linear_srgb([red, green, blue]),
            _ => key.colour.clone(),
        }
    }

    /// How far designs spread.
    pub fn reach(&self) -> Option<Reach> {
        self.spread.map(|Spread { distance, colour }| Reach { distance, colour })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "scene = 'box.gltf'\nframes = 200\nfps = 10\n\
        [[lamps]]\non = [[0.0, 5.0]]\n[[place]]\nat = [0, 1, 2]\nkeys = [{ time = 6, colour = [0.1, 0.2, 0.1] }]\n";

    fn parsed(text: &str) -> Result<Task> {
        Task::parse(text, Path::new("folder"))
    }

    #[test]
    fn a_file_is_a_task() {
        let task = parsed(GOOD).expect("a task");
        assert_eq!(task.scene, SceneSource::File("folder/box.gltf".into()));
        assert_eq!((task.states, task.bands, task.frame(6.0)), (1, Bands::Rgb, Some(60)));
        assert_eq!(task.radiance(&task.places[0].keys[0]), [0.1, 0.2, 0.1]);
        let eight = parsed(&GOOD.replace("fps", "bands = 'eight'\nfps")).expect("a task");
        let spectrum = eight.radiance(&eight.places[0].keys[0]);
        let colour = Bands::Eight.linear_srgb(&spectrum);
        assert!(spectrum.len() == 8 && colour.iter().zip([0.1, 0.2, 0.1]).all(|(a, b)| (a - b).abs() < 1e-2));
    }

    #[cfg(feature = "view")]
    #[test]
    fn what_is_written_is_read_again() {
        let view = "[view]\neye = [0, 1.6, 4]\nlook_at = [0, 1, 0]\n";
        for more in ["", "[spread]\ndistance = 4.0\ncolour = 0.2\n", view] {
            let text = format!("spectrum = 'mercury'\n{GOOD}{more}").replace("5.0]]", "5.0], [7, inf]]");
            let task = parsed(&text).expect("a task");
            let again = Task::parse(&task.text(), Path::new("")).expect("a task");
            assert_eq!(format!("{again:?}"), format!("{task:?}"));
        }
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        for (from, to, expected) in [
            ("fps = 10", "fps = 0", "`fps` is 0"),
            ("fps = 10", "fps = nan", "`fps` is NaN"),
            ("frames = 200", "frames = 1", "`frames` is 1"),
            ("fps", "states = 3\nfps", "`states` is 3"),
            ("fps", "fsp", "fsp"),
            ("[0.1, 0.2, 0.1]", "[0, 0, 0]", "all keys are black"),
            ("[0.1, 0.2, 0.1]", "[0.1]", "a colour of 1 values"),
            ("[0.1, 0.2, 0.1]", "[0.1, nan, 0.1]", "second 6: the colour [0.1, NaN, 0.1], not finite"),
            ("[0.1, 0.2, 0.1]", "[0.1, -0.2, 0.1]", "at least 0"),
            ("fps", "spectrum = 'sodium'\nfps", "sodium"),
            ("time = 6", "time = 20", "a key at second 20; the frames are from second 0 to 19.9"),
            ("time = 6", "time = nan", "a key at second NaN"),
            ("[0, 1, 2]", "[0, 1, inf]", "a place at"),
            (
                "keys = [",
                "keys = [{ time = 6.01, colour = [0, 0, 0] }, ",
                "at [0, 1, 2]: keys at seconds 6.01 and 6 are at the same frame",
            ),
            ("[[0.0, 5.0]]", "[[5.0, 0.0]]", "not from one moment to a later one"),
            (
                "[[0.0, 5.0]]",
                "[[-10.0, 5.0]]",
                "[[lamps]]: on from second -10; a design begins in the dark at second 0",
            ),
            ("box.gltf", "box.gtlf", "box.gtlf"),
        ] {
            let error = parsed(&GOOD.replace(from, to)).expect_err("refused");
            assert!(format!("{error:#}").contains(expected), "{to}: {error:#}");
        }
        let bare = &GOOD[..GOOD.find("[[place]]").expect("places")];
        let said = parsed(&format!("place = []\n{}", bare.replace("[[0.0, 5.0]]", "[[5.0, 0.0]]")));
        assert!(said.expect_err("refused").to_string().contains("not from one moment"), "lamps come first");
        let spread = format!("{GOOD}[spread]\ndistance = 0\ncolour = 1\n");
        assert!(parsed(&spread).expect_err("refused").to_string().contains("above 0"));
    }
}
