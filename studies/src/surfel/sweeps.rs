//! What threshold, levels and resolution do to the time of ambient occlusion, and to its image: how far it is
//! from the one that every surfel makes at every pixel.

use super::subject::SurfelFrame;
use crate::stages::Cost;
use deepshade_render::methods::disks::Disks;
use deepshade_render::methods::surfel::{SurfelParameters, occlusion::OCCLUSION};
use deepshade_render::screen::{Device, MethodPasses, ScreenMethod, upsampling};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{Effect, Planes};
use serde_json::json;

/// Thresholds of the thesis' Figure 4.11.
const THRESHOLDS: [f32; 4] = [0.8, 0.4, 0.1, 0.01];
/// Numbers of levels there.
const LEVELS: [u32; 4] = [2, 3, 4, 5];

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variant {
    /// Every surfel on every pixel.
    FullResolution,
    /// The same on a quarter of the pixels, brought to full size.
    HalfResolution,
    /// So many levels.
    Levels(u32),
    /// Another threshold.
    Threshold(f32),
}

/// A variant and what it costs.
#[derive(Clone, Debug)]
pub struct Row {
    variant: Variant,
    milliseconds: f64,
    /// Root of the mean squared difference from the image of full resolution.
    difference: f64,
}

impl Row {
    /// As JSON.
    pub fn to_json(&self) -> serde_json::Value {
        json!({ "variant": self.variant.to_string(), "ms": self.milliseconds, "difference": self.difference })
    }
}

impl std::fmt::Display for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::FullResolution => f.write_str("full resolution"),
            Self::HalfResolution => f.write_str("half resolution"),
            Self::Levels(levels) => write!(f, "{levels} levels"),
            Self::Threshold(threshold) => write!(f, "threshold {threshold}"),
        }
    }
}

/// Measures all variants of some parameters on a frame, and on `half`, the same of half as many rows and
/// columns.
///
/// # Errors
/// If the device fails.
pub fn run(
    gpu: &Gpu,
    [subject, half]: [&SurfelFrame<'_>; 2],
    usual: SurfelParameters,
    runs: usize,
) -> Result<Vec<Row>, GpuError> {
    let method = ScreenMethod::new(gpu, Disks::new(usual, OCCLUSION));
    let flat = SurfelParameters { levels: 1, ..usual };
    let shaded = |subject: &SurfelFrame<'_>, parameters: SurfelParameters| {
        let method = method.with(Disks::new(parameters, OCCLUSION));
        let passes = MethodPasses::new(&method, &subject.inputs(), &subject.view)?;
        let cost = Cost::of(gpu, &passes, runs)?;
        Ok::<_, GpuError>((passes, cost.total))
    };
    let image = |passes: &MethodPasses| -> Result<Planes, GpuError> { made(gpu, subject, passes.output()) };

    let (passes, milliseconds) = shaded(subject, flat)?;
    let wanted = image(&passes)?;
    let mut rows = vec![Row { variant: Variant::FullResolution, milliseconds, difference: 0.0 }];
    let (passes, few) = shaded(half, flat)?;
    let (found, upsampling) = upsampled(gpu, [subject, half], &passes, runs)?;
    let difference = difference(&found, &wanted);
    rows.push(Row { variant: Variant::HalfResolution, milliseconds: few + upsampling, difference });
    let mut levels = LEVELS.to_vec();
    levels.push(usual.levels);
    let levels =
        levels.into_iter().map(|levels| (Variant::Levels(levels), SurfelParameters { levels, ..usual }));
    let thresholds =
        THRESHOLDS.map(|threshold| (Variant::Threshold(threshold), SurfelParameters { threshold, ..usual }));
    for (variant, parameters) in levels.chain(thresholds) {
        let (passes, milliseconds) = shaded(subject, parameters)?;
        let difference = self::difference(&image(&passes)?, &wanted);
        rows.push(Row { variant, milliseconds, difference });
    }
    Ok(rows)
}

/// The image of half the resolution in full size, and the milliseconds that this takes.
fn upsampled(
    gpu: &Gpu,
    [subject, half]: [&SurfelFrame<'_>; 2],
    passes: &MethodPasses,
    runs: usize,
) -> Result<(Planes, f64), GpuError> {
    let Gpu { device, queue, .. } = gpu;
    let (full, few) = (subject.inputs().gbuffer, half.inputs().gbuffer);
    let image = gpu::empty::<f32>(device, "bench.surfel.upsampled", full.height() * full.width())?;
    let compiled = Device::new(device);
    let [size, small] = [full, few].map(|of| [of.height(), of.width()]);
    let settings = upsampling::settings(size, small, Effect::Ao);
    let step = upsampling::step(&compiled, (Effect::Ao, &settings), (few, passes.output()), (full, &image))?;
    let record = |encoder: &mut wgpu::CommandEncoder| step.step.encode(encoder, "upsampling", None);
    let timing = gpu::time(device, queue, "upsampling", usize::from(runs > 1), runs, record)?;
    Ok((made(gpu, subject, &image)?, timing.milliseconds))
}

fn made(gpu: &Gpu, subject: &SurfelFrame<'_>, image: &wgpu::Buffer) -> Result<Planes, GpuError> {
    let data = gpu::read(&gpu.device, &gpu.queue, image)?;
    Ok(Planes::from_data(1, subject.view.height, subject.view.width, data))
}

fn difference(a: &Planes, b: &Planes) -> f64 {
    let squares = a.data().iter().zip(b.data()).map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / a.data().len() as f64).sqrt()
}

/// Milliseconds with every surfel on every pixel over those with as many levels as usual.
pub fn ratio_fullres(rows: &[Row], usual: &SurfelParameters) -> Option<f64> {
    let of = |wanted: Variant| rows.iter().find(|row| row.variant == wanted).map(|row| row.milliseconds);
    Some(of(Variant::FullResolution)? / of(Variant::Levels(usual.levels))?)
}

/// The rows as a table.
pub fn table(rows: &[Row]) -> Vec<Vec<String>> {
    let head = ["ambient occlusion by surfels", "ms", "difference"].map(str::to_owned).to_vec();
    let row = |row: &Row| {
        vec![row.variant.to_string(), format!("{:.2}", row.milliseconds), format!("{:.4}", row.difference)]
    };
    std::iter::once(head).chain(rows.iter().map(row)).collect()
}
