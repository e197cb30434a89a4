//! Which scenes a stream is of: families in turn, each with seeds of its own for as long as the stream goes
//! on.

use crate::generate::rendered::Rendered;
use crate::plan::PlannedScene;
use crate::random::mix;
use crate::recipe::split_name;
use crate::{DatasetError, Pair, Props, Recipe, StagedScene, Variation};
use deepshade_render::scene::Camera;
use deepshade_render::scene::procedural::{Family, Split};

/// Scenes that are tried in place of ones without a fit view before the stream is given up.
const ATTEMPTS: u64 = 64;
/// Tells the seeds of streams from those of data on disk.
const STREAM: u64 = 0x5354_5245_414d;
/// Tells scenes of validation from those of the stream, as the highest bit of what their seeds are hashes of.
const VALIDATION: u64 = 1 << 63;

/// What pairs are used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Training: those of the stream.
    Training,
    /// Validation: of scenes that the stream never has.
    Validation,
}

/// The scenes of a recipe's stream.
#[derive(Debug)]
pub struct Scenes {
    recipe: Recipe,
    props: Props,
    /// The families of scenes one after the other, each as often as its share says.
    turns: Vec<Family>,
}

/// A scene with its views, all of which are fit.
pub struct ReadyScene<'a> {
    /// Where it comes from.
    pub planned: PlannedScene,
    /// The scene.
    pub staged: StagedScene<'a>,
    /// Camera and variation of each view.
    pub drawn: Vec<(Camera, Option<Variation>)>,
}

impl Scenes {
    /// The scenes of a recipe for training that consists of families alone.
    ///
    /// # Errors
    /// If the recipe is another one, or what its images are given cannot be read.
    pub fn of(recipe: &Recipe) -> Result<Self, DatasetError> {
        let refused = [
            (recipe.split != Split::Train, format!("`split` says {}", split_name(recipe.split))),
            (recipe.tiles.is_some(), "the table `tiles` is for test sets".to_owned()),
            (!recipe.files.is_empty(), "`files` do not go on without end".to_owned()),
            (!recipe.captures.is_empty(), "`captures` do not go on without end".to_owned()),
            (
                recipe.target.is_some(),
                "`target` names a method, where a stream's targets are truth".to_owned(),
            ),
        ];
        if let Some((_, what)) = refused.into_iter().find(|(holds, _)| *holds) {
            let what = format!("{what}; streams are of families for training");
            return Err(DatasetError::Recipe { path: recipe.path.clone(), what });
        }
        Ok(Self { turns: turns(recipe)?, props: Props::load(recipe)?, recipe: recipe.clone() })
    }

    /// What the scenes are of.
    pub const fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// The scene of a number, ready to be rendered: the first of its attempts all views of which are fit.
    ///
    /// # Errors
    /// If it cannot be had, or none of many attempts has views that are fit.
    pub fn ready(&self, number: usize, used: Use) -> Result<ReadyScene<'_>, DatasetError> {
        let mut attempt = 0;
        loop {
            let planned = self.planned(number, used, attempt);
            let staged = StagedScene::load(&planned.scene, &self.recipe, &self.props)?;
            let drawn = staged.each(&planned.views, |view| staged.drawn(planned.key, view));
            attempt += 1;
            match drawn {
                Ok(drawn) => return Ok(ReadyScene { planned, staged, drawn }),
                Err(DatasetError::NoView { .. }) if attempt < ATTEMPTS => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Renders a view of a scene.
    ///
    /// # Errors
    /// If the scene cannot be shown as the view wants it.
    pub fn pair(&self, ready: &ReadyScene<'_>, view: usize) -> Result<Pair, DatasetError> {
        let seed = ready.planned.views[view].seed;
        Ok(Rendered::new(&self.recipe, None, &ready.staged, seed, ready.drawn[view])?.into_pair())
    }

    /// The scene of a number at an attempt. Its seed is a hash that differs wherever number, use or attempt
    /// do.
    fn planned(&self, number: usize, used: Use, attempt: u64) -> PlannedScene {
        let kind = if used == Use::Validation { VALIDATION } else { 0 };
        let seed = mix(&[u64::from(self.recipe.seed), STREAM, kind | (number as u64 * ATTEMPTS + attempt)]);
        self.recipe.procedural_scene(self.turns[number % self.turns.len()], seed)
    }
}

/// A round of families, each with as many turns as its share says, spread evenly.
fn turns(recipe: &Recipe) -> Result<Vec<Family>, DatasetError> {
    let mut turns = Vec::new();
    for (index, share) in recipe.families.iter().enumerate() {
        let family = Family::by_name(&share.name)?;
        let place = |turn: usize| (turn as f64 + 0.5) / share.scenes as f64;
        turns.extend((0..share.scenes).map(|turn| (place(turn), index, family)));
    }
    turns.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    Ok(turns.into_iter().map(|(_, _, family)| family).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recipe::FamilyShare;
    use std::collections::HashSet;

    fn recipe(shares: &[(&str, usize)]) -> Recipe {
        let share =
            |(name, scenes): &(&str, usize)| FamilyShare { name: (*name).to_owned(), scenes: *scenes };
        Recipe { families: shares.iter().map(share).collect(), ..crate::shipped::shrunk("ao-tiny.toml") }
    }

    #[test]
    fn families_take_turns_by_their_shares() {
        let names = |shares| -> Vec<&str> {
            turns(&recipe(shares)).expect("families").into_iter().map(Family::name).collect()
        };
        assert_eq!(names(&[("room", 2), ("city", 2)]), ["room", "city", "room", "city"]);
        assert_eq!(names(&[("room", 3), ("city", 1)]), ["room", "room", "city", "room"]);
    }

    #[test]
    fn no_scene_is_of_two_numbers_uses_or_attempts_or_of_data_on_disk() {
        let recipe = recipe(&[("room", 50), ("city", 50)]);
        let scenes = Scenes::of(&recipe).expect("a stream");
        let mut seen: HashSet<u64> =
            recipe.plan().expect("a plan").iter().map(|planned| planned.key).collect();
        assert_eq!(seen.len(), 100);
        for number in 0..1000 {
            for used in [Use::Training, Use::Validation] {
                for attempt in 0..3 {
                    assert!(seen.insert(scenes.planned(number, used, attempt).key), "{number} {used:?}");
                }
            }
        }
    }

    #[test]
    fn recipes_for_testing_and_of_files_are_refused() {
        let refusal = |recipe: &Recipe| Scenes::of(recipe).expect_err("refused").to_string();
        assert!(refusal(&crate::shipped::shrunk("ao-test.toml")).contains("`split` says testing"));
        let train = recipe(&[("room", 1)]);
        let files = Recipe { files: vec!["a.gltf".into()], ..train.clone() };
        assert!(refusal(&files).contains("`files`"));
        assert!(refusal(&Recipe { target: Some("hbao".to_owned()), ..train }).contains("`target`"));
    }
}
