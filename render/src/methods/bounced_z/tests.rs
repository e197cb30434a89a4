//! Closed forms, what hides what, and the passes against the plain version.

mod fog;
mod sky;

use super::indirect::{INDIRECT, LIGHT};
use super::occlusion::{OCCLUSION, SKY};
use super::reference::{Arriving, LEAST_SINE, PixelRay, Ray, met, number_in_square, place_on_disk, shade};
use super::{BouncedZParameters, Matte, Reflector};
use crate::bvh::TracedScene;
use crate::method::{Frame, Method, Repeats};
use crate::methods::disks::Disks;
use crate::methods::proving::beyond::{corner, disk_mesh, prove_twin, scene_of, seen};
use crate::methods::proving::{
    Tolerance, camera, gbuffer_of, mean_difference, plane, prove_comparator, still_life, view,
};
use crate::methods::surfel::reference::form_factor;
use crate::methods::{Quality, Surface, blur, surfel};
use crate::path::{self, Sampling, Shot};
use crate::scene::procedural::Family;
use crate::scene::{Camera, Scene};
use crate::screen::{ScreenMethod, View};
use crate::surfels::reference::Disk;
use crate::surfels::{self, Surfel};
use deepshade_shaders::Effect;
use deepshade_shaders::gpu::Gpu;
use glam::{IVec2, UVec2, Vec3};
use std::f32::consts::TAU;

/// Every pixel keeps its own samples.
const PLAIN: BouncedZParameters = BouncedZParameters {
    surfels: surfels::SurfelDensity { scale: 0.02, near: 0.25 },
    directions: 16,
    filter: blur::BlurParameters { radius: 0, sharpness: 512.0 },
};

#[test]
fn pixels_of_a_square_have_all_numbers() {
    for (level, seed) in [(0, 3), (1, 0), (2, 9), (4, u32::MAX)] {
        let edge = 1u32 << level;
        let pixels = (0..edge * edge).map(|i| UVec2::new(3 * edge + i % edge, 5 * edge + i / edge));
        let mut numbers: Vec<u32> = pixels.map(|pixel| number_in_square(pixel, level, seed)).collect();
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..edge * edge), "level {level}");
    }
}

#[test]
fn normals_of_surfels_are_rounded_by_less_than_the_least_angle_and_by_nearly_as_much() {
    // They are farthest off in the middle between four that there are, in the octahedron's upper half.
    let between = |i: i16| (f32::from(i) + 0.5) / 511.0;
    let middles = (-511..511).flat_map(|x| (-511..511).map(move |y| [between(x), between(y)]));
    let upper = middles.filter(|[x, y]| x.abs() + y.abs() <= 1.0);
    let off = upper.map(|[x, y]| {
        let normal = Vec3::new(x, y, 1.0 - x.abs() - y.abs()).normalize();
        normal.cross(Surfel::new(Vec3::ZERO, normal, false, 1.0, 0.5).normal()).length()
    });
    let farthest = off.fold(0.0, f32::max);
    assert!((0.0041..LEAST_SINE).contains(&farthest), "{farthest}");
}

/// Directions from points with a normal, of all pixels of an image of 32 x 32.
fn directions(parameters: &BouncedZParameters, normal: Vec3) -> impl Iterator<Item = (UVec2, Vec3)> {
    let bounces = parameters.bounces(Effect::Ao, &view(32, 32, 100.0));
    let of_pixel = move |pixel| {
        (0..bounces.directions).map(move |number| {
            let place = place_on_disk(pixel, number, [bounces.directions, bounces.seed]);
            (pixel, Matte(normal).direction(place))
        })
    };
    (0..32 * 32).map(|i| UVec2::new(i % 32, i / 32)).flat_map(of_pixel)
}

