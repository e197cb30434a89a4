//! Light that surfaces keep goes with them: a plate that rises, walks aside and bends, in frames on the GPU,
//! against the rate equation at its texels in the file at each moment.

use crate::build::{Builder, write};
use deepshade_glow::paint::{LightInterval, MOST_STATES, Paint, PaintState};
use deepshade_render::bvh::TracedScene;
use deepshade_render::gbuffer;
use deepshade_render::method::{self, Method};
use deepshade_render::methods::phosphor::RateEquationParameters;
use deepshade_render::methods::phosphor::tile::{Tiles, texel_weights, texels_around};
use deepshade_render::past;
use deepshade_render::path::phosphor::{Afterglow, ReceivingPoint};
use deepshade_render::path::{self, Sampling, Shot};
use deepshade_render::raster::{Frame, frame::FrameStage, frame::RasterSettings};
use deepshade_render::scene::glow::{Glow, GlowSurface, Schedule, Start};
use deepshade_render::scene::{AnimatedScene, Camera, Light, Scene, SceneSource};
use deepshade_render::screen::{Inputs, MethodPasses, ScreenMethod, View};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::{Attribute, Effect};
use glam::{Vec2, Vec3};
use std::path::Path;
use std::sync::Arc;

const SIZE: usize = 48;
const TEXELS: RateEquationParameters = RateEquationParameters::exact(120);
/// Frames a second; the sequence lasts one.
const FPS: u16 = 8;

/// A floor, and a plate above it of which two corners fold up while it moves; both under one lamp.
fn stage() -> String {
    let mut builder = Builder::default();
    let square = |half: f32| [-half, 0.0, half, half, 0.0, half, half, 0.0, -half, -half, 0.0, -half];
    let floor = builder.floats("VEC3", &square(2.0));
    let plate = builder.floats("VEC3", &square(0.7));
    let folds = builder.floats("VEC3", &[0.0, 0.0, 0.0, -0.3, 0.8, 0.0, -0.3, 0.8, 0.0, 0.0, 0.0, 0.0]);
    let indices = builder.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
    let times = builder.floats("SCALAR", &[0.0, 1.0]);
    let walks = builder.floats("VEC3", &[-1.5, 0.3, 0.0, 1.2, 1.0, 0.2]);
    let weights = builder.floats("SCALAR", &[0.0, 1.0]);
    builder.gltf(&format!(
        r#""extensionsUsed":["KHR_lights_punctual"],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"point","intensity":3000}}]}}}},
        "nodes":[{{"mesh":0}},{{"mesh":1}},{{"translation":[-1.4,3,0.3],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{floor}}},"indices":{indices},"material":0}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":{plate}}},"indices":{indices},"material":0,
                "targets":[{{"POSITION":{folds}}}]}}]}}],
        "materials":[{{"name":"paint"}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":1,"path":"translation"}}}},
            {{"sampler":1,"target":{{"node":1,"path":"weights"}}}}],
        "samplers":[{{"input":{times},"output":{walks}}},{{"input":{times},"output":{weights}}}]}}]"#
    ))
}

fn glow() -> Glow {
    let state = PaintState { decay: 0.4, excitation: Vec3::splat(0.05), emission: Vec3::new(1.0, 0.8, 0.2) };
    Glow {
        surfaces: vec![GlowSurface::new(None, Paint { name: "test".to_owned(), states: vec![state] })],
        medium: None,
        schedules: vec![Schedule { on: vec![[0.0, 0.6]], ..Schedule::default() }],
        start: Start::Share(0.0),
        moment: 0.0,
    }
}

fn camera() -> Camera {
    Camera::look_at(Vec3::new(0.4, 3.2, 4.0), Vec3::new(0.0, 0.2, 0.0))
}

/// The file at a moment.
fn posed(path: &Path, time: f32) -> TracedScene {
    let mut scene = Scene::load(path, time).expect("the file");
    scene.glow = Some(Arc::new(glow()));
    TracedScene::new(scene).expect("a scene")
}

