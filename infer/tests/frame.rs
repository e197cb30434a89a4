//! What is made on the device before and after a network equals what is made in main memory.

mod common;

use common::gbuffer;
use deepshade_infer::forward::{
    ForwardError, FrameRecording, FrameScale, ImageBuffers, ImagePass, InputPasses, InputSource,
};
use deepshade_infer::parity::noise;
use deepshade_infer::{AnalyticEstimate, ChannelOrder, NetSpec, Network, Reach, Scaling, Weights, reference};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect, GBuffer, Planes};

const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
/// What a sum of thousands of depths may be off by, over the radius.
const TOLERANCE: f32 = 2e-5;

fn gpu() -> Gpu {
    Gpu::new().expect("the tests need a Vulkan, Metal or DirectX 12 adapter; a software one will do")
}

/// The network that corrects an estimate of an effect.
fn corrected_of(effect: Effect, method: &str) -> NetSpec {
    NetSpec::corrected(effect, 8, vec![AnalyticEstimate::new(method, "low")], REACH).expect("it has one")
}

fn corrected() -> NetSpec {
    corrected_of(Effect::Ao, "gtao")
}

fn published(effect: Effect) -> NetSpec {
    NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("it has one")
}

fn size_of(gbuffer: &GBuffer) -> [usize; 2] {
    [gbuffer.height(), gbuffer.width()]
}

fn frame(spec: &NetSpec, gbuffer: &GBuffer, radius: f32) -> FrameScale {
    let scaling = spec.scaling(gbuffer, radius).expect("everything is there");
    FrameScale { focal_length: gbuffer.focal_length().expect("positions are there"), radius, scaling }
}

/// The attributes' buffers.
fn uploaded(gpu: &Gpu, gbuffer: &GBuffer) -> Vec<(Attribute, wgpu::Buffer)> {
    let send = |attribute: &Attribute| {
        let planes = gbuffer.select(&[*attribute]).expect("it is there");
        (*attribute, gpu::storage(&gpu.device, attribute.name(), planes.data()).expect("room"))
    };
    gbuffer.attributes().iter().map(send).collect()
}

fn borrowed(buffers: &[(Attribute, wgpu::Buffer)]) -> Vec<(Attribute, &wgpu::Buffer)> {
    buffers.iter().map(|(attribute, buffer)| (*attribute, buffer)).collect()
}

fn planes(gpu: &Gpu, buffer: &wgpu::Buffer, channels: usize, [height, width]: [usize; 2]) -> Planes {
    let data = gpu::read(&gpu.device, &gpu.queue, buffer).expect("read");
    Planes::from_data(channels, height, width, data)
}

fn run(gpu: &Gpu, recording: &FrameRecording) {
    gpu::submit(&gpu.device, &gpu.queue, "frame", |encoder| recording.encode(encoder)).expect("runs");
}

/// What a run reads, made in main memory.
fn expected(spec: &NetSpec, gbuffer: &GBuffer, frame: FrameScale, run: usize) -> Planes {
    let prepared = spec.prepared(gbuffer, frame.radius).expect("positions are there");
    spec.input(&prepared, frame.scaling, run).expect("everything is there")
}

/// The largest difference of a channel, or infinity where one of two numbers is none.
fn difference(a: &[f32], b: &[f32]) -> f32 {
    let apart = |(a, b): (&f32, &f32)| if a == b { 0.0 } else { (a - b).abs() };
    a.iter().zip(b).map(apart).map(|d| if d.is_nan() { f32::INFINITY } else { d }).fold(0.0, f32::max)
}

/// Which channels are made of others.
fn is_made(spec: &NetSpec) -> Vec<bool> {
    let channels = |attribute: &Attribute| vec![!attribute.made_of().is_empty(); spec.width(*attribute)];
    spec.inputs.iter().flat_map(channels).collect()
}

fn assert_same_input(spec: &NetSpec, expected: &Planes, made: &Planes) {
    for (channel, is_made) in is_made(spec).into_iter().enumerate() {
        let difference = difference(expected.plane(channel), made.plane(channel));
        let allowed = if is_made { TOLERANCE } else { 0.0 };
        let largest = expected.plane(channel).iter().fold(0.0f32, |most, value| most.max(value.abs()));
        assert!(difference <= allowed, "{:?}: channel {channel} is off by {difference}", spec.inputs);
        assert!(largest > 0.0 && largest.is_finite(), "{:?}: channel {channel} proves nothing", spec.inputs);
    }
}

