//! What hands would do, from a file: a line a step, `#` begins a comment.

use super::pilot::Pilot;
use super::saved;
use super::state::{Arrangement, Map};
use super::window::Window;
use crate::figures::memory;
use crate::methods;
use crate::report::images::write_png;
use anyhow::{Context as _, Result, bail, ensure};
use deepshade_render::methods::Quality;
use deepshade_shaders::{Attribute, Effect};
use eframe::egui::{ColorImage, Context, ScreenshotCallback, ViewportCommand, vec2};
use glam::{Vec2, Vec3};
use image::RgbImage;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How long nothing may come of a step.
const PATIENCE: Duration = Duration::from_secs(300);

/// A step.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    /// Opens a scene or a file, as if it were dropped there.
    Open(PathBuf),
    Effect(Effect),
    /// Exactly these methods.
    Methods(Vec<String>),
    Quality(Quality),
    /// Metres.
    Radius(f32),
    /// Seconds.
    Time(f32),
    Play(bool),
    Truth(bool),
    Temporal(bool),
    Arrange(Arrangement),
    See(Map),
    Inspect(Attribute),
    /// Degrees to the right and up.
    Orbit(Vec2),
    Look(Vec2),
    /// Metres to the right, up and back.
    Fly(Vec3),
    /// Columns and rows of the images.
    Size([usize; 2]),
    /// Points of the window.
    Resize(Vec2),
    Minimise(bool),
    /// Until the picture is what is wanted.
    WaitPicture,
    /// Until truth has so many samples and the verdict is there.
    WaitTruth(u32),
    /// Until something could not be done.
    WaitRefusal,
    /// Seconds.
    Wait(f32),
    Screenshot(PathBuf),
    /// Images and a comparison, into a folder.
    Save(PathBuf),
    /// Pictures while the camera goes around, for how many come in a second.
    Measure(u32),
    /// Seconds for which the camera goes around while truth begins again and again, for what memory is lost.
    Soak(f32),
    Quit,
}

/// Steps, and how far they are done.
pub struct Script {
    steps: VecDeque<(usize, Step)>,
    /// When the step at the front began.
    began: Option<Instant>,
    /// When it came on last.
    progressed: Option<Instant>,
    /// The picture that was taken of the window, once it is there.
    taken: Arc<Mutex<Option<Arc<ColorImage>>>>,
    /// Pictures that the step at the front has seen.
    seen: u32,
    /// Megabytes after the first part of a soak.
    memory: Option<f64>,
}

/// How a script comes on.
pub enum Progress {
    /// It goes on.
    GoesOn,
    /// All is done.
    Done,
    /// A step failed.
    Failed(String),
}

