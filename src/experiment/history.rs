//! Networks that read what they made of the frame before, on films of a camera that goes on: how near they are to truth, and how
//! much they flicker, beside the same network without that and its images mixed over time.

use super::exam::{Exam, SIMILARITY, Scores, WholeFrame};
use super::lab::Lab;
use super::table::{Row, Table};
use crate::plot::{Line, Plot};
use anyhow::Result;
use deepshade_dataset::recipe::Sequence;
use deepshade_dataset::{Dataset, Pair, Recipe};
use deepshade_infer::NetSpec;
use deepshade_render::scene::Camera;
use deepshade_render::screen::reprojection::Parameters;
use deepshade_render::screen::reprojection::reference::{Two, flicker, mixed, since_at_rest};
use deepshade_shaders::{Attribute, Planes};
use deepshade_train::options::history::{Carry, Films, Memory, Recurrent, Still};
use std::time::Instant;

/// How cameras go on: some pixels a frame.
const SEQUENCE: Sequence = Sequence { frames: 4, turn: 0.5, step: 0.003 };

/// Networks that are compared, as figures and the table call them.
const MEMORIES: [(Memory, &str, &str); 3] = [
    (Memory::None, "none", "knows nothing of the frame before"),
    (Memory::Image, "image", "reads its image of the frame before"),
    (Memory::Kept, "kept", "reads it, and loses by change that truth lacks"),
];

/// Frames of a film with what is known of how they follow each other.
struct Film {
    stills: Vec<Still>,
    /// [`Two::since_before`] of each.
    since: Vec<Planes>,
}

/// The films of a dataset, read as they are wanted.
struct Shelf<'a> {
    dataset: &'a Dataset,
    spec: &'a NetSpec,
    /// The first pair of each film that is trained on.
    firsts: Vec<usize>,
}

/// Trains a network of each kind.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(lab: &Lab) -> Result<Table> {
    let exam = lab.exam("history", &test_recipe(lab))?;
    let data = lab.data("history", &recipe(&lab.recipe))?;
    let settings = lab.settings(&data)?;
    let films = exam.films(&settings.spec)?;
    let shelf = Shelf::new(&data.dataset, &settings.spec);
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (memory, name, label) in MEMORIES {
        note!("network `history-{name}`: {} steps", settings.steps);
        let start = Instant::now();
        let network = Recurrent::train(memory, &settings, &shelf)?;
        let seconds = start.elapsed().as_secs_f64();
        let images: Vec<Vec<Planes>> = films.iter().map(|film| film.run(&network)).collect();
        let mut add = |name: &str, label: &str, images: &[Vec<Planes>], seconds: f64| -> Result<()> {
            let (scores, flickers) =
                (exam.scores_of(images.iter().flatten().cloned().map(Ok))?, flickering(&films, images));
            lines.push(Line::dotted(label, vec![(flickers, scores.dssim())]));
            rows.push(row(name, label, &scores, flickers, seconds));
            Ok(())
        };
        add(name, label, &images, seconds)?;
        if memory == Memory::None {
            let calmed: Vec<Vec<Planes>> =
                films.iter().zip(&images).map(|(film, images)| film.calmed(images)).collect();
            add("mixed", "the same, its images mixed over time", &calmed, seconds)?;
        }
    }
    let truth: Vec<Vec<Planes>> =
        films.iter().map(|film| film.stills.iter().map(|still| still.target.clone()).collect()).collect();
    let trivial = exam.trivial()?;
    rows.push(row("trivial", "white", &trivial, 0.0, f64::NAN));
    lab.note(format!("truth itself flickers by {:.4}, of its noise too", flickering(&films, &truth)));
    Ok(Table {
        title: "Networks that know what they made of the frame before",
        rows_are: "network",
        columns: [&SIMILARITY[..], &[("L1", 4), ("flicker", 4), ("training s", 1)]].concat(),
        rows,
        plot: Plot {
            x: "flicker: mean change of a surface's value from frame to frame",
            is_logarithmic: false,
            y: "DSSIM on test scenes",
            lines,
            level: None,
        },
    })
}

fn row(name: &str, label: &str, scores: &Scores, flickers: f64, seconds: f64) -> Row {
    let values = [&scores.similarity()[..], &[scores.l1, flickers, seconds]].concat();
    Row::new(format!("ssim_{name}"), label, &values)
}

/// A recipe of films with about as many frames as it has views.
fn recipe(recipe: &Recipe) -> Recipe {
    let views_per_scene = recipe.views_per_scene.next_multiple_of(SEQUENCE.frames);
    Recipe { sequence: Some(SEQUENCE), views_per_scene, ..recipe.clone() }
}

/// The lab's recipe for testing, of films all frames of which are also kept whole.
fn test_recipe(lab: &Lab) -> Recipe {
    let films = recipe(&lab.test_recipe);
    let frames = films.scene_count() * films.views_per_scene;
    Recipe {
        tiles: films.tiles.map(|tiles| deepshade_dataset::recipe::Tiles { whole_frames: frames, ..tiles }),
        ..films
    }
}

