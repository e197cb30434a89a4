//! The kernel and the reference against closed forms, the GPU against the reference, and both against truth.

use super::*;
use crate::methods::proving::{
    Tolerance, everything, facing_plane, lit_still_life, on_gpu, prove_comparator, prove_twin, view,
};
use crate::metrics::relative_mse;
use crate::path::{self, Sampling, Shot};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};
use glam::{IVec2, Vec3};

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Of radiances up to about 1. Rounding puts a tap on the neighbouring pixel in few pixels.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.1 };

fn scattered(gbuffer: &GBuffer, parameters: &SeparableParameters) -> Planes {
    let settings = parameters.settings(&view(gbuffer.height(), gbuffer.width(), 1.0));
    let [.., image] = reference::shade(&Translucent::of(gbuffer).expect("all attributes"), &settings);
    image
}

#[test]
fn the_kernel_is_the_profile_integrated_over_columns() {
    // A profile's share in a strip, by sums over the plane in rings: of a ring of radius r, acos(a / r) / pi
    // is beyond a.
    let beyond = |a: f64| {
        let steps = 200_000;
        let step = 40.0 / f64::from(steps);
        let ring = |i: i32| {
            let r = (f64::from(i) + 0.5) * step;
            let share = 0.25 * ((-r).exp() + (-r / 3.0).exp());
            if r > a { share * step * (a / r).acos() / std::f64::consts::PI } else { 0.0 }
        };
        (0..steps).map(ring).sum::<f64>()
    };
    for a in [0.0, 0.01, 0.3, 1.0, 4.0, 9.0] {
        let (found, expected) = (kernel::beyond(a), beyond(a));
        assert!((found - expected).abs() < 2e-5, "{found} beyond {a}, {expected}");
    }
    for (count, reach) in [(2, 3.0), (4, 8.0), (25, 12.0)] {
        let taps = kernel::taps(count, reach);
        let sum: f32 = taps[0][1] + 2.0 * taps[1..].iter().map(|tap| tap[1]).sum::<f32>();
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        assert_eq!(taps[count - 1][0], reach);
        assert!(
            taps[..count].iter().all(|tap| tap[1] > 0.0) && taps[count..].iter().all(|tap| tap[1] == 0.0)
        );
    }
}

#[test]
fn even_light_stays_as_it_is() {
    let light = Vec3::new(0.3, 0.7, 5.0);
    let image = scattered(
        &facing_plane(HEIGHT, WIDTH, Vec3::new(7.0, 2.0, 0.0), |_| light),
        &SeparableParameters::of(Quality::High),
    );
    for (c, expected) in light.to_array().into_iter().enumerate() {
        assert!(image.plane(c).iter().all(|value| (value - expected).abs() < 1e-5 * expected));
    }
}

/// A step of light on a plane that faces the camera: the share of the profile on the lit side, along rows and
/// along columns.
#[test]
fn a_step_of_light_becomes_the_integral_of_the_profile() {
    const SIZE: usize = 97;
    let lit = |at: i32| Vec3::splat(f32::from(u8::from(at >= 48)));
    let lengths = Vec3::new(4.0, 2.0, 0.0);
    let ultra = SeparableParameters::of(Quality::Ultra);
    let rows = scattered(&facing_plane(SIZE, SIZE, lengths, |at| lit(at.x)), &ultra);
    let columns = scattered(&facing_plane(SIZE, SIZE, lengths, |at| lit(at.y)), &ultra);
    let mut noticed: f64 = 0.0;
    for (channel, length) in [(0, 4.0), (1, 2.0)] {
        for i in 20..77 {
            let share = |length: f64| {
                let from_edge = i as f64 + 0.5 - 48.0;
                let beyond = kernel::beyond(from_edge.abs() / length);
                if from_edge > 0.0 { 1.0 - beyond } else { beyond }
            };
            for value in [rows.at(channel, 40, i), columns.at(channel, i, 40)] {
                let off = (f64::from(value) - share(length)).abs();
                assert!(off < 0.04, "{channel} at {i}: {value} is not {}", share(length));
                noticed = noticed.max((f64::from(value) - share(1.5 * length)).abs());
            }
        }
    }
    assert!(noticed > 0.05, "a profile wider by a half is noticed: {noticed}");
    assert!((0..SIZE).all(|x| rows.at(2, 40, x) == lit(x as i32).x), "blue is not scattered");
}

