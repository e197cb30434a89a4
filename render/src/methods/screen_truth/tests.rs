//! Against closed forms, and against truth where all is seen and where something is not.

use super::*;
use crate::gbuffer;
use crate::methods::proving::receiver::{self, below_disk, beside_wall};
use crate::methods::proving::{camera, corner, mean_difference};
use crate::path::proving::{quad, sphere, traced};
use crate::path::{self, Sampling};
use crate::sampler;
use crate::scene::{Camera, Material, Mesh};
use deepshade_shaders::Attribute;
use std::f32::consts::{PI, TAU};

const HEIGHT: usize = 43;
const WIDTH: usize = 61;

/// One layer, no guard band, little noise.
const PLAIN: ScreenTruthParameters = ScreenTruthParameters { layers: 1, guard: 0.0, samples: 1024 };

fn scene(meshes: Vec<Mesh>) -> TracedScene {
    traced(meshes, Material::default())
}

fn shaded(scene: &TracedScene, size: [usize; 2], radius: f32, parameters: ScreenTruthParameters) -> Planes {
    from(scene, &camera(), size, radius, parameters)
}

fn from(
    scene: &TracedScene,
    camera: &Camera,
    [height, width]: [usize; 2],
    radius: f32,
    parameters: ScreenTruthParameters,
) -> Planes {
    let gbuffer = gbuffer::render(scene, camera, height, width, &[Attribute::Valid]);
    let frame = Frame { scene, camera, gbuffer: &gbuffer, radius, seed: 3 };
    parameters.shade(&frame, Repeats::ONCE).expect("an image").image
}

fn truth(scene: &TracedScene, camera: &Camera, size: [usize; 2], radius: f32) -> Planes {
    path::render(Effect::Ao, &Shot::new(scene, camera, size, radius), Sampling::one(1024, 3)).mean
}

fn darkest(image: &Planes) -> f32 {
    image.data().iter().fold(1.0f32, |a, b| a.min(*b))
}

/// A square around a point.
fn wide(middle: Vec3, normal: Vec3, half: f32) -> Mesh {
    let axes = sampler::frame(normal);
    let (right, up) = (axes.x_axis * half, axes.y_axis * half);
    quad([-right - up, right - up, right + up, up - right].map(|corner| middle + corner))
}

/// The plane of [`below_disk`].
fn background() -> Mesh {
    wide(Vec3::new(0.0, 0.0, -5.0), Vec3::Z, 9.0)
}

/// A disk that faces the camera, as large as that of [`below_disk`].
fn disk(z: f32) -> Mesh {
    let segments = 256;
    let rim = |i: u32| (0.5 * Vec2::from_angle(TAU * i as f32 / segments as f32)).extend(z);
    Mesh {
        positions: std::iter::once(Vec3::Z * z).chain((0..segments).map(rim)).collect(),
        triangles: (0..segments).map(|i| [0, 1 + i, 1 + (i + 1) % segments]).collect(),
        ..Mesh::default()
    }
}

fn wall() -> Mesh {
    quad([(-900., -1.5), (900., -1.5), (900., 0.), (-900., 0.)].map(|(x, y)| Vec3::new(x, y, -4.2)))
}

const SIZE: [usize; 2] = [receiver::HEIGHT, receiver::WIDTH];

#[test]
fn a_plane_is_open_however_it_is_tilted_and_so_is_a_sphere() {
    for normal in [Vec3::Z, Vec3::new(0.5, 0.3, 1.0), Vec3::new(-2.0, 1.0, 1.0), Vec3::new(0.0, 6.0, 1.0)] {
        let plane = scene(vec![wide(Vec3::new(0.0, 0.0, -4.0), normal.normalize(), 50.0)]);
        for layers in [1, 2] {
            let parameters = ScreenTruthParameters { layers, samples: 256, ..PLAIN };
            assert_eq!(darkest(&shaded(&plane, [HEIGHT, WIDTH], 1.5, parameters)), 1.0, "normal {normal}");
        }
    }
    let ball = scene(vec![sphere(Vec3::new(0.2, 0.1, -4.0), 1.3)]);
    assert_eq!(darkest(&shaded(&ball, [HEIGHT, WIDTH], 1.5, PLAIN)), 1.0);
}

