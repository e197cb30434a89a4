//! The reference against closed forms, and the GPU against the reference, pixel by pixel.

use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::path::{self, Sampling, Shot};
use crate::scene::{Camera, Material, Mesh, Scene};
use glam::{Mat3, Vec2, Vec3};

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// No blur and no bias: the integral itself.
const PLAIN: Parameters = Parameters {
    radius_scale: 1.0,
    bias: 0.0,
    strength: 1.0,
    directions: 16,
    steps: 24,
    blur_radius: 0,
    blur_sharpness: 16.0,
};

fn camera() -> Camera {
    Camera { position: Vec3::ZERO, rotation: Mat3::IDENTITY, vertical_fov: 50f32.to_radians(), lens: None }
}

/// The surface that `hit` finds along the ray of each pixel: position and normal in camera space.
fn surface(height: usize, width: usize, hit: impl Fn(Vec3) -> Option<(Vec3, Vec3)>) -> Surface {
    let rays = |y: usize, x: usize| {
        hit(camera().direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), height, width))
    };
    let vectors = |of: fn((Vec3, Vec3)) -> Vec3| {
        Planes::from_fn(3, height, width, |c, y, x| rays(y, x).map_or(0.0, |found| of(found)[c]))
    };
    Surface {
        height,
        width,
        position: vectors(|(position, _)| position),
        normal: vectors(|(_, normal)| normal),
        valid: Planes::from_fn(1, height, width, |_, y, x| f32::from(u8::from(rays(y, x).is_some()))),
    }
}

/// Where a ray from the camera meets the front of a plane through `point`.
fn plane(ray: Vec3, point: Vec3, normal: Vec3) -> Option<(Vec3, Vec3)> {
    let facing = normal.dot(ray);
    (facing < 0.0).then(|| (ray * (normal.dot(point) / facing), normal)).filter(|(at, _)| at.z < 0.0)
}

/// Where a ray from the camera enters a sphere.
fn sphere(ray: Vec3, centre: Vec3, radius: f32) -> Option<(Vec3, Vec3)> {
    let middle = ray.dot(centre);
    let inside = middle * middle - centre.length_squared() + radius * radius;
    (inside > 0.0 && middle > 0.0).then(|| {
        let at = ray * (middle - inside.sqrt());
        (at, (at - centre) / radius)
    })
}

fn nearest(hits: impl IntoIterator<Item = Option<(Vec3, Vec3)>>) -> Option<(Vec3, Vec3)> {
    hits.into_iter().flatten().min_by(|a, b| a.0.length().total_cmp(&b.0.length()))
}

/// A slanted floor, a wall of limited height, two spheres and some sky: nothing symmetric.
fn still_life(height: usize, width: usize) -> Surface {
    surface(height, width, |ray| {
        let floor = plane(ray, Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.05, 1.0, 0.02).normalize());
        let wall = plane(ray, Vec3::new(0.0, 0.0, -6.0), Vec3::new(-0.4, 0.0, 1.0).normalize())
            .filter(|(at, _)| at.y < 0.8);
        let ball = sphere(ray, Vec3::new(-0.7, -0.5, -3.0), 0.5);
        let other = sphere(ray, Vec3::new(0.9, -0.7, -4.2), 0.8);
        nearest([floor, wall, ball, other])
    })
}

fn settings(parameters: &Parameters, surface: &Surface, radius: f32) -> Settings {
    parameters.settings(surface, camera().focal_length(surface.height), radius, 11)
}

/// Whether two images agree pixel by pixel. Rounding differs a little between processors, and now and then it puts
/// a sample on the neighbouring pixel: 1 pixel in 100 may differ by up to 0.02, all others by 0.0002.
fn agree(a: &Planes, b: &Planes) -> Result<(), String> {
    assert!(a.same_shape(b));
    let mut differences: Vec<f32> = a.data().iter().zip(b.data()).map(|(a, b)| (a - b).abs()).collect();
    if differences.iter().any(|difference| difference.is_nan()) {
        return Err("not a number".to_owned());
    }
    differences.sort_unstable_by(f32::total_cmp);
    let usual = differences[differences.len() * 99 / 100];
    let worst = differences[differences.len() - 1];
    if usual <= 2e-4 && worst <= 0.02 {
        Ok(())
    } else {
        Err(format!("99 % differ by up to {usual}, the worst by {worst}"))
    }
}