impl Script {
    /// Reads a script.
    ///
    /// # Errors
    /// If it cannot be read, or a line is no step, which is named.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("script {}", path.display()))?;
        Self::parse(&text).with_context(|| format!("script {}", path.display()))
    }

    fn parse(text: &str) -> Result<Self> {
        let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line));
        let lines = lines.map(|(number, line)| (number, line.split('#').next().unwrap_or_default().trim()));
        let read = |(number, line): (usize, &str)| {
            step(line).map(|step| (number, step)).with_context(|| format!("line {number}, `{line}`"))
        };
        let steps = lines.filter(|(_, line)| !line.is_empty()).map(read).collect::<Result<_>>()?;
        Ok(Self { steps, began: None, progressed: None, taken: Arc::default(), seen: 0, memory: None })
    }

    /// Does the steps that can be done now.
    pub fn go_on(&mut self, window: &mut Window, context: &Context) -> Progress {
        while let Some((number, step)) = self.steps.front().cloned() {
            let first = self.began.is_none();
            let began = *self.began.get_or_insert_with(Instant::now);
            match self.take(&step, window, context, first, began.elapsed()) {
                Ok(true) => {
                    self.steps.pop_front();
                    (self.began, self.progressed) = (None, None);
                    (self.seen, self.memory) = (0, None);
                }
                Ok(false) if self.waits_in_vain(&step, began) => {
                    let said = window.message.clone().unwrap_or_default();
                    return Progress::Failed(format!("line {number} of the script waits in vain; {said}"));
                }
                Ok(false) => return Progress::GoesOn,
                Err(error) => return Progress::Failed(format!("line {number} of the script: {error:#}")),
            }
        }
        Progress::Done
    }

    /// Whether nothing has come of a step for too long.
    fn waits_in_vain(&self, step: &Step, began: Instant) -> bool {
        let since = self.progressed.unwrap_or(began);
        since.elapsed() > PATIENCE && !matches!(step, Step::Wait(_))
    }

    /// Begins a step or goes on with it. Whether it is done.
    fn take(
        &mut self,
        step: &Step,
        window: &mut Window,
        context: &Context,
        first: bool,
        since: Duration,
    ) -> Result<bool> {
        let state = &mut window.state;
        match step {
            Step::Open(path) => window.open(path),
            Step::Effect(effect) => {
                state.choose_effect(*effect);
                window.changed();
            }
            Step::Methods(wanted) => {
                let wanted: Vec<&str> = wanted.iter().map(String::as_str).collect();
                methods::check(state.show.effect, &wanted)?;
                let known = methods::names_of(state.show.effect);
                state.show.methods = known.into_iter().filter(|name| wanted.contains(name)).collect();
            }
            Step::Quality(quality) => state.show.quality = *quality,
            Step::Radius(radius) => state.show.radius = Some(*radius),
            Step::Time(time) => state.time = *time,
            Step::Play(on) => state.playing = *on,
            Step::Truth(on) => state.truth = *on,
            Step::Temporal(on) => state.show.temporal = *on,
            Step::Arrange(arrangement) => state.arrangement = *arrangement,
            Step::See(map) => state.map = *map,
            Step::Inspect(attribute) => state.show.inspected = Some(*attribute),
            Step::Orbit(degrees) => return steer(window, |pilot| pilot.orbit(degrees.map(f32::to_radians))),
            Step::Look(degrees) => return steer(window, |pilot| pilot.look(degrees.map(f32::to_radians))),
            Step::Fly(way) => return steer(window, |pilot| pilot.fly(*way)),
            Step::Size([width, height]) => state.show.size = [*height, *width],
            Step::Resize(size) => {
                context.send_viewport_cmd(ViewportCommand::InnerSize(vec2(size.x, size.y)));
            }
            Step::Minimise(on) => context.send_viewport_cmd(ViewportCommand::Minimized(*on)),
            Step::WaitPicture => return is_made(window),
            Step::WaitTruth(samples) => {
                let enough = window.truth_of_picture().is_some_and(|truth| truth.samples >= *samples);
                let judged = window.verdict_of_picture().is_some_and(|verdict| verdict.samples >= *samples);
                return Ok(is_made(window)? && enough && (judged || window.state.show.methods.is_empty()));
            }
            Step::WaitRefusal => return Ok(window.message.is_some()),
            Step::Wait(seconds) => return Ok(since.as_secs_f32() >= *seconds),
            Step::Screenshot(path) => return self.screenshot(path, context, first),
            Step::Save(folder) => saved::save(window, folder)?,
            Step::Measure(pictures) => return self.measure(*pictures, window, since),
            Step::Soak(seconds) => return self.soak(*seconds, window, since),
            Step::Quit => context.send_viewport_cmd(ViewportCommand::Close),
        }
        Ok(true)
    }

    /// Goes around by a degree a picture. Whether all of them are there; the first one, which may be long in coming, does not count.
    fn measure(&mut self, pictures: u32, window: &mut Window, since: Duration) -> Result<bool> {
        if !is_made(window)? {
            return Ok(false);
        }
        if self.seen == 0 {
            self.began = Some(Instant::now());
        } else if self.seen == pictures {
            let show = &window.state.show;
            let name = format!("fps_{}_{}", show.effect, show.methods.join("_")).replace('-', "_");
            window.measured(&name, f64::from(pictures) / since.as_secs_f64());
            return Ok(true);
        }
        self.go_around(window)
    }

    /// By a degree, which is not the end of the step.
    fn go_around(&mut self, window: &mut Window) -> Result<bool> {
        self.seen += 1;
        self.progressed = Some(Instant::now());
        steer(window, |pilot| pilot.orbit(Vec2::new(1f32.to_radians(), 0.0)))?;
        Ok(false)
    }

    /// Goes around, and stands still at every tenth picture until truth has begun. Whether the time is over; what memory grows
    /// by is counted from a quarter of it on, when drivers have what they need.
    fn soak(&mut self, seconds: f32, window: &mut Window, since: Duration) -> Result<bool> {
        if self.memory.is_none() && since.as_secs_f32() > 0.25 * seconds {
            self.memory = memory();
        }
        let truth_began = || !window.state.truth || window.truth_of_picture().is_some();
        if !is_made(window)? || (self.seen.is_multiple_of(10) && !truth_began()) {
            return Ok(false);
        }
        if since.as_secs_f32() >= seconds {
            if let (Some(before), Some(after)) = (self.memory, memory()) {
                window.measured("memory_growth_mb", after - before);
            }
            return Ok(true);
        }
        self.go_around(window)
    }

    /// Asks for a picture of the window, and writes it once it is there.
    fn screenshot(&self, path: &Path, context: &Context, first: bool) -> Result<bool> {
        if first {
            let (taken, context) = (Arc::clone(&self.taken), context.clone());
            let callback = ScreenshotCallback::new({
                let context = context.clone();
                move |image| {
                    *taken.lock().unwrap_or_else(PoisonError::into_inner) = Some(image);
                    context.request_repaint();
                }
            });
            context.send_viewport_cmd(ViewportCommand::Screenshot(callback));
            context.request_repaint();
        }
        let taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(image) = taken else { return Ok(false) };
        let [width, height] = image.size.map(|side| side as u32);
        let picture = RgbImage::from_fn(width, height, |x, y| {
            let [red, green, blue, _] = image.pixels[(y * width + x) as usize].to_array();
            image::Rgb([red, green, blue])
        });
        write_png(path, &picture)?;
        Ok(true)
    }
}

