//! Shells against brute force, closed forms, and the passes against the plain version.

mod directional;
mod glossy;
mod scattering;

use super::indirect::INDIRECT;
use super::reference::{self, LIGHT, brute_force, form_factor, level_sums, openness};
use super::{MOST_LEVELS, SurfelParameters, occlusion, shells, splat};
use crate::method::{Frame, Method, Repeats};
use crate::methods::disks::{Disks, Plain};
use crate::methods::proving::beyond::{
    corner, disk_mesh, prove_twin, scene_of, seen, shaded_by_surfels, sphere_mesh,
};
use crate::methods::proving::{Tolerance, agree, camera, gbuffer_of, plane, prove_comparator, view};
use crate::methods::{Quality, Surface, blur};
use crate::scene::procedural::Family;
use crate::scene::{Camera, Mesh, Scene};
use crate::screen::{ScreenMethod, View};
use crate::surfels;
use crate::surfels::reference::Disk;
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::Gpu;
use glam::{IVec2, UVec2, Vec3};

/// Surfels as fine as tests can afford, without a blur.
const SHARP: SurfelParameters = SurfelParameters {
    surfels: surfels::SurfelDensity { scale: 0.02, near: 0.25 },
    threshold: 0.06,
    levels: 4,
    blur: blur::BlurParameters { radius: 0, sharpness: 512.0 },
};

#[test]
fn every_level_is_a_permutation() {
    for level in 0..MOST_LEVELS {
        for key in [0, 1, 0x1234_5678, u32::MAX] {
            let count = 1u32 << (2 * level);
            let mut found: Vec<u32> = (0..count).map(|number| shells::permuted(number, level, key)).collect();
            found.sort_unstable();
            assert!(found.into_iter().eq(0..count), "level {level}, key {key}");
        }
        let size = 2 << level;
        let mut pixels: Vec<[u32; 2]> = (0..1u32 << (2 * level))
            .flat_map(|sub| {
                (0..4).map(move |place| {
                    shells::pixel(sub, UVec2::new(place % 2, place / 2), level, 5).to_array()
                })
            })
            .collect();
        pixels.sort_unstable();
        assert!(
            pixels.into_iter().eq((0..size).flat_map(|x| (0..size).map(move |y| [x, y]))),
            "level {level}"
        );
    }
}

/// A floor at y = -1 and disks above it at random places, seen from the origin.
fn floor_under_disks() -> (Surface, Vec<Disk>) {
    let gbuffer = gbuffer_of(24, 32, |ray| plane(ray, Vec3::new(0.0, -1.0, 0.0), Vec3::Y));
    let number = |i: u32, of: u32| deepshade_shaders::random::random(i, of, 3, 0);
    let disk = |i| Disk {
        place: Vec3::new(4.0 * number(i, 0) - 2.0, number(i, 1) - 0.9, -1.5 - 4.0 * number(i, 2)),
        radius: 0.02 + 0.02 * number(i, 3),
        normal: Vec3::new(number(i, 4) - 0.5, number(i, 5) - 0.5, number(i, 6) - 0.5).normalize(),
        open: true,
        patch: i,
        sent: [Vec3::ZERO; 2],
    };
    (Surface::of(&gbuffer).expect("a surface"), (0..3000).map(disk).collect())
}

fn levels_of(surface: &Surface, disks: &[Disk], parameters: &SurfelParameters, view: &View) -> Planes {
    let mut sum = Planes::filled(1, surface.height, surface.width, 0.0);
    for level in 0..parameters.levels {
        let one = level_sums(surface, disks, reference::OCCLUSION, &shells::level(parameters, level, view));
        sum.data_mut().iter_mut().zip(one.data()).for_each(|(sum, value)| *sum += value);
    }
    sum
}

#[test]
fn without_a_threshold_levels_are_brute_force() {
    let (surface, disks) = floor_under_disks();
    let parameters = SurfelParameters { threshold: 1e-9, ..SHARP };
    let sum = levels_of(&surface, &disks, &parameters, &view(24, 32, 3.0));
    let right = brute_force(&surface, &disks, reference::OCCLUSION, 3.0);
    assert_eq!(agree(&sum, &right, Tolerance { usual: 1e-5, worst: 1e-4 }), Ok(()));
}

