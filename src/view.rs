//! `deepshade view`: a window on a scene in motion, methods side by side, and truth that refines behind them.
//!
//! Threads work for the window, most for their newest order alone: [`studio`] makes frames on a device of its own, [`truth`]
//! refines truth while nobody moves, [`judge`] holds one against the other, `training` follows a training run, `trainer` waits for the
//! end of one, [`layers`] develops those of an EXR file, [`clerk`] reads and writes files. The window waits for none of them.

mod canvas;
mod caught;
mod clerk;
#[cfg(feature = "train")]
mod curves;
mod desk;
mod film;
mod judge;
mod layers;
mod legend;
mod lights;
mod mailbox;
mod outcome;
mod panel;
mod parameters;
mod pictures;
mod probe;
mod saved;
mod script;
mod stamp;
mod state;
mod studio;
mod subject;
#[cfg(feature = "train")]
mod trainer;
#[cfg(feature = "train")]
mod training;
mod truth;
mod window;
mod zoom;

use crate::arguments::{check_size, reach};
use crate::complete::{Additions, listeners};
use crate::exposure_time;
use crate::figures::Figures;
use crate::place::Place;
use crate::props;
use crate::views::Viewpoint;
use anyhow::{Result, anyhow, bail};
use clerk::Errand;
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::Setting;
use desk::Desk;
use eframe::egui::{self, ViewportBuilder};
use eframe::egui_wgpu::WgpuConfiguration;
use eframe::wgpu::CurrentSurfaceTexture;
use outcome::Outcome;
use script::Script;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use window::Window;

/// Shows a scene in a window, by several methods at once, beside truth.
#[derive(clap::Args, Clone)]
#[command(after_help = "Examples:\n  deepshade view\n  \
    deepshade view --scene sponza.gltf --effect gi --methods ssgi,surfel\n  \
    deepshade view --scene hall.gltf --put fox.gltf@-5,0,0,0.01,60 --effect fog-direct --extinction 0.2\n  \
    deepshade view --model runs/ao --methods learned,hbao    # while `deepshade train` works on it\n\n\
    Drag to go around, with the right button to look around, with the middle one to move; the wheel comes nearer, \
    with Ctrl it enlarges images, as + and - do; the middle button then moves them, and 0 shows all of them. W, A, S, D, Q and \
    E fly, with Shift faster. Space plays the animation, T turns truth on and off, M goes through image, difference and FLIP, P keeps a picture of \
    the window. A scene \
    file or the folder of a model or a training run dropped onto the window is opened, layers of an EXR file are shown beside the methods.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed, such as stairs:7.
    #[arg(long, default_value = "room:7")]
    scene: SceneSource,
    /// What is computed first.
    #[arg(long, default_value = "ao")]
    effect: Effect,
    /// By which methods, first; by default by the first two of the effect.
    #[arg(long, value_delimiter = ',')]
    methods: Vec<String>,
    /// How much time methods may take for a better image: low, medium, high or ultra.
    #[arg(long, default_value = "medium")]
    quality: Quality,
    /// Rows of the images.
    #[arg(long, default_value_t = 288)]
    height: usize,
    /// Columns of the images.
    #[arg(long, default_value_t = 448)]
    width: usize,
    /// How far effects with a radius reach, metres, or inf; by default 3 % of the scene's diagonal, or what
    /// the network states, and at most a quarter of the median depth of what is seen first.
    #[arg(long, value_parser = reach)]
    radius: Option<f32>,
    /// Samples of a pixel at which truth rests.
    #[arg(long, visible_alias = "samples", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(8..=16_384))]
    spp: u32,
    /// Moment of animations at the beginning, seconds.
    #[arg(long, default_value_t = 0.0)]
    time: f32,
    /// Folder or address of the network of `learned`, by default models/EFFECT; the folder of a training run is followed: its
    /// weights are run from each checkpoint on.
    #[arg(long)]
    model: Option<Place>,
    /// Chooses sampled views, added lights and all other random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// An EXR file whose layers are seen beside the methods.
    #[arg(long)]
    exr: Option<PathBuf>,
    /// Does what this file says, a line a step, instead of waiting for hands; the chapter
    /// on the window in the book lists them.
    #[arg(long)]
    script: Option<PathBuf>,
    /// Writes the figures here as JSON when the window closes.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
    #[command(flatten)]
    props: props::Args,
    #[command(flatten)]
    viewpoint: Viewpoint,
    #[command(flatten)]
    additions: Additions,
}

impl Args {
    /// How long the shutter is open, seconds.
    fn shutter(&self) -> f32 {
        exposure_time::Args::new(Some(self.time), None).shutter()
    }
}

