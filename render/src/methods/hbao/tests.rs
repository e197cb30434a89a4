//! The reference against closed forms, and the GPU against the reference, pixel by pixel.

use super::*;
use crate::gbuffer;
use crate::method::{Frame, Method, Repeats};
use crate::methods::march::blurred;
use crate::methods::proving::{
    Tolerance, agree, corner, gbuffer_of, nearest, plane, prove_comparator, prove_twin, still_life, view,
};
use crate::path::{self, Sampling, Shot};
use crate::scene::Camera;
use crate::screen::ScreenMethod;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::Gpu;
use glam::Vec3;

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// No blur and no bias: the integral itself.
const PLAIN: HbaoParameters = HbaoParameters {
    radius_scale: 1.0,
    bias: 0.0,
    strength: 1.0,
    directions: 16,
    steps: 24,
    blur_radius: 0,
    blur_sharpness: 16.0,
};

/// Rounding puts a sample on the neighbouring pixel in one pixel of 100.
const TOLERANCE: Tolerance = Tolerance { usual: 2e-4, worst: 0.02 };

fn surface(height: usize, width: usize, hit: impl Fn(Vec3) -> Option<(Vec3, Vec3)>) -> Surface {
    Surface::of(&gbuffer_of(height, width, hit)).expect("all attributes")
}

fn openness(surface: &Surface, parameters: &HbaoParameters, view: &View) -> Planes {
    let noisy = reference::occlude(surface, &parameters.march(view));
    let [.., image] = blurred(parameters, surface, view, noisy);
    image
}

#[test]
fn a_plane_is_open_however_it_is_tilted() {
    for normal in [Vec3::Z, Vec3::new(0.5, 0.3, 1.0), Vec3::new(-2.0, 1.0, 1.0), Vec3::new(0.0, 6.0, 1.0)] {
        let surface = surface(HEIGHT, WIDTH, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), normal.normalize()));
        let openness = openness(&surface, &PLAIN, &view(surface.height, surface.width, 1.5));
        let darkest = openness.data().iter().fold(1.0f32, |a, b| a.min(*b));
        assert!(darkest > 0.999, "normal {normal}: {darkest}");
    }
}

/// Looking straight down at a floor with a step up to a plateau. A point at the distance `a` from an edge
/// that is `h` high sees, in the direction `theta` from the edge's normal, the horizon at `a / cos(theta)`,
/// so that its occlusion is `1 / (2 pi)` times the integral of `h / r * (1 - (r / radius)^2)` with
/// `r^2 = h^2 + (a / cos(theta))^2`.
#[test]
fn a_step_occludes_as_its_integral_says() {
    let (height, width) = (111, 111);
    let (floor, rise, radius) = (-5.0, 0.5f32, 2.0f32);
    let surface = surface(height, width, |ray| {
        let low = plane(ray, Vec3::new(0.0, 0.0, floor), Vec3::Z);
        let high = plane(ray, Vec3::new(0.0, 0.0, floor + rise), Vec3::Z).filter(|(at, _)| at.x > 0.3);
        nearest([low, high])
    });
    let parameters = HbaoParameters { directions: 64, steps: 1000, ..PLAIN };
    let openness = openness(&surface, &parameters, &view(surface.height, surface.width, radius));
    let mut compared = 0;
    for x in 0..width {
        let at = surface.position.at(0, height / 2, x);
        let on_floor = surface.position.at(2, height / 2, x) < floor + 0.5 * rise;
        let away = 0.3 - at;
        // Nearer than a few pixels the grid shows; the image has to reach far enough along the edge, too.
        if !on_floor || !(0.15..1.8).contains(&away) {
            continue;
        }
        let samples = 10_000;
        let integral: f32 = (0..samples)
            .map(|i| {
                let theta =
                    (i as f32 + 0.5) / samples as f32 * std::f32::consts::PI - std::f32::consts::FRAC_PI_2;
                let reach = rise.hypot(away / theta.cos());
                if reach < radius { rise / reach * (1.0 - (reach / radius).powi(2)) } else { 0.0 }
            })
            .sum::<f32>()
            / samples as f32
            * 0.5;
        let found = 1.0 - openness.at(0, height / 2, x);
        assert!((found - integral).abs() < 0.015, "{away} m away: {found}, integral {integral}");
        compared += 1;
    }
    assert!(compared > 20, "{compared} pixels compared");
}

