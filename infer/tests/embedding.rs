//! What programs that embed a network rely on: textures, tiles, several networks in one encoder, little memory.

use deepshade_infer::forward::{Input, InputKind, Options, Output, OutputKind, Precision, Variant};
use deepshade_infer::parity::{Comparison, noise};
use deepshade_infer::{ChannelOrder, NetSpec, Network, Reach, Weights, reference};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, AttributeKind, Effect, GBuffer, Planes};
use wgpu::{TextureFormat, TextureUsages, TextureViewDescriptor};

const REACH: Reach = Reach { radius: 2.0, diagonal_share: 0.05, height: 512 };

fn gpu() -> Gpu {
    Gpu::new().expect("the tests need a Vulkan, Metal or DirectX 12 adapter; a software one will do")
}

fn spec(levels: usize) -> NetSpec {
    NetSpec { levels, ..NetSpec::ao(ChannelOrder::Interleaved, REACH) }
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
    let staged = Variant::staged(&gpu.device, &spec(3), OutputKind::Buffer);
    for (variant, precision) in
        [(Variant::Software, Precision::F32), (staged.clone(), Precision::F32), (staged, Precision::F16)]
    {
        let network = network(&gpu, &spec(3), Some(variant), precision);
        for (height, width) in [(130, 203), (61, 150)] {
            let input = noise(6, height, width, 3);
            let (whole, one) = image_within(&gpu, &network, &input, u64::MAX);
            let bytes = network.plan(height, width).expect("fits").bytes().activations;
            let (tiled, tiles) = image_within(&gpu, &network, &input, bytes / 2);
            assert!(one == 1 && tiles > 1);
            assert_eq!(whole, tiled, "{height}x{width} in {tiles} tiles, {precision:?}");
        }
    }
}

#[test]
fn a_device_of_narrow_limits_gets_tiles() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let adapter = adapter.expect("an adapter");
    let required_limits =
        wgpu::Limits { max_storage_buffer_binding_size: 1 << 20, ..wgpu::Limits::default() };
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device");
    let gpu = Gpu { device, queue, info: adapter.get_info() };
    let variant = Variant::staged(&gpu.device, &spec(2), OutputKind::Buffer);
    let network = network(&gpu, &spec(2), Some(variant), Precision::F32);
    let input = noise(6, 150, 260, 3);
    let (image, tiles) = image_within(&gpu, &network, &input, u64::MAX);
    assert!(tiles > 1, "down0 makes 1.2 MB");
    let expected = reference::forward(&spec(2), &Weights::random(&spec(2), 5), &input);
    assert!(Comparison::new(&expected, &image).agrees());
}

/// A texture of four 32-bit floats a texel with some planes of a g-buffer in its first components.
fn texture(gpu: &Gpu, planes: &Planes) -> wgpu::TextureView {
    let (height, width) = (planes.height(), planes.width());
    let pixel = |at: usize| {
        [0, 1, 2, 3].map(|c| if c < planes.channels() { planes.at(c, at / width, at % width) } else { 9.0 })
    };
    let texels: Vec<[f32; 4]> = (0..height * width).map(pixel).collect();
    let size = wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("gbuffer"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba32Float,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(16 * width as u32),
        rows_per_image: None,
    };
    gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, size);
    texture.create_view(&TextureViewDescriptor::default())
}

/// The network's image, from textures into a texture.
fn image_by_textures(gpu: &Gpu, network: &Network, input: Input<'_>, size: [usize; 2]) -> Planes {
    let [height, width] = size;
    let image = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("image"),
        size: wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba32Float,
        usage: TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let bytes = network.plan(height, width).expect("fits").bytes().activations;
    let plan = network.plan_within(height, width, bytes / 2).expect("fits in tiles");
    assert!(plan.tiles() > 1);
    let target = image.create_view(&TextureViewDescriptor::default());
    let recording = plan.bind(input, Output::Texture(&target)).expect("what the network was made for");
    gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| recording.encode(encoder)).expect("runs");
    let texels = gpu::read_texture_array(&gpu.device, &gpu.queue, &image).expect("reads");
    let channels = network.spec().output_channels();
    let alpha = if channels < 4 { 1.0 } else { texels[3] };
    assert!(texels.chunks(4).all(|texel| texel[3] == alpha && texel[channels..3].iter().all(|v| *v == 0.0)));
    Planes::from_fn(channels, height, width, |c, y, x| texels[(y * width + x) * 4 + c])
}