#[test]
fn a_networks_input_is_the_same_at_odd_sizes_whatever_it_reads() {
    let gpu = gpu();
    let effects = [Effect::Sss, Effect::Multi, Effect::MotionBlur];
    let filters = [
        (Effect::Dof, "ring-gather"),
        (Effect::MotionBlur, "reconstruction"),
        (Effect::Sss, "separable"),
        (Effect::Multi, "occluded-gather"),
    ];
    let filters = filters.into_iter().map(|(effect, method)| corrected_of(effect, method));
    let specs: Vec<NetSpec> =
        effects.into_iter().map(published).chain([corrected()]).chain(filters).collect();
    for (height, width) in [(45, 67), (130, 201), (3, 2)] {
        let gbuffer = gbuffer(height, width);
        let buffers = uploaded(&gpu, &gbuffer);
        for spec in &specs {
            let passes = InputPasses::new(&gpu.device, spec).expect("compiles");
            let count = spec.input_channels() * height * width;
            let input = gpu::empty::<f32>(&gpu.device, "input", count).expect("room");
            for run_index in 0..spec.runs() {
                let frame = frame(spec, &gbuffer, 0.4);
                let attributes = &borrowed(&buffers);
                let source = InputSource { size: size_of(&gbuffer), attributes, run: run_index, frame };
                run(&gpu, &passes.bind(&source, &input).expect("fits"));
                let made = planes(&gpu, &input, spec.input_channels(), size_of(&gbuffer));
                assert_same_input(spec, &expected(spec, &gbuffer, frame, run_index), &made);
            }
        }
    }
}

#[test]
fn another_frames_radius_is_set_without_binding_anew() {
    let gpu = gpu();
    let (spec, gbuffer) = (corrected(), gbuffer(45, 67));
    let buffers = uploaded(&gpu, &gbuffer);
    let passes = InputPasses::new(&gpu.device, &spec).expect("compiles");
    let (channels, size) = (spec.input_channels(), size_of(&gbuffer));
    let input = gpu::empty::<f32>(&gpu.device, "input", channels * 45 * 67).expect("room");
    let [near, far] = [0.4, 0.9].map(|radius| frame(&spec, &gbuffer, radius));
    let source = InputSource { size, attributes: &borrowed(&buffers), run: 0, frame: near };
    let recording = passes.bind(&source, &input).expect("fits");
    recording.set(&gpu.queue, far);
    run(&gpu, &recording);
    let made = planes(&gpu, &input, channels, size);
    assert_same_input(&spec, &expected(&spec, &gbuffer, far, 0), &made);
    let before = expected(&spec, &gbuffer, near, 0);
    for (channel, is_made) in is_made(&spec).into_iter().enumerate() {
        let difference = difference(before.plane(channel), made.plane(channel));
        assert_eq!(difference > 0.05, is_made, "channel {channel} differs by {difference}");
    }
}

#[test]
fn an_image_is_in_the_frames_light_with_its_background() {
    let gpu = gpu();
    let gbuffer = gbuffer(45, 67);
    let size = size_of(&gbuffer);
    let valid =
        &uploaded(&gpu, &gbuffer).into_iter().find(|(of, _)| *of == Attribute::Valid).expect("held").1;
    for spec in [published(Effect::Gi), published(Effect::Multi), corrected()] {
        let pass = ImagePass::new(&gpu.device, &spec).expect("compiles");
        let scaling = Scaling { length: 1.0, light: 0.3 };
        let frame = FrameScale { focal_length: 1.0, radius: 1.0, scaling };
        let runs: Vec<Planes> =
            (0..spec.runs()).map(|run| noise(spec.output_channels(), 45, 67, run as u32)).collect();
        let channels = spec.effect.channels();
        let image = gpu::empty::<f32>(&gpu.device, "image", channels * 45 * 67).expect("room");
        for (run_index, made) in runs.iter().enumerate() {
            let made = gpu::storage(&gpu.device, "made", made.data()).expect("room");
            let buffers = ImageBuffers { size, valid, made: &made, image: &image, run: run_index };
            run(&gpu, &pass.bind(&buffers, frame).expect("fits"));
        }
        let mut expected = spec.image(&runs, scaling);
        let unlike = spec.image(&runs, Scaling { light: 1.0, ..scaling });
        spec.set_background(&gbuffer, &mut expected).expect("has a mask");
        let made = planes(&gpu, &image, channels, size);
        assert!(difference(expected.data(), made.data()) < 1e-5, "{}", spec.effect);
        assert!(difference(unlike.data(), made.data()) > 0.1, "{}", spec.effect);
    }
}

