//! The WGSL forward pass equals the reference, layer by layer and element by element, on random asymmetric
//! weights.

use deepshade_infer::forward::{
    self, HALF_TOLERANCE, Input, Options, Output, OutputKind, Precision, Variant,
};
use deepshade_infer::parity::{TOLERANCE, first_difference, first_difference_within, noise, rms};
use deepshade_infer::{
    Activation, ChannelOrder, Colour, Comparison, Correction, Filter, Head, Model, NetSpec, Network, Reach,
    Weights, reference,
};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect, Planes};

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

fn gpu() -> Gpu {
    Gpu::new().expect("the tests need a Vulkan, Metal or DirectX 12 adapter; a software one will do")
}

fn ao() -> NetSpec {
    NetSpec::ao(ChannelOrder::Interleaved, REACH)
}

fn random_model(spec: NetSpec) -> Model {
    Model { weights: Weights::random(&spec, 11), spec }
}

/// The kernels for GPUs, of the shapes that are guessed to be best.
fn guess(gpu: &Gpu, spec: &NetSpec) -> Variant {
    Variant::gpu(&gpu.device.limits(), spec, OutputKind::Buffer)
}

fn network(gpu: &Gpu, model: &Model, variant: &Variant, precision: Precision) -> Network {
    let options = Options { variant: Some(variant.clone()), precision, ..Options::default() };
    Network::with(&gpu.device, &model.spec, &model.weights, &options).expect("compiles")
}

/// What every layer makes.
fn layers(
    gpu: &Gpu,
    model: &Model,
    variant: &Variant,
    precision: Precision,
    input: &Planes,
) -> Vec<Activation> {
    let network = network(gpu, model, variant, precision);
    forward::run_layers(&network, &gpu.queue, input).expect("runs")
}

fn assert_agrees(gpu: &Gpu, spec: NetSpec, sizes: &[(usize, usize)]) {
    let model = random_model(spec);
    // The software kernels are for U-nets.
    let software = model.spec.u_net().is_some().then_some(Variant::Software);
    let variants = software.into_iter().chain([guess(gpu, &model.spec)]);
    let networks: Vec<Network> =
        variants.map(|variant| network(gpu, &model, &variant, Precision::F32)).collect();
    for (height, width) in sizes {
        let input = noise(model.spec.input_channels(), *height, *width, 7);
        let expected = reference::layers(&model.spec, &model.weights, &input);
        let what = format!("{:?} at {height}x{width}", model.spec);
        for network in &networks {
            let made = forward::run_layers(network, &gpu.queue, &input).expect("runs");
            assert_eq!(made.len(), expected.len());
            assert_eq!(first_difference(&expected, &made), None, "{what} by {:?}", network.variant());
        }
        let last = &expected[expected.len() - 1].planes;
        // A filter averages what is random.
        let least = if model.spec.filter().is_some() { 0.05 } else { 0.3 };
        let proves = last.pixels() < 100 || (least..3.0).contains(&rms(last));
        assert!(proves, "{what}: an image of rms {} proves little", rms(last));
    }
}

#[test]
fn every_published_network_at_whole_and_odd_sizes() {
    let gpu = gpu();
    for effect in Effect::ALL {
        for order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
            let Some(spec) = NetSpec::published(effect, order, REACH) else { continue };
            let small = matches!(effect, Effect::Ibl | Effect::Real);
            assert_agrees(&gpu, spec, if small { &[(9, 20)] } else { &[(16, 32), (37, 53)] });
        }
    }
}

#[test]
fn one_and_three_levels_in_both_channel_orders() {
    let gpu = gpu();
    for channel_order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
        for levels in [1, 3] {
            let spec = ao().reshaped(|net| (net.levels, net.order) = (levels, channel_order));
            assert_agrees(&gpu, spec, &[(40, 56), (37, 53), (16, 16)]);
        }
    }
}

#[test]
fn kernels_of_other_sizes() {
    let gpu = gpu();
    for (kernel, levels) in [(1, 3), (5, 3), (7, 2)] {
        assert_agrees(
            &gpu,
            ao().reshaped(|net| (net.kernel, net.levels) = (kernel, levels)),
            &[(40, 56), (19, 21)],
        );
    }
}