/// Opens the window and closes it.
///
/// # Errors
/// If there is no display or no adapter, an argument means nothing, or a step of the script fails.
pub fn run(args: &Args) -> Result<()> {
    let began = Instant::now();
    check_size(["--height", "--width"], [args.height, args.width])?;
    listeners::check(args.effect, Setting::Radius, &[("--radius", args.radius.is_some())])?;
    let script = args.script.as_deref().map(Script::read).transpose()?;
    let outcome = Arc::new(Mutex::new(Outcome::default()));
    let state = state::State::new(args)?;
    let mut options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title(format!("deepshade: {}", args.scene))
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([240.0, 160.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        ..Default::default()
    };
    count_surfaces(&mut options.wgpu_options, &outcome);
    let made = {
        let (args, outcome) = (Arc::new(args.clone()), Arc::clone(&outcome));
        eframe::run_native(
            "deepshade",
            options,
            Box::new(move |creation| {
                let mut visuals = egui::Visuals::dark();
                // What is said beside images is read at a glance.
                visuals.override_text_color = Some(egui::Color32::from_gray(215));
                creation.egui_ctx.set_visuals(visuals);
                creation.egui_ctx.set_fonts(fonts());
                let desk = Desk::new(&args, &creation.egui_ctx)?;
                let mut window = Window::new(state, desk, script, outcome, began);
                args.exr.iter().for_each(|file| window.send(Errand::Open(file.clone())));
                Ok(Box::new(window))
            }),
        )
    };
    made.map_err(|error| no_window(&error))?;
    let outcome = outcome.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let mut figures = Figures::new("view");
    outcome.set(&mut figures);
    figures.write(args.json.as_deref())?;
    match outcome.failure {
        Some(failure) => bail!("{failure}"),
        None => Ok(()),
    }
}

/// Why there is no window, and what gives one to a machine without a screen.
fn no_window(error: &eframe::Error) -> anyhow::Error {
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => anyhow!(
            "no window: {}; on a machine without a screen `xvfb-run -a deepshade view` has one (package xvfb)",
            without_source(&error.to_string()).trim_end_matches('.')
        ),
        other => anyhow!("no window: {other}"),
    }
}

/// A message of winit's without the source file and the line that it names.
fn without_source(message: &str) -> &str {
    let Some((_, rest)) = message.split_once(".rs:") else { return message };
    rest.trim_start_matches(|letter: char| letter.is_ascii_digit()).trim_start_matches([':', ' '])
}

/// Counts how often there was no surface to paint on, whatever is done about it.
fn count_surfaces(options: &mut WgpuConfiguration, outcome: &Arc<Mutex<Outcome>>) {
    let (mend, outcome) = (Arc::clone(&options.on_surface_status), Arc::clone(outcome));
    options.on_surface_status = Arc::new(move |status: &CurrentSurfaceTexture| {
        let [outdated, lost] = &mut outcome.lock().unwrap_or_else(PoisonError::into_inner).surfaces;
        match status {
            CurrentSurfaceTexture::Outdated => *outdated += 1,
            CurrentSurfaceTexture::Lost => *lost += 1,
            _ => {}
        }
        mend(status)
    });
}

/// Roboto's Latin letters (Google, Apache License 2.0), whose digits are all as wide.
fn fonts() -> egui::FontDefinitions {
    let mut fonts = egui::FontDefinitions::empty();
    let name = "Roboto".to_owned();
    let letters = egui::FontData::from_static(include_bytes!("view/Roboto-Regular.ttf"));
    fonts.font_data.insert(name.clone(), Arc::new(letters));
    for family in [egui::FontFamily::Proportional, egui::FontFamily::Monospace] {
        fonts.families.insert(family, vec![name.clone()]);
    }
    fonts
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;

    #[test]
    fn what_is_said_where_there_is_no_screen_names_no_source_file() {
        let said =
            "winit EventLoopError: os error at /home/a/winit-0.30/src/linux/mod.rs:765: no DISPLAY is set";
        assert_eq!(without_source(said), "no DISPLAY is set");
        assert_eq!(without_source("another: error"), "another: error");
    }

    #[test]
    fn every_control_says_what_it_does() {
        for (name, text) in [
            ("panel", include_str!("view/panel.rs")),
            ("lights", include_str!("view/lights.rs")),
            ("layers", include_str!("view/layers.rs")),
            ("film", include_str!("view/film.rs")),
            #[cfg(feature = "train")]
            ("trainer", include_str!("view/trainer.rs")),
        ] {
            let text = text.split("#[cfg(test)]").next().unwrap_or_default();
            let count = |what: &[&str]| what.iter().map(|what| text.matches(what).count()).sum::<usize>();
            let pressed = count(&["ui.button(", "ui.small_button(", "ui.checkbox(", "ui.selectable_label("]);
            let set =
                count(&["ui.add(", "ui.add_enabled(", "ui.selectable_value(", ".show_ui(", "ui.collapsing("]);
            let explained = count(&[".on_hover_text("]);
            assert!(
                pressed + set > 0 && pressed + set == explained,
                "{name}: {pressed} + {set}, {explained}"
            );
        }
    }

    /// What a command line says.
    pub fn args(line: &str) -> Args {
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            args: Args,
        }
        let words = std::iter::once("deepshade").chain(line.split_whitespace());
        Line::try_parse_from(words).expect("a command line").args
    }
}
