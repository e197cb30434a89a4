//! The component of ambient occlusion in a Bevy app without a window, on any Vulkan adapter; a software one
//! will do.

#[allow(dead_code, reason = "each test uses a part of it")]
mod support;

use bevy::pbr::ScreenSpaceAmbientOcclusion;
use bevy::prelude::{OrthographicProjection, Projection};
use bevy::render::view::Msaa;
use deepshade_bevy::{LearnedAmbientOcclusion, Quality};
use deepshade_infer::Model;
use deepshade_shaders::Planes;
use std::path::{Path, PathBuf};
use support::frame::{Frame, View, differences, scores};
use support::headless::Headless;
use support::own;

const SIZE: [usize; 2] = [97, 131];
/// A part of the image: its left upper corner, its rows and columns.
const CORNER: [u32; 2] = [19, 30];
const PART: [usize; 2] = [64, 104];
const VIEW: View = [[2.4, 1.5, 2.6], [-0.3, 0.6, 0.0]];
const RADIUS: f32 = 0.7;
const WANTED: LearnedAmbientOcclusion = LearnedAmbientOcclusion { quality: Quality::Low, radius: RADIUS };

/// How far openness may be off that deepshade makes of the same g-buffer on the processor. Bevy's texture
/// has half floats. Rounding moves some borders of gtao's sectors, which the network passes on.
const USUAL: f32 = 2e-3;
/// The most that it may be off.
const WORST: f32 = 0.05;
/// The share that may be off by more than what is usual.
const STRAY: f64 = 0.01;

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn is_like(a: &Planes, b: &Planes) -> bool {
    let [largest, stray] = differences(a, b, USUAL);
    largest <= f64::from(WORST) && stray <= STRAY
}

