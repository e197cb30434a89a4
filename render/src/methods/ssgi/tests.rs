//! The reference against closed forms, and the GPU against the reference, pixel by pixel.

use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::method::{Frame, Method, Repeats};
use crate::methods::proving::receiver::{Met, Receiver, below_disk, beside_wall, crossing};
use crate::methods::proving::{
    Tolerance, agree, corner, everything, gbuffer_of, mean_difference, nearest, plane, prove_comparator,
    prove_twin, sphere, view,
};
use crate::metrics::ssim;
use crate::path::{self, Sampling, Shot};
use crate::scene::{Camera, Light};
use crate::screen::{ScreenMethod, Technique};
use deepshade_shaders::GBuffer;
use deepshade_shaders::gpu::Gpu;
use glam::Vec3;

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Rounding moves the border of a sector, which is a slice's 32nd, or puts a sample on the neighbouring
/// pixel; the blur shares that out. Of light of 1.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.05 };

/// A g-buffer with the light that its surfaces send, by position and normal.
fn lit(gbuffer: &GBuffer, sent: impl Fn(Vec3, Vec3) -> Vec3 + Sync) -> GBuffer {
    let surface = Surface::of(gbuffer).expect("all attributes");
    let light = surface.image(0.0, |at| sent(surface.position_at(at), surface.normal_at(at)).to_array());
    let attributes = [gbuffer.attributes(), &[Attribute::DiffuseLight]].concat();
    let data = [gbuffer.planes().data(), light.data()].concat();
    let channels = gbuffer.planes().channels() + 3;
    GBuffer::new(attributes, Planes::from_data(channels, gbuffer.height(), gbuffer.width(), data))
}

/// A slanted floor, a wall and two spheres, coloured and lit from the side; some sky.
fn coloured(height: usize, width: usize) -> GBuffer {
    let gbuffer = gbuffer_of(height, width, |ray| {
        let floor = plane(ray, Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.05, 1.0, 0.02).normalize());
        let wall = plane(ray, Vec3::new(0.0, 0.0, -6.0), Vec3::new(-0.4, 0.0, 1.0).normalize());
        let ball = sphere(ray, Vec3::new(-0.7, -0.5, -3.0), 0.5);
        let other = sphere(ray, Vec3::new(0.9, -0.7, -4.2), 0.8);
        nearest([floor, wall.filter(|(at, _)| at.y < 0.8), ball, other])
    });
    lit(&gbuffer, |at, normal| {
        let colour = Vec3::new(1.0, 0.6, 0.3) + 0.4 * Vec3::new(at.x.sin(), (3.0 * at.z).sin(), at.y);
        colour * normal.dot(Vec3::new(-0.5, 0.6, 0.6)).max(0.0)
    })
}

/// What the light of a g-buffer makes, before the blur, with many samples.
fn plain(gbuffer: &GBuffer, radius: f32, thickness: f32) -> Planes {
    let march = slices::SliceParameters { slices: 64, steps: 1000, thickness };
    let settings = march.settings(&view(gbuffer.height(), gbuffer.width(), radius));
    let surface = Surface::of(gbuffer).expect("all attributes");
    let light = gbuffer.select(&[Attribute::DiffuseLight]).expect("light");
    reference::gather_light(&surface, &light, &settings)
}

/// Compares a plane beside a thing that shines with the form factor of what is seen of the thing.
fn prove<F: Fn(Vec3, Vec3) -> Met + Sync>(
    receiver: &Receiver<F>,
    radiance: f32,
    thickness: f32,
) -> Result<(), String> {
    let on_plane = |at: Vec3| (at - receiver.plane[0]).dot(receiver.plane[1]).abs() < 1e-3;
    let sent = |at: Vec3, _| if on_plane(at) { Vec3::ZERO } else { Vec3::splat(radiance) };
    let image = plain(&lit(&receiver.gbuffer(), sent), receiver.radius, thickness);
    receiver.compare(&image, |met| 2.0 * met, 0.05)
}

#[test]
fn a_floor_beside_a_wall_gets_its_form_factor() {
    assert_eq!(prove(&beside_wall(), 2.0, 0.25), Ok(()));
    assert!(prove(&beside_wall(), 2.3, 0.25).is_err(), "more light");
    assert!(prove(&beside_wall(), 0.0, 0.25).is_err(), "no light");
}

#[test]
fn a_wall_gets_the_form_factor_of_the_square_that_it_faces() {
    let (middle, normal) = (Vec3::new(1.0, 0.0, -4.0), Vec3::new(-0.866, 0.0, 0.5));
    let thing = |origin, ray| {
        let met = crossing(origin, ray, middle, normal);
        met.filter(|(at, _)| (at - middle).abs().dot(Vec3::new(0.5, 0.0, 0.866)) < 0.6 && at.y.abs() < 0.6)
    };
    let plane = [Vec3::new(-1.0, 0.0, -4.0), Vec3::new(0.866, 0.0, 0.5)];
    let receiver = Receiver { plane, thing, radius: 4.0, is_measured: |at| at.z > -4.8 };
    assert_eq!(prove(&receiver, 2.0, 0.04), Ok(()));
    assert!(prove(&receiver, 2.4, 0.04).is_err(), "more light");
}

