//! Which kernels are the fastest on a device: measured once, remembered in a file.

use super::tuning_file::{Fails, LayerTimes, Timed, TuningFile};
use super::tuning_key::{keys, network_key};
use super::variant::shapes;
use super::{ForwardError, HALF_TOLERANCE, Network, Options, OutputKind, Precision, Shape, Variant};
use crate::parity::{TOLERANCE, first_difference_within, noise};
use crate::{Activation, Model, NetSpec, Weights, reference};
use deepshade_shaders::gpu::{self, Gpu, GpuError, PipelineCache, adapter_key};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Runs of each kernel before the clock counts, and runs that count.
const WARM_UP: usize = 1;
const TIMED: usize = 3;
/// How long the device is busy before.
const WARM_UP_TIME: Duration = Duration::from_millis(100);
/// Rows and columns of the image on which every kernel must be right before it is measured.
const PROOF: [usize; 2] = [37, 53];

/// What was measured on devices, layer shape by layer shape.
#[derive(Debug)]
pub struct Tuning {
    file: TuningFile,
    path: Option<PathBuf>,
    device: String,
    limits: wgpu::Limits,
}

impl Tuning {
    /// Nothing measured yet.
    pub fn new(device: &wgpu::Device) -> Self {
        Self::of(device, TuningFile::default(), None)
    }

    /// What a file remembers of a device, and in words why a file was of no use. A missing file remembers
    /// nothing.
    pub fn load(device: &wgpu::Device, path: &Path) -> (Self, Option<String>) {
        let (file, note) = TuningFile::load(path);
        (Self::of(device, file, Some(path.to_owned())), note)
    }

    /// Writes all into a file, whose folder is made where there is none.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        self.file.save(path)
    }

    /// The fastest kernels for a network that is to run with these options on images of about a size,
    /// `[height, width]`; none before all of its layers were measured, on images whose number of pixels is
    /// the same power of two, rounded.
    ///
    /// # Errors
    /// [`ForwardError::NoKernel`] if measuring found none that works.
    pub fn variant(
        &self,
        spec: &NetSpec,
        options: &Options<'_>,
        size: [usize; 2],
    ) -> Result<Option<Variant>, ForwardError> {
        let keys = keys(spec, options.precision, size, &self.limits);
        let Some(known) = self.file.devices.get(&self.device) else { return Ok(None) };
        let fails = known.networks.get(&network_key(&keys)).cloned().unwrap_or_default();
        let layers: Vec<LayerTimes> =
            keys.iter().map(|key| known.layers.get(key).copied().unwrap_or_default()).collect();
        let fastest: Option<Vec<Timed>> = layers.iter().map(|layer| layer.fastest).collect();
        let fastest = fastest.filter(|_| fails.gpu.is_none());
        if fastest.is_none() && fails.gpu.is_none() {
            return Ok(None);
        }
        let software: Option<f64> = layers.iter().map(|layer| layer.software).sum();
        let gpu: Option<f64> = fastest.as_ref().map(|all| all.iter().map(|one| one.milliseconds).sum());
        if let Some(software) =
            software.filter(|_| options.buffers() && !fails.software && spec.u_net().is_some())
            && gpu.is_none_or(|gpu| software < gpu)
        {
            return Ok(Some(Variant::Software));
        }
        let Some(fastest) = fastest else {
            let (layer, precision) = (fails.gpu.unwrap_or_default(), options.precision);
            let (device, file) = (self.device.clone(), self.path.clone());
            return Err(ForwardError::NoKernel { layer, precision, device, file });
        };
        let shape = |(index, timed): (usize, Timed)| {
            let shape = Shape { outputs: timed.outputs, pixels: timed.pixels, staged: timed.staged };
            let room = self.limits.max_compute_workgroup_storage_size;
            let known = shapes(spec, index, options.output, room);
            // Where the image goes decides what its layer may have, and a file may hold nonsense.
            if known.contains(&shape) { Some(shape) } else { known.first().copied() }
        };
        let shapes: Option<Vec<Shape>> = fastest.into_iter().enumerate().map(shape).collect();
        Ok(shapes.map(Variant::Gpu))
    }

    /// A network with its fastest kernels for images of about a size, `[height, width]`, measured where they
    /// are not known; in 32-bit floats where none in half floats works. With it the notes of
    /// [`Tuning::measure`].
    ///
    /// # Errors
    /// As [`Tuning::variant`], [`Tuning::measure`] and [`Network::with`].
    pub fn network(
        &mut self,
        gpu: &Gpu,
        model: &Model,
        options: &Options<'_>,
        size: [usize; 2],
    ) -> Result<(Network, Vec<String>), ForwardError> {
        let Model { spec, weights } = model;
        let mut notes = match self.variant(spec, options, size) {
            Ok(None) => self.measure(gpu, spec, options, size)?,
            _ => Vec::new(),
        };
        match self.variant(spec, options, size) {
            Err(error @ ForwardError::NoKernel { .. }) if options.precision == Precision::F16 => {
                notes.push(error.to_string());
                let options = Options { precision: Precision::F32, ..options.clone() };
                let (network, more) = self.network(gpu, model, &options, size)?;
                notes.extend(more);
                Ok((network, notes))
            }
            variant => {
                let options = Options { variant: variant?, ..options.clone() };
                Ok((Network::with(&gpu.device, spec, weights, &options)?, notes))
            }
        }
    }

    /// Measures all kernels that the layers of a network may have on images of a size, `[height, width]`, in
    /// the options' precision and through their cache, from buffers to buffers. A kernel counts only if the
    /// driver accepts it, it runs, and what it makes of a small image is what the reference makes of it; the
    /// notes say which do not. That none of a layer's counts is remembered too, of this network.
    ///
    /// # Errors
    /// If nothing runs, and not for a driver's refusal alone: the device has no such precision, allows too
    /// little, or fails.
    pub fn measure(
        &mut self,
        gpu: &Gpu,
        spec: &NetSpec,
        options: &Options<'_>,
        size: [usize; 2],
    ) -> Result<Vec<String>, ForwardError> {
        let weights = Weights::random(spec, 1);
        let expected =
            reference::layers(spec, &weights, &noise(spec.input_channels(), PROOF[0], PROOF[1], 1));
        let Options { precision, cache, .. } = *options;
        let trial = Trial { gpu, spec, weights, expected, size, precision, cache };
        let mut notes = Vec::new();
        let measured = trial.layers(&mut notes)?;
        self.remember(spec, precision, size, &measured);
        Ok(notes)
    }

    /// Keeps what was measured of a network's layers. What was measured of them in another network stays
    /// where this one brought nothing.
    fn remember(&mut self, spec: &NetSpec, precision: Precision, size: [usize; 2], measured: &[LayerTimes]) {
        let keys = keys(spec, precision, size, &self.limits);
        let known = self.file.devices.entry(self.device.clone()).or_default();
        let wrong = measured.iter().position(|layer| layer.fastest.is_none());
        let fails = Fails {
            software: measured.iter().any(|layer| layer.software.is_none()),
            gpu: wrong.map(|index| spec.layers().swap_remove(index).name),
        };
        known.networks.insert(network_key(&keys), fails);
        for (key, measured) in keys.into_iter().zip(measured) {
            known.layers.entry(key).or_default().update(*measured);
        }
    }

    fn of(device: &wgpu::Device, file: TuningFile, path: Option<PathBuf>) -> Self {
        Self { file, path, device: adapter_key(&device.adapter_info()), limits: device.limits() }
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
    cache: Option<&'a PipelineCache>,
}

