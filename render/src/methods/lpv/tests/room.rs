//! Light in a closed room beside truth: of a lamp, of a wall that shines, in fog; and light behind a wall.

use super::super::lit_volume::{LitVolume, LitVolumes};
use super::*;
use crate::methods::Quality;
use crate::methods::proving::view;
use crate::path::{self, Sampling, Shot};
use crate::scene::glow::Start;
use crate::scene::glow::tests::glow;
use crate::scene::{Bounds, Light, Material, MaterialId, Mesh};
use std::f32::consts::PI;

/// What the plain version makes of a scene.
pub fn shaded(technique: &impl Technique, scene: Scene, camera: Camera) -> Vec<f32> {
    let scene = TracedScene::new(scene).expect("triangles");
    let view = View { camera, radius: 20.0, ..view(12, 16, 1.0) };
    let gbuffer = gbuffer::render(&scene, &camera, 12, 16, InMedium::multiple(FEW).about().attributes);
    let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: Some(&scene) };
    technique.reference(&inputs, &view).expect("attributes").remove(0)
}

/// A scene as it is seen from a corner of the room.
pub fn from_a_corner(scene: Scene) -> ViewedScene {
    let scene = TracedScene::new(scene).expect("triangles");
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let view = View { camera, radius: 20.0, ..view(30, 40, 1.0) };
    let gbuffer = gbuffer::render(&scene, &camera, 30, 40, InMedium::multiple(FEW).about().attributes);
    (scene, view, gbuffer)
}

pub fn mean(image: &[f32]) -> f32 {
    image.iter().sum::<f32>() / image.len() as f32
}

