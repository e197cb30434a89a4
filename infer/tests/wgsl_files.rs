//! A network's WGSL files run in a host that knows nothing of deepshade but what `HOST.md` says: from the
//! buffers of a g-buffer to the effect's image.

mod common;
#[path = "common/host.rs"]
mod host;

use common::gbuffer;
use deepshade_infer::forward::{HALF_TOLERANCE, Precision, WgslFiles, wgsl_files};
use deepshade_infer::parity::TOLERANCE;
use deepshade_infer::{
    AnalyticEstimate, ChannelOrder, Colour, Comparison, Filter, Head, Model, NetSpec, Reach, Scaling,
    Weights, reference,
};
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Effect, GBuffer, Planes};
use host::{Host, number};
use serde_json::Value;
use std::collections::HashMap;

/// How far effects reach in the tests, metres.
const RADIUS: f32 = 0.4;

fn published(effect: Effect) -> NetSpec {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    NetSpec::published(effect, ChannelOrder::Interleaved, reach).expect("it has one")
}

/// A network that corrects an estimate, and reads what is made of positions.
fn correcting(effect: Effect, method: &str) -> NetSpec {
    let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
    let estimate = AnalyticEstimate::new(method, "low");
    NetSpec::corrected(effect, 8, vec![estimate], reach).expect("it has one")
}

/// Networks of which some fill no block of outputs.
fn specs() -> [NetSpec; 10] {
    let filter = |levels, kernel| Head::Filter(Filter { levels, kernel, black: false });
    [
        NetSpec { colour: Colour::Rgb, ..published(Effect::Dof) }.with_head(filter(5, 1)),
        published(Effect::MotionBlur).with_head(filter(2, 3)),
        correcting(Effect::Ao, "gtao"),
        correcting(Effect::Gi, "surfel"),
        published(Effect::Multi).predicting_kernels().expect("it reads light"),
        published(Effect::Ao),
        published(Effect::Aa),
        published(Effect::Ibl),
        published(Effect::Ao).reshaped(|net| (net.u0, net.levels) = (12, 3)),
        published(Effect::Do).reshaped(|net| (net.order, net.levels) = (ChannelOrder::Contiguous, 3)),
    ]
}

/// What a host makes of a g-buffer in the buffer of that name.
fn made(
    gpu: &Gpu,
    model: &Model,
    precision: Precision,
    name: &str,
    gbuffer: &GBuffer,
    scaling: Scaling,
) -> Planes {
    let WgslFiles { files, attributes } = wgsl_files(model, precision, &[]).expect("files");
    let focal_length = f64::from(gbuffer.focal_length().expect("positions are there"));
    let frame = HashMap::from([
        ("radius", f64::from(RADIUS)),
        ("focal_length", focal_length),
        ("exposure", f64::from(scaling.light)),
    ]);
    let size @ [height, width] = [gbuffer.height(), gbuffer.width()];
    let filled = attributes.iter().map(|attribute| {
        let planes = gbuffer.select(&[*attribute]).expect("it is there");
        (attribute.name().to_owned(), planes.data().to_vec())
    });
    let data = Host::new(gpu, &files, size, frame).run(&filled.collect(), name);
    Planes::from_data(data.len() / (height * width), height, width, data)
}

/// What each run of the network makes, in plain Rust.
fn outputs(model: &Model, gbuffer: &GBuffer, scaling: Scaling) -> Vec<Planes> {
    let Model { spec, weights } = model;
    let prepared = spec.prepared(gbuffer, RADIUS).expect("positions are there");
    let input = |run| spec.input(&prepared, scaling, run).expect("everything is there");
    (0..spec.runs()).map(|run| reference::forward(spec, weights, &input(run))).collect()
}

/// The effect's image of it.
fn image(spec: &NetSpec, gbuffer: &GBuffer, scaling: Scaling, outputs: &[Planes]) -> Planes {
    let mut image = spec.image(outputs, scaling);
    spec.set_background(gbuffer, &mut image).expect("validity is there");
    image
}

/// What of two images lies where a surface is seen; elsewhere some have no background.
fn seen(gbuffer: &GBuffer, image: &Planes) -> Planes {
    let seen = gbuffer.seen().expect("validity is there");
    Planes::from_fn(image.channels(), image.height(), image.width(), |c, y, x| {
        if seen[y * image.width() + x] { image.at(c, y, x) } else { 0.0 }
    })
}

#[test]
fn a_host_that_knows_the_files_alone_makes_the_effects_image() {
    let gpu = Gpu::new().expect("an adapter");
    let half = gpu.device.features().contains(wgpu::Features::SHADER_F16);
    for spec in specs() {
        let [width, height] = if spec.effect == Effect::Ibl { [20, 9] } else { [53, 37] };
        let gbuffer = gbuffer(height, width);
        let model = Model { weights: Weights::random(&spec, 5), spec };
        let scaling = model.spec.scaling(&gbuffer, RADIUS).expect("everything is there");
        let outputs = outputs(&model, &gbuffer, scaling);
        // Half floats are held against what is not yet cut to the effect's range.
        let last = outputs[outputs.len() - 1].clone();
        let image = image(&model.spec, &gbuffer, scaling, &outputs);
        let mut wrong = model.clone();
        wrong.weights.0[0].weight.reverse();
        let kinds = [
            (Precision::F32, "image", &image, TOLERANCE),
            (Precision::F32, "output", &last, TOLERANCE),
            (Precision::F16, "output", &last, HALF_TOLERANCE),
        ];
        for (precision, name, expected, tolerance) in
            kinds.into_iter().filter(|(kind, ..)| half || *kind == Precision::F32)
        {
            let compare = |model: &Model| {
                let made = made(&gpu, model, precision, name, &gbuffer, scaling);
                Comparison::within(&seen(&gbuffer, expected), &seen(&gbuffer, &made), tolerance)
            };
            let comparison = compare(&model);
            assert!(comparison.agrees(), "{:?}, {precision:?}: {comparison:?}", model.spec.effect);
            assert!(!compare(&wrong).agrees(), "{:?}, {precision:?}", model.spec.effect);
        }
    }
}

#[test]
fn every_map_has_room_for_what_its_kernel_writes() {
    for spec in specs() {
        let model = Model { weights: Weights::random(&spec, 5), spec };
        let files = wgsl_files(&model, Precision::F32, &[]).expect("files").files;
        let file = |name: &Value| {
            let (_, bytes) = files.iter().find(|(file, _)| *name == file[..]).expect("it is there");
            std::str::from_utf8(bytes).expect("text")
        };
        let network: Value = serde_json::from_str(file(&Value::from("network.json"))).expect("JSON");
        let layers = model.spec.layers();
        for layer in layers.iter().filter(|layer| layer.activation) {
            let mut passes = network["passes"].as_array().expect("passes").iter();
            let pass = passes.find(|pass| pass["name"] == layer.name[..]).expect("a pass");
            let (_, outputs) = file(&pass["file"]).split_once("const OUTPUTS = ").expect("a constant");
            let (outputs, _) = outputs.split_once("u;").expect("a number");
            let outputs: u64 = outputs.parse().expect("a number");
            let part = &network["buffers"][&layer.name]["made"][0];
            assert_eq!(4 * number(&part["planes"]), outputs * number(&pass["workgroups_z"]), "{part}");
        }
    }
}
