//! Partial sums and the march on the GPU at equal error (the paper's section 9: 3.6 to 4.1 times on a GTX
//! 480).
//!
//! Both read the frame's shadow maps; errors are against a march of many steps through the same maps.

use super::equal_error::{TimeAndError, fewest};
use super::subject::{Kind, Setup, View, setting};
use super::table_number;
use anyhow::{Context, Result};
use deepshade::shared::figures::Figures;
use deepshade_render::methods::Quality;
use deepshade_render::methods::{fog_march, gpu_epipolar};
use deepshade_render::metrics::{exposed, exposure, relative_mse};
use deepshade_render::raster::frame::{Frame, FrameStage, RasterSettings};
use deepshade_render::screen::{self, Inputs, MethodPasses, ScreenMethod};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect, Planes};
use serde_json::{Value, json};

/// Steps of the march that errors are against.
const REFERENCE_STEPS: u32 = 4096;
/// The fewest and the most steps that are tried.
const STEPS: [u32; 2] = [8, 2048];
/// Rows and columns of a software adapter's images, on which everything runs once.
const OF_SOFTWARE: [usize; 2] = [72, 96];
/// Timed runs on a graphics card.
const RUNS: usize = 50;

/// What was measured on an adapter.
pub struct OnGpu {
    adapter: String,
    size: [usize; 2],
    comparisons: Vec<SumsAgainstMarch>,
}

/// Partial sums of a scene and view, and the march that is as good.
struct SumsAgainstMarch {
    name: String,
    sums: TimeAndError,
    /// Its steps, and what it is; `None` if no march is.
    march: Option<(u32, TimeAndError)>,
}

/// A frame that both are run on.
struct BenchFrame<'a> {
    gpu: &'a Gpu,
    frame: Frame,
    view: screen::View,
    runs: usize,
}

impl OnGpu {
    /// Measures all scenes and views.
    ///
    /// # Errors
    /// If the device fails or has no room.
    pub fn of(gpu: &Gpu, setup: Setup) -> Result<Self> {
        let setup = if gpu.is_software() { Setup { size: OF_SOFTWARE, ..setup } } else { setup };
        let mut comparisons = Vec::new();
        for kind in Kind::ALL {
            for view in View::ALL {
                comparisons.push(SumsAgainstMarch::of(
                    &BenchFrame::new(gpu, kind, view, setup)?,
                    kind.called(view),
                )?);
            }
        }
        Ok(Self { adapter: gpu.info.name.clone(), size: setup.size, comparisons })
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        for comparison in &self.comparisons {
            figures.set(&format!("gpu_ratio_{}", comparison.name), comparison.ratio());
        }
        let ratios = || self.comparisons.iter().map(SumsAgainstMarch::ratio);
        figures.set("gpu_ratio_min", ratios().fold(f64::INFINITY, f64::min));
        figures.set("gpu_ratio_max", ratios().fold(0.0, f64::max));
    }

