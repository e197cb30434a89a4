//! What a plan's passes are for, what each kind of them takes, and what memory they write.

use deepshade_render::screen::{MethodStep, Plan};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::wgsl::{self, Shader};

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

/// Which shader belongs to which stage.
static SHADERS: [(Stage, &Shader); 65] = [
    (Stage::Surfels, &wgsl::SURFELS_VERTICES),
    (Stage::Surfels, &wgsl::SURFELS_MEASURE),
    (Stage::Surfels, &wgsl::SURFELS_SUM),
    (Stage::Surfels, &wgsl::SURFELS_TOTAL),
    (Stage::Surfels, &wgsl::SURFELS_BEGIN),
    (Stage::Surfels, &wgsl::SURFELS_PLACE),
    (Stage::Surfels, &wgsl::AOV_FACETS),
    (Stage::Light, &wgsl::SURFELS_REFLECTED),
    (Stage::Light, &wgsl::SURFELS_RECEIVED),
    (Stage::Light, &wgsl::SURFELS_DIMMED),
    (Stage::Light, &wgsl::SURFELS_KEEP),
    (Stage::Light, &wgsl::SURFELS_KEEP_DIMMED),
    (Stage::Light, &wgsl::SURFELS_GIVE_BACK),
    (Stage::Light, &wgsl::PHOSPHOR_CELLS),
    (Stage::Intervals, &wgsl::VOLUME_SHELL_INTERVALS),
    (Stage::Intervals, &wgsl::VOLUME_SHELL_PAPER_INTERVALS),
    (Stage::Tree, &wgsl::SURFELS_LEAVES),
    (Stage::Tree, &wgsl::SURFELS_LIT_LEAVES),
    (Stage::Tree, &wgsl::SURFELS_PARENTS),
    (Stage::Tree, &wgsl::AOV_PARENTS),
    (Stage::Splat, &wgsl::SURFEL_OCCLUSION),
    (Stage::Splat, &wgsl::SURFEL_LIGHT),
    (Stage::Splat, &wgsl::GLOSS),
    (Stage::Splat, &wgsl::SURFEL_GLOSSY),
    (Stage::Splat, &wgsl::SURFEL_BLOCKED),
    (Stage::Splat, &wgsl::SURFEL_BODIES),
    (Stage::Splat, &wgsl::SURFEL_GIVEN),
    (Stage::Splat, &wgsl::BOUNCED_TRACE),
    (Stage::Splat, &wgsl::BOUNCED_GLOSSY_TRACE),
    (Stage::Splat, &wgsl::BOUNCED_SKY),
    (Stage::Splat, &wgsl::BOUNCED_LIGHT),
    (Stage::Splat, &wgsl::AOV_OCCLUSION),
    (Stage::Splat, &wgsl::AOV_TRACE),
    (Stage::Splat, &wgsl::VOLUME_SHELL_SPLAT),
    (Stage::Splat, &wgsl::VOLUME_SHELL_PAPER_SPLAT),
    (Stage::Blur, &wgsl::BLUR),
    (Stage::Blur, &wgsl::VOLUME_SHELL_REDUCE),
    (Stage::Blur, &wgsl::VOLUME_SHELL_EXPAND),
    (Stage::Blur, &wgsl::BOUNCED_FILTER),
    (Stage::Blur, &wgsl::BOUNCED_GLOSSY_FILTER),
    (Stage::Sum, &wgsl::SURFEL_OPENNESS),
    (Stage::Sum, &wgsl::SURFEL_INDIRECT),
    (Stage::Sum, &wgsl::SURFEL_OPEN),
    (Stage::Sum, &wgsl::SURFEL_REFLECT),
    (Stage::Sum, &wgsl::SURFEL_SCATTER),
    (Stage::Sum, &wgsl::SURFELS_IN_WATTS),
    (Stage::Sum, &wgsl::VOLUME_SHELL_ADD),
    (Stage::Direct, &wgsl::VOLUME_SHELL_DIRECT),
    (Stage::Inject, &wgsl::LPV_CLEAR),
    (Stage::Inject, &wgsl::LPV_INJECT),
    (Stage::Inject, &wgsl::LPV_FRESH),
    (Stage::Inject, &wgsl::LPV_NEST),
    (Stage::Inject, &wgsl::LPV_BORDER),
    (Stage::Inject, &wgsl::LPV_SHINE),
    (Stage::Inject, &wgsl::LPV_SHINE_KEPT),
    (Stage::Inject, &wgsl::LPV_SHINE_MEDIUM),
    (Stage::Inject, &wgsl::LPV_REFLECT),
    (Stage::Blockers, &wgsl::LPV_LINKS),
    (Stage::Medium, &wgsl::LPV_MEDIA),
    (Stage::Scatter, &wgsl::LPV_BEGIN),
    (Stage::Scatter, &wgsl::LPV_BEGIN_EMITTED),
    (Stage::Propagate, &wgsl::LPV_PROPAGATE),
    (Stage::March, &wgsl::LPV_LIT),
    (Stage::March, &wgsl::LPV_MARCH),
    (Stage::March, &wgsl::LPV_APPLY),
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
        let its = SHADERS.iter().find(|(_, shader)| step.step.pass.is_of(shader.name));
        its.map(|(stage, _)| *stage)
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
    pub fn of(gpu: &Gpu, plan: &Plan, runs: usize) -> Result<Self, GpuError> {
        let Gpu { device, queue, .. } = gpu;
        let warm_up = usize::from(runs > 1);
        let time = |record: &dyn Fn(&mut wgpu::CommandEncoder)| {
            gpu::time(device, queue, "surfel", warm_up, runs, record).map(|timing| timing.milliseconds)
        };
        let mut stages: Vec<(Stage, f64)> = Vec::new();
        // Passes of one stage that follow one another are timed together. Whatever runs again finds what it
        // left, which changes images and not the time.
        let stage_of = |step: &MethodStep| Stage::of(step).unwrap_or(Stage::Sum);
        for together in plan.steps().chunk_by(|a, b| stage_of(a) == stage_of(b)) {
            let milliseconds = time(&|encoder| {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                together.iter().for_each(|step| step.step.encode_in(&mut pass));
            })?;
            let stage = stage_of(&together[0]);
            match stages.iter_mut().find(|(other, _)| *other == stage) {
                Some((_, sum)) => *sum += milliseconds,
                None => stages.push((stage, milliseconds)),
            }
        }
        let total = time(&|encoder| plan.encode(encoder))?;
        Ok(Self { stages, total, megabytes: megabytes(plan), surfels: surfels(gpu, plan)? })
    }
}

/// Megabytes of all that a plan's passes write.
pub fn megabytes(plan: &Plan) -> f64 {
    let mut written: Vec<&wgpu::Buffer> = plan.steps().iter().flat_map(|step| &step.writes).collect();
    written.sort_unstable();
    written.dedup();
    let bytes: u64 = written.into_iter().map(wgpu::Buffer::size).sum();
    bytes as f64 * 1e-6
}

/// How many surfels the last frame has, and how many it would have with room for all.
pub fn surfels(gpu: &Gpu, plan: &Plan) -> Result<[u32; 2], GpuError> {
    let counts = plan.steps().iter().find(|step| step.step.pass.is_of(wgsl::SURFELS_TOTAL.name));
    let Some(counts) = counts.and_then(|step| step.writes.last()) else { return Ok([0; 2]) };
    let counts: Vec<u32> = gpu::read_part(&gpu.device, &gpu.queue, counts, 0, 8)?;
    Ok([counts[0], counts[1]])
}