/// Whether the picture is what is wanted.
///
/// # Errors
/// If that cannot be made, which would be waited for in vain.
fn is_made(window: &Window) -> Result<bool> {
    ensure!(!window.is_refused(), "no picture: {}", window.message.as_deref().unwrap_or("it was refused"));
    Ok(window.is_up_to_date())
}

/// Moves the camera, once there is one. Whether there is.
fn steer(window: &mut Window, how: impl FnOnce(&mut Pilot)) -> Result<bool> {
    let Some(pilot) = &mut window.state.pilot else { return is_made(window).map(|_| false) };
    how(pilot);
    Ok(true)
}

/// Reads a step.
fn step(line: &str) -> Result<Step> {
    let (verb, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    let numbers = || -> Result<Vec<f32>> {
        rest.split_whitespace()
            .map(|word| word.parse().with_context(|| format!("`{word}` is no number")))
            .collect()
    };
    let one = || match numbers()?[..] {
        [one] => Ok(one),
        _ => bail!("it takes one number"),
    };
    let two = || match numbers()?[..] {
        [x, y] => Ok(Vec2::new(x, y)),
        _ => bail!("it takes two numbers"),
    };
    let three = || match numbers()?[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => bail!("it takes three numbers"),
    };
    let on = || match rest {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => bail!("it takes on or off"),
    };
    let named = |names: &[&str]| {
        let place = names.iter().position(|name| *name == rest);
        place.with_context(|| format!("it takes one of {}", names.join(", ")))
    };
    Ok(match verb {
        "open" => Step::Open(rest.into()),
        "effect" => Step::Effect(rest.parse().map_err(anyhow::Error::msg)?),
        "methods" => Step::Methods(rest.split(',').map(|name| name.trim().to_owned()).collect()),
        "quality" => Step::Quality(rest.parse().map_err(anyhow::Error::msg)?),
        "radius" => Step::Radius(one()?),
        "time" => Step::Time(one()?),
        "play" => Step::Play(on()?),
        "truth" => Step::Truth(on()?),
        "temporal" => Step::Temporal(on()?),
        "arrange" => Step::Arrange(Arrangement::ALL[named(&Arrangement::ALL.map(Arrangement::name))?]),
        "see" => Step::See(Map::ALL[named(&Map::ALL.map(Map::name))?]),
        "inspect" => Step::Inspect(Attribute::ALL[named(&Attribute::ALL.map(Attribute::name))?]),
        "orbit" => Step::Orbit(two()?),
        "look" => Step::Look(two()?),
        "fly" => Step::Fly(three()?),
        "size" => Step::Size(two()?.to_array().map(|side| side.max(1.0) as usize)),
        "resize" => Step::Resize(two()?),
        "minimise" => Step::Minimise(on()?),
        "wait" => match rest.split_once(' ').unwrap_or((rest, "")) {
            ("picture", "") => Step::WaitPicture,
            ("refusal", "") => Step::WaitRefusal,
            ("truth", samples) => Step::WaitTruth(samples.trim().parse().context("wait truth SAMPLES")?),
            _ => Step::Wait(one()?),
        },
        "screenshot" => Step::Screenshot(crate::arguments::png_file(rest).map_err(anyhow::Error::msg)?),
        "save" => Step::Save(rest.into()),
        "measure" => Step::Measure(one()?.clamp(1.0, 1e6) as u32),
        "soak" => Step::Soak(one()?),
        "quit" => Step::Quit,
        _ => bail!("there is no such step"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_read_and_comments_are_not() {
        let text =
            "# a walk\neffect gi\nmethods ssgi, surfel # both\n\norbit 30 -10\nwait truth 64\nsee flip\n";
        let steps: Vec<(usize, Step)> = Script::parse(text).expect("a script").steps.into();
        let methods = ["ssgi", "surfel"].map(str::to_owned).to_vec();
        assert_eq!(
            steps,
            [
                (2, Step::Effect(Effect::Gi)),
                (3, Step::Methods(methods)),
                (5, Step::Orbit(Vec2::new(30.0, -10.0))),
                (6, Step::WaitTruth(64)),
                (7, Step::See(Map::Flip)),
            ]
        );
    }

    #[test]
    fn lines_that_are_no_steps_are_named() {
        for (text, named) in [
            ("orbit 30", "two numbers"),
            ("\ndance", "line 2, `dance`"),
            ("see nothing", "image, difference, flip"),
            ("effect shadows", "shadows"),
            ("wait truth many", "SAMPLES"),
            ("screenshot a.jpg", "png"),
            ("fly 1 2 x", "`x` is no number"),
        ] {
            let error = format!("{:#}", Script::parse(text).err().expect("an error"));
            assert!(error.contains(named), "{text}: {error}");
        }
    }
}