#[test]
fn without_a_mean_free_path_the_picture_stays_bit_for_bit() {
    let light = |at: IVec2| Vec3::new(0.1 * at.x as f32, 1.0 / (1.0 + at.y as f32), 7.0);
    for quality in Quality::ALL {
        let image =
            scattered(&facing_plane(HEIGHT, WIDTH, Vec3::ZERO, light), &SeparableParameters::of(quality));
        let sharp = Planes::from_fn(3, HEIGHT, WIDTH, |c, y, x| light(IVec2::new(x as i32, y as i32))[c]);
        assert!(image == sharp);
    }
}

#[test]
fn light_does_not_leap_between_surfaces_far_apart() {
    let plane =
        facing_plane(HEIGHT, WIDTH, Vec3::splat(3.0), |at| Vec3::splat(f32::from(u8::from(at.x >= 30))));
    let mut planes = plane.planes().clone();
    // What is lit is ten times as far away.
    for pixel in (0..HEIGHT * WIDTH).filter(|i| i % WIDTH >= 30) {
        (0..3).for_each(|c| planes.plane_mut(c)[pixel] *= 10.0);
    }
    let apart = GBuffer::new(plane.attributes().to_vec(), planes);
    let bled = |gbuffer: &GBuffer, follow: f32| {
        scattered(gbuffer, &SeparableParameters { follow, ..SeparableParameters::of(Quality::High) })
            .at(0, 20, 29)
    };
    let follow = SeparableParameters::of(Quality::High).follow;
    assert!(bled(&apart, follow) < 1e-3, "{}", bled(&apart, follow));
    assert!(bled(&plane, follow) > 0.2 && bled(&apart, 0.0) > 0.2, "as it would on one surface");
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, SeparableParameters::of(Quality::High));
    let coarse = SeparableParameters { taps: 3, reach: 2.0, follow: 0.0 };
    for (height, width, parameters) in [
        (HEIGHT, WIDTH, SeparableParameters::of(Quality::High)),
        (HEIGHT, WIDTH, coarse),
        (1, 1, SeparableParameters::of(Quality::High)),
        (17, 5, SeparableParameters::of(Quality::Ultra)),
    ] {
        let view = view(height, width, 1.0);
        prove_twin(&method.with(parameters), &lit_still_life(height, width), None, &view, TOLERANCE);
    }
    let (_, view, gbuffer) = everything(48, 64);
    prove_twin(&method, &gbuffer, None, &view, TOLERANCE);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    prove_comparator(
        &scattered(&lit_still_life(HEIGHT, WIDTH), &SeparableParameters::of(Quality::High)),
        TOLERANCE,
    );
}

#[test]
fn the_method_is_nearer_to_truth_than_the_sharp_picture() {
    let (scene, view, gbuffer) = everything(48, 64);
    let shot = Shot::new(&scene, &view.camera, [48, 64], 1.0);
    let truth = path::render(Effect::Sss, &shot, Sampling::one(1, 1)).mean;
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, SeparableParameters::of(Quality::High));
    let sharp = gbuffer.select(&[Attribute::Light]).expect("light");
    let image = on_gpu(&method, &gbuffer, None, &view);
    let (with, without) = (relative_mse(&image, &truth), relative_mse(&sharp, &truth));
    assert!(with < 0.5 * without, "{with}, without {without}");
    let seen = gbuffer.seen().expect("a mask");
    let dark = (0..48 * 64).filter(|i| !seen[*i]).all(|i| (0..3).all(|c| image.plane(c)[i] == 0.0));
    assert!(dark && seen.contains(&false), "black where no surface is seen");
}
