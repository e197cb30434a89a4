//! What a plan's passes are for, what each kind of them takes, and what memory they write.

use deepshade_render::screen::{MethodStep, Plan};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::wgsl::{self, Shader};

/// A stage of the thesis' Tables 4.1 and 6.1. What these have besides, shuffling and unshuffling, ours do not need:
/// places in sub-buffers are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Surfels are laid out, or facets of ambient occlusion volumes.
    Surfels,
    /// Their direct light.
    Light,
    /// The tree over them.
    Tree,
    /// What they do to pixels, or the rays that meet them.
    Splat,
    /// Noise is removed.
    Blur,
    /// Levels are added up.
    Sum,
}

/// Which shader belongs to which stage.
static SHADERS: [(Stage, &Shader); 34] = [
    (Stage::Surfels, &wgsl::SURFELS_VERTICES),
    (Stage::Surfels, &wgsl::SURFELS_MEASURE),
    (Stage::Surfels, &wgsl::SURFELS_SUM),
    (Stage::Surfels, &wgsl::SURFELS_TOTAL),
    (Stage::Surfels, &wgsl::SURFELS_BEGIN),
    (Stage::Surfels, &wgsl::SURFELS_PLACE),
    (Stage::Surfels, &wgsl::AOV_FACETS),
    (Stage::Light, &wgsl::SURFELS_REFLECTED),
    (Stage::Light, &wgsl::SURFELS_RECEIVED),
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
    (Stage::Blur, &wgsl::BLUR),
    (Stage::Blur, &wgsl::BOUNCED_FILTER),
    (Stage::Blur, &wgsl::BOUNCED_GLOSSY_FILTER),
    (Stage::Sum, &wgsl::SURFEL_OPENNESS),
    (Stage::Sum, &wgsl::SURFEL_INDIRECT),
    (Stage::Sum, &wgsl::SURFEL_OPEN),
    (Stage::Sum, &wgsl::SURFEL_REFLECT),
    (Stage::Sum, &wgsl::SURFEL_SCATTER),
];

impl Stage {
    /// All, in the order in which they run.
    pub const ALL: [Self; 6] = [Self::Surfels, Self::Light, Self::Tree, Self::Splat, Self::Blur, Self::Sum];

    /// Its name in figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Surfels => "surfels",
            Self::Light => "light",
            Self::Tree => "tree",
            Self::Splat => "splat",
            Self::Blur => "blur",
            Self::Sum => "sum",
        }
    }

    /// Whether a pass is one of those that lay surfels out.
    pub fn is_laying(step: &MethodStep) -> bool {
        Self::of(step) == Some(Self::Surfels)
    }

    /// That of a pass.
    fn of(step: &MethodStep) -> Option<Self> {
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
        // Passes of one stage that follow one another are timed together. Whatever runs again finds what it left, which
        // changes images and not the time.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::surfel::subject::{self, Subject};
    use crate::bench::surfel::{Args, METHODS, opened};
    use crate::methods;
    use deepshade_render::methods::Quality;
    use deepshade_shaders::Effect;

    #[test]
    fn every_pass_has_a_stage_and_stages_add_up() {
        use clap::Parser as _;
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            args: Args,
        }
        let line =
            Line::try_parse_from(["deepshade", "--scene", "room:1", "--quality", "low"]).expect("a line");
        let gpu = Gpu::new().expect("an adapter");
        let shaded = |effect: &Effect| methods::screen_names(*effect).contains(&METHODS[0]);
        let effects: Vec<Effect> = Effect::ALL.into_iter().filter(shaded).collect();
        let methods = opened(&line.args, &gpu, &effects).expect("methods");
        let attributes: Vec<_> = methods.iter().flat_map(|method| method.attributes()).copied().collect();
        let staged = subject::staged(&line.args, &effects).expect("a room");
        let size = "64x48".parse().expect("a size");
        let subject = Subject::new(&gpu, &staged, None, size, &attributes).expect("room");
        for method in &methods {
            let name = format!("{} by {}", method.effect(), method.name());
            let plan = Plan::new(method, &subject.inputs(), &subject.view).expect("a plan");
            assert!(plan.steps().iter().all(|step| Stage::of(step).is_some()), "{name}");
            let cost = Cost::of(&gpu, &plan, 1).expect("times");
            let has = |stage| cost.stages.iter().any(|(other, _)| *other == stage);
            assert!(has(Stage::Surfels) && has(Stage::Splat), "{name}: {cost:?}");
            assert_eq!(
                has(Stage::Light),
                matches!(method.effect(), Effect::Gi | Effect::Glossy | Effect::Subsurface),
                "{name}"
            );
            assert_eq!(cost.surfels[0] > 100, !method.name().starts_with("aov"), "{name}: {cost:?}");
            assert!(cost.surfels[0] <= cost.surfels[1], "{name}: {cost:?}");
            let sum: f64 = cost.stages.iter().map(|(_, time)| time).sum();
            assert!(sum > 0.0 && cost.total > 0.0 && cost.megabytes > 1.0, "{name}: {cost:?}");
        }
        assert!(subject.area_error(Quality::Low).expect("an area").abs() < 0.01);
    }
}
