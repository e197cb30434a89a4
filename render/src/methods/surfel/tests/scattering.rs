//! Scattering by surfels: shares against the profile's integral, a step of light against its closed form,
//! slabs against what is known to go through, bodies apart, and the passes against the plain version.

use super::super::reference::{Receiver, Shade, sums};
use super::super::scattering::{SCATTERING, SUPPORT, Side, given, met_from_within, scattered, shape};
use super::*;
use crate::bvh::TracedScene;
use crate::gbuffer;
use crate::methods::proving::mean_difference;
use crate::methods::separable::kernel;
use crate::path::proving::quad;
use crate::path::{self, Sampling, Shot};
use crate::scene::{Light, Material, MaterialId};
use deepshade_shaders::random::random;
use deepshade_shaders::{Attribute, Effect, GBuffer};
use std::f32::consts::PI;

type ViewedScene = (TracedScene, View, GBuffer);

const SIZE: usize = 64;
/// What the images of sheets show of them, metres; a pixel is a 64th of it.
const EDGE: f32 = 0.1;
const PIXEL: f32 = EDGE / SIZE as f32;

/// What a camera sees of a scene, with all that scattering reads.
fn looked_at(scene: Scene, camera: Camera, [height, width]: [usize; 2], radius: f32) -> ViewedScene {
    let scene = TracedScene::new(scene).expect("triangles");
    let gbuffer = gbuffer::render(&scene, &camera, height, width, &Attribute::ALL);
    (scene, View { camera, ..view(height, width, radius) }, gbuffer)
}

/// From straight above, so far away that all pixels show the same area.
fn from_above() -> Camera {
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 10.0), Vec3::ZERO);
    Camera { vertical_fov: 2.0 * (0.5 * EDGE / 10.0).atan(), ..camera }
}

/// A rectangle at a height `z`, from one x to another, its front up.
fn sheet([from, to]: [f32; 2], z: f32, material: u32) -> Mesh {
    let corners = [(from, -0.2), (to, -0.2), (to, 0.2), (from, 0.2)];
    Mesh { material: MaterialId(material), ..quad(corners.map(|(x, y)| Vec3::new(x, y, z))) }
}

fn sun(direction: Vec3) -> Light {
    Light::Directional { direction, irradiance: Vec3::splat(PI), pattern: None }
}

fn wax(colour: f32, mean_free_path: Vec3) -> Material {
    Material { mean_free_path, ..Material::matte("wax", Vec3::splat(colour)) }
}

/// A white plane in even light.
fn plane_of(mean_free_path: Vec3) -> Scene {
    Scene {
        meshes: vec![sheet([-0.2, 0.2], 0.0, 0)].into(),
        materials: vec![wax(1.0, mean_free_path)],
        lights: vec![sun(Vec3::NEG_Z)],
        ..Scene::default()
    }
}

fn parameters(scale: f32, levels: u32) -> SurfelParameters {
    SurfelParameters { surfels: surfels::SurfelDensity { scale, near: 0.25 }, levels, ..SHARP }
}

fn plain((scene, view, gbuffer): &ViewedScene, parameters: &SurfelParameters) -> Planes {
    let surface = &Surface::of(gbuffer).expect("a surface");
    let disks =
        surfels::reference::laid(scene, &parameters.surfels, view, Some(surfels::SurfelLight::Received));
    let plain = Plain { gbuffer, surface, scene, environment: None, parameters, view };
    (SCATTERING.plain)(&plain, &disks).expect("attributes")
}

fn image(method: &ScreenMethod, (scene, view, gbuffer): &ViewedScene) -> Planes {
    let frame = Frame { scene, camera: &view.camera, gbuffer, radius: view.radius, seed: view.seed };
    Method::shade(method, &frame, Repeats::ONCE).expect("an image").image
}

/// The share of the profile within a distance, lengths.
fn within(distance: f32) -> f32 {
    1.0 - 0.25 * (-distance).exp() - 0.75 * (-distance / 3.0).exp()
}

