//! The steps of a script, and how a line says one.

use crate::arguments::{check_size, reach};
use crate::view::state::{Arrangement, Map};
#[cfg(feature = "train")]
use crate::view::trainer::Wish;
use anyhow::{Context as _, Result, bail};
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::Setting;
use deepshade_shaders::{Attribute, Effect};
use glam::{Vec2, Vec3};
use std::path::PathBuf;

/// A step.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Opens a scene or a file, as if it were dropped there.
    Open(PathBuf),
    Effect(Effect),
    /// Exactly these methods.
    Methods(Vec<String>),
    Quality(Quality),
    /// A method's parameter and its value.
    Set(String, String, Setting),
    /// Metres.
    Radius(f32),
    /// Seconds.
    Time(f32),
    Play(bool),
    Truth(bool),
    Temporal(bool),
    Arrange(Arrangement),
    See(Map),
    /// The method that the others are held against, or truth.
    Against(String),
    /// How many times as large images are, and what of them is in the middle, as shares of their width and height.
    Zoom(f32, Vec2),
    /// As suits what is shown now.
    Expose,
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
    /// Until the picture's images are judged.
    WaitVerdict,
    /// Until the picture is made by a training run's weights of this step, or of a later one.
    #[cfg(feature = "train")]
    WaitCheckpoint(usize),
    /// A dataset into the folder of a run.
    #[cfg(feature = "train")]
    Train(Wish),
    /// The training that the window has begun, until it has ended.
    #[cfg(feature = "train")]
    StopTraining,
    /// Until something could not be done.
    WaitRefusal,
    /// Seconds.
    Wait(f32),
    Screenshot(PathBuf),
    /// Images and a comparison, into a folder.
    Save(PathBuf),
    /// Exactly these layers of the EXR file that was opened.
    Layers(Vec<String>),
    /// Seconds of films where time has no end.
    Length(f32),
    /// The animation into a folder, so many frames a second.
    Record(PathBuf, f32),
    /// Pictures while the camera goes around, for how many come in a second.
    Measure(u32),
    /// Seconds for which effects, methods, sizes and views change while truth begins again and again, for what memory is lost;
    /// which effects, if not the one that is shown alone.
    Soak(f32, Vec<Effect>),
    Quit,
}

impl Step {
    /// Whether it waits for what a training makes, in vain if that has failed.
    pub const fn needs_training(&self) -> bool {
        #[cfg(feature = "train")]
        return matches!(self, Self::WaitCheckpoint(_));
        #[cfg(not(feature = "train"))]
        return false;
    }
}

/// Reads a step.
///
/// # Errors
/// If there is no such step, or it takes something else.
pub fn step(line: &str) -> Result<Step> {
    let (verb, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    let numbers = || -> Result<Vec<f32>> {
        rest.split_whitespace()
            .map(|word| {
                let number = word.parse().ok().filter(|number: &f32| number.is_finite());
                number.with_context(|| format!("`{word}` is no number"))
            })
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
        "set" => {
            let [method, name, value] = rest.split_whitespace().collect::<Vec<_>>()[..] else {
                bail!("it takes a method, a parameter and a value");
            };
            Step::Set(method.to_owned(), name.to_owned(), value.into())
        }
        "radius" => Step::Radius(reach(rest).map_err(anyhow::Error::msg)?),
        "time" => Step::Time(one()?),
        "play" => Step::Play(on()?),
        "truth" => Step::Truth(on()?),
        "temporal" => Step::Temporal(on()?),
        "arrange" => Step::Arrange(Arrangement::ALL[named(&Arrangement::ALL.map(Arrangement::name))?]),
        "see" => Step::See(Map::ALL[named(&Map::ALL.map(Map::name))?]),
        "zoom" => {
            let [factor, x, y] = three()?.to_array();
            Step::Zoom(factor, Vec2::new(x, y))
        }
        "expose" => Step::Expose,
        "against" => Step::Against(rest.to_owned()),
        "inspect" => Step::Inspect(Attribute::ALL[named(&Attribute::ALL.map(Attribute::name))?]),
        "orbit" => Step::Orbit(two()?),
        "look" => Step::Look(two()?),
        "fly" => Step::Fly(three()?),
        "size" => {
            let [width, height] = two()?.to_array().map(|side| side as usize);
            check_size(["height", "width"], [height, width])?;
            Step::Size([width, height])
        }
        "resize" => Step::Resize(two()?),
        "minimise" => Step::Minimise(on()?),
        "wait" => match rest.split_once(' ').unwrap_or((rest, "")) {
            ("picture", "") => Step::WaitPicture,
            ("verdict", "") => Step::WaitVerdict,
            ("refusal", "") => Step::WaitRefusal,
            #[cfg(feature = "train")]
            ("checkpoint", step) => {
                Step::WaitCheckpoint(step.trim().parse().context("wait checkpoint STEP")?)
            }
            ("truth", samples) => Step::WaitTruth(samples.trim().parse().context("wait truth SAMPLES")?),
            _ => Step::Wait(one()?),
        },
        #[cfg(feature = "train")]
        "train" => Step::Train(Wish::parse(rest)?),
        #[cfg(feature = "train")]
        "stop" => Step::StopTraining,
        "screenshot" => Step::Screenshot(crate::arguments::png_file(rest).map_err(anyhow::Error::msg)?),
        "save" => Step::Save(rest.into()),
        "layer" => Step::Layers(rest.split(',').map(|name| name.trim().to_owned()).collect()),
        "length" => Step::Length(one()?),
        "record" => {
            let (folder, rate) = rest.rsplit_once(char::is_whitespace).context("record FOLDER FPS")?;
            let rate = rate.parse().ok().filter(|rate: &f32| *rate > 0.0 && rate.is_finite());
            Step::Record(folder.trim().into(), rate.context("record FOLDER FPS: above 0 frames a second")?)
        }
        "measure" => Step::Measure(one()?.clamp(1.0, 1e6) as u32),
        "soak" => {
            let (seconds, effects) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            let seconds = seconds.parse().context("soak SECONDS EFFECT,EFFECT")?;
            let names = effects.split(',').map(str::trim).filter(|name| !name.is_empty());
            Step::Soak(
                seconds,
                names.map(|name| name.parse().map_err(anyhow::Error::msg)).collect::<Result<_>>()?,
            )
        }
        "quit" => Step::Quit,
        _ => bail!("there is no such step"),
    })
}
