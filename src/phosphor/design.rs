//! `deepshade phosphor design`: materials by how places of a scene should look (thesis, section 8.6).

pub mod light;
mod pictures;
mod spread;
mod strip;
pub mod task;

use crate::figures::{Figures, write_atomically};
use crate::table;
use anyhow::{Context, Result, ensure};
use deepshade_glow::file::MaterialFile;
use deepshade_glow::material::Material;
use deepshade_phosphor::design::{Design, Key, TargetPoint, thesis_grid};
use deepshade_render::scene::glow::file::{GlowFile, WrittenSurface};
use deepshade_shaders::colour::luminance;
use glam::{DVec3, Vec3};
use light::{Spot, SwitchedScene};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;
use task::Task;

/// Finds materials that make places of a scene look as they should at certain moments.
///
/// A file (TOML) names the scene, says when its lamps shine, and for places on its surfaces which colours
/// they should have when. Light is that of lamps with shadows; what moves is where it is in each frame.
/// Places on the same material are met together, by one material; other materials that are like it, in place
/// and colour, may get one like it. The folder --out gets `glow.toml`, which `render --effect phosphor
/// --phosphor` takes, its `materials.toml`, a plot for each place of what is wanted and what is reached, and
/// a strip of pictures of the moments that were asked for, labelled by moment and places.
#[derive(clap::Args)]
#[command(after_help = EXAMPLE)]
pub struct Args {
    /// What is wanted (.toml).
    file: PathBuf,
    /// Folder for what is found, which is made.
    #[arg(long)]
    out: PathBuf,
    /// Rows of the pictures; columns are half as many more.
    #[arg(long, default_value_t = 192, value_parser = clap::value_parser!(u16).range(16..=2048))]
    height: u16,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// What `--help` ends with.
const EXAMPLE: &str = "Example: a wall that is green after its lamp went off at second 5, and blue later.

  scene = \"hall.gltf\"           # relative to this file, or a family and a seed: \"room:7\"
  states = 2                    # 1 by default
  bands = \"rgb\"                 # or \"eight\"; rgb by default
  frames = 200
  fps = 10
  reflected = false             # whether colours include light of lamps that the surface reflects to the camera of [view]

  spectrum = \"mercury\"          # of all lamps, as in files for --phosphor; may be left out

  [[lamps]]                     # as there, from second 0 on
  on = [[0.0, 5.0]]

  [[place]]
  at = [0.2, 1.1, -3.0]         # metres; the surface next to it
  keys = [{ time = 5.5, colour = [0.02, 0.08, 0.03] }, { time = 15, colour = [0.005, 0.01, 0.02] }]

  [spread]                      # to materials alike: over such differences affinity falls to 1/e; may be left out
  distance = 4.0
  colour = 0.2

  [view]                        # by default the scene's first camera
  eye = [0, 1.6, 4]
  look_at = [0, 1, 0]

  deepshade phosphor design wanted.toml --out designed
  deepshade render --scene hall.gltf --effect phosphor --phosphor designed/glow.toml --time 8

Of the figures, ms_design is what all designs take, design_residual the sum of squares that they leave of what is wanted, over \
places, keys and bands, design_residual_grid what the thesis' grid leaves (one state, ten values for each parameter).";

/// A material of the scene with what was found for it.
pub struct Designed {
    /// Number in the scene, and what files call it.
    pub material: usize,
    pub name: String,
    /// Its places, by their numbers in the task.
    pub numbers: Vec<usize>,
    pub spots: Vec<Spot>,
    /// Their light and what is wanted there.
    pub places: Vec<TargetPoint>,
    pub design: Design,
    /// What the thesis' grid leaves.
    grid: f64,
    milliseconds: f64,
}

/// Designs, writes and prints.
///
/// # Errors
/// If the file says what makes no sense or the scene lacks, or a file cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let task = Task::read(&args.file)?;
    let switched = SwitchedScene::new(&task).with_context(|| args.file.display().to_string())?;
    let first = switched.at(0.0)?;
    ensure!(!first.scene().lights.is_empty(), "{}: the scene has no lamp", args.file.display());
    let size = [args.height.into(), usize::from(args.height) * 3 / 2];
    let camera = task.view.of(&task.scene, &first, size, 0)?.camera;
    let found =
        designs(&task, &switched, camera.position).with_context(|| args.file.display().to_string())?;
    found.iter().for_each(Designed::warn);
    let paints = spread::paints(&found, first.scene(), task.reach())?;
    let mut figures = Figures::new("phosphor design");
    figures.set("ms_design", found.iter().map(|found| found.milliseconds).sum());
    figures.set("design_residual", found.iter().map(|found| found.design.residual).sum());
    figures.set("design_residual_grid", found.iter().map(|found| found.grid).sum());
    figures.set("wanted", found.iter().map(Designed::wanted).sum());
    let of_material = |found: &Designed| {
        json!({ "material": found.name, "ms": found.milliseconds, "residual": found.design.residual, "grid": found.grid,
            "wanted": found.wanted(), "states": found.design.material.states, "at_bounds": found.design.at_bounds() })
    };
    figures.detail("designs", found.iter().map(of_material).collect());
    std::fs::create_dir_all(&args.out).with_context(|| args.out.display().to_string())?;
    figures.write(args.json.as_deref())?;
    let surface = |(material, paint): &(String, Material)| WrittenSurface {
        material: Some(material.clone()),
        paint: paint.name.clone(),
        ..WrittenSurface::default()
    };
    let glow = GlowFile {
        materials: Some("materials.toml".into()),
        surfaces: paints.iter().map(surface).collect(),
        spectrum: task.spectrum,
        lamps: task.lamps.clone(),
        ..GlowFile::default()
    };
    let materials =
        MaterialFile { materials: paints.into_iter().map(|(_, paint)| paint).collect(), fragments: vec![] };
    write_atomically(&args.out.join("materials.toml"), materials.text().as_bytes())?;
    let file = args.out.join("glow.toml");
    write_atomically(&file, glow.text().as_bytes())?;
    pictures::plots(&task, &found, &args.out)?;
    strip::write(&task, (&switched, &camera), &found, &file, size)?;
    say!("{}", table::aligned(&rows(&found)))?;
    say!("{}", file.display())
}

