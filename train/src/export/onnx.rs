//! The network as an ONNX file, operator set 17, batch, height and width free.
//!
//! Padding to the network's alignment and cropping back are part of the graph, so that it runs on images of
//! any size.

mod half_floats;
mod head;

pub use half_floats::{HalfError, ONNX_HALF_TOLERANCE, halved};

use super::proto::{
    AttributeProto, Dimension, Extent, FLOAT, GraphProto, INT64, ModelProto, NodeProto, OperatorSetIdProto,
    TensorProto, TensorShapeProto, TensorTypeProto, TypeProto, ValueInfoProto,
};
use deepshade_infer::{BlockSource, Head, Layer, Model, NetSpec};
use prost::Message;

/// Name of the graph's input, `[batch, channels, height, width]`.
pub const INPUT: &str = "gbuffer";
/// Name of the graph's output, `[batch, channels, height, width]`.
pub const OUTPUT: &str = "image";

/// The bytes of an ONNX file.
pub fn encode(model: &Model) -> Vec<u8> {
    let spec = &model.spec;
    let mut graph = Graph::default();
    let size = graph.size();
    let padded = graph.pad(&size, spec.alignment());
    let mut outputs: Vec<String> = Vec::new();
    let layers = spec.layers();
    for (layer, weights) in layers.iter().zip(&model.weights.0) {
        let input = match layer.source {
            BlockSource::Input => padded.clone(),
            BlockSource::Folded => graph.fold(&layer.name, &padded),
            BlockSource::Plain(from) => outputs[from].clone(),
            BlockSource::Pooled(finer) => graph.halve(&layer.name, &outputs[finer]),
            BlockSource::Joined { coarse, skip, groups } => {
                let coarse = graph.double(&layer.name, &outputs[coarse]);
                graph.join(&layers, layer, groups, &coarse, &outputs[skip])
            }
        };
        let shape = layer.weight_shape().map(|n| n as i64);
        graph.floats(&format!("{}.weight", layer.name), &shape, &weights.weight);
        graph.floats(&format!("{}.bias", layer.name), &[layer.outputs as i64], &weights.bias);
        outputs.push(graph.convolve(spec, layer, &input));
    }
    let last = outputs.last().expect("a network has a layer");
    let last = graph.unfold(last, spec.last_level());
    let image = match spec.head {
        Head::Image => last,
        Head::Filter(filter) => graph.filter(spec, filter, &last, &padded),
        Head::Correction(correction) => graph.correct(spec, correction, &last, &padded),
    };
    graph.crop(&image, &size);
    model_proto(spec, graph).encode_to_vec()
}

/// The bytes of an ONNX file that gives beside the image what every layer makes, in their order: for finding
/// the layer in which two runtimes part. The last layer's output is the image itself.
///
/// # Errors
/// If `file` is no ONNX file.
pub fn with_layers(file: &[u8], spec: &NetSpec) -> Result<Vec<u8>, prost::DecodeError> {
    let mut model = ModelProto::decode(file)?;
    let layers = spec.layers();
    let earlier = &layers[..layers.len() - 1];
    if let Some(graph) = &mut model.graph {
        graph.output = earlier.iter().map(|layer| layer_image(&layer.name, layer.outputs)).collect();
        graph.output.push(image(OUTPUT, spec.output_channels()));
    }
    Ok(model.encode_to_vec())
}

fn model_proto(spec: &NetSpec, graph: Graph) -> ModelProto {
    let inputs: Vec<&str> = spec.inputs.iter().map(|attribute| attribute.name()).collect();
    ModelProto {
        ir_version: 8,
        producer_name: "deepshade".to_owned(),
        producer_version: env!("CARGO_PKG_VERSION").to_owned(),
        doc_string: format!(
            "{} from {}; the model's card says what its inputs are multiplied by before",
            spec.effect,
            inputs.join(", ")
        ),
        graph: Some(GraphProto {
            node: graph.nodes,
            name: spec.effect.name().to_owned(),
            initializer: graph.constants,
            input: vec![image(INPUT, spec.input_channels())],
            output: vec![image(OUTPUT, spec.output_channels())],
        }),
        opset_import: vec![OperatorSetIdProto { domain: String::new(), version: 17 }],
    }
}

/// An image `[batch, channels, height, width]` of the input's size, all but the channels free.
fn image(name: &str, channels: usize) -> ValueInfoProto {
    sized(name, channels, ["height", "width"])
}

