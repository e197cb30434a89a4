//! Rates on a grid, with what a material of such rates would send at each key frame.
//!
//! Steps of the rate equation are products: of the decay's factor and of one for each group of bands. All factors of an
//! animation are tabulated, so that a step of a point of the grid takes no exponential.

use super::super::spectrum::Bands;
use super::refinement::Columns;
use super::{Place, Rates};
use rayon::prelude::*;

/// The thesis' Table 8.2: rates are `SCALE 2^b`, ten values of `b` from 0 to 5 for decay and from 0 to 12 for
/// excitation.
pub const SCALE: f64 = 1e-3;
pub const THESIS_STEPS: usize = 10;
const DECAY_EXPONENT: f64 = 5.0 / 9.0;
const EXCITATION_EXPONENT: f64 = 12.0 / 9.0;
/// The thesis' decays end at 0.032 per second, though its materials go on to 0.251: as many more as reach 0.32.
const DECAYS: usize = 16;
/// The thesis' excitation rates, and none.
const EXCITATIONS: usize = THESIS_STEPS + 1;
/// Bands share an excitation rate in three groups: the grid has as many points for eight bands as for RGB.
const GROUPS: usize = 3;
const POINTS: usize = DECAYS * EXCITATIONS * EXCITATIONS * EXCITATIONS;

/// All points of the grid.
pub struct Grid<'a> {
    place: &'a Place,
    wanted: Vec<Vec<f64>>,
    /// Decay times excited share at each key, a list a point: what is sent but for the re-radiation function.
    pub responses: Vec<Vec<f64>>,
}

