//! What a frame is given, and what is recorded with it.

use super::*;
use crate::methods;
use deepshade_infer::{AnalyticEstimate, ChannelOrder, Model, NetSpec, Reach, Weights};
use deepshade_render::methods::Quality;
use deepshade_render::scene::SceneSource;
use glam::Vec3;

/// Shadow maps of a frame that a method alone looks at, which does not ask for direct light.
fn shadow_maps(effect: Effect, method: &str) -> usize {
    let gpu = Gpu::new().expect("an adapter");
    let source: SceneSource = "room:1".parse().expect("a scene");
    let animated = AnimatedScene::load(&source, 0.0).expect("a scene");
    let method = methods::open_screen(effect, method, &gpu, Quality::Low).expect("a method");
    let wanted = LiveSettings {
        size: [16, 24],
        methods: vec![method],
        learned: None,
        attributes: vec![Attribute::Valid],
        temporal: false,
        radius: 1.0,
        shutter: 0.0,
    };
    let camera = Camera::look_at(Vec3::new(1.0, 1.5, 1.0), Vec3::new(0.0, 1.0, 0.0));
    Live::new(&gpu, &animated, &camera, wanted).expect("a frame").frame.world().maps_to_draw()
}

#[test]
fn lamps_cast_shadows_for_whoever_asks_for_their_light() {
    assert!(shadow_maps(Effect::Phosphor, "glassner") > 0);
    assert!(shadow_maps(Effect::Gi, "surfel") > 0);
    assert_eq!(shadow_maps(Effect::Ao, "gtao"), 0);
}

const REACH: Reach = Reach { radius: 0.5, diagonal_share: 0.05, height: 64 };

/// The largest difference between what a network makes in a frame's passes and what it makes of the frame's
/// g-buffer by itself, and the share of pixels where it is above 2e-3.
fn recorded_against_alone(spec: NetSpec) -> (f32, f32) {
    let gpu = Gpu::new().expect("an adapter");
    let model = Model { weights: Weights::random(&spec, 3), spec };
    let source: SceneSource = "room:1".parse().expect("a scene");
    let animated = AnimatedScene::load(&source, 0.0).expect("a scene");
    let wanted = LiveSettings {
        size: [32, 48],
        methods: Vec::new(),
        learned: Some(Learned::on_adapter(&gpu, &model).expect("compiles")),
        attributes: vec![Attribute::Valid],
        temporal: false,
        radius: 0.5,
        shutter: 0.0,
    };
    let [first, second] = [[1.0, 1.5, 1.0], [-1.0, 1.2, 0.8]].map(|from| Camera {
        vertical_fov: 0.5 + 0.2 * from[1],
        ..Camera::look_at(Vec3::from(from), Vec3::new(0.0, 1.0, 0.0))
    });
    let mut live = Live::new(&gpu, &animated, &first, wanted).expect("a frame");
    assert!(live.shading[0].is_recorded());
    live.make(0.0, 0, &first).expect("runs");
    live.make(0.0, 1, &second).expect("runs");
    let gbuffer = gpu::wait(live.gbuffer_async(model.spec.effect.attributes())).expect("no page");
    let gbuffer = gbuffer.expect("read");
    let alone = Learned::on_adapter(&gpu, &model).expect("compiles");
    let alone = alone.image(&gbuffer, 0.5, Repeats::ONCE).expect("runs").image;
    let made = live.image(0).expect("read");
    let apart: Vec<f32> = alone.data().iter().zip(made.data()).map(|(a, b)| (a - b).abs()).collect();
    let far = apart.iter().filter(|apart| **apart > 2e-3).count();
    (apart.iter().copied().fold(0.0, f32::max), far as f32 / apart.len() as f32)
}

#[test]
fn a_network_recorded_with_a_frame_makes_what_it_makes_of_the_g_buffer() {
    let (largest, _) = recorded_against_alone(NetSpec::ao(ChannelOrder::Interleaved, REACH));
    assert!(largest < 2e-3, "{largest}");
    let estimate = AnalyticEstimate::new("gtao", "low");
    let corrected = NetSpec::corrected(Effect::Ao, 8, vec![estimate], REACH).expect("it has one");
    let (_, share) = recorded_against_alone(corrected);
    assert!(share < 0.02, "{share} of the pixels");
}

#[test]
fn a_network_that_corrects_surfels_reads_those_of_the_live_scene() {
    let gpu = Gpu::new().expect("an adapter");
    let openness = AnalyticEstimate::new("gtao", "low").of(Effect::Ao);
    let estimates = [AnalyticEstimate::new("surfel", "low"), openness];
    let spec = NetSpec::corrected(Effect::Gi, 8, estimates.to_vec(), REACH).expect("it has one");
    let mut model = Model { weights: Weights::random(&spec, 3), spec };
    // It leaves the estimate as it is.
    let last = model.weights.0.last_mut().expect("a layer");
    last.weight.fill(0.0);
    last.bias.fill(0.0);
    let source: SceneSource = "room:1".parse().expect("a scene");
    let animated = AnimatedScene::load(&source, 0.0).expect("a scene");
    let wanted = LiveSettings {
        size: [32, 48],
        methods: vec![methods::open_screen(Effect::Gi, "surfel", &gpu, Quality::Low).expect("a method")],
        learned: Some(Learned::on_adapter(&gpu, &model).expect("compiles")),
        attributes: vec![Attribute::Valid],
        temporal: false,
        radius: 2.0,
        shutter: 0.0,
    };
    let camera = Camera::look_at(Vec3::new(1.0, 1.5, 1.0), Vec3::new(0.0, 1.0, 0.0));
    let mut live = Live::new(&gpu, &animated, &camera, wanted).expect("a frame");
    live.make(0.0, learned::SEED, &camera).expect("runs");
    let [surfel, learned] = [0, 1].map(|method| live.image(method).expect("read"));
    let mean = surfel.data().iter().sum::<f32>() / surfel.data().len() as f32;
    assert!(mean > 1e-4, "light that the room's surfaces send: {mean}");
    let apart = surfel.data().iter().zip(learned.data()).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f32::max) < 1e-2 * mean, "the network's estimate is the frame's own");
}

#[test]
fn a_network_that_reads_light_is_not_recorded() {
    let gpu = Gpu::new().expect("an adapter");
    let spec = NetSpec::published(Effect::Aa, ChannelOrder::Interleaved, REACH).expect("it has one");
    let model = Model { weights: Weights::random(&spec, 3), spec };
    let learned = Learned::on_adapter(&gpu, &model).expect("compiles");
    let attributes = [Attribute::Depth, Attribute::Light, Attribute::Valid];
    let gbuffer = GpuGBuffer::empty(&gpu.device, 16, 16, &attributes).expect("room");
    let image = gpu::empty::<f32>(&gpu.device, "image", 3 * 16 * 16).expect("room");
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z);
    let view = View { height: 16, width: 16, camera, radius: 0.5, seed: 0 };
    assert!(learned.record(&gbuffer, &view, &image).expect("nothing to refuse").is_none());
}
