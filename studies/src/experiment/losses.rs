//! The same network trained to make different losses small (thesis 7.5.3, Figure 7.15).

use super::table::{Row, Table};
use super::test_frames::{SIMILARITY, Scores};
use super::workspace::{Workspace, scores};
use anyhow::Result;
use clap::ValueEnum;
use deepshade::shared::plot::{Line, Plot};
use deepshade::shared::train::LossName;
use deepshade_train::Loss;

/// Trains a network for each loss.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(workspace: &Workspace) -> Result<Table> {
    let settings = workspace.settings(&workspace.base_data()?)?;
    let test_frames = workspace.base_test_frames()?;
    let values = |scores: &Scores| [&scores.similarity()[..], &[scores.l1, scores.l2, scores.flip]].concat();
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for choice in LossName::value_variants() {
        let loss = Loss::from(*choice);
        let value = choice.to_possible_value();
        let name = value.as_ref().map_or("", |value| value.get_name());
        let run = if loss == settings.loss { "base".to_owned() } else { format!("loss-{name}") };
        let mut varied = settings.clone();
        varied.loss = loss;
        let network = workspace.network(&run, &varied)?;
        let scores = scores(&test_frames, &network)?;
        lines.push(Line::dotted(name, vec![(scores.l1, scores.ssim.mean)]));
        let values = [values(&scores), vec![network.seconds]].concat();
        rows.push(Row::new(format!("ssim_{}", name.replace('-', "_")), name, &values));
    }
    rows.push(Row::new("ssim_trivial", "nothing", &values(&test_frames.trivial()?)));
    let more = [("L1", 4), ("L2", 4), ("FLIP", 4), ("training s", 1)];
    Ok(Table {
        title: "Losses that the same network is trained for",
        rows_are: "loss",
        columns: [&SIMILARITY[..], &more].concat(),
        rows,
        plot: Plot {
            x: "mean absolute difference on test scenes",
            is_logarithmic: false,
            y: "SSIM on test scenes",
            lines,
            level: None,
        },
    })
}