/// What surfels of a plane give its pixels by a profile of these lengths, where `light` says what falls on
/// them; and the surfels.
fn given_by_a_plane(
    lengths: Vec3,
    parameters: &SurfelParameters,
    light: impl Fn(Vec3) -> Vec3 + Sync,
) -> (Planes, Vec<Disk>) {
    let (scene, view, gbuffer) = looked_at(plane_of(Vec3::ONE), from_above(), [SIZE; 2], 0.1);
    let surface = Surface::of(&gbuffer).expect("a surface");
    let disks = surfels::reference::surfels(scene.scene(), &parameters.surfels, &view);
    let lit = |disk: Disk| Disk { sent: [light(disk.place), Vec3::ZERO], ..disk };
    let disks: Vec<Disk> = disks.into_iter().map(lit).collect();
    let gives = |disk: &Disk, _: f32, way: Vec3, _: Receiver| given(disk, way, Vec3::Z, lengths);
    let reach = |_: IVec2| SUPPORT * lengths.max_element();
    let shade = Shade { reach: &reach, of: &gives };
    (sums(&surface, &disks, shade, parameters, &view), disks)
}

#[test]
fn shares_of_a_plane_add_up_to_the_profile_at_all_sizes_and_over_all_levels() {
    for (scale, levels) in [(0.01, 1), (0.01, 4), (0.02, 3), (0.04, 1), (0.04, 3)] {
        let lengths = Vec3::new(3.0, 1.5, 0.5) * PIXEL;
        let (sums, disks) = given_by_a_plane(lengths, &parameters(scale, levels), |_| Vec3::new(3., 2., 1.));
        let mean = |channel: usize| sums.plane(channel).iter().sum::<f32>() / (SIZE * SIZE) as f32;
        let areas = disks.iter().map(|disk| disk.radius * disk.radius).sum::<f32>();
        for c in 0..3 {
            // What is nearer than a surfel is large is left out, and a thousandth beyond the support of the
            // longest.
            let beyond = |disk: &Disk| disk.radius * disk.radius * (1.0 - within(disk.radius / lengths[c]));
            let wanted = disks.iter().map(beyond).sum::<f32>() / areas;
            let found = mean(c + 3);
            assert!((found - wanted).abs() < 0.02, "{scale}, {levels} levels, {c}: {found}, not {wanted}");
            let light = mean(c) / found;
            assert!((light - (3 - c) as f32).abs() < 1e-4, "{light}");
        }
    }
}

#[test]
fn even_light_stays_as_it_is() {
    let seen = looked_at(plane_of(Vec3::new(0.02, 0.002, 0.0)), from_above(), [SIZE; 2], 0.1);
    for (scale, levels) in [(0.01, 4), (0.04, 2)] {
        let image = plain(&seen, &parameters(scale, levels));
        let off = image.data().iter().map(|light| (light - 1.0).abs()).fold(0.0, f32::max);
        assert!(off < 1e-4, "{scale}: {off}");
    }
}

#[test]
fn a_step_of_light_becomes_the_integral_of_the_profile() {
    let lengths = Vec3::new(4.0, 2.0, 1.0);
    let right = |place: Vec3| if place.x > 0.0 { Vec3::ONE } else { Vec3::ZERO };
    let (sums, _) = given_by_a_plane(lengths * PIXEL, &parameters(0.01, 4), right);
    let mut noticed = 0.0f64;
    for channel in 0..2 {
        for x in 16..48 {
            let from_edge = x as f64 + 0.5 - 32.0;
            let column = |c: usize| (0..SIZE).map(|y| f64::from(sums.at(c, y, x))).sum::<f64>() / SIZE as f64;
            let own = if x < 32 { 0.0 } else { 1.0 };
            let found = own * (1.0 - column(channel + 3)) + column(channel);
            let lit = |length: f64| {
                let beyond = kernel::beyond(from_edge.abs() / length);
                if from_edge > 0.0 { 1.0 - beyond } else { beyond }
            };
            let length = f64::from(lengths[channel]);
            let off = (found - lit(length)).abs();
            assert!(off < 0.025, "{channel} at {x}: {found}, not {}", lit(length));
            noticed = noticed.max((found - lit(1.3 * length)).abs());
        }
    }
    assert!(noticed > 0.03, "a profile wider by three tenths is noticed: {noticed}");
}