impl Trial<'_> {
    /// What is measured of every layer. Kernels that are refused, fail or are wrong are noted; a failure is
    /// an error if nothing else ran.
    fn layers(&self, notes: &mut Vec<String>) -> Result<Vec<LayerTimes>, ForwardError> {
        let mut measured = vec![LayerTimes::default(); self.expected.len()];
        let mut failure = None;
        let mut times = |variant: &Variant| {
            self.times(variant, notes).unwrap_or_else(|error| {
                notes.push(format!("refused with {variant:?}: {error}"));
                // The software kernels have limits of their own, and every driver has a taste and faults of
                // its own.
                if !matches!(
                    error,
                    ForwardError::Weights { .. }
                        | ForwardError::Channels { .. }
                        | ForwardError::Gpu(GpuError::Shader { .. })
                ) {
                    failure = Some(error);
                }
                vec![None; self.expected.len()]
            })
        };
        if self.precision == Precision::F32 {
            for (layer, milliseconds) in measured.iter_mut().zip(times(&Variant::Software)) {
                layer.software = milliseconds;
            }
        }
        for variant in Variant::candidates(&self.gpu.device.limits(), self.spec, OutputKind::Buffer) {
            let times = times(&variant);
            let Variant::Gpu(these) = variant else { continue };
            for ((layer, shape), time) in measured.iter_mut().zip(these).zip(times) {
                let Some(milliseconds) = time else { continue };
                if layer.fastest.is_none_or(|fastest| milliseconds < fastest.milliseconds) {
                    let Shape { outputs, pixels, staged } = shape;
                    layer.fastest = Some(Timed { outputs, pixels, staged, milliseconds });
                }
            }
        }
        match failure.filter(|_| measured.iter().all(|layer| *layer == LayerTimes::default())) {
            Some(error) => Err(error),
            None => Ok(measured),
        }
    }

    /// Milliseconds of each layer of a network; none of one that is wrong, nor of those after it.
    fn times(&self, variant: &Variant, notes: &mut Vec<String>) -> Result<Vec<Option<f64>>, ForwardError> {
        let options = Options {
            precision: self.precision,
            variant: Some(variant.clone()),
            cache: self.cache,
            ..Options::default()
        };
        let network = Network::with(&self.gpu.device, self.spec, &self.weights, &options)?;
        let input = noise(self.spec.input_channels(), PROOF[0], PROOF[1], 1);
        let made = super::run_layers(&network, &self.gpu.queue, &input)?;
        let tolerance = match self.precision {
            Precision::F32 => TOLERANCE,
            Precision::F16 => HALF_TOLERANCE,
        };
        let wrong = first_difference_within(&self.expected, &made, tolerance).map(|(layer, _)| layer);
        if let Some(layer) = &wrong {
            notes.push(format!("layer `{layer}` is wrong with {variant:?}"));
        }
        let mut right = true;
        gpu::warm_up(&self.gpu.device, &self.gpu.queue, WARM_UP_TIME)?;
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

#[cfg(test)]
mod tests;
