//! A material as images need it: how linear RGB light excites each state, and the linear RGB colour of what
//! each sends. Both are linear in the light, so that nothing is lost but what a spectrum is beyond its
//! colour.

use super::material::{Material, State};
use super::rate::Scheme;
use super::spectrum::Bands;
use super::spectrum::lights::Light;
use deepshade_shaders::colour::luminance;
use glam::{DVec3, Vec3};

/// Most states of a material that is rendered.
pub const MOST_STATES: usize = 4;

/// Rates above this, per second, are taken for this: its state is full within any step.
pub const FASTEST: f32 = 1e30;

/// What a state does in images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PaintState {
    /// Re-radiation rate, per second.
    pub decay: f32,
    /// Excitation rate by irradiance of 1 of each colour, per second.
    pub excitation: Vec3,
    /// Radiance where all of it is excited, linear RGB: what screens cannot show of a colour is left out.
    pub emission: Vec3,
}

/// What a place has of a paint's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintFactors {
    /// Of the excitation rate by each colour.
    pub excitation: Vec3,
    /// Of the re-radiation rate.
    pub decay: f32,
    /// Of what is given back at that rate.
    pub emission: Vec3,
}

impl PaintFactors {
    /// All of them.
    pub const ONE: Self = Self { excitation: Vec3::ONE, decay: 1.0, emission: Vec3::ONE };

    /// Of radiance, which is faster where the re-radiation rate is.
    pub fn of_radiance(&self) -> Vec3 {
        self.emission * self.decay
    }
}

/// A material of at most [`MOST_STATES`] states.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    /// What it is called.
    pub name: String,
    /// Its states.
    pub states: Vec<PaintState>,
}

/// Light that stays the same for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightInterval {
    /// For how long, seconds.
    pub seconds: f32,
    /// Irradiance, linear RGB.
    pub irradiance: Vec3,
}

/// How a time of light that stays the same is gone through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// By which scheme.
    pub scheme: Scheme,
    /// In how many steps, one at least.
    pub count: u32,
}

impl Steps {
    /// At once.
    pub const EXACT: Self = Self { scheme: Scheme::Exact, count: 1 };

    /// So many steps of Euler's scheme, or the exact one without any.
    pub const fn of(euler: u32) -> Self {
        if euler == 0 { Self::EXACT } else { Self { scheme: Scheme::Euler, count: euler } }
    }
}

impl Paint {
    /// What a material does in images under lamps of a spectrum, whose colours in a scene then say how bright
    /// they are and no more, or under lamps of smooth spectra of their colours.
    ///
    /// # Errors
    /// If it has more states than are rendered, or a value that 32 bits do not hold; in words.
    pub fn new(material: &Material, lamp: Option<Light>) -> Result<Self, String> {
        let (name, count) = (&material.name, material.states.len());
        if count > MOST_STATES {
            return Err(format!("{name} has {count} states; at most {MOST_STATES} are rendered"));
        }
        let states: Option<Vec<PaintState>> =
            material.states.iter().map(|state| PaintState::new(state, material.bands, lamp)).collect();
        let states = states.ok_or_else(|| {
            format!("{name}: a decay, an excitation or an emission is larger than numbers of 32 bits are")
        })?;
        Ok(Self { name: name.clone(), states })
    }

    /// What it is where it has these parts of its numbers.
    #[must_use]
    pub fn scaled(&self, factors: &PaintFactors) -> Self {
        let scaled = |state: &PaintState| PaintState {
            decay: state.decay * factors.decay,
            excitation: state.excitation * factors.excitation,
            emission: state.emission * factors.of_radiance(),
        };
        Self { name: self.name.clone(), states: self.states.iter().map(scaled).collect() }
    }

    /// A material in RGB that does the same in images.
    pub fn material(&self) -> Material {
        let state = |state: &PaintState| State {
            decay: state.decay.into(),
            excitation: state.excitation.as_dvec3().to_array().to_vec(),
            emission: state.emitted().to_array().to_vec(),
        };
        let states = self.states.iter().map(state).collect();
        Material { name: self.name.clone(), bands: Bands::Rgb, doubt: None, states }
    }

