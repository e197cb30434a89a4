//! A material by how it should look (thesis, section 8.6): colours that places have at key frames of an
//! animation, whose light is known, become parameters.
//!
//! What is sent is linear in the re-radiation functions, so that only rates are searched for: to any rates
//! the best functions are known at once (variable projection, Golub and Pereyra 1973). [`grid`] tries rates
//! on a grid that contains the thesis' and covers its Table 8.1, [`refinement`] goes on from the best of
//! them. Several places may share a material. What the thesis does is beside it, as the rival: the same grid
//! with functions on a grid, too.

mod grid;
mod problem;
mod propagation;
mod refinement;
mod response;
mod thesis;

pub use propagation::{Edit, Feature, Propagated, PropagationError, Reach};
pub use thesis::thesis_grid;

use deepshade_glow::material::{Material, State, is_amount};
use deepshade_glow::spectrum::Bands;
use grid::Grid;
use problem::Problem;

/// The most states that are designed.
pub const MAX_STATES: usize = 2;
/// From how many of the best points of the grid the search goes on.
const STARTS: usize = 4;

/// A place of an animated scene, and how it should look.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetPoint {
    /// The bands of irradiance, colours and the material.
    pub bands: Bands,
    /// Between frames, in seconds.
    pub dt: f64,
    /// Irradiance of each frame, one value a band. Before the first frame it was dark for long.
    pub irradiance: Vec<Vec<f64>>,
    /// Radiance that the surface reflects in each frame, one value a band, where that is part of how it
    /// looks; else there are none.
    pub reflected: Vec<Vec<f64>>,
    /// How it should look, at one frame at least.
    pub keys: Vec<Key>,
}

/// How a place should look at a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The frame, from 0 on; light of this frame is reflected, but has not yet excited.
    pub frame: usize,
    /// Radiance, one value a band.
    pub radiance: Vec<f64>,
}

/// A designed material.
#[derive(Clone, Debug)]
pub struct Design {
    /// The material.
    pub material: Material,
    /// The sum of squares of what its radiance is off at the key frames, over all bands (equation 8.7).
    pub residual: f64,
}

/// Why nothing can be designed, in words.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DesignError(String);

/// The rates of a state: everything of it but its re-radiation function.
#[derive(Clone, Debug, PartialEq)]
struct Rates {
    decay: f64,
    /// One a band.
    excitation: Vec<f64>,
}

impl Design {
    /// The material of one or two states, the faster first, that looks most like what is wanted, at all
    /// places together.
    ///
    /// # Errors
    /// If the number of states is neither, or a place makes no sense, or they have not the same bands.
    pub fn new(name: &str, places: &[TargetPoint], states: usize) -> Result<Self, DesignError> {
        if !(1..=MAX_STATES).contains(&states) {
            return Err(DesignError(format!("{states} states: 1 or {MAX_STATES} can be designed")));
        }
        checked(places)?;
        let problem = Problem::new(places);
        let grid = Grid::new(&problem);
        let starts = if states == 1 { grid.best(STARTS) } else { grid.best_pairs(STARTS) };
        let (rates, fitted) = refinement::best(&problem, &starts);
        let residual = fitted.cost();
        let state = |(rates, emission): (Rates, Vec<f64>)| State {
            decay: rates.decay,
            excitation: rates.excitation,
            emission,
        };
        let mut states: Vec<State> = rates.into_iter().zip(fitted.emission).map(state).collect();
        // As fits have them; means of materials are of states of the same place.
        states.sort_by(|a, b| b.decay.total_cmp(&a.decay));
        let material = Material { name: name.into(), bands: problem.bands, doubt: None, states };
        Ok(Self { material, residual })
    }

    /// The rates that ended at a bound of the search, in words: better ones may lie beyond.
    pub fn at_bounds(&self) -> Vec<String> {
        let of_state = |(number, state): (usize, &State)| {
            let rates = refinement::at_bounds(state).into_iter();
            rates.map(move |rate| format!("state {number}: {rate}"))
        };
        (1..).zip(&self.material.states).flat_map(of_state).collect()
    }
}

/// Whether a material can be designed for some places.
fn checked(places: &[TargetPoint]) -> Result<(), DesignError> {
    let fails = |fault: &str| DesignError(fault.to_owned());
    let first = places.first().ok_or_else(|| fails("a design needs one place at least"))?;
    if places.iter().any(|place| place.bands != first.bands) {
        return Err(fails("places of the same material differ in their bands"));
    }
    (1..).zip(places).try_for_each(|(number, place)| place.check(number).map_err(DesignError))
}

impl TargetPoint {
    /// Whether the place of this number makes sense; else what does not.
    fn check(&self, place: usize) -> Result<(), String> {
        let (bands, frames) = (self.bands.count(), self.irradiance.len());
        if !(self.dt.is_finite() && self.dt > 0.0) {
            return Err(format!("{} s between frames: it must be finite and above 0", self.dt));
        }
        if self.keys.is_empty() {
            return Err("a design needs one key frame at least".to_owned());
        }
        if !self.reflected.is_empty() && self.reflected.len() != frames {
            return Err(format!(
                "reflected light of {} frames, irradiance of {frames}",
                self.reflected.len()
            ));
        }
        let irradiance = self.irradiance.iter().map(|values| ("irradiance", values));
        let keys = self.keys.iter().map(|key| ("a key's radiance", &key.radiance));
        let reflected = self.reflected.iter().map(|values| ("reflected light", values));
        for (what, values) in irradiance.chain(keys).chain(reflected) {
            if values.len() != bands || !values.iter().copied().all(is_amount) {
                return Err(format!("{what} is {values:?}, not {bands} finite numbers that are at least 0"));
            }
        }
        for (index, Key { frame, .. }) in self.keys.iter().enumerate() {
            if *frame >= frames {
                let last = frames.saturating_sub(1);
                return Err(format!("a key at frame {frame}: there are frames 0 to {last}"));
            }
            if self.keys[..index].iter().any(|other| other.frame == *frame) {
                return Err(format!("place {place} has two keys at frame {frame}"));
            }
        }
        Ok(())
    }

    /// The emission that is wanted at each key, a list a band: what should be seen less what is reflected. It
    /// may be negative where more is reflected than should be seen.
    fn wanted(&self) -> Vec<Vec<f64>> {
        let reflected =
            |key: &Key, band: usize| self.reflected.get(key.frame).map_or(0.0, |radiance| radiance[band]);
        let of_band = |band| self.keys.iter().map(|key| key.radiance[band] - reflected(key, band)).collect();
        (0..self.bands.count()).map(of_band).collect()
    }

    /// The last frame that a key is at.
    fn last(&self) -> usize {
        self.keys.iter().map(|key| key.frame).max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests;
