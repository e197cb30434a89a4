//! A network on a device.

use super::device_layer::{DeviceLayer, LayerCompiler};
use super::head;
use super::{ForwardError, InputKind, OutputKind, Plan, Precision, Shape, Variant, limits, variant};
use crate::{Layer, NetSpec, Weights};
use deepshade_shaders::gpu::PipelineCache;
use std::collections::HashMap;

/// A network on a device: its compiled kernels and its weights. A [`Plan`] adds what depends on the image's
/// size.
#[derive(Debug)]
pub struct Network {
    pub(super) device: wgpu::Device,
    pub(super) spec: NetSpec,
    pub(super) layers: Vec<Layer>,
    pub(super) device_layers: Vec<DeviceLayer>,
    pub(super) head: Option<head::Passes>,
    pub(super) variant: Variant,
    pub(super) precision: Precision,
    pub(super) input: InputKind,
    pub(super) output: OutputKind,
}

/// How a network is to run.
#[derive(Clone, Debug, Default)]
pub struct Options<'a> {
    /// Where the input is.
    pub input: InputKind,
    /// Where the image goes.
    pub output: OutputKind,
    /// How feature maps are kept.
    pub precision: Precision,
    /// Which kernels, such as [`Tuning::variant`](super::Tuning::variant) says; without,
    /// [`Variant::default_for`] the device.
    pub variant: Option<Variant>,
    /// Remembers compiled kernels for the next start of the program.
    pub cache: Option<&'a PipelineCache>,
}

impl Options<'_> {
    /// Whether it goes from a buffer to a buffer.
    pub(super) fn buffers(&self) -> bool {
        self.input == InputKind::Buffer && self.output == OutputKind::Buffer
    }
}

impl Network {
    /// A network from buffers to buffers, in 32-bit floats, with the kernels that suit the device by default.
    ///
    /// # Errors
    /// If the weights are not the spec's, a layer is beyond the device's limits, or the device refuses.
    pub fn new(device: &wgpu::Device, spec: &NetSpec, weights: &Weights) -> Result<Self, ForwardError> {
        Self::with(device, spec, weights, &Options::default())
    }

    /// Compiles the kernels and uploads the weights. Where nothing says which kernels, and a layer is too
    /// wide for those for software adapters, it has the others.
    ///
    /// # Errors
    /// If the weights are not the spec's, a layer is beyond the device's limits, the device allows fewer
    /// storage buffers in a kernel than the five that most networks need ([`ForwardError::Limit`]; WebGPU's
    /// default is eight), the options ask for what the device or the kernels cannot do, or the device
    /// refuses.
    pub fn with(
        device: &wgpu::Device,
        spec: &NetSpec,
        weights: &Weights,
        options: &Options<'_>,
    ) -> Result<Self, ForwardError> {
        if spec.validate().is_err() || !weights.fit(spec) {
            return Err(ForwardError::Unfit);
        }
        if let Some(variant) = &options.variant {
            return Self::of(device, spec, weights, options, variant);
        }
        match Self::of(device, spec, weights, options, &Variant::default_for(device, spec, options)) {
            Err(ForwardError::Weights { .. } | ForwardError::Channels { .. }) => {
                let variant = Variant::gpu(&device.limits(), spec, options.output);
                Self::of(device, spec, weights, options, &variant)
            }
            made => made,
        }
    }

    fn of(
        device: &wgpu::Device,
        spec: &NetSpec,
        weights: &Weights,
        options: &Options<'_>,
        variant: &Variant,
    ) -> Result<Self, ForwardError> {
        check(device, spec, variant, options)?;
        limits::check(&device.limits(), spec, variant, options)?;
        let layers = spec.layers();
        let mut compiler = LayerCompiler { device, spec, weights, options, compiled: HashMap::new() };
        let compiled = |(index, layer)| match variant {
            Variant::Software => compiler.software(index, layer),
            Variant::Gpu(shapes) => compiler.gpu(index, layer, shapes[index]),
        };
        let device_layers = layers.iter().enumerate().map(compiled).collect::<Result<_, _>>()?;
        let head = head::Passes::new(device, spec, options)?;
        let (device, spec, variant) = (device.clone(), spec.clone(), variant.clone());
        let Options { input, output, precision, .. } = *options;
        Ok(Self { device, spec, layers, device_layers, head, variant, precision, input, output })
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        &self.spec
    }

    /// Its kernels.
    pub const fn variant(&self) -> &Variant {
        &self.variant
    }

    /// How it keeps feature maps.
    pub const fn precision(&self) -> Precision {
        self.precision
    }

    /// Prepares runs on images of a size: the feature maps between the layers. Where the whole image's would
    /// be beyond the device's limits, or the device has no memory left for them, the image is run in tiles,
    /// which make the same.
    ///
    /// # Errors
    /// If the size is beyond the device's limits or its memory.
    pub fn plan(&self, height: usize, width: usize) -> Result<Plan, ForwardError> {
        self.plan_within(height, width, u64::MAX)
    }

    /// As [`Network::plan`], with feature maps of at most so many bytes: in tiles, where the whole image's
    /// take more.
    ///
    /// # Errors
    /// If the size is beyond the device's limits or its memory, or no tile is small enough.
    pub fn plan_within(&self, height: usize, width: usize, bytes: u64) -> Result<Plan, ForwardError> {
        Plan::new(self, height, width, bytes)
    }
}

/// Whether the kernels can do what is asked for.
fn check(
    device: &wgpu::Device,
    spec: &NetSpec,
    variant: &Variant,
    options: &Options<'_>,
) -> Result<(), ForwardError> {
    let half = options.precision == Precision::F16;
    let refused = match variant {
        _ if half && !device.features().contains(wgpu::Features::SHADER_F16) => {
            "the device has no half floats"
        }
        Variant::Software if half => "the software kernels have no half floats",
        Variant::Software if spec.u_net().is_none() => "the software kernels are for U-nets",
        Variant::Software if !options.buffers() => "the software kernels read and write buffers only",
        Variant::Gpu(shapes) if shapes.len() != spec.layers().len() => "a shape is needed for every layer",
        Variant::Gpu(shapes) => return check_shapes(device, spec, shapes, options),
        Variant::Software => return Ok(()),
    };
    Err(ForwardError::Variant(refused))
}

/// Whether every layer's kernel may have its shape on the device.
fn check_shapes(
    device: &wgpu::Device,
    spec: &NetSpec,
    shapes: &[Shape],
    options: &Options<'_>,
) -> Result<(), ForwardError> {
    let room = device.limits().max_compute_workgroup_storage_size;
    for (index, (shape, layer)) in shapes.iter().zip(spec.layers()).enumerate() {
        if !variant::shapes(spec, index, options.output, room).contains(shape) {
            return Err(ForwardError::Shape { layer: layer.name, shape: *shape });
        }
    }
    Ok(())
}
