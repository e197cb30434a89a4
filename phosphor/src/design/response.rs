//! What states of given rates send at the keys, and the re-radiation functions that meet what is wanted best.

use super::Rates;
use super::problem::{LightStep, Problem};

/// Re-radiation functions of given rates.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// One a state, one value a band.
    pub emission: Vec<Vec<f64>>,
    /// What is sent less what is wanted, `[bands][keys]`.
    pub off: Vec<f64>,
}

impl Fitted {
    /// The sum of squares that is left.
    pub fn cost(&self) -> f64 {
        dot(&self.off, &self.off)
    }
}

/// Decay times excited share at each key, of a state of given rates.
pub fn response(problem: &Problem, rates: &Rates) -> Vec<f64> {
    let mut response = vec![0.0; problem.keys];
    for track in &problem.tracks {
        let mut share = 0.0;
        for step in track {
            let charge = rates.charge(step);
            let total = charge + rates.decay;
            let rest = charge / total;
            share = rest + (share - rest) * (-total * step.seconds).exp();
            if let Some(key) = step.key {
                response[key] = rates.decay * share;
            }
        }
    }
    response
}

/// The best re-radiation functions of states of given rates.
pub fn fitted(problem: &Problem, rates: &[Rates]) -> Fitted {
    let responses: Vec<Vec<f64>> = rates.iter().map(|rates| response(problem, rates)).collect();
    let amounts: Vec<Vec<f64>> = problem.wanted.iter().map(|band| amounts(&responses, band)).collect();
    let emission =
        (0..rates.len()).map(|state| amounts.iter().map(|amounts| amounts[state]).collect()).collect();
    let off = problem.wanted.iter().zip(&amounts).flat_map(|(band, amounts)| off(&responses, amounts, band));
    Fitted { emission, off: off.collect() }
}

/// What is sent less what is wanted of a band, at each key.
fn off(responses: &[Vec<f64>], amounts: &[f64], band: &[f64]) -> Vec<f64> {
    let sent = |key: usize| responses.iter().zip(amounts).map(|(r, a)| r[key] * a).sum::<f64>();
    band.iter().enumerate().map(|(key, wanted)| sent(key) - wanted).collect()
}

/// The non-negative amounts of one or two responses that explain a band best.
pub fn amounts(responses: &[Vec<f64>], band: &[f64]) -> Vec<f64> {
    let alone = |response: &[f64]| {
        let square = dot(response, response);
        if square > 0.0 { (dot(response, band) / square).max(0.0) } else { 0.0 }
    };
    let [one, other] = responses else { return responses.iter().map(|response| alone(response)).collect() };
    let (a, b, d) = (dot(one, one), dot(one, other), dot(other, other));
    let (p, q) = (dot(one, band), dot(other, band));
    let determinant = a * d - b * b;
    let both = [(p * d - q * b) / determinant, (q * a - p * b) / determinant];
    // Columns that are nearly the same are one.
    if determinant > 1e-12 * a * d && both.iter().all(|amount| *amount >= 0.0) {
        return both.to_vec();
    }
    let [first, second] = [alone(one), alone(other)];
    if first * p >= second * q { vec![first, 0.0] } else { vec![0.0, second] }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Rates {
    fn charge(&self, step: &LightStep) -> f64 {
        dot(&step.light, &self.excitation)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Key, TargetPoint};
    use super::*;
    use crate::least_squares::non_negative;
    use crate::noise::Noise;
    use deepshade_glow::rate::Scheme;
    use deepshade_glow::spectrum::Bands;

    /// Two responses are explained as by the general solver.
    #[test]
    fn two_responses_are_solved_as_by_the_general_solver() {
        let mut noise = Noise::new(3);
        let mut held = 0;
        for _ in 0..500 {
            let [a, b, wanted] = [0; 3].map(|_| (0..4).map(|_| noise.normal()).collect::<Vec<f64>>());
            let rows: Vec<Vec<f64>> = a.iter().zip(&b).map(|(a, b)| vec![*a, *b]).collect();
            let found = amounts(&[a, b], &wanted);
            let expected = non_negative(&rows, &wanted);
            assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
            held += usize::from(found.contains(&0.0));
        }
        assert!((200..450).contains(&held), "bounds held {held} of 500");
    }

    fn place() -> TargetPoint {
        let light = |frame: usize| [0, 1, 2].map(|band| ((frame / 4 * (band + 2)) % 7) as f64 * 0.3).to_vec();
        let key = |frame| Key { frame, radiance: vec![1.0; 3] };
        let irradiance = (0..60).map(light).collect();
        let keys = vec![key(59), key(3), key(0), key(20)];
        TargetPoint { bands: Bands::Rgb, dt: 0.4, irradiance, reflected: vec![], keys }
    }

    fn rates() -> Rates {
        Rates { decay: 0.07, excitation: vec![0.02, 0.3, 0.11] }
    }

    #[test]
    fn responses_are_those_of_steps_frame_by_frame() {
        let (place, rates) = (place(), rates());
        let found = response(&Problem::new(std::slice::from_ref(&place)), &rates);
        let mut share = 0.0;
        for (frame, light) in place.irradiance.iter().enumerate() {
            if let Some(key) = place.keys.iter().position(|key| key.frame == frame) {
                assert!((found[key] - rates.decay * share).abs() < 1e-12, "{frame}");
            }
            share = Scheme::Exact.step(share, dot(light, &rates.excitation), rates.decay, place.dt);
        }
    }
}
