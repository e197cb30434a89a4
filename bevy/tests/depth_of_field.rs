//! The component of depth of field in a Bevy app without a window, on any Vulkan adapter; a software one will
//! do.

#[allow(dead_code, reason = "each test uses a part of it")]
mod support;

use bevy::camera::Hdr;
use bevy::light::DirectionalLight;
use bevy::math::Vec3;
use bevy::prelude::Transform;
use bevy::render::view::Msaa;
use deepshade_bevy::{LearnedAmbientOcclusion, LearnedDepthOfField};
use deepshade_infer::Model;
use deepshade_shaders::{Attribute, GBuffer, Planes};
use std::path::{Path, PathBuf};
use support::frame::{Frame, View, differences};
use support::headless::Headless;
use support::{lens, own};

const SIZE: [usize; 2] = [97, 131];
/// A part of the image: its left upper corner, its rows and columns.
const CORNER: [usize; 2] = [19, 30];
const PART: [usize; 2] = [64, 104];
const VIEW: View = [[2.4, 1.5, 2.6], [-0.3, 0.6, 0.0]];
const WANTED: LearnedDepthOfField = LearnedDepthOfField { focal_distance: 2.5, aperture_radius: 0.1 };
/// Points of the lens through which truth is seen.
const POINTS: usize = 64;

/// How far exposed light may be off that deepshade makes of the same g-buffer on the processor. Bevy's
/// pictures have half floats.
const USUAL: f32 = 2e-3;
/// The most that it may be off: rounding puts some samples of `ring-gather` on the neighbouring pixel.
const WORST: f32 = 0.1;
/// The share that may be off by more than what is usual.
const STRAY: f64 = 0.01;

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

/// Whether two pictures are alike, exposed as the first one.
fn is_like(a: &Planes, b: &Planes) -> bool {
    let [a, b] = lens::exposed([a, b], a);
    let [largest, stray] = differences(&a, &b, USUAL);
    largest <= f64::from(WORST) && stray <= STRAY
}

fn app(models: &Path, folder: &Path, size: [usize; 2]) -> (Headless, Frame) {
    let source = "playground:1".parse().expect("a scene");
    let frame = Frame::new(&source, &folder.join("scene.glb"), VIEW, size).expect("a frame");
    let bevy = Headless::new(models, folder, "scene.glb", &frame.camera, size).expect("an app");
    (bevy, frame)
}

