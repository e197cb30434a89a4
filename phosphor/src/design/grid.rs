//! Rates on a grid, with what a material of such rates would send at each key frame.
//!
//! Steps of the rate equation are products: of the decay's factor and of one for each group of bands. All
//! factors of an animation are tabulated, so that a step of a point of the grid takes no exponential. Points
//! that differ in their decay alone lie side by side, so that what is done for all is done for several at
//! once.

use super::Rates;
use super::problem::{LightStep, Problem};
use deepshade_glow::spectrum::Bands;
use rayon::prelude::*;

/// The thesis' Table 8.2: rates are `SCALE 2^b`, ten values of `b` from 0 to 5 for decay and from 0 to 12 for
/// excitation.
pub const SCALE: f64 = 1e-3;
pub const THESIS_STEPS: usize = 10;
const DECAY_EXPONENT: f64 = 5.0 / 9.0;
const EXCITATION_EXPONENT: f64 = 12.0 / 9.0;
/// The thesis' decays end at 0.032 per second, though its materials go on to 0.251: as many more as reach
/// 0.32.
const DECAYS: usize = 16;
/// The thesis' excitation rates, and none.
const EXCITATIONS: usize = THESIS_STEPS + 1;
/// Bands share an excitation rate in three groups: the grid has as many points for eight bands as for RGB.
const GROUPS: usize = 3;
const BLOCKS: usize = EXCITATIONS * EXCITATIONS * EXCITATIONS;
/// Responses whose squared sine is below this are taken for one.
const ALIKE: f64 = 1e-9;

/// One value for each decay.
type Lanes = [f64; DECAYS];

/// All points of the grid: blocks of the same excitation, of all decays.
pub struct Grid {
    bands: Bands,
    keys: usize,
    /// `[blocks][keys]`: decay times excited share at each key, scaled to length 1 over the keys.
    directions: Vec<Lanes>,
    /// `[blocks]`: the lengths.
    lengths: Vec<Lanes>,
    /// `[blocks][bands]`: the part of what is wanted that lies along a direction; negative where none of it
    /// can be sent.
    along: Vec<Lanes>,
}

/// The decays of the grid.
pub fn decays() -> Lanes {
    std::array::from_fn(|step| SCALE * (DECAY_EXPONENT * step as f64).exp2())
}

/// The excitation rates of the grid: none, then the thesis'.
pub fn excitations() -> [f64; EXCITATIONS] {
    let rate = |step: usize| SCALE * (EXCITATION_EXPONENT * (step - 1) as f64).exp2();
    std::array::from_fn(|step| if step == 0 { 0.0 } else { rate(step) })
}

/// The group of each band.
fn groups(bands: Bands) -> &'static [usize] {
    match bands {
        Bands::Rgb => &[0, 1, 2],
        Bands::Eight => &[0, 0, 0, 1, 1, 2, 2, 2],
    }
}

impl Grid {
    pub fn new(problem: &Problem) -> Self {
        let light = Light::new(problem);
        let blocks: Vec<Block> =
            (0..BLOCKS).into_par_iter().map(|block| light.block(problem, block)).collect();
        let mut grid = Self {
            bands: problem.bands,
            keys: problem.keys,
            directions: Vec::with_capacity(BLOCKS * problem.keys),
            lengths: Vec::with_capacity(BLOCKS),
            along: Vec::with_capacity(BLOCKS * problem.bands.count()),
        };
        for block in blocks {
            grid.directions.extend(block.directions);
            grid.lengths.push(block.lengths);
            grid.along.extend(block.along);
        }
        grid
    }

    /// Decay times excited share of a point at each key.
    pub fn response(&self, point: usize) -> Vec<f64> {
        let (block, lane) = (point / DECAYS, point % DECAYS);
        self.directions(block).iter().map(|key| key[lane] * self.lengths[block][lane]).collect()
    }

    /// All points.
    pub const fn points() -> std::ops::Range<usize> {
        0..BLOCKS * DECAYS
    }

    /// The best points of one state, each the best of its decay.
    pub fn best(&self, count: usize) -> Vec<Vec<Rates>> {
        self.best_of_decays().into_iter().take(count).map(|(_, point)| vec![self.rates(point)]).collect()
    }

    /// The best pairs of points. From the best point of each decay its best partner is searched, from that
    /// its best partner, and so on until nothing gets better.
    pub fn best_pairs(&self, count: usize) -> Vec<Vec<Rates>> {
        let climb = |(_, start): (f64, usize)| {
            let (mut first, mut second) = (start, start);
            let mut best = 0.0;
            loop {
                let (explained, partner) = self.partner(first);
                if explained <= best {
                    return (best, first, second);
                }
                (best, first, second) = (explained, partner, first);
            }
        };
        let mut pairs: Vec<(f64, usize, usize)> = self.best_of_decays().into_par_iter().map(climb).collect();
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        pairs.dedup_by_key(|pair| (pair.1.min(pair.2), pair.1.max(pair.2)));
        let rates = |(_, a, b): (f64, usize, usize)| vec![self.rates(a), self.rates(b)];
        pairs.into_iter().take(count).map(rates).collect()
    }

