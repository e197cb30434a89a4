//! Which effects listen to which options: one that changes nothing is refused rather than passed over.

use anyhow::{Result, bail};
use deepshade_shaders::Effect;

/// Effects that reach no further than a radius.
pub const RADIUS: &[Effect] =
    &[Effect::Ao, Effect::Do, Effect::Gi, Effect::Glossy, Effect::Multi, Effect::PhosphorGi];
/// Effects of a moment that lasts.
pub const SHUTTER: &[Effect] = &[Effect::MotionBlur];
/// Effects of light on its way through a medium.
pub const MEDIUM: &[Effect] = &[
    Effect::FogDirect,
    Effect::FogIndirect,
    Effect::FogMultiple,
    Effect::Phosphor,
    Effect::PhosphorGi,
    Effect::Path,
    Effect::Real,
];
/// Effects of light on its way through materials.
pub const MEAN_FREE_PATH: &[Effect] = &[Effect::Sss, Effect::Subsurface];
/// Effects that are seen through a lens.
pub const LENS: &[Effect] = &[
    Effect::Dof,
    Effect::Multi,
    Effect::FogDirect,
    Effect::FogIndirect,
    Effect::FogMultiple,
    Effect::Path,
    Effect::Real,
];
/// Effects of light that surfaces keep.
pub const PHOSPHOR: &[Effect] = &[Effect::Phosphor, Effect::PhosphorGi, Effect::Path];
/// Effects that show an environment, or are lit by it.
pub const ENVIRONMENT: &[Effect] = &[
    Effect::Do,
    Effect::Gi,
    Effect::Glossy,
    Effect::Ibl,
    Effect::Dof,
    Effect::MotionBlur,
    Effect::Aa,
    Effect::Multi,
    Effect::FogDirect,
    Effect::FogIndirect,
    Effect::FogMultiple,
    Effect::Path,
    Effect::Real,
];

/// Whether options, each with whether it is given, are for an effect.
///
/// # Errors
/// If one is given that the effect does not listen to.
pub fn check(effect: Effect, listeners: &[Effect], options: &[(&str, bool)]) -> Result<()> {
    check_any(&[effect], listeners, options)
}

/// Whether options, each with whether it is given, are for one at least of some effects.
///
/// # Errors
/// If one is given that none of the effects listens to.
pub fn check_any(effects: &[Effect], listeners: &[Effect], options: &[(&str, bool)]) -> Result<()> {
    let given = options.iter().find(|(_, given)| *given);
    if let Some((option, _)) = given.filter(|_| !effects.iter().any(|effect| listeners.contains(effect))) {
        let names = |effects: &[Effect]| effects.iter().map(|e| e.name()).collect::<Vec<_>>().join(", ");
        let plural = if effects.len() == 1 { "" } else { "s" };
        bail!(
            "{option} means nothing to the effect{plural} {}, only to {}",
            names(effects),
            names(listeners)
        );
    }
    Ok(())
}