    /// Everything that was measured.
    pub fn to_json(&self) -> Value {
        let measured = |found: &TimeAndError| json!({ "seconds": found.seconds, "relmse": found.relmse });
        let comparison = |comparison: &SumsAgainstMarch| {
            json!({
                "name": comparison.name, "sums": measured(&comparison.sums),
                "march": comparison.march.as_ref().map(|(steps, found)| json!([steps, measured(found)])),
            })
        };
        json!({
            "adapter": self.adapter, "size": self.size,
            "duels": self.comparisons.iter().map(comparison).collect::<Vec<_>>(),
        })
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["on the GPU", "relmse", "sums ms", "steps", "march ms", "times as fast"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for SumsAgainstMarch { name, sums, march } in &self.comparisons {
            let of_march = |text: &dyn Fn(u32, &TimeAndError) -> String| {
                march.as_ref().map_or("worse".to_owned(), |(steps, found)| text(*steps, found))
            };
            rows.push(vec![
                name.clone(),
                table_number(sums.relmse),
                format!("{:.2}", 1e3 * sums.seconds),
                of_march(&|steps, _| steps.to_string()),
                of_march(&|_, found| format!("{:.2}", 1e3 * found.seconds)),
                of_march(&|_, found| format!("{:.1}", found.seconds / sums.seconds)),
            ]);
        }
        rows
    }

    /// What it ran on, in words.
    pub fn title(&self) -> String {
        let [height, width] = self.size;
        format!("{} at {width}x{height}", self.adapter)
    }
}

impl SumsAgainstMarch {
    fn of(stand: &BenchFrame<'_>, name: String) -> Result<Self> {
        let truth = stand.image(&march(stand.gpu, REFERENCE_STEPS))?;
        let exposure = exposure(Effect::FogDirect, &truth);
        let truth = exposed(&truth, exposure);
        let error = |method: &ScreenMethod| {
            anyhow::Ok(relative_mse(&exposed(&stand.image(method)?, exposure), &truth))
        };
        let sums = ScreenMethod::new(stand.gpu, gpu_epipolar::GpuEpipolarParameters::of(Quality::High));
        let sums = TimeAndError { relmse: error(&sums)?, seconds: stand.seconds(&sums)? };
        let is_enough = |steps| anyhow::Ok(error(&march(stand.gpu, steps))? <= sums.relmse);
        let march = fewest(STEPS, is_enough)?.map(|steps| {
            let march = march(stand.gpu, steps);
            anyhow::Ok((steps, TimeAndError { relmse: error(&march)?, seconds: stand.seconds(&march)? }))
        });
        Ok(Self { name, sums, march: march.transpose()? })
    }

    /// How many times as long the march takes; no number if none is as good.
    fn ratio(&self) -> f64 {
        self.march.map_or(f64::NAN, |(_, march)| march.seconds / self.sums.seconds)
    }
}

fn march(gpu: &Gpu, steps: u32) -> ScreenMethod {
    ScreenMethod::new(gpu, fog_march::FogMarchParameters { steps })
}

impl<'a> BenchFrame<'a> {
    fn new(gpu: &'a Gpu, kind: Kind, view: View, setup: Setup) -> Result<Self> {
        let (scene, camera) = setting(kind, view, setup.size)?;
        let [height, width] = setup.size;
        let attributes = vec![Attribute::Position, Attribute::Valid];
        let settings = RasterSettings { height, width, attributes, shadow_size: Some(setup.shadow_size) };
        let mut frame = Frame::new(gpu, &scene.into(), &settings)?;
        frame.set(&gpu.queue, 0.0, 0.0, &camera);
        gpu::submit(&gpu.device, &gpu.queue, "bench.epipolar", |encoder| {
            FrameStage::ALL.into_iter().for_each(|stage| frame.encode(stage, encoder, None));
        })?;
        let view = screen::View { height, width, camera, radius: 1.0, seed: 1 };
        Ok(Self { gpu, frame, view, runs: if gpu.is_software() { 1 } else { RUNS } })
    }

    fn passes(&self, method: &ScreenMethod) -> Result<MethodPasses> {
        let inputs =
            Inputs { gbuffer: self.frame.gbuffer(), environment: None, world: Some(self.frame.world()) };
        MethodPasses::new(method, &inputs, &self.view).with_context(|| method.name())
    }

    fn image(&self, method: &ScreenMethod) -> Result<Planes> {
        let Gpu { device, queue, .. } = self.gpu;
        let passes = self.passes(method)?;
        gpu::submit(device, queue, "bench.epipolar.image", |encoder| passes.encode(encoder))?;
        let data = gpu::read(device, queue, passes.output())?;
        Ok(Planes::from_data(3, self.view.height, self.view.width, data))
    }

    fn seconds(&self, method: &ScreenMethod) -> Result<f64> {
        let Gpu { device, queue, .. } = self.gpu;
        let passes = self.passes(method)?;
        let timing =
            gpu::time(device, queue, "bench.epipolar", 1, self.runs, |encoder| passes.encode(encoder))?;
        Ok(1e-3 * timing.milliseconds)
    }
}
