//! What is very long, very thin, very strong or of no size.

use super::*;

/// A lamp that flashes over the floor, so many times.
fn flashing(count: u8) -> (TracedScene, View, GBuffer) {
    let flashes: Vec<[f32; 2]> =
        (0..count).map(f32::from).map(|index| [0.3 * index, 0.3 * index + 0.1]).collect();
    let kept = glow(&[0.7], &flashes, 0.3 * f32::from(count));
    let lights = vec![lamp(Vec3::new(0.3, 2.0, 0.2), 20.0)];
    seen(scene(vec![floor()], lights, kept), camera(), [9, 11])
}

/// More than 65,535 steps of one state.
#[test]
fn steps_of_euler_are_as_many_as_are_asked_for() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters { texels: 12, euler: 4096 });
    prove_twin(&method, &flashing(9), Tolerance { usual: 1e-4, worst: 1e-4 });
}

/// More than 65,535 looks at a piece of the past.
#[test]
fn moments_are_as_many_as_are_asked_for() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, Moments { samples: 4096 });
    prove_twin(&method, &flashing(21), Tolerance { usual: 2e-3, worst: 1e-2 });
}

/// A piece of the way through it hides some ten times what can be told from 1.
#[test]
fn thin_fog_shines_as_in_the_plain_version() {
    let gpu = gpu();
    let method = ScreenMethod::new(&gpu, RateEquationParameters::exact(100));
    let mut kept = glow(&[0.4], &[[0.0, 1.0]], 1.5);
    kept.medium = kept.surfaces.pop().map(|surface| surface.paint);
    let density = Density::Within(Bounds { min: Vec3::new(-1.0, 0.1, -1.0), max: Vec3::new(1.0, 1.3, 1.0) });
    let medium = Medium::new(Vec3::ZERO, Vec3::splat(2e-5), 0.0, density).expect("a medium");
    let scene = scene(vec![floor()], vec![lamp(Vec3::new(0.1, 2.5, 0.2), 30.0)], kept);
    let look = Look { medium: Some(Arc::new(medium)), ..scene.scene().look() };
    let room = seen(scene.with_look(look).expect("a look"), camera(), [37, 53]);
    let found = shaded(&method, &room);
    let plain =
        reference::shade(&room.0, &room.1, RateEquationParameters::exact(100)).pop().expect("an image");
    let brightest = plain.iter().copied().fold(0.0, f32::max);
    assert!((1e-6..1e-4).contains(&brightest), "{brightest}");
    assert!(near(found.data(), &plain, 5e-3 * brightest));
}

/// Red light alone excites; that of the other colours is endless, too.
#[test]
fn endless_light_fills_what_it_excites() {
    let corners = [(-0.5, 0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, -0.5)];
    let board = quad(corners.map(|(x, z)| Vec3::new(x, 0.0, z)), 0);
    let lights = vec![lamp(Vec3::new(0.0, 0.7, 0.0), 3e38)];
    let room = seen(scene(vec![board], lights, glow(&[0.3], &[[0.0, 9.0]], 1.0)), camera(), [9, 11]);
    for states in both_states(&room, 20) {
        assert!(states.len() > 200 && states.iter().all(|share| *share == 1.0));
    }
}

/// Three corners that are one, and have normals that face the lamp.
#[test]
fn what_has_no_area_gets_no_light() {
    let point = Mesh {
        positions: vec![Vec3::new(0.5, 1.0, 0.5); 3],
        normals: vec![Vec3::Y; 3],
        triangles: vec![[0, 1, 2]],
        material: MaterialId(1),
        ..Mesh::default()
    };
    let lights = vec![lamp(Vec3::new(0.3, 2.0, 0.2), 20.0)];
    let kept = glow(&[0.7], &[[0.0, 9.0]], 1.0);
    let room = seen(scene(vec![floor(), point], lights, kept), camera(), [9, 11]);
    let [states, expected] = both_states(&room, 20);
    assert!(near(&states, &expected, 1e-5));
    assert_eq!(states.iter().filter(|share| **share == 0.0).count(), 3, "a triangle has three texels");
}
