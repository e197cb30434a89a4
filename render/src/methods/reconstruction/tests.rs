//! The reference against closed forms, the GPU against the reference, and both against truth.

use super::*;
use crate::methods::picture::every_pixel;
use crate::methods::proving::{
    Tolerance, everything, lit_still_life, on_gpu, prove_comparator, prove_twin, view,
};
use crate::metrics::relative_mse;
use crate::path::{self, Sampling, Shot};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};
use glam::{IVec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Of radiances up to about 1. Rounding puts a sample on the neighbouring pixel in few pixels.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.2 };

/// Movements of any length that an image holds.
fn unbounded(quality: Quality) -> ReconstructionParameters {
    ReconstructionParameters { longest: 1.0, ..ReconstructionParameters::of(quality) }
}

/// What a pixel of a picture made by hand shows.
#[derive(Clone, Copy)]
struct TestPixel {
    light: Vec3,
    depth: f32,
    /// Direction, from x to the right towards y up, and length in pixels.
    motion: [f32; 2],
}

fn gbuffer_of(height: usize, width: usize, pixel: impl Fn(IVec2) -> Option<TestPixel> + Sync) -> GBuffer {
    let pixels = every_pixel(height, width, |at| {
        pixel(at).map_or([0.0; 7], |TestPixel { light, depth, motion }| {
            [light.x, light.y, light.z, depth, motion[0], motion[1], 1.0]
        })
    });
    let attributes = vec![Attribute::Light, Attribute::Depth, Attribute::Motion, Attribute::Valid];
    GBuffer::new(attributes, Planes::from_fn(7, height, width, |c, y, x| pixels[y * width + x][c]))
}

fn exposed(gbuffer: &GBuffer, parameters: &ReconstructionParameters) -> Planes {
    let settings = parameters.settings(&view(gbuffer.height(), gbuffer.width(), 1.0));
    let written = reference::shade(&reference::Moving::of(gbuffer).expect("all attributes"), &settings);
    let image = written.into_iter().last().expect("an image");
    Planes::from_data(3, gbuffer.height(), gbuffer.width(), image)
}

/// A sheet to the left of the middle, or above it, that moves by 20 pixels across its edge, before nothing
/// and before what stands still.
#[test]
fn a_moving_step_edge_is_a_linear_ramp() {
    const SIZE: usize = 64;
    let sheet = |direction| TestPixel { light: Vec3::ONE, depth: 1.0, motion: [direction, 20.0] };
    let wall = TestPixel { light: Vec3::ZERO, depth: 4.0, motion: [0.0, 0.0] };
    for background in [None, Some(wall)] {
        let across = gbuffer_of(SIZE, SIZE, |at| if at.x < 32 { Some(sheet(0.0)) } else { background });
        let down = gbuffer_of(SIZE, SIZE, |at| if at.y < 32 { Some(sheet(FRAC_PI_2)) } else { background });
        let rows = exposed(&across, &unbounded(Quality::Ultra));
        let columns = exposed(&down, &unbounded(Quality::Ultra));
        let worst = |length: f32| {
            let off = (0..SIZE).map(|i| {
                let ramp = (0.5 - (i as f32 + 0.5 - 32.0) / length).clamp(0.0, 1.0);
                (rows.at(0, 40, i) - ramp).abs().max((columns.at(0, i, 20) - ramp).abs())
            });
            off.fold(0.0, f32::max)
        };
        assert!(worst(20.0) < 0.03, "{}", worst(20.0));
        assert!(worst(17.0) > 0.03, "an exposure shorter by a seventh is noticed: {}", worst(17.0));
    }
}

