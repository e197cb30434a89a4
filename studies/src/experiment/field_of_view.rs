//! A network trained at 50 degrees on views of others (thesis 7.5.1, Figure 7.13): dolly zooms, so that what
//! is seen stays nearly the same, of one view a scene.

use super::table::{Row, Table};
use super::test_frames::SIMILARITY;
use super::workspace::{Workspace, scores};
use anyhow::Result;
use deepshade::shared::plot::{Line, Plot};
use deepshade_dataset::Recipe;
use deepshade_dataset::recipe::FieldOfView;

/// Vertical fields of view, degrees.
const DEGREES: [u8; 8] = [20, 30, 40, 50, 60, 70, 80, 90];

/// Tests the same network at each.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(workspace: &Workspace) -> Result<Table> {
    let network = workspace.base_network()?;
    let (mut rows, mut learned, mut nothing) = (Vec::new(), Vec::new(), Vec::new());
    for degrees in DEGREES {
        let recipe = Recipe {
            field_of_view: Some(FieldOfView::Fixed(degrees.into())),
            views_per_scene: 1,
            ..workspace.test_recipe.clone()
        };
        let test_frames = workspace.test_frames(&format!("field-of-view-{degrees}"), &recipe)?;
        let (scores, trivial) = (scores(&test_frames, &network)?, test_frames.trivial()?);
        learned.push((f64::from(degrees), scores.dssim()));
        nothing.push((f64::from(degrees), trivial.dssim()));
        let values = [&scores.similarity()[..], &[scores.dssim(), trivial.ssim.mean]].concat();
        rows.push(Row::new(format!("ssim_fov{degrees}"), degrees.to_string(), &values));
    }
    let more = [("DSSIM", 4), ("SSIM of doing nothing", 4)];
    let lines = vec![Line::dotted("network", learned), Line::dotted("doing nothing", nothing)];
    Ok(Table {
        title: "Fields of view of a network trained at 50 degrees",
        rows_are: "degrees",
        columns: [&SIMILARITY[..], &more].concat(),
        rows,
        plot: Plot {
            x: "vertical field of view (degrees)",
            is_logarithmic: false,
            y: "DSSIM on test scenes",
            lines,
            level: None,
        },
    })
}
