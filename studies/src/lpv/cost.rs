//! What each stage takes, as in the paper's Table 1.

use super::subject::LpvFrame;
use crate::stages::{Cost, Stage};
use anyhow::Result;
use deepshade::shared::figures::Figures;
use deepshade_render::lpv::Scheme;
use deepshade_render::methods::lpv::LpvParameters;
use deepshade_render::screen::MethodPasses;
use deepshade_shaders::gpu::{self, Gpu};

/// Cells along the scene, and what figures of them end with.
const GRIDS: [(usize, &str); 2] = [(32, ""), (64, "_64")];
/// The paper's iterations.
const ITERATIONS: usize = 8;
/// Steps of the march, of one pixel of so many along each axis.
const STEPS: u32 = 32;
const SCALE: usize = 2;
/// Bytes that an iteration reads and writes of a cell at least: lobes of three kinds of light and three
/// colours and what is sent out again in both directions, what is shown by the medium and by surfaces
/// likewise, links and the medium.
const BYTES: u64 = 2 * (144 + 16) + 2 * SHOWN + 16 + 48;
/// Of these, what is shown.
const SHOWN: u64 = 96;

/// Costs of both grids.
pub struct Costs {
    of_grids: Vec<(&'static str, Cost)>,
    /// Bytes a second of propagation in the finer grid, and of a copy.
    bytes: [f64; 2],
}

impl Costs {
    /// Measures them.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(subject: &LpvFrame<'_>, runs: usize) -> Result<Self> {
        let Gpu { device, queue, .. } = subject.gpu;
        let mut of_grids = Vec::new();
        let mut moved = 0.0;
        for (cells, suffix) in GRIDS {
            let passes = subject.passes(LpvParameters {
                cells,
                cascades: 1,
                iterations: ITERATIONS,
                steps: STEPS,
                scale: SCALE,
                scheme: Scheme::OURS,
            })?;
            let cost = Cost::of(subject.gpu, &passes, runs)?;
            moved = bytes(&passes) as f64 / (1e-3 * cost.of_stage(Stage::Propagate));
            of_grids.push((suffix, cost));
        }
        let copied = gpu::ceilings(device, queue)?.copy;
        Ok(Self { of_grids, bytes: [moved, copied] })
    }

    /// Propagation in the finer grid over that in the coarser one.
    fn ratio(&self) -> f64 {
        let [coarse, fine] = [0, 1].map(|i: usize| self.of_grids[i].1.of_stage(Stage::Propagate));
        fine / coarse
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        for (suffix, cost) in &self.of_grids {
            for (stage, milliseconds) in &cost.stages {
                figures.set(&format!("ms_{}{suffix}", stage.name()), *milliseconds);
            }
            figures.set(&format!("ms_total{suffix}"), cost.total);
        }
        figures.set("ratio_64_32", self.ratio());
        figures.set("bytes_ratio", self.bytes[0] / self.bytes[1]);
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = vec![["stage", "ms at 32", "ms at 64"].map(str::to_owned).to_vec()];
        for (stage, _) in &self.of_grids[0].1.stages {
            let of = |(_, cost): &(_, Cost)| format!("{:.2}", cost.of_stage(*stage));
            rows.push(std::iter::once(stage.name().to_owned()).chain(self.of_grids.iter().map(of)).collect());
        }
        let [moved, copied] = self.bytes.map(|bytes| 1e-9 * bytes);
        rows.push(vec![format!("64 over 32: {:.1}", self.ratio()), String::new(), String::new()]);
        rows.push(vec![format!("{moved:.1} GB/s of {copied:.1}"), String::new(), String::new()]);
        rows
    }
}

/// Bytes that propagation moves at least.
fn bytes(passes: &MethodPasses) -> u64 {
    let steps = passes.steps().iter().filter(|step| step.step.pass.is_of("lpv.propagate"));
    steps.filter_map(|step| step.writes.last()).map(|shown| shown.size() / SHOWN * BYTES).sum()
}
