//! `deepshade view`: a window on a scene in motion, methods side by side, and truth that refines behind them.
//!
//! Threads work for the window ([`workers`]), most for their newest request alone: [`method_worker`] makes
//! frames on a device of its own, [`truth`] refines truth while nothing moves, [`metrics`] measures one
//! against the other, `training_run` follows a training run, `training_process` waits for the end of one,
//! [`file_worker`] reads and writes files, `design::place` finds light of places. The window waits for none.

mod canvas;
mod catch_panic;
mod design;
mod display_image;
mod figures;
mod file_worker;
mod film;
mod layers;
mod legend;
mod lights;
mod method_worker;
mod metrics;
mod panel;
mod parameters;
mod probe;
mod request_slot;
mod saved;
mod state;
mod subject;
#[cfg(feature = "train")]
mod training_panel;
#[cfg(feature = "train")]
mod training_process;
#[cfg(feature = "train")]
mod training_run;
mod truth;
mod window;
mod window_figures;
mod workers;
mod zoom;

use crate::arguments::{check_size, reach};
use crate::complete::{Additions, listeners};
use crate::exposure_time;
use crate::learned;
use crate::location::Location;
use crate::phosphor::design::task::Task;
use crate::props;
use crate::views::Viewpoint;
use anyhow::{Result, anyhow, bail};
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;
use design::GlowDesign;
use eframe::egui::{self, ViewportBuilder};
use eframe::egui_wgpu::WgpuConfiguration;
use eframe::wgpu::CurrentSurfaceTexture;
use file_worker::FileTask;
use state::State;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use window::{Screenshot, Window};
use window_figures::WindowFigures;
use workers::Workers;

/// Shows a scene in a window, by several methods at once, beside truth.
#[derive(clap::Args, Clone)]
#[command(after_help = "Examples:\n  deepshade view\n  \
    deepshade view --scene sponza.gltf --effect gi --methods ssgi,surfel\n  \
    deepshade view --scene hall.gltf --put fox.gltf@-5,0,0,0.01,60 --effect fog-direct --extinction 0.2\n  \
    deepshade view --model runs/ao --methods learned,hbao    # while `deepshade train` works on it\n\n\
    Drag to go around, with the right button to look around, with the middle one to move; the wheel comes \
    nearer, \
    with Ctrl it enlarges images, as + and - do; the middle button then moves them, and 0 shows all of them. \
    W, A, S, D, Q and \
    E fly, with Shift faster. Space plays the animation, T turns truth on and off, M goes through image, \
    difference and FLIP, P keeps a picture of \
    the window. A scene \
    file or the folder of a model or a training run dropped onto the window is opened, layers of an EXR file \
    are shown beside the methods.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7.
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
    /// Folder, address or name of the network of `learned`, by default models/EFFECT, else the program's own;
    /// the folder of a training run is followed: its weights are run from each checkpoint on.
    #[arg(long, value_parser = network)]
    model: Option<Location>,
    /// Chooses sampled views, added lights and all other random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// An EXR file whose layers are seen beside the methods.
    #[arg(long)]
    exr: Option<PathBuf>,
    /// Key frames of glow to begin with: of a file (.toml) as `deepshade phosphor design` reads, its first
    /// place, states, length, spectrum, and whether colours include what is reflected (towards where the
    /// camera is). When lamps shine is as the scene or --phosphor says.
    #[arg(long)]
    key_frames: Option<PathBuf>,
    /// Writes an image of the window here as PNG, once truth has --spp samples and figures are there, and
    /// ends.
    #[arg(long, value_parser = crate::arguments::png_file)]
    screenshot: Option<PathBuf>,
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

/// Reads where a network is, or will be once its training has begun.
fn network(text: &str) -> Result<Location, String> {
    learned::place(text).or_else(|_| text.parse())
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
/// If there is no display or no adapter, an argument means nothing, or no screenshot can be made.
pub fn run(args: &Args) -> Result<()> {
    let outcome = Arc::new(Mutex::new(WindowFigures::new()));
    check_size(["--height", "--width"], [args.height, args.width])?;
    listeners::check(args.effect, EffectSetting::Radius, &[("--radius", args.radius.is_some())])?;
    let key_frames = [("--key-frames", args.key_frames.is_some())];
    listeners::check(args.effect, EffectSetting::Phosphor, &key_frames)?;
    // What is wrong with the file is said where no window is yet.
    args.key_frames.as_deref().map(Task::read).transpose()?;
    let state = State::new(args)?;
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
        let outcome = Arc::clone(&outcome);
        eframe::run_native(
            "deepshade",
            options,
            Box::new(move |creation| {
                style(&creation.egui_ctx);
                Ok(Box::new(open(state, outcome, &creation.egui_ctx)?))
            }),
        )
    };
    made.map_err(|error| no_window(&error))?;
    let outcome = outcome.lock().unwrap_or_else(PoisonError::into_inner).clone();
    outcome.figures().write(args.json.as_deref())?;
    match outcome.failure {
        Some(failure) => bail!("{failure}"),
        None => Ok(()),
    }
}

/// Sets fonts and colours.
fn style(context: &egui::Context) {
    let mut visuals = egui::Visuals::dark();
    // What is said beside images is read at a glance.
    visuals.override_text_color = Some(egui::Color32::from_gray(215));
    context.set_visuals(visuals);
    context.set_fonts(fonts());
}

/// A window with its workers, as the command line wants it.
fn open(state: State, outcome: Arc<Mutex<WindowFigures>>, context: &egui::Context) -> Result<Window> {
    let args = Arc::clone(&state.args);
    let screenshot = args.screenshot.clone().map(Screenshot::new);
    let mut window = Window::new(state, Workers::new(&args, context)?, screenshot, outcome);
    if let Some(file) = &args.key_frames {
        window.design = GlowDesign::of(&Task::read(file)?);
    }
    args.exr.iter().for_each(|file| window.send(FileTask::Open(file.clone())));
    Ok(window)
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
fn count_surfaces(options: &mut WgpuConfiguration, outcome: &Arc<Mutex<WindowFigures>>) {
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
mod tests;
