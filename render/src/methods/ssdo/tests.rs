//! The reference against closed forms, and the GPU against the reference, pixel by pixel.

use super::*;
use crate::gbuffer;
use crate::method::{Frame, Method, Repeats};
use crate::methods::march::blurred;
use crate::methods::proving::receiver::beside_wall;
use crate::methods::proving::{
    Tolerance, agree, corner, everything, gbuffer_of, hemisphere_mean, mean_difference, plane,
    prove_comparator, prove_twin, still_life, view,
};
use crate::path::proving::{spotted, with_environment};
use crate::path::{self, Sampling, Shot};
use crate::scene::Camera;
use crate::screen::ScreenMethod;
use deepshade_shaders::GBuffer;
use deepshade_shaders::gpu::Gpu;

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Rounding puts a point on the neighbouring pixel or behind what it was before, which is one direction of
/// many; the blur shares that out.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.1 };

/// Many directions and points, no blur: the integral itself.
const PLAIN: SsdoParameters = SsdoParameters {
    directions: 500,
    steps: 150,
    thickness: 0.2,
    environment_height: 32,
    blur: blur::BlurParameters { radius: 0, sharpness: 1.0 },
};

fn shade(gbuffer: &GBuffer, environment: &Environment, parameters: &SsdoParameters, radius: f32) -> Planes {
    seen(gbuffer, Some(environment), parameters, &view(gbuffer.height(), gbuffer.width(), radius))
}

fn seen(gbuffer: &GBuffer, sky: Option<&Environment>, parameters: &SsdoParameters, view: &View) -> Planes {
    let surface = Surface::of(gbuffer).expect("all attributes");
    let noisy = reference::gather_light(&surface, &parameters.filtered(sky), &parameters.march(view));
    let [.., image] = blurred(parameters, &surface, view, noisy);
    image
}

#[test]
fn light_from_everywhere_is_the_ambient_occlusion_of_a_wall() {
    let receiver = beside_wall();
    let image = |radiance, parameters: &SsdoParameters| {
        shade(&receiver.gbuffer(), &Environment::uniform(Vec3::splat(radiance)), parameters, receiver.radius)
    };
    let compare = |image: &Planes| receiver.compare(image, |met| 2.0 * (1.0 - met), 0.06);
    assert_eq!(compare(&image(2.0, &PLAIN)), Ok(()));
    assert!(compare(&image(2.2, &PLAIN)).is_err(), "more light");
    assert!(
        compare(&image(2.0, &SsdoParameters { steps: 1, ..PLAIN })).is_err(),
        "one point a direction misses much"
    );
}

#[test]
fn an_open_plane_has_its_irradiance_whatever_its_tilt() {
    let environment = spotted().rotated(-2.0);
    for normal in [Vec3::Z, Vec3::new(0.5, 0.3, 1.0), Vec3::new(0.0, 6.0, 1.0)].map(Vec3::normalize) {
        let gbuffer = gbuffer_of(9, 13, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), normal));
        let parameters = SsdoParameters { directions: 5000, steps: 2, environment_height: 8, ..PLAIN };
        let image = shade(&gbuffer, &environment, &parameters, 1.5);
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let expected = hemisphere_mean(normal, |direction| environment.radiance(direction)[channel]);
            let found = image.at(channel, 4, 6);
            assert!((found / expected - 1.0).abs() < 0.1, "{normal}, {name}: {found} and {expected}");
            let behind = hemisphere_mean(-normal, |direction| environment.radiance(direction)[channel]);
            assert!((behind / expected - 1.0).abs() > 0.2, "the other side has another irradiance");
        }
    }
}

