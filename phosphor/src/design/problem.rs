//! What the search works on: the light of all places as steps in which it stays the same, and what is wanted
//! of the material.
//!
//! Steps of the rate equation are exact for light that stays the same, so that frames alike, side by side,
//! are one step.

use super::TargetPoint;
use deepshade_glow::spectrum::Bands;

/// The places that share a material.
pub struct Problem {
    pub bands: Bands,
    /// A place's steps, from the dark before the first frame to its last key.
    pub tracks: Vec<Vec<LightStep>>,
    /// Emission that is wanted, `[bands][keys]`: keys of all places one after the other.
    pub wanted: Vec<Vec<f64>>,
    pub keys: usize,
}

/// A time in which light stays the same.
pub struct LightStep {
    /// Irradiance, one value a band.
    pub light: Vec<f64>,
    pub seconds: f64,
    /// The key that is at its end.
    pub key: Option<usize>,
}

impl Problem {
    /// That of places that make sense and have the same bands.
    pub fn new(places: &[TargetPoint]) -> Self {
        let mut keys = 0;
        let tracks = places.iter().map(|place| {
            let track = track(place, keys);
            keys += place.keys.len();
            track
        });
        let tracks = tracks.collect();
        let bands = places[0].bands;
        let of_places: Vec<_> = places.iter().map(TargetPoint::wanted).collect();
        let of_band = |band: usize| of_places.iter().flat_map(|wanted| wanted[band].clone()).collect();
        Self { bands, tracks, wanted: (0..bands.count()).map(of_band).collect(), keys }
    }

    /// The sum of squares of all that is wanted.
    pub fn size(&self) -> f64 {
        self.wanted.iter().flatten().map(|value| value * value).sum()
    }
}

/// The steps of a place whose first key has this number.
fn track(place: &TargetPoint, first: usize) -> Vec<LightStep> {
    let mut steps: Vec<LightStep> = Vec::new();
    for (frame, light) in place.irradiance[..place.last()].iter().enumerate() {
        let key = place.keys.iter().position(|key| key.frame == frame + 1).map(|key| first + key);
        match steps.last_mut().filter(|step| step.key.is_none() && step.light == *light) {
            Some(step) => (step.seconds, step.key) = (step.seconds + place.dt, key),
            None => steps.push(LightStep { light: light.clone(), seconds: place.dt, key }),
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::super::Key;
    use super::*;

    #[test]
    fn frames_alike_are_one_step_that_ends_at_keys() {
        let key = |frame| Key { frame, radiance: vec![1.0; 3] };
        let light = |frame: usize| vec![if frame < 30 { 2.0 } else { 0.0 }; 3];
        let irradiance = (0..100).map(light).collect();
        let place = TargetPoint {
            bands: Bands::Rgb,
            dt: 0.5,
            irradiance,
            reflected: vec![],
            keys: vec![key(50), key(20), key(0)],
        };
        let problem = Problem::new(&[place.clone(), place]);
        let shape = |track: &Vec<LightStep>| -> Vec<(f64, f64, Option<usize>)> {
            track.iter().map(|step| (step.light[0], step.seconds, step.key)).collect()
        };
        assert_eq!(shape(&problem.tracks[0]), [(2.0, 10.0, Some(1)), (2.0, 5.0, None), (0.0, 10.0, Some(0))]);
        assert_eq!(shape(&problem.tracks[1]), [(2.0, 10.0, Some(4)), (2.0, 5.0, None), (0.0, 10.0, Some(3))]);
        assert_eq!((problem.keys, problem.wanted[1].len()), (6, 6));
    }
}
