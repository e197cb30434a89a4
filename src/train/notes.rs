//! What `deepshade train` says before its first step.

use deepshade_dataset::manifest::PairRecord;
use deepshade_dataset::{Recipe, TrainingSplit};
use deepshade_train::TrainConfig;
use std::collections::HashSet;
use std::path::Path;

/// What is trained, and on what.
pub fn beginning(config: &TrainConfig, data: &Path) -> String {
    let spec = &config.spec;
    let (effect, weights, data) = (spec.effect, spec.weight_count(), data.display());
    format!("training a network for {effect} on {data}: {weights} weights, crops of {} pixels", config.crop)
}

/// What is to be said of pairs held apart that show too little to judge a network by; nothing where they are
/// of several scenes.
pub fn held_apart(pairs: &[PairRecord]) -> Option<String> {
    let of = |part: TrainingSplit| -> HashSet<_> {
        pairs.iter().filter(|pair| pair.part == part).map(|pair| &pair.scene.source).collect()
    };
    let (held, trained) = (of(TrainingSplit::Validation), of(TrainingSplit::Training));
    let scene = held.iter().next().filter(|_| held.len() == 1)?;
    let how = if trained.contains(scene) { "which is trained on, too" } else { "and no other" };
    Some(format!(
        "warning: all pairs held apart for validation are of {scene}, {how}: \
         the best network is chosen by it alone; more scenes, or a larger `validation_share` in the recipe, say more"
    ))
}

/// As [`held_apart`], of a recipe whose views are rendered while the network trains.
pub fn held_apart_of_stream(recipe: &Recipe, pairs: usize) -> Option<String> {
    let views = recipe.views_per_scene;
    (pairs <= views).then(|| {
        format!(
            "warning: {pairs} pairs held apart for validation are of one scene, since a scene has {views} views: \
             the best network is chosen by it alone; a larger --validation-pairs says more"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_dataset::{SceneOrCapture, SceneRecord};
    use deepshade_render::scene::Camera;
    use glam::Vec3;

    fn pair(scene: &str, part: TrainingSplit) -> PairRecord {
        let source = SceneOrCapture::try_from(scene.to_owned()).expect("a scene");
        PairRecord {
            file: String::new(),
            blake3: String::new(),
            part,
            scene: SceneRecord { source, blake3: None },
            view: 0,
            camera: Camera::look_at(Vec3::ONE, Vec3::ZERO),
            radius: 1.0,
            seed: 0,
            variation: None,
        }
    }

    #[test]
    fn a_single_scene_held_apart_is_warned_of_by_name() {
        let of = |held: &[&str]| {
            let held = held.iter().map(|scene| pair(scene, TrainingSplit::Validation));
            let pairs: Vec<PairRecord> = held.chain([pair("stairs:1", TrainingSplit::Training)]).collect();
            held_apart(&pairs)
        };
        let apart = of(&["stairs:2", "stairs:2"]).expect("a warning");
        assert!(apart.contains("are of stairs:2, and no other"), "{apart}");
        assert!(of(&["stairs:1"]).expect("a warning").contains("which is trained on, too"));
        assert_eq!((of(&["stairs:2", "stairs:3"]), of(&[])), (None, None));
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
        let recipe = Recipe::load(&path).expect("a recipe");
        let views = recipe.views_per_scene;
        assert!(held_apart_of_stream(&recipe, views).is_some());
        assert_eq!(held_apart_of_stream(&recipe, views + 1), None);
    }
}
