//! The thread that refines truth for as long as nobody moves: path traced on all cores but one, kept for each view.

use super::News;
use super::caught::caught;
use super::mailbox::Mailbox;
use super::pictures::Developed;
use super::subject::Subject;
use crate::methods::TRUTH;
use crate::render::picture::Exposure;
use anyhow::Result;
use deepshade_render::metrics::exposure;
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::path::{Refinement, Shot};
use deepshade_render::scene::{Camera, Light, SceneSource};
use deepshade_shaders::{Effect, Planes};
use std::sync::Weak;
use std::time::Instant;

/// What truth is of.
#[derive(Clone)]
pub struct Sight {
    /// Where the scene is from.
    pub source: SceneSource,
    /// What is computed of it.
    pub effect: Effect,
    /// The scene, as long as the window shows it: truth that is kept keeps no scenes.
    pub subject: Weak<Subject>,
    /// From where it is seen.
    pub camera: Camera,
    /// When, seconds.
    pub time: f32,
    /// Under which lights.
    pub lights: Vec<Light>,
    /// How far the effect reaches, metres.
    pub radius: f32,
    /// Rows and columns.
    pub size: [usize; 2],
}

impl PartialEq for Sight {
    /// A scene that was read again is the same one.
    fn eq(&self, other: &Self) -> bool {
        (&self.source, self.effect) == (&other.source, other.effect)
            && (self.camera, self.time, &self.lights, self.radius, self.size)
                == (other.camera, other.time, &other.lights, other.radius, other.size)
    }
}

/// Truth that is wanted.
#[derive(Clone, PartialEq)]
pub struct Order {
    /// Of what.
    pub sight: Sight,
    /// How it is exposed; by default as suits it.
    pub exposure: Option<Exposure>,
    /// How much brighter than suits it, stops.
    pub stops: f32,
    /// With how many samples of a pixel.
    pub samples: u32,
    /// Chooses random numbers.
    pub seed: u32,
}

impl Order {
    /// Whether what is traced for another order is what this one wants, and it wants more than rest.
    fn goes_on(&self, other: &Self) -> bool {
        (&self.sight, self.seed) == (&other.sight, other.seed) && self.samples > 0
    }

    fn developed(&self, values: Planes) -> Developed {
        let suits = || Exposure::new(self.sight.effect, &values, None).brighter(self.stops);
        let exposure = self.exposure.unwrap_or_else(suits);
        Developed::new(TRUTH, values, exposure)
    }
}

/// Truth as far as it is known.
#[derive(Clone)]
pub struct Truth {
    /// Of what.
    pub sight: Sight,
    /// The image.
    pub image: Developed,
    /// Samples of a pixel.
    pub samples: u32,
    /// Its noise as a share of its values.
    pub noise: f64,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Views of which truth is kept.
const KEPT: usize = 32;

/// Refines what is ordered until the mailbox is closed.
pub fn run(orders: &Mailbox<Order>, tell: &(dyn Fn(News) + Sync)) {
    let threads =
        std::thread::available_parallelism().map_or(1, |cores| cores.get().saturating_sub(1).max(1));
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool,
        Err(error) => return tell(News::Refused(format!("truth: {error}"))),
    };
    let mut known: Vec<Truth> = Vec::new();
    while let Some(order) = orders.take() {
        let before =
            known.iter().position(|truth| truth.sight == order.sight).map(|index| known.remove(index));
        if let Some(truth) = &before {
            let image = order.developed(Planes::clone(&truth.image.values));
            tell(News::Truth(Truth { image, ..truth.clone() }));
        }
        let samples = before.as_ref().map_or(0, |truth| truth.samples);
        let doing = format!("truth of {} of {}", order.sight.effect, order.sight.source);
        let refined = caught(&doing, || pool.install(|| refine(orders, order, samples, tell)));
        match refined {
            Ok(refined) => known.extend(refined.or(before)),
            Err(error) => tell(News::Refused(format!("truth: {error:#}"))),
        }
        if known.len() > KEPT {
            known.remove(0);
        }
    }
}

/// Refines truth until there are samples enough or there is another order, and tells of each pass that has more samples than
/// are known. Gives the last of these. An order of the same sight that is only shown otherwise, or wants other numbers of
/// samples, goes on with what there is.
fn refine(
    orders: &Mailbox<Order>,
    mut order: Order,
    known: u32,
    tell: &(dyn Fn(News) + Sync),
) -> Result<Option<Truth>> {
    if known >= order.samples {
        return Ok(None);
    }
    let start = Instant::now();
    let sight = order.sight.clone();
    let Some(subject) = sight.subject.upgrade() else { return Ok(None) };
    let scene = subject.traced(sight.time, &sight.lights)?;
    let shot = Shot::new(&scene, &sight.camera, sight.size, sight.radius);
    let mut refinement = Refinement::new(sight.effect, &shot, SCRAMBLINGS, order.seed);
    let mut best: Option<Truth> = None;
    while refinement.samples() < order.samples {
        let each = (refinement.samples() / SCRAMBLINGS).max(1);
        let left = (order.samples - refinement.samples()).div_ceil(SCRAMBLINGS);
        let overtaken = || orders.is_overtaken_by(|newer| !newer.goes_on(&order));
        refinement.refine(each.min(left), |_, _| !overtaken(), |_| {});
        if overtaken() {
            break;
        }
        if let Some(newer) = orders.take_where(|newer| newer.goes_on(&order)) {
            order = newer;
        }
        let estimate = refinement.estimate();
        if estimate.samples <= known {
            continue;
        }
        let noise = estimate.noise_relmse(exposure(sight.effect, &estimate.mean)).unwrap_or(f64::NAN).sqrt();
        let samples = estimate.samples;
        let truth = Truth {
            sight: sight.clone(),
            image: order.developed(estimate.mean),
            samples,
            noise,
            seconds: start.elapsed().as_secs_f64(),
        };
        tell(News::Truth(truth.clone()));
        best = Some(truth);
    }
    Ok(best)
}