#[test]
fn directions_are_spread_by_their_cosine() {
    for normal in [Vec3::Z, -Vec3::Z, Vec3::new(0.3, -0.9, -0.2).normalize()] {
        let all: Vec<Vec3> = directions(&PLAIN, normal).map(|(_, direction)| direction).collect();
        assert!(all.iter().all(|direction| (direction.length() - 1.0).abs() < 1e-5));
        let mean = |value: &dyn Fn(&Vec3) -> f32| all.iter().map(value).sum::<f32>() / all.len() as f32;
        let tangent = normal.any_orthonormal_vector();
        // E cos = 2/3, E cos^2 = 1/2, E t = 0, E t^2 = 1/4.
        let cosine = |direction: &Vec3| direction.dot(normal);
        let along = |direction: &Vec3| direction.dot(tangent);
        for (found, right) in [
            (mean(&cosine), 2.0 / 3.0),
            (mean(&|d| cosine(d).powi(2)), 0.5),
            (mean(&along), 0.0),
            (mean(&|d| along(d).powi(2)), 0.25),
        ] {
            assert!((found - right).abs() < 5e-3, "{found} is not {right}");
        }
    }
}

/// What arrives on an upward surface at a point, the mean over the directions of many pixels.
fn arriving(what: Arriving<'_>, disks: &[Disk], origin: Vec3, parameters: &BouncedZParameters) -> Vec3 {
    let bounces = parameters.bounces(what.effect, &view(32, 32, 100.0));
    let radiance = |(pixel, direction)| {
        let ray = Ray { origin, normal: Vec3::Y, direction };
        (what.of)(met(&bounces, disks, &ray), &PixelRay { pixel, number: 0, direction })
    };
    let all: Vec<Vec3> = directions(parameters, Vec3::Y).map(radiance).collect();
    all.iter().sum::<Vec3>() / all.len() as f32
}

/// A scene's disks for a camera above and before the origin, and the origin in that camera's space.
fn laid(scene: &Scene, scale: f32) -> (Vec<Disk>, Vec3) {
    let parameters = surfels::SurfelDensity { scale, near: 0.01 };
    let camera = Camera { position: Vec3::new(0.0, 0.5, 3.0), ..camera() };
    let view = View { camera, ..view(96, 128, 100.0) };
    (surfels::reference::surfels(scene, &parameters, &view), -camera.position)
}

/// The mean over the directions of so many pixels needs no more of each.
const FEW: BouncedZParameters = BouncedZParameters { directions: 4, ..PLAIN };

/// Disks that cover a square of four metres to a side at a height, and send light downwards.
fn sheet(height: f32, sent: f32) -> Vec<Disk> {
    let disk = |i: u16| Disk {
        place: Vec3::new(f32::from(i % 40) * 0.1 - 1.95, height, f32::from(i / 40) * 0.1 - 1.95),
        radius: 0.058,
        normal: -Vec3::Y,
        open: true,
        patch: 0,
        sent: [Vec3::splat(sent), Vec3::ZERO],
    };
    (0..1600).map(disk).collect()
}

/// What a horizontal square of four metres to a side hides, from below its middle: four times a corner's form
/// factor.
fn hidden_by_sheet(height: f32) -> f32 {
    let side = 2.0 / height;
    let slant = (1.0 + side * side).sqrt();
    4.0 * 2.0 * side / slant * (side / slant).atan() / TAU
}

#[test]
fn sheets_behind_one_another_occlude_like_one() {
    for height in [0.5f32, 1.0, 3.0] {
        let right = hidden_by_sheet(height);
        for count in [1u8, 3] {
            let disks: Vec<Disk> =
                (0..count).flat_map(|i| sheet(height + 1e-3 * f32::from(i), 0.0)).collect();
            let hidden = 1.0 - arriving(SKY, &disks, Vec3::ZERO, &FEW).x;
            assert!((hidden - right).abs() < 0.03, "{count} at {height}: {hidden}, not {right}");
            let factor = |disk: &Disk| form_factor(disk.place, Vec3::Y, disk);
            let added: f32 = disks.iter().map(factor).sum();
            assert!(added > 0.97 * f32::from(count) * right, "{added} without visibility");
        }
    }
}

#[test]
fn surfels_of_a_sheet_have_few_holes_and_more_sheets_close_them() {
    for (radius, height) in [(0.5f32, 1.0f32), (1.0, 0.7), (0.3, 1.0)] {
        // A disk of radius r at height h above a point hides r^2 / (r^2 + h^2).
        let right = radius * radius / (radius * radius + height * height);
        let hidden = |count: u8| {
            let sheet = |i| disk_mesh(Vec3::new(0.0, height + 1e-3 * f32::from(i), 0.0), radius);
            let (disks, origin) = laid(&scene_of((0..count).map(sheet).collect()), 0.01);
            (1.0 - arriving(SKY, &disks, origin, &FEW).x) / right
        };
        let [one, three] = [1, 3].map(hidden);
        assert!((0.75..1.03).contains(&one), "one of {radius} at {height}: {one}");
        assert!(three > one && (0.95..1.06).contains(&three), "three of {radius} at {height}: {three}");
    }
}

