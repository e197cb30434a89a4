//! What hands would do, from a file: a line a step, `#` begins a comment.

mod soak;
mod steps;

use super::state::State;
use super::window::Window;
use super::zoom::Zoom;
use crate::live::pilot::Pilot;
use crate::methods::{self, TRUTH};
use crate::output::message;
use anyhow::{Context as _, Result, ensure};
use deepshade_render::methods::dials::Setting;
use eframe::egui::{Context, ViewportCommand, vec2};
use glam::Vec2;
use soak::{Soak, Walk};
use std::collections::VecDeque;
use std::path::Path;
use std::time::{Duration, Instant};
use steps::{Step, step};

/// How long nothing may come of a step.
const PATIENCE: Duration = Duration::from_mins(10);
/// How long a window manager may take to put the window away. Where there is none, nobody does.
const PUT_AWAY: Duration = Duration::from_secs(5);

/// Steps, and how far they are done.
pub struct Script {
    steps: VecDeque<(usize, Step)>,
    /// When the step at the front began.
    began: Option<Instant>,
    /// When it came on last.
    progressed: Option<Instant>,
    /// Pictures that the step at the front has seen.
    seen: u32,
    /// How far a long walk is.
    soak: Option<Soak>,
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
        Ok(Self { steps, began: None, progressed: None, seen: 0, soak: None })
    }

    /// Does the steps that can be done now.
    pub fn go_on(&mut self, window: &mut Window, context: &Context) -> Progress {
        while let Some((number, step)) = self.steps.front().cloned() {
            let first = self.began.is_none();
            let began = *self.began.get_or_insert_with(Instant::now);
            match self.take(&step, window, context, first, began.elapsed()) {
                Ok(done) if self.goes_unheard(&step, done, window) => {
                    let said = window.unheard.join("; ");
                    return Progress::Failed(format!("line {number} of the script: {said}"));
                }
                Ok(true) => {
                    self.steps.pop_front();
                    (self.began, self.progressed) = (None, None);
                    (self.seen, self.soak) = (0, None);
                }
                Ok(false) if self.waits_in_vain(&step, began) => {
                    let said = window.said().unwrap_or_default();
                    return Progress::Failed(format!("line {number} of the script waits in vain; {said}"));
                }
                Ok(false) => return Progress::GoesOn,
                Err(error) => {
                    return Progress::Failed(format!("line {number} of the script: {}", message(&error)));
                }
            }
        }
        Progress::Done
    }

    /// Whether something could not be done, and neither the step at the front nor the one after it waits for that.
    fn goes_unheard(&self, step: &Step, done: bool, window: &Window) -> bool {
        let next = self.steps.get(1).is_some_and(|(_, next)| *next == Step::WaitRefusal);
        let is_heard = (*step == Step::WaitRefusal && !done) || (next && (done || !step.needs_training()));
        !window.unheard.is_empty() && !is_heard
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
            Step::Methods(wanted) => state.choose_methods(wanted)?,
            Step::Quality(quality) => state.show.quality = *quality,
            Step::Set(method, name, value) => return set(state, method, name, value),
            Step::Radius(radius) => state.set_radius(Some(*radius)),
            Step::Time(time) => state.time = *time,
            Step::Play(on) => state.playing = *on,
            Step::Truth(on) => state.truth = *on,
            Step::Temporal(on) => state.show.temporal = *on,
            Step::Arrange(arrangement) => state.arrangement = *arrangement,
            Step::See(map) => state.map = *map,
            Step::Against(name) => {
                let shown = state.show.methods.iter().copied().find(|shown| shown == name);
                ensure!(shown.is_some() || name == TRUTH, "method `{name}` is not shown");
                state.against = shown;
            }
            Step::Zoom(factor, centre) => state.zoom = Zoom::new(*factor, *centre),
            Step::Expose => window.expose_anew(),
            Step::Inspect(attribute) => state.show.inspected = Some(*attribute),
            Step::Orbit(degrees) => return steer(window, |pilot| pilot.orbit(degrees.map(f32::to_radians))),
            Step::Look(degrees) => return steer(window, |pilot| pilot.look(degrees.map(f32::to_radians))),
            Step::Fly(way) => return steer(window, |pilot| pilot.fly(*way)),
            Step::Size([width, height]) => state.show.size = [*height, *width],
            Step::Resize(size) => {
                context.send_viewport_cmd(ViewportCommand::InnerSize(vec2(size.x, size.y)));
            }
            Step::Minimise(on) => {
                if first {
                    context.send_viewport_cmd(ViewportCommand::Minimized(*on));
                    return Ok(false);
                }
                let is_away = context.input(|input| input.viewport().minimized) == Some(true);
                if is_away != *on && since < PUT_AWAY {
                    return Ok(false);
                }
                if *on {
                    window.measured("minimised", f64::from(u8::from(is_away)));
                }
            }
            Step::WaitPicture => return Ok(is_made(window)? && window.is_idle()),
            Step::WaitTruth(samples) => {
                let enough = window.truth_of_picture().is_some_and(|truth| truth.samples >= *samples);
                // Against a method, which has no samples, nothing is judged by truth.
                let samples = if window.state.reference() == TRUTH { *samples } else { 0 };
                let judged = window.verdict_of_picture().is_some_and(|verdict| verdict.samples >= samples);
                return Ok(is_made(window)? && enough && (judged || window.state.show.methods.is_empty()));
            }
            Step::WaitVerdict => return Ok(is_made(window)? && window.verdict_of_picture().is_some()),
            #[cfg(feature = "train")]
            Step::WaitCheckpoint(step) => {
                let trained = window.trained_step().map_or(0, |step| step as u32);
                if trained != self.seen {
                    (self.seen, self.progressed) = (trained, Some(Instant::now()));
                }
                let reached = window.trained_step().is_some_and(|trained| trained >= *step);
                return Ok(reached && is_made(window)?);
            }
            #[cfg(feature = "train")]
            Step::Train(wish) => {
                if first {
                    window.wish = wish.clone();
                    window.train();
                }
                return Ok(window.trainer.as_ref().is_none_or(|trainer| trainer.has_begun));
            }
            #[cfg(feature = "train")]
            Step::StopTraining => {
                if let Some(trainer) = window.trainer.as_ref().filter(|_| first) {
                    trainer.stop();
                }
                return Ok(window.trainer.is_none());
            }
            Step::WaitRefusal => {
                let is_heard = !window.unheard.is_empty() || window.is_refused();
                window.unheard.clear();
                return Ok(is_heard);
            }
            Step::Wait(seconds) => return Ok(since.as_secs_f32() >= *seconds),
            Step::Screenshot(path) => {
                if first {
                    window.shoot(context, Some(path.clone()));
                }
                let is_idle = window.is_idle();
                let said = window.message.as_deref().unwrap_or("it was not written");
                ensure!(!is_idle || path.is_file(), "{}: {said}", path.display());
                return Ok(is_idle);
            }
            Step::Save(folder) => {
                if first {
                    window.save(Some(folder.clone()));
                }
                return Ok(window.is_idle());
            }
            Step::Layers(layers) => {
                if !window.is_idle() {
                    return Ok(false);
                }
                window.choose_layers(layers)?;
            }
            Step::Length(seconds) => state.film_seconds = *seconds,
            Step::Record(folder, rate) => {
                if first {
                    window.record(Some(folder.clone()), *rate);
                }
                return self.recorded(window);
            }
            Step::Measure(pictures) => return self.measure(*pictures, window, since),
            Step::Soak(seconds, effects) => {
                let soak = self.soak.get_or_insert_with(|| Soak::begin(effects, window));
                let walk = soak.go_on(*seconds, window)?;
                if !matches!(walk, Walk::Waits) {
                    self.progressed = Some(Instant::now());
                }
                return Ok(matches!(walk, Walk::Done));
            }
            // What was opened or is being written may not come to anything yet.
            Step::Quit if !(window.is_met() || window.is_refused()) || !window.is_idle() => return Ok(false),
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
        self.seen += 1;
        self.progressed = Some(Instant::now());
        steer(window, |pilot| pilot.orbit(Vec2::new(1f32.to_radians(), 0.0)))?;
        Ok(false)
    }

    /// Whether a film is written; each frame is a sign that something comes of it.
    fn recorded(&mut self, window: &Window) -> Result<bool> {
        let frame = window.recording.as_ref().map_or(0, |recording| recording.frame);
        if frame != self.seen {
            (self.seen, self.progressed) = (frame, Some(Instant::now()));
        }
        Ok(is_made(window)? && window.recording.is_none() && window.is_idle())
    }
}

