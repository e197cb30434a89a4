//! What a method's passes are for, what each kind of them takes, and what memory they write.

use deepshade_render::method::Repeats;
use deepshade_render::screen::{MethodPasses, MethodStep};
use deepshade_shaders::gpu::{self, Gpu, GpuError};

/// A stage of the thesis' Tables 4.1, 5.1 and 6.1. What these have besides, shuffling and unshuffling, ours
/// do not need: places in sub-buffers are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Surfels are laid out, or facets of ambient occlusion volumes.
    Surfels,
    /// Their direct light.
    Light,
    /// Rays through a medium are divided into intervals.
    Intervals,
    /// The tree over them.
    Tree,
    /// What they do to pixels, or the rays that meet them.
    Splat,
    /// Noise is removed.
    Blur,
    /// Levels are added up.
    Sum,
    /// Direct light that a medium scatters.
    Direct,
    /// Surfels as light and blockers of a volume.
    Inject,
    /// What passes between its cells.
    Blockers,
    /// What the medium in its cells does.
    Medium,
    /// Light of the lamps that its cells scatter.
    Scatter,
    /// Light is handed on.
    Propagate,
    /// Pixels are lit by a volume.
    March,
}

/// Labels of the passes of each stage.
const PASSES: [(Stage, &[&str]); 14] = [
    (
        Stage::Surfels,
        &[
            "surfels.vertices",
            "surfels.measure",
            "surfels.sum",
            "surfels.total",
            "surfels.begin",
            "surfels.place",
            "aov.facets",
        ],
    ),
    (
        Stage::Light,
        &[
            "surfels.reflected",
            "surfels.received",
            "surfels.dimmed",
            "surfels.emit",
            "surfels.keep",
            "surfels.keep_dimmed",
            "surfels.give_back",
            "phosphor.cells",
        ],
    ),
    (Stage::Intervals, &["volume-shell.intervals", "volume-shell.paper_intervals"]),
    (Stage::Tree, &["surfels.leaves", "surfels.lit_leaves", "surfels.parents", "aov.parents"]),
    (
        Stage::Splat,
        &[
            "surfel.occlusion",
            "surfel.light",
            "gloss",
            "surfel.glossy",
            "surfel.blocked",
            "surfel.bodies",
            "surfel.given",
            "bounced-z.trace",
            "bounced-z.glossy_trace",
            "bounced-z.sky",
            "bounced-z.light",
            "bounced-z.environment",
            "bounced-z.bounce",
            "aov.occlusion",
            "aov.trace",
            "volume-shell.splat",
            "volume-shell.paper_splat",
        ],
    ),
    (
        Stage::Blur,
        &[
            "blur.smooth",
            "volume-shell.reduce",
            "volume-shell.expand",
            "bounced-z.filter",
            "bounced-z.glossy_filter",
        ],
    ),
    (
        Stage::Sum,
        &[
            "surfel.openness",
            "surfel.indirect",
            "surfel.open",
            "surfel.reflect",
            "surfel.scatter",
            "surfels.in_watts",
            "bounced-z.share",
            "volume-shell.add",
        ],
    ),
    (Stage::Direct, &["volume-shell.direct"]),
    (
        Stage::Inject,
        &[
            "lpv.clear",
            "lpv.inject",
            "lpv.fresh",
            "lpv.nest",
            "lpv.border",
            "lpv.shine",
            "lpv.shine_kept",
            "lpv.shine_medium",
            "lpv.reflect",
        ],
    ),
    (Stage::Blockers, &["lpv.links"]),
    (Stage::Medium, &["lpv.media"]),
    (Stage::Scatter, &["lpv.begin", "lpv.begin_emitted"]),
    (Stage::Propagate, &["lpv.propagate"]),
    (Stage::March, &["lpv.lit", "lpv.march", "lpv.apply"]),
];

