//! Ways of running a network on a device, of which one is the fastest there.

use super::head;
use super::maps::has_means;
use super::{Options, OutputKind};
use crate::{BlockSource, Layer, NetSpec};
use deepshade_shaders::wgsl::convolution::{Convolution, Reading, Shape, Writing};

/// How feature maps are kept between layers. Sums and weights are 32-bit floats in either case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// In 32-bit floats.
    #[default]
    F32,
    /// In half floats, where the device has `SHADER_F16`: half the memory. A value above 65504 becomes
    /// infinite; other errors are bounded by [`HALF_TOLERANCE`](super::HALF_TOLERANCE).
    F16,
}

/// A set of kernels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Kernels for software adapters: feature maps in textures, weights in uniform buffers, eight outputs of
    /// 2x2 pixels an invocation. From buffers to buffers, in 32-bit floats.
    Software,
    /// Kernels for GPUs: feature maps in a storage buffer; the shape of each layer's kernel, one of those
    /// that [`Variant::candidates`] have for it.
    Gpu(Vec<Shape>),
}

impl Variant {
    /// A good guess for a device: the software kernels where they can and the adapter is software, else the
    /// others. For U-nets they are five times as fast there: `gi` at 192x128 takes 97 ms on llvmpipe and two
    /// cores, with the best shape of each layer of the others 520.
    pub fn default_for(device: &wgpu::Device, spec: &NetSpec, options: &Options<'_>) -> Self {
        let software = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
        let can = options.buffers() && options.precision == Precision::F32 && spec.u_net().is_some();
        match software && can {
            true => Self::Software,
            false if software => Self::gpu_on_software(&device.limits(), spec, options.output),
            false => Self::gpu(&device.limits(), spec, options.output),
        }
    }

    /// The kernels for GPUs, of the shapes that are best on llvmpipe: as many pixels an invocation as there
    /// may be. Workgroup memory pays where a map is doubled on the way, which is then done once a workgroup;
    /// elsewhere it costs.
    /// `models/ao` takes 640 ms at 192x128, with [`Variant::gpu`] 1,430.
    fn gpu_on_software(limits: &wgpu::Limits, spec: &NetSpec, output: OutputKind) -> Self {
        let layers = spec.layers();
        let best = |(shapes, layer): (Vec<Shape>, &Layer)| {
            let joins = matches!(layer.source, BlockSource::Joined { .. });
            let outputs = if joins { 8 } else { 4 };
            let unlike = |shape: &Shape| {
                let pixels = shape.pixels[0] * shape.pixels[1];
                (std::cmp::Reverse(pixels), shape.staged != joins, shape.outputs.abs_diff(outputs))
            };
            shapes.into_iter().min_by_key(unlike).expect("every layer has a shape")
        };
        Self::Gpu(shapes_of_layers(limits, spec, output).into_iter().zip(&layers).map(best).collect())
    }

    /// The kernels for GPUs, of the shapes that are guessed to be best within a device's limits.
    pub fn gpu(limits: &wgpu::Limits, spec: &NetSpec, output: OutputKind) -> Self {
        Self::Gpu(shapes_of_layers(limits, spec, output).into_iter().map(|shapes| shapes[0]).collect())
    }

    /// Kernels for GPUs such that every shape that a layer's kernel may have is in one of them, the best
    /// guess first.
    pub fn candidates(limits: &wgpu::Limits, spec: &NetSpec, output: OutputKind) -> Vec<Self> {
        let shapes = shapes_of_layers(limits, spec, output);
        let most = shapes.iter().map(Vec::len).max().unwrap_or(0);
        let round = |round: usize| shapes.iter().map(|all| all[round % all.len()]).collect();
        (0..most).map(|index| Self::Gpu(round(index))).collect()
    }
}

fn shapes_of_layers(limits: &wgpu::Limits, spec: &NetSpec, output: OutputKind) -> Vec<Vec<Shape>> {
    let room = limits.max_compute_workgroup_storage_size;
    (0..spec.layers().len()).map(|index| shapes(spec, index, output, room)).collect()
}

/// The shapes that a layer's kernel may have within that many bytes of workgroup memory, the best guess
/// first.
///
/// A larger shape reads inputs and weights less often and keeps more sums in registers, of which an
/// invocation has a limited number: 16 to 64 sums.
pub fn shapes(spec: &NetSpec, index: usize, output: OutputKind, room: u32) -> Vec<Shape> {
    let layers = spec.layers();
    let pools = has_means(&layers, index);
    let outputs = outputs_at_once(spec, &layers[index], output);
    let pixels: &[[u32; 2]] = if pools { &[[2, 2], [4, 2]] } else { &[[2, 1], [2, 2], [4, 2]] };
    let all = outputs.iter().flat_map(|outputs| {
        pixels.iter().flat_map(|pixels| {
            [true, false].map(|staged| Shape { outputs: *outputs, pixels: *pixels, staged })
        })
    });
    let sums = |shape: &Shape| shape.outputs * shape.pixels[0] * shape.pixels[1];
    // An image has few outputs, so that its sums are few in any case. Without staging a few shapes show what
    // it is worth.
    let sensible = |shape: &Shape| {
        let few = if shape.staged { 16..=64 } else { 32..=32 };
        !layers[index].activation && layers[index].level == 0 || few.contains(&sums(shape))
    };
    let mut shapes: Vec<Shape> =
        all.filter(sensible).filter(|shape| workgroup_bytes(&layers[index], *shape) <= room).collect();
    // Staged before direct, 32 sums before more or fewer, many outputs before few: they share what is staged.
    shapes.sort_by_key(|shape| (!shape.staged, sums(shape).abs_diff(32), std::cmp::Reverse(shape.outputs)));
    shapes
}

/// Outputs that an invocation may make of a layer.
fn outputs_at_once(spec: &NetSpec, layer: &Layer, output: OutputKind) -> Vec<u32> {
    let channels = spec.last_channels();
    let of_group = (layer.outputs / layer.groups) as u32;
    let many = || [4, 8, 16].into_iter().filter(|outputs| *outputs <= of_group.max(4)).collect();
    let output = if head::of(spec).is_some() { OutputKind::Buffer } else { output };
    match (layer.activation, output) {
        (true, _) => many(),
        // What a head works on is a map like others.
        (false, _) if layer.level > 0 => many(),
        // A texel is written as a whole.
        (false, OutputKind::Texture(_)) if channels > 1 => vec![4],
        (false, _) if channels > 1 => vec![1, 4],
        (false, _) => vec![1],
    }
}

fn workgroup_bytes(layer: &Layer, shape: Shape) -> u32 {
    let kernel = layer.kernel as u32;
    let (reading, folded, writing) = (Reading::Map, None, Writing::Map);
    Convolution { kernel, shape, half: false, arena: true, reading, folded, writing }.workgroup_bytes()
}