/// Whether the picture is what is wanted.
///
/// # Errors
/// If that cannot be made, which would be waited for in vain.
fn is_made(window: &Window) -> Result<bool> {
    ensure!(!window.is_refused(), "no picture: {}", window.said().unwrap_or("it was refused"));
    Ok(window.is_up_to_date())
}

/// Moves the camera, once there is one. Whether there is.
fn steer(window: &mut Window, how: impl FnOnce(&mut Pilot)) -> Result<bool> {
    let Some(pilot) = &mut window.state.pilot else { return is_made(window).map(|_| false) };
    how(pilot);
    Ok(true)
}

/// Sets a parameter of a method by hand.
fn set(state: &mut State, method: &str, name: &str, value: &Setting) -> Result<bool> {
    let shown = state.show.methods.iter().copied().find(|shown| *shown == method);
    let shown = shown.with_context(|| format!("method `{method}` is not shown"))?;
    let dials = methods::dials(state.show.effect, shown, state.show.quality)?;
    let dial = dials.iter().find(|dial| dial.name == name);
    let dial = dial.with_context(|| format!("method `{method}` has no parameter `{name}`"))?;
    state.set(shown, dial, dial.number(value)?);
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::state::Map;
    use deepshade_shaders::Effect;

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
            ("record film", "record FOLDER FPS"),
            ("record film 0", "above 0"),
            ("fly 1 2 x", "`x` is no number"),
            ("zoom 2", "three numbers"),
            ("size 7 131", "width: 7 is not within 16 to 8192"),
            ("size 131 -7", "height: 0 is not within"),
            ("radius -1", "-1 is not above 0"),
            ("time nan", "`nan` is no number"),
            ("soak long", "soak SECONDS"),
            ("soak 9 ao,shadows", "shadows"),
        ] {
            let error = format!("{:#}", Script::parse(text).err().expect("an error"));
            assert!(error.contains(named), "{text}: {error}");
        }
    }
}