#[test]
fn light_comes_from_where_the_camera_in_the_world_says() {
    let gbuffer = gbuffer_of(9, 13, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), Vec3::Z));
    let environment = spotted().rotated(-2.0);
    let camera = Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 1.5, -2.0));
    let view = View { camera, ..view(9, 13, 1.0) };
    let parameters = SsdoParameters { directions: 5000, steps: 2, environment_height: 8, ..PLAIN };
    let image = seen(&gbuffer, Some(&environment), &parameters, &view);
    let normal = camera.rotation * Vec3::Z;
    let expected = hemisphere_mean(normal, |direction| environment.radiance(direction).x);
    assert!((image.at(0, 4, 6) / expected - 1.0).abs() < 0.1, "{} and {expected}", image.at(0, 4, 6));
    let unturned = hemisphere_mean(Vec3::Z, |direction| environment.radiance(direction).x);
    assert!((unturned / expected - 1.0).abs() > 0.2, "{unturned}");
}

#[test]
fn it_is_black_without_an_environment_and_in_the_sky() {
    let gbuffer = still_life(HEIGHT, WIDTH);
    let image = seen(&gbuffer, None, &SsdoParameters::of(Quality::High), &view(HEIGHT, WIDTH, 1.0));
    assert!(image.data().iter().all(|value| *value == 0.0));
    let image = shade(&gbuffer, &spotted(), &SsdoParameters::of(Quality::High), 1.0);
    let mask = gbuffer.seen().expect("a mask");
    assert!((0..HEIGHT * WIDTH).all(|i| mask[i] == (image.plane(0)[i] > 0.0)));
    assert!(image.data().iter().all(|value| value.is_finite()));
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let ssdo = ScreenMethod::new(&gpu, SsdoParameters::of(Quality::High));
    let environment = spotted().rotated(0.7);
    for (height, width, quality, radius) in [
        (HEIGHT, WIDTH, Quality::High, 1.0),
        (HEIGHT, WIDTH, Quality::Low, 30.0),
        (1, 1, Quality::High, 1.0),
        (17, 5, Quality::Ultra, 0.4),
    ] {
        let ssdo = ssdo.with(SsdoParameters::of(quality));
        let view = view(height, width, radius);
        prove_twin(&ssdo, &still_life(height, width), Some(&environment), &view, TOLERANCE);
    }
    prove_twin(&ssdo, &still_life(9, 9), None, &view(9, 9, 1.0), TOLERANCE);
    let (_, view, gbuffer) = everything(37, 50);
    prove_twin(&ssdo, &gbuffer, Some(&environment), &view, TOLERANCE);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    let right = shade(&still_life(HEIGHT, WIDTH), &spotted(), &SsdoParameters::of(Quality::High), 1.0);
    prove_comparator(&right, TOLERANCE);
    let turned =
        shade(&still_life(HEIGHT, WIDTH), &spotted().rotated(0.3), &SsdoParameters::of(Quality::High), 1.0);
    assert!(agree(&right, &turned, TOLERANCE).is_err(), "a turned environment");
}

/// Bright above, red on one side.
fn dusk() -> Environment {
    let texel = |i: usize| Vec3::new(1.0 + (i % 8) as f32 / 4.0, 1.0, 1.0) * (3 - i / 8) as f32;
    Environment::new("dusk".as_ref(), 8, 4, (0..32).map(texel).collect()).expect("radiance")
}

#[test]
fn the_method_is_nearer_to_truth_than_light_that_nothing_blocks() {
    let (scene, radius) = (with_environment(corner(), dusk()), 1.0);
    let camera = Camera::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::splat(0.8));
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let ssdo = ScreenMethod::new(&gpu, SsdoParameters::of(Quality::High));
    let gbuffer = gbuffer::render(&scene, &camera, HEIGHT, WIDTH, ssdo.attributes());
    let image = |radius| {
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: 3 };
        ssdo.shade(&frame, Repeats::ONCE).expect("runs").image
    };
    let shot = Shot::new(&scene, &camera, [HEIGHT, WIDTH], radius);
    let truth = path::render(Effect::Do, &shot, Sampling::one(256, 1)).mean;
    let open = mean_difference(&image(1e-3), &truth);
    let found = mean_difference(&image(radius), &truth);
    assert!(open > 0.03 && found < 0.5 * open, "open {open}, ssdo {found}");
}
