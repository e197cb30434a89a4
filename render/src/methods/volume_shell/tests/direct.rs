//! Closed forms of direct single scattering.

use super::*;
use crate::methods::proving::view;
use crate::methods::volume_shell::direct::Direct;
use crate::path::medium::HenyeyGreenstein;
use crate::path::proving::quad;
use crate::scene::{Camera, Light};

const IRRADIANCE: f32 = 2.0;

/// Fog from x = 0 to 3 that a camera at x = -1 looks through along x before a wall, in sunlight from above
/// it, which passes no fog on its way where the fog is a thin sheet; `roof` is what it does not pass, from
/// one x to another.
fn sheet(extinction: f32, roof: Option<[f32; 2]>) -> ViewedScene {
    let wall = quad([(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)].map(|(y, z)| Vec3::new(3.0, y, z)));
    let roof = roof.map(|[from, to]| {
        quad([(from, -4.0), (to, -4.0), (to, 4.0), (from, 4.0)].map(|(x, z)| Vec3::new(x, 2.0, z)))
    });
    let light =
        Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(IRRADIANCE), pattern: None };
    let scene = crate::methods::proving::beyond::scene_of([wall].into_iter().chain(roof).collect());
    let thin = Bounds { min: Vec3::new(0.0, -1.0, -1.0), max: Vec3::new(3.0, 0.001, 1.0) };
    let medium = Medium { density: Density::Within(thin), ..fog(extinction) };
    let camera = Camera { vertical_fov: 1e-4, ..Camera::look_at(Vec3::new(-1.0, 0.0, 0.0), Vec3::ZERO) };
    let view = View { camera, radius: 1.0, ..view(16, 16, 1.0) };
    seen_in(Scene { lights: vec![light], ..scene }, Some(medium), view)
}

/// What scatters from one distance to another in the fog, of which light from the side has passed none.
fn right(extinction: f32, [from, to]: [f32; 2]) -> f32 {
    let passed = |at: f32| (-extinction * at).exp();
    0.8 * IRRADIANCE * HenyeyGreenstein::new(0.3).evaluate(0.0) * (passed(from) - passed(to))
}

#[test]
fn lit_fog_and_a_shaft_of_light_have_closed_forms() {
    let gpu = gpu();
    let fine = VolumeShellParameters { samples: 64, ..coarse() };
    let method = ScreenMethod::new(&gpu, Direct(fine));
    for extinction in [0.05, 0.5] {
        for (roof, lit) in
            [(None, [0.0, 3.0]), (Some([1.0, 3.0]), [0.0, 1.0]), (Some([-1.0, 2.0]), [2.0, 3.0])]
        {
            let found = mean(&shaded(&method, &sheet(extinction, roof)));
            let right = right(extinction, lit);
            assert!((found / right - 1.0).abs() < 0.03, "{extinction}, {roof:?}: {found}, not {right}");
        }
    }
}

#[test]
fn more_intervals_are_nearer_to_a_shaft() {
    let gpu = gpu();
    let off = |samples| {
        let method = ScreenMethod::new(&gpu, Direct(VolumeShellParameters { samples, ..coarse() }));
        let right = right(0.5, [0.0, 1.0]);
        let image = shaded(&method, &sheet(0.5, Some([1.0, 3.0])));
        image.data().iter().map(|found| (found / right - 1.0).powi(2)).sum::<f32>()
    };
    assert!(off(64) < 0.3 * off(8), "{} and {}", off(64), off(8));
}
