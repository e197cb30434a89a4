//! The reference against closed forms, and the GPU against the reference, pixel by pixel.

use super::*;
use crate::gbuffer;
use crate::method::{Frame, Method, Repeats};
use crate::methods::march::blurred;
use crate::methods::proving::receiver::{Met, Receiver, below_disk, beside_wall};
use crate::methods::proving::{
    Tolerance, agree, corner, everything, gbuffer_of, mean_difference, plane, prove_comparator, prove_twin,
    sphere, still_life, view,
};
use crate::path::{self, Sampling, Shot};
use crate::scene::Camera;
use crate::screen::ScreenMethod;
use deepshade_shaders::gpu::Gpu;
use glam::Vec3;

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// Rounding moves the border of a sector, which is a slice's 32nd, or puts a sample on the neighbouring
/// pixel; the blur shares that out.
const TOLERANCE: Tolerance = Tolerance { usual: 1e-4, worst: 0.05 };

/// Many samples, no blur: the integral itself.
fn plain(thickness: f32) -> GtaoParameters {
    GtaoParameters {
        slices: slices::SliceParameters { slices: 64, steps: 1000, thickness },
        blur: blur::BlurParameters { radius: 0, sharpness: 1.0 },
    }
}

fn surface(height: usize, width: usize, hit: impl Fn(Vec3) -> Option<(Vec3, Vec3)>) -> Surface {
    Surface::of(&gbuffer_of(height, width, hit)).expect("all attributes")
}

fn openness(surface: &Surface, parameters: &GtaoParameters, radius: f32) -> Planes {
    seen_openness(surface, parameters, &view(surface.height, surface.width, radius))
}

fn seen_openness(surface: &Surface, parameters: &GtaoParameters, view: &View) -> Planes {
    let noisy = reference::occlude(surface, &parameters.march(view));
    let [.., image] = blurred(parameters, surface, view, noisy);
    image
}

#[test]
fn a_plane_is_open_however_it_is_tilted() {
    for normal in [Vec3::Z, Vec3::new(0.5, 0.3, 1.0), Vec3::new(-2.0, 1.0, 1.0), Vec3::new(0.0, 6.0, 1.0)] {
        let surface = surface(HEIGHT, WIDTH, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), normal.normalize()));
        for parameters in [plain(0.3), GtaoParameters::of(Quality::Low)] {
            let openness = openness(&surface, &parameters, 1.5);
            let darkest = openness.data().iter().fold(1.0f32, |a, b| a.min(*b));
            assert!(darkest > 0.999, "normal {normal}: {darkest}");
        }
    }
}

/// Compares the plane beside a thing with the share of directions that do not meet it.
fn prove<F: Fn(Vec3, Vec3) -> Met>(
    receiver: &Receiver<F>,
    thickness: f32,
    within: f32,
) -> Result<(), String> {
    let surface = Surface::of(&receiver.gbuffer()).expect("all attributes");
    let openness = openness(&surface, &plain(thickness), receiver.radius);
    receiver.compare(&openness, |met| 1.0 - met, within)
}

#[test]
fn a_floor_beside_a_wall_has_its_integral() {
    assert_eq!(prove(&beside_wall(), 0.25, 0.02), Ok(()));
    assert!(prove(&beside_wall(), 0.001, 0.02).is_err(), "between samples of a thin wall light leaks");
    let near = Receiver { radius: 0.9, ..beside_wall() };
    assert_eq!(prove(&near, 0.5, 0.03), Ok(()), "a pixel of the wall's is the radius' border");
    let surface = Surface::of(&near.gbuffer()).expect("all attributes");
    let far = openness(&surface, &plain(0.5), 1.2);
    assert!(near.compare(&far, |met| 1.0 - met, 0.03).is_err(), "another radius");
}

#[test]
fn a_disk_above_a_plane_lets_light_pass_behind_it() {
    assert_eq!(prove(&below_disk(), 0.06, 0.02), Ok(()));
    assert!(prove(&below_disk(), 9.0, 0.02).is_err(), "down to the plane, as with horizons");
}

#[test]
fn a_sphere_on_a_plane_has_its_integral() {
    let (centre, radius) = (Vec3::new(0.0, -0.5, -4.0), 0.5);
    let thing = move |origin: Vec3, ray: Vec3| {
        sphere(ray, centre - origin, radius).map(|(at, normal)| (at + origin, normal))
    };
    let receiver =
        Receiver { plane: [Vec3::NEG_Y, Vec3::Y], thing, radius: 2.0, is_measured: |at| at.z > -3.5 };
    assert_eq!(prove(&receiver, 0.05, 0.02), Ok(()));
}

#[test]
fn openness_is_in_range_and_one_where_nothing_is_seen() {
    let surface = Surface::of(&still_life(HEIGHT, WIDTH)).expect("all attributes");
    let openness = openness(&surface, &GtaoParameters::of(Quality::High), 1.0);
    assert!(openness.data().iter().all(|value| (0.0..=1.0).contains(value)));
    let sky: Vec<usize> = (0..HEIGHT * WIDTH).filter(|i| surface.valid.data()[*i] == 0.0).collect();
    assert!(sky.len() > 100 && sky.iter().all(|i| openness.data()[*i] == 1.0));
    let mean: f32 = openness.data().iter().sum::<f32>() / openness.data().len() as f32;
    assert!(mean < 0.95, "something is occluded: {mean}");
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let gtao = ScreenMethod::new(&gpu, GtaoParameters::of(Quality::High));
    for (height, width, quality, radius) in [
        (HEIGHT, WIDTH, Quality::High, 1.0),
        (HEIGHT, WIDTH, Quality::Low, 30.0),
        (1, 1, Quality::High, 1.0),
        (17, 5, Quality::Ultra, 0.4),
    ] {
        let view = view(height, width, radius);
        let gtao = gtao.with(GtaoParameters::of(quality));
        prove_twin(&gtao, &still_life(height, width), None, &view, TOLERANCE);
    }
    let (_, view, gbuffer) = everything(37, 50);
    prove_twin(&gtao, &gbuffer, None, &view, TOLERANCE);
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    let surface = Surface::of(&still_life(HEIGHT, WIDTH)).expect("all attributes");
    let right = openness(&surface, &GtaoParameters::of(Quality::High), 1.0);
    prove_comparator(&right, TOLERANCE);
    let view = View { seed: 12, ..view(HEIGHT, WIDTH, 1.0) };
    let reseeded = seen_openness(&surface, &GtaoParameters::of(Quality::High), &view);
    assert!(agree(&right, &reseeded, TOLERANCE).is_err(), "another seed");
}

#[test]
fn the_method_is_nearer_to_truth_than_white() {
    let (scene, radius) = (corner(), 1.0);
    let camera = Camera::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::splat(0.8));
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let gtao = ScreenMethod::new(&gpu, GtaoParameters::of(Quality::High));
    let gbuffer = gbuffer::render(&scene, &camera, HEIGHT, WIDTH, gtao.attributes());
    let shot = Shot::new(&scene, &camera, [HEIGHT, WIDTH], radius);
    let truth = path::render(Effect::Ao, &shot, Sampling::one(256, 1)).mean;
    let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: 3 };
    let found = gtao.shade(&frame, Repeats::ONCE).expect("runs").image;
    let white = mean_difference(&Planes::filled(1, HEIGHT, WIDTH, 1.0), &truth);
    let found = mean_difference(&found, &truth);
    assert!(white > 0.03 && found < 0.25 * white, "white {white}, gtao {found}");
}
