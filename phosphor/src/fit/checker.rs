//! A camera's colours by a photographed colour chart, after the thesis' calibration by what is known (section
//! 8.4.2).
//!
//! The thesis photographs known light through known filters and solves for what is not known by least squares
//! (Kirk and O'Brien 2011). Here what is not known are the nine numbers that make linear sRGB of the camera's
//! red, green and blue, and known are patches of a colour chart, through filters or without. No matrix makes
//! the eye of a camera: what it leaves of the patches is stated. Nor is it the same for all spectra that look
//! alike, which is why a material that glows in narrow bands is better measured through filters.

pub mod chart;
mod files;

use super::measurement::Shot;
use super::photographs::PhotographsError;
use crate::table::TableError;
use glam::{DMat3, DVec3};

/// The file that lists what was photographed of the chart.
pub(super) const CHECKER: &str = "checker.csv";
/// How many colours there must be: those of three would always fit, and show no mistake.
pub(super) const LEAST: usize = 6;
/// A channel of which no more than this part is its own, the rest being a mixture of the other two, tells no
/// colours. Of the classic chart it is a tenth or more; greys alone leave what noise they have.
const OWN: f64 = 0.02;

/// A colour that a camera saw and that is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// What it is called.
    pub name: String,
    /// Linear red, green and blue of the camera, over the exposure's gain.
    pub seen: [f64; 3],
    /// Its linear sRGB colour; negative parts are of colours that screens lack.
    pub known: [f64; 3],
}

/// What makes linear sRGB of a camera's colours. The unit is that of the known colours: of a chart in
/// daylight 1 is a white diffuser in that light.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    /// Row by row; each row makes one channel of linear sRGB.
    pub matrix: [[f64; 3]; 3],
    /// The part of each of the camera's channels that is no mixture of the other two, over all colours.
    pub own: [f64; 3],
    /// How many colours it was found from.
    pub patches: usize,
    /// The root mean square of what is left of their channels, for as many values as were not needed.
    pub rms: f64,
    /// The colour of which most is left, and the length of that.
    pub worst: (String, f64),
}

/// Why there is no such matrix.
#[derive(Debug, thiserror::Error)]
pub enum CheckerError {
    /// The list of patches is at fault.
    #[error("{CHECKER}")]
    Table(#[from] TableError),
    /// The photograph of the chart is.
    #[error("{CHECKER}")]
    Photographs(#[from] PhotographsError),
    /// There are too few.
    #[error("{CHECKER}: {0} patches, at least {LEAST} are needed: list more of the chart")]
    TooFew(usize),
    /// A value is no number, or what was seen is negative.
    #[error(
        "{CHECKER}: patch {0} was seen as {1:?} and is known as {2:?}: numbers must be finite, and seen ones \
        not negative; of a dark patch take a larger rectangle, or less of a black level"
    )]
    Value(String, [f64; 3], [f64; 3]),
    /// The colours are of one or two kinds only.
    #[error(
        "{CHECKER}: the patches do not tell the camera's colours apart: its {0} is the same mixture of the \
        other channels in all of them. are greys alone listed, or is a channel empty?"
    )]
    Alike(&'static str),
}

impl Checker {
    /// The matrix with the least sum of squared differences between known colours and what it makes of those
    /// that were seen. All patches weigh the same.
    ///
    /// # Errors
    /// If there are fewer than six, a value is not finite, one that was seen is negative, or they do not tell
    /// the camera's channels apart.
    pub fn new(patches: &[Patch]) -> Result<Self, CheckerError> {
        let count = patches.len();
        if count < LEAST {
            return Err(CheckerError::TooFew(count));
        }
        let finite = |colour: &[f64; 3]| colour.iter().all(|value| value.is_finite());
        let sound = |patch: &&Patch| {
            finite(&patch.seen) && finite(&patch.known) && patch.seen.iter().all(|value| *value >= 0.0)
        };
        if let Some(Patch { name, seen, known }) = patches.iter().find(|patch| !sound(patch)) {
            return Err(CheckerError::Value(name.clone(), *seen, *known));
        }
        // In units of each channel's own length, so that a camera of faint blue is no worse off.
        let length = |channel: usize| patches.iter().map(|p| p.seen[channel].powi(2)).sum::<f64>().sqrt();
        let lengths = DVec3::from([0, 1, 2].map(length));
        let names = ["red", "green", "blue"];
        if let Some(dark) = (0..3).find(|channel| lengths[*channel] <= 0.0) {
            return Err(CheckerError::Alike(names[dark]));
        }
        let seen = |patch: &Patch| DVec3::from(patch.seen) / lengths;
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let square: DMat3 = patches.iter().map(|patch| outer(seen(patch), seen(patch))).sum();
        let inverse = square.inverse();
        // One over the diagonal is the share of a channel's square that the other two do not explain.
        let share = |channel: usize| inverse.col(channel)[channel].recip().max(0.0).sqrt();
        let own = [0, 1, 2].map(share);
        if let Some(alike) = (0..3).find(|channel| own[*channel] <= OWN) {
            return Err(CheckerError::Alike(names[alike]));
        }
        let product: DMat3 = patches.iter().map(|patch| outer(DVec3::from(patch.known), seen(patch))).sum();
        let found = product * inverse * DMat3::from_diagonal(lengths.recip());
        let matrix = found.transpose().to_cols_array_2d();
        let mut checker = Self { matrix, own, patches: count, rms: 0.0, worst: (String::new(), 0.0) };
        let left =
            |patch: &Patch| (DVec3::from(checker.colour(patch.seen)) - DVec3::from(patch.known)).length();
        let squares: f64 = patches.iter().map(|patch| left(patch).powi(2)).sum();
        // Three of each channel's values are used up by its three numbers.
        let rms = (squares / (3 * (count - 3)) as f64).sqrt();
        let worst = patches.iter().max_by(|a, b| left(a).total_cmp(&left(b)));
        let worst = worst.map_or_else(|| (String::new(), 0.0), |patch| (patch.name.clone(), left(patch)));
        (checker.rms, checker.worst) = (rms, worst);
        Ok(checker)
    }

    /// The linear sRGB colour of one that the camera saw.
    pub fn colour(&self, seen: [f64; 3]) -> [f64; 3] {
        self.matrix.map(|row| row.iter().zip(seen).map(|(a, b)| a * b).sum())
    }

    /// A photograph in linear sRGB. Its channels share noise then, which a fit takes for independent; how
    /// well the matrix is known is not in it.
    pub fn shot(&self, shot: &Shot) -> Shot {
        let noise =
            |row: [f64; 3]| row.iter().zip(shot.noise).map(|(a, b)| (a * b).powi(2)).sum::<f64>().sqrt();
        Shot { value: self.colour(shot.value), noise: self.matrix.map(noise), ..*shot }
    }
}

#[cfg(test)]
mod tests;