/// One test, as all of it is one app's: a device and its pipelines take long to be had.
#[test]
fn bevys_materials_read_the_networks_openness() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.glb");
    let source = "playground:1".parse().expect("a scene");
    let frame = Frame::new(&source, &file, VIEW, SIZE).expect("a frame");
    let mut bevy = Headless::new(&models(), folder.path(), "scene.glb", &frame.camera, SIZE).expect("an app");
    let plain = bevy.picture().expect("a picture");
    assert!(bevy.openness().expect("read").is_none(), "nobody has asked for occlusion");

    bevy.learned(WANTED);
    assert_eq!(bevy.failures(), [""; 0]);
    let made = bevy.openness().expect("read").expect("the texture is there");
    let gbuffer = bevy.gbuffer::<LearnedAmbientOcclusion>().expect("read");
    let seen = gbuffer.seen().expect("valid");

    // The same g-buffer by deepshade itself, and controls.
    let model = Model::load(&models().join(WANTED.quality.folder())).expect("a network");
    let own_image = own::image(&model, &gbuffer, RADIUS).expect("openness");
    let [largest, stray] = differences(&made, &own_image, USUAL);
    println!("largest difference {largest:.2e}, {:.2} % above {USUAL}", 100.0 * stray);
    assert!(is_like(&made, &own_image), "largest {largest}, stray {stray}");
    let [height, width] = SIZE;
    let moved = Planes::from_fn(1, height, width, |c, y, x| own_image.at(c, y, (x + 1) % width));
    let flipped = Planes::from_fn(1, height, width, |c, y, x| own_image.at(c, height - 1 - y, x));
    let darker = own_image.map(|value| 0.99 * value);
    let farther = own::image(&model, &gbuffer, 1.1 * RADIUS).expect("openness");
    for wrong in [&moved, &flipped, &darker, &farther] {
        assert!(!is_like(&made, wrong), "a control passes");
    }

    // Bevy's g-buffer, of ten bits a normal and drawn by triangles, shows what rays show.
    let by_rays = own::image(&model, &frame.gbuffer(), RADIUS).expect("openness");
    let [similarity, _] = scores(&made, &by_rays, &seen);
    println!("beside deepshade's own g-buffer: SSIM {similarity:.4}");
    assert!(similarity > 0.97, "{similarity}");

    // Materials read it: occluded pixels are darker, by ambient light alone, and others are not.
    let picture = bevy.picture().expect("a picture");
    let [mut dimmed, mut open] = [Vec::new(), Vec::new()];
    for pixel in (0..height * width).filter(|pixel| seen[*pixel] && plain.data()[*pixel] > 0.05) {
        let share = picture.data()[pixel] / plain.data()[pixel];
        match made.data()[pixel] {
            value if value < 0.6 => dimmed.push(share),
            value if value > 0.99 => open.push(share),
            _ => {}
        }
    }
    let mean = |shares: &[f32]| shares.iter().sum::<f32>() / shares.len() as f32;
    assert!(dimmed.len() > 100 && open.len() > 100, "{} {}", dimmed.len(), open.len());
    assert!(mean(&dimmed) < 0.9 && mean(&open) > 0.97, "{} {}", mean(&dimmed), mean(&open));

    // Another radius, from frame to frame.
    bevy.with(LearnedAmbientOcclusion { radius: 0.5 * RADIUS, ..WANTED });
    let near = bevy.openness().expect("read").expect("the texture is there");
    assert!(is_like(&near, &own::image(&model, &gbuffer, 0.5 * RADIUS).expect("openness")));
    assert!(!is_like(&near, &made));

    // Through a part of the image, which has another size.
    bevy.with(WANTED);
    bevy.look_through(CORNER, PART);
    let part = bevy.openness().expect("read").expect("the texture is there");
    assert_eq!([part.height(), part.width()], PART);
    let seen_through = bevy.gbuffer::<LearnedAmbientOcclusion>().expect("read");
    assert!(is_like(&part, &own::image(&model, &seen_through, RADIUS).expect("openness")));
    let by_rays = Frame { size: PART, ..frame }.gbuffer();
    let by_rays = own::image(&model, &by_rays, RADIUS).expect("openness");
    let [similarity, _] = scores(&part, &by_rays, &seen_through.seen().expect("valid"));
    assert!(similarity > 0.97, "through a part: {similarity}");
    bevy.look_through([0, 0], SIZE);

    // Bevy's own takes over where ours goes, and the other way round; with both, ours stays.
    bevy.bevys(ScreenSpaceAmbientOcclusion::default());
    let bevys = bevy.openness().expect("read").expect("the texture is there");
    assert!(!is_like(&bevys, &made), "Bevy's own passes did not run");
    bevy.with(WANTED);
    let both = bevy.openness().expect("read").expect("the texture is there");
    assert!(is_like(&both, &own_image), "Bevy's own passes wrote over ours");
    bevy.without::<ScreenSpaceAmbientOcclusion>();
    bevy.without::<LearnedAmbientOcclusion>();
    assert!(bevy.openness().expect("read").is_none());
    assert_eq!(bevy.picture().expect("a picture"), plain);

    // What is wrong is said, and nothing is occluded then.
    let mut refused = |wanted: LearnedAmbientOcclusion, text: &str| {
        bevy.with(wanted);
        let failures = bevy.failures();
        assert!(matches!(&failures[..], [only] if only.contains(text)), "{failures:?}");
        assert!(bevy.openness().expect("read").is_none());
        assert_eq!(bevy.picture().expect("a picture"), plain);
    };
    refused(LearnedAmbientOcclusion { radius: -1.0, ..WANTED }, "a radius of -1");
    refused(LearnedAmbientOcclusion { radius: f32::NAN, ..WANTED }, "a radius of NaN");
    bevy.with((WANTED, Msaa::Sample4));
    assert!(bevy.failures().iter().any(|failure| failure.contains("Msaa::Off")), "{:?}", bevy.failures());
    let perspective = bevy.projection().expect("the camera's");
    bevy.with((Msaa::Off, Projection::Orthographic(OrthographicProjection::default_3d())));
    assert!(bevy.failures().iter().any(|failure| failure.contains("perspective")), "{:?}", bevy.failures());
    bevy.with(perspective);
    assert_eq!(bevy.failures(), [""; 0]);
    let again = bevy.openness().expect("read").expect("the texture is there");
    assert!(is_like(&again, &own_image));
}

#[test]
fn a_network_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.glb");
    let source = "playground:1".parse().expect("a scene");
    let frame = Frame::new(&source, &file, VIEW, [24, 32]).expect("a frame");
    let nowhere = folder.path().join("models");
    let mut bevy =
        Headless::new(&nowhere, folder.path(), "scene.glb", &frame.camera, [24, 32]).expect("an app");
    bevy.with(WANTED);
    let failures = bevy.failures();
    assert!(failures.iter().any(|failure| failure.contains("ao-small")), "{failures:?}");
    assert!(bevy.openness().expect("read").is_none());
}
