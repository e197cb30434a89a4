mod glass;
mod veach;

use super::*;
use crate::path::proving::{MeanWithError, least_squares, prove_slope, quad};
use crate::path::{Sampling, Shot, render};
use crate::sampler::PixelSampler;
use crate::scene::{AlphaMode, Camera, Environment, Gloss, Light, Material, MaterialId, Mesh, Scene};
use deepshade_shaders::Effect;
use std::f32::consts::{FRAC_1_PI, PI};

fn traced(scene: Scene) -> TracedScene {
    TracedScene::new(scene).expect("triangles")
}

/// A square of edge `2 size` at a height, of a material.
fn square(y: f32, size: f32, material: u32) -> Mesh {
    let corner = |(x, z): (f32, f32)| Vec3::new(x * size, y, z * size);
    Mesh { material: MaterialId(material), ..quad([(-1., -1.), (-1., 1.), (1., 1.), (1., -1.)].map(corner)) }
}

/// The first `faces` faces of a cube of edge 2 around the origin; the last one is its top.
fn cube(faces: usize) -> Vec<Mesh> {
    let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let faces_of_all = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6]];
    faces_of_all[..faces].iter().map(|face| quad(face.map(corner))).collect()
}

fn lambert(albedo: f32) -> Material {
    Material { gloss: Gloss::None, ..Material::matte("grey", Vec3::splat(albedo)) }
}

/// Mean of a quantity over independent paths.
fn measured(count: u32, sample: impl Fn(&mut Stream) -> f32) -> MeanWithError {
    MeanWithError::of_independent(|stream| Vec3::splat(sample(stream)), count)
}

/// Proves a value, and that light that is 2 % brighter would be noticed: transport is linear.
fn prove(name: &str, found: MeanWithError, expected: Vec3) {
    found.proves(name, expected);
    MeanWithError { mean: 1.02 * found.mean, error: 1.02 * found.error }.refutes(name, expected);
}

/// Where paths of these tests begin, and their direction.
const EYE: (Vec3, Vec3) = (Vec3::new(0.1, 0.3, -0.2), Vec3::new(0.36, -0.8, 0.48));

#[test]
fn a_white_furnace_of_lambert_walls_has_the_sum_of_powers() {
    for albedo in [0.3f32, 0.7] {
        let wall = Material { emission: Vec3::ONE, ..lambert(albedo) };
        let scene = traced(Scene { meshes: cube(6).into(), materials: vec![wall], ..Scene::default() });
        let transport = Transport::new(&scene);
        let of = |parts: &dyn Fn(Split) -> Vec3| {
            MeanWithError::of_independent(|stream| parts(transport.split(EYE.0, EYE.1, stream)), 150_000)
        };
        let all = 1.0 / (1.0 - albedo);
        let first = of(&|split| Vec3::new(split.emitted.x, split.direct.x, split.first_indirect.x));
        let later = of(&|split| Vec3::new(split.rest.x, split.total().x, split.total().x));
        for (found, expected) in [
            (first, Vec3::new(1.0, albedo, albedo.powi(2))),
            (later, all * Vec3::new(albedo.powi(3), 1.0, 1.0)),
        ] {
            for part in 0..3 {
                let alone = |of: Vec3| Vec3::splat(of[part]);
                let found = MeanWithError { mean: alone(found.mean), error: alone(found.error) };
                prove("furnace/lambert_box", found, alone(expected));
            }
        }
    }
}

#[test]
fn white_walls_in_a_white_sky_are_invisible() {
    // A white cube without a lid, in an environment of radiance 1: every wall has radiance 1.
    let scene = traced(Scene {
        meshes: cube(5).into(),
        materials: vec![lambert(1.0)],
        environment: Some(Environment::uniform(Vec3::ONE).into()),
        ..Scene::default()
    });
    let transport = Transport::new(&scene);
    let found = MeanWithError::of_independent(|stream| transport.radiance(EYE.0, EYE.1, stream), 20_000);
    prove("furnace/open_box", found, Vec3::ONE);
}