#[test]
fn numbers_of_channels_that_fill_no_block() {
    let gpu = gpu();
    for channel_order in [ChannelOrder::Contiguous, ChannelOrder::Interleaved] {
        for u0 in [2, 6, 10, 12] {
            assert_agrees(
                &gpu,
                ao().reshaped(|net| (net.u0, net.levels, net.order) = (u0, 4, channel_order)),
                &[(37, 53)],
            );
        }
    }
}

#[test]
fn networks_that_correct_an_estimate() {
    let gpu = gpu();
    let spec = |levels, kernel| {
        let (of, over) = (Attribute::Openness, Attribute::RawOpenness);
        let inputs = vec![Attribute::Normal, of, over];
        let correction = Correction { of, over, levels, kernel, gain: levels != 1, gated: levels > 1 };
        NetSpec::correcting(Effect::Ao, inputs, Vec::new(), correction, 8, REACH)
    };
    for (levels, kernel) in [(0, 1), (1, 5), (3, 3)] {
        assert_agrees(&gpu, spec(levels, kernel), &[(37, 53), (64, 32), (1, 3)]);
    }
    let model = random_model(spec(2, 3));
    let input = noise(model.spec.input_channels(), 333, 900, 1);
    let expected = reference::forward(&model.spec, &model.weights, &input);
    let network = network(&gpu, &model, &guess(&gpu, &model.spec), Precision::F32);
    let image = in_tiles(&gpu, &network, &input, 20_000_000);
    assert!(Comparison::new(&expected, &image).agrees(), "in tiles");
}

#[test]
fn networks_that_predict_kernels() {
    let gpu = gpu();
    let spec = |effect, levels, kernel, colour| {
        let published = NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("it has one");
        NetSpec { colour, ..published }.with_head(Head::Filter(Filter { levels, kernel, black: false }))
    };
    let multi = NetSpec::published(Effect::Multi, ChannelOrder::Interleaved, REACH).expect("it has one");
    for spec in [
        spec(Effect::Dof, 5, 1, Colour::Rgb),
        spec(Effect::Dof, 5, 3, Colour::Rgb),
        spec(Effect::Dof, 4, 3, Colour::Mono),
        spec(Effect::Aa, 1, 5, Colour::Mono),
        multi.predicting_kernels().expect("it reads light"),
    ] {
        assert_agrees(&gpu, spec, &[(16, 32), (37, 53), (1, 3)]);
    }
    let model = random_model(spec(Effect::Dof, 2, 3, Colour::Rgb).reshaped(|net| net.levels = 2));
    let input = noise(model.spec.input_channels(), 133, 187, 1);
    let expected = reference::forward(&model.spec, &model.weights, &input);
    for variant in [Variant::Software, guess(&gpu, &model.spec)] {
        let network = network(&gpu, &model, &variant, Precision::F32);
        let comparison = Comparison::new(&expected, &in_tiles(&gpu, &network, &input, 1_500_000));
        assert!(comparison.agrees(), "{variant:?}: {comparison:?}");
    }
}

/// The network's image, made in tiles within so many bytes.
fn in_tiles(gpu: &Gpu, network: &Network, input: &Planes, bytes: u64) -> Planes {
    let (height, width) = (input.height(), input.width());
    let plan = network.plan_within(height, width, bytes).expect("tiles are small enough");
    assert!(plan.tiles() > 1);
    let [read, made] = [input.channels(), network.spec().output_channels()]
        .map(|channels| gpu::empty::<f32>(&gpu.device, "planes", channels * height * width).expect("room"));
    gpu::write(&gpu.device, &gpu.queue, &read, input.data()).expect("writes");
    let recording = plan.bind(Input::Buffer(&read), Output::Buffer(&made)).expect("binds");
    gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| recording.encode(encoder)).expect("runs");
    plan.image(&gpu.queue, &made).expect("reads")
}

#[test]
fn weights_beyond_one_uniform_buffer() {
    assert_agrees(&gpu(), ao().reshaped(|net| (net.u0, net.levels) = (32, 3)), &[(20, 12)]);
}

