//! Which effects listen to which options: one that changes nothing is refused rather than passed over.

use anyhow::{Result, bail};
use deepshade_shaders::Effect;
use deepshade_shaders::effect::EffectSetting;

/// Whether options, each with whether it is given, are for an effect.
///
/// # Errors
/// If one is given that the effect does not listen to.
pub fn check(effect: Effect, setting: EffectSetting, options: &[(&str, bool)]) -> Result<()> {
    check_any(&[effect], setting, options)
}

/// Whether options, each with whether it is given, are for one at least of some effects.
///
/// # Errors
/// If one is given that none of the effects listens to.
pub fn check_any(effects: &[Effect], setting: EffectSetting, options: &[(&str, bool)]) -> Result<()> {
    let given = options.iter().find(|(_, given)| *given);
    if let Some((option, _)) = given.filter(|_| !effects.iter().any(|effect| effect.listens_to(setting))) {
        let listeners: Vec<Effect> =
            Effect::ALL.into_iter().filter(|effect| effect.listens_to(setting)).collect();
        let names = |effects: &[Effect]| effects.iter().map(|e| e.name()).collect::<Vec<_>>().join(", ");
        let plural = if effects.len() == 1 { "" } else { "s" };
        bail!(
            "{option} means nothing to the effect{plural} {}, only to {}",
            names(effects),
            names(&listeners)
        );
    }
    Ok(())
}
