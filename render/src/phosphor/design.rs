//! A material by how it should look (thesis, section 8.6): colours that places have at key frames of an animation,
//! whose light is known, become parameters.
//!
//! What is sent is linear in the re-radiation functions, so that only rates are searched for: to any rates the best
//! functions are known at once (variable projection, Golub and Pereyra 1973). [`grid`] tries rates on a grid that
//! contains the thesis' and covers its Table 8.1, [`refinement`] goes on from the best of them. Several places may share a
//! material. What the thesis does is
//! beside it, as the rival: the same grid with functions on a grid, too.

mod grid;
mod problem;
mod propagation;
mod refinement;
mod response;
mod thesis;

pub use propagation::{Edit, Feature, Propagated, PropagationError, Reach};
pub use thesis::thesis_grid;

use super::material::{Material, State};
use super::spectrum::Bands;
use grid::Grid;
use problem::Problem;

/// The most states that are designed.
pub const MAX_STATES: usize = 2;
/// From how many of the best points of the grid the search goes on.
const STARTS: usize = 4;

/// A place of an animated scene, and how it should look.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The bands of irradiance, colours and the material.
    pub bands: Bands,
    /// Between frames, in seconds.
    pub dt: f64,
    /// Irradiance of each frame, one value a band. Before the first frame it was dark for long.
    pub irradiance: Vec<Vec<f64>>,
    /// Radiance that the surface reflects in each frame, one value a band, where that is part of how it looks; else there are none.
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

/// Why nothing can be designed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// A number of states that is not designed.
    #[error("{0} states: 1 or {MAX_STATES} can be designed")]
    States(usize),
    /// No place.
    #[error("a design needs one place at least")]
    NoPlaces,
    /// Places that no material can have in common.
    #[error("places of the same material differ in their bands")]
    Unlike,
    /// No constraint.
    #[error("a design needs one key frame at least")]
    NoKeys,
    /// A key at a frame that there is not.
    #[error("a key at frame {frame}: there are frames 0 to {last}")]
    Frame {
        /// The key's.
        frame: usize,
        /// The last that there is.
        last: usize,
    },
    /// Two keys of a place at one frame.
    #[error("place {place} has two keys at frame {frame}")]
    Twice {
        /// The place's, counted from 1.
        place: usize,
        /// The keys'.
        frame: usize,
    },
    /// Reflected light of some frames, and not of others.
    #[error("reflected light of {0} frames, irradiance of {1}")]
    Reflected(usize, usize),
    /// A list of the wrong length, or a number that makes no sense.
    #[error("{what} is {values:?}, not {bands} finite numbers that are at least 0")]
    Values {
        /// Of what.
        what: &'static str,
        /// The values.
        values: Vec<f64>,
        /// How many there must be.
        bands: usize,
    },
    /// A time between frames that makes no sense.
    #[error("{0} s between frames: it must be finite and above 0")]
    TimeStep(f64),
}

/// The rates of a state: everything of it but its re-radiation function.
#[derive(Clone, Debug, PartialEq)]
struct Rates {
    decay: f64,
    /// One a band.
    excitation: Vec<f64>,
}

impl Design {
    /// The material of one or two states, the faster first, that looks most like what is wanted, at all places together.
    ///
    /// # Errors
    /// If the number of states is neither, or a place makes no sense, or they have not the same bands.
    pub fn new(name: &str, places: &[Place], states: usize) -> Result<Self, DesignError> {
        if !(1..=MAX_STATES).contains(&states) {
            return Err(DesignError::States(states));
        }
        checked(places)?;
        let problem = Problem::new(places);
        let grid = Grid::new(&problem);
        let starts = if states == 1 { grid.best(STARTS) } else { grid.best_pairs(STARTS) };
        let (rates, fitted) = refinement::best(&problem, &starts);
        let state = |(rates, emission): (Rates, Vec<f64>)| State {
            decay: rates.decay,
            excitation: rates.excitation,
            emission,
        };
        let mut states: Vec<State> = rates.into_iter().zip(fitted.emission).map(state).collect();
        // As fits have them; means of materials are of states of the same place.
        states.sort_by(|a, b| b.decay.total_cmp(&a.decay));
        let material = Material { name: name.into(), bands: problem.bands, doubt: None, states };
        Ok(Self { material, residual: fitted.cost })
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
fn checked(places: &[Place]) -> Result<(), DesignError> {
    let first = places.first().ok_or(DesignError::NoPlaces)?;
    if places.iter().any(|place| place.bands != first.bands) {
        return Err(DesignError::Unlike);
    }
    (1..).zip(places).try_for_each(|(number, place)| place.check(number))
}

impl Place {
    /// Whether the place of this number makes sense.
    fn check(&self, place: usize) -> Result<(), DesignError> {
        let bands = self.bands.count();
        if !(self.dt.is_finite() && self.dt > 0.0) {
            return Err(DesignError::TimeStep(self.dt));
        }
        if self.keys.is_empty() {
            return Err(DesignError::NoKeys);
        }
        let irradiance = self.irradiance.iter().map(|values| ("irradiance", values));
        let keys = self.keys.iter().map(|key| ("a key's radiance", &key.radiance));
        let reflected = self.reflected.iter().map(|values| ("reflected light", values));
        if !self.reflected.is_empty() && self.reflected.len() != self.irradiance.len() {
            return Err(DesignError::Reflected(self.reflected.len(), self.irradiance.len()));
        }
        for (what, values) in irradiance.chain(keys).chain(reflected) {
            if values.len() != bands || !values.iter().all(|value| value.is_finite() && *value >= 0.0) {
                return Err(DesignError::Values { what, values: values.clone(), bands });
            }
        }
        for (index, key) in self.keys.iter().enumerate() {
            if key.frame >= self.irradiance.len() {
                return Err(DesignError::Frame {
                    frame: key.frame,
                    last: self.irradiance.len().saturating_sub(1),
                });
            }
            if self.keys[..index].iter().any(|other| other.frame == key.frame) {
                return Err(DesignError::Twice { place, frame: key.frame });
            }
        }
        Ok(())
    }

    /// The emission that is wanted at each key, a list a band: what should be seen less what is reflected. It may be
    /// negative where more is reflected than should be seen.
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