/// A slab of white wax, so many mean free paths thick, lit from one side; its two sides are one mesh.
fn slab(paths: f32, light: Light) -> ViewedScene {
    let thickness = 0.01;
    let side =
        |z: f32| [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(0.5 * x, 0.5 * y, z));
    let positions = [side(0.0), side(-thickness)].concat();
    let mesh =
        Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]], ..Mesh::default() };
    let scene = Scene {
        meshes: vec![mesh].into(),
        materials: vec![wax(1.0, Vec3::splat(thickness / paths))],
        lights: vec![light],
        ..Scene::default()
    };
    looked_at(scene, from_above(), [24; 2], 0.4)
}

#[test]
fn a_slab_lets_through_its_share_and_loses_nothing() {
    // Known by Heaslet and Warming 1965, as truth's own test has it.
    for (paths, known) in [(0.5, 0.7040), (1.0, 0.5532), (2.0, 0.3900)] {
        // Without a blur some pixels give more than they have.
        let parameters =
            SurfelParameters { blur: SurfelParameters::of(Quality::High).blur, ..parameters(0.02, 4) };
        let mean = |direction| {
            let image = plain(&slab(paths, sun(direction)), &parameters);
            image.data().iter().sum::<f32>() / image.data().len() as f32
        };
        let [through, back] = [Vec3::Z, Vec3::NEG_Z].map(mean);
        let (scene, view, _) = slab(paths, sun(Vec3::Z));
        let mut turned = scene.scene().clone();
        turned.meshes.iter_mut().flat_map(|mesh| &mut mesh.triangles).for_each(|corners| corners.swap(1, 2));
        let turned = plain(&looked_at(turned, view.camera, [24; 2], 0.4), &parameters);
        let turned = turned.data().iter().sum::<f32>() / turned.data().len() as f32;
        assert!((turned / through - 1.0).abs() < 0.01, "{paths}: {turned}, its triangles turned round");
        // The far side's share of the profile is what of it lies beyond the slab's thickness.
        let right = 1.0 - within(paths * shape(Vec3::ONE).x);
        assert!((through / right - 1.0).abs() < 0.015, "{paths}: {through} and not {right}");
        assert!((1.0..1.15).contains(&(through / known)), "{paths}: {through}, in truth {known}");
        assert!((through + back - 1.0).abs() < 0.01, "{paths}: {through} and {back}");
    }
}

#[test]
fn what_is_scattered_is_a_mean_of_what_falls_on_the_body() {
    let number = |i: u32, of: u32| random(i, of, 3, 0);
    let mut beyond_all = 0;
    for i in 0..10_000 {
        let (own, [near, far]) = (number(i, 0), [1, 2].map(|of| number(i, of)));
        // Of layers one behind the other, more than all of the profile.
        let [of_near, of_far] = [3, 4].map(|of| 2.0 * number(i, of));
        let side = |light: f32, share: f32| Side { light: light * share, share };
        let found = scattered(own, 1.0, side(near, of_near), side(far, of_far));
        let (least, most) = (own.min(near).min(far), own.max(near).max(far));
        assert!((least - 1e-6..most + 1e-6).contains(&found), "{found} of {own}, {near}, {far}");
        let even = scattered(own, 1.0, side(own, of_near), side(own, of_far));
        assert!((even - own).abs() < 1e-5, "{even} and not {own}");
        beyond_all += usize::from(of_near + of_far > 1.0);
    }
    assert!(beyond_all > 5000, "{beyond_all}");
}

