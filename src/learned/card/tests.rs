//! One encoder makes what the processor makes step by step.

use super::*;
use crate::engine::Engine;
use crate::learned::Learned;
use crate::learned::estimates::SEED;
use deepshade_infer::{AnalyticEstimate, ChannelOrder, Model, Reach, Weights};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::Method;
use deepshade_render::scene::{Camera, Lens, SceneSource};
use deepshade_shaders::Effect;
use glam::Vec3;

const REACH: Reach = Reach { radius: 0.5, diagonal_share: 0.05, height: 64 };
const SIZE: [usize; 2] = [40, 56];

fn stairs() -> GBuffer {
    let stairs: SceneSource = "stairs:7".parse().expect("a family");
    let scene = TracedScene::new(stairs.scene(0.0).expect("a scene")).expect("a scene");
    let camera = Camera::look_at(Vec3::new(0.3, 1.0, 1.0), Vec3::new(0.0, 0.4, -4.0));
    gbuffer::render(&scene, &camera, SIZE[0], SIZE[1], &Attribute::ALL)
}

/// A network with weights that nobody has trained.
fn random(spec: NetSpec) -> Model {
    Model { weights: Weights::random(&spec, 3), spec }
}

/// The network that corrects gtao's estimate.
fn corrected() -> Model {
    let estimate = AnalyticEstimate::new("gtao", "low");
    random(NetSpec::corrected(Effect::Ao, 8, vec![estimate], REACH).expect("it has one"))
}

/// What the passes estimate, plane after plane.
fn estimated_by_card(gpu: &Gpu, gbuffer: &GBuffer, radius: f32) -> Vec<f32> {
    let card = Card::new(gpu, &corrected().spec).expect("compiles");
    let seen = GpuGBuffer::upload(&gpu.device, gbuffer, &card.reads(gbuffer)).expect("room");
    let view = EstimateInputs { gbuffer, radius, seed: SEED, scene: None }.view();
    let estimates = card.estimates(&seen, &view).expect("compiles");
    let estimate = estimates[0].as_ref().expect("the g-buffer lacks it");
    gpu::submit(&gpu.device, &gpu.queue, "estimate", |encoder| estimate.encode(encoder, None)).expect("runs");
    let read = |buffer: &wgpu::Buffer| gpu::read::<f32>(&gpu.device, &gpu.queue, buffer).expect("read");
    estimate.images().map(read).collect::<Vec<_>>().concat()
}

/// The largest difference of two images, over 1 and the number.
fn difference(expected: &Planes, made: &Planes) -> f32 {
    let both = expected.data().iter().zip(made.data());
    both.map(|(a, b)| (a - b).abs() / (1.0 + a.abs())).fold(0.0, f32::max)
}

#[test]
fn passes_and_processor_estimate_the_same() {
    let gpu = Gpu::new().expect("an adapter");
    let gbuffer = stairs();
    let passes = estimated_by_card(&gpu, &gbuffer, 0.5);
    let estimator = Estimator::named(Effect::Ao, "gtao", "low").expect("known");
    let inputs = EstimateInputs { gbuffer: &gbuffer, radius: 0.5, seed: SEED, scene: None };
    let vectors = estimator.on_processor(&inputs).expect("runs");
    assert_eq!(passes.len(), 2 * SIZE[0] * SIZE[1]);
    let far = passes.iter().zip(&vectors).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
    assert!(far * 50 < passes.len(), "{far} of {} numbers", passes.len());
    let (image, raw) = passes.split_at(SIZE[0] * SIZE[1]);
    assert!(image.iter().zip(raw).any(|(image, raw)| (image - raw).abs() > 0.02), "one is blurred");
}

#[test]
fn surfels_are_corrected_of_a_scene_or_of_a_layer_that_has_it() {
    let gpu = Gpu::new().expect("an adapter");
    let room: SceneSource = "room:7".parse().expect("a family");
    let scene = TracedScene::new(room.scene(0.0).expect("a scene")).expect("a scene");
    let bounds = scene.scene().bounds();
    let camera = Camera::look_at(bounds.centre() + 0.3 * bounds.size(), bounds.centre());
    let gbuffer = gbuffer::render(&scene, &camera, SIZE[0], SIZE[1], &Attribute::ALL);
    let radius = 0.2 * bounds.diagonal();
    let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: 0 };
    let openness = AnalyticEstimate::new("gtao", "low").of(Effect::Ao);
    let estimates = [AnalyticEstimate::new("surfel", "low"), openness];
    let spec = NetSpec::corrected(Effect::Gi, 8, estimates.to_vec(), REACH).expect("it has one");
    let mut model = random(spec);
    // It leaves the estimate as it is.
    let last = model.weights.0.last_mut().expect("a layer");
    last.weight.fill(0.0);
    last.bias.fill(0.0);
    let processor = Learned::on_processor(&model).expect("prepared");
    let by_processor = processor.shade(&frame, Repeats::ONCE).expect("shades").image;
    let by_card = Learned::on_adapter(&gpu, &model).expect("compiles").shade(&frame, Repeats::ONCE);
    let by_card = by_card.expect("shades").image;
    let mean = |image: &Planes| image.data().iter().sum::<f32>() / image.data().len() as f32;
    let (a, b) = (mean(&by_processor), mean(&by_card));
    assert!(a > 1e-4 && (a / b - 1.0).abs() < 0.05, "{a} on the processor, {b} on the card");
    let refused = processor.image(&gbuffer, radius, Repeats::ONCE).expect_err("nobody knows the scene");
    assert!(refused.to_string().contains("`estimate`"), "{refused}");
    let with = gbuffer.with(&[Attribute::Estimate], by_processor.data());
    let of_layer = processor.image(&with, radius, Repeats::ONCE).expect("it has the layer").image;
    assert!(difference(&by_processor, &of_layer) < 1e-5);
}

