//! What methods estimate for a network to read: in their passes on a card, in vector instructions on the
//! processor.

use crate::methods::{LEARNED, open_screen};
use deepshade_infer::NetSpec;
use deepshade_render::method::{MethodError, Repeats};
use deepshade_render::methods::Quality;
use deepshade_render::methods::estimate::{EstimateError, Estimator};
use deepshade_render::scene::Camera;
use deepshade_render::screen::{GpuGBuffer, Inputs, Plan, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use deepshade_shaders::{GBuffer, lists};
use glam::Vec3;
use web_time::Instant;

/// Chooses the random numbers of estimates: the same in each frame, so that their noise stands still.
const SEED: u32 = 1;

/// The methods that a network's spec names.
pub struct Estimates {
    methods: Vec<(Estimator, Option<Box<dyn ScreenMethod>>)>,
}

impl Estimates {
    /// Opens them: for an adapter where there is one, else for the processor.
    ///
    /// # Errors
    /// If there is no such method, or the adapter refuses its passes.
    pub fn new(gpu: Option<&Gpu>, spec: &NetSpec) -> Result<Self, MethodError> {
        let other = |what: String| MethodError::Other { method: LEARNED, what };
        let open = |estimate: &deepshade_infer::Estimate| {
            let unknown = |error: EstimateError| other(error.to_string());
            let estimator = Estimator::named(&estimate.method, &estimate.quality).map_err(unknown)?;
            let quality = Quality::ALL.into_iter().find(|quality| quality.name() == estimate.quality);
            // A web page may not wait for a card.
            let waits = !cfg!(target_arch = "wasm32");
            let card = gpu.filter(|_| waits).zip(quality);
            let passes = card.map(|(gpu, quality)| open_screen(spec.effect, &estimate.method, gpu, quality));
            let passes = passes.transpose().map_err(|error| other(format!("{error:#}")))?;
            Ok((estimator, passes))
        };
        Ok(Self { methods: spec.estimates.iter().map(open).collect::<Result<_, _>>()? })
    }

    /// The g-buffer with what they make, and how many milliseconds that took; none where a network reads no
    /// estimates.
    ///
    /// # Errors
    /// If the g-buffer lacks something or the device fails.
    pub fn of(
        &self,
        gbuffer: &GBuffer,
        radius: f32,
        repeats: Repeats,
    ) -> Result<(Option<GBuffer>, f64), MethodError> {
        let mut with: Option<GBuffer> = None;
        let mut milliseconds = 0.0;
        for (estimator, passes) in &self.methods {
            let (made, time) = match passes {
                Some(method) => on_card(method.as_ref(), gbuffer, radius, repeats)?,
                None => on_processor(estimator, gbuffer, radius, repeats)?,
            };
            milliseconds += time;
            with = Some(with.as_ref().unwrap_or(gbuffer).with(estimator.makes(), &made));
        }
        Ok((with, milliseconds))
    }
}

fn on_processor(
    estimator: &Estimator,
    gbuffer: &GBuffer,
    radius: f32,
    repeats: Repeats,
) -> Result<(Vec<f32>, f64), MethodError> {
    let run = || {
        estimator
            .on_processor(gbuffer, radius, SEED)
            .map_err(|source| MethodError::Missing { method: LEARNED, source })
    };
    timed(run, repeats)
}

/// What work comes to, and the median of the milliseconds that it takes.
pub fn timed<T>(
    mut work: impl FnMut() -> Result<T, MethodError>,
    repeats: Repeats,
) -> Result<(T, f64), MethodError> {
    (0..repeats.warm_up).try_for_each(|_| work().map(drop))?;
    let mut times = Vec::with_capacity(repeats.timed);
    loop {
        let start = Instant::now();
        let made = work()?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
        if times.len() >= repeats.timed {
            return Ok((made, lists::median(times)));
        }
    }
}

/// A method's image and what its first pass writes, which is that before its blur.
fn on_card(
    method: &dyn ScreenMethod,
    gbuffer: &GBuffer,
    radius: f32,
    repeats: Repeats,
) -> Result<(Vec<f32>, f64), MethodError> {
    let failed = |source: GpuError| MethodError::Gpu { method: LEARNED, source };
    let missing = |source| MethodError::Missing { method: LEARNED, source };
    let Gpu { device, queue, .. } = method.gpu();
    let seen = GpuGBuffer::upload(device, gbuffer, method.attributes())
        .map_err(|error| MethodError::Other { method: LEARNED, what: error.to_string() })?;
    let (height, width) = (gbuffer.height(), gbuffer.width());
    let vertical_fov = 2.0 * (0.5 * height as f32 / gbuffer.focal_length().map_err(missing)?).atan();
    let camera = Camera { vertical_fov, ..Camera::look_at(Vec3::ZERO, Vec3::NEG_Z) };
    let view = View { height, width, camera, radius, seed: SEED };
    let inputs = Inputs { gbuffer: &seen, environment: None, world: None };
    let plan = Plan::new(method, &inputs, &view).map_err(failed)?;
    let timing = gpu::time(device, queue, method.name(), repeats.warm_up, repeats.timed, |encoder| {
        plan.encode(encoder);
    })
    .map_err(failed)?;
    let image: Vec<f32> = gpu::read(device, queue, plan.output()).map_err(failed)?;
    let Some(first) = plan.steps().first() else {
        return Ok(([image.clone(), image].concat(), timing.milliseconds));
    };
    // Later passes write where the first one did: it runs once more by itself.
    gpu::submit(device, queue, method.name(), |encoder| {
        first.step.encode(encoder, "deepshade.estimate", None)
    })
    .map_err(failed)?;
    let raw = first.writes.first().unwrap_or_else(|| plan.output());
    let raw: Vec<f32> = gpu::read(device, queue, raw).map_err(failed)?;
    Ok(([&image[..], &raw[..height * width]].concat(), timing.milliseconds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::bvh::TracedScene;
    use deepshade_render::gbuffer;
    use deepshade_render::scene::SceneSource;
    use deepshade_shaders::{Attribute, Effect};

    #[test]
    fn passes_and_processor_estimate_the_same() {
        let gpu = Gpu::new().expect("an adapter");
        let stairs: SceneSource = "stairs:7".parse().expect("a family");
        let scene = TracedScene::new(stairs.scene(0.0).expect("a scene")).expect("a scene");
        let camera = Camera::look_at(Vec3::new(0.3, 1.0, 1.0), Vec3::new(0.0, 0.4, -4.0));
        let (height, width) = (40, 56);
        let gbuffer = gbuffer::render(&scene, &camera, height, width, &Attribute::ALL);
        let method = open_screen(Effect::Ao, "gtao", &gpu, Quality::Low).expect("a method");
        let (passes, _) = on_card(method.as_ref(), &gbuffer, 0.5, Repeats::ONCE).expect("runs");
        let estimator = Estimator::named("gtao", "low").expect("known");
        let (vectors, _) = on_processor(&estimator, &gbuffer, 0.5, Repeats::ONCE).expect("runs");
        assert_eq!(passes.len(), 2 * height * width);
        let far = passes.iter().zip(&vectors).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
        assert!(far * 50 < passes.len(), "{far} of {} numbers", passes.len());
        let (image, raw) = passes.split_at(height * width);
        assert!(image.iter().zip(raw).any(|(image, raw)| (image - raw).abs() > 0.02), "one is blurred");
    }
}