/// Blocks of wax from one x to another and a roof over what is left of x = 0, in light from above.
fn blocks(ends: &[[f32; 2]]) -> Scene {
    let block = |[from, to]: &[f32; 2]| {
        let at = |x, z| [(x, -0.2, z), (x, 0.2, z)].map(|(x, y, z)| Vec3::new(x, y, z));
        let positions = [at(*from, -0.1), at(*to, -0.1), at(*to, 0.0), at(*from, 0.0)].concat();
        let side = |a: u32, b: u32| [[a, b, b + 1], [a, b + 1, a + 1]];
        let triangles = [side(0, 2), side(2, 4), side(4, 6), side(6, 0)].concat();
        Mesh { positions, triangles, ..Mesh::default() }
    };
    let roof = sheet([-0.3, 0.0], 0.3, 1);
    Scene {
        meshes: ends.iter().map(block).chain([roof]).collect::<Vec<Mesh>>().into(),
        materials: vec![wax(0.8, Vec3::splat(0.01)), wax(0.8, Vec3::ZERO)],
        lights: vec![Light::Directional {
            direction: Vec3::NEG_Z,
            irradiance: Vec3::splat(4.0 * PI),
            pattern: None,
        }],
        ..Scene::default()
    }
}

const TWO: &[[f32; 2]] = &[[-0.1, -0.001], [0.001, 0.1]];
const ONE: &[[f32; 2]] = &[[-0.1, 0.1]];

#[test]
fn light_does_not_go_from_one_body_to_another() {
    let camera = Camera {
        position: Vec3::new(0.0, 0.0, 0.25),
        vertical_fov: 0.5,
        ..Camera::look_at(Vec3::Z, Vec3::ZERO)
    };
    let seen = looked_at(blocks(TWO), camera, [32, 48], 0.2);
    let dark_half =
        |image: &Planes| (0..32 * 48).filter(|i| i % 48 < 23).map(|i| image.plane(0)[i]).fold(0.0, f32::max);
    // With a blur, which must not bring it over either.
    let parameters =
        SurfelParameters { blur: SurfelParameters::of(Quality::High).blur, ..parameters(0.03, 3) };
    let apart = plain(&seen, &parameters);
    assert_eq!(dark_half(&apart), 0.0);
    assert!(apart.data().iter().any(|light| *light > 0.1), "the other is lit");
    let one = looked_at(blocks(ONE), camera, [32, 48], 0.2);
    assert!(dark_half(&plain(&one, &parameters)) > 0.01, "within one body it does");
}

#[test]
fn closed_surfaces_are_met_from_within() {
    let met = |place: Vec3, normal: Vec3, open: bool| {
        let disk =
            Disk { place, radius: 0.1, normal: normal.normalize(), open, patch: 0, sent: [Vec3::ZERO; 2] };
        met_from_within(&disk, place, Vec3::Y)
    };
    for aside in [0.1, 1.0, 20.0] {
        let beside = Vec3::X * aside;
        assert!(met(beside, Vec3::Y, false), "in the same plane");
        assert!(met(beside - Vec3::Y, -Vec3::Y, false), "the far side of a slab");
        assert!(!met(beside - Vec3::Y, Vec3::Y, false), "what lies below that, from outside");
        assert!(met(beside - Vec3::Y, Vec3::Y, true), "a sheet has no outside");
    }
    // On a ball and in a hollow of radius 1.
    for angle in [0.1f32, 0.5, 1.0] {
        let (sin, cos) = angle.sin_cos();
        assert!(met(Vec3::new(sin, cos - 1.0, 0.0), Vec3::new(sin, cos, 0.0), false), "ball, {angle}");
        assert!(met(Vec3::new(sin, 1.0 - cos, 0.0), Vec3::new(-sin, cos, 0.0), false), "hollow, {angle}");
    }
}

#[test]
fn without_surfels_or_ways_below_light_stays_where_it_is() {
    let seen = looked_at(blocks(TWO), from_above(), [SIZE; 2], 0.1);
    let (scene, view, gbuffer) = &seen;
    let surface = &Surface::of(gbuffer).expect("a surface");
    let plain = Plain { gbuffer, surface, scene, environment: None, parameters: &SHARP, view };
    let is_light = |image: &Planes, gbuffer: &GBuffer| {
        image.data() == gbuffer.select(&[Attribute::DiffuseLight]).expect("light").data()
    };
    assert!(is_light(&(SCATTERING.plain)(&plain, &[]).expect("attributes"), gbuffer));
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let method = ScreenMethod::new(&gpu, Disks::new(parameters(0.03, 3), SCATTERING));
    let mut opaque = blocks(TWO);
    opaque.materials[0].mean_free_path = Vec3::ZERO;
    let opaque = looked_at(opaque, from_above(), [SIZE; 2], 0.1);
    assert!(is_light(&image(&method, &opaque), &opaque.2));
    assert!(!is_light(&image(&method, &seen), gbuffer), "and else it goes elsewhere");
}

