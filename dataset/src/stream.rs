//! An endless stream of a training recipe's pairs, rendered while somebody else trains on them; nothing is on
//! disk.
//!
//! Pair `i` is a function of the recipe and `i` alone: view `i % views_per_scene` of scene `i /
//! views_per_scene`. The recipe's families take turns, `scenes` being their shares, and every scene has a
//! seed of its own. A scene without a fit view is passed over for the next of its attempts, the same ones
//! whatever the speed.
//!
//! Threads of the stream's own render several scenes at a time in the order of their numbers, so that one is
//! built while another is rendered, and wait while `room` pairs are there that nobody has
//! [forgotten](Stream::forget_before). They are not rayon's global ones: what the consumer computes there
//! would wait behind whole scenes.

mod ring;
mod scenes;

use crate::{DatasetError, Pair, Recipe, data_version};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use ring::Ring;
use scenes::{Scenes, Use};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

/// Pairs without end.
#[derive(Debug)]
pub struct Stream {
    ring: Arc<Ring>,
}

impl Stream {
    /// Begins to render the pairs of a training recipe of families from number `first` on. At most `room`
    /// pairs are in memory that were not forgotten, and as scenes are rendered whole, at least `room -
    /// views_per_scene + 1` can be asked for at any time.
    ///
    /// # Errors
    /// If the recipe is for testing, holds files or aims at a method's images, `room` is below
    /// `views_per_scene`, or what the recipe's images are given cannot be read.
    pub fn start(recipe: &Recipe, first: usize, room: usize) -> Result<Self, DatasetError> {
        Self::on_threads(recipe, first, room, 0)
    }

    /// [`Stream::start`] with so many threads; 0 for as many as the processor has.
    fn on_threads(recipe: &Recipe, first: usize, room: usize, threads: usize) -> Result<Self, DatasetError> {
        let scenes = Scenes::of(recipe)?;
        let views = recipe.views_per_scene;
        if room < views {
            let what = format!("room for {room} pairs, where a scene has {views}");
            return Err(DatasetError::Stream { number: first, what });
        }
        let ring = Arc::new(Ring::new(first, room, views));
        let of_thread = Arc::clone(&ring);
        let failed = |what: String| DatasetError::Stream { number: first, what };
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| failed(error.to_string()))?;
        std::thread::Builder::new()
            .name("stream".to_owned())
            .spawn(move || render(&scenes, &of_thread, &pool))
            .map_err(|error| failed(error.to_string()))?;
        Ok(Self { ring })
    }

    /// The pair of a number; waits until it is rendered.
    ///
    /// # Errors
    /// If it was forgotten, is further ahead than there is room, or its scene cannot be had.
    pub fn pair(&self, number: usize) -> Result<Arc<Pair>, DatasetError> {
        self.ring.pair(number)
    }

    /// Drops all pairs before a number, which is never asked for again, so that others have room.
    pub fn forget_before(&self, number: usize) {
        self.ring.forget_before(number);
    }

    /// How long [`Stream::pair`] has waited in all.
    pub fn waited(&self) -> Duration {
        self.ring.waited()
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        self.ring.end("it was dropped");
    }
}

/// What tells the pairs of a recipe's stream from those of others: a hash of the recipe and of the version of
/// the data.
pub fn hash(recipe: &Recipe) -> String {
    let described = serde_json::to_vec(recipe).expect("a recipe is plain data");
    let mut hasher = blake3::Hasher::new();
    hasher.update(&described).update(&data_version(recipe.effect).to_le_bytes());
    hasher.finalize().to_hex().to_string()
}

/// The first pairs for validation: always the same, of scenes that the recipe's stream never has.
///
/// # Errors
/// As [`Stream::start`], and if a scene cannot be had.
pub fn validation(recipe: &Recipe, count: usize) -> Result<Vec<Pair>, DatasetError> {
    let scenes = Scenes::of(recipe)?;
    let views = recipe.views_per_scene;
    let of_scene = |number: usize| -> Result<Vec<Pair>, DatasetError> {
        let ready = scenes.ready(number, Use::Validation)?;
        let wanted = views.min(count - number * views);
        ready.staged.each(&ready.planned.views[..wanted], |view| scenes.pair(&ready, view.index))
    };
    let pairs: Result<Vec<Vec<Pair>>, DatasetError> =
        (0..count.div_ceil(views)).into_par_iter().map(of_scene).collect();
    Ok(pairs?.into_iter().flatten().collect())
}

/// Renders what there is room for until the stream ends. This thread only waits; the pool's do the work.
fn render(scenes: &Scenes, ring: &Ring, pool: &ThreadPool) {
    let at_once = pool.current_num_threads().max(2);
    pool.in_place_scope(|scope| {
        while let Some(number) = ring.begin_scene(at_once) {
            scope.spawn(move |_| {
                let made = catch_unwind(AssertUnwindSafe(|| render_scene(scenes, ring, number)));
                match made {
                    Ok(Ok(())) => {}
                    Ok(Err(error)) => ring.end(&error.to_string()),
                    Err(_) => ring.end("its rendering panicked"),
                }
                ring.finish_scene();
            });
        }
    });
}

/// Renders those views of a scene that somebody may ask for.
fn render_scene(scenes: &Scenes, ring: &Ring, number: usize) -> Result<(), DatasetError> {
    let ready = scenes.ready(number, Use::Training)?;
    let first = number * scenes.recipe().views_per_scene;
    ready.staged.each(&ready.planned.views, |view| {
        if ring.wants(first + view.index) {
            ring.put(first + view.index, scenes.pair(&ready, view.index)?);
        }
        Ok(())
    })?;
    Ok(())
}

#[cfg(test)]
mod tests;