#[test]
fn what_stands_still_stays_bit_for_bit() {
    let light = |at: IVec2| Vec3::new(0.1 * at.x as f32, 1.0 / (1.0 + at.y as f32), 7.0);
    // To the right something moves, far behind; of what stands still it covers nothing.
    let gbuffer = |still: f32| {
        gbuffer_of(HEIGHT, WIDTH, move |at| {
            let (depth, length) = if at.x < 30 { (2.0, still) } else { (5.0, 12.0) };
            Some(TestPixel { light: light(at), depth, motion: [0.0, length] })
        })
    };
    for quality in Quality::ALL {
        let image = exposed(&gbuffer(0.0), &ReconstructionParameters::of(quality));
        let moved = exposed(&gbuffer(3.0), &ReconstructionParameters::of(quality));
        let (mut blurred, mut changed) = (0, 0);
        for at in (0..HEIGHT * WIDTH).map(|i| IVec2::new((i % WIDTH) as i32, (i / WIDTH) as i32)) {
            let is = |image: &Planes| {
                Vec3::from_array([0, 1, 2].map(|c| image.at(c, at.y as usize, at.x as usize)))
            };
            assert!(at.x >= 30 || is(&image) == light(at), "{}: {at}", quality.name());
            blurred += usize::from(is(&image) != light(at));
            changed += usize::from(at.x < 30 && is(&moved) != light(at));
        }
        assert!(blurred > 600 && changed > 600, "{}: {blurred} pixels, {changed}", quality.name());
    }
}

#[test]
fn what_is_flat_stays_flat_whatever_moves() {
    let gbuffer = gbuffer_of(HEIGHT, WIDTH, |at| {
        let (a, b) = ((at.x / 9) as f32, (at.y / 5) as f32);
        let motion = [(a + 2.0 * b) % 3.1, 25.0 * (a * 1.3 + b).sin().abs()];
        Some(TestPixel { light: Vec3::splat(2.5), depth: 2.0 + (3.0 * a - b).sin(), motion })
    });
    for quality in Quality::ALL {
        let image = exposed(&gbuffer, &unbounded(quality));
        assert!(image.data().iter().all(|value| (value - 2.5).abs() < 1e-5), "{}", quality.name());
    }
}

/// Stripes from the lower left to the upper right stay what they are when they move along themselves.
#[test]
fn directions_turn_from_right_to_up() {
    let stripes = |at: IVec2| Vec3::splat(((at.x + at.y) / 4 % 2) as f32);
    let contrast = |direction: f32| {
        let gbuffer = gbuffer_of(HEIGHT, WIDTH, |at| {
            Some(TestPixel { light: stripes(at), depth: 2.0, motion: [direction, 16.0] })
        });
        let image = exposed(&gbuffer, &ReconstructionParameters::of(Quality::High));
        let values: Vec<f32> = (20..40).map(|x| image.at(0, 20, x)).collect();
        values.iter().fold(0.0f32, |a, b| a.max(*b)) - values.iter().fold(1.0f32, |a, b| a.min(*b))
    };
    assert!(contrast(FRAC_PI_4) > 0.8, "along: {}", contrast(FRAC_PI_4));
    assert!(contrast(3.0 * FRAC_PI_4) < 0.4, "across: {}", contrast(3.0 * FRAC_PI_4));
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, ReconstructionParameters::of(Quality::High));
    let coarse = ReconstructionParameters { samples: 3, longest: 0.05, depth_extent: 0.5 };
    for (height, width, parameters) in [
        (HEIGHT, WIDTH, ReconstructionParameters::of(Quality::High)),
        (HEIGHT, WIDTH, coarse),
        (1, 1, ReconstructionParameters::of(Quality::High)),
        (17, 5, unbounded(Quality::Ultra)),
    ] {
        let view = view(height, width, 1.0);
        prove_twin(&method.with(parameters), &lit_still_life(height, width), None, &view, TOLERANCE);
    }
    let (_, view, gbuffer) = everything(48, 64);
    for quality in Quality::ALL {
        prove_twin(&method.with(unbounded(quality)), &gbuffer, None, &view, TOLERANCE);
    }
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    prove_comparator(
        &exposed(&lit_still_life(HEIGHT, WIDTH), &ReconstructionParameters::of(Quality::High)),
        TOLERANCE,
    );
}

#[test]
fn the_method_is_nearer_to_truth_than_the_sharp_picture() {
    let (scene, view, gbuffer) = everything(48, 64);
    let shot = Shot::new(&scene, &view.camera, [48, 64], 1.0);
    let truth = path::render(Effect::MotionBlur, &shot, Sampling::one(64, 1)).mean;
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, ReconstructionParameters::of(Quality::High));
    let sharp = gbuffer.select(&[Attribute::Light]).expect("light");
    let image = on_gpu(&method, &gbuffer, None, &view);
    let (with, without) = (relative_mse(&image, &truth), relative_mse(&sharp, &truth));
    assert!(with < 0.6 * without, "{with}, without {without}");
}