#[test]
fn a_corner_darkens_steadily_from_open_to_half() {
    let size = 111;
    let surface = surface(size, size, |ray| {
        let wall = |normal: Vec3| plane(ray, Vec3::new(0.0, 0.0, -5.0), normal.normalize());
        nearest([wall(Vec3::new(1.0, 0.0, 1.0)), wall(Vec3::new(-1.0, 0.0, 1.0))])
    });
    let parameters = HbaoParameters { directions: 64, steps: 1000, ..PLAIN };
    let openness = openness(&surface, &parameters, &view(surface.height, surface.width, 1.2));
    let row: Vec<f32> = (0..=size / 2).map(|x| openness.at(0, size / 2, x)).collect();
    let corner = row[size / 2];
    assert!(row[0] > 0.999 && row[10] > 0.99, "open far from the corner: {row:?}");
    assert!((0.4..0.6).contains(&corner), "half of all directions meet the other wall: {corner}");
    for (x, pair) in row.windows(2).enumerate() {
        assert!(pair[1] <= pair[0] + 0.01, "brighter towards the corner at {x}: {pair:?}");
    }
    assert!(row[30] > row[44] + 0.03 && row[44] > row[52] + 0.03, "{row:?}");
}

#[test]
fn openness_is_in_range_and_one_where_nothing_is_seen() {
    let surface = Surface::of(&still_life(HEIGHT, WIDTH)).expect("all attributes");
    let parameters = HbaoParameters { strength: 3.0, ..HbaoParameters::of(Quality::High) };
    let openness = openness(&surface, &parameters, &view(surface.height, surface.width, 1.0));
    assert!(openness.data().iter().all(|value| (0.0..=1.0).contains(value)));
    let sky: Vec<usize> = (0..HEIGHT * WIDTH).filter(|i| surface.valid.data()[*i] == 0.0).collect();
    assert!(sky.len() > 100 && sky.len() < HEIGHT * WIDTH / 2, "{} pixels of sky", sky.len());
    assert!(sky.iter().all(|i| openness.data()[*i] == 1.0));
    let seen: f32 = openness.data().iter().sum::<f32>() / openness.data().len() as f32;
    assert!(seen < 0.95, "something is occluded: {seen}");
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let hbao = ScreenMethod::new(&gpu, HbaoParameters::of(Quality::High));
    let coarse = HbaoParameters {
        directions: 5,
        steps: 7,
        strength: 1.7,
        blur_radius: 0,
        ..HbaoParameters::of(Quality::High)
    };
    for (height, width, parameters, radius) in [
        (HEIGHT, WIDTH, HbaoParameters::of(Quality::High), 1.0),
        (HEIGHT, WIDTH, coarse, 3.0),
        (1, 1, HbaoParameters::of(Quality::High), 1.0),
        (17, 5, coarse, 0.4),
    ] {
        let view = view(height, width, radius);
        prove_twin(&hbao.with(parameters), &still_life(height, width), None, &view, TOLERANCE);
    }
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    let surface = Surface::of(&still_life(HEIGHT, WIDTH)).expect("all attributes");
    let right =
        openness(&surface, &HbaoParameters::of(Quality::High), &view(surface.height, surface.width, 1.0));
    prove_comparator(&right, TOLERANCE);
    let view = View { seed: 12, ..view(HEIGHT, WIDTH, 1.0) };
    let reseeded = openness(&surface, &HbaoParameters::of(Quality::High), &view);
    assert!(agree(&right, &reseeded, TOLERANCE).is_err(), "another seed");
}

#[test]
fn the_method_is_nearer_to_truth_than_white() {
    let (scene, radius) = (corner(), 1.0);
    let camera = Camera::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::splat(0.8));
    let gbuffer = gbuffer::render(
        &scene,
        &camera,
        HEIGHT,
        WIDTH,
        &[Attribute::Normal, Attribute::Position, Attribute::Valid],
    );
    let shot = Shot::new(&scene, &camera, [HEIGHT, WIDTH], radius);
    let truth = path::render(Effect::Ao, &shot, Sampling::one(256, 1)).mean;
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let hbao = ScreenMethod::new(&gpu, HbaoParameters::of(Quality::High));
    let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: 3 };
    let shaded = hbao.shade(&frame, Repeats { warm_up: 1, timed: 3 }).expect("runs");
    let error = |image: &Planes| -> f32 {
        let differences = image.data().iter().zip(truth.data()).map(|(a, b)| (a - b).abs());
        differences.sum::<f32>() / truth.pixels() as f32
    };
    let (white, found) = (error(&Planes::filled(1, HEIGHT, WIDTH, 1.0)), error(&shaded.image));
    assert!(white > 0.03 && found < 0.5 * white, "white {white}, hbao {found}");
    assert!(shaded.milliseconds > 0.0);

    let faint = hbao.with(HbaoParameters { strength: 0.0, ..HbaoParameters::of(Quality::High) });
    let faint = faint.shade(&frame, Repeats::ONCE).expect("runs").image;
    // The blur divides by its weights, and GPUs divide to the last digits only nearly.
    assert!(faint.data().iter().all(|value| (value - 1.0).abs() < 1e-6), "no strength, no occlusion");

    let lacking = gbuffer::render(&scene, &camera, 4, 4, &[Attribute::Position]);
    let frame = Frame { gbuffer: &lacking, ..frame };
    let message = hbao.shade(&frame, Repeats::ONCE).expect_err("no normals").to_string();
    assert_eq!(message, "method `hbao`: the g-buffer has no `normal`; it holds position");
}
