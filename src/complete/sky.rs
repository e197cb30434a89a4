//! The environment of effects that are lit by one alone, which networks for them know by heart.

use super::Wants;
use crate::compare::file_digest;
use deepshade_dataset::Recipe;
use deepshade_dataset::vary::Surroundings;
use deepshade_infer::TrainedUnder;
use deepshade_render::scene::procedural::sky;
use deepshade_render::scene::{Environment, Look};
use std::sync::Arc;

/// The environment of all images of a recipe; `None` without one, where there are many, and where its file is
/// not there any more.
pub fn of_recipe(recipe: &Recipe) -> Option<TrainedUnder> {
    Some(match recipe.vary.as_ref()?.environment.as_ref()? {
        Surroundings::Sky(number) => TrainedUnder::Sky(*number),
        Surroundings::Skies(_) => return None,
        Surroundings::File(path) => TrainedUnder::File(file_digest(&recipe.folder.join(path)).ok()?),
    })
}

/// Adds an environment where there is none: the sky that the network knows, else one that the seed chooses.
/// Says which, and where the network knows another one than there is.
pub fn add(look: &mut Look, wants: &Wants<'_>, added: &mut Vec<String>) {
    let another = match (&look.environment, wants.learned) {
        (Some(there), Some(learned)) => !is_it(learned, there, wants),
        (None, Some(learned)) => matches!(learned, TrainedUnder::File(_)),
        (_, None) => false,
    };
    if look.environment.is_none() {
        let (number, why) = match wants.learned {
            Some(TrainedUnder::Sky(number)) => (*number, ", which the network was trained under"),
            _ => (wants.seed, ""),
        };
        look.environment = Some(Arc::new(sky(u64::from(number))));
        added.push(format!("no environment is given: a clear sky, number {number}{why}"));
    }
    added.extend(wants.learned.filter(|_| another).map(said_of_another));
}

/// What is said where there is another environment than a network knows.
pub fn said_of_another(learned: &TrainedUnder) -> String {
    format!(
        "another environment than the network was trained under, {learned}: it knows no other, and is wrong"
    )
}

/// Whether an environment is the one that a network knows.
fn is_it(learned: &TrainedUnder, there: &Environment, wants: &Wants<'_>) -> bool {
    match learned {
        TrainedUnder::Sky(number) => *there == sky(u64::from(*number)),
        TrainedUnder::File(hash) => {
            let given = wants.additions.environment.as_deref();
            given.and_then(|path| file_digest(path).ok()).as_ref() == Some(hash)
        }
    }
}