#[test]
fn shells_are_brute_force_in_the_mean() {
    let (surface, disks) = floor_under_disks();
    let right = brute_force(&surface, &disks, reference::OCCLUSION, 3.0);
    for threshold in [SHARP.threshold, 0.5] {
        let parameters = SurfelParameters { threshold, ..SHARP };
        let seeds = 64;
        let mut sum = vec![[0.0f64; 2]; right.data().len()];
        for seed in 0..seeds {
            let shells = levels_of(&surface, &disks, &parameters, &View { seed, ..view(24, 32, 3.0) });
            for (sums, value) in sum.iter_mut().zip(shells.data()) {
                sums[0] += f64::from(*value);
                sums[1] += f64::from(*value * *value);
            }
        }
        let seeds = f64::from(seeds);
        let (mut bias, mut noise_of_bias, mut total) = (0.0, 0.0, 0.0);
        for (sums, right) in sum.iter().zip(right.data()) {
            let mean = sums[0] / seeds;
            let variance = (sums[1] / seeds - mean * mean).max(0.0) / seeds;
            let off = mean - f64::from(*right);
            assert!(off.abs() < 6.0 * variance.sqrt() + 0.01, "{mean} in place of {right}");
            bias += off;
            noise_of_bias += variance;
            total += f64::from(*right);
        }
        assert!(bias.abs() < 3.0 * noise_of_bias.sqrt(), "{threshold}: {} of {total}", bias);
    }
}

/// What is occluded of an upward hemisphere at a point, by brute force over the surfels of a scene.
fn occluded_at(scene: &Scene, at: Vec3, scale: f32) -> f32 {
    let parameters = surfels::SurfelDensity { scale, near: 0.01 };
    let view =
        View { camera: Camera { position: Vec3::new(0.0, 0.5, 3.0), ..camera() }, ..view(96, 128, 100.0) };
    let disks = surfels::reference::surfels(scene, &parameters, &view);
    let at = at - view.camera.position;
    disks.iter().map(|disk| form_factor(disk.place - at, Vec3::Y, disk)).sum()
}

#[test]
fn closed_forms() {
    // A disk of radius r at height h above a point hides r^2 / (r^2 + h^2).
    for (radius, height) in [(0.5f32, 1.0f32), (1.0, 0.7), (0.2, 2.0)] {
        let disk = scene_of(vec![disk_mesh(Vec3::new(0.0, height, 0.0), radius)]);
        let (found, right) =
            (occluded_at(&disk, Vec3::ZERO, 0.004), radius * radius / (radius * radius + height * height));
        assert!((found / right - 1.0).abs() < 0.02, "disk {radius} at {height}: {found}, not {right}");
        let sheets = scene_of(
            (0..3).map(|i| disk_mesh(Vec3::new(0.0, height + 1e-3 * i as f32, 0.0), radius)).collect(),
        );
        let found = occluded_at(&sheets, Vec3::ZERO, 0.004);
        assert!((found / (3.0 * right) - 1.0).abs() < 0.03, "three sheets hide three times as much: {found}");
    }
    // A wall of height H along a floor, at distance d: (1 - d / sqrt(d^2 + H^2)) / 2 where it is endless.
    let (height, half) = (1.0f32, 60.0);
    let corners =
        [(-half, 0.0), (half, 0.0), (half, height), (-half, height)].map(|(x, y)| Vec3::new(x, y, -0.5));
    let wall = scene_of(vec![Mesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }]);
    let (found, right) = (occluded_at(&wall, Vec3::ZERO, 0.003), 0.5 * (1.0 - 0.5 / (0.25f32 + 1.0).sqrt()));
    assert!((found / right - 1.0).abs() < 0.02, "wall: {found}, not {right}");
}