#[test]
fn textures_give_what_buffers_give() {
    let gpu = gpu();
    let gi = NetSpec::published(Effect::Gi, ChannelOrder::Contiguous, REACH).expect("it has one");
    let dof = NetSpec::published(Effect::Do, ChannelOrder::Interleaved, REACH).expect("it has one");
    for spec in [spec(2), NetSpec { levels: 2, ..gi }, NetSpec { levels: 2, ..dof }] {
        let (height, width, radius) = (45, 131, 0.7);
        let attributes = [&[Attribute::Valid][..], &spec.inputs].concat();
        let channels = attributes.iter().map(|attribute| attribute.width()).sum();
        let mut planes = noise(channels, height, width, 2);
        planes.plane_mut(0).fill(1.0);
        let gbuffer = GBuffer::new(attributes, planes);
        let views: Vec<wgpu::TextureView> = spec
            .inputs
            .iter()
            .map(|attribute| texture(&gpu, &gbuffer.select(&[*attribute]).expect("it is there")))
            .collect();
        let weights = Weights::random(&spec, 5);
        let output = OutputKind::Texture(TextureFormat::Rgba32Float);
        let options = Options { input: InputKind::Textures, output, ..Options::default() };
        let network = Network::with(&gpu.device, &spec, &weights, &options).expect("compiles");
        for run in 0..spec.runs() {
            let length_scale = spec.reach.position_scale(radius);
            let input = Input::Textures { views: &views, length_scale, run };
            let image = image_by_textures(&gpu, &network, input, [height, width]);
            let planes = spec.input(&gbuffer, radius, run).expect("all is there");
            let comparison = Comparison::new(&reference::forward(&spec, &weights, &planes), &image);
            assert!(comparison.agrees(), "{spec:?}, run {run}: {comparison:?}");
        }
        let colours = spec.inputs.iter().any(|attribute| attribute.kind() == AttributeKind::Colour);
        assert_eq!(spec.runs() > 1, colours, "mono networks read colours channel by channel");
    }
}

#[test]
fn several_networks_go_into_one_encoder_again_and_again() {
    let gpu = gpu();
    let input = noise(6, 37, 53, 1);
    let source = gpu::storage(&gpu.device, "input", input.data()).expect("room");
    let networks = [
        (spec(2), Some(Variant::Software)),
        (spec(3), Some(Variant::staged(&gpu.device, &spec(3), OutputKind::Buffer))),
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
    let variant = Variant::staged(&gpu.device, &spec, OutputKind::Buffer);
    let network = network(&gpu, &spec, Some(variant), Precision::F16);
    let plan = network.plan(1080, 1920).expect("fits");
    let bytes = plan.bytes();
    assert_eq!(plan.tiles(), 1);
    assert!(bytes.activations <= 80_000_000, "{bytes:?}");
    // 71,089 weights and what fills them up to blocks.
    assert!((284_000 - 4_000..400_000).contains(&bytes.weights), "{bytes:?}");
}

#[test]
fn what_a_network_was_not_made_for_is_refused() {
    let gpu = gpu();
    let spec = spec(2);
    let weights = Weights::random(&spec, 5);
    let output = OutputKind::Texture(TextureFormat::Rgba8Unorm);
    let options = Options { output, ..Options::default() };
    let error = Network::with(&gpu.device, &spec, &weights, &options).expect_err("too coarse");
    assert!(error.to_string().contains("does not go into Rgba8Unorm"), "{error}");
    let network = Network::new(&gpu.device, &spec, &weights).expect("compiles");
    let plan = network.plan(20, 30).expect("fits");
    let target = gpu::empty::<f32>(&gpu.device, "output", 20 * 30).expect("room");
    let textures = Input::Textures { views: &[], length_scale: 1.0, run: 0 };
    let error = plan.bind(textures, Output::Buffer(&target)).expect_err("it reads a buffer");
    assert!(error.to_string().contains("the network was made for Buffer"), "{error}");
    let options = Options { input: InputKind::Textures, ..Options::default() };
    let network = Network::with(&gpu.device, &spec, &weights, &options).expect("compiles");
    let plan = network.plan(20, 30).expect("fits");
    let error = plan.bind(textures, Output::Buffer(&target)).expect_err("no textures");
    assert!(error.to_string().contains("0 textures; the network reads 2"), "{error}");
    let small = texture(&gpu, &noise(3, 20, 16, 1));
    let views = [small.clone(), small];
    let textures = Input::Textures { views: &views, length_scale: 1.0, run: 0 };
    let error = plan.bind(textures, Output::Buffer(&target)).expect_err("too small");
    assert!(error.to_string().contains("a texture of [20, 16] rows and columns"), "{error}");
}