/// The share of each texel after all frames: of each the time since the one before, lit as the scene is then.
fn expected(path: &Path, tiles: &Tiles) -> Vec<f32> {
    let mut shares = vec![0.0f32; tiles.texels];
    let glow = glow();
    let paint = &glow.surfaces[0].paint;
    for frame in 1..=FPS {
        let [before, now] = [frame - 1, frame].map(|frame| f32::from(frame) / f32::from(FPS));
        let scene = posed(path, now);
        let afterglow = Afterglow::new(&scene);
        let pieces = glow.between(before, now);
        for (tile, [mesh, triangle]) in tiles.tiles.iter().zip(&tiles.origins) {
            let mesh = &scene.scene().meshes[*mesh as usize];
            for (texel, weights) in texel_weights(tile.divisions).enumerate() {
                let received =
                    afterglow.irradiance(&ReceivingPoint::new(mesh, *triangle as usize, weights))[0];
                let lit = |on: bool| if on { received } else { Vec3::ZERO };
                let past = pieces
                    .iter()
                    .map(|piece| LightInterval { seconds: piece.seconds, irradiance: lit(piece.on[0]) });
                let share = &mut shares[tile.first as usize + texel];
                *share = paint.after(*share, past)[0];
            }
        }
    }
    shares
}

/// The share of values that differ by more than a fiftieth of the largest.
fn off(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().copied().fold(0.0, f32::max);
    let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 0.02 * largest;
    // What is no number is near nothing.
    1.0 - a.iter().zip(b).filter(|pair| near(*pair)).count() as f32 / b.len() as f32
}

#[test]
fn kept_light_moves_and_bends_with_its_surface() {
    let gpu = Gpu::new().expect("an adapter");
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), "stage.gltf", stage());
    let path = folder.path().join("stage.gltf");
    let mut animated = AnimatedScene::load(&SceneSource::File(path.clone()), 0.0).expect("a file");
    animated.scene.glow = Some(Arc::new(glow()));

    let method = ScreenMethod::new(&gpu, TEXELS);
    let mut attributes = vec![Attribute::Light, Attribute::DiffuseLight];
    attributes.extend(method.attributes());
    let settings = RasterSettings { height: SIZE, width: SIZE, attributes, shadow_size: Some(2048) };
    let mut frame = Frame::new(&gpu, &animated, &settings).expect("a frame");
    let view = View { height: SIZE, width: SIZE, camera: camera(), radius: 1.0, seed: 0 };
    let inputs = Inputs { gbuffer: frame.gbuffer(), environment: None, world: Some(frame.world()) };
    let passes = MethodPasses::new(&method, &inputs, &view).expect("passes");
    for number in 0..=FPS {
        frame.set(&gpu.queue, f32::from(number) / f32::from(FPS), 0.0, &camera());
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
            FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
            passes.encode(encoder);
        })
        .expect("a frame");
    }
    let step = passes.steps().iter().rev().nth(1).expect("passes");
    let mut states: Vec<f32> = gpu::read(&gpu.device, &gpu.queue, &step.writes[0]).expect("states");
    // What rounding left is behind them.
    states.truncate(states.len() / 2);
    let image: Vec<f32> = gpu::read(&gpu.device, &gpu.queue, passes.output()).expect("an image");

    let tiles = Tiles::new(&animated, &frame.world().geometry.draws, TEXELS.texels);
    let right = expected(&path, &tiles);
    assert!(
        right.iter().any(|share| *share > 0.3) && off(&states, &right) < 0.03,
        "{}",
        off(&states, &right)
    );

    // Where it is seen at the end.
    let last = posed(&path, 1.0);
    let sent = |pixel: usize| {
        let at = Vec2::new((pixel % SIZE) as f32 + 0.5, (pixel / SIZE) as f32 + 0.5);
        let hit = last.hit(camera().position, camera().direction(at, SIZE, SIZE), f32::INFINITY)?;
        let tile = tiles.origins.iter().position(|origin| *origin == [hit.mesh, hit.triangle])?;
        let tile = &tiles.tiles[tile];
        let around = texels_around(tile.divisions, hit.barycentric);
        let share = around.iter().map(|(texel, weight)| weight * right[tile.first as usize + texel]).sum();
        let mut shares = [0.0; MOST_STATES];
        shares[0] = share;
        Some(glow().surfaces[0].paint.emission(&shares).x)
    };
    let seen: Vec<f32> = (0..SIZE * SIZE).map(|pixel| sent(pixel).unwrap_or(0.0)).collect();
    assert!(off(&image[..SIZE * SIZE], &seen) < 0.03, "{}", off(&image[..SIZE * SIZE], &seen));

    // Somebody who took the last pose for all of the past would be wrong.
    let (ended, glow) = (Afterglow::new(&last), glow());
    let still = |(tile, [mesh, triangle]): (_, &[u32; 2])| {
        let tile: &deepshade_shaders::wgsl::uniforms::GlowTile = tile;
        let mesh = &last.scene().meshes[*mesh as usize];
        let share = |weights| {
            let received = ended.irradiance(&ReceivingPoint::new(mesh, *triangle as usize, weights))[0];
            let lit = |on: bool| if on { received } else { Vec3::ZERO };
            let past = glow.past(1.0);
            let past = past
                .iter()
                .map(|piece| LightInterval { seconds: piece.seconds, irradiance: lit(piece.on[0]) });
            glow.surfaces[0].paint.after(0.0, past)[0]
        };
        texel_weights(tile.divisions).map(share).collect::<Vec<_>>()
    };
    let still: Vec<f32> = tiles.tiles.iter().zip(&tiles.origins).flat_map(still).collect();
    assert!(off(&still, &right) > 0.1, "{}", off(&still, &right));
}

