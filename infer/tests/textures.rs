//! Textures instead of buffers: a renderer's g-buffer in, an image out.

use deepshade_infer::forward::{HALF_TOLERANCE, Input, InputKind, Options, Output, OutputKind, Precision};
use deepshade_infer::parity::{Comparison, TOLERANCE, Tolerance, noise};
use deepshade_infer::{
    ChannelOrder, Colour, Filter, Head, NetSpec, Network, Reach, Scaling, Weights, reference,
};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, AttributeKind, Effect, GBuffer, Planes};
use half::f16;
use wgpu::{TextureFormat, TextureUsages, TextureViewDescriptor};

const REACH: Reach = Reach { radius: 2.0, diagonal_share: 0.05, height: 512 };

fn gpu() -> Gpu {
    Gpu::new().expect("the tests need a Vulkan, Metal or DirectX 12 adapter; a software one will do")
}

fn spec(levels: usize) -> NetSpec {
    NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = levels)
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

/// The network's images, from textures into a texture, of one recording whose input is scaled anew for each.
fn images_by_textures(
    gpu: &Gpu,
    network: &Network,
    (views, run): (&[wgpu::TextureView], usize),
    scalings: &[Scaling],
    size: [usize; 2],
    format: TextureFormat,
) -> Vec<Planes> {
    let [height, width] = size;
    let image = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("image"),
        size: wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let bytes = network.plan(height, width).expect("fits").bytes().activations;
    let plan = network.plan_within(height, width, bytes / 2).expect("fits in tiles");
    assert!(plan.tiles() > 1);
    let target = image.create_view(&TextureViewDescriptor::default());
    let input = Input::Textures { views, scaling: scalings[0], run };
    let recording = plan.bind(input, Output::Texture(&target)).expect("what the network was made for");
    let mut images = Vec::new();
    for (frame, scaling) in scalings.iter().enumerate() {
        if frame > 0 {
            recording.set_scaling(&gpu.queue, *scaling);
        }
        gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| recording.encode(encoder)).expect("runs");
        images.push(read(gpu, network, &image, size));
    }
    images
}

/// The network's image that a texture holds.
fn read(gpu: &Gpu, network: &Network, image: &wgpu::Texture, [height, width]: [usize; 2]) -> Planes {
    let format = image.format();
    let elements = match format {
        TextureFormat::Rgba16Float => {
            let halves = gpu::read_texture_array::<f16>(&gpu.device, &gpu.queue, image).expect("reads");
            halves.into_iter().map(f16::to_f32).collect()
        }
        _ => gpu::read_texture_array(&gpu.device, &gpu.queue, image).expect("reads"),
    };
    let (components, channels) = (usize::from(format.components()), network.spec().output_channels());
    let rest = |texel: &[f32]| {
        channels == components || (texel[channels..3] == [0.0; 3][channels..] && texel[3] == 1.0)
    };
    assert!(elements.chunks(components).all(rest));
    Planes::from_fn(channels, height, width, |c, y, x| elements[(y * width + x) * components + c])
}

/// All of a network's runs in 32-bit floats, and one in half floats, which lavapipe and GPUs of today have.
/// Not where kernels are predicted: an error in them makes one of the image that grows with the light, of
/// which the tolerance knows nothing.
fn runs(spec: &NetSpec) -> Vec<(Precision, usize)> {
    let half = spec.filter().is_none().then_some((Precision::F16, 0));
    (0..spec.runs()).map(|run| (Precision::F32, run)).chain(half).collect()
}

#[test]
fn textures_give_what_buffers_give() {
    let gpu = gpu();
    let gi = NetSpec::published(Effect::Gi, ChannelOrder::Contiguous, REACH).expect("it has one");
    let directional = NetSpec::published(Effect::Do, ChannelOrder::Interleaved, REACH).expect("it has one");
    // Reads a length a colour channel.
    let sss = NetSpec::published(Effect::Sss, ChannelOrder::Interleaved, REACH).expect("it has one");
    let coloured_sss = NetSpec { colour: Colour::Rgb, ..sss.clone() };
    let [gi, directional, sss, coloured_sss] =
        [gi, directional, sss, coloured_sss].map(|spec| spec.reshaped(|net| net.levels = 2));
    let head = Head::Filter(Filter { levels: 2, kernel: 3, black: false });
    let [filtering, coloured_filtering] = [&sss, &coloured_sss].map(|sss| sss.clone().with_head(head));
    for (spec, format) in [
        (filtering, TextureFormat::R32Float),
        (coloured_filtering, TextureFormat::Rgba32Float),
        (spec(2), TextureFormat::R32Float),
        (gi, TextureFormat::Rgba32Float),
        (directional, TextureFormat::Rgba16Float),
        (sss, TextureFormat::R32Float),
        (coloured_sss, TextureFormat::Rgba32Float),
    ] {
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
        let output = OutputKind::Texture(format);
        for (precision, run) in runs(&spec) {
            let options = Options { input: InputKind::Textures, output, precision, ..Options::default() };
            let network = Network::with(&gpu.device, &spec, &weights, &options).expect("compiles");
            let scaling = Scaling { light: 0.7, ..spec.scaling(&gbuffer, radius).expect("all is there") };
            let scalings = [scaling, Scaling { length: 0.5 * scaling.length, light: 0.3 }];
            let input = (&views[..], run);
            let images = images_by_textures(&gpu, &network, input, &scalings, [height, width], format);
            // A conversion to half floats may cut off, so that values, below 8, are off by at most 2^-10 of
            // that.
            let of_rms = if format == TextureFormat::Rgba16Float { 8e-3 } else { TOLERANCE.of_rms };
            let kind = if precision == Precision::F16 { HALF_TOLERANCE } else { TOLERANCE };
            let tolerance = Tolerance { of_rms, ..kind };
            for (scaling, image) in scalings.into_iter().zip(images) {
                let planes = spec.input(&gbuffer, scaling, run).expect("all is there");
                let expected = reference::forward(&spec, &weights, &planes);
                let comparison = Comparison::within(&expected, &image, tolerance);
                assert!(
                    comparison.agrees(),
                    "{spec:?}, run {run}, {precision:?}, {scaling:?}: {comparison:?}"
                );
            }
        }
        let colours = spec.inputs.iter().any(|attribute| attribute.kind() == AttributeKind::Colour);
        assert_eq!(
            spec.runs() > 1,
            colours && spec.colour == Colour::Mono,
            "mono networks read colours channel by channel"
        );
    }
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
    let textures = Input::Textures { views: &[], scaling: Scaling { length: 1.0, light: 1.0 }, run: 0 };
    let error = plan.bind(textures, Output::Buffer(&target)).expect_err("it reads a buffer");
    assert!(error.to_string().contains("the network was made for Buffer"), "{error}");
    let options = Options { input: InputKind::Textures, ..Options::default() };
    let network = Network::with(&gpu.device, &spec, &weights, &options).expect("compiles");
    let plan = network.plan(20, 30).expect("fits");
    let error = plan.bind(textures, Output::Buffer(&target)).expect_err("no textures");
    assert!(error.to_string().contains("0 textures; the network reads 2"), "{error}");
    let small = texture(&gpu, &noise(3, 20, 16, 1));
    let views = [small.clone(), small];
    let textures = Input::Textures { views: &views, scaling: Scaling { length: 1.0, light: 1.0 }, run: 0 };
    let error = plan.bind(textures, Output::Buffer(&target)).expect_err("too small");
    assert!(error.to_string().contains("a texture of [20, 16] rows and columns"), "{error}");
}