/// The designs of all materials that places are on, which are seen from `eye`.
fn designs(task: &Task, switched: &SwitchedScene, eye: Vec3) -> Result<Vec<Designed>> {
    let first = switched.at(0.0)?;
    let spots: Vec<Spot> =
        task.places.iter().map(|place| light::spot(&first, place.at)).collect::<Result<_>>()?;
    let [excites, reflected] = light::received(task, switched, &first, (&spots, eye))?;
    let mut materials: Vec<usize> = spots.iter().map(|spot| spot.material).collect();
    materials.sort_unstable();
    materials.dedup();
    let names = first.scene().material_names();
    let of_material = |material: usize| {
        let numbers: Vec<usize> =
            (0..spots.len()).filter(|index| spots[*index].material == material).collect();
        let places = numbers.iter().map(|index| place(task, *index, [&excites[*index], &reflected[*index]]));
        let places = places.collect::<Result<Vec<TargetPoint>>>()?;
        let name = names[material].clone();
        let start = Instant::now();
        let design = Design::new(&format!("{name}, designed"), &places, task.states)?;
        let milliseconds = 1e3 * start.elapsed().as_secs_f64();
        let spots = numbers.iter().map(|index| spots[*index].clone()).collect();
        let grid = thesis_grid(&places)?;
        Ok(Designed { material, name, numbers, spots, places, design, grid, milliseconds })
    };
    materials.into_iter().map(of_material).collect()
}

/// A place of the task with its light in each frame: what excites, and what is reflected.
fn place(task: &Task, index: usize, [excites, reflected]: [&[Vec3]; 2]) -> Result<TargetPoint> {
    let wanted = &task.places[index];
    ensure!(
        excites.iter().any(|light| *light != Vec3::ZERO),
        "the place at {} gets no light of lamps in any frame",
        wanted.at
    );
    let in_bands = |colour: &Vec3| task.bands.of_linear_srgb(colour.as_dvec3().to_array());
    let lamp = task.spectrum.map(|lamp| lamp.of_luminance_one(task.bands));
    let exciting = |colour: &Vec3| match &lamp {
        Some(lamp) => {
            let luminance = f64::from(luminance(colour.to_array()));
            lamp.iter().map(|part| luminance * part).collect()
        }
        None => in_bands(colour),
    };
    let key =
        |key: &task::WantedKey| Some(Key { frame: task.frame(key.time)?, radiance: task.radiance(key) });
    let counts: &[Vec3] = if task.reflected { reflected } else { &[] };
    Ok(TargetPoint {
        bands: task.bands,
        dt: 1.0 / f64::from(task.fps),
        irradiance: excites.iter().map(exciting).collect(),
        reflected: counts.iter().map(in_bands).collect(),
        keys: wanted.keys.iter().filter_map(key).collect(),
    })
}

impl Designed {
    /// The sum of squares of what is wanted.
    fn wanted(&self) -> f64 {
        let keys = self.places.iter().flat_map(|place| &place.keys);
        keys.flat_map(|key| &key.radiance).map(|value| value * value).sum()
    }

    /// Says which rates ended at a bound of the search.
    fn warn(&self) {
        for rate in self.design.at_bounds() {
            note!("{}: {rate}, a bound of the search: what is wanted may ask for more", self.name);
        }
    }
}

fn rows(found: &[Designed]) -> Vec<Vec<String>> {
    let head = [
        "material",
        "places",
        "half lives, s",
        "off, of what is wanted",
        "the thesis' grid",
        "ms",
        "at bounds",
    ];
    let row = |found: &Designed| {
        let share = |left: f64| format!("{:.2} %", 100.0 * (left / found.wanted()).sqrt());
        let half = |decay: f64| format!("{:.1}", std::f64::consts::LN_2 / decay);
        let states = &found.design.material.states;
        vec![
            found.name.clone(),
            found.places.len().to_string(),
            states.iter().map(|state| half(state.decay)).collect::<Vec<_>>().join(", "),
            share(found.design.residual),
            share(found.grid),
            format!("{:.1}", found.milliseconds),
            found.design.at_bounds().join("; "),
        ]
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(found.iter().map(row)).collect()
}

/// A linear RGB colour of values in bands.
fn colour(task: &Task, values: &[f64]) -> DVec3 {
    DVec3::from(task.bands.linear_srgb(values))
}

#[cfg(test)]
mod tests;
