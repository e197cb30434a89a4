//! Reprojection against closed forms, and the GPU against the reference.

use super::reference::{Two, flicker, mixed, since};
use super::*;
use crate::methods::proving::{Tolerance, agree, prove_comparator};
use crate::scene::Camera;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{Planes, random};
use glam::{Vec2, Vec3};

const HEIGHT: usize = 37;
const WIDTH: usize = 53;

/// Everything moves alike, at one depth.
fn moving(x: f32, y: f32) -> Planes {
    Planes::from_fn(4, HEIGHT, WIDTH, |c, _, _| [x, y, 4.0, 4.0][c])
}

fn noise(seed: u32) -> Planes {
    Planes::from_fn(1, HEIGHT, WIDTH, |_, y, x| random::random(x as u32, y as u32, seed, 0))
}

fn variance(image: &Planes) -> f64 {
    let values: Vec<f64> = image.data().iter().map(|value| f64::from(*value)).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64
}

#[test]
fn noise_averages_out_as_its_share_says() {
    let still = moving(0.0, 0.0);
    let two = Two { since_before: &still, since_before_that: &still };
    let parameters = ReprojectionParameters { share: 0.2, clip: 1e9, ..ReprojectionParameters::default() };
    let mut image = noise(0);
    let (mut calm, mut restless) = (0.0, 0.0);
    for frame in 1..60 {
        let next = mixed(two, &noise(frame), &image, &parameters.uniform(HEIGHT, WIDTH, false));
        calm = flicker(two, &next, &image, 0.05);
        restless = flicker(two, &noise(frame), &noise(frame - 1), 0.05);
        image = next;
    }
    let ratio = variance(&image) / variance(&noise(99));
    assert!((ratio - 0.2 / 1.8).abs() < 0.015, "{ratio}");
    // Two uniform numbers differ by a third in the mean.
    assert!((restless - 1.0 / 3.0).abs() < 0.01 && calm < 0.25 * restless, "{calm}, {restless}");
}

#[test]
fn what_moves_takes_its_history_along() {
    let pattern = |shift: usize| {
        Planes::from_fn(1, HEIGHT, WIDTH, |_, y, x| ((x + 100 - shift) * 7 + y * 3) as f32 % 11.0)
    };
    let ways = moving(3.0, 0.0);
    let two = Two { since_before: &ways, since_before_that: &ways };
    let mixing = ReprojectionParameters { clip: 1e9, ..ReprojectionParameters::default() }
        .uniform(HEIGHT, WIDTH, false);
    let image = mixed(two, &pattern(3), &pattern(0), &mixing);
    let off = |image: &Planes| -> f32 {
        let differences = image.data().iter().zip(pattern(3).data().to_vec()).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f32::max)
    };
    assert!(off(&image) < 1e-5, "{}", off(&image));
    assert!(flicker(two, &pattern(3), &pattern(0), 0.05) < 1e-6);
    let wrong = Two { since_before: &moving(-3.0, 0.0), ..two };
    assert!(off(&mixed(wrong, &pattern(3), &pattern(0), &mixing)) > 1.0, "the way back is noticed");
    let upwards = Two { since_before: &moving(0.0, 3.0), ..two };
    assert!(off(&mixed(upwards, &pattern(3), &pattern(0), &mixing)) > 1.0, "another direction is noticed");
}

#[test]
fn what_comes_nearer_keeps_its_history() {
    let far = Planes::from_fn(4, HEIGHT, WIDTH, |c, _, _| [0.0, 0.0, 8.0, 8.0][c]);
    let near = |then: f32| Planes::from_fn(4, HEIGHT, WIDTH, move |c, _, _| [0.0, 0.0, 6.0, then][c]);
    let (dark, bright) = (
        Planes::filled(1, HEIGHT, WIDTH, 0.0),
        Planes::from_fn(1, HEIGHT, WIDTH, |_, _, x| 1.0 - 1e-4 * (x % 2) as f32),
    );
    let mixing = ReprojectionParameters { clip: 1e9, ..ReprojectionParameters::default() }
        .uniform(HEIGHT, WIDTH, false);
    for (then, kept) in [(8.0, true), (6.0, false), (0.0, false)] {
        let two = Two { since_before: &near(then), since_before_that: &far };
        let value = mixed(two, &bright, &dark, &mixing).at(0, 9, 9);
        assert!((value - if kept { 0.1 } else { 1.0 }).abs() < 1e-3, "{then} m: {value}");
        assert_eq!(flicker(two, &bright, &dark, 0.05) > 0.5, kept, "{then} m");
    }
}