#[test]
fn every_material_in_a_white_sky_shows_its_albedo() {
    let metal = |roughness: f32, gloss: Gloss| Material {
        metallic: 1.0,
        roughness,
        gloss,
        ..Material::matte("metal", Vec3::splat(0.8))
    };
    let dielectric = |roughness: f32, gloss: Gloss| Material { metallic: 0.0, ..metal(roughness, gloss) };
    for (name, material) in [
        ("furnace/lambert", lambert(0.8)),
        ("furnace/smooth_metal", metal(0.25, Gloss::Microfacets)),
        ("furnace/rough_metal", metal(0.9, Gloss::Microfacets)),
        ("furnace/dielectric", dielectric(0.4, Gloss::Microfacets)),
        ("furnace/phong_metal", metal(0.4, Gloss::Phong)),
        ("furnace/phong_dielectric", dielectric(0.6, Gloss::Phong)),
    ] {
        let scene = traced(Scene {
            meshes: vec![square(-1.0, 5.0, 0)].into(),
            materials: vec![material],
            environment: Some(Environment::uniform(Vec3::ONE).into()),
            ..Scene::default()
        });
        let hit = scene.hit(EYE.0, EYE.1, f32::INFINITY).expect("the floor");
        let vertex = Vertex::surface(SurfacePoint::new(&scene, &hit, EYE.1), EYE.1);
        let expected = integral(|direction| vertex.evaluate(direction).x);
        for finding in [Finding::Both, Finding::Lights, Finding::Paths] {
            let transport = Transport::new(&scene).with_finding(finding);
            let count = if finding == Finding::Both { 100_000 } else { 20_000 };
            let found = measured(count, |stream| transport.radiance(EYE.0, EYE.1, stream).x);
            match finding {
                Finding::Both => prove(name, found, Vec3::splat(expected)),
                Finding::Lights | Finding::Paths => found.proves(name, Vec3::splat(expected)),
            }
        }
    }
}

/// Integral over the upper hemisphere, by the rule of midpoints.
fn integral(of: impl Fn(Vec3) -> f32) -> f32 {
    let (rows, columns) = (1_000, 2_000);
    let mut sum = 0.0f64;
    for row in 0..rows {
        let y = (row as f32 + 0.5) / rows as f32;
        let aside = (1.0 - y * y).sqrt();
        for column in 0..columns {
            let (sin, cos) = (2.0 * PI * (column as f32 + 0.5) / columns as f32).sin_cos();
            sum += f64::from(of(Vec3::new(cos * aside, y, sin * aside)));
        }
    }
    (sum * 2.0 * std::f64::consts::PI / f64::from(rows * columns)) as f32
}

#[test]
fn lights_without_an_extent_light_a_floor_as_they_do_alone() {
    let floor = |lights: Vec<Light>| {
        traced(Scene {
            meshes: vec![square(0.0, 9.0, 0)].into(),
            materials: vec![lambert(0.5)],
            lights,
            ..Scene::default()
        })
    };
    let position = Vec3::new(-3.0, 4.0, 0.0);
    let point =
        |intensity: f32| Light::Point { position, intensity: Vec3::splat(intensity), range: f32::INFINITY };
    let spot = Light::Spot {
        position,
        direction: Vec3::new(0.6, -0.8, 0.0),
        intensity: Vec3::splat(100.0),
        range: f32::INFINITY,
        cos_inner: 0.95,
        cos_outer: 0.9,
        slide: None,
    };
    let sun = Light::Directional {
        direction: Vec3::new(0.0, -0.8, 0.6),
        irradiance: Vec3::splat(2.0),
        pattern: None,
    };
    let at_origin = |lights: Vec<Light>, from: Vec3| {
        let scene = floor(lights);
        let transport = Transport::new(&scene);
        let found = measured(4_000, |stream| transport.radiance(from, -from.normalize(), stream).x);
        assert!(found.error.x < 0.01 * found.mean.x.max(1e-3), "{found:?}");
        found
    };
    // Rays start a little above the floor, which is a little nearer to the light.
    let close = |found: MeanWithError, to: f32| (found.mean.x - to).abs() <= 3.0 * found.error.x + 1e-4 * to;
    // I / d^2 cos albedo / pi, with d = 5 and cos = 0.8.
    let (above, by_lamp) = (Vec3::new(0.3, 2.0, 0.4), 100.0 / 25.0 * 0.8 * 0.5 * FRAC_1_PI);
    assert!(close(at_origin(vec![point(100.0)], above), by_lamp));
    assert!(!close(at_origin(vec![point(102.0)], above), by_lamp));
    assert!(close(at_origin(vec![spot], above), by_lamp));
    let by_sun = 2.0 * 0.8 * 0.5 * FRAC_1_PI;
    assert!(close(at_origin(vec![sun], above), by_sun));
    assert!(close(at_origin(vec![point(100.0), spot, sun], above), 2.0 * by_lamp + by_sun));
    // From below, the floor itself is in the way.
    assert!(close(at_origin(vec![point(100.0), sun], -above), 0.0));
}

