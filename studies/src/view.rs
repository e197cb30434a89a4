//! `deepshade-studies view`: the window under a script: seconds to the first picture, pictures a second by
//! every method, what it takes badly, memory. Without a screen it runs under Xvfb (`xvfb-run -a
//! deepshade-studies view`).

use anyhow::{Context, Result, bail};
use deepshade::shared::figures::Figures;
use deepshade::shared::learned;
use deepshade::shared::methods::{self, LEARNED, SLOW, STUDY, TRUTH};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::Effect;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Measures the window.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade-studies view --json view.json\n  \
    xvfb-run -a deepshade-studies view --effects ao,gi --minutes 10 --json view.json\n\n\
    In the JSON file seconds_to_first_picture is from the program's beginning, fps_EFFECT_METHOD pictures a \
    second while the camera goes around, memory_growth_mb_10min what memory grew by in the minutes of \
    --minutes, scaled to ten, minimised whether a window manager put the window away, surfaces_outdated and \
    surfaces_lost how often there was none to paint on, panics how many threads died.")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj) or a procedural family and a seed, such as stairs:7.
    #[arg(long, default_value = "room:7")]
    scene: SceneSource,
    /// Which effects; by default all that have a method.
    #[arg(long, value_delimiter = ',')]
    effects: Vec<Effect>,
    /// Pictures of each method.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pictures: u32,
    /// For how long all effects are gone through in rounds, two at least, while memory is watched from the
    /// second one on; 0 for not at all.
    #[arg(long, default_value_t = 1.0, value_parser = deepshade::shared::arguments::within(0.0..=600.0))]
    minutes: f32,
    /// Pictures of the window, one an effect, are written into this folder.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = deepshade::shared::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Measures and prints.
///
/// # Errors
/// If there is no display or no adapter, or the window does not come to the end of its script.
pub fn run(args: &Args) -> Result<()> {
    let folder = tempfile::tempdir().context("a folder for the script")?;
    let broken = folder.path().join("broken.glb");
    std::fs::write(&broken, b"glTF, but not for long").context("a broken file")?;
    let [script, json] = ["script.txt", "view.json"].map(|name| folder.path().join(name));
    let shots = args.out.as_deref();
    if let Some(folder) = shots {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    std::fs::write(&script, steps(args, &broken, shots)).context("the script")?;
    note!("every method of every effect; on a software adapter that takes some quarter of an hour");
    let window = Command::new(crate::program::deepshade()?)
        .args(["view", "--scene", &args.scene.to_string(), "--height", "144", "--width", "224", "--script"])
        .arg(&script)
        .arg("--json")
        .arg(&json)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .context("the window")?;
    let said = String::from_utf8_lossy(&window.stderr);
    let panics = said.matches("panicked at").count();
    let mut figures = Figures::new("view");
    figures.detail("scene", args.scene.to_string().into());
    if !window.status.success() {
        // A window that ends before its script counts, too, be it without a word.
        figures.set("panics", panics.max(1) as f64);
        figures.write(args.json.as_deref())?;
        bail!("the window: {}", said.trim());
    }
    let text = std::fs::read_to_string(&json).context("the window's figures")?;
    let measured: Value = serde_json::from_str(&text).context("the window's figures")?;
    let measured = &measured["figures"];
    for (name, value) in measured.as_object().into_iter().flatten() {
        let Some(value) = value.as_f64() else { continue };
        match (name.as_str(), measured["soak_seconds"].as_f64()) {
            ("memory_growth_mb", Some(seconds)) => {
                figures.set("memory_growth_mb_10min", value * 600.0 / seconds);
            }
            (name, _) => figures.set(name, value),
        }
    }
    figures.set("panics", panics as f64);
    figures.write(args.json.as_deref())?;
    if measured["minimised"] == 0.0 {
        note!("no window manager is there, which would put a window away: that is not tried");
    }
    for (name, value) in figures.to_json()["figures"].as_object().into_iter().flatten() {
        say!("{name:<40} {:>10.3}", value.as_f64().unwrap_or(f64::NAN))?;
    }
    Ok(())
}

/// What hands would do: every effect by every method, odd sizes, a window that is put away, broken files, and
/// long walks.
fn steps(args: &Args, broken: &Path, shots: Option<&Path>) -> String {
    let all = Effect::ALL.into_iter().filter(|effect| !opened(*effect).is_empty());
    let effects: Vec<Effect> = if args.effects.is_empty() { all.collect() } else { args.effects.clone() };
    let mut steps = "truth off\nquality low\nwait picture\n".to_owned();
    let mut add = |step: String| writeln!(steps, "{step}").unwrap_or_default();
    for effect in &effects {
        add(format!("effect {effect}"));
        for method in opened(*effect) {
            add(format!("methods {method}\nmeasure {}", args.pictures));
        }
        if let Some(folder) = shots {
            add(format!("methods {}", opened(*effect).join(",")));
            add(format!("wait picture\nscreenshot {}", folder.join(format!("{effect}.png")).display()));
        }
    }
    if let Some(effect) = effects.first() {
        add(format!("effect {effect}\nmethods {}", opened(*effect)[0]));
    }
    for size in ["333 217", "1 1", "1601 901", "640 480"] {
        add(format!("resize {size}\nwait 0.3\nwait picture"));
    }
    add("size 37 23\nwait picture\nsize 224 144\nwait picture".to_owned());
    add("minimise on\norbit 10 0\nwait picture\nminimise off\nwait picture".to_owned());
    add(format!("open {}\nwait refusal\nopen {}\nwait picture", broken.display(), args.scene));
    if args.minutes > 0.0 {
        let names: Vec<&str> = effects.iter().map(|effect| effect.name()).collect();
        add(format!("truth on\nsoak {} {}", 60.0 * args.minutes, names.join(",")));
    }
    add("quit".to_owned());
    steps
}

/// Methods that can be opened: a trained network only where there is one, and neither [`SLOW`] nor [`STUDY`],
/// which take long.
fn opened(effect: Effect) -> Vec<&'static str> {
    let there = |name: &&str| {
        ![TRUTH, SLOW, STUDY].contains(name)
            && (*name != LEARNED || learned::is_network(&learned::usual_folder(effect)))
    };
    methods::names_of(effect).into_iter().filter(there).collect()
}
