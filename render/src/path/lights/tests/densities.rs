//! Directions to lights against the densities that are claimed for them, by Pearson's chi-square test.

use super::*;
use crate::path::chi_square::{p_value, proves, refutes};

/// The first `faces` faces of a cube of edge 2 around the origin, the last of them its top; of materials 0,
/// 1, 0, ...
fn cube(faces: usize) -> Vec<Mesh> {
    let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let all = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6]];
    let face = |(index, face): (usize, &[usize; 4])| Mesh {
        material: MaterialId(index as u32 % 2),
        ..quad(face.map(corner))
    };
    all[..faces].iter().enumerate().map(face).collect()
}

/// Density of a direction by all kinds of lights together.
fn density(scene: &TracedScene, at: &LightsAt<'_>, from: Vec3, direction: Vec3) -> f32 {
    let hit = scene.hit(from, direction, f32::INFINITY);
    hit.map_or(0.0, |hit| at.density_of_hit(direction, &hit)) + at.density_of_environment(direction)
}

#[test]
fn points_of_triangles_have_the_density_that_is_claimed() {
    let point = Vec3::new(0.2, -0.1, 0.3);
    let shining = |emissions: [f32; 2]| {
        let materials = emissions.map(|emission| lamp(Vec3::splat(emission))).to_vec();
        traced(Scene { meshes: cube(6).into(), materials, ..Scene::default() })
    };
    let (scene, other) = (shining([1.0, 3.0]), shining([3.0, 1.0]));
    let lights = Lights::new(&scene);
    let sample = |stream: &mut Stream| lights.at(point).sample(stream).map(|light| light.direction);
    let p = |scene: &TracedScene| {
        let lights = Lights::new(scene);
        let at = lights.at(point);
        p_value(Vec3::Y, sample, |direction| density(scene, &at, point, direction))
    };
    let name = "chi_square/emissive_triangles";
    proves(name, p(&scene), 1);
    refutes(name, p(&other), 1);
}

#[test]
fn lights_of_all_kinds_together_have_the_density_that_is_claimed() {
    // Walls that shine around a black floor, below a sky and a lamp; a strong sun below the floor.
    let mut meshes = cube(4);
    let floor = quad([(-1., -1.), (-1., 1.), (1., 1.), (1., -1.)].map(|(x, z)| Vec3::new(x, -1.0, z)));
    meshes.push(Mesh { material: MaterialId(2), ..floor });
    let texels = (0..8).map(|i| Vec3::splat(0.2 + 0.1 * i as f32)).collect();
    let scene = traced(Scene {
        meshes: meshes.into(),
        materials: [0.3, 1.0, 0.0].map(|emission| lamp(Vec3::splat(emission))).to_vec(),
        lights: vec![
            Light::Point { position: Vec3::Y, intensity: Vec3::splat(4.0), range: f32::INFINITY },
            Light::Directional { direction: Vec3::Y, irradiance: Vec3::splat(40.0), pattern: None },
        ],
        environment: Some(Environment::new("sky".as_ref(), 4, 2, texels).expect("a sky").into()),
        ..Scene::default()
    });
    let hit = scene.hit(Vec3::new(0.2, 0.0, 0.1), Vec3::NEG_Y, f32::INFINITY).expect("the floor");
    let point = SurfacePoint::new(&scene, &hit, Vec3::NEG_Y);
    let (lights, from) = (Lights::new(&scene), point.ray_origin());
    let at = lights.at_surface(&point);
    // Lights without an extent have no density: they are the samples without a direction.
    let sample = |stream: &mut Stream| {
        at.sample(stream).filter(|light| light.density.is_some()).map(|light| light.direction)
    };
    let p = |at: &LightsAt<'_>| p_value(Vec3::Y, sample, |direction| density(&scene, at, from, direction));
    let name = "chi_square/lights_of_all_kinds";
    proves(name, p(&at), 1);
    // Without the horizon, the sun would take much of the choice.
    refutes(name, p(&lights.at(from)), 1);
}
