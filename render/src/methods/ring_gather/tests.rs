//! The reference against closed forms, the GPU against the reference, and both against truth.

use super::*;
use crate::gbuffer;
use crate::methods::picture::every_pixel;
use crate::methods::proving::{
    Tolerance, everything, lit_still_life, on_gpu, prove_comparator, prove_twin, view,
};
use crate::metrics::relative_mse;
use crate::path::{self, Sampling, Shot};
use crate::scene::{Camera, Lens};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};
use glam::{IVec2, Vec3};

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Of radiances up to about 1. Rounding puts a sample on the neighbouring pixel in few pixels.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.1 };

/// Circles of any size that an image holds.
fn unbounded(quality: Quality) -> RingGatherParameters {
    RingGatherParameters { largest: 1.0, ..RingGatherParameters::of(quality) }
}

/// Light and signed radius of the circle of confusion of every pixel.
fn gbuffer_of(height: usize, width: usize, pixel: impl Fn(IVec2) -> (Vec3, f32) + Sync) -> GBuffer {
    const DEPTH: f32 = 3.0;
    let pixels = every_pixel(height, width, |at| {
        let (light, radius) = pixel(at);
        [light.x, light.y, light.z, DEPTH, DEPTH * radius, 1.0]
    });
    let attributes = vec![Attribute::Light, Attribute::Depth, Attribute::Blurriness, Attribute::Valid];
    GBuffer::new(attributes, Planes::from_fn(6, height, width, |c, y, x| pixels[y * width + x][c]))
}

fn blurred(gbuffer: &GBuffer, parameters: &RingGatherParameters) -> Planes {
    let settings = parameters.settings(&view(gbuffer.height(), gbuffer.width(), 1.0));
    let written = reference::shade(&reference::Blurred::of(gbuffer).expect("all attributes"), &settings);
    let image = written.into_iter().last().expect("an image");
    Planes::from_data(3, gbuffer.height(), gbuffer.width(), image)
}

#[test]
fn what_is_in_focus_stays_bit_for_bit() {
    let light = |at: IVec2| Vec3::new(0.1 * at.x as f32, 1.0 / (1.0 + at.y as f32), 7.0);
    for quality in Quality::ALL {
        let image =
            blurred(&gbuffer_of(HEIGHT, WIDTH, |at| (light(at), 0.0)), &RingGatherParameters::of(quality));
        let sharp = Planes::from_fn(3, HEIGHT, WIDTH, |c, y, x| light(IVec2::new(x as i32, y as i32))[c]);
        assert!(image == sharp, "{}", quality.name());
        let image =
            blurred(&gbuffer_of(HEIGHT, WIDTH, |at| (light(at), 3.0)), &RingGatherParameters::of(quality));
        assert!(image != sharp, "{}: what is out of focus is not", quality.name());
    }
}

#[test]
fn what_is_flat_stays_flat_whatever_its_blur() {
    let radius = |at: IVec2| 9.0 * ((at.x / 7) as f32).sin() + (at.y % 5) as f32 - 2.0;
    for quality in Quality::ALL {
        let image =
            blurred(&gbuffer_of(HEIGHT, WIDTH, |at| (Vec3::splat(2.5), radius(at))), &unbounded(quality));
        assert!(image.data().iter().all(|value| (value - 2.5).abs() < 1e-5), "{}", quality.name());
    }
}

/// Light of one pixel far behind focus on what is black there too, and of one in front over what is black and
/// sharp.
#[test]
fn a_point_becomes_an_even_disc_with_all_of_its_energy() {
    let (size, middle, radius) = (64, IVec2::splat(32), 10.0);
    let point = |at: IVec2| if at == middle { Vec3::splat(100.0) } else { Vec3::ZERO };
    let far = gbuffer_of(size, size, |at| (point(at), radius));
    let near = gbuffer_of(size, size, |at| (point(at), if at == middle { -radius } else { 0.0 }));
    for gbuffer in [far, near] {
        let image = blurred(&gbuffer, &unbounded(Quality::Ultra));
        let within = |radius: f32| {
            let inside = every_pixel(size, size, |at| {
                let inside = (at - middle).as_vec2().length() < radius;
                if inside { image.at(0, at.y as usize, at.x as usize) } else { 0.0 }
            });
            inside.iter().sum::<f32>()
        };
        let all = within(99.0);
        assert!((all - 100.0).abs() < 3.0, "{all} of 100");
        assert!((within(radius + 1.0) - all).abs() < 1e-3 * all, "nothing outside of the disc");
        assert!((within(0.6 * radius) - 36.0).abs() < 4.0, "{} of 36", within(0.6 * radius));
    }
}

