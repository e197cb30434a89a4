//! Which kernels are the fastest on a device: measured once, remembered in a file.

use super::maps::has_means;
use super::tuning_file::{Layers, Measured, Timed, TuningFile};
use super::variant::shapes;
use super::{ForwardError, HALF_TOLERANCE, Network, Options, OutputKind, Precision, Shape, Variant};
use crate::parity::{TOLERANCE, first_difference_within, noise};
use crate::{Activation, NetSpec, Source, Weights, reference};
use deepshade_shaders::gpu::{Gpu, adapter_key};
use std::io;
use std::path::Path;

/// Runs of each kernel before the clock counts, and runs that count.
const WARM_UP: usize = 1;
const TIMED: usize = 3;
/// Rows and columns of the image on which every kernel must be right before it is measured.
const PROOF: [usize; 2] = [37, 53];

/// What was measured on devices, layer shape by layer shape.
#[derive(Debug)]
pub struct Tuning {
    file: TuningFile,
    device: String,
    workgroup_bytes: u32,
}

impl Tuning {
    /// Nothing measured yet.
    pub fn new(device: &wgpu::Device) -> Self {
        Self::of(device, TuningFile::default())
    }

    /// What a file remembers of a device, and in words why a file was of no use. A missing file remembers nothing.
    pub fn load(device: &wgpu::Device, path: &Path) -> (Self, Option<String>) {
        let (file, note) = TuningFile::load(path);
        (Self::of(device, file), note)
    }

    /// Writes all into a file, whose folder is made where there is none.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        self.file.save(path)
    }

    /// The fastest kernels for a network that is to run with these options, if all of its layers were measured.
    pub fn variant(&self, spec: &NetSpec, options: &Options<'_>) -> Option<Variant> {
        let measured = self.file.devices.get(&self.device)?;
        let layers: Option<Vec<&Measured>> = (0..spec.layers().len())
            .map(|index| measured.get(&key(spec, index, options.precision)))
            .collect();
        let layers = layers?;
        let fastest: Option<Vec<Timed>> = layers.iter().map(|layer| layer.fastest).collect();
        let software: Option<f64> = layers.iter().map(|layer| layer.software).sum();
        let staged: Option<f64> = fastest.as_ref().map(|all| all.iter().map(|one| one.milliseconds).sum());
        if let Some(software) = software.filter(|_| options.buffers())
            && staged.is_none_or(|staged| software < staged)
        {
            return Some(Variant::Software);
        }
        let shape = |(index, timed): (usize, Timed)| {
            let shape = Shape { outputs: timed.outputs, pixels: timed.pixels, staged: timed.staged };
            let known = shapes(spec, index, options.output, self.workgroup_bytes);
            // Where the image goes decides what its layer may have, and a file may hold nonsense.
            if known.contains(&shape) { Some(shape) } else { known.first().copied() }
        };
        Some(Variant::Gpu(fastest?.into_iter().enumerate().map(shape).collect::<Option<_>>()?))
    }

    /// Measures all kernels that the layers of a network may have on images of a size, from buffers to buffers. A kernel
    /// counts only if what it makes of a small image is what the reference makes of it; the note says which do not.
    ///
    /// # Errors
    /// If the GPU refuses.
    pub fn measure(
        &mut self,
        gpu: &Gpu,
        spec: &NetSpec,
        size: [usize; 2],
        precision: Precision,
    ) -> Result<Vec<String>, ForwardError> {
        let weights = Weights::random(spec, 1);
        let expected =
            reference::layers(spec, &weights, &noise(spec.input_channels(), PROOF[0], PROOF[1], 1));
        let trial = Trial { gpu, spec, weights, expected, size, precision };
        let (layers, notes) = trial.layers()?;
        self.file.devices.entry(self.device.clone()).or_default().extend(layers);
        Ok(notes)
    }

    fn of(device: &wgpu::Device, file: TuningFile) -> Self {
        let workgroup_bytes = device.limits().max_compute_workgroup_storage_size;
        Self { file, device: adapter_key(&device.adapter_info()), workgroup_bytes }
    }
}