/// A closed room with a lamp, and with a wall across it, as thin as a sheet, if it is `divided`.
pub fn room(divided: bool) -> Scene {
    let quad = |corners: [Vec3; 4]| Mesh {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let sides = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    let side = |out: Vec3| {
        let (along, up) = (Vec3::new(out.y, out.z, out.x), Vec3::new(out.z, out.x, out.y));
        quad([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| out + a * along + b * up))
    };
    let corner = |y: f32, z: f32| Vec3::new(0.13, y, z);
    let sheet = quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    let lamp = Light::Point {
        position: Vec3::new(0.6, 0.5, 0.0),
        intensity: Vec3::splat(4.0),
        range: f32::INFINITY,
    };
    Scene {
        meshes: sides.map(side).chain(divided.then_some(sheet)).collect::<Vec<_>>().into(),
        materials: vec![Material::default()],
        lights: vec![lamp],
        ..Scene::default()
    }
}

#[test]
fn a_room_is_as_bright_as_truth_has_it() {
    let parameters = LpvParameters { cells: 16, iterations: 32, ..FEW };
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let image = shaded(&parameters, room(false), camera);
    let scene = TracedScene::new(room(false)).expect("triangles");
    let shot = Shot::new(&scene, &camera, [12, 16], 20.0);
    let truth = path::render(Effect::Gi, &shot, Sampling::one(128, 1)).mean;
    let ratio = mean(&image) / mean(truth.data());
    let off = |(is, wanted): (&f32, &f32)| (is - wanted).powi(2) / (wanted * wanted + 1e-2);
    let error = mean(&image.iter().zip(truth.data()).map(off).collect::<Vec<_>>());
    assert!((ratio - 1.0).abs() < 0.1 && error < 0.1, "{ratio} {error}");
}

#[test]
fn little_light_goes_through_a_wall_thinner_than_a_cell() {
    let parameters = LpvParameters { cells: 16, iterations: 16, ..FEW };
    let leak = |lookup: Lookup| {
        let technique = LpvParameters { scheme: Scheme { lookup, ..Scheme::OURS }, ..parameters };
        let lit = Camera::look_at(Vec3::new(0.9, 0.2, 0.8), Vec3::new(0.3, -0.3, -0.8));
        let dark = Camera::look_at(Vec3::new(-0.8, 0.2, 0.8), Vec3::new(0.1, -0.3, -0.6));
        let [lit, dark] = [lit, dark].map(|camera| mean(&shaded(&technique, room(true), camera)));
        dark / lit
    };
    let [before, within] = [Lookup::Before, Lookup::Within].map(leak);
    assert!(before < 0.015 && within > 1.3 * before, "{before} {within}");
}

/// The room with a wall that shines in place of the lamp, or with the lamp, with fog or without.
pub fn shining(is_wall: bool, medium: Option<Medium>) -> Scene {
    let mut scene = Scene { medium: medium.map(Into::into), ..room(false) };
    if is_wall {
        scene.lights.clear();
        scene.materials.push(Material { emission: Vec3::new(1.0, 0.6, 0.3), ..Material::default() });
        let mut meshes = scene.meshes.to_vec();
        meshes[0].material = MaterialId(1);
        scene.meshes = meshes.into();
    }
    scene
}

/// Fog of a mean free path of two metres.
pub fn fog() -> Medium {
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    Medium::new(Vec3::splat(0.05), Vec3::splat(0.45), 0.0, Density::Within(bounds)).expect("fog")
}

/// Brightness over truth's of an effect.
pub fn over_truth(technique: &impl Technique, effect: Effect, scene: Scene, samples: u32) -> f32 {
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let image = shaded(technique, scene.clone(), camera);
    let scene = TracedScene::new(scene).expect("triangles");
    let shot = Shot::new(&scene, &camera, [12, 16], 20.0);
    mean(&image) / mean(path::render(effect, &shot, Sampling::one(samples, 1)).mean.data())
}

/// On its way twice through the grid light spreads more evenly over the walls than it does: this corner gets
/// a sixth too much.
#[test]
fn a_wall_that_shines_lights_a_corner_about_as_truth_has_it() {
    let parameters = LpvParameters { cells: 16, iterations: 32, ..FEW };
    let ratio = over_truth(&parameters, Effect::Gi, shining(true, None), 256);
    assert!((ratio - 1.0).abs() < 0.17, "{ratio}");
}

#[test]
fn surfaces_that_shine_are_as_the_plain_version_has_it() {
    let gpu = gpu();
    let pixel = Pixel { medium: true, surface: false };
    let lit = ScreenMethod::new(&gpu, FEW);
    prove_twin(&lit, &from_a_corner(shining(true, None)), TOLERANCE);
    let foggy = from_a_corner(shining(true, Some(fog())));
    prove_twin(&ScreenMethod::new(&gpu, InMedium::indirect_at(FEW, pixel)), &foggy, OF_MEDIUM);
    let multiple = ScreenMethod::new(&gpu, InMedium::multiple(FEW));
    prove_twin(&multiple, &foggy, OF_MEDIUM);
    prove_twin(&multiple, &from_a_corner(glowing(Some(fog()))), OF_MEDIUM);
}

/// The room with a wall that gives back light that it kept, and no lamp.
pub fn glowing(medium: Option<Medium>) -> Scene {
    let mut scene = shining(true, medium);
    scene.materials[1] = Material { name: "glows".to_owned(), ..Material::default() };
    let mut full = glow(&[1.0], &[], 0.0);
    full.start = Start::Share(1.0);
    full.surfaces[0].material = Some("glows".to_owned());
    Scene { glow: Some(full.into()), ..scene }
}

#[test]
fn light_that_surfaces_kept_enters_fog_as_that_which_they_emit() {
    let parameters = LpvParameters { cells: 12, iterations: 16, ..FEW };
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let glows = glowing(Some(fog()));
    let mut emits = shining(true, Some(fog()));
    let paint = &glows.glow.as_deref().expect("a paint").surfaces[0].paint;
    emits.materials[1].emission = paint.emission(&[1.0; 4]);
    let images = |technique: &dyn Fn(Scene) -> Vec<f32>| [glows.clone(), emits.clone()].map(technique);
    let pixel = Pixel { medium: true, surface: false };
    for [kept, emitted] in [
        images(&|scene| shaded(&InMedium::indirect_at(parameters, pixel), scene, camera)),
        images(&|scene| shaded(&InMedium::multiple(parameters), scene, camera)),
    ] {
        let worst = kept.iter().zip(&emitted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // A patch's emission has nine bits.
        assert!(mean(&emitted) > 1e-3 && worst < 5e-3 * mean(&emitted), "{worst} of {}", mean(&emitted));
    }
    // Of `gi` it is none, as in truth.
    assert_eq!(mean(&shaded(&parameters, glows, camera)), 0.0);
}

#[test]
fn finer_grids_light_as_the_plain_version_has_it() {
    let gpu = gpu();
    let nested = ScreenMethod::new(&gpu, LpvParameters { cascades: 2, ..FEW });
    prove_twin(&nested, &with_colours(corner()), TOLERANCE);
    prove_twin(&nested, &from_a_corner(shining(true, None)), TOLERANCE);
    let papers = LpvParameters { cascades: 2, scheme: Scheme::PAPER, ..FEW };
    prove_twin(&ScreenMethod::new(&gpu, papers), &with_colours(corner()), TOLERANCE);
}

/// Surfaces in it are as bright as the coarser one has them, whose light it gets.
#[test]
fn a_finer_grid_is_as_bright_as_the_one_around_it() {
    let brightness = |cascades, camera| {
        let parameters = LpvParameters { cells: 12, cascades, iterations: 48, ..FEW };
        mean(&shaded(&parameters, room(false), camera))
    };
    let to_the_wall = Camera::look_at(Vec3::new(-0.6, 0.1, 0.3), Vec3::new(-1.0, -0.1, 0.2));
    let in_a_corner = Camera::look_at(Vec3::new(-0.9, -0.8, 0.9), Vec3::new(-0.8, -1.0, 0.7));
    // Where the borders of both are the scene's.
    let beside_the_wall = Camera::look_at(Vec3::new(-0.9, 0.1, 0.3), Vec3::new(-1.0, 0.1, 0.2));
    for camera in [to_the_wall, in_a_corner, beside_the_wall] {
        let [one, two] = [1, 2].map(|cascades| brightness(cascades, camera));
        assert!((two / one - 1.0).abs() < 0.05, "{two} of {one}");
        // Beside the scene's border the coarser grid lights alone.
        assert!(two != one || camera == beside_the_wall);
    }
}

/// Of linear lobes, on a wall at which all of them end, to an eighth. Of squared ones the second is too
/// bright there already, and there is no third.
#[test]
fn any_number_of_grids_of_linear_lobes_is_as_bright_as_one_that_is_as_fine() {
    let camera = Camera::look_at(Vec3::new(-0.9, 0.1, 0.3), Vec3::new(-1.0, 0.1, 0.2));
    let view = View { camera, radius: 50.0, ..view(12, 16, 1.0) };
    let scene = TracedScene::new(room(false)).expect("triangles");
    let lights = |scheme, cells, cascades| -> Vec<f32> {
        let parameters = LpvParameters { cells, cascades, iterations: 2 * cells, scheme, ..FEW };
        let volumes = LitVolumes::new(&scene, parameters, &view, Filled::Clear, 50.0);
        let on_wall = |volume: &LitVolume| volume.irradiance(Vec3::new(-1.0, 0.1, 0.22), Vec3::X).x;
        volumes.0.iter().map(on_wall).collect()
    };
    // The second of the nested grids has cells of a tenth of a metre, as this one.
    let [linear, squared] = [Scheme::PAPER, Scheme::OURS].map(|scheme| lights(scheme, 22, 1)[0]);
    let nested = lights(Scheme::PAPER, 12, 4);
    let ratios: Vec<f32> = nested.iter().map(|light| light / linear).collect();
    assert!(ratios.len() == 4 && ratios[1..3].iter().all(|ratio| (ratio - 1.0).abs() < 0.12), "{ratios:?}");
    let nested = lights(Scheme::OURS, 12, 4);
    assert!(nested.len() == 2 && nested[1] > 1.2 * squared, "{nested:?} {squared}");
}

/// In a medium they would be too bright.
#[test]
fn in_a_medium_there_is_one_grid() {
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let scene = || Scene { medium: Some(fog().into()), ..room(false) };
    let [one, two] = [1, 2]
        .map(|cascades| shaded(&InMedium::multiple(LpvParameters { cascades, ..FEW }), scene(), camera));
    assert!(mean(&one) > 0.0 && one == two);
}

/// Beside its border a finer grid knows light as the coarser one does: what surfels reflect there of light
/// that surfaces emit.
#[test]
fn a_finer_grid_knows_light_beside_its_border() {
    let parameters = LpvParameters { cells: 14, cascades: 2, iterations: 32, ..FEW };
    let camera = Camera::look_at(Vec3::new(0.0, -0.9, 0.0), Vec3::new(0.0, -1.0, -1.0));
    let view = View { camera, radius: 20.0, ..view(12, 16, 1.0) };
    let scene = TracedScene::new(room(false)).expect("triangles");
    let volumes = LitVolumes::new(&scene, parameters, &view, Filled::Clear, 20.0);
    let [coarse, fine] = [0, 1].map(|i: usize| &volumes.0[i]);
    // On the floor, along a square so far from the middle; the finer grid ends at 0.58.
    let ratio = |at: f32| {
        let around = (0..40).flat_map(|i| {
            let along = (i as f32 / 39.0 - 0.5) * 1.6 * at;
            [Vec3::new(along, -1.0, at), Vec3::new(at, -1.0, along), Vec3::new(along, -1.0, -at)]
        });
        let points: Vec<Vec3> = around.collect();
        let of = |volume: &LitVolume| points.iter().map(|at| volume.irradiance(*at, Vec3::Y).x).sum::<f32>();
        of(fine) / of(coarse)
    };
    // Smaller cells find more light in the middle of a floor; beside the border they have what larger ones
    // hand over.
    let [inside, beside] = [0.3, 0.52].map(ratio);
    assert!((1.0..1.4).contains(&inside) && (1.0..inside).contains(&beside), "{beside} {inside}");
}

/// A room with a lamp in fog with a preferred direction of scattering: what is scattered nearly ahead is
/// scattered all the same.
#[test]
fn fog_in_a_room_is_about_as_bright_as_truth_has_it_whichever_way_it_scatters() {
    let parameters = LpvParameters { cells: 16, iterations: 64, ..FEW };
    let ratios = [-0.5, 0.0, 0.7].map(|anisotropy| {
        let scene = shining(false, Some(Medium { anisotropy, ..fog() }));
        let indirect = over_truth(&InMedium::indirect(parameters), Effect::FogIndirect, scene.clone(), 1024);
        [indirect, over_truth(&InMedium::multiple(parameters), Effect::FogMultiple, scene, 1024)]
    });
    assert!(ratios.iter().all(|[indirect, _]| (0.9..1.1).contains(indirect)), "{ratios:?}");
    assert!(ratios.iter().all(|[_, multiple]| (0.7..1.3).contains(multiple)), "{ratios:?}");
    let [less, even, more] = ratios.map(|[indirect, _]| indirect);
    assert!((less / even - 1.0).abs() < 0.15 && (more / even - 1.0).abs() < 0.15, "{ratios:?}");
}

/// Whatever its walls reflect: of light that was scattered once to a twentieth, of all other to a tenth.
#[test]
fn fog_in_a_closed_room_is_as_bright_as_truth_has_it() {
    let parameters = LpvParameters::of(Quality::Low);
    for albedo in [0.2, 0.5, 0.8] {
        let mut scene = shining(false, Some(fog()));
        scene.materials[0].base_colour = Vec3::splat(albedo).extend(1.0);
        let indirect = over_truth(&InMedium::indirect(parameters), Effect::FogIndirect, scene.clone(), 1024);
        let multiple = over_truth(&InMedium::multiple(parameters), Effect::FogMultiple, scene, 1024);
        assert!(
            (indirect - 1.0).abs() < 0.05 && (multiple - 1.0).abs() < 0.1,
            "{albedo}: {indirect} {multiple}"
        );
    }
}

#[test]
fn lamps_that_are_switched_off_light_nothing() {
    let parameters = LpvParameters { cells: 12, iterations: 16, ..FEW };
    let camera = Camera::look_at(Vec3::new(-0.9, 0.4, 0.9), Vec3::new(0.3, -0.3, -0.5));
    let dark = glowing(Some(fog()));
    let lamp = Light::Point {
        position: Vec3::new(0.1, 0.2, -0.1),
        intensity: Vec3::new(0.3, 0.4, 0.2),
        range: f32::INFINITY,
    };
    let off = Scene { lights: vec![lamp], ..dark.clone() };
    let mut on = off.clone();
    let mut glow = (**on.glow.as_ref().expect("a paint")).clone();
    // From now on: nothing is kept of it yet.
    glow.schedules[0].on = vec![[0.0, f32::INFINITY]];
    on.glow = Some(glow.into());
    let images = |shade: &dyn Fn(Scene) -> Vec<f32>| [&dark, &off, &on].map(|scene| shade(scene.clone()));
    for [dark, off, on] in [
        images(&|scene| shaded(&InMedium::indirect(parameters), scene, camera)),
        images(&|scene| shaded(&InMedium::multiple(parameters), scene, camera)),
        images(&|scene| shaded(&parameters, scene, camera)),
    ] {
        assert!(off == dark && mean(&on) > mean(&off) + 1e-3, "{} {}", mean(&on), mean(&off));
    }
    let gpu = gpu();
    for frame in [off, on].map(from_a_corner) {
        let indirect = ScreenMethod::new(&gpu, InMedium::indirect(FEW));
        prove_twin(&indirect, &frame, OF_MEDIUM);
        let multiple = ScreenMethod::new(&gpu, InMedium::multiple(FEW));
        prove_twin(&multiple, &frame, OF_MEDIUM);
    }
}

/// Light of any strength, in rooms of any size.
#[test]
fn light_is_linear_and_the_same_on_both_sides_of_a_mirror() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, LpvParameters { cells: 8, iterations: 8, ..FEW });
    let corner = |size: f32, power: f32, side: f32| {
        let quad = |corners: [[f32; 3]; 4]| Mesh {
            positions: corners.map(|[x, y, z]| size * Vec3::new(side * x, y, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let floor = quad([[-1., 0., 1.], [1., 0., 1.], [1., 0., -1.], [-1., 0., -1.]]);
        let wall = quad([[1., 0., -1.], [1., 0., 1.], [1., 1., 1.], [1., 1., -1.]]);
        let sun = Light::Directional {
            direction: Vec3::new(0.6 * side, -0.8, 0.0),
            irradiance: Vec3::splat(power),
            pattern: None,
        };
        let scene = Scene {
            meshes: vec![floor, wall].into(),
            materials: vec![Material::default()],
            lights: vec![sun],
            ..Scene::default()
        };
        let scene = TracedScene::new(scene).expect("triangles");
        let camera = Camera::look_at(size * Vec3::new(0.0, 1.0, 1.5), Vec3::ZERO);
        let attributes = FEW.about().attributes;
        let gbuffer = gbuffer::render(&scene, &camera, 12, 16, attributes);
        let frame = Frame { scene: &scene, camera: &camera, gbuffer: &gbuffer, radius: 20.0 * size, seed: 1 };
        let image = method.shade(&frame, Repeats::ONCE).expect("an image").image;
        mean(image.data()) / power
    };
    let usual = corner(1.0, 1.0, 1.0);
    assert!(usual > 1e-3, "{usual}");
    for (size, power, side) in
        [(1.0, 1e-4, 1.0), (1.0, 1e-4, -1.0), (300.0, 1e5, 1.0), (300.0, 1e5, -1.0), (1.0, 1.0, -1.0)]
    {
        let found = corner(size, power, side);
        assert!((found / usual - 1.0).abs() < 0.02, "{size} m, {power} W/m²: {found} for {usual}");
    }
}

/// A wall that glows, radiance 1, as truth has it to the others of a cube: Howell's catalogue, C-11 and C-14,
/// to which 0.2 is near.
#[test]
fn light_that_a_wall_kept_comes_to_the_others_by_their_form_factors() {
    let mut scene = shining(true, None);
    scene.materials[1].name = "glows".to_owned();
    let mut full = glow(&[1.0], &[], 0.0);
    full.start = Start::Share(1.0);
    full.surfaces[0].material = Some("glows".to_owned());
    scene.glow = Some(full.into());
    let scene = TracedScene::new(scene).expect("triangles");
    let parameters = LpvParameters { cells: 16, iterations: 64, ..FEW };
    let volumes = LitVolumes::new(&scene, parameters, &view(1, 1, 1.0), Filled::Kept, f32::MAX);
    let received = |out: Vec3| {
        let (along, up) = (Vec3::new(out.y, out.z, out.x), Vec3::new(out.z, out.x, out.y));
        let at = |i: u32| 2.0 * (i as f32 + 0.5) / 40.0 - 1.0;
        let point = |i: u32| out + at(i % 40) * along + at(i / 40) * up;
        (0..1600).map(|i| volumes.irradiance(point(i), -out).x / PI).sum::<f32>() / 1600.0
    };
    let [own, opposite] = [Vec3::X, -Vec3::X].map(received);
    let beside = [Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z].map(received);
    let all = own + opposite + beside.iter().sum::<f32>();
    assert!((all - 1.0).abs() < 0.02, "energy: {all}");
    assert!(own < 0.02 && (opposite - 0.2).abs() < 0.03, "{own} {opposite}");
    assert!(beside.iter().all(|received| (received - 0.2).abs() < 0.01), "{beside:?}");
}
