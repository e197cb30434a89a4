//! The layers of a network.

use super::{LayerTold, frame, head};
use crate::forward::maps::{self, MapId};
use crate::forward::packing::{BLOCK, Packed};
use crate::forward::{ForwardError, Options, Precision, Shape, Variant, files::File, kernel};
use crate::{Layer, Model, NetSpec};
use deepshade_shaders::host::{Extent, HostBinding, HostBuffer, HostPart, HostPass, HostPasses, HostValue};
use deepshade_shaders::wgsl::convolution::{Convolution, WORKGROUP};
use deepshade_shaders::wgsl::uniforms::NetLayer;

/// A network's passes, and the files that they read.
pub struct NetworkFiles {
    /// From `input` to `output`.
    pub passes: HostPasses,
    /// Weights, and tables of what is read.
    pub files: Vec<File>,
}

/// The passes of a network from the planar buffer `input` to the planar buffer `output`.
///
/// # Errors
/// If its image has no form.
pub fn network(model: &Model, precision: Precision) -> Result<NetworkFiles, ForwardError> {
    let Model { spec, weights } = model;
    let options = Options { precision, ..Options::default() };
    let layers = spec.layers();
    let Variant::Gpu(shapes) = Variant::gpu(&wgpu::Limits::default(), spec, options.output) else {
        unreachable!("the kernels for GPUs have shapes");
    };
    let mut made = NetworkFiles { passes: HostPasses::default(), files: Vec::new() };
    for (index, (layer, shape)) in layers.iter().zip(&shapes).enumerate() {
        let packed = Packed::new(spec, index, &weights.0[index], shape.outputs as usize);
        // A host gives each map a buffer of its own, so that what is read is not written.
        let convolution = Convolution { arena: false, ..kernel::convolution(spec, index, *shape, &options)? };
        made.passes.passes.push(pass(spec, &layers, index, *shape, &packed, convolution.source()));
        for (kind, bytes) in [
            ("reads", bytemuck::cast_slice(&packed.reads)),
            ("weights", bytemuck::cast_slice::<f32, u8>(&packed.weights)),
        ] {
            let (name, file) = (format!("{}.{kind}", layer.name), format!("{}.{kind}.bin", layer.name));
            made.passes.add(&name, HostBuffer::File(file.clone()));
            made.files.push((file, bytes.to_vec()));
        }
    }
    let element = if precision == Precision::F16 { 8 } else { 16 };
    for map in maps::maps(&layers) {
        // A kernel writes whole blocks of outputs.
        let channels = map.channels.next_multiple_of(shapes[map.born].outputs as usize);
        let part = HostPart { over: frame(spec, map.level), planes: channels / BLOCK, bytes: element };
        made.passes.add(&map_name(&layers, map.id), HostBuffer::Made(vec![part]));
    }
    made.passes.extend(head::passes(spec));
    let output = HostPart::floats(Extent::IMAGE, spec.output_channels());
    made.passes.add("output", HostBuffer::Made(vec![output]));
    let each_run = spec.runs() > 1;
    made.passes.passes.iter_mut().for_each(|pass| pass.each_run = each_run);
    Ok(made)
}

/// The buffer of a map.
fn map_name(layers: &[Layer], id: MapId) -> String {
    match id {
        MapId::Made(layer) => layers[layer].name.clone(),
        MapId::Means(layer) => format!("{}.means", layers[layer].name),
    }
}

fn pass(
    spec: &NetSpec,
    layers: &[Layer],
    index: usize,
    shape: Shape,
    packed: &Packed,
    source: String,
) -> HostPass {
    let layer = &layers[index];
    let has_head = crate::forward::head::of(spec).is_some();
    let over = frame(spec, layer.level);
    // Of the planar buffer that is read or written; between them layers have maps alone.
    let channels = match layer.activation {
        false => spec.last_channels(),
        true if layer.source.is_input() => spec.input_channels(),
        true => 0,
    };
    let told = LayerTold {
        over,
        image: if has_head && !layer.activation { over } else { Extent::IMAGE },
        channels: HostValue::Constant(channels as f64),
        stride: HostValue::Constant((packed.stride / BLOCK) as f64),
        leak: spec.leak,
    };
    let [reads, weights] = ["reads", "weights"].map(|kind| format!("{}.{kind}", layer.name));
    let last = if has_head { "kernels" } else { "output" };
    let written = if layer.activation { map_name(layers, MapId::Made(index)) } else { last.to_owned() };
    let mut pass = HostPass::new(layer.name.clone(), source, over, WORKGROUP)
        .told(&NetLayer::LAYOUT, |field| told.value(field))
        .bind(1, HostBinding::read(reads))
        .bind(2, HostBinding::read(weights))
        .bind(3, HostBinding::written(written));
    for (binding, id) in (4..).zip(maps::read_by(layer)) {
        pass = pass.bind(binding, HostBinding::read(map_name(layers, id)));
    }
    if layer.source.is_input() {
        pass = pass.bind(4, HostBinding::read("input"));
    }
    if maps::has_means(layers, index) {
        pass = pass.bind(5, HostBinding::written(map_name(layers, MapId::Means(index))));
    }
    HostPass { tile: shape.pixels.map(|pixels| WORKGROUP * pixels), workgroups_z: packed.reads.len(), ..pass }
}