    /// The excited share of each state after a past, which began with `start` of each excited. What is no
    /// amount of light is none, and endless light fills a state.
    pub fn after(&self, start: f32, past: impl Iterator<Item = LightInterval> + Clone) -> [f32; MOST_STATES] {
        self.after_steps(start, past.map(|lit| (lit, Steps::EXACT)))
    }

    /// The same by any steps.
    pub fn after_steps(
        &self,
        start: f32,
        past: impl Iterator<Item = (LightInterval, Steps)> + Clone,
    ) -> [f32; MOST_STATES] {
        let mut shares = [0.0; MOST_STATES];
        for (share, state) in shares.iter_mut().zip(&self.states) {
            let step = |share: f64, (lit, Steps { scheme, count }): (LightInterval, Steps)| {
                let (charge, seconds) = (state.charge(lit.irradiance), f64::from(lit.seconds));
                let (charge, decay) = (f64::from(charge), f64::from(state.decay));
                let one = |share, _| scheme.step(share, charge, decay, seconds / f64::from(count));
                (0..count).fold(share, one)
            };
            *share = past.clone().fold(f64::from(start), step) as f32;
        }
        shares
    }

    /// Radiance where these shares are excited (thesis, equation 8.3).
    pub fn emission(&self, shares: &[f32; MOST_STATES]) -> Vec3 {
        self.states.iter().zip(shares).map(|(state, share)| state.emission * *share).sum()
    }
}

impl PaintState {
    /// Nothing where a value is too large.
    fn new(state: &State, bands: Bands, lamp: Option<Light>) -> Option<Self> {
        let of_lamp = lamp.map(|lamp| state.charge(&lamp.of_luminance_one(bands)));
        let charge = |colour: [f32; 3]| match of_lamp {
            Some(charge) => charge * f64::from(luminance(colour)),
            None => state.charge(&bands.of_linear_srgb(colour.map(f64::from))),
        };
        let sent: Vec<f64> = state.emission.iter().map(|emission| emission * state.decay).collect();
        let excitation = Vec3::AXES.map(|primary| charge(primary.to_array()));
        let [excitation, emission] =
            [excitation, bands.linear_srgb(&sent)].map(|colour| DVec3::from(colour).as_vec3());
        let decay = state.decay as f32;
        let is_finite = decay.is_finite() && excitation.is_finite() && emission.is_finite();
        let [excitation, emission] = [excitation, emission].map(|colour| colour.max(Vec3::ZERO));
        is_finite.then_some(Self { decay, excitation, emission })
    }

    /// The re-radiation function, linear RGB; a state that does not decay is dark.
    fn emitted(&self) -> DVec3 {
        let decay = f64::from(self.decay);
        if decay > 0.0 { self.emission.as_dvec3() / decay } else { DVec3::ZERO }
    }