/// How much images of films flicker, in the mean.
fn flickering(films: &[Film], images: &[Vec<Planes>]) -> f64 {
    let of = |(film, images): (&Film, &Vec<Planes>)| -> Vec<f64> {
        (1..images.len())
            .map(|frame| flicker(film.two(frame), &images[frame], &images[frame - 1], tolerance()))
            .collect()
    };
    let flickers: Vec<f64> = films.iter().zip(images).flat_map(of).collect();
    flickers.iter().sum::<f64>() / flickers.len() as f64
}

fn tolerance() -> f32 {
    Parameters::default().depth_tolerance
}

impl Film {
    /// A film of g-buffers, cameras and truth, in their order.
    fn new<'a>(frames: impl Iterator<Item = WholeFrame<'a>>, spec: &NetSpec) -> Result<Self> {
        let (mut stills, mut since) = (Vec::new(), Vec::<Planes>::new());
        let mut before: Option<&Camera> = None;
        for (gbuffer, camera, radius, truth) in frames {
            let seen = gbuffer.seen()?;
            let positions = gbuffer.select(&[Attribute::Position])?;
            since.push(since_at_rest(&positions, &seen, camera, before.unwrap_or(camera)));
            let carry = match &since[..] {
                [.., then, now] => carry(Two { since_before: now, since_before_that: then }),
                _ => Carry::nothing(truth.pixels()),
            };
            let valid = seen.iter().map(|seen| f32::from(u8::from(*seen))).collect();
            stills.push(Still {
                input: spec.input(gbuffer, spec.scaling(gbuffer, radius)?, 0)?,
                target: truth.clone(),
                variance: truth.map(|_| 0.0),
                valid: Planes::from_data(1, truth.height(), truth.width(), valid),
                carry,
            });
            before = Some(camera);
        }
        Ok(Self { stills, since })
    }

    /// What a frame and the one before show of the same surfaces.
    fn two(&self, frame: usize) -> Two<'_> {
        Two { since_before: &self.since[frame], since_before_that: &self.since[frame.saturating_sub(1)] }
    }

    /// A network's images, frame by frame.
    fn run(&self, network: &Recurrent) -> Vec<Planes> {
        let mut images: Vec<Planes> = Vec::new();
        for still in &self.stills {
            let made = network.image(still, images.last());
            images.push(on_white(&made, &still.valid));
        }
        images
    }

    /// Images mixed over time, as `--temporal` does.
    fn calmed(&self, images: &[Planes]) -> Vec<Planes> {
        let mut calmed: Vec<Planes> = Vec::new();
        for (frame, image) in images.iter().enumerate() {
            let [height, width] = [image.height(), image.width()];
            let mixing = Parameters::default().uniform(height, width, frame == 0);
            let before = calmed.last().unwrap_or(image);
            calmed.push(mixed(self.two(frame), image, before, &mixing));
        }
        calmed
    }
}

/// Ambient occlusion's background where nothing is seen.
fn on_white(image: &Planes, valid: &Planes) -> Planes {
    Planes::from_fn(image.channels(), image.height(), image.width(), |c, y, x| {
        if valid.at(0, y, x) > 0.5 { image.at(c, y, x) } else { 1.0 }
    })
}

/// Where each pixel's surface was in the frame before.
fn carry(two: Two<'_>) -> Carry {
    let [height, width] = [two.since_before.height(), two.since_before.width()];
    let of = |pixel: usize| match two.taps([pixel / width, pixel % width], tolerance()) {
        Some((taps, sum)) => taps.map(|(at, weight)| (at, weight / sum)),
        None => [(0, 0.0); 4],
    };
    Carry((0..height * width).map(of).collect())
}

impl<'a> Shelf<'a> {
    fn new(dataset: &'a Dataset, spec: &'a NetSpec) -> Self {
        let firsts = dataset
            .training()
            .into_iter()
            .filter(|pair| dataset.record(*pair).view.is_multiple_of(SEQUENCE.frames));
        Self { dataset, spec, firsts: firsts.collect() }
    }
}

impl Films for Shelf<'_> {
    fn count(&self) -> usize {
        self.firsts.len()
    }

    fn frames(&self, film: usize) -> Result<Vec<Still>, String> {
        let pairs = self.firsts[film]..self.firsts[film] + SEQUENCE.frames;
        let read = |pair: usize| self.dataset.pair(pair).map_err(|error| error.to_string());
        let read = pairs.clone().map(read).collect::<Result<Vec<_>, _>>()?;
        let frames = pairs.zip(&read).map(|(index, pair)| {
            (&pair.gbuffer, &self.dataset.record(index).camera, pair.radius, &pair.target)
        });
        let stills = Film::new(frames, self.spec).map_err(|error| format!("{error:#}"))?.stills;
        let with_noise = |(still, pair): (Still, &Pair)| {
            let variance = pair.variance.clone().unwrap_or(still.variance);
            Still { variance, ..still }
        };
        Ok(stills.into_iter().zip(&read).map(with_noise).collect())
    }
}

impl Exam {
    /// Its frames as films.
    fn films(&self, spec: &NetSpec) -> Result<Vec<Film>> {
        self.whole_frames()
            .chunks(SEQUENCE.frames)
            .map(|frames| Film::new(frames.iter().copied(), spec))
            .collect()
    }
}