#[test]
fn a_sphere_hides_its_solid_angle_once() {
    // A sphere straight above hides (r / d)^2; with a hole at its top, its far half is seen from inside and
    // hides as much again.
    let mut sphere = sphere_mesh(Vec3::new(0.0, 2.0, 0.0), 0.5);
    let hidden = |mesh: Mesh| occluded_at(&scene_of(vec![mesh]), Vec3::ZERO, 0.004) * 16.0;
    let whole = hidden(sphere.clone());
    assert!((whole - 1.0).abs() < 0.03, "{whole} of what a sphere hides");
    sphere.triangles.remove(0);
    let holed = hidden(sphere);
    assert!((holed - 2.0).abs() < 0.06, "{holed} of what a sphere hides");
}

#[test]
fn the_passes_make_of_their_surfels_what_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let coarse = surfels::SurfelDensity { scale: 0.03, near: 0.25 };
    let tolerance = Tolerance { usual: 2e-3, worst: 0.1 };
    let mut method =
        ScreenMethod::new(&gpu, Disks::new(SurfelParameters::of(Quality::High), occlusion::OCCLUSION));
    for (family, [height, width], levels, threshold) in [
        (Family::StillLife, [43, 61], 4, 0.06),
        (Family::Room, [64, 48], 1, 0.2),
        (Family::Shelves, [37, 83], 6, 0.1),
    ] {
        let parameters =
            SurfelParameters { surfels: coarse, levels, threshold, ..SurfelParameters::of(Quality::High) };
        method = method.with(Disks::new(parameters, occlusion::OCCLUSION));
        let seen = seen(family, height, width);
        let (image, disks) = shaded_by_surfels(&method, &seen);
        assert!(disks.len() > 500, "{} surfels", disks.len());
        let (scene, view, gbuffer) = &seen;
        let surface = &Surface::of(gbuffer).expect("a surface");
        let plain = Plain { gbuffer, surface, scene, environment: None, parameters: &parameters, view };
        let right = (occlusion::OCCLUSION.plain)(&plain, &disks).expect("attributes");
        assert_eq!(agree(&image, &right, tolerance), Ok(()), "{family:?}");
        prove_comparator(&right, tolerance);
    }
}

#[test]
fn splats_on_the_processor_are_the_plain_version() {
    for (family, [height, width], levels, radius) in [
        (Family::StillLife, [23, 31], 4, 1.0),
        (Family::Room, [32, 24], 1, 0.3),
        (Family::Shelves, [19, 27], 6, 1.0),
    ] {
        let (scene, view, gbuffer) = seen(family, height, width);
        let view = View { radius: radius * view.radius, seed: 9, ..view };
        let parameters = SurfelParameters { levels, ..SurfelParameters::of(Quality::Low) };
        let lit = Some(surfels::SurfelLight::Reflected);
        let disks = surfels::reference::laid(&scene, &parameters.surfels, &view, lit);
        assert!(disks.iter().any(|disk| disk.sent != [Vec3::ZERO; 2]), "{family:?}");
        let surface = &Surface::of(&gbuffer).expect("a surface");
        for level in 0..levels {
            let settings = shells::level(&parameters, level, &view);
            let made = splat::level_sums(surface, &disks, &settings, view.focal_length());
            assert_eq!(made, level_sums(surface, &disks, LIGHT, &settings), "{family:?}, level {level}");
        }
        let plain = Plain {
            gbuffer: &gbuffer,
            surface,
            scene: &scene,
            environment: None,
            parameters: &parameters,
            view: &view,
        };
        let right = (INDIRECT.plain)(&plain, &disks).expect("attributes");
        let largest = right.data().iter().copied().fold(0.0, f32::max);
        assert!(largest > 0.0, "{family:?}");
        // A lamp may be faint.
        let over_largest =
            |image: &Planes| Planes::from_fn(3, height, width, |c, y, x| image.at(c, y, x) / largest);
        let tolerance = Tolerance { usual: 1e-5, worst: 1e-4 };
        let made = over_largest(&splat::light(surface, &disks, &parameters, &view));
        let right = over_largest(&right);
        assert_eq!(agree(&made, &right, tolerance), Ok(()), "{family:?}");
        prove_comparator(&right, tolerance);
    }
}