/// One test, as all of it is one app's: a device and its pipelines take long to be had.
#[test]
fn a_camera_shows_what_the_network_makes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut bevy, frame) = app(&models(), folder.path(), SIZE);
    bevy.add((
        DirectionalLight::default(),
        Transform::default().looking_to(Vec3::new(-1.0, -2.0, -0.5), Vec3::Y),
    ));
    bevy.with(Hdr);
    let plain = bevy.light(false).expect("read");
    let brightest = plain.data().iter().copied().fold(0.0, f32::max);
    assert!(brightest > 1.5, "a picture brighter than a screen: {brightest}");

    bevy.with(WANTED);
    assert_eq!(bevy.failures(), [""; 0]);
    let made = bevy.light(false).expect("read");
    assert!(bevy.light(true).expect("read") == plain, "another frame");

    // The same g-buffer by deepshade itself, and controls.
    let model = Model::load(&models().join("dof")).expect("a network");
    let own = |gbuffer: &GBuffer| own::image(&model, gbuffer, 1.0).expect("an image");
    let gbuffer = lens::gbuffer(&mut bevy, [0, 0]).expect("read");
    let own_image = own(&gbuffer);
    let [here, there] = lens::exposed([&made, &own_image], &made);
    let [largest, stray] = differences(&here, &there, USUAL);
    println!("largest difference {largest:.2e}, {:.2} % above {USUAL}", 100.0 * stray);
    assert!(is_like(&made, &own_image), "largest {largest}, stray {stray}");
    let [height, width] = SIZE;
    let moved = Planes::from_fn(3, height, width, |c, y, x| own_image.at(c, y, (x + 1) % width));
    let flipped = Planes::from_fn(3, height, width, |c, y, x| own_image.at(c, height - 1 - y, x));
    let turned = Planes::from_fn(3, height, width, |c, y, x| own_image.at((c + 1) % 3, y, x));
    let darker = own_image.map(|value| 0.99 * value);
    let blurriness = gbuffer.select(&[Attribute::Blurriness]).expect("it is there");
    let wider = blurriness.map(|value| 1.1 * value);
    let wider = own(&gbuffer.with(&[Attribute::Blurriness], wider.data()));
    for wrong in [&plain, &moved, &flipped, &turned, &darker, &wider] {
        assert!(!is_like(&made, wrong), "a control passes");
    }

    // Exposed light is what the network was shown: 99 % of it is at most 1.
    let shown = bevy.gbuffer::<LearnedDepthOfField>().expect("read");
    let [exposed] = lens::exposed([&plain], &plain);
    let shown = shown.select(&[Attribute::Light]).expect("it is there");
    assert!(differences(&shown, &exposed, 1e-5)[0] < 1e-3, "another exposure");

    // It is what a lens shows, and of this lens.
    bevy.without::<LearnedDepthOfField>();
    assert!(bevy.light(false).expect("read") == plain);
    let truth = lens::truth(&mut bevy, &frame.camera, WANTED, POINTS).expect("truth");
    assert!(bevy.light(false).expect("read") == plain, "the camera is back");
    let score = |image: &Planes| lens::scores(image, &truth)[0];
    println!("SSIM {:.4}, of the picture without a lens {:.4}", score(&made), score(&plain));
    assert!(score(&made) > score(&plain) + 0.03 && score(&made) > 0.9);
    for other in [
        LearnedDepthOfField { focal_distance: 1.5 * WANTED.focal_distance, ..WANTED },
        LearnedDepthOfField { aperture_radius: 2.0 * WANTED.aperture_radius, ..WANTED },
    ] {
        bevy.with(other);
        let of_other = bevy.light(false).expect("read");
        assert!(score(&of_other) < score(&made), "{other:?}: {}", score(&of_other));
    }

    // Without a lens nothing changes. Of one so small that all is in focus the network's image is the
    // program's, too: little softer than the picture.
    bevy.with(LearnedDepthOfField { aperture_radius: 0.0, ..WANTED });
    assert_eq!(bevy.failures(), [""; 0]);
    assert!(bevy.light(false).expect("read") == plain);
    bevy.with(LearnedDepthOfField { aperture_radius: 1e-4, ..WANTED });
    let sharp = bevy.light(false).expect("read");
    assert!(is_like(&sharp, &own(&lens::gbuffer(&mut bevy, [0, 0]).expect("read"))));
    let [similarity, difference] = lens::scores(&sharp, &plain);
    println!("all in focus: SSIM {similarity:.4}, mean difference {difference:.4}");
    assert!(similarity > 0.95 && difference < 0.02, "{similarity} {difference}");

    // Through a part of the image, which has another size; what is around it stays.
    bevy.with(WANTED);
    bevy.look_through(CORNER.map(|edge| edge as u32), PART);
    let whole = bevy.light(false).expect("read");
    let before = bevy.light(true).expect("read");
    let gbuffer = lens::gbuffer(&mut bevy, CORNER).expect("read");
    assert_eq!([gbuffer.height(), gbuffer.width()], PART);
    assert!(is_like(&lens::part(&whole, CORNER, PART), &own(&gbuffer)));
    let is_inside = |y: usize, x: usize| {
        (CORNER[1]..CORNER[1] + PART[0]).contains(&y) && (CORNER[0]..CORNER[0] + PART[1]).contains(&x)
    };
    let around = |image: &Planes| {
        Planes::from_fn(3, height, width, |c, y, x| if is_inside(y, x) { 0.0 } else { image.at(c, y, x) })
    };
    assert!(around(&whole) == around(&before));
    bevy.look_through([0, 0], SIZE);
    assert!(is_like(&bevy.light(false).expect("read"), &own_image));

    // Beside occlusion.
    bevy.with(LearnedAmbientOcclusion { radius: 0.7, ..Default::default() });
    assert_eq!(bevy.failures(), [""; 0]);
    assert!(bevy.openness().expect("read").is_some());
    let gbuffer = lens::gbuffer(&mut bevy, [0, 0]).expect("read");
    let occluded = bevy.light(false).expect("read");
    assert!(is_like(&occluded, &own(&gbuffer)) && !is_like(&occluded, &own_image));
    bevy.without::<LearnedAmbientOcclusion>();

    // What is wrong is said, and nothing is blurred then.
    let mut refused = |wanted: LearnedDepthOfField, text: &str| {
        bevy.with(wanted);
        let failures = bevy.failures();
        assert!(matches!(&failures[..], [only] if only.contains(text)), "{failures:?}");
        assert!(is_like(&bevy.light(false).expect("read"), &plain), "{text}");
    };
    refused(LearnedDepthOfField { focal_distance: 0.0, ..WANTED }, "a focal distance of 0");
    refused(LearnedDepthOfField { aperture_radius: f32::NAN, ..WANTED }, "an aperture radius of NaN");
    bevy.with((WANTED, Msaa::Sample4));
    assert!(bevy.failures().iter().any(|failure| failure.contains("Msaa::Off")), "{:?}", bevy.failures());
    bevy.with(Msaa::Off);
    assert_eq!(bevy.failures(), [""; 0]);
    assert!(is_like(&bevy.light(false).expect("read"), &own_image));
}

#[test]
fn a_network_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut bevy, _) = app(&folder.path().join("models"), folder.path(), [24, 32]);
    bevy.with(WANTED);
    let failures = bevy.failures();
    assert!(failures.iter().any(|failure| failure.contains("dof")), "{failures:?}");
}