#[test]
fn other_surfaces_and_cut_off_values_are_not_kept() {
    let still = moving(0.0, 0.0);
    let farther = Planes::from_fn(4, HEIGHT, WIDTH, |c, _, _| [0.0, 0.0, 8.0, 8.0][c]);
    let dark = Planes::filled(1, HEIGHT, WIDTH, 0.0);
    let bright = Planes::from_fn(1, HEIGHT, WIDTH, |_, _, x| 1.0 - 1e-4 * (x % 2) as f32);
    let mixing = ReprojectionParameters { clip: 1e9, ..ReprojectionParameters::default() }
        .uniform(HEIGHT, WIDTH, false);
    let kept = mixed(Two { since_before: &still, since_before_that: &still }, &bright, &dark, &mixing);
    assert!((kept.at(0, 9, 9) - 0.1).abs() < 1e-4);
    let uncovered = Two { since_before: &still, since_before_that: &farther };
    assert_eq!(mixed(uncovered, &bright, &dark, &mixing), bright);
    let sky = Planes::filled(4, HEIGHT, WIDTH, 0.0);
    assert_eq!(mixed(Two { since_before: &sky, since_before_that: &sky }, &bright, &dark, &mixing), bright);
    // Where all around is bright, darkness is cut off.
    let strict = ReprojectionParameters::default().uniform(HEIGHT, WIDTH, false);
    let two = Two { since_before: &still, since_before_that: &still };
    assert!((mixed(two, &bright, &dark, &strict).at(0, 9, 9) - 1.0).abs() < 1e-3);
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    const TOLERANCE: Tolerance = Tolerance { usual: 1e-5, worst: 1e-3 };
    let gpu = Gpu::new().expect("an adapter");
    let (device, queue) = (&gpu.device, &gpu.queue);
    let image = |seed: u32| {
        Planes::from_fn(3, HEIGHT, WIDTH, |c, y, x| {
            (x as f32 * 0.1).sin() + random::random(x as u32, y as u32, seed, c as u32)
        })
    };
    let ways = |seed: u32| {
        Planes::from_fn(4, HEIGHT, WIDTH, |c, y, x| match c {
            0 | 1 => 6.0 * random::random(x as u32 / 8, y as u32 / 8, seed, c as u32) - 3.0,
            _ if x < 5 => 0.0,
            _ => 4.0 + 0.4 * random::random(x as u32 / 8, y as u32 / 8, 7, 2),
        })
    };
    let current = gpu::storage(device, "test", image(0).data()).expect("room");
    let parameters = ReprojectionParameters::default();
    let since = gpu::storage(device, "test", ways(0).data()).expect("room");
    let mut reprojection =
        Reprojection::new(device, [HEIGHT, WIDTH], &since, &current, 3, parameters).expect("valid passes");
    let mut wanted = Planes::filled(3, HEIGHT, WIDTH, 0.0);
    for frame in 0..4 {
        queue.write_buffer(&current, 0, bytemuck::cast_slice(image(frame).data()));
        queue.write_buffer(&since, 0, bytemuck::cast_slice(ways(frame).data()));
        gpu::submit(device, queue, "test", |encoder| reprojection.encode(queue, encoder, None))
            .expect("valid passes");
        let before = if frame == 0 { moving(0.0, 0.0) } else { ways(frame - 1) };
        let two = Two { since_before: &ways(frame), since_before_that: &before };
        wanted = mixed(two, &image(frame), &wanted, &parameters.uniform(HEIGHT, WIDTH, frame == 0));
        let found = gpu::read(device, queue, reprojection.output()).expect("an image");
        let found = Planes::from_data(3, HEIGHT, WIDTH, found);
        assert_eq!(agree(&found, &wanted, TOLERANCE), Ok(()), "frame {frame}");
    }
    prove_comparator(&wanted, TOLERANCE);
}

#[test]
fn cameras_and_what_has_gone_tell_what_moved() {
    // A wall 5 m before a camera that went half a metre to the right, and came a metre nearer.
    let before = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z);
    let camera = Camera { position: Vec3::new(0.5, 0.0, -1.0), ..before };
    let focal = before.focal_length(HEIGHT);
    let place = |y: usize, x: usize| {
        let middle = Vec2::new(x as f32 + 0.5 - 0.5 * WIDTH as f32, 0.5 * HEIGHT as f32 - y as f32 - 0.5);
        (middle * 5.0 / focal).extend(-5.0)
    };
    let positions = Planes::from_fn(3, HEIGHT, WIDTH, |c, y, x| place(y, x)[c]);
    let mut seen = vec![true; HEIGHT * WIDTH];
    seen[0] = false;
    // A pixel further right shows what has itself gone to the right.
    let mut gone = vec![Vec3::ZERO; HEIGHT * WIDTH];
    gone[10 * WIDTH + 21] = Vec3::new(0.3, 0.0, 0.0);
    let since = since(&positions, &seen, &gone, &camera, &before);
    let went = since.at(0, 10, 21) - since.at(0, 10, 20);
    // Pixels were 5/6 as far apart, from a metre further away.
    assert!((went - (1.0 - 5.0 / 6.0 + 0.3 * focal / 6.0)).abs() < 1e-3, "{went}");
    assert_eq!([0, 1, 2, 3].map(|channel| since.at(channel, 0, 0)), [0.0; 4], "nothing is seen there");
    let now = place(10, 20).truncate() * focal / 5.0;
    let then = (place(10, 20).truncate() + Vec2::new(0.5, 0.0)) * focal / 6.0;
    let expected = [now.x - then.x, now.y - then.y, 5.0, 6.0];
    for (channel, expected) in expected.into_iter().enumerate() {
        assert!(
            (since.at(channel, 10, 20) - expected).abs() < 1e-3,
            "{channel}: {}",
            since.at(channel, 10, 20)
        );
    }
}
