//! What methods estimate for a network to read, on the processor: in vector instructions where a method has
//! such a version.

use crate::methods::LEARNED;
use deepshade_infer::{AnalyticEstimate, NetSpec};
use deepshade_render::method::{MethodError, Repeats};
use deepshade_render::methods::estimate::{EstimateError, EstimateInputs, Estimator};
use deepshade_render::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Attribute, GBuffer, lists};
use web_time::Instant;

/// Chooses the random numbers of estimates: the same in each frame, so that their noise stands still.
pub const SEED: u32 = 1;

/// The methods that a network's spec names.
pub struct Estimates {
    methods: Vec<Estimator>,
}

impl Estimates {
    /// Of a network.
    ///
    /// # Errors
    /// If there is no such method or quality.
    pub fn new(spec: &NetSpec) -> Result<Self, MethodError> {
        let methods = spec.estimates.iter().map(|estimate| estimator(spec, estimate));
        Ok(Self { methods: methods.collect::<Result<_, _>>()? })
    }

    /// The g-buffer with what they make, and how many milliseconds that took; none where a network reads no
    /// estimates, or has them.
    ///
    /// # Errors
    /// If the g-buffer lacks something, or the scene is not known and has to be.
    pub fn of(
        &self,
        inputs: &EstimateInputs<'_>,
        repeats: Repeats,
    ) -> Result<(Option<GBuffer>, f64), MethodError> {
        let mut with: Option<GBuffer> = None;
        let mut milliseconds = 0.0;
        for estimator in
            self.methods.iter().filter(|estimator| !estimator.is_made(inputs.gbuffer.attributes()))
        {
            let run = || estimator.on_processor(inputs).map_err(no_estimate);
            let (made, time) = timed(run, repeats)?;
            milliseconds += time;
            with = Some(with.as_ref().unwrap_or(inputs.gbuffer).with(estimator.makes(), &made));
        }
        Ok((with, milliseconds))
    }
}

/// The error of a method for what a network reads.
pub fn no_estimate(error: EstimateError) -> MethodError {
    match error {
        EstimateError::Missing(source) => MethodError::Missing { method: LEARNED, source },
        EstimateError::Method(error) => error,
        other => MethodError::Other { method: LEARNED, what: other.to_string() },
    }
}

/// The method that a spec names.
///
/// # Errors
/// If there is no such method or quality.
pub fn estimator(spec: &NetSpec, estimate: &AnalyticEstimate) -> Result<Estimator, MethodError> {
    let AnalyticEstimate { method, quality, .. } = estimate;
    Estimator::named(estimate.effect(spec.effect), method, quality).map_err(no_estimate)
}

/// The methods that look at the scene itself and estimate what a network reads, with what each makes.
///
/// # Errors
/// If there is no such method or quality.
pub fn of_scene(gpu: &Gpu, spec: &NetSpec) -> Result<Vec<(Attribute, ScreenMethod)>, MethodError> {
    let mut methods = Vec::new();
    for estimate in &spec.estimates {
        let estimator = estimator(spec, estimate)?;
        if estimator.reads_scene() {
            methods.push((estimator.makes()[0], estimator.on(gpu)));
        }
    }
    Ok(methods)
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
