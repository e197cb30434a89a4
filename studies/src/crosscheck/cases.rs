//! Which effects are compared in which scenes.

use deepshade_render::sampler::hash;
use deepshade_shaders::Effect;

/// An effect in a scene.
#[derive(Debug)]
pub struct Case {
    /// One of those that [`super::scenes::build`] knows.
    pub scene: &'static str,
    /// What is computed.
    pub effect: Effect,
    /// What our truth is compared with.
    pub reference: Reference,
    /// Whether the two should agree.
    pub expected: Expected,
    /// Times as many samples as asked for: so many that the image's mean is known well enough.
    pub samples: u32,
}

/// What our truth is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// Mitsuba's rendering of the exported scene, with a fault where the case is a control.
    Mitsuba {
        /// What is wrong with it.
        fault: Option<Fault>,
    },
    /// The mean of our own still frames at moments of the exposure.
    Stills,
}

/// What can be put wrong on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Every light shines 2 % brighter, the environment too.
    BrighterLights,
    /// Directions are uniform over the hemisphere and not cosine-distributed.
    NoCosine,
}

/// How a comparison should end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Both are means of the same.
    Agreement,
    /// The fault is found.
    Disagreement,
}

impl Case {
    /// `<scene>.<effect>`, and the fault of a control.
    pub fn name(&self) -> String {
        let fault = match self.reference {
            Reference::Mitsuba { fault: Some(Fault::BrighterLights) } => ".brighter-lights",
            Reference::Mitsuba { fault: Some(Fault::NoCosine) } => ".no-cosine",
            Reference::Mitsuba { fault: None } | Reference::Stills => "",
        };
        format!("{}.{}{fault}", self.scene, self.effect)
    }

    /// A seed of its own for each case, so that what chance does to one it does not to another; below 2^31.
    pub fn seed(&self) -> u32 {
        self.name().bytes().fold(0, |seed, byte| hash(seed ^ u32::from(byte))) >> 1
    }

    /// The same with more samples.
    const fn sampled(self, times: u32) -> Self {
        Self { samples: times, ..self }
    }
}

const fn case(scene: &'static str, effect: Effect, reference: Reference, expected: Expected) -> Case {
    Case { scene, effect, reference, expected, samples: 1 }
}

const fn mitsuba(scene: &'static str, effect: Effect) -> Case {
    case(scene, effect, Reference::Mitsuba { fault: None }, Expected::Agreement)
}

const fn control(scene: &'static str, effect: Effect, fault: Fault) -> Case {
    case(scene, effect, Reference::Mitsuba { fault: Some(fault) }, Expected::Disagreement)
}

/// Every comparison.
pub const ALL: &[Case] = &[
    mitsuba("blocks", Effect::Ao),
    mitsuba("blocks", Effect::Aa),
    mitsuba("blocks", Effect::Gi).sampled(8),
    mitsuba("blocks", Effect::Path),
    mitsuba("glossy", Effect::Ibl),
    mitsuba("glossy", Effect::Path),
    mitsuba("polished", Effect::Glossy).sampled(8),
    mitsuba("blobs", Effect::Ao),
    mitsuba("blobs", Effect::Do),
    mitsuba("blobs", Effect::Ibl),
    mitsuba("flat-blobs", Effect::Path),
    mitsuba("still-life", Effect::Dof),
    mitsuba("still-life", Effect::Multi),
    mitsuba("room", Effect::Gi).sampled(8),
    mitsuba("room", Effect::Path).sampled(2),
    mitsuba("cornell-box", Effect::Path).sampled(4),
    mitsuba("sponza", Effect::Ao),
    mitsuba("sponza", Effect::Gi).sampled(4),
    mitsuba("sponza", Effect::Path),
    mitsuba("fog", Effect::FogDirect).sampled(4),
    mitsuba("fog", Effect::FogIndirect).sampled(4),
    mitsuba("fog", Effect::Path),
    mitsuba("smoke", Effect::FogDirect),
    mitsuba("smoke", Effect::Path),
    mitsuba("black-smoke", Effect::FogMultiple).sampled(8),
    case("moving", Effect::MotionBlur, Reference::Stills, Expected::Agreement),
    control("blocks", Effect::Ao, Fault::NoCosine),
    control("blocks", Effect::Aa, Fault::BrighterLights),
    control("blobs", Effect::Ibl, Fault::BrighterLights),
    control("glossy", Effect::Path, Fault::BrighterLights),
    control("still-life", Effect::Dof, Fault::BrighterLights),
    control("polished", Effect::Glossy, Fault::BrighterLights).sampled(8),
    control("room", Effect::Gi, Fault::BrighterLights).sampled(8),
    control("fog", Effect::FogIndirect, Fault::BrighterLights).sampled(4),
    control("smoke", Effect::FogDirect, Fault::BrighterLights),
    control("black-smoke", Effect::FogMultiple, Fault::BrighterLights).sampled(8),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_folders_of_their_own() {
        let names: BTreeSet<String> = ALL.iter().map(Case::name).collect();
        assert_eq!(names.len(), ALL.len());
        assert!(names.iter().all(|name| !name.contains(['/', ' '])));
        let seeds: BTreeSet<u32> = ALL.iter().map(|case| case.seed() >> 12).collect();
        assert_eq!(seeds.len(), ALL.len(), "seeds follow each other from the first of a case");
    }

    #[test]
    fn there_are_enough_scenes_and_controls() {
        let scenes: BTreeSet<&str> = ALL.iter().map(|case| case.scene).collect();
        assert!(scenes.len() >= 6);
        let control = |case: &Case| (case.expected == Expected::Disagreement).then_some(case.effect.name());
        let controls: BTreeSet<&str> = ALL.iter().filter_map(control).collect();
        for effect in
            ["ao", "aa", "gi", "glossy", "ibl", "dof", "path", "fog-direct", "fog-indirect", "fog-multiple"]
        {
            assert!(controls.contains(effect), "a fault of {effect}");
        }
    }
}
