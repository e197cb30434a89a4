//! The reference against closed forms and against truth, the GPU against the reference.

use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::methods::proving::{
    Tolerance, everything, facing_plane, gbuffer_of, lit_still_life, on_gpu, plane, prove_comparator,
    prove_twin, view,
};
use crate::methods::separable::kernel;
use crate::metrics::relative_mse;
use crate::path::proving::quad;
use crate::path::{self, Sampling, Shot};
use crate::scene::{Camera, Light, Material, MaterialId, Mesh, Scene};
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use deepshade_shaders::{GBuffer, Planes};
use glam::{IVec2, Vec3};

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Of radiances up to about 1. Rounding puts one of many samples on the neighbouring pixel in many pixels.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.1 };

fn scattered(gbuffer: &GBuffer, samples: u32) -> Planes {
    let settings = GatherParameters { samples }.settings(&view(gbuffer.height(), gbuffer.width(), 1.0));
    let [.., image] = reference::shade(&Translucent::of(gbuffer).expect("all attributes"), &settings);
    image
}

#[test]
fn radii_are_drawn_by_the_profile() {
    for d in [0.02f32, 1.0, 30.0] {
        for share in [0.001f32, 0.1, 0.5, 0.9, 0.999] {
            let r = reference::radius_of(share, d);
            let held = 1.0 - 0.25 * (-r / d).exp() - 0.75 * (-r / (3.0 * d)).exp();
            assert!((held - share).abs() < 2e-5, "{share} of the profile within {r}: {held}");
        }
    }
}

#[test]
fn areas_are_those_of_slanted_planes() {
    for normal in [Vec3::Z, Vec3::new(0.4, -0.3, 1.0), Vec3::new(0.0, 3.0, 1.0)] {
        let normal = normal.normalize();
        let gbuffer = gbuffer_of(HEIGHT, WIDTH, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), normal));
        let surface = Translucent::of(&with_light(&gbuffer)).expect("all attributes");
        let settings = GatherParameters::of(Quality::High).settings(&view(HEIGHT, WIDTH, 1.0));
        for at in [IVec2::new(30, 21), IVec2::new(20, 25), IVec2::new(45, 30)] {
            let (x, y) = (IVec2::X, IVec2::Y);
            // The parallelogram between the pixels on either side, four times the area.
            let across = surface.position_at(at + x) - surface.position_at(at - x);
            let down = surface.position_at(at + y) - surface.position_at(at - y);
            let expected = 0.25 * across.cross(down).length();
            let found = reference::area_of_surface(&surface, &settings, at);
            assert!((found - expected).abs() < 0.03 * expected, "{at} {normal}: {found}, {expected}");
        }
    }
}

/// A g-buffer with light and mean free paths, of which nothing depends.
fn with_light(gbuffer: &GBuffer) -> GBuffer {
    let attributes = [gbuffer.attributes(), &[Attribute::Light, Attribute::MeanFreePath]].concat();
    let channels = gbuffer.planes().channels();
    let planes = Planes::from_fn(channels + 6, gbuffer.height(), gbuffer.width(), |c, y, x| {
        if c < channels { gbuffer.planes().at(c, y, x) } else { 1.0 }
    });
    GBuffer::new(attributes, planes)
}

#[test]
fn even_light_stays_as_it_is() {
    let light = Vec3::new(0.3, 0.7, 5.0);
    let image = scattered(&facing_plane(HEIGHT, WIDTH, Vec3::new(7.0, 2.0, 0.0), |_| light), 32);
    for (c, expected) in light.to_array().into_iter().enumerate() {
        assert!(image.plane(c).iter().all(|value| (value - expected).abs() < 1e-5 * expected));
    }
}

/// The share of the profile on the lit side of a step, on a plane that faces the camera.
#[test]
fn a_step_of_light_becomes_the_integral_of_the_profile() {
    const SIZE: usize = 97;
    let lit = |at: IVec2| Vec3::splat(f32::from(u8::from(at.x >= 48)));
    let image = scattered(&facing_plane(SIZE, SIZE, Vec3::new(4.0, 2.0, 0.0), lit), 2048);
    let mut noticed: f64 = 0.0;
    for (channel, length) in [(0, 4.0), (1, 2.0)] {
        for x in 30..67 {
            let share = |length: f64| {
                let from_edge = x as f64 + 0.5 - 48.0;
                let beyond = kernel::beyond(from_edge.abs() / length);
                if from_edge > 0.0 { 1.0 - beyond } else { beyond }
            };
            let value = (44..53).map(|y| f64::from(image.at(channel, y, x))).sum::<f64>() / 9.0;
            assert!((value - share(length)).abs() < 0.012, "{channel} at {x}: {value}, {}", share(length));
            noticed = noticed.max((value - share(1.2 * length)).abs());
        }
    }
    assert!(noticed > 0.018, "a profile wider by a fifth is noticed: {noticed}");
    assert!((0..SIZE).all(|x| image.at(2, 40, x) == lit(IVec2::new(x as i32, 0)).x), "blue is not scattered");
}