    /// The rate at which irradiance excites it, per second, at most [`FASTEST`]. A colour that does not
    /// excite does nothing, even where its light is endless.
    pub fn charge(&self, irradiance: Vec3) -> f32 {
        let excites = self.excitation.cmpgt(Vec3::ZERO) & irradiance.cmpgt(Vec3::ZERO);
        Vec3::select(excites, self.excitation * irradiance, Vec3::ZERO).element_sum().min(FASTEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::MaterialFile;
    use crate::spectrum::Axis;

    #[test]
    fn a_lamp_s_spectrum_excites_as_its_bands_do_however_the_lamp_is_coloured() {
        let presets = MaterialFile::presets();
        let material = presets.named("green").expect("a preset");
        let charges = Light::ALL.map(|lamp| {
            let spectrum = lamp.spectrum(Axis::EIGHT);
            let colour = Bands::Eight.linear_srgb(&spectrum).map(|part| part as f32);
            let state = Paint::new(material, Some(lamp)).expect("few states").states[0];
            let expected = material.states[0].charge(&spectrum) as f32;
            let found = state.charge(Vec3::from(colour));
            assert!((found / expected - 1.0).abs() < 1e-5, "{}: {found} {expected}", lamp.name());
            let grey = state.charge(Vec3::splat(luminance(colour)));
            assert!((grey / expected - 1.0).abs() < 1e-5, "{}: {grey} {expected}", lamp.name());
            state.charge(Vec3::ONE)
        });
        let [halogen, _, mercury, ..] = charges;
        assert!(mercury > 1.5 * halogen, "what excites is blue: {mercury} {halogen}");
    }

    #[test]
    fn a_paint_s_material_is_the_same_paint() {
        let presets = MaterialFile::presets();
        let known = presets.materials.iter().filter(|material| material.excitation_is_known());
        for material in known.filter(|material| material.states.len() <= MOST_STATES) {
            let paint = Paint::new(material, Some(Light::Mercury)).expect("few states");
            let again = Paint::new(&paint.material(), None).expect("as many");
            let off = |a: Vec3, b: Vec3| (a - b).abs().max_element() > 1e-6 * b.abs().max_element();
            for (state, own) in again.states.iter().zip(&paint.states) {
                assert_eq!((state.decay, state.excitation), (own.decay, own.excitation), "{}", paint.name);
                assert!(!off(state.emission, own.emission), "{}", paint.name);
            }
        }
        let dark = PaintState { decay: 0.0, excitation: Vec3::ONE, emission: Vec3::ONE };
        let paint = Paint { name: "dark".to_owned(), states: vec![dark] };
        assert_eq!(paint.material().states[0].emission, [0.0; 3]);
    }

    #[test]
    fn a_part_of_a_paint_is_that_part_of_its_material() {
        let own = State { decay: 0.2, excitation: vec![0.1, 0.2, 0.3], emission: vec![4.0, 2.0, 1.0] };
        let half = State { decay: 0.1, excitation: vec![0.1, 0.1, 0.0], emission: vec![4.0, 1.0, 0.5] };
        let paint = |state: &State| {
            let material =
                Material { name: "own".into(), bands: Bands::Rgb, doubt: None, states: vec![state.clone()] };
            Paint::new(&material, None).expect("a paint")
        };
        let factors = PaintFactors {
            excitation: Vec3::new(1.0, 0.5, 0.0),
            decay: 0.5,
            emission: Vec3::new(1.0, 0.5, 0.5),
        };
        let (found, expected) = (paint(&own).scaled(&factors).states[0], paint(&half).states[0]);
        assert_eq!((found.decay, found.excitation), (expected.decay, expected.excitation));
        assert!((found.emission - expected.emission).abs().max_element() < 1e-7);
        assert_eq!(paint(&own).scaled(&PaintFactors::ONE), paint(&own));
    }

    #[test]
    fn light_that_is_none_does_nothing_and_endless_light_fills() {
        let state = PaintState { decay: 0.0, excitation: Vec3::ONE, emission: Vec3::ONE };
        let paint = Paint { name: "test".to_owned(), states: vec![state] };
        let under = |irradiance: Vec3, seconds: f32| {
            paint.after(0.25, std::iter::once(LightInterval { seconds, irradiance }))[0]
        };
        assert_eq!([under(Vec3::NAN, 1.0), under(Vec3::NEG_ONE, 1.0), under(Vec3::ONE, 0.0)], [0.25; 3]);
        assert_eq!([under(Vec3::INFINITY, 1.0), under(Vec3::ONE, f32::MAX)], [1.0; 2]);
        let of_blue = PaintState { excitation: Vec3::Z, ..state };
        let charges = [Vec3::INFINITY, Vec3::new(f32::INFINITY, 0.0, 2.0), Vec3::new(0.0, f32::NAN, 3.0)];
        assert_eq!(charges.map(|light| of_blue.charge(light)), [FASTEST, 2.0, 3.0]);
    }

    #[test]
    fn what_32_bits_do_not_hold_is_refused() {
        let good = State { decay: 0.1, excitation: vec![0.1; 3], emission: vec![1.0; 3] };
        let refused = |change: fn(&mut State)| {
            let mut state = good.clone();
            change(&mut state);
            let material =
                Material { name: "huge".into(), bands: Bands::Rgb, doubt: None, states: vec![state] };
            Paint::new(&material, None).is_err_and(|said| said.starts_with("huge: "))
        };
        assert!(!refused(|_| {}));
        assert!(refused(|state| state.decay = 1e39));
        assert!(refused(|state| state.excitation[1] = 1e39));
        assert!(refused(|state| state.emission[2] = 1e40));
        assert!(refused(|state| (state.decay, state.emission) = (1e20, vec![1e300; 3])));
    }
}