/// The decays of the grid.
pub fn decays() -> [f64; DECAYS] {
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

impl<'a> Grid<'a> {
    pub fn new(place: &'a Place) -> Self {
        let light = Light::new(place);
        let excited: Vec<usize> = (0..POINTS / DECAYS).collect();
        let responses =
            excited.par_iter().flat_map_iter(|excitation| light.responses(place, *excitation)).collect();
        Self { place, wanted: place.wanted(), responses }
    }

    /// The best points of one state, each the best of its decay.
    pub fn best(&self, count: usize) -> Vec<Vec<Rates>> {
        let mut best: Vec<(f64, usize)> = self.best_of_decays();
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        best.into_iter().take(count).map(|(_, point)| vec![self.rates(point)]).collect()
    }

    /// The best pairs of points. From the best point of each decay its best partner is searched, from that its best
    /// partner, and so on until nothing gets better.
    pub fn best_pairs(&self, count: usize) -> Vec<Vec<Rates>> {
        let climb = |(_, start): (f64, usize)| {
            let (mut first, mut second) = (start, start);
            let mut best = f64::INFINITY;
            loop {
                let (cost, partner) = self.partner(first);
                if cost >= best {
                    return (best, first, second);
                }
                (best, first, second) = (cost, partner, first);
            }
        };
        let mut pairs: Vec<(f64, usize, usize)> = self.best_of_decays().into_par_iter().map(climb).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        pairs.dedup_by_key(|pair| (pair.1.min(pair.2), pair.1.max(pair.2)));
        let rates = |(_, a, b): (f64, usize, usize)| vec![self.rates(a), self.rates(b)];
        pairs.into_iter().take(count).map(rates).collect()
    }

    /// The rates of a point.
    pub fn rates(&self, point: usize) -> Rates {
        let steps = steps(point / DECAYS);
        let excitation = groups(self.place.bands).iter().map(|group| excitations()[steps[*group]]).collect();
        Rates { decay: decays()[point % DECAYS], excitation }
    }

    /// Whether the thesis' grid has a point.
    pub fn is_of_thesis(&self, point: usize) -> bool {
        point % DECAYS < THESIS_STEPS && steps(point / DECAYS).iter().all(|step| *step > 0)
    }

    /// For each decay the least cost of its points, and which has it.
    fn best_of_decays(&self) -> Vec<(f64, usize)> {
        let cost = |point: usize| Columns::new([&self.responses[point]]).cost(&self.wanted);
        let best = |decay: usize| {
            let points = (decay..POINTS).step_by(DECAYS).map(|point| (cost(point), point));
            points.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a decay has points")
        };
        (0..DECAYS).into_par_iter().map(best).collect()
    }

    /// The point that explains most beside another, and the cost of both.
    fn partner(&self, first: usize) -> (f64, usize) {
        let cost =
            |point: usize| Columns::new([&self.responses[first], &self.responses[point]]).cost(&self.wanted);
        let points = (0..POINTS).map(|point| (cost(point), point));
        points.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a grid has points")
    }
}

/// The step of each group's excitation rate.
fn steps(excitation: usize) -> [usize; GROUPS] {
    [excitation % EXCITATIONS, excitation / EXCITATIONS % EXCITATIONS, excitation / EXCITATIONS / EXCITATIONS]
}

/// An animation's light as factors.
struct Light {
    /// Irradiance of each frame and group.
    groups: Vec<[f64; GROUPS]>,
    /// `exp(-rate irradiance dt)` of each frame, group and excitation rate.
    factors: Vec<[[f64; EXCITATIONS]; GROUPS]>,
    /// `exp(-decay dt)`.
    decayed: [f64; DECAYS],
    /// The keys' frames, ascending, with their places in the list of keys.
    keys: Vec<(usize, usize)>,
}

impl Light {
    fn new(place: &Place) -> Self {
        let of_group = |frame: &Vec<f64>| {
            let mut light = [0.0; GROUPS];
            groups(place.bands).iter().zip(frame).for_each(|(group, value)| light[*group] += value);
            light
        };
        let lit: Vec<[f64; GROUPS]> = place.irradiance[..=place.last()].iter().map(of_group).collect();
        let factors = |light: &[f64; GROUPS]| {
            light.map(|light| excitations().map(|rate| (-rate * light * place.dt).exp()))
        };
        let mut keys: Vec<(usize, usize)> = place.keys.iter().map(|key| key.frame).zip(0..).collect();
        keys.sort_unstable();
        Self {
            factors: lit.iter().map(factors).collect(),
            groups: lit,
            decayed: decays().map(|decay| (-decay * place.dt).exp()),
            keys,
        }
    }

    /// What the points of all decays, with the same excitation rates, send at each key.
    fn responses(&self, place: &Place, excitation: usize) -> Vec<Vec<f64>> {
        let (steps, decays) = (steps(excitation), decays());
        let rates = steps.map(|step| excitations()[step]);
        let mut responses = vec![vec![0.0; place.keys.len()]; DECAYS];
        let mut shares = [0.0; DECAYS];
        let mut keys = self.keys.iter().peekable();
        for (frame, (light, factors)) in self.groups.iter().zip(&self.factors).enumerate() {
            if let Some((_, key)) = keys.next_if(|(at, _)| *at == frame) {
                (0..DECAYS).for_each(|i| responses[i][*key] = decays[i] * shares[i]);
            }
            let charge: f64 = light.iter().zip(rates).map(|(light, rate)| light * rate).sum();
            let left: f64 = factors.iter().zip(steps).map(|(factors, step)| factors[step]).product();
            for i in 0..DECAYS {
                let rest = charge / (charge + decays[i]);
                shares[i] = rest + (shares[i] - rest) * (left * self.decayed[i]);
            }
        }
        responses
    }
}

#[cfg(test)]
mod tests {
    use super::super::Key;
    use super::super::refinement::response;
    use super::*;

    /// What the tables of factors give is what steps of the rate equation give.
    #[test]
    fn responses_are_those_of_the_rate_equation() {
        for bands in [Bands::Rgb, Bands::Eight] {
            let light = |frame: usize| {
                (0..bands.count()).map(|band| ((frame * (band + 2)) % 7) as f64 * 0.3).collect()
            };
            let key = |frame| Key { frame, radiance: vec![1.0; bands.count()] };
            let place = Place {
                bands,
                dt: 0.4,
                irradiance: (0..60).map(light).collect(),
                reflectance: vec![0.0; bands.count()],
                keys: vec![key(59), key(3), key(20)],
            };
            let grid = Grid::new(&place);
            for point in (0..POINTS).step_by(977) {
                let expected = response(&place, &grid.rates(point));
                let found = &grid.responses[point];
                assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{point}: {found:?}");
            }
        }
    }

    #[test]
    fn the_grid_covers_the_measured_materials() {
        let (decays, excitations) = (decays(), excitations());
        assert!(decays[0] < 0.015 && decays[DECAYS - 1] > 0.251, "{decays:?}");
        assert!((decays[THESIS_STEPS - 1] - 0.032).abs() < 1e-12, "the thesis' last");
        assert!(
            excitations[1] == 0.001 && (excitations[EXCITATIONS - 1] - 4.096).abs() < 1e-12,
            "{excitations:?}"
        );
    }
}
