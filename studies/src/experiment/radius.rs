//! Effect radius against resolution (thesis 7.5.1, Figure 7.12): one network, told of the radius by what it
//! reads ([`NetSpec::scaling`](deepshade_infer::NetSpec::scaling)). Where resolution times radius is the
//! same, the effect is as large in pixels.

use super::table::{Row, Table};
use super::test_frames::SIMILARITY;
use super::workspace::{Workspace, scores};
use anyhow::Result;
use deepshade::shared::plot::{Line, Plot};
use deepshade_dataset::Recipe;
use deepshade_dataset::recipe::Resolution;

/// Resolutions over that of training, and radii over that of training, with their names in figures.
const FACTORS: [(f32, &str); 3] = [(0.5, "half"), (1.0, "one"), (2.0, "two")];

/// Tests the same network in each cell.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(workspace: &Workspace) -> Result<Table> {
    let network = workspace.base_network()?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (finer, _) in FACTORS {
        let mut points = Vec::new();
        let edge = (finer * workspace.size.edge as f32) as usize;
        for (wider, name) in FACTORS {
            let test_frames = workspace
                .test_frames(&format!("radius-{edge}-{name}"), &cell(&workspace.test_recipe, edge, wider))?;
            let (scores, trivial) = (scores(&test_frames, &network)?, test_frames.trivial()?);
            points.push((f64::from(wider), scores.ssim.mean));
            let in_pixels = f64::from(finer * wider);
            let values = [&scores.similarity()[..], &[in_pixels, trivial.ssim.mean]].concat();
            rows.push(Row::new(
                format!("ssim_height{edge}_radius_{name}"),
                format!("{edge}x{edge} radius x {wider}"),
                &values,
            ));
        }
        lines.push(Line::dotted(format!("{edge}x{edge}"), points));
    }
    let more = [("radius in pixels over training's", 2), ("SSIM of doing nothing", 4)];
    Ok(Table {
        title: "Effect radius against resolution",
        rows_are: "images",
        columns: [&SIMILARITY[..], &more].concat(),
        rows,
        plot: Plot {
            x: "radius over that of training",
            is_logarithmic: true,
            y: "SSIM on test scenes",
            lines,
            level: None,
        },
    })
}

/// A recipe for testing of one view a scene, at a resolution and with its radius times a factor.
fn cell(recipe: &Recipe, edge: usize, wider: f32) -> Recipe {
    Recipe {
        resolution: Resolution { height: edge, width: edge },
        radius: recipe.radius.times(wider),
        views_per_scene: 1,
        ..recipe.clone()
    }
}
