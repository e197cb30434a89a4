//! `deepshade view`: a window on a scene in motion, methods side by side, and truth that refines behind them.
//!
//! Three threads work for the window, each for its newest order alone: [`studio`] makes frames on a device of its own, [`truth`]
//! refines truth while nobody moves, [`judge`] holds one against the other. The window waits for none of them.

mod canvas;
mod caught;
mod judge;
mod lights;
mod mailbox;
mod panel;
mod pictures;
mod pilot;
mod saved;
mod script;
mod state;
mod studio;
mod subject;
mod truth;
mod window;

use crate::arguments::{check_pixels, reach};
use crate::complete::{Additions, listeners};
use crate::exposure_time;
use crate::figures::Figures;
use crate::props;
use crate::views::Viewpoint;
use anyhow::{Result, anyhow, bail};
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use deepshade_shaders::Effect;
use eframe::egui::{self, ViewportBuilder};
use judge::Verdict;
use mailbox::Mailbox;
use script::Script;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Instant;
use studio::Picture;
use subject::Subject;
use truth::Truth;
use window::{Outcome, Window};

/// Shows a scene in a window, by several methods at once, beside truth.
#[derive(clap::Args, Clone)]
#[command(after_help = "Examples:\n  deepshade view\n  \
    deepshade view --scene sponza.gltf --effect gi --methods ssgi,surfel\n  \
    deepshade view --scene hall.gltf --put fox.gltf@-5,0,0,0.01,60 --effect fog-direct --extinction 0.2\n\n\
    Drag to go around, with the right button to look around, with the middle one to move; the wheel comes nearer; W, A, S, D, Q and \
    E fly, with Shift faster. Space plays the animation, T turns truth on and off, M goes through image, difference and FLIP. A scene \
    file or a model folder dropped onto the window is opened.")]
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
    /// How far effects with a radius reach, metres, or inf; by default 15 % of the scene's diagonal at 512 rows.
    #[arg(long, value_parser = reach)]
    radius: Option<f32>,
    /// Samples of a pixel at which truth rests.
    #[arg(long, visible_alias = "samples", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(8..=16_384))]
    spp: u32,
    /// Moment of animations at the beginning, seconds.
    #[arg(long, default_value_t = 0.0)]
    time: f32,
    /// Folder of the network of `learned`; by default models/EFFECT.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Chooses sampled views, added lights and all other random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Does what this file says, a line a step, instead of waiting for hands: see the README.
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

/// What threads tell the window.
pub enum News {
    /// Another scene was read.
    Subject(Arc<Subject>),
    /// A frame was made.
    Picture(Box<Picture>),
    /// Truth is better known.
    Truth(Truth),
    /// Images were judged.
    Judged(Verdict),
    /// The picture that is ordered cannot be made.
    NoPicture(String),
    /// Something else cannot be done.
    Refused(String),
}

/// Where the window puts its orders, and hears what came of them.
pub struct Desk {
    /// Frames.
    studio: Arc<Mailbox<studio::Order>>,
    /// Truth.
    truth: Arc<Mailbox<truth::Order>>,
    /// Images to be judged.
    judge: Arc<Mailbox<judge::Case>>,
    news: mpsc::Receiver<News>,
    threads: Vec<thread::JoinHandle<()>>,
}

/// Opens the window and closes it.
///
/// # Errors
/// If there is no display or no adapter, an argument means nothing, or a step of the script fails.
pub fn run(args: &Args) -> Result<()> {
    let began = Instant::now();
    check_pixels(args.height, args.width)?;
    listeners::check(args.effect, listeners::RADIUS, &[("--radius", args.radius.is_some())])?;
    let script = args.script.as_deref().map(Script::read).transpose()?;
    let outcome = Arc::new(Mutex::new(Outcome::default()));
    let state = state::State::new(args)?;
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title(format!("deepshade: {}", args.scene))
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([240.0, 160.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        ..Default::default()
    };
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
                Ok(Box::new(Window::new(state, desk, script, outcome, began)))
            }),
        )
    };
    made.map_err(|error| anyhow!("no window: {error}"))?;
    let outcome = outcome.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let mut figures = Figures::new("view");
    outcome.set(&mut figures);
    figures.write(args.json.as_deref())?;
    match outcome.failure {
        Some(failure) => bail!("{failure}"),
        None => Ok(()),
    }
}

impl Desk {
    fn new(args: &Arc<Args>, context: &egui::Context) -> Result<Self> {
        let (sender, news) = mpsc::channel();
        let tell = move |context: &egui::Context, news: News| {
            // The window may have closed meanwhile.
            let _ = sender.send(news);
            context.request_repaint();
        };
        let (studio, truth, judge) = (Arc::default(), Arc::default(), Arc::default());
        let mut desk = Self { studio, truth, judge, news, threads: Vec::new() };
        desk.threads.push({
            let (args, orders, tell, context) =
                (Arc::clone(args), Arc::clone(&desk.studio), tell.clone(), context.clone());
            spawn("studio", move || studio::run(&args, &orders, &|news| tell(&context, news)))?
        });
        desk.threads.push({
            let (orders, tell, context) = (Arc::clone(&desk.truth), tell.clone(), context.clone());
            spawn("truth", move || truth::run(&orders, &|news| tell(&context, news)))?
        });
        desk.threads.push({
            let (orders, context) = (Arc::clone(&desk.judge), context.clone());
            spawn("judge", move || judge::run(&orders, &|news| tell(&context, news)))?
        });
        Ok(desk)
    }
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

fn spawn(name: &str, work: impl FnOnce() + Send + 'static) -> Result<thread::JoinHandle<()>> {
    Ok(thread::Builder::new().name(name.to_owned()).spawn(work)?)
}

impl Drop for Desk {
    /// Threads go home after the frame or the pass that they are at.
    fn drop(&mut self) {
        self.studio.close();
        self.truth.close();
        self.judge.close();
        for thread in self.threads.drain(..) {
            // A thread that panicked has told its own story.
            let _ = thread.join();
        }
    }
}
