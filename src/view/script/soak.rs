//! A long walk through effects, methods, sizes and views, for what memory is lost on the way.

use super::{is_made, steer};
use crate::arguments::EDGES;
use crate::figures::memory;
use crate::view::window::Window;
use anyhow::Result;
use deepshade_shaders::Effect;
use glam::Vec2;
use std::time::Instant;

/// Pictures at a station, each from another view; truth begins at the last one.
const PICTURES: u32 = 3;

/// How a walk comes on.
pub enum Walk {
    /// It waits for a picture, or for truth.
    Waits,
    /// It goes on.
    GoesOn,
    /// It is over.
    Done,
}

/// A walk.
pub struct Soak {
    stations: Vec<Station>,
    began: Instant,
    /// How many stations were left, in all rounds.
    left: usize,
    /// Pictures of this one.
    seen: u32,
    /// Megabytes after the first round, when everything was needed once, and when that was.
    first: Option<(Option<f64>, Instant)>,
}

/// What is shown for some pictures.
struct Station {
    effect: Effect,
    /// By the first of its methods alone.
    alone: bool,
    size: [usize; 2],
}

impl Soak {
    /// Begins a walk through these effects, or through the one that is shown: by the first methods of each together, and by the
    /// first one alone at another, odd size.
    pub fn begin(effects: &[Effect], window: &mut Window) -> Self {
        let [height, width] = window.state.show.size;
        let odd = [height, width].map(|side| ((side / 2) | 1).max(EDGES.start() + 1));
        let shown = [window.state.show.effect];
        let effects = if effects.is_empty() { &shown } else { effects };
        let stations = |effect: &Effect| {
            [(false, [height, width]), (true, odd)].map(|(alone, size)| Station {
                effect: *effect,
                alone,
                size,
            })
        };
        let stations: Vec<Station> = effects.iter().flat_map(stations).collect();
        stations[0].enter(window);
        Self { stations, began: Instant::now(), left: 0, seen: 0, first: None }
    }

    /// Takes the next step of a walk that lasts so long, and then to the end of a round, the second one or a later one: what memory
    /// grows by is counted between the same stations.
    pub fn go_on(&mut self, seconds: f32, window: &mut Window) -> Result<Walk> {
        let truth_began = !window.state.truth || window.truth_of_picture().is_some();
        if !is_made(window)? || (self.seen == PICTURES && !truth_began) {
            return Ok(Walk::Waits);
        }
        if self.seen < PICTURES {
            self.seen += 1;
            steer(window, |pilot| pilot.orbit(Vec2::new(1f32.to_radians(), 0.0)))?;
            return Ok(Walk::GoesOn);
        }
        (self.left, self.seen) = (self.left + 1, 0);
        let next = self.left % self.stations.len();
        if next == 0 && self.ends_with_round(seconds, window) {
            return Ok(Walk::Done);
        }
        self.stations[next].enter(window);
        Ok(Walk::GoesOn)
    }

    fn ends_with_round(&mut self, seconds: f32, window: &Window) -> bool {
        let (before, since) = *self.first.get_or_insert_with(|| (memory(), Instant::now()));
        if self.left == self.stations.len() || self.began.elapsed().as_secs_f32() < seconds {
            return false;
        }
        if let (Some(before), Some(after)) = (before, memory()) {
            window.measured("memory_growth_mb", after - before);
        }
        window.measured("soak_seconds", since.elapsed().as_secs_f64());
        window.measured("soak_rounds", (self.left / self.stations.len()) as f64);
        true
    }
}

impl Station {
    fn enter(&self, window: &mut Window) {
        window.state.choose_effect(self.effect);
        if self.alone {
            window.state.show.methods.truncate(1);
        }
        window.state.show.size = self.size;
        window.changed();
    }
}