#[test]
fn a_plan_runs_again_and_again_with_other_buffers() {
    use deepshade_shaders::gpu;
    let gpu = Gpu::new().expect("an adapter");
    let model = random_model(ao().reshaped(|net| net.levels = 3));
    let network = Network::new(&gpu.device, &model.spec, &model.weights).expect("compiles");
    let plan = network.plan(21, 34).expect("fits");
    for seed in 0..3 {
        let input = noise(6, 21, 34, seed);
        let source = gpu::storage(&gpu.device, "input", input.data()).expect("fits");
        let target = gpu::empty::<f32>(&gpu.device, "output", 21 * 34).expect("fits");
        gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| {
            plan.encode(encoder, &source, &target).expect("records");
        })
        .expect("runs");
        let image = plan.image(&gpu.queue, &target).expect("reads");
        let expected = reference::forward(&model.spec, &model.weights, &input);
        let comparison = Comparison::new(&expected, &image);
        assert!(comparison.agrees(), "{comparison:?}");
    }
}

#[test]
fn every_shape_of_kernels() {
    let gpu = gpu();
    let rgb = NetSpec::published(Effect::Do, ChannelOrder::Contiguous, REACH).expect("it has one");
    // Of three levels, so that layers join maps and are themselves joined.
    for spec in [
        ao().reshaped(|net| net.u0 = 16),
        ao().reshaped(|net| (net.u0, net.kernel) = (8, 5)),
        rgb.reshaped(|net| net.u0 = 8),
    ] {
        let model = random_model(spec.reshaped(|net| net.levels = 3));
        let input = noise(model.spec.input_channels(), 21, 39, 7);
        let expected = reference::layers(&model.spec, &model.weights, &input);
        let candidates = Variant::candidates(&gpu.device.limits(), &model.spec, OutputKind::Buffer);
        assert!(candidates.len() > 5);
        for (precision, tolerance) in [(Precision::F32, TOLERANCE), (Precision::F16, HALF_TOLERANCE)] {
            for variant in &candidates {
                let made = layers(&gpu, &model, variant, precision, &input);
                let difference = first_difference_within(&expected, &made, tolerance);
                assert_eq!(difference, None, "{variant:?}, {precision:?}");
            }
        }
    }
}

#[test]
fn half_floats_stay_within_their_bound() {
    let gpu = gpu();
    let half = gpu.device.features().contains(wgpu::Features::SHADER_F16);
    assert!(half, "lavapipe and GPUs of today have them");
    let contiguous = NetSpec::ao(ChannelOrder::Contiguous, REACH);
    let gi = NetSpec::published(Effect::Gi, ChannelOrder::Interleaved, REACH).expect("it has one");
    for spec in [contiguous, ao(), gi] {
        let model = random_model(spec);
        let input = noise(model.spec.input_channels(), 75, 129, 7);
        let expected = reference::layers(&model.spec, &model.weights, &input);
        let made = layers(&gpu, &model, &guess(&gpu, &model.spec), Precision::F16, &input);
        assert_eq!(first_difference_within(&expected, &made, HALF_TOLERANCE), None);
        assert!(first_difference(&expected, &made).is_some(), "they are not 32-bit floats");
    }
}

#[test]
fn a_wrong_layer_is_found_where_it_is() {
    let gpu = gpu();
    let model = random_model(ao().reshaped(|net| net.levels = 3));
    let input = noise(6, 24, 24, 1);
    let expected = reference::layers(&model.spec, &model.weights, &input);
    let guess = guess(&gpu, &model.spec);
    for (variant, precision, tolerance) in [
        (Variant::Software, Precision::F32, TOLERANCE),
        (guess.clone(), Precision::F32, TOLERANCE),
        (guess, Precision::F16, HALF_TOLERANCE),
    ] {
        for (index, layer) in model.spec.layers().iter().enumerate() {
            let mut wrong = model.clone();
            wrong.weights.0[index].weight.reverse();
            let made = layers(&gpu, &wrong, &variant, precision, &input);
            let (found, _) =
                first_difference_within(&expected, &made, tolerance).expect("the weights are reversed");
            assert_eq!(found, layer.name);
        }
    }
}

