//! As many pairs from few scenes and from many (thesis 7.5.4, Figure 7.16 right).

use super::table::{Row, Table};
use super::test_frames::SIMILARITY;
use super::workspace::{Workspace, scores};
use anyhow::Result;
use deepshade::shared::plot::{Line, Plot};
use deepshade_dataset::Recipe;

/// One scene in so many is held apart for validation beside those that are trained on.
const TRAINED_A_HELD: usize = 10;

/// Trains a network on each dataset.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(workspace: &Workspace) -> Result<Table> {
    let test_frames = workspace.base_test_frames()?;
    let pairs = workspace.recipe.scene_count() * workspace.recipe.views_per_scene;
    let (mut rows, mut points) = (Vec::new(), Vec::new());
    for scenes in workspace.size.scene_counts {
        let name = format!("scenes-{scenes}");
        let data = workspace.data(&name, &from_scenes(&workspace.recipe, *scenes, pairs))?;
        let network = workspace.network(&name, &workspace.settings(&data)?)?;
        let scores = scores(&test_frames, &network)?;
        points.push((*scenes as f64, scores.dssim()));
        let trained = data.dataset.training().len() as f64;
        let values = [&scores.similarity()[..], &[trained, data.seconds, network.seconds]].concat();
        rows.push(Row::new(format!("ssim_scenes{scenes}"), scenes.to_string(), &values));
    }
    let trivial = test_frames.trivial()?;
    rows.push(Row::new("ssim_trivial", "nothing", &trivial.similarity()));
    let more = [("pairs trained on", 0), ("data s", 1), ("training s", 1)];
    let lines = vec![Line::dotted("network", points)];
    Ok(Table {
        title: "Scenes that as many pairs are from",
        rows_are: "scenes",
        columns: [&SIMILARITY[..], &more].concat(),
        rows,
        plot: Plot {
            x: "scenes trained on",
            is_logarithmic: true,
            y: "DSSIM on test scenes",
            lines,
            level: None,
        },
    })
}

/// A recipe with so many scenes to train on, dealt out to its families in turn, beside some that are held
/// apart, and so many pairs to train on in all.
fn from_scenes(recipe: &Recipe, scenes: usize, pairs: usize) -> Recipe {
    let held = (scenes / TRAINED_A_HELD).max(1);
    let all = scenes + held;
    let mut recipe = Recipe {
        views_per_scene: (pairs / scenes).max(1),
        validation_share: held as f64 / all as f64,
        ..recipe.clone()
    };
    let families = recipe.families.len();
    recipe.families.iter_mut().enumerate().for_each(|(index, family)| {
        family.scenes = (all + families - 1 - index) / families;
    });
    recipe.families.retain(|family| family.scenes > 0);
    recipe
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::size::Size;

    #[test]
    fn there_are_as_many_pairs_of_so_many_scenes() {
        let folder = tempfile::tempdir().expect("a folder");
        for size in [Size::DEFAULT, Size::FULL] {
            let workspace = Workspace::open(folder.path(), size).expect("a lab");
            let pairs = workspace.recipe.scene_count() * workspace.recipe.views_per_scene;
            for scenes in size.scene_counts {
                let recipe = from_scenes(&workspace.recipe, *scenes, pairs);
                let plan = recipe.plan().expect("scenes");
                let trained: Vec<usize> = plan
                    .iter()
                    .map(|scene| scene.views.iter().filter(|view| !view.held_apart).count())
                    .filter(|views| *views > 0)
                    .collect();
                assert_eq!((trained.len(), trained.iter().sum()), (*scenes, pairs), "{}", size.name);
                assert!(plan.len() > *scenes, "some are held apart");
            }
        }
    }
}
