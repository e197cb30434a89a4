//! The best re-radiation functions of given rates, and rates that are better than those of the grid.

use super::super::least_squares::{Unknown, minimum};
use super::super::rate::Scheme;
use super::{Place, Rates};
use rayon::prelude::*;

/// Rates stay within these bounds, per second.
const DECAY: [f64; 2] = [1e-5, 10.0];
const EXCITATION: [f64; 2] = [0.0, 100.0];
/// How much leaving the start weighs beside the wanted colours: what key frames do not determine stays as it was.
const STAYING: f64 = 1e-6;

/// Re-radiation functions of given rates.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// One a state, one value a band.
    pub emission: Vec<Vec<f64>>,
    /// The sum of squares that is left.
    pub cost: f64,
}

/// What each of `N` states sends at the keys but for its re-radiation function.
pub struct Columns<'a, const N: usize> {
    columns: [&'a [f64]; N],
    /// Products of the columns with one another.
    products: [[f64; N]; N],
}

impl<'a, const N: usize> Columns<'a, N> {
    pub fn new(columns: [&'a Vec<f64>; N]) -> Self {
        let columns = columns.map(Vec::as_slice);
        Self { columns, products: columns.map(|a| columns.map(|b| dot(a, b))) }
    }

    /// The least sum of squares that is left, over all bands.
    pub fn cost(&self, wanted: &[Vec<f64>]) -> f64 {
        wanted.iter().map(|band| dot(band, band) - self.gain(&self.solution(band), band)).sum()
    }

    /// The non-negative amounts of the columns that explain a band best.
    fn solution(&self, band: &[f64]) -> [f64; N] {
        let explained = self.columns.map(|column| dot(column, band));
        let alone = |index: usize| {
            let mut amounts = [0.0; N];
            let square = self.products[index][index];
            amounts[index] = if square > 0.0 { (explained[index] / square).max(0.0) } else { 0.0 };
            amounts
        };
        if N == 1 {
            return alone(0);
        }
        let [[a, b], [_, d]] = [0, 1].map(|i| [0, 1].map(|j| self.products[i][j]));
        let determinant = a * d - b * b;
        let mut both = [0.0; N];
        both[0] = (explained[0] * d - explained[1] * b) / determinant;
        both[1] = (explained[1] * a - explained[0] * b) / determinant;
        // Columns that are nearly the same are one.
        if determinant > 1e-12 * a * d && both.iter().all(|amount| *amount >= 0.0) {
            return both;
        }
        let [first, second] = [alone(0), alone(1)];
        if self.gain(&first, band) >= self.gain(&second, band) { first } else { second }
    }

    /// By how much amounts that are best, or best alone, lower the sum of squares.
    fn gain(&self, amounts: &[f64; N], band: &[f64]) -> f64 {
        self.columns.iter().zip(amounts).map(|(column, amount)| amount * dot(column, band)).sum()
    }
}

/// The best re-radiation functions of states of given rates.
pub fn fitted(place: &Place, rates: &[Rates]) -> Fitted {
    let responses: Vec<Vec<f64>> = rates.iter().map(|rates| response(place, rates)).collect();
    let wanted = place.wanted();
    let amounts: Vec<Vec<f64>> = wanted.iter().map(|band| amounts(&responses, band)).collect();
    let emission: Vec<Vec<f64>> =
        (0..rates.len()).map(|state| amounts.iter().map(|amounts| amounts[state]).collect()).collect();
    let cost = residuals(&responses, &amounts, &wanted).map(|off| off * off).sum();
    Fitted { emission, cost }
}

fn amounts(responses: &[Vec<f64>], band: &[f64]) -> Vec<f64> {
    match responses {
        [one] => Columns::new([one]).solution(band).to_vec(),
        [one, other, ..] => Columns::new([one, other]).solution(band).to_vec(),
        [] => vec![],
    }
}

/// What is sent less what is wanted, band by band and key by key.
fn residuals(responses: &[Vec<f64>], amounts: &[Vec<f64>], wanted: &[Vec<f64>]) -> impl Iterator<Item = f64> {
    wanted.iter().zip(amounts).flat_map(move |(band, amounts)| {
        let sent = move |key: usize| responses.iter().zip(amounts).map(|(r, a)| r[key] * a).sum::<f64>();
        band.iter().enumerate().map(move |(key, wanted)| sent(key) - wanted)
    })
}

/// Decay times excited share at each key, of a state of given rates.
pub fn response(place: &Place, rates: &Rates) -> Vec<f64> {
    let mut response = vec![0.0; place.keys.len()];
    let mut share = 0.0;
    for (frame, light) in place.irradiance[..=place.last()].iter().enumerate() {
        for (response, key) in response.iter_mut().zip(&place.keys) {
            if key.frame == frame {
                *response = rates.decay * share;
            }
        }
        let charge = light.iter().zip(&rates.excitation).map(|(light, rate)| light * rate).sum();
        share = Scheme::Exact.step(share, charge, rates.decay, place.dt);
    }
    response
}

/// The best rates that are found from any of the starts, with their functions; never worse than the best start.
pub fn best(place: &Place, starts: &[Vec<Rates>]) -> (Vec<Rates>, Fitted) {
    let tried =
        starts.par_iter().flat_map_iter(|start| [Some(start.clone()), refined(place, start)]).flatten();
    let fitted = tried.map(|rates| (fitted(place, &rates), rates)).map(|(fitted, rates)| (rates, fitted));
    fitted.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost)).expect("a start at least")
}