#[test]
fn a_dark_sheet_hides_a_bright_one() {
    let (dark, bright) = (sheet(0.5, 0.0), sheet(0.8, 1.0));
    let alone = arriving(LIGHT, &bright, Vec3::ZERO, &FEW).x;
    let hidden = arriving(LIGHT, &[dark, bright].concat(), Vec3::ZERO, &FEW).x;
    assert!(alone > 0.8 && hidden < 0.01, "{alone} alone, {hidden} behind another");
    let (near, far) = (sheet(0.5, 1.0), sheet(0.8, 7.0));
    let of_near = arriving(LIGHT, &near, Vec3::ZERO, &FEW).x;
    let of_both = arriving(LIGHT, &[far, near].concat(), Vec3::ZERO, &FEW).x;
    assert!((of_near - of_both).abs() < 0.02, "{of_near} of the nearer, {of_both} of both");
}

#[test]
fn surfels_send_on_the_side_that_is_seen() {
    let turned = |disk: Disk| Disk { normal: -disk.normal, ..disk };
    let turned: Vec<Disk> = sheet(0.5, 1.0).into_iter().map(turned).collect();
    assert_eq!(arriving(LIGHT, &turned, Vec3::ZERO, &FEW), Vec3::ZERO);
}

#[test]
fn a_lit_wall_lights_the_floor_as_a_closed_form_says() {
    let (scene, view, gbuffer) = corner();
    let fine = surfels::SurfelDensity { scale: 0.02, near: 0.01 };
    let disks = surfels::reference::laid(&scene, &fine, &view, Some(surfels::SurfelLight::Reflected));
    let surface = Surface::of(&gbuffer).expect("a surface");
    let filter = blur::BlurParameters { radius: 2, sharpness: 512.0 };
    let image = shade(
        &surface,
        &Matte::all_over(&surface),
        &disks,
        &LIGHT,
        (&BouncedZParameters { directions: 4, filter, ..PLAIN }, &view),
    );
    // A wall of height H at distance d sends radiance L: L (1 - d / sqrt(d^2 + H^2)) / 2, were it endless;
    // seen from its middle it is so within 4 %.
    let (mut found, mut right, mut compared) = (Vec3::ZERO, Vec3::ZERO, 0);
    for at in (0..48).flat_map(|y| (0..64).map(move |x| IVec2::new(x, y))) {
        let place = view.camera.position + view.camera.rotation * surface.position_at(at);
        let is_measured = place.y < 1e-3 && place.z.abs() < 1.0 && (-0.5..0.7).contains(&place.x);
        if !surface.valid_at(at) || !is_measured {
            continue;
        }
        let distance = 1.0 - place.x;
        let share = 0.5 * (1.0 - distance / (distance * distance + 4.0).sqrt());
        let light = Vec3::from_array([0, 1, 2].map(|c| image.at(c, at.y as usize, at.x as usize)));
        (found, right, compared) = (found + light, right + share * Vec3::new(2.0, 1.0, 0.5), compared + 1);
    }
    assert!(compared > 200, "{compared}");
    // Some of it is lost through holes.
    let ratio = found / right;
    assert!(ratio.cmpgt(Vec3::splat(0.8)).all() && ratio.cmplt(Vec3::splat(1.03)).all(), "{ratio}");
}

/// A surface that is anything but flat.
fn bumpy() -> Surface {
    Surface::of(&still_life(40, 56)).expect("a surface")
}

#[test]
fn the_filter_keeps_an_even_sky() {
    let image = shade(
        &bumpy(),
        &Matte::all_over(&bumpy()),
        &[],
        &SKY,
        (&BouncedZParameters::of(Quality::High), &view(40, 56, 1.0)),
    );
    assert!(image.data().iter().all(|open| (open - 1.0).abs() < 1e-5));
}

