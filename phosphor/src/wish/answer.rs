//! The material that comes closest to a wish.

use super::Wish;
use crate::design::{Design, DesignError, Key, TargetPoint};
use crate::simulation::SimulationError;
use deepshade_glow::spectrum::Bands;
use std::f64::consts::LN_2;

/// What was found.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The material, in RGB, and what it is off.
    pub design: Design,
    /// What the place gives back by it in each frame, linear RGB radiance.
    pub reached: Vec<[f64; 3]>,
    /// The root of what is left over that of what is wanted, squares of all keys and colours added up.
    pub off: f64,
}

/// Why there is no material.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WishError {
    /// Nothing is wanted.
    #[error("no key frames")]
    NoKeys,
    /// Nothing but darkness is wanted.
    #[error("all key frames are black")]
    Black,
    /// The place cannot keep what it does not get.
    #[error("no light of lamps reaches this place before the last key frame")]
    Unlit,
    /// The solver refuses.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// What was found cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

impl Wish {
    /// The material of one or two states that comes closest, with a name.
    ///
    /// # Errors
    /// If nothing is wanted that can be reached by any.
    pub fn answer(&self, name: &str, states: usize) -> Result<Answer, WishError> {
        let last = self.keys.last().ok_or(WishError::NoKeys)?.frame;
        let wanted: f64 = self.keys.iter().flat_map(|key| key.radiance()).map(|part| part * part).sum();
        if wanted <= 0.0 {
            return Err(WishError::Black);
        }
        let irradiance = self.light.in_bands(Bands::Rgb);
        if irradiance[..last].iter().flatten().all(|light| *light == 0.0) {
            return Err(WishError::Unlit);
        }
        let keys = self.keys.iter().map(|key| Key { frame: key.frame, radiance: key.radiance().to_vec() });
        let place = TargetPoint {
            bands: Bands::Rgb,
            dt: self.light.dt(),
            irradiance,
            reflected: self.light.reflected().into_iter().map(Vec::from).collect(),
            keys: keys.collect(),
        };
        let design = Design::new(name, &[place], states)?;
        let reached = self.light.designed(&design.material)?;
        let off = (design.residual / wanted).sqrt();
        Ok(Answer { design, reached, off })
    }
}

impl Answer {
    /// How close it comes, and by what: sentences.
    pub fn in_words(&self) -> Vec<String> {
        let close = match 100.0 * self.off {
            off if off < 1.0 => "met: the material is off by less than 1 % of what is wanted".to_owned(),
            off if off < 10.0 => format!("nearly met: the material is off by {off:.1} % of what is wanted"),
            off => format!("not met: the closest material is off by {off:.0} % of what is wanted"),
        };
        let states = self.design.material.states.iter();
        let half: Vec<String> = states.map(|state| format!("{:.1}", LN_2 / state.decay)).collect();
        let lives = if half.len() == 1 { "half life" } else { "half lives" };
        let bounds = self.design.at_bounds().into_iter().map(|rate| format!("{rate}, a bound of the search"));
        [close, format!("{lives} {} s", half.join(" and "))].into_iter().chain(bounds).collect()
    }
}
