//! What a medium does to light between a cell and its neighbours.
//!
//! The way to a neighbour lies in the cell up to a share of it, and in the neighbour from there on;
//! collisions happen where they lie. The share is chosen so that in a medium that is the same everywhere the
//! squared distance between two collisions is on average `2 / sigma^2`, as it is on exponential flights,
//! whatever the length of a cell. Light that collides in its cell and is scattered there may collide there
//! again: the sum of all of that is a geometric series, so that one iteration takes light on by a cell, be a
//! cell as many mean free paths long as it may.
//!
//! In truth the mean length of the way through a body of even light that shines on it from everywhere depends
//! on its form alone, not on how it scatters (Blanco and Fournier 2003), since what enters a dense body
//! mostly turns back at once. Here, where all that collides in a cell does so in its middle, that way grows
//! with extinction. So from a thinner cell only as much enters a denser one as keeps even light even where
//! nothing is absorbed, and of the rest as much turns back as half a space of the medium reflects of diffuse
//! light.
//!
//! Billeter, Sintorn and Assarsson 2012, equation (3), lets all collisions happen in the cell that light
//! leaves and takes what is scattered on to a neighbour: each collision costs at least the length of a cell,
//! in dense media many times what it should.

use super::lattice::{CLASSES, DISTANCES, mean};
use std::sync::LazyLock;

/// How collisions are counted.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Factors {
    /// Where they happen, as above.
    #[default]
    Placed,
    /// In the cell that light leaves, as the paper has it: `sigma d` of the mean distance. Of light that
    /// would go on, less than nothing is left where that is above 1.
    Linear,
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
    /// Of light that collides on its way out, what sets out again in all directions, over all collisions in
    /// the cell.
    pub again: f32,
    /// Mean length of the way in the cell of light that sets out from it.
    pub track_out: f32,
    /// That of light that sets out again.
    pub track_again: f32,
    /// That of light that comes from each kind of neighbour.
    pub tracks_in: [f32; CLASSES],
    /// That of light that a surface on the way to each kind of neighbour sends back.
    pub tracks_back: [f32; CLASSES],
    /// What it would send towards each kind if nothing were absorbed and light were even, over fluence.
    pub even: [f32; CLASSES],
    /// What goes in of diffuse light that a surface sends into it.
    pub opens: f32,
    /// What half a space of its medium reflects of diffuse light.
    pub turns: f32,
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
        let tracks_in = [0, 1, 2].map(|class| track(class, enters[class]));
        let sets_out = left.max(LEAST).recip();
        let way = sets_out * (track_out + mean(|class| leaves[class] * tracks_in[class]));
        let whole = mean(|class| DISTANCES[class]);
        let way = way.max(0.999 * whole);
        Self {
            streams: leaves,
            scatters: leaves,
            enters,
            albedo,
            again: albedo / (1.0 - albedo + albedo * left).max(LEAST),
            track_out,
            track_again: track_out,
            tracks_in,
            tracks_back: [0, 1, 2].map(|class| track(class, leaves[class])),
            even: leaves.map(|leaves| leaves * sets_out / way),
            opens: (whole / way).min(1.0),
            turns: reflectance(albedo),
        }
    }

    /// What of light from a cell that goes to this one, a neighbour of a kind, goes in; the rest
    /// [`turns`](Self::turns) back. What passes straight through does not turn.
    pub fn lets_in(&self, from: &Self, class: usize) -> f32 {
        // Of extinction without end neither sends anything.
        let share =
            if from.even[class] > self.even[class] { self.even[class] / from.even[class] } else { 1.0 };
        share.max(self.enters[class])
    }

    /// The same with other factors.
    pub fn by(factors: Factors, extinction: f32, albedo: f32) -> Self {
        if factors == Factors::Placed {
            return Self::new(extinction, albedo);
        }
        let passes = 1.0 - extinction * mean(|class| DISTANCES[class]);
        Self {
            streams: [passes; CLASSES],
            scatters: [1.0; CLASSES],
            enters: [1.0; CLASSES],
            albedo,
            again: albedo,
            track_out: track(passes, extinction, mean(|class| DISTANCES[class])),
            track_again: 0.0,
            tracks_in: [0.0; CLASSES],
            tracks_back: [0.0; CLASSES],
            even: [1.0; CLASSES],
            opens: 1.0,
            turns: 0.0,
        }
    }
}

/// What half a space of a medium reflects of diffuse light: the spherical albedo of isotropic scattering, to
/// 2 % (Hapke 1981, equation 39).
pub fn reflectance(albedo: f32) -> f32 {
    let gamma = (1.0 - albedo).max(0.0).sqrt();
    (1.0 - gamma) / (1.0 + gamma) * (1.0 - gamma / (3.0 + 3.0 * gamma))
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

/// Shares of the way to a neighbour that lie in the cell, by extinction; between them [`own_share`] is
/// linear.
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

/// Mean squared distance to the next collision of light that sets out alike in all directions, over
/// `2 / extinction^2`: the sum over the steps of a walk whose direction is kept, where a collision on the
/// second part of a way is in the cell beyond.
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