/// A network whose kernels are measured.
struct Trial<'a> {
    gpu: &'a Gpu,
    spec: &'a NetSpec,
    weights: Weights,
    expected: Vec<Activation>,
    size: [usize; 2],
    precision: Precision,
}

impl Trial<'_> {
    /// What is measured of every layer, and which kernels were wrong.
    fn layers(&self) -> Result<(Layers, Vec<String>), ForwardError> {
        let count = self.spec.layers().len();
        let (mut measured, mut notes) = (vec![Measured::default(); count], Vec::new());
        if self.precision == Precision::F32 {
            for (layer, milliseconds) in measured.iter_mut().zip(self.times(&Variant::Software, &mut notes)?)
            {
                layer.software = milliseconds;
            }
        }
        for variant in Variant::candidates(&self.gpu.device.limits(), self.spec, OutputKind::Buffer) {
            let times = self.times(&variant, &mut notes)?;
            let Variant::Gpu(these) = variant else { continue };
            for ((layer, shape), time) in measured.iter_mut().zip(these).zip(times) {
                let Some(milliseconds) = time else { continue };
                if layer.fastest.is_none_or(|fastest| milliseconds < fastest.milliseconds) {
                    let Shape { outputs, pixels, staged } = shape;
                    layer.fastest = Some(Timed { outputs, pixels, staged, milliseconds });
                }
            }
        }
        let keys = (0..count).map(|index| key(self.spec, index, self.precision));
        Ok((keys.zip(measured).collect(), notes))
    }

    /// Milliseconds of each layer of a network; none of one that is wrong, nor of those after it.
    fn times(&self, variant: &Variant, notes: &mut Vec<String>) -> Result<Vec<Option<f64>>, ForwardError> {
        let options =
            Options { precision: self.precision, variant: Some(variant.clone()), ..Options::default() };
        let network = match Network::with(&self.gpu.device, self.spec, &self.weights, &options) {
            Ok(network) => network,
            // The software kernels have limits of their own.
            Err(error) if *variant == Variant::Software => {
                notes.push(error.to_string());
                return Ok(vec![None; self.expected.len()]);
            }
            Err(error) => return Err(error),
        };
        let input = noise(self.spec.input_channels(), PROOF[0], PROOF[1], 1);
        let made = super::run_layers_of(&network, &self.gpu.queue, &input)?;
        let share = match self.precision {
            Precision::F32 => TOLERANCE,
            Precision::F16 => HALF_TOLERANCE,
        };
        let wrong = first_difference_within(&self.expected, &made, share).map(|(layer, _)| layer);
        if let Some(layer) = &wrong {
            notes.push(format!("layer `{layer}` is wrong with {variant:?}"));
        }
        let mut right = true;
        let times = network.layer_times(&self.gpu.queue, self.size, WARM_UP, TIMED)?;
        Ok(times
            .into_iter()
            .map(|(layer, timing)| {
                right &= wrong.as_ref() != Some(&layer);
                right.then_some(timing.milliseconds)
            })
            .collect())
    }
}

/// A layer in words: all that a kernel's time depends on, but for the size.
fn key(spec: &NetSpec, index: usize, precision: Precision) -> String {
    let layers = spec.layers();
    let layer = &layers[index];
    let source = match layer.source {
        Source::Input => "input",
        Source::Plain(_) => "map",
        Source::Pooled(_) => "means",
        Source::Joined { .. } => "joined",
    };
    let kept = match layer.activation {
        true if has_means(&layers, index) => "map and means",
        true => "map",
        false => "image",
    };
    format!(
        "{source} {} to {kept} {}, {} groups {:?}, kernel {}, {precision:?}",
        layer.inputs, layer.outputs, layer.groups, spec.channel_order, spec.kernel
    )
}

#[cfg(test)]
mod tests;
