//! The thread that refines truth for as long as nothing moves: path traced on all cores but one, kept for
//! each view.

use super::catch_panic::catch_panic;
use super::display_image::DisplayImage;
use super::request_slot::RequestSlot;
use super::subject::PreparedScene;
use super::workers::{SendUpdate, Update};
use crate::methods::TRUTH;
use crate::output::message;
use crate::render::picture::Exposure;
use anyhow::Result;
use deepshade_render::metrics::{Scores, exposed, exposure};
use deepshade_render::path::estimate::SCRAMBLINGS;
use deepshade_render::path::{Refinement, Shot, Taken};
use deepshade_render::scene::{Camera, Glow, Light, SceneSource};
use deepshade_shaders::{Effect, Planes};
use std::sync::{Arc, Weak};
use std::time::Instant;

/// What truth is of.
#[derive(Clone)]
pub struct ViewKey {
    /// Where the scene is from.
    pub source: SceneSource,
    /// What is computed of it.
    pub effect: Effect,
    /// How often the user had opened a scene when it was read: its files may be other ones each time.
    pub scenes_opened: u32,
    /// What keeps light in it, where that was designed.
    pub glow: Option<Arc<Glow>>,
    /// The scene, as long as the window shows it: truth that is kept keeps no scenes.
    pub subject: Weak<PreparedScene>,
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

impl PartialEq for ViewKey {
    /// A scene that was completed again, as for another effect in between, is the same one.
    fn eq(&self, other: &Self) -> bool {
        (&self.source, self.scenes_opened, self.effect) == (&other.source, other.scenes_opened, other.effect)
            && self.glow == other.glow
            && (self.camera, self.time, &self.lights, self.radius, self.size)
                == (other.camera, other.time, &other.lights, other.radius, other.size)
    }
}

/// Truth that is wanted.
#[derive(Clone, PartialEq)]
pub struct Request {
    /// Of what.
    pub view_key: ViewKey,
    /// How it is exposed; by default as suits it.
    pub exposure: Option<Exposure>,
    /// How much brighter than suits it, stops.
    pub stops: f32,
    /// With how many samples of a pixel.
    pub samples: u32,
    /// Chooses random numbers.
    pub seed: u32,
}

impl Request {
    /// Whether what is traced for another request is what this one wants, and it wants samples.
    fn goes_on(&self, other: &Self) -> bool {
        (&self.view_key, self.seed) == (&other.view_key, other.seed) && self.samples > 0
    }

    fn shown(&self, values: Planes) -> DisplayImage {
        let suits = || Exposure::new(self.view_key.effect, &values, None).brighter(self.stops);
        let exposure = self.exposure.unwrap_or_else(suits);
        DisplayImage::new(TRUTH, values, exposure)
    }
}

/// Truth as far as it is known.
#[derive(Clone)]
pub struct Truth {
    /// Of what.
    pub view_key: ViewKey,
    /// The image.
    pub image: DisplayImage,
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
    /// What it goes on from.
    taken: Taken,
    seed: u32,
}

/// Bytes of all that is kept.
const ROOM: usize = 256 << 20;
/// The most samples of each scrambling in a pass: a pass under way is lost when the view changes.
const PASS: u32 = 16;

/// Refines what is requested until the slot is closed.
pub fn run(requests: &RequestSlot<Request>, send: SendUpdate<'_>) {
    let threads =
        std::thread::available_parallelism().map_or(1, |cores| cores.get().saturating_sub(1).max(1));
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool,
        Err(error) => return send(Update::Error(format!("truth: {error}"))),
    };
    let mut known: Vec<Kept> = Vec::new();
    while let Some(request) = requests.take() {
        let same = |kept: &Kept| (&kept.truth.view_key, kept.seed) == (&request.view_key, request.seed);
        let mut kept = known.iter().position(same).map(|index| known.remove(index));
        if let Some(Kept { truth, .. }) = &mut kept {
            truth.image = request.shown(Planes::clone(&truth.image.values));
            send(Update::Truth(truth.clone()));
        }
        let doing = format!("truth of {} of {}", request.view_key.effect, request.view_key.source);
        match catch_panic(&doing, || pool.install(|| refine(requests, request, kept, send))) {
            Ok(kept) => known.extend(kept),
            Err(error) => send(Update::Error(format!("truth: {}", message(&error)))),
        }
        make_room(&mut known, ROOM);
    }
}

/// Forgets the oldest truth that does not fit into so many bytes. The newest stays, since it is being looked
/// at.
fn make_room(known: &mut Vec<Kept>, room: usize) {
    let size = |known: &[Kept]| -> usize {
        known.iter().map(|kept| kept.truth.image.size() + kept.taken.size()).sum()
    };
    while known.len() > 1 && size(known) > room {
        known.remove(0);
    }
}

/// Refines truth from what is kept of it until there are samples enough or there is another request, and
/// sends it after each pass. A request of the same view that is only shown otherwise, or wants other numbers
/// of samples, goes on with what there is.
fn refine(
    requests: &RequestSlot<Request>,
    mut request: Request,
    kept: Option<Kept>,
    send: SendUpdate<'_>,
) -> Result<Option<Kept>> {
    let known = kept.as_ref().map_or(0, |kept| kept.truth.samples);
    let view_key = request.view_key.clone();
    let Some(subject) = view_key.subject.upgrade().filter(|_| known < request.samples) else {
        return Ok(kept);
    };
    let scene = subject.traced(view_key.time, &view_key.lights)?;
    let shot = Shot::new(&scene, &view_key.camera, view_key.size, view_key.radius);
    let (mut refinement, mut truth) = match kept {
        Some(Kept { truth, taken, .. }) => (Refinement::going_on(view_key.effect, &shot, taken), Some(truth)),
        None => (Refinement::new(view_key.effect, &shot, SCRAMBLINGS, request.seed), None),
    };
    let seed = request.seed;
    let keep = |truth: Option<Truth>, taken| truth.map(|truth| Kept { truth, taken, seed });
    while refinement.samples() < request.samples {
        let each = (refinement.samples() / SCRAMBLINGS).clamp(1, PASS);
        let left = (request.samples - refinement.samples()).div_ceil(SCRAMBLINGS);
        let overtaken = || requests.is_overtaken_by(|newer| !newer.goes_on(&request));
        let (began, taken) = (Instant::now(), refinement.taken());
        refinement.refine(each.min(left), |_, _| !overtaken(), |_| {});
        if overtaken() {
            // Some pixels lack samples of the pass.
            return Ok(keep(truth, taken));
        }
        if let Some(newer) = requests.take_where(|newer| newer.goes_on(&request)) {
            request = newer;
        }
        let estimate = refinement.estimate();
        let scale = exposure(view_key.effect, &estimate.mean);
        let [one, other] = refinement.halves().map(|half| exposed(&half, scale));
        let newest = Truth {
            view_key: view_key.clone(),
            samples: estimate.samples,
            noise: estimate.noise_relmse(scale).unwrap_or(f64::NAN).sqrt(),
            ceiling: Scores::new(&one, &other),
            seconds: truth.map_or(0.0, |truth| truth.seconds) + began.elapsed().as_secs_f64(),
            image: request.shown(estimate.mean),
        };
        send(Update::Truth(newest.clone()));
        truth = Some(newest);
    }
    Ok(keep(truth, refinement.taken()))
}

#[cfg(test)]
mod tests;
