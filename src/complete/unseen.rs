//! Light that is in a scene and that an effect, or the methods for it, cannot see.

use deepshade_render::scene::Scene;
use deepshade_shaders::Effect;
use deepshade_shaders::effect::{EffectSetting, LitBy};

/// What of a scene's light is left out, in a sentence; `None` where nothing is.
pub fn light(effect: Effect, scene: &Scene) -> Option<String> {
    let emits = scene.emits().then_some("emissive surfaces");
    let is_kept = effect.listens_to(EffectSetting::Phosphor)
        && scene.glow.as_deref().is_some_and(|glow| glow.schedule_of_sky().is_some());
    let sky = (scene.environment.is_some() && !is_kept).then_some("the environment");
    let lamps = (!scene.lights.is_empty()).then_some("lamps");
    match effect.definition().lit_by {
        LitBy::Environment => listed([lamps, emits])
            .map(|others| format!("{effect} has the light of the environment alone: {others} are left out")),
        LitBy::AllInTruth => listed([emits, sky]).map(|others| {
            format!("most methods of {effect} see the light of lamps alone: that of {others} is in its truth")
        }),
        LitBy::Lamps => listed([emits, sky])
            .map(|others| format!("{effect} has the light of lamps alone: {others} light nothing in it")),
        LitBy::Nothing | LitBy::All => None,
    }
}

/// Those of two that are there.
fn listed(two: [Option<&str>; 2]) -> Option<String> {
    let there: Vec<&str> = two.into_iter().flatten().collect();
    (!there.is_empty()).then(|| there.join(" and "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::{Environment, Light, Material, Mesh};
    use glam::Vec3;

    fn scene(lamp: bool, emission: f32, sky: bool) -> Scene {
        let light = Light::Point { position: Vec3::ZERO, intensity: Vec3::ONE, range: f32::INFINITY };
        Scene {
            meshes: vec![Mesh::default()].into(),
            materials: vec![Material { emission: Vec3::splat(emission), ..Material::default() }],
            lights: if lamp { vec![light] } else { vec![] },
            environment: sky.then(|| Environment::uniform(Vec3::ONE).into()),
            ..Scene::default()
        }
    }

    #[test]
    fn light_that_an_effect_does_not_see_is_named() {
        let said =
            |effect, lamp, emission, sky| light(effect, &scene(lamp, emission, sky)).unwrap_or_default();
        for effect in Effect::ALL {
            assert_eq!(said(effect, false, 0.0, false), "", "{effect}");
        }
        for effect in [Effect::Gi, Effect::Glossy, Effect::Dof, Effect::Aa, Effect::Multi] {
            assert_eq!(said(effect, true, 0.0, false), "", "{effect} sees lamps");
            for (emission, sky, named) in [
                (1.0, false, " emissive surfaces "),
                (1.0, true, " emissive surfaces and the environment "),
                (0.0, true, " the environment "),
            ] {
                let said = said(effect, true, emission, sky);
                assert!(said.contains("light of lamps alone") && said.contains(named), "{said}");
            }
        }
        for effect in [Effect::Do, Effect::Ibl] {
            assert_eq!(said(effect, false, 0.0, true), "", "{effect} sees the environment");
            assert!(said(effect, true, 1.0, true).contains(": lamps and emissive surfaces are left out"));
        }
        assert_eq!(said(Effect::Path, true, 1.0, true), "");
        assert_eq!(said(Effect::Ao, true, 1.0, true), "");
    }
}