#[test]
fn an_effect_that_reaches_nowhere_does_nothing() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let (scene, view, gbuffer) = corner();
    let frame = Frame { scene: &scene, camera: &view.camera, gbuffer: &gbuffer, radius: 0.0, seed: 1 };
    let coarse = surfels::SurfelDensity { scale: 0.03, near: 0.25 };
    let parameters = SurfelParameters { surfels: coarse, ..SurfelParameters::of(Quality::High) };
    let open = ScreenMethod::new(&gpu, Disks::new(parameters, occlusion::OCCLUSION));
    let image = Method::shade(&open, &frame, Repeats::ONCE).expect("an image").image;
    assert!(image.data().iter().all(|open| *open == 1.0));
    let indirect = ScreenMethod::new(&gpu, Disks::new(parameters, INDIRECT));
    let image = indirect.shade_in_passes(&frame, Repeats::ONCE).expect("an image").image;
    assert!(image.data().iter().all(|light| *light == 0.0));
}

#[test]
fn fewer_levels_and_a_smaller_threshold_agree_with_more_of_both() {
    let (scene, view, gbuffer) = seen(Family::StillLife, 40, 56);
    let surface = Surface::of(&gbuffer).expect("a surface");
    let disks = surfels::reference::surfels(
        scene.scene(),
        &surfels::SurfelDensity { scale: 0.02, near: 0.25 },
        &view,
    );
    let shade = |threshold, levels| {
        openness(
            &surface,
            &disks,
            &SurfelParameters { threshold, levels, ..SurfelParameters::of(Quality::High) },
            &view,
        )
    };
    let exact = shade(1e-6, 1);
    let off = |image: &Planes| {
        let differences = image.data().iter().zip(exact.data()).map(|(a, b)| (a - b).abs());
        differences.sum::<f32>() / exact.data().len() as f32
    };
    let [fine, coarse] = [off(&shade(0.02, 4)), off(&shade(0.4, 4))];
    assert!(fine < 0.03 && fine < coarse, "{fine} and {coarse}");
}

#[test]
fn a_lit_wall_lights_the_floor_as_a_closed_form_says() {
    let (scene, view, gbuffer) = corner();
    let fine = surfels::SurfelDensity { scale: 0.02, near: 0.01 };
    let disks = surfels::reference::laid(&scene, &fine, &view, Some(surfels::SurfelLight::Reflected));
    let surface = Surface::of(&gbuffer).expect("a surface");
    let light = brute_force(&surface, &disks, LIGHT, 20.0);
    // A wall of height H at distance d sends radiance L: L (1 - d / sqrt(d^2 + H^2)) / 2, were it endless;
    // seen from its middle it is so within 4 %.
    let mut compared = 0;
    for (index, valid) in surface.valid.data().iter().enumerate() {
        let at = IVec2::new((index % 64) as i32, (index / 64) as i32);
        let place = view.camera.position + view.camera.rotation * surface.position_at(at);
        if *valid < 0.5 || place.y > 1e-3 || place.z.abs() > 1.0 || !(-0.5..0.7).contains(&place.x) {
            continue;
        }
        let distance = 1.0 - place.x;
        let share = 0.5 * (1.0 - distance / (distance * distance + 4.0).sqrt());
        for (channel, radiance) in [2.0, 1.0, 0.5].into_iter().enumerate() {
            let found = light.at(channel, at.y as usize, at.x as usize) / (radiance * share);
            assert!((0.9..1.05).contains(&found), "{found} of the light at {place}");
        }
        compared += 1;
    }
    assert!(compared > 200, "{compared}");
}

#[test]
fn the_passes_light_as_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let coarse = surfels::SurfelDensity { scale: 0.03, near: 0.25 };
    let parameters = SurfelParameters { surfels: coarse, levels: 4, ..SurfelParameters::of(Quality::High) };
    let method = ScreenMethod::new(&gpu, Disks::new(parameters, INDIRECT));
    // Shadow maps end within a texel of where shadows do; radiance has nine bits.
    prove_twin(&method, &corner(), Tolerance { usual: 5e-3, worst: 0.1 });
}
