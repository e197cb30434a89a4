//! Which effects are compared in which scenes.

use deepshade_shaders::Effect;

/// An effect in a scene.
#[derive(Debug)]
pub struct Case {
    /// One of those that [`super::settings::build`] knows.
    pub scene: &'static str,
    /// What is computed.
    pub effect: Effect,
    /// What our truth is compared with.
    pub reference: Reference,
    /// Whether the two should agree.
    pub expected: Expected,
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
    /// Every light shines 2 % brighter.
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
}

const fn mitsuba(scene: &'static str, effect: Effect) -> Case {
    Case { scene, effect, reference: Reference::Mitsuba { fault: None }, expected: Expected::Agreement }
}

const fn control(scene: &'static str, effect: Effect, fault: Fault) -> Case {
    let reference = Reference::Mitsuba { fault: Some(fault) };
    Case { scene, effect, reference, expected: Expected::Disagreement }
}

/// Every comparison.
pub const ALL: &[Case] = &[
    mitsuba("blocks", Effect::Ao),
    mitsuba("blocks", Effect::Aa),
    mitsuba("blocks", Effect::Gi),
    mitsuba("blocks", Effect::Path),
    mitsuba("glossy", Effect::Path),
    mitsuba("blobs", Effect::Ao),
    mitsuba("blobs", Effect::Do),
    mitsuba("blobs", Effect::Ibl),
    mitsuba("flat-blobs", Effect::Path),
    mitsuba("still-life", Effect::Dof),
    mitsuba("still-life", Effect::Multi),
    mitsuba("room", Effect::Gi),
    mitsuba("room", Effect::Path),
    mitsuba("cornell-box", Effect::Path),
    mitsuba("sponza", Effect::Ao),
    mitsuba("sponza", Effect::Gi),
    mitsuba("sponza", Effect::Path),
    mitsuba("fog", Effect::FogDirect),
    mitsuba("fog", Effect::FogIndirect),
    mitsuba("fog", Effect::Path),
    mitsuba("smoke", Effect::FogDirect),
    mitsuba("smoke", Effect::Path),
    mitsuba("black-smoke", Effect::FogMultiple),
    Case {
        scene: "moving",
        effect: Effect::MotionBlur,
        reference: Reference::Stills,
        expected: Expected::Agreement,
    },
    control("blocks", Effect::Ao, Fault::NoCosine),
    control("blocks", Effect::Aa, Fault::BrighterLights),
    control("smoke", Effect::FogDirect, Fault::BrighterLights),
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
    }

    #[test]
    fn there_are_enough_scenes_and_controls() {
        let scenes: BTreeSet<&str> = ALL.iter().map(|case| case.scene).collect();
        assert!(scenes.len() >= 6);
        assert!(ALL.iter().any(|case| case.expected == Expected::Disagreement));
    }
}