#[test]
fn a_plane_is_open_however_it_is_tilted() {
    for normal in [Vec3::Z, Vec3::new(0.5, 0.3, 1.0), Vec3::new(-2.0, 1.0, 1.0), Vec3::new(0.0, 6.0, 1.0)] {
        let surface = surface(HEIGHT, WIDTH, |ray| plane(ray, Vec3::new(0.0, 0.0, -4.0), normal.normalize()));
        let openness = reference::shade(&surface, &settings(&PLAIN, &surface, 1.5));
        let darkest = openness.data().iter().fold(1.0f32, |a, b| a.min(*b));
        assert!(darkest > 0.999, "normal {normal}: {darkest}");
    }
}

/// Looking straight down at a floor with a step up to a plateau. A point at the distance `a` from an edge that is `h`
/// high sees, in the direction `theta` from the edge's normal, the horizon at `a / cos(theta)`, so that its occlusion
/// is `1 / (2 pi)` times the integral of `h / r * (1 - (r / radius)^2)` with `r^2 = h^2 + (a / cos(theta))^2`.
#[test]
fn a_step_occludes_as_its_integral_says() {
    let (height, width) = (111, 111);
    let (floor, rise, radius) = (-5.0, 0.5f32, 2.0f32);
    let surface = surface(height, width, |ray| {
        let low = plane(ray, Vec3::new(0.0, 0.0, floor), Vec3::Z);
        let high = plane(ray, Vec3::new(0.0, 0.0, floor + rise), Vec3::Z).filter(|(at, _)| at.x > 0.3);
        nearest([low, high])
    });
    let parameters = Parameters { directions: 64, steps: 1000, ..PLAIN };
    let openness = reference::shade(&surface, &settings(&parameters, &surface, radius));
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
    let parameters = Parameters { directions: 64, steps: 1000, ..PLAIN };
    let openness = reference::shade(&surface, &settings(&parameters, &surface, 1.2));
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
    let surface = still_life(HEIGHT, WIDTH);
    let parameters = Parameters { strength: 3.0, ..Parameters::default() };
    let openness = reference::shade(&surface, &settings(&parameters, &surface, 1.0));
    assert!(openness.data().iter().all(|value| (0.0..=1.0).contains(value)));
    let sky: Vec<usize> = (0..HEIGHT * WIDTH).filter(|i| surface.valid.data()[*i] == 0.0).collect();
    assert!(sky.len() > 100 && sky.len() < HEIGHT * WIDTH / 2, "{} pixels of sky", sky.len());
    assert!(sky.iter().all(|i| openness.data()[*i] == 1.0));
    let seen: f32 = openness.data().iter().sum::<f32>() / openness.data().len() as f32;
    assert!(seen < 0.95, "something is occluded: {seen}");
}

#[test]
fn the_blur_smooths_planes_and_keeps_steps() {
    let surface = surface(HEIGHT, WIDTH, |ray| {
        let low = plane(ray, Vec3::new(0.0, 0.0, -5.0), Vec3::Z);
        let high = plane(ray, Vec3::new(0.0, 0.0, -4.0), Vec3::Z).filter(|(at, _)| at.x > 0.0);
        nearest([low, high])
    });
    let high = |x: usize| surface.position.at(2, 20, x) > -4.5;
    let edge = (0..WIDTH).find(|x| high(*x)).expect("a plateau");
    let settings = settings(&Parameters::default(), &surface, 1.0);
    // Dark and light columns in turn on the floor, all light on the plateau.
    let stripes = Planes::from_fn(1, HEIGHT, WIDTH, |_, _, x| if high(x) { 1.0 } else { (x % 2) as f32 });
    let blurred = reference::blur(&surface, &settings.blurs[0], &stripes);
    assert!((blurred.at(0, 20, edge / 2) - 0.5).abs() < 0.05, "stripes become grey");
    assert!(blurred.at(0, 20, edge) > 0.999, "nothing of the floor bleeds onto the plateau");
    assert!(blurred.at(0, 20, edge - 1) < 0.9, "nothing of the plateau bleeds onto the floor");
    let along_columns = reference::blur(&surface, &settings.blurs[1], &stripes);
    assert_eq!(along_columns.at(0, 20, 3), 1.0, "columns are uniform");
    assert_eq!(along_columns.at(0, 20, 4), 0.0, "columns are uniform");
}

