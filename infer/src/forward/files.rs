//! A network as files for any engine that has compute shaders: its kernels, its packed weights, and what a
//! host must do.
//!
//! The kernels are those that [`Network`](super::Network) runs on GPUs, from a planar buffer to a planar
//! buffer, of the shapes that are guessed to be best within WebGPU's limits.

use super::maps::{self, MapId};
use super::packing::{BLOCK, Packed};
use super::{ForwardError, Options, Precision, Shape, Variant, io};
use super::{head, kernel};
use crate::{BlockSource, Layer, Model, NetSpec};
use deepshade_shaders::wgsl::TILE;
use deepshade_shaders::wgsl::convolution::{Convolution, Reading, WORKGROUP, Writing};
use deepshade_shaders::wgsl::uniforms::NetLayer;
use serde_json::{Value, json};
use std::fmt::Write;

/// A file's name and what it holds.
pub type File = (String, Vec<u8>);

/// What a host must do, in words.
const HOST: &str = include_str!("host.md");

/// The files of a network: a kernel, weights and a table of what is read for each layer, `network.json` with
/// the passes and what they bind, and `HOST.md` with the same in words.
///
/// # Errors
/// If the weights are not the spec's.
pub fn wgsl_files(model: &Model, precision: Precision) -> Result<Vec<File>, ForwardError> {
    let Model { spec, weights } = model;
    if spec.validate().is_err() || !weights.fit(spec) {
        return Err(ForwardError::Unfit);
    }
    let options = Options { precision, ..Options::default() };
    let layers = spec.layers();
    let Variant::Gpu(shapes) = Variant::gpu(&wgpu::Limits::default(), spec, options.output) else {
        unreachable!("the kernels for GPUs have shapes");
    };
    let (mut files, mut passes) = (Vec::new(), Vec::new());
    for (index, (layer, shape)) in layers.iter().zip(&shapes).enumerate() {
        let packed = Packed::new(spec, index, &weights.0[index], shape.outputs as usize);
        let stem = format!("{index:02}_{}", layer.name);
        // A host gives each map a buffer of its own, so that what is read is not written.
        let convolution = Convolution { arena: false, ..kernel::convolution(spec, index, *shape, &options)? };
        passes.push(pass(spec, &layers, index, *shape, &packed, &stem));
        files.push((format!("{stem}.wgsl"), (heading(&layers, index) + &convolution.source()).into_bytes()));
        files.push((format!("{stem}.reads.bin"), bytemuck::cast_slice(&packed.reads).to_vec()));
        files.push((format!("{stem}.weights.bin"), bytemuck::cast_slice(&packed.weights).to_vec()));
    }
    for (name, source, pass) in head_passes(spec) {
        files.push((name, source.into_bytes()));
        passes.push(pass);
    }
    let maps: Vec<Value> = maps::maps(&layers).iter().map(|map| map_json(&layers, &shapes, map)).collect();
    let inputs: Vec<&str> = spec.inputs.iter().map(|attribute| attribute.name()).collect();
    let network = json!({
        "effect": spec.effect, "inputs": inputs, "factors": factors(spec), "runs": spec.runs(), "reach": spec.reach,
        "input_channels": spec.input_channels(), "output_channels": spec.output_channels(),
        "alignment": spec.alignment(), "leak": spec.leak, "half": precision == Precision::F16,
        "uniform": uniform_fields(), "maps": maps, "passes": passes,
        "head": head_json(spec),
    });
    files.push(("network.json".to_owned(), format!("{network:#}\n").into_bytes()));
    files.push(("HOST.md".to_owned(), HOST.as_bytes().to_vec()));
    Ok(files)
}

/// What the channels of a run's input are multiplied by beside the frame's factors of lengths and light.
fn factors(spec: &NetSpec) -> Vec<f32> {
    let channels = io::texture_channels(spec);
    channels.iter().flatten().map(|channel| 2f32.powi(channel.exponent)).collect()
}

/// The name of a map in `network.json`.
fn map_name(layers: &[Layer], id: MapId) -> String {
    match id {
        MapId::Made(layer) => layers[layer].name.clone(),
        MapId::Means(layer) => format!("{}.means", layers[layer].name),
    }
}

fn map_json(layers: &[Layer], shapes: &[Shape], map: &maps::Map) -> Value {
    // A kernel writes whole blocks of outputs.
    let channels = map.channels.next_multiple_of(shapes[map.born].outputs as usize);
    let (first, last) = (&layers[map.born].name, &layers[map.dies].name);
    json!({
        "name": map_name(layers, map.id), "level": map.level, "blocks": channels / BLOCK,
        "written_by": first, "last_read_by": last,
    })
}

/// The uniform buffer's fields, in order.
fn uniform_fields() -> Vec<Value> {
    let field = |field: &deepshade_shaders::wgsl::uniforms::Field| json!({ "name": field.name, "kind": field.kind, "offset": field.offset });
    NetLayer::LAYOUT.fields.iter().map(field).collect()
}