#[test]
fn an_estimate_is_corrected_in_one_encoder_as_on_the_processor() {
    let gpu = Gpu::new().expect("an adapter");
    let (gbuffer, model) = (stairs(), corrected());
    let learned = Learned::on_adapter(&gpu, &model).expect("compiles");
    let shaded = learned.image(&gbuffer, 0.5, Repeats::ONCE).expect("runs");
    // Of the same estimates, of which a few pixels are not the same to the last bit on every device.
    let estimates = [Attribute::Openness, Attribute::RawOpenness];
    let with = gbuffer.with(&estimates, &estimated_by_card(&gpu, &gbuffer, 0.5));
    let engine = Engine::new(None, &model).expect("prepared");
    let by_processor = |radius: f32| {
        let spec = &model.spec;
        let prepared = spec.prepared(&with, radius).expect("positions are there");
        let scaling = spec.scaling(&prepared, radius).expect("everything is there");
        let input = spec.input(&prepared, scaling, 0).expect("everything is there");
        let mut image = spec.image(&[engine.run(&input, 0, 1).expect("runs").0], scaling);
        spec.set_background(&gbuffer, &mut image).expect("has a mask");
        image
    };
    let off = difference(&by_processor(0.5), &shaded.image);
    assert!(off < 2e-3, "{off}");
    assert!(difference(&by_processor(2.0), &shaded.image) > 1e-2, "another radius makes another image");
    assert!(shaded.milliseconds > 0.0 && shaded.device == gpu.info.name);
}

#[test]
fn a_filter_of_light_is_estimated_and_exposed_on_the_card_as_on_the_processor() {
    let gpu = Gpu::new().expect("an adapter");
    let playground: SceneSource = "playground:3".parse().expect("a family");
    let scene = TracedScene::new(playground.scene(0.0).expect("a scene")).expect("a scene");
    let bounds = scene.scene().bounds();
    let lens = Lens::new(0.02 * bounds.diagonal(), 0.4 * bounds.diagonal()).expect("a lens");
    let camera = Camera::look_at(bounds.centre() + 0.4 * bounds.size(), bounds.centre());
    let camera = Camera { lens: Some(lens), ..camera };
    let gbuffer = gbuffer::render(&scene, &camera, SIZE[0], SIZE[1], &Attribute::ALL);
    let filters = [
        (Effect::Dof, "ring-gather"),
        (Effect::MotionBlur, "reconstruction"),
        (Effect::Sss, "separable"),
        (Effect::Multi, "occluded-gather"),
        (Effect::Aa, "fxaa"),
    ];
    for (effect, method) in filters {
        let estimate = AnalyticEstimate::new(method, "medium");
        let model = random(NetSpec::corrected(effect, 8, vec![estimate], REACH).expect("it has one"));
        let card = Learned::on_adapter(&gpu, &model).expect("compiles");
        let processor = Learned::on_processor(&model).expect("prepared");
        let image = |learned: &Learned, gbuffer: &GBuffer| {
            learned.image(gbuffer, 0.5, Repeats::ONCE).expect("runs").image
        };
        let by_card = image(&card, &gbuffer);
        let off = far_apart(&image(&processor, &gbuffer), &by_card);
        assert!(off * 100 < by_card.data().len(), "{method}: {off} of {} values", by_card.data().len());
        assert!(by_card.data().iter().any(|value| *value > 0.01), "{method}: black proves nothing");
        // What a g-buffer has is not estimated anew.
        let with = gbuffer.with(&[Attribute::Estimate], by_card.map(|value| 2.0 * value).data());
        let of_layer = image(&card, &with);
        let off = far_apart(&image(&processor, &with), &of_layer);
        assert!(off * 100 < by_card.data().len(), "{method}: {off} of {} values", by_card.data().len());
        assert!(far_apart(&by_card, &of_layer) * 10 > by_card.data().len(), "{method}: another estimate");
    }
}

/// How many values of two images differ by more than a hundredth.
fn far_apart(a: &Planes, b: &Planes) -> usize {
    let both = a.data().iter().zip(b.data());
    both.filter(|(a, b)| (*a - *b).abs() > 1e-2 * (1.0 + a.abs())).count()
}

#[test]
fn runs_of_a_mono_network_make_their_colours_in_one_encoder() {
    let gpu = Gpu::new().expect("an adapter");
    let spec = NetSpec::published(Effect::Gi, ChannelOrder::Interleaved, REACH).expect("it has one");
    let (gbuffer, model) = (stairs(), random(spec));
    let image = |learned: &Learned| learned.image(&gbuffer, 0.5, Repeats::ONCE).expect("runs").image;
    let by_card = image(&Learned::on_adapter(&gpu, &model).expect("compiles"));
    let by_processor = image(&Learned::on_processor(&model).expect("prepared"));
    let off = difference(&by_processor, &by_card);
    assert!(off < 2e-3, "{off}");
    let [red, green] = [0, 1].map(|channel| by_card.plane(channel));
    assert!(red.iter().zip(green).any(|(red, green)| (red - green).abs() > 1e-2), "colours differ");
}

#[test]
fn what_a_g_buffer_lacks_is_named() {
    let gpu = Gpu::new().expect("an adapter");
    let blind = GBuffer::new(vec![Attribute::Valid], Planes::filled(1, 8, 8, 1.0));
    let learned = Learned::on_adapter(&gpu, &corrected()).expect("compiles");
    let refused = learned.image(&blind, 0.5, Repeats::ONCE).expect_err("no positions");
    assert!(matches!(refused, MethodError::Missing { .. }), "{refused}");
}