/// The rates where the sum of squares is least near a start.
fn refined(place: &Place, start: &[Rates]) -> Option<Vec<Rates>> {
    let wanted = place.wanted();
    let bands = place.bands.count();
    let size = wanted.iter().flatten().map(|value| value * value).sum::<f64>().sqrt();
    let unknowns: Vec<Unknown> = start.iter().flat_map(unknowns).collect();
    let values = bands * place.keys.len();
    let residuals_of = |x: &[f64], residuals_of: &mut [f64]| {
        let responses: Vec<Vec<f64>> =
            unpacked(x, bands).iter().map(|rates| response(place, rates)).collect();
        let amounts: Vec<Vec<f64>> = wanted.iter().map(|band| amounts(&responses, band)).collect();
        let (off, moved) = residuals_of.split_at_mut(values);
        off.iter_mut().zip(residuals(&responses, &amounts, &wanted)).for_each(|(to, from)| *to = from);
        for ((moved, x), unknown) in moved.iter_mut().zip(x).zip(&unknowns) {
            *moved = STAYING * size * (x - unknown.start) / unknown.scale;
        }
    };
    let found = minimum(&unknowns, values + unknowns.len(), residuals_of).ok()?;
    Some(unpacked(&found.values, bands))
}

/// A state's unknowns: the logarithm of its decay, and its excitation rates.
fn unknowns(rates: &Rates) -> Vec<Unknown> {
    let decay = Unknown { start: rates.decay.ln(), bounds: DECAY.map(f64::ln), scale: 1.0 };
    let excitation = rates.excitation.iter().map(|rate| Unknown {
        start: *rate,
        bounds: EXCITATION,
        scale: rate.max(0.01),
    });
    std::iter::once(decay).chain(excitation).collect()
}

fn unpacked(values: &[f64], bands: usize) -> Vec<Rates> {
    let rates = |values: &[f64]| Rates { decay: values[0].exp(), excitation: values[1..].to_vec() };
    values.chunks(1 + bands).map(rates).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::super::super::least_squares::non_negative;
    use super::super::super::noise::Noise;
    use super::*;

    /// Amounts of two columns are those of the general solver.
    #[test]
    fn two_columns_are_solved_as_by_the_general_solver() {
        let mut noise = Noise::new(3);
        let mut held = 0;
        for _ in 0..500 {
            let [a, b, wanted] = [0; 3].map(|_| (0..4).map(|_| noise.normal()).collect::<Vec<f64>>());
            let found = Columns::new([&a, &b]).solution(&wanted);
            let rows: Vec<Vec<f64>> = a.iter().zip(&b).map(|(a, b)| vec![*a, *b]).collect();
            let expected = non_negative(&rows, &wanted);
            assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
            held += usize::from(found.contains(&0.0));
        }
        assert!((200..450).contains(&held), "bounds held {held} of 500");
    }
}