/// A plate above the floor, under the lamp, that has no size until the middle of the first second.
fn growing() -> String {
    let mut builder = Builder::default();
    let square = |half: f32| [-half, 0.0, half, half, 0.0, half, half, 0.0, -half, -half, 0.0, -half];
    let floor = builder.floats("VEC3", &square(2.0));
    let plate = builder.floats("VEC3", &square(0.5));
    let indices = builder.shorts("SCALAR", &[0, 1, 2, 0, 2, 3]);
    let times = builder.floats("SCALAR", &[0.0, 0.5]);
    let sizes = builder.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    builder.gltf(&format!(
        r#""extensionsUsed":["KHR_lights_punctual"],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"point","intensity":3000}}]}}}},
        "nodes":[{{"mesh":0}},{{"mesh":1,"translation":[0,1,0],"scale":[0,0,0]}},
            {{"translation":[0,3,0],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{floor}}},"indices":{indices},"material":0}}]}},
            {{"primitives":[{{"attributes":{{"POSITION":{plate}}},"indices":{indices},"material":0}}]}}],
        "materials":[{{"name":"paint"}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":1,"path":"scale"}}}}],
        "samplers":[{{"input":{times},"output":{sizes},"interpolation":"STEP"}}]}}]"#
    ))
}

/// What has no area for a while keeps its triangles: it has got no light then, and the floor below was not in
/// its shadow.
#[test]
fn kept_light_survives_poses_in_which_triangles_have_no_area() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), "growing.gltf", growing());
    let source = SceneSource::File(folder.path().join("growing.gltf"));
    let mut animated = AnimatedScene::load(&source, 0.0).expect("a file");
    // So faint that nothing is full.
    let intensity = Vec3::splat(20.0);
    animated.scene.lights[0] = Light::Point { position: 3.0 * Vec3::Y, intensity, range: f32::INFINITY };
    let mut kept = Glow { moment: 1.5, ..glow() };
    kept.schedules[0].on = vec![[0.0, 1.0]];
    let (state, moment) = (kept.surfaces[0].paint.states[0], kept.moment);
    let now = Scene { glow: Some(Arc::new(kept)), ..animated.scene.clone() };
    let scene = past::of_animation(&animated, &now).expect("poses of the same triangles");

    // Irradiance on top of the plate and in the middle of the floor, and what each keeps of a time of it.
    let share = |distance: f32, [from, to]: [f32; 2]| {
        let charge = state.excitation.dot(intensity / (distance * distance));
        let total = charge + state.decay;
        charge / total * (1.0 - (-total * (to - from)).exp()) * (-state.decay * (moment - to)).exp()
    };
    let afterglow = Afterglow::new(&scene);
    let middle = |mesh: usize| afterglow.shares(mesh, 0, [0.5, 0.0, 0.5]).expect("paint")[0];
    for (mesh, expected) in [(0, share(3.0, [0.0, 0.5])), (1, share(2.0, [0.5, 1.0]))] {
        let found = middle(mesh);
        // The change falls into one of 48 poses of the second of light.
        assert!((found / expected - 1.0).abs() < 0.05 && expected > 0.05, "{mesh}: {found} {expected}");
    }

    // And so on the GPU, in a still and in frames.
    let gpu = Gpu::new().expect("an adapter");
    let method = ScreenMethod::new(&gpu, TEXELS);
    let camera = Camera::look_at(Vec3::new(0.0, 1.6, 3.0), Vec3::new(0.0, 0.4, 0.0));
    let gbuffer = gbuffer::render(&scene, &camera, SIZE, SIZE, method.attributes());
    let seen = method::Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius: 1.0, seed: 0 };
    let still = method.shade(&seen, method::Repeats::ONCE).expect("an image").image;
    let shot = Shot::new(&scene, &camera, [SIZE, SIZE], 1.0);
    let truth = path::render(Effect::Phosphor, &shot, Sampling::one(1, 1)).mean;
    // Each surface by itself, since the plate is a fiftieth of the image. What of a surface differs by more
    // than a part of the brightest is its rim, or the rim of the plate's shadow.
    let brightest = truth.data().iter().copied().fold(0.0, f32::max);
    let object = gbuffer.select(&[Attribute::ObjectId, Attribute::Valid]).expect("objects");
    let far = |image: &[f32], mesh: f32, part: f32| {
        let plane = SIZE * SIZE;
        let shows = |pixel: usize| object.data()[pixel] == mesh && object.data()[plane + pixel] > 0.5;
        let own: Vec<usize> = (0..image.len()).filter(|index| shows(index % plane)).collect();
        let near = |index: &&usize| (image[**index] - truth.data()[**index]).abs() <= brightest / part;
        1.0 - own.iter().filter(near).count() as f32 / own.len() as f32
    };
    let [floor, plate] = [0.0, 1.0];
    let all = |image: &[f32], part: f32| [far(image, floor, part), far(image, plate, part)];
    // Of four of 48 poses one stands for all: some twentieth of a second of light falls on the wrong side of
    // the change, at most.
    let [of_floor, of_plate] = all(still.data(), 6.0);
    assert!(of_floor < 0.06 && of_plate < 0.2, "{of_floor} {of_plate}");

    let glowing = AnimatedScene { scene: now, rigs: animated.rigs };
    let attributes = method.attributes().to_vec();
    let settings = RasterSettings { height: SIZE, width: SIZE, attributes, shadow_size: Some(1024) };
    let mut frame = Frame::new(&gpu, &glowing, &settings).expect("a frame");
    // Texels of the plate are for its size later: its diagonal of 1.41 m over a 120th of that of the scene,
    // 5.7 m.
    let tiles = Tiles::new(&glowing, &frame.world().geometry.draws, TEXELS.texels);
    let of_plate = tiles.tiles.iter().zip(&tiles.origins).filter(|(_, [mesh, _])| *mesh == 1);
    let divisions: Vec<u32> = of_plate.map(|(tile, _)| tile.divisions).collect();
    assert!(divisions.len() == 2 && divisions.iter().all(|count| (29..=31).contains(count)), "{divisions:?}");
    let view = View { height: SIZE, width: SIZE, camera, radius: 1.0, seed: 0 };
    let inputs = Inputs { gbuffer: frame.gbuffer(), environment: None, world: Some(frame.world()) };
    let passes = MethodPasses::new(&method, &inputs, &view).expect("passes");
    for number in 0..=72u16 {
        frame.set(&gpu.queue, f32::from(number) / 48.0, 0.0, &camera);
        gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
            FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
            passes.encode(encoder);
        })
        .expect("a frame");
    }
    let image: Vec<f32> = gpu::read(&gpu.device, &gpu.queue, passes.output()).expect("an image");
    // Of a frame, a 48th of a second.
    let [of_floor, of_plate] = all(&image, 12.0);
    assert!(of_floor < 0.06 && of_plate < 0.2, "{of_floor} {of_plate}");
}

