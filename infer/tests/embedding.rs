//! What programs that embed a network rely on: tiles, several networks in one encoder, little memory.

use deepshade_infer::forward::{Input, Options, Output, OutputKind, Precision, Variant};
use deepshade_infer::parity::{Comparison, noise};
use deepshade_infer::{ChannelOrder, Filter, Head, NetSpec, Network, Reach, Weights, reference};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Effect, Planes};

const REACH: Reach = Reach { radius: 2.0, diagonal_share: 0.05, height: 512 };

fn gpu() -> Gpu {
    Gpu::new().expect("the tests need a Vulkan, Metal or DirectX 12 adapter; a software one will do")
}

fn spec(levels: usize) -> NetSpec {
    NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = levels)
}

/// Of a network that predicts kernels.
fn filtering() -> NetSpec {
    let dof = NetSpec::published(Effect::Dof, ChannelOrder::Interleaved, REACH).expect("it has one");
    dof.with_head(Head::Filter(Filter { levels: 2, kernel: 3, black: false })).reshaped(|net| net.levels = 2)
}

fn network(gpu: &Gpu, spec: &NetSpec, variant: Option<Variant>, precision: Precision) -> Network {
    let options = Options { variant, precision, ..Options::default() };
    Network::with(&gpu.device, spec, &Weights::random(spec, 5), &options).expect("compiles")
}

/// The network's image within that many bytes of feature maps, and in how many tiles.
fn image_within(gpu: &Gpu, network: &Network, input: &Planes, bytes: u64) -> (Planes, usize) {
    let plan = network.plan_within(input.height(), input.width(), bytes).expect("fits");
    assert!(plan.bytes().activations <= bytes);
    let source = gpu::storage(&gpu.device, "input", input.data()).expect("room");
    let elements = network.spec().output_channels() * input.pixels();
    let target = gpu::empty::<f32>(&gpu.device, "output", elements).expect("room");
    gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| {
        plan.encode(encoder, &source, &target).expect("records");
    })
    .expect("runs");
    (plan.image(&gpu.queue, &target).expect("reads"), plan.tiles())
}

#[test]
fn tiles_make_what_the_whole_makes_bit_for_bit() {
    let gpu = gpu();
    for spec in [spec(3), filtering()] {
        let staged = Variant::gpu(&gpu.device.limits(), &spec, OutputKind::Buffer);
        for (variant, precision) in
            [(Variant::Software, Precision::F32), (staged.clone(), Precision::F32), (staged, Precision::F16)]
        {
            let network = network(&gpu, &spec, Some(variant), precision);
            for (height, width) in [(130, 203), (61, 150)] {
                let input = noise(spec.input_channels(), height, width, 3);
                let (whole, one) = image_within(&gpu, &network, &input, u64::MAX);
                let bytes = network.plan(height, width).expect("fits").bytes().activations;
                let (tiled, tiles) = image_within(&gpu, &network, &input, bytes / 2);
                assert!(one == 1 && tiles > 1);
                assert_eq!(whole, tiled, "{height}x{width} in {tiles} tiles, {precision:?}");
            }
        }
    }
}

#[test]
fn a_device_of_narrow_limits_gets_tiles() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.expect("an adapter");
    let buffers = wgpu::Limits { max_storage_buffer_binding_size: 1 << 20, ..wgpu::Limits::default() };
    let workgroups = wgpu::Limits { max_compute_workgroups_per_dimension: 16, ..wgpu::Limits::default() };
    // At 150x260 a map of down0 has 1.2 MB, kernels of 18 taps 2.8 MB, and 16 workgroups are 128 pixels.
    for (spec, required_limits) in [(spec(2), buffers.clone()), (filtering(), buffers), (spec(2), workgroups)]
    {
        let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device");
        let gpu = Gpu { device, queue, info: adapter.get_info() };
        let variant = Variant::gpu(&gpu.device.limits(), &spec, OutputKind::Buffer);
        let network = network(&gpu, &spec, Some(variant), Precision::F32);
        let input = noise(spec.input_channels(), 150, 260, 3);
        let (image, tiles) = image_within(&gpu, &network, &input, u64::MAX);
        assert!(tiles > 1);
        let expected = reference::forward(&spec, &Weights::random(&spec, 5), &input);
        assert!(Comparison::new(&expected, &image).agrees());
    }
}

#[test]
fn several_networks_go_into_one_encoder_again_and_again() {
    let gpu = gpu();
    let input = noise(6, 37, 53, 1);
    let source = gpu::storage(&gpu.device, "input", input.data()).expect("room");
    let networks = [
        (spec(2), Some(Variant::Software)),
        (spec(3), Some(Variant::gpu(&gpu.device.limits(), &spec(3), OutputKind::Buffer))),
    ]
    .map(|(spec, variant)| network(&gpu, &spec, variant, Precision::F32));
    let runs = networks.map(|network| {
        let plan = network.plan(37, 53).expect("fits");
        let target = gpu::empty::<f32>(&gpu.device, "output", input.pixels()).expect("room");
        let recording = plan.bind(Input::Buffer(&source), Output::Buffer(&target)).expect("fits");
        (network, plan, target, recording)
    });
    for _ in 0..2 {
        gpu::submit(&gpu.device, &gpu.queue, "all", |encoder| {
            runs.iter().for_each(|(.., recording)| recording.encode(encoder));
        })
        .expect("runs");
        for (network, plan, target, _) in &runs {
            let image = plan.image(&gpu.queue, target).expect("reads");
            let spec = network.spec();
            let expected = reference::forward(spec, &Weights::random(spec, 5), &input);
            assert!(Comparison::new(&expected, &image).agrees());
        }
    }
}

#[test]
fn feature_maps_of_a_full_hd_image_are_small() {
    let gpu = gpu();
    let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
    let variant = Variant::gpu(&gpu.device.limits(), &spec, OutputKind::Buffer);
    let network = network(&gpu, &spec, Some(variant), Precision::F16);
    let plan = network.plan(1080, 1920).expect("fits");
    let bytes = plan.bytes();
    assert_eq!(plan.tiles(), 1);
    assert!(bytes.activations <= 80_000_000, "{bytes:?}");
    // 71,089 weights and what fills them up to blocks.
    assert!((284_000 - 4_000..400_000).contains(&bytes.weights), "{bytes:?}");
}