#[test]
fn without_a_mean_free_path_the_picture_stays_bit_for_bit() {
    let light = |at: IVec2| Vec3::new(0.1 * at.x as f32, 1.0 / (1.0 + at.y as f32), 7.0);
    let image = scattered(&facing_plane(HEIGHT, WIDTH, Vec3::ZERO, light), 8);
    let sharp = Planes::from_fn(3, HEIGHT, WIDTH, |c, y, x| light(IVec2::new(x as i32, y as i32))[c]);
    assert!(image == sharp);
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, GatherParameters::of(Quality::High));
    for (height, width, samples) in [(HEIGHT, WIDTH, 128), (HEIGHT, WIDTH, 5), (1, 1, 16), (17, 5, 512)] {
        let view = view(height, width, 1.0);
        prove_twin(
            &method.with(GatherParameters { samples }),
            &lit_still_life(height, width),
            None,
            &view,
            TOLERANCE,
        );
    }
    let (_, view, gbuffer) = everything(48, 64);
    prove_twin(&method, &gbuffer, None, &view, TOLERANCE);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    prove_comparator(&scattered(&lit_still_life(HEIGHT, WIDTH), 128), TOLERANCE);
}

/// A dark and a light half plane, seen from aside.
fn slanted_step() -> (TracedScene, View) {
    let half = |side: f32, material: u32| {
        let corners = [(0., -2.), (side, -2.), (side, 2.), (0., 2.)].map(|(x, y)| Vec3::new(x, y, 0.0));
        Mesh { material: MaterialId(material), ..quad(corners) }
    };
    let material = |grey: f32| Material {
        mean_free_path: Vec3::new(0.2, 0.1, 0.05),
        ..Material::matte("matte", Vec3::splat(grey))
    };
    let position = Vec3::new(1.0, 0.5, 1.5);
    let scene = Scene {
        meshes: vec![half(-2.0, 0), half(2.0, 1)].into(),
        materials: vec![material(0.1), material(0.9)],
        lights: vec![Light::Point { position, intensity: Vec3::splat(5.0), range: f32::INFINITY }],
        ..Scene::default()
    };
    let camera = Camera::look_at(Vec3::new(1.5, -1.8, 1.6), Vec3::ZERO);
    (TracedScene::new(scene).expect("two half planes"), View { camera, ..view(48, 64, 1.0) })
}

/// Without noise what is left is that of truth's groups of pixels, and of areas where the planes end.
#[test]
fn many_samples_become_truth() {
    let (scene, view) = slanted_step();
    let shot = Shot::new(&scene, &view.camera, [48, 64], 1.0);
    let truth = path::render(Effect::Sss, &shot, Sampling::one(1, 1)).mean;
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, GatherParameters::of(Quality::High));
    let gbuffer = gbuffer::render(&scene, &view.camera, 48, 64, method.attributes());
    let sharp = relative_mse(&gbuffer.select(&[Attribute::Light]).expect("light"), &truth);
    let errors = [8, 64, 512, 4096].map(|samples| {
        let image = on_gpu(&method.with(GatherParameters { samples }), &gbuffer, None, &view);
        relative_mse(&image, &truth) / sharp
    });
    assert!(errors.windows(2).all(|pair| pair[1] < 0.3 * pair[0]), "{errors:?} of {sharp}");
    assert!(errors[3] < 1e-4, "{errors:?} of {sharp}");
}

#[test]
fn the_method_is_nearer_to_truth_than_the_sharp_picture() {
    let (scene, view, gbuffer) = everything(48, 64);
    let shot = Shot::new(&scene, &view.camera, [48, 64], 1.0);
    let truth = path::render(Effect::Sss, &shot, Sampling::one(1, 1)).mean;
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, GatherParameters::of(Quality::High));
    let error = |samples: u32| {
        relative_mse(&on_gpu(&method.with(GatherParameters { samples }), &gbuffer, None, &view), &truth)
    };
    let sharp = relative_mse(&gbuffer.select(&[Attribute::Light]).expect("light"), &truth);
    let errors = [8, 128, 512].map(error);
    assert!(errors[0] < sharp && errors[1] < 0.3 * sharp && errors[2] < 0.15 * sharp, "{errors:?}, {sharp}");
    let image = scattered(&gbuffer, 8);
    let seen = gbuffer.seen().expect("a mask");
    let dark = (0..48 * 64).filter(|i| !seen[*i]).all(|i| (0..3).all(|c| image.plane(c)[i] == 0.0));
    assert!(dark && seen.contains(&false), "black where no surface is seen");
}