/// While time stands still, a lamp that is dimmed has been as dim for all of the past, as truth has it; one
/// that is given as it was before changes nothing of what is known of the past.
#[test]
fn kept_light_is_that_of_lamps_as_they_are_given() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(folder.path(), "growing.gltf", growing());
    let source = SceneSource::File(folder.path().join("growing.gltf"));
    let mut animated = AnimatedScene::load(&source, 0.0).expect("a file");
    let intensity = Vec3::splat(20.0);
    let lamp = Light::Point { position: 3.0 * Vec3::Y, intensity, range: f32::INFINITY };
    let dim = lamp.brighter(0.2);
    animated.scene.glow = Some(Arc::new(glow()));
    let gpu = Gpu::new().expect("an adapter");
    let method = ScreenMethod::new(&gpu, TEXELS);
    let camera = Camera::look_at(Vec3::new(0.0, 1.6, 3.0), Vec3::new(0.0, 0.4, 0.0));
    let attributes = method.attributes().to_vec();
    let settings = RasterSettings { height: SIZE, width: SIZE, attributes, shadow_size: Some(1024) };
    let view = View { height: SIZE, width: SIZE, camera, radius: 1.0, seed: 0 };
    // The last of frames, each under a lamp at a moment.
    let last = |frames: &[(Light, f32)]| {
        let mut scene = animated.clone();
        scene.scene.lights[0] = frames[0].0;
        let mut frame = Frame::new(&gpu, &scene, &settings).expect("a frame");
        let inputs = Inputs { gbuffer: frame.gbuffer(), environment: None, world: Some(frame.world()) };
        let passes = MethodPasses::new(&method, &inputs, &view).expect("passes");
        for (lamp, moment) in frames {
            frame.set_lights(&gpu.queue, &[*lamp]);
            frame.set(&gpu.queue, *moment, 0.0, &camera);
            gpu::submit(&gpu.device, &gpu.queue, "test", |encoder| {
                FrameStage::ALL.iter().for_each(|stage| frame.encode(*stage, encoder, None));
                passes.encode(encoder);
            })
            .expect("a frame");
        }
        gpu::read::<f32>(&gpu.device, &gpu.queue, passes.output()).expect("an image")
    };
    let (bright, dimmed) = (last(&[(lamp, 1.0)]), last(&[(dim, 1.0)]));
    assert!(off(&bright, &dimmed) > 0.3, "{}", off(&bright, &dimmed));
    assert_eq!(off(&last(&[(lamp, 1.0), (dim, 1.0)]), &dimmed), 0.0);
    // What is given again is nothing new: of the plate's growth half a second ago the floor still knows.
    let on = last(&[(lamp, 0.0), (lamp, 0.4), (lamp, 1.0)]);
    assert!(off(&on, &bright) > 0.005, "{}", off(&on, &bright));
}