#[test]
fn gpu_and_reference_agree_at_every_pixel() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let passes = Passes::new(&gpu.device).expect("valid shaders");
    let coarse =
        Parameters { directions: 5, steps: 7, strength: 1.7, blur_radius: 0, ..Parameters::default() };
    for (height, width, parameters, radius) in [
        (HEIGHT, WIDTH, Parameters::default(), 1.0),
        (HEIGHT, WIDTH, coarse, 3.0),
        (1, 1, Parameters::default(), 1.0),
        (17, 5, coarse, 0.4),
    ] {
        let surface = still_life(height, width);
        let settings = settings(&parameters, &surface, radius);
        let (found, timing) = passes.shade(&gpu, &surface, &settings, Repeats::ONCE).expect("runs");
        let wanted = reference::shade(&surface, &settings);
        assert_eq!(agree(&found, &wanted), Ok(()), "{height}x{width}, radius {radius}");
        assert!(timing.milliseconds > 0.0);
    }
}

#[test]
fn the_comparator_rejects_what_is_wrong() {
    let surface = still_life(HEIGHT, WIDTH);
    let right = reference::shade(&surface, &settings(&Parameters::default(), &surface, 1.0));
    let changed =
        |value: &dyn Fn(usize, usize) -> f32| Planes::from_fn(1, HEIGHT, WIDTH, |_, y, x| value(y, x));
    let shifted = changed(&|y, x| right.at(0, y, x.saturating_sub(1)));
    let scaled = changed(&|y, x| 0.99 * right.at(0, y, x));
    let mirrored = changed(&|y, x| right.at(0, y, WIDTH - 1 - x));
    let upside_down = changed(&|y, x| right.at(0, HEIGHT - 1 - y, x));
    let one_wrong = changed(&|y, x| if (y, x) == (30, 20) { f32::NAN } else { right.at(0, y, x) });
    assert_eq!(agree(&right, &right), Ok(()));
    for wrong in [shifted, scaled, mirrored, upside_down, one_wrong] {
        assert!(agree(&right, &wrong).is_err());
    }
    let reseeded = Settings {
        occlusion: uniforms::Hbao { seed: 12, ..settings(&Parameters::default(), &surface, 1.0).occlusion },
        ..settings(&Parameters::default(), &surface, 1.0)
    };
    assert!(agree(&right, &reference::shade(&surface, &reseeded)).is_err(), "another seed");
}

/// A floor and two walls that meet in a corner.
fn corner() -> TracedScene {
    let (x, y, z) = (3.0 * Vec3::X, 3.0 * Vec3::Y, 3.0 * Vec3::Z);
    let quad = |along: Vec3, beside: Vec3| Mesh {
        positions: vec![Vec3::ZERO, along, along + beside, beside],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let materials = vec![Material::matte("grey", Vec3::splat(0.5))];
    let meshes = vec![quad(z, x), quad(x, y), quad(y, z)];
    TracedScene::new(Scene { meshes: meshes.into(), materials, ..Scene::default() }).expect("three squares")
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
    let hbao = Hbao::new(&gpu, Parameters::default()).expect("valid shaders");
    let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius, seed: 3 };
    let shaded = hbao.shade(&frame, Repeats { warm_up: 1, timed: 3 }).expect("runs");
    let error = |image: &Planes| -> f32 {
        let differences = image.data().iter().zip(truth.data()).map(|(a, b)| (a - b).abs());
        differences.sum::<f32>() / truth.pixels() as f32
    };
    let (white, found) = (error(&Planes::filled(1, HEIGHT, WIDTH, 1.0)), error(&shaded.image));
    assert!(white > 0.03 && found < 0.5 * white, "white {white}, hbao {found}");
    assert!(shaded.milliseconds > 0.0);

    let faint = hbao.with(Parameters { strength: 0.0, ..Parameters::default() });
    let faint = faint.shade(&frame, Repeats::ONCE).expect("runs").image;
    assert!(faint.data().iter().all(|value| *value == 1.0), "no strength, no occlusion");

    let lacking = gbuffer::render(&scene, &camera, 4, 4, &[Attribute::Position]);
    let frame = Frame { gbuffer: &lacking, ..frame };
    let message = hbao.shade(&frame, Repeats::ONCE).expect_err("no normals").to_string();
    assert_eq!(message, "method `hbao`: the g-buffer has no `normal`; it holds position");
}