/// As [`image`], of a layer's own size: the same name would promise the same number.
fn layer_image(name: &str, channels: usize) -> ValueInfoProto {
    sized(name, channels, [&format!("{name}.height"), &format!("{name}.width")])
}

fn sized(name: &str, channels: usize, [height, width]: [&str; 2]) -> ValueInfoProto {
    let free = |name: &str| Extent::DimParam(name.to_owned());
    let extents = [free("batch"), Extent::DimValue(channels as i64), free(height), free(width)];
    let dim = extents.map(|extent| Dimension { value: Some(extent) }).to_vec();
    let tensor_type = TensorTypeProto { elem_type: FLOAT, shape: Some(TensorShapeProto { dim }) };
    ValueInfoProto { name: name.to_owned(), r#type: Some(TypeProto { tensor_type: Some(tensor_type) }) }
}

/// A graph under construction. Every step returns the name of the value that it makes.
#[derive(Default)]
struct Graph {
    nodes: Vec<NodeProto>,
    constants: Vec<TensorProto>,
}

impl Graph {
    /// `[height, width]` of the input.
    fn size(&mut self) -> String {
        self.node("Shape", "size", &[INPUT], vec![int("start", 2)])
    }

    /// The input continued by its edge to the right and below, to a multiple of `alignment`.
    fn pad(&mut self, size: &str, alignment: usize) -> String {
        self.ints("alignment", &[alignment as i64]);
        self.ints("axes", &[2, 3]);
        self.ints("no_padding", &[0; 6]);
        let negative = self.node("Neg", "minus_size", &[size], vec![]);
        let missing = self.node("Mod", "missing", &[&negative, "alignment"], vec![]);
        let pads = self.node("Concat", "pads", &["no_padding", &missing], vec![int("axis", 0)]);
        self.node("Pad", "padded", &[INPUT, &pads], vec![text("mode", "edge")])
    }

    fn halve(&mut self, layer: &str, input: &str) -> String {
        let attributes = vec![ints("kernel_shape", &[2, 2]), ints("strides", &[2, 2])];
        self.node("AveragePool", &format!("{layer}.pooled"), &[input], attributes)
    }

    fn double(&mut self, layer: &str, input: &str) -> String {
        let scales = format!("{layer}.scales");
        self.floats(&scales, &[4], &[1.0, 1.0, 2.0, 2.0]);
        let attributes = vec![text("mode", "linear"), text("coordinate_transformation_mode", "half_pixel")];
        self.node("Resize", &format!("{layer}.doubled"), &[input, "", &scales], attributes)
    }

    /// Space to depth.
    fn fold(&mut self, layer: &str, input: &str) -> String {
        self.node("SpaceToDepth", &format!("{layer}.folded"), &[input], vec![int("blocksize", 2)])
    }

    /// Depth to space, of a block on that level.
    fn unfold(&mut self, input: &str, level: usize) -> String {
        if level == 0 {
            return input.to_owned();
        }
        let attributes = vec![int("blocksize", 1 << level), text("mode", "DCR")];
        self.node("DepthToSpace", "unfolded", &[input], attributes)
    }

    /// Concatenation dealt out in groups; a `Gather` where that is not the plain one.
    fn join(&mut self, layers: &[Layer], layer: &Layer, groups: usize, coarse: &str, skip: &str) -> String {
        let name = &layer.name;
        let joined = self.node("Concat", &format!("{name}.joined"), &[coarse, skip], vec![int("axis", 1)]);
        if groups == 1 {
            return joined;
        }
        let order: Vec<i64> = layer.read_order(layers).into_iter().map(|channel| channel as i64).collect();
        let indices = format!("{name}.order");
        self.ints(&indices, &order);
        self.node("Gather", &format!("{name}.ordered"), &[&joined, &indices], vec![int("axis", 1)])
    }

    fn convolve(&mut self, spec: &NetSpec, layer: &Layer, input: &str) -> String {
        let (name, half) = (&layer.name, (layer.kernel / 2) as i64);
        let attributes = vec![
            int("group", layer.groups as i64),
            ints("kernel_shape", &[layer.kernel as i64; 2]),
            ints("pads", &[half; 4]),
        ];
        let constants = [format!("{name}.weight"), format!("{name}.bias")];
        let sums =
            self.node("Conv", &format!("{name}.sums"), &[input, &constants[0], &constants[1]], attributes);
        if !layer.activation {
            return sums;
        }
        self.node("LeakyRelu", name, &[&sums], vec![float("alpha", spec.leak)])
    }

    /// The graph's output: the image cut to the size of the input.
    fn crop(&mut self, input: &str, size: &str) {
        self.ints("corner", &[0, 0]);
        self.node("Slice", OUTPUT, &[input, "corner", size, "axes"], vec![]);
    }

    fn node(&mut self, op: &str, output: &str, inputs: &[&str], attribute: Vec<AttributeProto>) -> String {
        self.nodes.push(NodeProto {
            input: inputs.iter().map(|input| (*input).to_owned()).collect(),
            output: vec![output.to_owned()],
            name: format!("make_{output}"),
            op_type: op.to_owned(),
            attribute,
        });
        output.to_owned()
    }

    fn floats(&mut self, name: &str, dims: &[i64], values: &[f32]) {
        self.constant(name, dims, FLOAT, values.iter().flat_map(|value| value.to_le_bytes()).collect());
    }

    fn ints(&mut self, name: &str, values: &[i64]) {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.constant(name, &[values.len() as i64], INT64, bytes);
    }

    fn constant(&mut self, name: &str, dims: &[i64], data_type: i32, raw_data: Vec<u8>) {
        self.constants.push(TensorProto { dims: dims.to_vec(), data_type, name: name.to_owned(), raw_data });
    }
}

fn attribute(name: &str, r#type: i32) -> AttributeProto {
    AttributeProto { name: name.to_owned(), r#type, ..Default::default() }
}

fn float(name: &str, value: f32) -> AttributeProto {
    AttributeProto { f: Some(value), ..attribute(name, 1) }
}

fn int(name: &str, value: i64) -> AttributeProto {
    AttributeProto { i: Some(value), ..attribute(name, 2) }
}

fn text(name: &str, value: &str) -> AttributeProto {
    AttributeProto { s: Some(value.as_bytes().to_vec()), ..attribute(name, 3) }
}

fn ints(name: &str, values: &[i64]) -> AttributeProto {
    AttributeProto { ints: values.to_vec(), ..attribute(name, 7) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Reach, Weights};
    use std::collections::HashSet;

    fn model(channel_order: ChannelOrder) -> Model {
        let spec = NetSpec::ao(channel_order, Reach { radius: 1.0, diagonal_share: 0.05, height: 512 });
        Model { weights: Weights::random(&spec, 1), spec }
    }

    #[test]
    fn every_value_is_made_once_before_it_is_read() {
        for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
            let proto = ModelProto::decode(&encode(&model(order))[..]).expect("decodes");
            let graph = proto.graph.expect("a graph");
            let mut known: HashSet<String> = graph.initializer.iter().map(|t| t.name.clone()).collect();
            assert_eq!(known.len(), graph.initializer.len(), "names of constants");
            known.extend(["".to_owned(), INPUT.to_owned()]);
            for node in &graph.node {
                assert!(node.input.iter().all(|name| known.contains(name)), "{node:?}");
                assert!(known.insert(node.output[0].clone()), "{} is made twice", node.output[0]);
            }
            assert!(known.contains(OUTPUT));
        }
    }

    #[test]
    fn weights_and_groups_are_the_models() {
        let model = model(ChannelOrder::Interleaved);
        let proto = ModelProto::decode(&encode(&model)[..]).expect("decodes");
        let graph = proto.graph.expect("a graph");
        for (layer, weights) in model.spec.layers().iter().zip(&model.weights.0) {
            let name = format!("{}.weight", layer.name);
            let tensor = graph.initializer.iter().find(|t| t.name == name).expect("its weights");
            let numbers: Vec<f32> =
                tensor.raw_data.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
            assert_eq!(numbers, weights.weight);
            let node = graph.node.iter().find(|node| node.input.contains(&name)).expect("its convolution");
            let group = node.attribute.iter().find(|a| a.name == "group").and_then(|a| a.i);
            assert_eq!(group, Some(layer.groups as i64));
        }
    }

    #[test]
    fn only_the_interleaved_order_gathers() {
        let gathers = |order| {
            let proto = ModelProto::decode(&encode(&model(order))[..]).expect("decodes");
            proto.graph.expect("a graph").node.iter().filter(|node| node.op_type == "Gather").count()
        };
        assert_eq!((gathers(ChannelOrder::Contiguous), gathers(ChannelOrder::Interleaved)), (0, 4));
    }
}