/// A corner of a room with glossy and matte walls under a lamp, a point light and a sky.
fn corner() -> TracedScene {
    let lamp = Material { emission: Vec3::new(6.0, 5.0, 4.0), ..lambert(0.0) };
    let metal =
        Material { metallic: 1.0, roughness: 0.3, ..Material::matte("metal", Vec3::new(0.9, 0.6, 0.4)) };
    let mut meshes = cube(3);
    meshes.push(square(-1.0, 1.0, 1));
    meshes.push(square(0.9, 0.5, 2));
    traced(Scene {
        meshes: meshes.into(),
        materials: vec![Material::matte("wall", Vec3::new(0.8, 0.7, 0.3)), metal, lamp],
        lights: vec![Light::Point { position: Vec3::splat(0.5), intensity: Vec3::ONE, range: f32::INFINITY }],
        environment: Some(Environment::uniform(Vec3::new(0.2, 0.3, 0.5)).into()),
        ..Scene::default()
    })
}

#[test]
fn parts_add_up_and_fewer_bounces_leave_the_first_parts() {
    let scene = corner();
    let transport = Transport::new(&scene);
    let limited: Vec<_> = (0..3).map(|most| Transport::new(&scene).with_bounces(most)).collect();
    let mut sum = Split::default();
    for i in 0..500 {
        let stream = || Stream::new(PixelSampler::new(i, 0, 0), 0);
        let split = transport.split(EYE.0, EYE.1, &mut stream());
        let whole = transport.radiance(EYE.0, EYE.1, &mut stream());
        assert!((split.total() - whole).length() <= 1e-5 * whole.length());
        let parts = [split.emitted, split.direct, split.first_indirect];
        for (transport, most) in limited.iter().zip(1..) {
            let expected: Vec3 = parts[..most].iter().sum();
            let found = transport.radiance(EYE.0, EYE.1, &mut stream());
            assert!((found - expected).length() <= 1e-5 * expected.length(), "{found} is not {expected}");
        }
        sum.direct += split.direct;
        sum.first_indirect += split.first_indirect;
        sum.rest += split.rest;
    }
    assert!(sum.direct.x > 1.0 && sum.first_indirect.x > 1.0 && sum.rest.x > 1.0, "{sum:?}");
}

#[test]
fn lights_and_paths_find_the_same_light() {
    let scene = corner();
    let found_by = |finding: Finding| {
        let transport = Transport::new(&scene).with_finding(finding);
        measured(200_000, |stream| transport.radiance(EYE.0, EYE.1, stream).y)
    };
    let both = found_by(Finding::Both);
    for finding in [Finding::Lights, Finding::Paths] {
        let one = found_by(finding);
        let error = both.error.x.hypot(one.error.x);
        assert!((both.mean.x - one.mean.x).abs() < 3.0 * error, "{both:?}, {finding:?} {one:?}");
        assert!(
            error < 0.02 * both.mean.x,
            "{error} is too large to tell 6 %: {both:?}, {finding:?} {one:?}"
        );
    }
}

