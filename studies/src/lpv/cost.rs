//! What each stage takes, as in the paper's Table 1.

use super::subject::LpvFrame;
use crate::cards::{GTX_480, Timed};
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
/// The paper's milliseconds of propagation in cubes of as many cells along an edge (Table 1), on a GTX 480.
const PAPER: [f64; 2] = [1.49, 12.3];
/// Bytes that its iteration reads and writes of a cell at least: four numbers of three colours in both
/// directions, and what is summed up likewise.
const PAPER_BYTES: u64 = 2 * (48 + 48);

/// Costs of both grids.
pub struct Costs {
    of_grids: Vec<(&'static str, Cost)>,
    /// Of both, bytes that propagation moves at least over those that a copy does meanwhile.
    shares: Vec<f64>,
}

impl Costs {
    /// Measures them.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(subject: &LpvFrame<'_>, runs: usize) -> Result<Self> {
        let Gpu { device, queue, .. } = subject.gpu;
        let at_best = gpu::ceilings(device, queue)?;
        let (mut of_grids, mut shares) = (Vec::new(), Vec::new());
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
            let propagation = Timed { milliseconds: cost.of_stage(Stage::Propagate), at_best };
            shares.push(propagation.share_of_copy(bytes(&passes) as f64));
            of_grids.push((suffix, cost));
        }
        Ok(Self { of_grids, shares })
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
        figures.set("bytes_ratio", self.shares[1]);
        figures.set("bytes_ratio_paper", paper_shares()[1]);
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = vec![["stage", "ms at 32", "ms at 64"].map(str::to_owned).to_vec()];
        for (stage, _) in &self.of_grids[0].1.stages {
            let of = |(_, cost): &(_, Cost)| format!("{:.2}", cost.of_stage(*stage));
            rows.push(std::iter::once(stage.name().to_owned()).chain(self.of_grids.iter().map(of)).collect());
        }
        rows.push(vec![format!("64 over 32: {:.1}", self.ratio()), String::new(), String::new()]);
        for (name, shares) in [("share of a copy", &self.shares[..]), ("the paper's", &paper_shares()[..])] {
            let shares = shares.iter().map(|share| format!("{:.1} %", 100.0 * share));
            rows.push(std::iter::once(name.to_owned()).chain(shares).collect());
        }
        rows
    }
}

/// The same of the paper's propagation on its card.
fn paper_shares() -> [f64; 2] {
    [0, 1].map(|i: usize| {
        let bytes = GRIDS[i].0.pow(3) as u64 * ITERATIONS as u64 * PAPER_BYTES;
        Timed { milliseconds: PAPER[i], at_best: GTX_480 }.share_of_copy(bytes as f64)
    })
}

/// Bytes that propagation moves at least.
fn bytes(passes: &MethodPasses) -> u64 {
    let steps = passes.steps().iter().filter(|step| step.step.pass.is_of("lpv.propagate"));
    steps.filter_map(|step| step.writes.last()).map(|shown| shown.size() / SHOWN * BYTES).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade::shared::arguments::Size;
    use deepshade_render::scene::SceneSource;

    #[test]
    fn propagation_moves_its_bytes_of_each_cell_in_each_iteration() {
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        let scene: SceneSource = "colonnade:1".parse().expect("a scene");
        let subject = LpvFrame::new(&gpu, &scene, Size { width: 16, height: 16 }).expect("a frame");
        let parameters =
            LpvParameters { cells: 12, cascades: 1, iterations: 3, steps: 4, scale: 1, scheme: Scheme::OURS };
        let passes = subject.passes(parameters).expect("room");
        let cells = subject.grid(parameters).cells() as u64;
        // Nine lobes and what is sent out again there and back, six sums likewise, links and the medium.
        assert_eq!(bytes(&passes), 3 * cells * 16 * (2 * 10 + 2 * 6 + 1 + 3));
    }

    #[test]
    fn the_paper_moves_a_fifth_of_what_its_card_copies() {
        // 402.7 and 50.3 MB.
        let [coarse, fine] = paper_shares();
        assert!((fine - 0.1845).abs() < 1e-3 && (coarse - 0.1904).abs() < 1e-3, "{coarse} {fine}");
    }
}
