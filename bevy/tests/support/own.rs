//! What deepshade makes of the same frames without Bevy.

use deepshade_infer::{Model, cpu};
use deepshade_render::exr_file::{self, Layer, Metadata};
use deepshade_render::methods::estimate::{EstimateInputs, Estimator, with_estimates};
use deepshade_shaders::{Effect, GBuffer, Planes};
use std::error::Error;
use std::path::Path;
use std::process::Command;

/// A network's image of a g-buffer, on the processor, step by step as `deepshade infer` does it there.
///
/// # Errors
/// If the g-buffer lacks something.
pub fn image(model: &Model, gbuffer: &GBuffer, radius: f32) -> Result<Planes, Box<dyn Error>> {
    let Model { spec, weights } = model;
    let named = |estimate: &deepshade_infer::AnalyticEstimate| {
        Estimator::named(estimate.effect(spec.effect), &estimate.method, &estimate.quality)
    };
    let estimators: Vec<Estimator> = spec.estimates.iter().map(named).collect::<Result<_, _>>()?;
    let inputs = EstimateInputs { gbuffer, radius, seed: 1, scene: None };
    let estimated = with_estimates(&inputs, &estimators)?;
    let prepared = spec.prepared(&estimated, radius)?;
    let scaling = spec.scaling(&prepared, radius)?;
    let input = spec.input(&prepared, scaling, 0)?;
    let made = cpu::Network::new(spec, weights)?.run(&input)?;
    let mut image = spec.image(&[made], scaling);
    spec.set_background(gbuffer, &mut image)?;
    Ok(image)
}

/// deepshade's program, and a folder for what it reads and writes.
pub struct Program<'a> {
    /// The program.
    pub program: &'a Path,
    /// The folder.
    pub folder: &'a Path,
}

impl Program<'_> {
    /// What the program makes of a g-buffer by the network in a folder, for an effect of a radius. The
    /// g-buffer is taken as it is: also what is far away is a surface.
    ///
    /// # Errors
    /// If the program fails.
    pub fn image(
        &self,
        model: &Path,
        effect: Effect,
        gbuffer: &GBuffer,
        radius: f32,
    ) -> Result<Planes, Box<dyn Error>> {
        let [read, written] = ["gbuffer.exr", "image.exr"].map(|name| self.folder.join(name));
        exr_file::write(&read, &[Layer::gbuffer(gbuffer).in_full()], &Metadata::new())?;
        let mut command = Command::new(self.program);
        command.arg("infer").arg("--model").arg(model).arg("--gbuffer").arg(&read).arg("--out").arg(&written);
        let output = command.args(["--trusted", "--radius", &radius.to_string()]).output()?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into());
        }
        Ok(exr_file::read(&written)?.image(effect.name(), effect.channels())?)
    }
}