#[test]
fn a_floor_beside_a_wall_has_its_integral() {
    let room = scene(vec![wide(-1.5 * Vec3::Y, Vec3::Y, 90.0), wall()]);
    for radius in [1.2, 0.9] {
        let seen = receiver::Receiver { radius, ..beside_wall() };
        let image = shaded(&room, SIZE, radius, PLAIN);
        assert_eq!(seen.compare(&image, |met| 1.0 - met, 0.02), Ok(()));
        assert!(beside_wall().compare(&image, |met| 1.0 - met, 0.02).is_ok() == (radius == 1.2));
    }
}

#[test]
fn a_disk_above_a_plane_lets_light_pass_behind_it() {
    let hovering = scene(vec![background(), disk(-4.4)]);
    for layers in [1, 2] {
        let image = shaded(&hovering, SIZE, 1.5, ScreenTruthParameters { layers, ..PLAIN });
        assert_eq!(below_disk().compare(&image, |met| 1.0 - met, 0.02), Ok(()), "{layers} layers");
        assert!(below_disk().compare(&image, |met| 1.0 - 0.9 * met, 0.02).is_err());
    }
}

#[test]
fn what_hides_behind_something_is_known_with_a_second_layer_alone() {
    let stacked = scene(vec![background(), disk(-4.4), disk(-4.7)]);
    let truth = truth(&stacked, &camera(), SIZE, 1.5);
    assert!(below_disk().compare(&truth, |met| 1.0 - met, 0.02).is_err(), "the lower disk occludes");
    let [one, two] =
        [1, 2].map(|layers| shaded(&stacked, SIZE, 1.5, ScreenTruthParameters { layers, ..PLAIN }));
    assert_eq!(below_disk().compare(&one, |met| 1.0 - met, 0.02), Ok(()), "the upper one alone");
    let [one, two] = [one, two].map(|image| mean_difference(&image, &truth));
    assert!(two < 0.002 && one > 5.0 * two, "one layer {one}, two {two}");
}

#[test]
fn what_is_beside_the_image_is_known_with_a_guard_band_alone() {
    let beyond = 5.0 * (0.5 * camera().vertical_fov).tan() * 1.05 * WIDTH as f32 / HEIGHT as f32;
    let side = [(-9., -5.), (9., -5.), (9., -4.6), (-9., -4.6)].map(|(y, z)| Vec3::new(beyond, y, z));
    let screened = scene(vec![background(), quad(side)]);
    assert_eq!(darkest(&shaded(&screened, [HEIGHT, WIDTH], 1.0, PLAIN)), 1.0);
    // The wall is seen at a grazing angle: of few pixels its end would be a large part.
    let size = [3 * HEIGHT, 3 * WIDTH];
    let truth = truth(&screened, &camera(), size, 1.0);
    assert!(darkest(&truth) < 0.9);
    let [without, with] =
        [0.0, 0.1].map(|guard| shaded(&screened, size, 1.0, ScreenTruthParameters { guard, ..PLAIN }));
    let (without, with) = (mean_difference(&without, &truth), mean_difference(&with, &truth));
    assert!(with < 0.1 * without, "without {without}, with {with}");
}

#[test]
fn where_all_is_seen_it_is_truth_and_where_something_hides_it_is_not() {
    let (room, view) = (corner(), Camera::look_at(Vec3::new(4.0, 3.0, 5.0), Vec3::splat(0.8)));
    let size = [HEIGHT, WIDTH];
    let right = truth(&room, &view, size, 1.0);
    let found = mean_difference(&from(&room, &view, size, 1.0, PLAIN), &right);
    let white = mean_difference(&Planes::filled(1, HEIGHT, WIDTH, 1.0), &right);
    assert!(found < 0.003 && white > 10.0 * found, "{found}, white {white}");
    // The control: a disk that another one hides.
    let stacked = scene(vec![background(), disk(-4.4), disk(-4.7)]);
    let hidden = truth(&stacked, &camera(), size, 1.5);
    let [one, two] = [1, 2].map(|layers| {
        mean_difference(&shaded(&stacked, size, 1.5, ScreenTruthParameters { layers, ..PLAIN }), &hidden)
    });
    assert!(one > 3.0 * two, "one layer {one}, two {two}");
}