#[test]
fn all_of_a_frame_goes_into_one_encoder() {
    let gpu = gpu();
    let (spec, gbuffer, size) = (corrected(), gbuffer(45, 67), [45, 67]);
    let buffers = uploaded(&gpu, &gbuffer);
    let attributes = borrowed(&buffers);
    let weights = Weights::random(&spec, 5);
    let network = Network::new(&gpu.device, &spec, &weights).expect("compiles");
    let runner = network.runner(45, 67).expect("room");
    let frame = frame(&spec, &gbuffer, 0.4);
    let passes = InputPasses::new(&gpu.device, &spec).expect("compiles");
    let source = InputSource { size, attributes: &attributes, run: 0, frame };
    let before = passes.bind(&source, runner.input()).expect("fits");
    let image = gpu::empty::<f32>(&gpu.device, "image", 45 * 67).expect("room");
    let valid = attributes.iter().find(|(of, _)| *of == Attribute::Valid).expect("held").1;
    let buffers = ImageBuffers { size, valid, made: runner.output(), image: &image, run: 0 };
    let after = ImagePass::new(&gpu.device, &spec).and_then(|pass| pass.bind(&buffers, frame)).expect("fits");
    gpu::submit(&gpu.device, &gpu.queue, "frame", |encoder| {
        before.encode(encoder);
        runner.encode(encoder);
        after.encode(encoder);
    })
    .expect("runs");
    let made = planes(&gpu, &image, 1, size);
    let of_radius = |radius: f32| {
        let prepared = spec.prepared(&gbuffer, radius).expect("positions are there");
        let input = spec.input(&prepared, frame.scaling, 0).expect("everything is there");
        let mut image = spec.image(&[reference::forward(&spec, &weights, &input)], frame.scaling);
        spec.set_background(&gbuffer, &mut image).expect("has a mask");
        image
    };
    assert!(difference(of_radius(0.4).data(), made.data()) < 1e-3);
    assert!(difference(of_radius(0.8).data(), made.data()) > 1e-2, "another radius");
}

#[test]
fn what_is_missing_or_too_small_is_named() {
    let gpu = gpu();
    let (spec, gbuffer, size) = (corrected(), gbuffer(9, 8), [9, 8]);
    let buffers = uploaded(&gpu, &gbuffer);
    let attributes = borrowed(&buffers);
    let passes = InputPasses::new(&gpu.device, &spec).expect("compiles");
    let reads = passes.reads();
    assert!([Attribute::Valid, Attribute::Position, Attribute::Openness].iter().all(|of| reads.contains(of)));
    assert!(!reads.contains(&Attribute::Relief), "it is made");
    let input = gpu::empty::<f32>(&gpu.device, "input", spec.input_channels() * 9 * 8).expect("room");
    let frame = frame(&spec, &gbuffer, 0.4);
    let whole = InputSource { size, attributes: &attributes, run: 0, frame };
    assert!(passes.bind(&whole, &input).is_ok());
    for lacking in passes.reads() {
        let others: Vec<_> = attributes.iter().copied().filter(|(of, _)| *of != lacking).collect();
        let refused = passes.bind(&InputSource { attributes: &others, ..whole }, &input);
        assert!(matches!(refused, Err(ForwardError::Missing(missing)) if missing.wanted == lacking.name()));
    }
    let named = |source: &InputSource<'_>, input: &wgpu::Buffer| {
        passes.bind(source, input).map(|_| ()).map_err(|error| error.to_string())
    };
    assert!(named(&InputSource { run: 1, ..whole }, &input).is_err_and(|error| error.contains("run 1 of 1")));
    assert!(named(&InputSource { size: [9, 9], ..whole }, &input).is_err_and(|e| e.contains("input")));
    let large = gpu::empty::<f32>(&gpu.device, "input", spec.input_channels() * 9 * 9).expect("room");
    assert!(named(&InputSource { size: [9, 9], ..whole }, &large).is_err_and(|e| e.contains("bytes")));
}
