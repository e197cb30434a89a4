//! Kernels of 3x3 against 5x5 pixels, and 4, 8 or 16 of them on the first level (thesis 7.5.2, Figure 7.14).

use super::table::{Row, Table};
use super::test_frames::SIMILARITY;
use super::workspace::{Trained, Workspace, scores};
use anyhow::Result;
use deepshade::shared::learned::Engine;
use deepshade::shared::plot::{Line, Plot};
use deepshade_infer::parity;

/// Width and height of kernels.
const KERNELS: [usize; 2] = [3, 5];
/// Numbers of kernels on the first level.
const U0: [usize; 3] = [4, 8, 16];
/// Height and width of the images that networks are timed with.
pub const TIMED: usize = 256;

/// Trains a network of each kind.
///
/// # Errors
/// If data, training or testing fail.
pub fn run(workspace: &Workspace) -> Result<Table> {
    let settings = workspace.settings(&workspace.base_data()?)?;
    let test_frames = workspace.base_test_frames()?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for kernel in KERNELS {
        let mut points = Vec::new();
        for u0 in U0 {
            let spec = settings.spec.clone().reshaped(|net| (net.kernel, net.u0) = (kernel, u0));
            let is_base = spec == settings.spec;
            let name = if is_base { "base".to_owned() } else { format!("kernel{kernel}-u{u0}") };
            let mut varied = settings.clone();
            varied.spec = spec;
            let network = workspace.network(&name, &varied)?;
            let (scores, time) = (scores(&test_frames, &network)?, milliseconds(&network)?);
            points.push((time, scores.dssim()));
            let weights = network.model.spec.weight_count() as f64;
            let values =
                [&scores.similarity()[..], &[network.validation, weights, time, network.seconds]].concat();
            rows.push(Row::new(
                format!("ssim_kernel{kernel}_u{u0}"),
                format!("{kernel}x{kernel} u0 = {u0}"),
                &values,
            ));
        }
        lines.push(Line::dotted(format!("{kernel}x{kernel}"), points));
    }
    let white = test_frames.trivial()?;
    rows.push(Row::new("ssim_trivial", "nothing", &white.similarity()));
    let more = [("validation DSSIM", 4), ("weights", 0), ("ms at 256x256", 2), ("training s", 1)];
    Ok(Table {
        title: "Kernels: size and number on the first level",
        rows_are: "network",
        columns: [&SIMILARITY[..], &more].concat(),
        rows,
        plot: Plot {
            x: "ms at 256x256 on the processor",
            is_logarithmic: true,
            y: "DSSIM on test scenes",
            lines,
            level: None,
        },
    })
}

/// What a network takes for an image of 256 x 256 pixels on the processor.
///
/// # Errors
/// If the processor refuses the network.
pub fn milliseconds(network: &Trained) -> Result<f64> {
    let engine = Engine::new(None, &network.model)?;
    let input = parity::noise(network.model.spec.input_channels(), TIMED, TIMED, 1);
    Ok(engine.run(&input, 2, 9)?.1.milliseconds)
}