#[test]
fn blended_surfaces_let_their_share_through_whichever_way_light_is_found() {
    // A lamp of opacity 0.4 under a white sky, seen from a floor of albedo 1/2 that a pane of opacity 0.25
    // covers.
    let blend = |mut material: Material, alpha: f32| {
        material.base_colour.w = alpha;
        Material { alpha: AlphaMode::Blend, ..material }
    };
    let lamp = blend(Material { emission: Vec3::splat(5.0), ..lambert(0.0) }, 0.4);
    let pane = blend(lambert(0.0), 0.25);
    let scene = traced(Scene {
        meshes: vec![square(0.0, 1.0, 0), square(0.5, 500.0, 1), square(1.0, 1.0, 2)].into(),
        materials: vec![lambert(0.5), pane, lamp],
        environment: Some(Environment::uniform(Vec3::ONE).into()),
        ..Scene::default()
    });
    // Form factor of two coaxial parallel squares of edge 2 at distance 1, at the middle of one: Lambert's
    // polygon.
    let (a, b) = (0.5f32.sqrt(), 1.0f32);
    let form_factor = 4.0 / PI * a * (b * a).atan() * 1.0;
    let sky = 0.75 * (1.0 - 0.4 * form_factor);
    let by_lamp = 0.75 * 0.4 * form_factor * 5.0;
    let expected = 0.5 * (sky + by_lamp);
    for finding in [Finding::Both, Finding::Lights, Finding::Paths] {
        let transport = Transport::new(&scene).with_finding(finding);
        let down = |stream: &mut Stream| transport.radiance(Vec3::Y * 0.25, Vec3::NEG_Y, stream).x;
        let found = measured(40_000, down);
        assert!(found.is(Vec3::splat(expected)), "{found:?} by {finding:?} is not {expected}");
    }
    // Seen from above, beside the diagonal that two triangles share: the lamp, the pane and the floor, each
    // through those before.
    let transport = Transport::new(&scene);
    let from = Vec3::new(0.003, 2.0, 0.001);
    let found = measured(40_000, |stream| transport.radiance(from, Vec3::NEG_Y, stream).x);
    let seen = 0.4 * 5.0 + 0.6 * 0.75 * expected;
    assert!(found.is(Vec3::splat(seen)), "{found:?} is not {seen}");
}

fn seen(scene: &TracedScene, sampling: Sampling, size: usize) -> crate::path::Estimate {
    let camera = Camera::look_at(Vec3::new(0.9, 0.6, 0.8), Vec3::new(-0.2, -0.4, -0.3));
    render(Effect::Path, &Shot::new(scene, &camera, [size, size], f32::INFINITY), sampling)
}

#[test]
fn the_error_falls_at_least_as_the_root_of_the_number_of_samples() {
    let scene = corner();
    let points: Vec<(f64, f64)> = [16, 64, 256, 1024]
        .into_iter()
        .map(|each: u32| {
            let sampling = Sampling { samples: each * 8, scramblings: 8, seed: 4 };
            let variance = seen(&scene, sampling, 8).variance.expect("eight scramblings");
            let values = variance.data();
            let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64;
            (f64::from(each).ln(), 0.5 * mean.ln())
        })
        .collect();
    let slope = least_squares(&points);
    // The variance of 192 values with seven degrees of freedom each is known to 4 % or so.
    assert!((-1.5..-0.48).contains(&slope), "{slope} of {points:?}");
}

#[test]
fn in_a_white_furnace_the_error_falls_at_least_as_the_root_of_the_number_of_samples() {
    let wall = Material { emission: Vec3::ONE, ..lambert(0.7) };
    let scene = traced(Scene { meshes: cube(6).into(), materials: vec![wall], ..Scene::default() });
    let transport = Transport::new(&scene);
    prove_slope("slope/path", 1.0 / 0.3, |replicate, samples| {
        let sampler = PixelSampler::new(0, 0, 7).scrambled(replicate);
        let radiance = |i| transport.radiance(EYE.0, EYE.1, &mut Stream::new(sampler, i)).x;
        (0..samples).map(radiance).sum::<f32>() / samples as f32
    });
}

#[test]
fn images_do_not_depend_on_the_number_of_threads() {
    let scene = corner();
    let image = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| seen(&scene, Sampling::scrambled(16, 9), 33))
    };
    assert_eq!(image(1), image(3));
}