    /// The rates of a point.
    pub fn rates(&self, point: usize) -> Rates {
        let steps = steps(point / DECAYS);
        let excitation = groups(self.bands).iter().map(|group| excitations()[steps[*group]]).collect();
        Rates { decay: decays()[point % DECAYS], excitation }
    }

    /// Whether the thesis' grid has a point.
    pub fn is_of_thesis(point: usize) -> bool {
        point % DECAYS < THESIS_STEPS && steps(point / DECAYS).iter().all(|step| *step > 0)
    }

    fn directions(&self, block: usize) -> &[Lanes] {
        &self.directions[block * self.keys..][..self.keys]
    }

    fn along(&self, block: usize) -> &[Lanes] {
        let bands = self.bands.count();
        &self.along[block * bands..][..bands]
    }

    /// For each decay the point that explains most, and the squares that it explains; the best decay first.
    fn best_of_decays(&self) -> Vec<(f64, usize)> {
        let mut best: Vec<(f64, usize)> = (0..DECAYS).map(|decay| (0.0, decay)).collect();
        for block in 0..BLOCKS {
            let mut explained = [0.0; DECAYS];
            for along in self.along(block) {
                explained.iter_mut().zip(along).for_each(|(sum, along)| *sum += square(along.max(0.0)));
            }
            keep_better(&mut best, &explained, block);
        }
        best.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        best
    }

    /// The point that explains most beside another, and the squares that both explain.
    fn partner(&self, first: usize) -> (f64, usize) {
        let (own, lane) = (first / DECAYS, first % DECAYS);
        let direction: Vec<f64> = self.directions(own).iter().map(|key| key[lane]).collect();
        let first_along: Vec<f64> = self.along(own).iter().map(|band| band[lane]).collect();
        let mut best: Vec<(f64, usize)> = (0..DECAYS).map(|decay| (0.0, decay)).collect();
        for block in 0..BLOCKS {
            let mut cosines = [0.0; DECAYS];
            for (key, own) in self.directions(block).iter().zip(&direction) {
                cosines.iter_mut().zip(key).for_each(|(cosine, key)| *cosine += key * own);
            }
            let mut explained = [0.0; DECAYS];
            for (along, first) in self.along(block).iter().zip(&first_along) {
                for lane in 0..DECAYS {
                    explained[lane] += explained_by_both(*first, along[lane], cosines[lane]);
                }
            }
            keep_better(&mut best, &explained, block);
        }
        best.into_iter().max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))).expect("a grid has points")
    }
}

fn keep_better(best: &mut [(f64, usize)], explained: &Lanes, block: usize) {
    for (lane, (best, explained)) in best.iter_mut().zip(explained).enumerate() {
        if *explained > best.0 {
            *best = (*explained, block * DECAYS + lane);
        }
    }
}

/// The squares of a band that non-negative amounts of two directions explain, which see these parts of it and
/// have this cosine.
fn explained_by_both(one: f64, other: f64, cosine: f64) -> f64 {
    let (left_of_one, left_of_other) = (one - cosine * other, other - cosine * one);
    let sine = 1.0 - cosine * cosine;
    let both = (one * left_of_one + other * left_of_other) / sine.max(ALIKE);
    let alone = square(one.max(other).max(0.0));
    if sine > ALIKE && left_of_one >= 0.0 && left_of_other >= 0.0 { both } else { alone }
}

const fn square(value: f64) -> f64 {
    value * value
}

/// The step of each group's excitation rate.
const fn steps(block: usize) -> [usize; GROUPS] {
    [block % EXCITATIONS, block / EXCITATIONS % EXCITATIONS, block / EXCITATIONS / EXCITATIONS]
}

/// Points of the same excitation rates.
struct Block {
    directions: Vec<Lanes>,
    lengths: Lanes,
    along: Vec<Lanes>,
}

/// A place's light as factors, one for each of its steps.
struct Light(Vec<Vec<Factors>>);

struct Factors {
    /// Irradiance of each group.
    groups: [f64; GROUPS],
    /// `exp(-rate irradiance seconds)` of each group and excitation rate.
    charged: [[f64; EXCITATIONS]; GROUPS],
    /// `exp(-decay seconds)`.
    decayed: Lanes,
    key: Option<usize>,
}

impl Light {
    fn new(problem: &Problem) -> Self {
        let factors = |step: &LightStep| {
            let mut light = [0.0; GROUPS];
            groups(problem.bands).iter().zip(&step.light).for_each(|(group, value)| light[*group] += value);
            Factors {
                groups: light,
                charged: light.map(|light| excitations().map(|rate| (-rate * light * step.seconds).exp())),
                decayed: decays().map(|decay| (-decay * step.seconds).exp()),
                key: step.key,
            }
        };
        Self(problem.tracks.iter().map(|track| track.iter().map(factors).collect()).collect())
    }

