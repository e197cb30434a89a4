//! An exported network in half floats: weights and layers, from the first convolution to the last. What goes
//! in and comes out are 32-bit floats still. So are heads: a gate that compares light with an estimate of it
//! would take their rounding for movement.

use super::super::proto::{FLOAT, FLOAT16, GraphProto, ModelProto, NodeProto, TensorProto};
use super::int;
use deepshade_infer::parity::Tolerance;
use half::f16;
use prost::Message;
use std::collections::{BTreeSet, HashSet};
use thiserror::Error;

/// How far the image may be off. Unlike in [`forward`](deepshade_infer::forward) weights are rounded, too, by
/// which alone `do-paper` comes to half of it, of a room at 768x512. The other networks of `models` come to
/// an eighth at most.
pub const ONNX_HALF_TOLERANCE: Tolerance = Tolerance { of_rms: 0.0, of_largest: 5e-2 };

/// Why a network has no file in half floats.
#[derive(Debug, Error)]
pub enum HalfError {
    /// The file cannot be decoded.
    #[error("no ONNX file: {0}")]
    Damaged(#[from] prost::DecodeError),
    /// A weight is too large.
    #[error("`{constant}` has {value:e}, which half floats do not hold")]
    TooLarge {
        /// Name of the weights.
        constant: String,
        /// The weight.
        value: f32,
    },
}

/// The bytes of a file that [`encode`](super::encode) or [`with_layers`](super::with_layers) made, in half
/// floats.
///
/// # Errors
/// If `file` is no ONNX file, or half floats do not hold one of its weights.
pub fn halved(file: &[u8]) -> Result<Vec<u8>, HalfError> {
    let mut model = ModelProto::decode(file)?;
    if let Some(graph) = &mut model.graph {
        halve_weights(graph)?;
        cast_layers(graph);
    }
    Ok(model.encode_to_vec())
}

fn is_convolution(node: &NodeProto) -> bool {
    node.op_type == "Conv"
}

/// Weights and biases.
fn halve_weights(graph: &mut GraphProto) -> Result<(), HalfError> {
    let convolutions = graph.node.iter().filter(|node| is_convolution(node));
    let read: HashSet<&String> = convolutions.flat_map(|node| &node.input).collect();
    graph.initializer.iter_mut().filter(|constant| read.contains(&constant.name)).try_for_each(halve)
}

fn halve(constant: &mut TensorProto) -> Result<(), HalfError> {
    let mut halves = Vec::with_capacity(constant.raw_data.len() / 2);
    for bytes in constant.raw_data.as_chunks().0 {
        let value = f32::from_le_bytes(*bytes);
        let half = f16::from_f32(value);
        if !half.is_finite() {
            return Err(HalfError::TooLarge { constant: constant.name.clone(), value });
        }
        halves.extend(half.to_le_bytes());
    }
    constant.raw_data = halves;
    constant.data_type = FLOAT16;
    Ok(())
}

/// Casts what goes into the layers, and what comes out of them.
fn cast_layers(graph: &mut GraphProto) {
    let (before, mut layers, after) = parts(std::mem::take(&mut graph.node));
    let mut outside = read(&after);
    outside.extend(graph.output.iter().map(|output| output.name.clone()));
    let (entering, leaving) = (&made(&before) & &read(&layers), &made(&layers) & &outside);
    for value in layers.iter_mut().flat_map(|node| node.input.iter_mut().chain(&mut node.output)) {
        if entering.contains(value) || leaving.contains(value) {
            *value = in_half(value);
        }
    }
    let into = entering.iter().map(|name| cast(name, &in_half(name), FLOAT16));
    let out_of = leaving.iter().map(|name| cast(&in_half(name), name, FLOAT));
    graph.node = before.into_iter().chain(into).chain(layers).chain(out_of).chain(after).collect();
}

/// What comes before the first convolution, the layers to the last one, and what comes after it.
fn parts(mut nodes: Vec<NodeProto>) -> (Vec<NodeProto>, Vec<NodeProto>, Vec<NodeProto>) {
    let last = nodes.iter().rposition(is_convolution);
    let after = nodes.split_off(last.map_or(0, |last| last + 1));
    let first = nodes.iter().position(is_convolution);
    let layers = nodes.split_off(first.unwrap_or_default());
    (nodes, layers, after)
}

fn read(nodes: &[NodeProto]) -> BTreeSet<String> {
    nodes.iter().flat_map(|node| node.input.clone()).collect()
}

fn made(nodes: &[NodeProto]) -> BTreeSet<String> {
    nodes.iter().flat_map(|node| node.output.clone()).collect()
}

/// Name of what is cast, in half floats.
fn in_half(name: &str) -> String {
    format!("{name}.half")
}

fn cast(from: &str, to: &str, data_type: i32) -> NodeProto {
    NodeProto {
        input: vec![from.to_owned()],
        output: vec![to.to_owned()],
        name: format!("cast_to_{to}"),
        op_type: "Cast".to_owned(),
        attribute: vec![int("to", i64::from(data_type))],
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::proto::INT64;
    use super::super::{INPUT, encode, with_layers};
    use super::*;
    use deepshade_infer::{AnalyticEstimate, Model, NetSpec, Reach, Weights};
    use deepshade_shaders::Effect;
    use std::collections::HashMap;

    /// One whose head has constants of its own.
    fn model() -> Model {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let estimates = vec![AnalyticEstimate::new("reconstruction", "low")];
        let spec = NetSpec::corrected(Effect::MotionBlur, 8, estimates, reach).expect("it has one");
        Model { weights: Weights::random(&spec, 1), spec }
    }

    fn graph(file: &[u8]) -> GraphProto {
        ModelProto::decode(file).expect("decodes").graph.expect("a graph")
    }

    #[test]
    fn what_convolutions_read_is_halves_near_the_models() {
        let file = encode(&model());
        let (plain, half) = (graph(&file), graph(&halved(&file).expect("halves")));
        for (before, after) in plain.initializer.iter().zip(&half.initializer) {
            if !before.name.ends_with(".weight") && !before.name.ends_with(".bias") {
                assert_eq!(before, after);
                continue;
            }
            assert_eq!((after.data_type, &after.name, &after.dims), (FLOAT16, &before.name, &before.dims));
            let weights = before.raw_data.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
            let halves = after.raw_data.as_chunks().0.iter().map(|bytes| f16::from_le_bytes(*bytes));
            assert_eq!(weights.len(), halves.len());
            for (weight, half) in weights.zip(halves) {
                let off = (weight - half.to_f32()).abs();
                assert!(off <= 2f32.powi(-11) * weight.abs() + 2f32.powi(-25), "{weight}: {half}");
            }
        }
    }

    /// The kind of numbers that a node makes of those that it reads, which are of one kind.
    fn kind_made(node: &NodeProto, kinds: &HashMap<String, i32>) -> i32 {
        let reads: Vec<i32> =
            node.input.iter().filter(|name| !name.is_empty()).map(|name| kinds[name]).collect();
        let read = reads[0];
        match node.op_type.as_str() {
            "Cast" => return node.attribute[0].i.expect("a kind") as i32,
            "Shape" => return INT64,
            // Scales are 32-bit floats in any graph.
            "Resize" => {}
            _ => assert!(reads.iter().all(|kind| [read, INT64].contains(kind)), "{node:?}: {reads:?}"),
        }
        read
    }

    #[test]
    fn layers_alone_are_in_half_floats_and_the_graph_stays_whole() {
        let model = model();
        let layers = with_layers(&encode(&model), &model.spec).expect("decodes");
        for file in [encode(&model), layers] {
            let half = graph(&halved(&file).expect("halves"));
            assert_eq!((&half.input, &half.output), (&graph(&file).input, &graph(&file).output));
            let constants =
                half.initializer.iter().map(|constant| (constant.name.clone(), constant.data_type));
            let mut kinds: HashMap<String, i32> = constants.chain([(INPUT.to_owned(), FLOAT)]).collect();
            for node in &half.node {
                let kind = kind_made(node, &kinds);
                assert!(!is_convolution(node) || kind == FLOAT16, "{node:?}");
                assert_eq!(kinds.insert(node.output[0].clone(), kind), None, "{} is made twice", node.name);
            }
            assert!(half.output.iter().all(|output| kinds[&output.name] == FLOAT));
            let names: HashSet<&str> = half.node.iter().map(|node| node.name.as_str()).collect();
            assert_eq!(names.len(), half.node.len(), "names of nodes");
            let casts = half.node.iter().filter(|node| node.op_type == "Cast").count();
            // Of one output the last layer leaves, of all others theirs, too.
            assert_eq!(casts, 1 + half.output.len());
        }
    }

    #[test]
    fn weights_beyond_half_floats_and_other_files_are_refused() {
        let mut model = model();
        model.weights.0[1].bias[0] = 1e5;
        let error = halved(&encode(&model)).expect_err("too large").to_string();
        let layer = &model.spec.layers()[1].name;
        assert_eq!(error, format!("`{layer}.bias` has 1e5, which half floats do not hold"));
        assert!(matches!(halved(b"no model"), Err(HalfError::Damaged(_))));
    }
}
