//! The thread that refines truth for as long as nobody moves: path traced on all cores but one, kept for each view.

use super::caught::caught;
use super::desk::News;
use super::mailbox::Mailbox;
use super::pictures::Developed;
use super::subject::Subject;
use crate::methods::TRUTH;
use crate::output::message;
use crate::render::picture::Exposure;
use anyhow::Result;
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::path::{Refinement, Shot, Taken};
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
    /// What tells the scene from what its files made at another time.
    pub contents: String,
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
    /// A scene that was read again is the same one where its files are.
    fn eq(&self, other: &Self) -> bool {
        (&self.source, self.effect, &self.contents) == (&other.source, other.effect, &other.contents)
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
    /// One half of it against the other.
    pub ceiling: Scores,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Truth that is kept for when its view comes back.
struct Kept {
    truth: Truth,
    /// What it goes on from; nothing where there was no room.
    taken: Option<Taken>,
    seed: u32,
}

/// Views of which truth is kept, where there is room.
const KEPT: usize = 32;
/// Bytes of all that is kept: images, and what they go on from.
const ROOM: usize = 256 << 20;
/// The most samples of each scrambling in a pass: what is under way is lost when hands move.
const PASS: u32 = 16;

/// Refines what is ordered until the mailbox is closed.
pub fn run(orders: &Mailbox<Order>, tell: &(dyn Fn(News) + Sync)) {
    let threads =
        std::thread::available_parallelism().map_or(1, |cores| cores.get().saturating_sub(1).max(1));
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool,
        Err(error) => return tell(News::Refused(format!("truth: {error}"))),
    };
    let mut known: Vec<Kept> = Vec::new();
    while let Some(order) = orders.take() {
        let same = |kept: &Kept| (&kept.truth.sight, kept.seed) == (&order.sight, order.seed);
        let mut kept = known.iter().position(same).map(|index| known.remove(index));
        if let Some(Kept { truth, .. }) = &mut kept {
            truth.image = order.developed(Planes::clone(&truth.image.values));
            tell(News::Truth(truth.clone()));
        }
        let doing = format!("truth of {} of {}", order.sight.effect, order.sight.source);
        match caught(&doing, || pool.install(|| refine(orders, order, &mut kept, tell))) {
            Ok(()) => {}
            Err(error) => tell(News::Refused(format!("truth: {}", message(&error)))),
        }
        known.extend(kept);
        make_room(&mut known, ROOM);
    }
}

/// Forgets the oldest truth where there is more than is kept or fits into so many bytes, and before that what the oldest goes on from.
/// The newest image stays, since it is being looked at.
fn make_room(known: &mut Vec<Kept>, room: usize) {
    let images = |known: &[Kept]| known.iter().map(|kept| kept.truth.image.size()).sum::<usize>();
    while known.len() > KEPT || (known.len() > 1 && images(known) > room) {
        known.remove(0);
    }
    let mut room = room.saturating_sub(images(known));
    for kept in known.iter_mut().rev() {
        let size = kept.taken.as_ref().map_or(0, Taken::size);
        match room.checked_sub(size) {
            Some(left) => room = left,
            None => kept.taken = None,
        }
    }
}

/// Refines truth from what is kept of it until there are samples enough or there is another order, and tells of each pass that
/// has more samples than are known. An order of the same sight that is only shown otherwise, or wants other numbers of samples,
/// goes on with what there is.
fn refine(
    orders: &Mailbox<Order>,
    mut order: Order,
    kept: &mut Option<Kept>,
    tell: &(dyn Fn(News) + Sync),
) -> Result<()> {
    let known = kept.as_ref().map_or(0, |kept| kept.truth.samples);
    if known >= order.samples {
        return Ok(());
    }
    let sight = order.sight.clone();
    let Some(subject) = sight.subject.upgrade() else { return Ok(()) };
    let scene = subject.traced(sight.time, &sight.lights)?;
    let shot = Shot::new(&scene, &sight.camera, sight.size, sight.radius);
    let (before, mut seconds) = match kept.as_mut().map(|kept| (kept.taken.take(), kept.truth.seconds)) {
        Some((Some(taken), seconds)) => (Some(taken), seconds),
        _ => (None, 0.0),
    };
    let mut refinement = match before {
        Some(taken) => Refinement::going_on(sight.effect, &shot, taken),
        None => Refinement::new(sight.effect, &shot, SCRAMBLINGS, order.seed),
    };
    while refinement.samples() < order.samples {
        let each = (refinement.samples() / SCRAMBLINGS).clamp(1, PASS);
        let left = (order.samples - refinement.samples()).div_ceil(SCRAMBLINGS);
        let overtaken = || orders.is_overtaken_by(|newer| !newer.goes_on(&order));
        let (began, taken) = (Instant::now(), refinement.taken());
        refinement.refine(each.min(left), |_, _| !overtaken(), |_| {});
        if overtaken() {
            // Some pixels lack samples of the pass.
            if let Some(kept) = kept.as_mut().filter(|kept| kept.truth.samples == taken.samples()) {
                kept.taken = Some(taken);
            }
            break;
        }
        seconds += began.elapsed().as_secs_f64();
        if let Some(newer) = orders.take_where(|newer| newer.goes_on(&order)) {
            order = newer;
        }
        let estimate = refinement.estimate();
        if estimate.samples <= known {
            continue;
        }
        let scale = exposure(sight.effect, &estimate.mean);
        let noise = estimate.noise_relmse(scale).unwrap_or(f64::NAN).sqrt();
        let [one, other] = refinement.halves().map(|half| exposed(&half, scale));
        let ceiling = Scores::new(&one, &other);
        let samples = estimate.samples;
        let image = order.developed(estimate.mean);
        let truth = Truth { sight: sight.clone(), image, samples, noise, ceiling, seconds };
        tell(News::Truth(truth.clone()));
        *kept = Some(Kept { truth, taken: None, seed: order.seed });
    }
    if let Some(kept) = kept.as_mut().filter(|kept| kept.truth.samples == refinement.samples()) {
        kept.taken.get_or_insert_with(|| refinement.taken());
    }
    Ok(())
}

#[cfg(test)]
mod tests;