/// A still life of wax under a lamp.
fn still_life() -> ViewedScene {
    let mut scene = Family::StillLife.scene(3);
    let (middle, diagonal) = (scene.bounds().centre(), scene.bounds().diagonal());
    for material in &mut scene.materials {
        material.mean_free_path = diagonal * Vec3::new(0.01, 0.005, 0.0);
    }
    scene.lights = vec![Light::Point {
        position: middle + diagonal * Vec3::new(0.3, 0.5, 0.2),
        intensity: Vec3::splat(diagonal * diagonal),
        range: f32::INFINITY,
    }];
    let camera = Camera::look_at(middle + diagonal * Vec3::new(0.2, 0.2, 0.3), middle);
    looked_at(scene, camera, [43, 61], 0.5 * diagonal)
}

#[test]
fn the_passes_scatter_as_the_plain_version_does() {
    let gpu = Gpu::new().expect("an adapter; lavapipe will do");
    let parameters =
        SurfelParameters { blur: SurfelParameters::of(Quality::High).blur, ..parameters(0.02, 4) };
    // Of radiances up to about 4. Shadow maps end within a texel of where shadows do; radiance has nine bits.
    let tolerance = Tolerance { usual: 2e-2, worst: 0.5 };
    let camera = Camera::look_at(Vec3::new(0.06, -0.14, 0.24), Vec3::new(0.01, 0.0, 0.0));
    let mut scene = blocks(ONE);
    scene.materials[0].mean_free_path = Vec3::new(0.01, 0.004, 0.0);
    let seen = looked_at(scene, camera, [43, 61], 0.2);
    let method = ScreenMethod::new(&gpu, Disks::new(parameters, SCATTERING));
    prove_twin(&method, &seen, tolerance);
    // A lamp behind a slab: all light comes from the far side.
    let position = Vec3::new(0.02, 0.01, -0.04);
    let lamp = Light::Point { position, intensity: Vec3::splat(3e-2), range: f32::INFINITY };
    prove_twin(&method, &slab(1.0, lamp), tolerance);
}

#[test]
fn it_is_nearer_to_truth_than_light_that_is_not_scattered() {
    let parameters =
        SurfelParameters { blur: SurfelParameters::of(Quality::High).blur, ..parameters(0.015, 4) };
    let above = Camera::look_at(Vec3::new(0.06, -0.14, 0.24), Vec3::new(0.01, 0.0, 0.0));
    for (name, seen) in
        [("partly lit", looked_at(blocks(ONE), above, [43, 61], 0.2)), ("still life", still_life())]
    {
        let found = plain(&seen, &parameters);
        let (scene, view, gbuffer) = &seen;
        let shot = Shot::new(scene, &view.camera, [view.height, view.width], view.radius);
        let light = gbuffer.select(&[Attribute::DiffuseLight]).expect("light");
        let truth = path::render(Effect::Subsurface, &shot, Sampling::one(256, 1)).mean;
        let [found, nothing] = [&found, &light].map(|image| mean_difference(image, &truth));
        assert!(found < 0.8 * nothing, "{name}: {found}, without scattering {nothing}");
    }
}

#[test]
fn colours_that_reflect_less_go_less_far() {
    // Christensen and Burley 2015, equation 6, at its ends.
    let shapes = shape(Vec3::new(0.0, 0.8, 1.0));
    assert!((shapes - Vec3::new(4.14, 1.1, 1.04)).abs().max_element() < 1e-5, "{shapes}");
}