#[test]
fn the_filter_removes_noise() {
    let gbuffer = gbuffer_of(24, 32, |ray| plane(ray, Vec3::new(0.0, -1.0, 0.0), Vec3::Y));
    let surface = Surface::of(&gbuffer).expect("a surface");
    let disks: Vec<Disk> = sheet(0.6, 1.0)
        .into_iter()
        .map(|disk| Disk { place: disk.place - Vec3::new(1.0, 1.0, 4.0), ..disk })
        .collect();
    let view = view(24, 32, 9.0);
    let shaded = |directions, radius| {
        let filter = blur::BlurParameters { radius, sharpness: 512.0 };
        shade(
            &surface,
            &Matte::all_over(&surface),
            &disks,
            &SKY,
            (&BouncedZParameters { directions, filter, ..PLAIN }, &view),
        )
    };
    let right = shaded(1024, 0);
    let [noisy, filtered] = [0, 3].map(|radius| mean_difference(&shaded(4, radius), &right));
    assert!(filtered < 0.7 * noisy, "{filtered} of {noisy}");
    prove_comparator(&right, Tolerance { usual: 2e-3, worst: 0.1 });
}

#[test]
fn the_passes_make_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let coarse = surfels::SurfelDensity { scale: 0.05, near: 0.25 };
    let mut method = ScreenMethod::new(&gpu, Disks::new(BouncedZParameters::of(Quality::High), OCCLUSION));
    for (family, [height, width], directions) in
        [(Family::StillLife, [27, 35], 3), (Family::Room, [24, 32], 16), (Family::Shelves, [21, 43], 1)]
    {
        let parameters =
            BouncedZParameters { surfels: coarse, directions, ..BouncedZParameters::of(Quality::High) };
        method = method.with(Disks::new(parameters, OCCLUSION));
        // A ray that just meets a disk in one may just miss it in the other: 0.0047 on an H100.
        prove_twin(&method, &seen(family, height, width), Tolerance { usual: 5e-3, worst: 0.1 });
    }
}

#[test]
fn the_passes_light_as_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let surfels = surfels::SurfelDensity { scale: 0.03, near: 0.25 };
    let parameters = BouncedZParameters { surfels, ..BouncedZParameters::of(Quality::High) };
    let method = ScreenMethod::new(&gpu, Disks::new(parameters, INDIRECT));
    // Shadow maps end within a texel of where shadows do; radiance has nine bits.
    prove_twin(&method, &corner(), Tolerance { usual: 5e-3, worst: 0.1 });
}

#[test]
fn where_nothing_is_met_all_is_open() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let (scene, view, gbuffer) = seen(Family::StillLife, 24, 32);
    let method = ScreenMethod::new(&gpu, Disks::new(BouncedZParameters::of(Quality::High), OCCLUSION));
    let frame = Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: 0.0, seed: 1 };
    let image = method.shade(&frame, Repeats::ONCE).expect("an image").image;
    assert!(image.data().iter().all(|open| (open - 1.0).abs() < 1e-6), "an effect that reaches nowhere");
    let elsewhere = TracedScene::new(scene_of(vec![disk_mesh(Vec3::splat(1e4), 1.0)])).expect("a disk");
    let image = method.shade(&Frame { scene: &elsewhere, radius: 1.0, ..frame }, Repeats::ONCE);
    let image = image.expect("an image").image;
    assert!(image.data().iter().all(|open| (open - 1.0).abs() < 1e-6), "no surfels");
}

#[test]
fn it_is_nearer_to_truth_than_what_adds_all_surfels_up() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    for family in [Family::StillLife, Family::Room] {
        let (scene, view, gbuffer) = seen(family, 96, 128);
        let frame =
            Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: view.radius, seed: 1 };
        let shot = Shot::new(&scene, &view.camera, [96, 128], view.radius);
        let truth = path::render(Effect::Ao, &shot, Sampling::one(128, 1)).mean;
        let off = |method: &dyn Method| {
            mean_difference(&method.shade(&frame, Repeats::ONCE).expect("an image").image, &truth)
        };
        let bounced = ScreenMethod::new(&gpu, Disks::new(BouncedZParameters::of(Quality::High), OCCLUSION));
        let surfel = ScreenMethod::new(
            &gpu,
            Disks::new(surfel::SurfelParameters::of(Quality::High), surfel::occlusion::OCCLUSION),
        );
        let [near, far] = [off(&bounced), off(&surfel)];
        assert!(near < 0.09 && near < 0.7 * far, "{family:?}: {near} off, all surfels {far}");
    }
}