#[test]
fn what_faces_away_sends_nothing() {
    let receiver = below_disk();
    let dark = lit(&receiver.gbuffer(), |at, _| if at.z > -4.5 { Vec3::ONE } else { Vec3::ZERO });
    let image = plain(&dark, receiver.radius, 0.06);
    assert!(image.data().iter().all(|value| *value == 0.0), "the lit side looks away from the plane");
}

#[test]
fn nothing_is_sent_along_a_plane_or_to_the_sky() {
    let slanted = Vec3::new(0.5, 0.3, 1.0).normalize();
    let wall = gbuffer_of(HEIGHT, WIDTH, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), slanted));
    let brightest =
        plain(&lit(&wall, |_, _| Vec3::ONE), 2.0, 0.3).data().iter().fold(0.0f32, |a, b| a.max(*b));
    assert!(brightest < 1e-3, "a plane does not see itself: {brightest}");
    let gbuffer = coloured(HEIGHT, WIDTH);
    let image = plain(&gbuffer, 1.0, 0.3);
    let seen = gbuffer.seen().expect("a mask");
    assert!((0..HEIGHT * WIDTH).all(|i| seen[i] || (0..3).all(|c| image.plane(c)[i] == 0.0)));
    assert!(image.data().iter().all(|value| value.is_finite()));
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let ssgi = ScreenMethod::new(&gpu, SsgiParameters::of(Quality::High));
    for (height, width, quality, radius) in [
        (HEIGHT, WIDTH, Quality::High, 1.0),
        (HEIGHT, WIDTH, Quality::Low, 30.0),
        (1, 1, Quality::High, 1.0),
        (17, 5, Quality::Ultra, 0.4),
    ] {
        let ssgi = ssgi.with(SsgiParameters::of(quality));
        prove_twin(&ssgi, &coloured(height, width), None, &view(height, width, radius), TOLERANCE);
    }
    let (_, view, gbuffer) = everything(37, 50);
    prove_twin(&ssgi, &gbuffer, None, &view, TOLERANCE);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    let shade = |seed| {
        let gbuffer = coloured(HEIGHT, WIDTH);
        let view = View { seed, ..view(HEIGHT, WIDTH, 2.0) };
        let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: None };
        let written = SsgiParameters::of(Quality::High).reference(&inputs, &view).expect("all attributes");
        Planes::from_data(3, HEIGHT, WIDTH, written[2].clone())
    };
    prove_comparator(&shade(11), TOLERANCE);
    assert!(agree(&shade(11), &shade(12), TOLERANCE).is_err(), "another seed");
}

/// The corner of a floor and two walls, lit from one side so that one wall is bright.
fn lit_corner() -> TracedScene {
    let mut scene = corner().scene().clone();
    let direction = Vec3::new(-1.0, -0.35, -0.2).normalize();
    scene.lights = vec![Light::Directional { direction, irradiance: Vec3::splat(6.0), pattern: None }];
    TracedScene::new(scene).expect("three squares")
}

/// An image of the corner's indirect light, and its truth.
fn at_corner(parameters: SsgiParameters) -> [Planes; 2] {
    let (scene, radius) = (lit_corner(), 1.5);
    let camera = Camera::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::splat(0.8));
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let ssgi = ScreenMethod::new(&gpu, parameters);
    let gbuffer = gbuffer::render(&scene, &camera, HEIGHT, WIDTH, ssgi.attributes());
    let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: 3 };
    let found = ssgi.shade(&frame, Repeats::ONCE).expect("runs").image;
    let shot = Shot::new(&scene, &camera, [HEIGHT, WIDTH], radius);
    [found, path::render(Effect::Gi, &shot, Sampling::one(256, 1)).mean]
}

#[test]
fn the_method_is_nearer_to_truth_than_black() {
    let [found, truth] = at_corner(SsgiParameters::of(Quality::High));
    let black = mean_difference(&Planes::filled(3, HEIGHT, WIDTH, 0.0), &truth);
    let found = mean_difference(&found, &truth);
    assert!(black > 0.03 && found < 0.3 * black, "black {black}, ssgi {found}");
}

#[test]
fn the_highest_quality_is_converged() {
    let ultra = SsgiParameters::of(Quality::Ultra);
    let march = slices::SliceParameters {
        slices: 2 * ultra.slices.slices,
        steps: 2 * ultra.slices.steps,
        ..ultra.slices
    };
    let [image, _] = at_corner(ultra);
    let [finer, _] = at_corner(SsgiParameters { slices: march, ..ultra });
    let [coarse, _] = at_corner(SsgiParameters::of(Quality::Low));
    let [to_finer, to_coarse] = [&finer, &coarse].map(|other| ssim(&image, other));
    assert!(to_finer > 0.99 && to_coarse < to_finer, "{to_finer}, and the lowest quality {to_coarse}");
}