#[test]
fn a_runner_makes_every_images_own_image() {
    let gpu = gpu();
    let model = random_model(ao().reshaped(|net| net.levels = 2));
    let network = Network::new(&gpu.device, &model.spec, &model.weights).expect("compiles");
    let runner = network.runner(21, 34).expect("fits");
    for seed in [1, 2, 1] {
        let input = noise(6, 21, 34, seed);
        let (image, _) = runner.run_timed(&gpu.queue, &input, 1, 1).expect("runs");
        let expected = reference::forward(&model.spec, &model.weights, &input);
        let comparison = Comparison::new(&expected, &image);
        assert!(comparison.agrees(), "{seed}: {comparison:?}");
    }
    let error = runner.run_timed(&gpu.queue, &noise(5, 21, 34, 1), 0, 1).expect_err("five channels");
    assert_eq!(error.to_string(), "the input has 5 channels; the network reads 6");
}

#[test]
fn every_layer_is_timed() {
    let gpu = gpu();
    let model = random_model(ao().reshaped(|net| net.levels = 3));
    let network = Network::new(&gpu.device, &model.spec, &model.weights).expect("compiles");
    let times = network.layer_times(&gpu.queue, [40, 56], 1, 3).expect("runs");
    let names: Vec<&str> = times.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["down0", "down1", "down2", "up1", "up0"]);
    assert!(times.iter().all(|(_, timing)| timing.milliseconds > 0.0));
}

#[test]
fn what_cannot_run_is_named() {
    let gpu = gpu();
    let model = random_model(ao().reshaped(|net| net.levels = 2));
    let error = forward::run(&gpu, &model, &Planes::filled(5, 16, 16, 0.0)).expect_err("five channels");
    assert_eq!(error.to_string(), "the input has 5 channels; the network reads 6");
    let network = Network::new(&gpu.device, &model.spec, &model.weights).expect("compiles");
    let message = |height, width| network.plan(height, width).expect_err("cannot be").to_string();
    assert!(message(0, 16).contains("layer `down0` has no pixel"), "{}", message(0, 16));
    assert!(
        message(1 << 16, 1 << 16).contains("layer `down0` binds a buffer of"),
        "{}",
        message(1 << 16, 1 << 16)
    );
    let spec = ao().reshaped(|net| (net.u0, net.levels) = (128, 3));
    let weights = random_model(spec.clone()).weights;
    let software = Options { variant: Some(Variant::Software), ..Options::default() };
    let error = Network::with(&gpu.device, &spec, &weights, &software).expect_err("too wide");
    assert!(error.to_string().contains("layer `up1`: eight of its outputs have"), "{error}");
    let network = Network::new(&gpu.device, &spec, &weights).expect("the others can");
    assert!(matches!(network.variant(), Variant::Gpu(_)));
    let half = Options { precision: Precision::F16, ..software };
    let error = Network::with(&gpu.device, &spec, &weights, &half).expect_err("it has none");
    assert_eq!(error.to_string(), "the software kernels have no half floats");
    let Variant::Gpu(mut shapes) = guess(&gpu, &spec) else { unreachable!("kernels for GPUs") };
    shapes[1].pixels = [2, 1];
    let options = Options { variant: Some(Variant::Gpu(shapes)), ..Options::default() };
    let error = Network::with(&gpu.device, &spec, &weights, &options).expect_err("down1 keeps means");
    assert!(error.to_string().starts_with("layer `down1` has no kernel of Shape"), "{error}");
    let error = network.plan_within(300, 300, 1000).expect_err("too little");
    assert!(error.to_string().contains("no tile of it has feature maps of at most 1000 bytes"), "{error}");
    let plan = network.plan(16, 16).expect("fits");
    let small = gpu::empty::<f32>(&gpu.device, "small", 16 * 16).expect("fits");
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let error = plan.encode(&mut encoder, &small, &small).expect_err("six channels do not fit");
    assert_eq!(error.to_string(), "`deepshade.net.input`: a buffer of 1024 bytes; 6144 are needed");
    let mut unfit = model;
    unfit.weights.0.pop();
    assert!(Network::new(&gpu.device, &unfit.spec, &unfit.weights).is_err());
}
