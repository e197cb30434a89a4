//! What a medium does to light between a cell and its neighbours.
//!
//! The way to a neighbour lies in the cell up to a share of it, and in the neighbour from there on; collisions happen
//! where they lie. The share is chosen so that in a medium that is the same everywhere the squared distance between two
//! collisions is on average `2 / sigma^2`, as it is on exponential flights, whatever the length of a cell. Light that
//! collides in its cell and is scattered there may collide there again: the sum of all of that is a geometric series,
//! so that one iteration takes light on by a cell, be a cell as many mean free paths long as it may.
//!
//! Billeter, Sintorn and Assarsson 2012, equation (3), lets all collisions happen in the cell that light leaves and
//! takes what is scattered on to a neighbour: each collision costs at least the length of a cell, in dense media many
//! times what it should.

use super::lattice::{CLASSES, DISTANCES, mean};
use std::sync::LazyLock;

/// How collisions are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Factors {
    /// Where they happen, as above.
    #[default]
    Placed,
    /// In the cell that light leaves: `1 - exp(-sigma d)` of what goes to a neighbour at a distance of `d`.
    Exponential,
    /// As the paper has it: `sigma d` of the mean distance. Of light that would go on, less than nothing is left where
    /// that is above 1.
    Linear,
}

impl Factors {
    /// All, the paper's last.
    pub const ALL: [Self; 3] = [Self::Placed, Self::Exponential, Self::Linear];

    /// Its name in figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Placed => "placed",
            Self::Exponential => "exponential",
            Self::Linear => "linear",
        }
    }
}

/// What a cell does to light of one colour. Lengths are in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Of light that sets out to a neighbour of each kind, what leaves the cell.
    pub streams: [f32; CLASSES],
    /// Of light that was scattered in the cell, what leaves it towards each kind.
    pub scatters: [f32; CLASSES],
    /// Of light that comes from a neighbour of each kind, what keeps its direction.
    pub enters: [f32; CLASSES],
    /// Of a collision there, what is scattered.
    pub albedo: f32,
    /// Of light that collides on its way out, what sets out again in all directions, over all collisions in the cell.
    pub again: f32,
    /// Mean length of the way in the cell of light that sets out from it.
    pub track_out: f32,
    /// That of light that sets out again.
    pub track_again: f32,
    /// That of light that comes from each kind of neighbour.
    pub tracks_in: [f32; CLASSES],
    /// That of light that a surface on the way to each kind of neighbour sends back.
    pub tracks_back: [f32; CLASSES],
}

impl Flight {
    /// Of a cell with so much extinction per length of a cell.
    pub fn new(extinction: f32, albedo: f32) -> Self {
        let within = extinction * own_share(extinction);
        let beyond = extinction - within;
        let leaves = DISTANCES.map(|distance| (-within * distance).exp());
        let enters = DISTANCES.map(|distance| (-beyond * distance).exp());
        let left = mean(|class| leaves[class]);
        let track = |class: usize, passes: f32| track(passes, extinction, 0.5 * DISTANCES[class]);
        let track_out = mean(|class| track(class, leaves[class]));
        Self {
            streams: leaves,
            scatters: leaves,
            enters,
            albedo,
            again: albedo / (1.0 - albedo + albedo * left).max(LEAST),
            track_out,
            track_again: track_out,
            tracks_in: [0, 1, 2].map(|class| track(class, enters[class])),
            tracks_back: [0, 1, 2].map(|class| track(class, leaves[class])),
        }
    }

    /// The same with other factors.
    pub fn by(factors: Factors, extinction: f32, albedo: f32) -> Self {
        let streams = match factors {
            Factors::Placed => return Self::new(extinction, albedo),
            Factors::Exponential => DISTANCES.map(|distance| (-extinction * distance).exp()),
            Factors::Linear => [1.0 - extinction * mean(|class| DISTANCES[class]); CLASSES],
        };
        let passes = mean(|class| streams[class]);
        Self {
            streams,
            scatters: [1.0; CLASSES],
            enters: [1.0; CLASSES],
            albedo,
            again: albedo,
            track_out: track(passes, extinction, mean(|class| DISTANCES[class])),
            track_again: 0.0,
            tracks_in: [0.0; CLASSES],
            tracks_back: [0.0; CLASSES],
        }
    }
}

/// What leaves a cell of any medium at least, so that nothing is divided by 0.
const LEAST: f32 = 1e-20;

/// Less extinction than this per cell counts as none where lengths are asked for.
const CLEAR: f32 = 1e-3;

/// Mean length of a way on which so much passes; `whole` where nothing is lost.
fn track(passes: f32, extinction: f32, whole: f32) -> f32 {
    if extinction > CLEAR { (1.0 - passes) / extinction } else { whole }
}

/// The logarithm to the base 2 of the least extinction of [`table`].
pub const FIRST: f32 = -6.0;
/// Entries of [`table`] for each doubling.
pub const PER_DOUBLING: f32 = 4.0;
/// Entries of [`table`], up to an extinction of 2^26.
pub const ENTRIES: usize = 129;

/// Shares of the way to a neighbour that lie in the cell, by extinction; between them [`own_share`] is linear.
pub fn table() -> &'static [f32; ENTRIES] {
    static TABLE: LazyLock<[f32; ENTRIES]> = LazyLock::new(|| {
        std::array::from_fn(|i| exact_share(f64::from(FIRST + i as f32 / PER_DOUBLING).exp2()))
    });
    &TABLE
}

/// The share of the way to a neighbour that lies in the cell.
pub fn own_share(extinction: f32) -> f32 {
    let at = ((extinction.max(1e-30).log2() - FIRST) * PER_DOUBLING).clamp(0.0, (ENTRIES - 1) as f32);
    let low = (at as usize).min(ENTRIES - 2);
    let part = at - low as f32;
    table()[low] * (1.0 - part) + table()[low + 1] * part
}

/// The share that makes the second moment of a flight right, by bisection.
fn exact_share(extinction: f64) -> f32 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if moment_ratio(extinction, middle) > 1.0 { low = middle } else { high = middle }
    }
    (0.5 * (low + high)) as f32
}

/// Mean squared distance to the next collision of light that sets out alike in all directions, over `2 / extinction^2`:
/// the sum over the steps of a walk whose direction is kept, where a collision on the second part of a way is in the
/// cell beyond.
fn moment_ratio(extinction: f64, share: f64) -> f64 {
    let mean = |of: &dyn Fn(f64) -> f64| -> f64 {
        let weights = [6.0 / 21.0, 48.0 / 105.0, 72.0 / 280.0];
        weights.iter().zip([1.0f64, 2.0, 3.0]).map(|(weight, squared)| weight * of(squared.sqrt())).sum()
    };
    let passes = |length: f64| (-extinction * length).exp();
    let collides = mean(&|d| -(-extinction * d).exp_m1());
    let straight = mean(&|d| d * passes(d));
    let first = mean(&|d| d * passes(d * share));
    let squared = mean(&|d| d * d * passes(d * share));
    (squared / collides + 2.0 * straight * first / (collides * collides)) * extinction * extinction / 2.0
}