fn pass(spec: &NetSpec, layers: &[Layer], index: usize, shape: Shape, packed: &Packed, stem: &str) -> Value {
    let layer = &layers[index];
    let mut bindings = json!({ "0": "uniform", "1": "reads", "2": "weights" });
    let has_head = head::of(spec).is_some();
    let last = if has_head { "kernels" } else { "output" };
    bindings["3"] = if layer.activation { json!(map_name(layers, MapId::Made(index))) } else { json!(last) };
    // Of the planar buffer that is read or written; between them layers have maps alone.
    let channels = match (layer.activation, layer.source) {
        (false, _) => spec.last_channels(),
        (true, BlockSource::Input | BlockSource::Folded) => spec.input_channels(),
        (true, _) => 0,
    };
    let sources = maps::read_by(layer);
    for (binding, id) in (4..).zip(&sources) {
        bindings[binding.to_string()] = json!(map_name(layers, *id));
    }
    if layer.source.is_input() {
        bindings["4"] = json!("input");
    }
    if maps::has_means(layers, index) {
        bindings["5"] = json!(map_name(layers, MapId::Means(index)));
    }
    json!({
        "layer": layer.name, "file": format!("{stem}.wgsl"), "level": layer.level,
        "reads": format!("{stem}.reads.bin"), "weights": format!("{stem}.weights.bin"),
        "tile": shape.pixels.map(|pixels| WORKGROUP * pixels), "workgroups_z": packed.reads.len(),
        "stride": packed.stride / 4, "channels": channels, "bindings": bindings,
        "whole_frame": has_head && !layer.activation,
    })
}

/// What a host must know of the network's head: of which size its buffers are.
fn head_json(spec: &NetSpec) -> Option<Value> {
    let head = head::of(spec)?;
    let estimates = head.pyramid_numbers([1, 1]) - usize::from(head.levels > 0) * head.channels as usize;
    Some(json!({
        "kernels": spec.last_channels(), "level": spec.last_level(), "levels": head.levels, "planes": estimates,
    }))
}

/// The passes of the network's head: name and source of the file, and what `network.json` says of it.
fn head_passes(spec: &NetSpec) -> Vec<(String, String, Value)> {
    let Some(head) = head::of(spec) else { return Vec::new() };
    let first = spec.layers().len();
    let pass = |index: usize, name: String, level: u32, source: String, bindings: Value| {
        let file = format!("{:02}_{name}.wgsl", first + index);
        let heading =
            format!("// Pass `{name}` of the head, written by deepshade; HOST.md says how it is run.\n\n");
        let json = json!({
            "layer": name, "file": file, "level": level, "tile": [TILE, TILE], "workgroups_z": 1, "stride": 0,
            "channels": spec.input_channels(), "bindings": bindings, "whole_frame": false,
        });
        (file, heading + &source, json)
    };
    let mut passes = Vec::new();
    let mut image = json!({ "0": "uniform", "1": "kernels", "3": "output" });
    if head.has_pyramid() {
        let light = json!({ "0": "uniform", "3": "pyramid", "4": "input" });
        passes.push(pass(0, "light".to_owned(), 0, head.light(&Reading::Planes), light));
        for level in 1..head.levels {
            let halve = json!({ "0": "uniform", "3": "pyramid" });
            passes.push(pass(passes.len(), format!("light{level}"), level, head.halve(level), halve));
        }
        image["2"] = json!("pyramid");
    }
    let mut last = pass(passes.len(), "image".to_owned(), 0, head.image(Writing::Planes), image);
    // Rows and columns of what the last block makes.
    last.2["channels"] = json!("kernels_rows");
    last.2["stride"] = json!("kernels_columns");
    passes.push(last);
    passes
}

/// What stands at the head of a layer's kernel.
fn heading(layers: &[Layer], index: usize) -> String {
    let layer = &layers[index];
    let reads = match layer.source {
        BlockSource::Input => "the network's input".to_owned(),
        BlockSource::Folded => "the network's input, the pixels of squares of four as channels".to_owned(),
        BlockSource::Plain(of) => format!("what `{}` makes", layers[of].name),
        BlockSource::Pooled(of) => format!("the 2x2 means of what `{}` makes", layers[of].name),
        BlockSource::Joined { coarse, skip, .. } => format!(
            "what `{}` makes, doubled bilinearly, and what `{}` makes",
            layers[coarse].name, layers[skip].name
        ),
    };
    let mut text = format!("// Layer `{}`, written by deepshade; HOST.md says how it is run.\n", layer.name);
    let Layer { inputs, outputs, groups, level, .. } = layer;
    writeln!(
        text,
        "// Reads {reads}: {inputs} channels in {groups} group(s), to {outputs} channels on level {level}.\n"
    )
    .expect("writing to a string");
    text
}