#[test]
fn surfaces_go_on_behind_others_and_end_where_they_do() {
    let hovering = scene(vec![background(), disk(-4.4)]);
    let view = camera();
    let eye = Eye { scene: &hovering, camera: &view, height: HEIGHT, width: WIDTH };
    let covered = |layers: usize| {
        let screen = Screen::new(&eye, [0, 0], layers);
        let shown = proxy::scene(&eye, &screen).expect("memory").expect("triangles");
        let mesh = &shown.scene().meshes[0];
        let of_plane = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle);
            let spans = (a.z - b.z).abs().max((a.z - c.z).abs());
            assert!(spans < 1e-4, "a triangle between disk and plane: {a} {b} {c}");
            let is_square = mesh.triangles[triangle][0] as usize >= screen.points().len();
            if a.z > -4.9 || is_square { 0.0 } else { 0.5 * (b - a).cross(c - a).length() }
        };
        (0..mesh.triangles.len()).map(of_plane).sum::<f32>()
    };
    let all = ((HEIGHT - 1) * (WIDTH - 1)) as f32 * eye.footprint(5.0).powi(2);
    assert!((covered(2) / all - 1.0).abs() < 1e-4, "of {all}: {}", covered(2));
    let shadow = 0.25 * PI * (5.0f32 / 4.4).powi(2);
    let missing = all - covered(1);
    assert!(missing > shadow && missing < 2.0 * shadow, "behind the disk: {missing}, its shadow {shadow}");
}

#[test]
fn a_thing_of_one_pixel_is_as_large_as_the_pixel() {
    let (height, width) = (9, 9);
    let view = camera();
    let dot = scene(vec![wide(Vec3::new(0.0, 0.0, -4.0), Vec3::Z, 0.1)]);
    let eye = Eye { scene: &dot, camera: &view, height, width };
    let shown = proxy::scene(&eye, &Screen::new(&eye, [0, 0], 1)).expect("memory").expect("triangles");
    let edge = eye.footprint(4.0);
    assert!(edge > 0.2 && (shown.bounds().size() - Vec3::new(edge, edge, 0.0)).length() < 1e-5);
    let away = Camera { position: Vec3::new(0.0, 0.0, -9.0), ..view };
    let eye = Eye { camera: &away, ..eye };
    assert!(proxy::scene(&eye, &Screen::new(&eye, [0, 0], 2)).expect("memory").is_none());
    assert_eq!(darkest(&from(&dot, &away, [height, width], 1.0, PLAIN)), 1.0);
}

#[test]
fn a_floor_seen_along_itself_is_one_surface_behind_a_wire_as_well() {
    let view = camera();
    let floor = wide(-0.2 * Vec3::Y, Vec3::Y, 90.0);
    let post = quad([(0.0, -1.0), (0.01, -1.0), (0.01, 1.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, -2.0)));
    let of = |meshes: Vec<Mesh>| {
        let scene = scene(meshes);
        let eye = Eye { scene: &scene, camera: &view, height: 40, width: 60 };
        let screen = Screen::new(&eye, [0, 0], 1);
        let links = links::Links::new(&eye, &screen);
        let row = 34;
        let joins = |x: usize, step: usize| {
            let node = |x: usize| links::Node { x, y: row, layer: 0 };
            links.joins(node(x), node(x + step)) && links.surround(node(x))
        };
        (1..58).filter(|x| !joins(*x, 1)).count()
    };
    assert_eq!(of(vec![floor.clone()]), 0);
    assert_eq!(of(vec![floor, post]), 0);
}

#[test]
fn noise_is_not_that_of_truth_of_the_same_seed() {
    let room = scene(vec![wide(-1.5 * Vec3::Y, Vec3::Y, 90.0), wall()]);
    let (view, size) = (camera(), [HEIGHT, WIDTH]);
    let taken = |seed: u32, samples: u32| {
        path::render(Effect::Ao, &Shot::new(&room, &view, size, 1.2), Sampling::one(samples, seed)).mean
    };
    // Equal seeds would leave nothing between them but what the mesh makes of the scene.
    let found = shaded(&room, size, 1.2, ScreenTruthParameters { samples: 16, ..PLAIN });
    let (same, other) = (mean_difference(&found, &taken(3, 16)), mean_difference(&found, &taken(99, 16)));
    assert!((0.8..1.25).contains(&(same / other)), "{same} is not {other}");
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    let stacked = scene(vec![background(), disk(-4.4), disk(-4.7)]);
    let parameters = ScreenTruthParameters { layers: 2, guard: 0.1, samples: 16 };
    let image = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| shaded(&stacked, [37, 51], 1.0, parameters))
    };
    assert_eq!(image(1), image(3));
}