    /// The points of all decays with the same excitation rates.
    fn block(&self, problem: &Problem, block: usize) -> Block {
        let mut directions = self.responses(problem.keys, block);
        let mut squares = [0.0; DECAYS];
        for key in &directions {
            squares.iter_mut().zip(key).for_each(|(sum, value)| *sum += value * value);
        }
        let lengths = squares.map(f64::sqrt);
        let scales = lengths.map(|length| if length > 0.0 { 1.0 / length } else { 0.0 });
        for key in &mut directions {
            key.iter_mut().zip(scales).for_each(|(value, scale)| *value *= scale);
        }
        let along = |band: &Vec<f64>| {
            let mut along = [0.0; DECAYS];
            for (key, wanted) in directions.iter().zip(band) {
                along.iter_mut().zip(key).for_each(|(sum, value)| *sum += value * wanted);
            }
            along
        };
        let along = problem.wanted.iter().map(along).collect();
        Block { directions, lengths, along }
    }

    /// Decay times excited share at each key.
    fn responses(&self, keys: usize, block: usize) -> Vec<Lanes> {
        let (steps, decays) = (steps(block), decays());
        let rates = steps.map(|step| excitations()[step]);
        let mut responses = vec![[0.0; DECAYS]; keys];
        for track in &self.0 {
            let mut shares = [0.0; DECAYS];
            for Factors { groups, charged, decayed, key } in track {
                let charge: f64 = groups.iter().zip(rates).map(|(light, rate)| light * rate).sum();
                let left: f64 = charged.iter().zip(steps).map(|(factors, step)| factors[step]).product();
                for i in 0..DECAYS {
                    let rest = charge / (charge + decays[i]);
                    shares[i] = rest + (shares[i] - rest) * (left * decayed[i]);
                }
                if let Some(key) = key {
                    responses[*key] = std::array::from_fn(|i| decays[i] * shares[i]);
                }
            }
        }
        responses
    }
}

#[cfg(test)]
mod tests {
    use super::super::response::{fitted, response};
    use super::super::{Key, TargetPoint};
    use super::*;
    use deepshade_glow::file::MaterialFile;

    fn place(bands: Bands) -> TargetPoint {
        let light =
            |frame: usize| (0..bands.count()).map(|band| ((frame * (band + 2)) % 7) as f64 * 0.3).collect();
        let key = |frame: usize| Key {
            frame,
            radiance: (0..bands.count()).map(|band| ((frame + 3 * band) % 5) as f64).collect(),
        };
        TargetPoint {
            bands,
            dt: 0.4,
            irradiance: (0..60).map(light).collect(),
            reflected: vec![],
            keys: vec![key(59), key(3), key(20), key(40)],
        }
    }

    /// What the tables of factors give is what steps of the rate equation give.
    #[test]
    fn responses_are_those_of_the_rate_equation() {
        for bands in [Bands::Rgb, Bands::Eight] {
            let problem = Problem::new(&[place(bands), TargetPoint { dt: 0.7, ..place(bands) }]);
            let grid = Grid::new(&problem);
            for point in Grid::points().step_by(977) {
                let expected = response(&problem, &grid.rates(point));
                let found = grid.response(point);
                assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{point}: {found:?}");
            }
        }
    }

    /// What pairs are said to explain is what the best functions of their rates do.
    #[test]
    fn pairs_explain_what_they_are_said_to() {
        for bands in [Bands::Rgb, Bands::Eight] {
            let problem = Problem::new(&[place(bands)]);
            let grid = Grid::new(&problem);
            let left = |points: &[usize]| {
                let rates: Vec<Rates> = points.iter().map(|point| grid.rates(*point)).collect();
                fitted(&problem, &rates).cost()
            };
            for first in Grid::points().step_by(5003) {
                let (explained, partner) = grid.partner(first);
                let cost = left(&[first, partner]);
                assert!((problem.size() - explained - cost).abs() < 1e-6 * problem.size(), "{first}");
                let other = Grid::points().step_by(97).map(|point| left(&[first, point]));
                assert!(other.fold(f64::INFINITY, f64::min) >= cost * (1.0 - 1e-9), "{first}");
            }
        }
    }

    #[test]
    fn the_grid_covers_the_measured_materials() {
        let (decays, excitations) = (decays(), excitations());
        for state in MaterialFile::presets().materials.iter().flat_map(|material| &material.states) {
            assert!((decays[0]..=decays[DECAYS - 1]).contains(&state.decay), "{state:?}: {decays:?}");
            // A rate below the first is between it and none.
            for rate in &state.excitation {
                assert!((0.0..=excitations[EXCITATIONS - 1]).contains(rate), "{state:?}: {excitations:?}");
            }
        }
        assert!((decays[THESIS_STEPS - 1] - 0.032).abs() < 1e-12, "the thesis' last");
        assert!(
            excitations[1] == 0.001 && (excitations[EXCITATIONS - 1] - 4.096).abs() < 1e-12,
            "{excitations:?}"
        );
    }
}
