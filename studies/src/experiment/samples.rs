//! Samples of a pixel against number of images, where both take as long (thesis 7.5.4, Figure 7.16 left),
//! with targets whose noise the loss takes off and ones whose noise it does not know.

use super::table::{Row, Table};
use super::test_frames::SIMILARITY;
use super::workspace::{Workspace, scores};
use anyhow::Result;
use deepshade::shared::plot::{Line, Plot};
use deepshade_dataset::Recipe;

/// Samples that are compared.
const SAMPLES: [u32; 4] = [4, 16, 64, 256];
/// Sequences that they are split over, what is known then, and what that adds to names.
const SCRAMBLINGS: [(u32, &str, &str); 2] = [(1, "noise unknown", ""), (2, "noise known", "-known")];

/// Trains a network on each dataset.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(workspace: &Workspace) -> Result<Table> {
    let test_frames = workspace.base_test_frames()?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (scramblings, label, suffix) in SCRAMBLINGS {
        let mut points = Vec::new();
        for samples in SAMPLES {
            let recipe =
                Recipe { scramblings, ..equal_time(&workspace.recipe, workspace.size.image_cost, samples) };
            let is_base = recipe == workspace.recipe;
            let name = if is_base { "base".to_owned() } else { format!("samples-{samples}{suffix}") };
            let data = workspace.data(&name, &recipe)?;
            let network = workspace.network(&name, &workspace.settings(&data)?)?;
            let scores = scores(&test_frames, &network)?;
            points.push((f64::from(samples), scores.dssim()));
            let trained = data.dataset.training().len() as f64;
            let values = [&scores.similarity()[..], &[trained, data.seconds, network.seconds]].concat();
            rows.push(Row::new(
                format!("ssim_samples{samples}{}", suffix.replace('-', "_")),
                format!("{samples}, {label}"),
                &values,
            ));
        }
        lines.push(Line::dotted(label, points));
    }
    let trivial = test_frames.trivial()?;
    rows.push(Row::new("ssim_trivial", "nothing", &trivial.similarity()));
    let more = [("pairs trained on", 0), ("data s", 1), ("training s", 1)];
    Ok(Table {
        title: "Samples of a pixel against number of images",
        rows_are: "samples",
        columns: [&SIMILARITY[..], &more].concat(),
        rows,
        plot: Plot {
            x: "samples of a pixel",
            is_logarithmic: true,
            y: "DSSIM on test scenes",
            lines,
            level: None,
        },
    })
}

/// A recipe with other samples and so many views of each scene that it takes as long, as near as whole views
/// come to it; one view at least.
fn equal_time(recipe: &Recipe, image_cost: usize, samples: u32) -> Recipe {
    let cost = |samples: u32| samples as usize + image_cost;
    let budget = recipe.views_per_scene * cost(recipe.samples);
    let views_per_scene = (budget as f64 / cost(samples) as f64).round().max(1.0) as usize;
    Recipe { samples, views_per_scene, ..recipe.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::size::Size;

    #[test]
    fn all_take_as_long_as_near_as_whole_views_come_to_it() {
        let folder = tempfile::tempdir().expect("a folder");
        for size in [Size::DEFAULT, Size::FULL] {
            let workspace = Workspace::open(folder.path(), size).expect("a lab");
            let cost = |recipe: &Recipe| recipe.samples as usize + size.image_cost;
            let time = |recipe: &Recipe| recipe.views_per_scene * cost(recipe);
            for samples in SAMPLES {
                let recipe = equal_time(&workspace.recipe, size.image_cost, samples);
                assert_eq!((recipe.samples, recipe.scene_count()), (samples, workspace.recipe.scene_count()));
                let off = time(&recipe).abs_diff(time(&workspace.recipe));
                assert!(2 * off <= cost(&recipe), "{}, {samples} samples: {off}", size.name);
            }
            assert_eq!(
                equal_time(&workspace.recipe, size.image_cost, workspace.recipe.samples),
                workspace.recipe
            );
        }
    }
}