impl Stage {
    /// All, in the order in which they run.
    pub const ALL: [Self; 14] = [
        Self::Surfels,
        Self::Light,
        Self::Tree,
        Self::Intervals,
        Self::Splat,
        Self::Blur,
        Self::Sum,
        Self::Direct,
        Self::Inject,
        Self::Blockers,
        Self::Medium,
        Self::Scatter,
        Self::Propagate,
        Self::March,
    ];

    /// Its name in figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Surfels => "surfels",
            Self::Light => "light",
            Self::Tree => "tree",
            Self::Intervals => "intervals",
            Self::Splat => "splat",
            Self::Blur => "blur",
            Self::Sum => "sum",
            Self::Direct => "direct",
            Self::Inject => "inject",
            Self::Blockers => "blockers",
            Self::Medium => "medium",
            Self::Scatter => "scatter",
            Self::Propagate => "propagate",
            Self::March => "march",
        }
    }

    /// Whether a pass is one of those that lay surfels out.
    pub fn is_laying(step: &MethodStep) -> bool {
        Self::of(step) == Some(Self::Surfels)
    }

    /// That of a pass.
    pub fn of(step: &MethodStep) -> Option<Self> {
        let is_of = |(_, labels): &&(Self, &[&str])| labels.iter().any(|label| step.step.pass.is_of(label));
        PASSES.iter().find(is_of).map(|(stage, _)| *stage)
    }
}

/// What a method costs on a frame.
#[derive(Clone, Debug)]
pub struct Cost {
    /// Milliseconds of each stage that it has.
    pub stages: Vec<(Stage, f64)>,
    /// Of all, one after the other without a pause.
    pub total: f64,
    /// Of what its passes write, surfels and their tree among it.
    pub megabytes: f64,
    /// Surfels that there are, and that there would be with room for all.
    pub surfels: [u32; 2],
}

impl Cost {
    /// Milliseconds of a stage; 0 where there is none.
    pub fn of_stage(&self, stage: Stage) -> f64 {
        self.stages.iter().filter(|(other, _)| *other == stage).map(|(_, time)| time).sum()
    }

    /// How many surfels there are, and of how many where there is no room for all.
    pub fn surfels_in_words(&self) -> String {
        let [kept, wanted] = self.surfels;
        if kept == wanted { kept.to_string() } else { format!("{kept} of {wanted}") }
    }

    /// Measures it.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, passes: &MethodPasses, runs: usize) -> Result<Self, GpuError> {
        let repeats = Repeats { warm_up: usize::from(runs > 1), timed: runs };
        let times = passes.times(gpu, repeats, |step| Stage::of(step).unwrap_or(Stage::Sum))?;
        let stages = times.into_iter().map(|time| (time.key, time.milliseconds)).collect();
        let total = gpu::time(&gpu.device, &gpu.queue, "surfel", repeats.warm_up, runs, |encoder| {
            passes.encode(encoder);
        })?;
        let total = total.milliseconds;
        Ok(Self { stages, total, megabytes: megabytes(passes), surfels: surfels(gpu, passes)? })
    }
}

/// Megabytes of all that a method's passes write.
pub fn megabytes(passes: &MethodPasses) -> f64 {
    let mut written: Vec<&wgpu::Buffer> = passes.steps().iter().flat_map(|step| &step.writes).collect();
    written.sort_unstable();
    written.dedup();
    let bytes: u64 = written.into_iter().map(wgpu::Buffer::size).sum();
    bytes as f64 * 1e-6
}

/// How many surfels the last frame has, and how many it would have with room for all.
pub fn surfels(gpu: &Gpu, passes: &MethodPasses) -> Result<[u32; 2], GpuError> {
    let counts = passes.steps().iter().find(|step| step.step.pass.is_of("surfels.total"));
    let Some(counts) = counts.and_then(|step| step.writes.last()) else { return Ok([0; 2]) };
    let counts: Vec<u32> = gpu::read_part(&gpu.device, &gpu.queue, counts, 0, 8)?;
    Ok([counts[0], counts[1]])
}