/// A near half plane, white, over what is black and sharp: of a disc whose middle is as far from the edge as
/// a pixel is, the share beyond the edge is white.
#[test]
fn a_near_edge_covers_what_it_cuts_of_the_disc() {
    let (size, radius) = (64, 8.0f32);
    let gbuffer =
        gbuffer_of(size, size, |at| if at.x < 32 { (Vec3::ONE, -radius) } else { (Vec3::ZERO, 0.0) });
    let share = |beyond: f32| {
        let t = beyond.clamp(-1.0, 1.0);
        (t.acos() - t * (1.0 - t * t).sqrt()) / std::f32::consts::PI
    };
    for (quality, tolerance) in [(Quality::Ultra, 0.05), (Quality::High, 0.08)] {
        let image = blurred(&gbuffer, &unbounded(quality));
        let worst = |radius: f32| {
            let off = (18..46).map(|x| {
                let expected = share((x as f32 + 0.5 - 32.0) / radius);
                (image.at(1, 30, x) - expected).abs()
            });
            off.fold(0.0, f32::max)
        };
        assert!(worst(radius) < tolerance, "{}: {}", quality.name(), worst(radius));
        assert!(worst(1.5 * radius) > tolerance, "{}: another radius is noticed", quality.name());
    }
}

#[test]
fn what_is_sharp_takes_nothing_from_a_blurred_background() {
    let gbuffer =
        gbuffer_of(HEIGHT, WIDTH, |at| if at.x < 30 { (Vec3::X, 0.0) } else { (Vec3::splat(5.0), 9.0) });
    for quality in Quality::ALL {
        let image = blurred(&gbuffer, &RingGatherParameters::of(quality));
        for (y, x) in (0..HEIGHT).flat_map(|y| (0..30).map(move |x| (y, x))) {
            assert_eq!([image.at(0, y, x), image.at(1, y, x)], [1.0, 0.0], "{}: ({x}, {y})", quality.name());
        }
        assert!((image.at(1, 20, 45) - 5.0).abs() < 1e-5, "nor the background from what is sharp");
    }
}

/// Nothing is seen beyond an edge: what is infinitely far away is black and blurred.
#[test]
fn what_is_not_seen_is_far_away() {
    let mut planes = gbuffer_of(HEIGHT, WIDTH, |_| (Vec3::ONE, -4.0)).planes().clone();
    let attributes = vec![Attribute::Light, Attribute::Depth, Attribute::Blurriness, Attribute::Valid];
    for pixel in (0..HEIGHT * WIDTH).filter(|i| i % WIDTH >= 30) {
        for plane in 0..6 {
            planes.plane_mut(plane)[pixel] = if plane == 5 { 0.0 } else { f32::NAN };
        }
    }
    let image = blurred(&GBuffer::new(attributes, planes), &RingGatherParameters::of(Quality::Ultra));
    assert!(image.data().iter().all(|value| value.is_finite()));
    assert!((0.2..0.5).contains(&image.at(0, 20, 30)), "{}", image.at(0, 20, 30));
    assert!((0.5..0.8).contains(&image.at(0, 20, 29)) && image.at(0, 20, 40) == 0.0);
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, RingGatherParameters::of(Quality::High));
    let coarse = RingGatherParameters { scale: 3, rings: 1, softness: 2.5, ..unbounded(Quality::Low) };
    for (height, width, parameters) in [
        (HEIGHT, WIDTH, RingGatherParameters::of(Quality::High)),
        (HEIGHT, WIDTH, coarse),
        (1, 1, RingGatherParameters::of(Quality::High)),
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
        &blurred(&lit_still_life(HEIGHT, WIDTH), &RingGatherParameters::of(Quality::High)),
        TOLERANCE,
    );
}

#[test]
fn the_method_is_nearer_to_truth_than_the_sharp_picture() {
    let (scene, view, _) = everything(48, 64);
    let lens = Lens::new(0.06 * scene.diagonal(), 0.4 * scene.diagonal()).expect("a lens");
    let view = View { camera: Camera { lens: Some(lens), ..view.camera }, ..view };
    let shot = Shot::new(&scene, &view.camera, [48, 64], 1.0);
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, unbounded(Quality::High));
    let gbuffer = gbuffer::render(&scene, &view.camera, 48, 64, method.attributes());
    let truth = path::render(Effect::Dof, &shot, Sampling::one(64, 1)).mean;
    let sharp = gbuffer.select(&[Attribute::Light]).expect("light");
    let errors = Quality::ALL.map(|quality| {
        relative_mse(&on_gpu(&method.with(unbounded(quality)), &gbuffer, None, &view), &truth)
    });
    let without = relative_mse(&sharp, &truth);
    assert!(errors.iter().all(|error| *error < 0.5 * without), "{errors:?}, without {without}");
}
