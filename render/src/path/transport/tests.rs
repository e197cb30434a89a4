mod veach;

use super::*;
use crate::path::sampler::PixelSampler;
use crate::path::{Sampling, Shot, render};
use crate::scene::{Camera, Environment, Gloss, Light, Material, MaterialId, Mesh, Scene};
use deepshade_shaders::Effect;
use std::f32::consts::{FRAC_1_PI, PI};

fn traced(scene: Scene) -> TracedScene {
    TracedScene::new(scene).expect("triangles")
}

fn quad(corners: [Vec3; 4]) -> Mesh {
    Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
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

/// Mean of a quantity over independent paths, with its standard error.
#[derive(Clone, Copy, Debug)]
struct Measured {
    mean: f32,
    error: f32,
}

impl Measured {
    fn new(count: usize, sample: impl Fn(&mut Stream) -> f32) -> Self {
        let [measured] = Self::together(count, |stream| [sample(stream)]);
        measured
    }

    /// Several quantities of the same paths.
    fn together<const N: usize>(count: usize, sample: impl Fn(&mut Stream) -> [f32; N]) -> [Self; N] {
        let mut sums = [[0.0f64; 2]; N];
        for i in 0..count {
            let values = sample(&mut Stream::new(PixelSampler::new(i, 11, 3), 0));
            for (sums, value) in sums.iter_mut().zip(values.map(f64::from)) {
                *sums = [sums[0] + value, sums[1] + value * value];
            }
        }
        sums.map(|[sum, squares]| {
            let mean = sum / count as f64;
            let variance = (squares / count as f64 - mean * mean).max(0.0) / count as f64;
            Self { mean: mean as f32, error: variance.sqrt() as f32 }
        })
    }

    /// Within three standard errors, or the rounding of sums of many numbers where there is no noise.
    fn is(&self, expected: f32) -> bool {
        (self.mean - expected).abs() <= 3.0 * self.error + 1e-4 * expected
    }

    /// The same by light that is 2 % brighter: transport is linear.
    fn brighter(&self) -> Self {
        Self { mean: 1.02 * self.mean, error: 1.02 * self.error }
    }
}

/// Where paths of these tests begin, and their direction.
const EYE: (Vec3, Vec3) = (Vec3::new(0.1, 0.3, -0.2), Vec3::new(0.36, -0.8, 0.48));

#[test]
fn a_white_furnace_of_lambert_walls_has_the_sum_of_powers() {
    for albedo in [0.3f32, 0.7] {
        let wall = Material { emission: Vec3::ONE, ..lambert(albedo) };
        let scene = traced(Scene { meshes: cube(6), materials: vec![wall], ..Scene::default() });
        let transport = Transport::new(&scene);
        let parts = |split: Split| {
            [split.emitted, split.direct, split.first_indirect, split.rest, split.total()].map(|part| part.x)
        };
        let found = Measured::together(150_000, |stream| parts(transport.split(EYE.0, EYE.1, stream)));
        let expected = [1.0, albedo, albedo.powi(2), albedo.powi(3) / (1.0 - albedo), 1.0 / (1.0 - albedo)];
        for (found, expected) in found.iter().zip(expected) {
            assert!(found.is(expected), "{found:?} is not {expected}");
            assert!(!found.brighter().is(expected), "2 % more light than {found:?} passes for {expected}");
        }
    }
}

#[test]
fn white_walls_in_a_white_sky_are_invisible() {
    // A white cube without a lid, in an environment of radiance 1: every wall has radiance 1.
    let scene = traced(Scene {
        meshes: cube(5),
        materials: vec![lambert(1.0)],
        environment: Some(Environment::uniform(Vec3::ONE).into()),
        ..Scene::default()
    });
    let transport = Transport::new(&scene);
    let found = Measured::new(20_000, |stream| transport.radiance(EYE.0, EYE.1, stream).x);
    assert!(found.is(1.0) && !found.brighter().is(1.0), "{found:?}");
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
    for material in [
        lambert(0.8),
        metal(0.25, Gloss::Microfacets),
        metal(0.9, Gloss::Microfacets),
        dielectric(0.4, Gloss::Microfacets),
        metal(0.4, Gloss::Phong),
        dielectric(0.6, Gloss::Phong),
    ] {
        let scene = traced(Scene {
            meshes: vec![square(-1.0, 5.0, 0)],
            materials: vec![material.clone()],
            environment: Some(Environment::uniform(Vec3::ONE).into()),
            ..Scene::default()
        });
        let hit = scene.hit(EYE.0, EYE.1, f32::INFINITY).expect("the floor");
        let vertex = Vertex::surface(SurfacePoint::new(&scene, &hit, EYE.1), EYE.1);
        let expected = integral(|direction| vertex.evaluate(direction).x);
        for finding in [Finding::Both, Finding::Lights, Finding::Paths] {
            let transport = Transport::new(&scene).with_finding(finding);
            let count = if finding == Finding::Both { 100_000 } else { 20_000 };
            let found = Measured::new(count, |stream| transport.radiance(EYE.0, EYE.1, stream).x);
            assert!(found.is(expected), "{found:?} by {finding:?} is not {expected} of {material:?}");
            let noticed = finding != Finding::Both || !found.brighter().is(expected);
            assert!(noticed, "2 % more light than {found:?} passes for {expected} of {material:?}");
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
            meshes: vec![square(0.0, 9.0, 0)],
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
        let found = Measured::new(4_000, |stream| transport.radiance(from, -from.normalize(), stream).x);
        assert!(found.error < 0.01 * found.mean.max(1e-3), "{found:?}");
        found
    };
    // I / d^2 cos albedo / pi, with d = 5 and cos = 0.8.
    let (above, by_lamp) = (Vec3::new(0.3, 2.0, 0.4), 100.0 / 25.0 * 0.8 * 0.5 * FRAC_1_PI);
    assert!(at_origin(vec![point(100.0)], above).is(by_lamp));
    assert!(!at_origin(vec![point(102.0)], above).is(by_lamp));
    assert!(at_origin(vec![spot], above).is(by_lamp));
    let by_sun = 2.0 * 0.8 * 0.5 * FRAC_1_PI;
    assert!(at_origin(vec![sun], above).is(by_sun));
    assert!(at_origin(vec![point(100.0), spot, sun], above).is(2.0 * by_lamp + by_sun));
    // From below, the floor itself is in the way.
    assert!(at_origin(vec![point(100.0), sun], -above).is(0.0));
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
        meshes,
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
    let measured = |finding: Finding| {
        let transport = Transport::new(&scene).with_finding(finding);
        Measured::new(80_000, |stream| transport.radiance(EYE.0, EYE.1, stream).y)
    };
    let both = measured(Finding::Both);
    for finding in [Finding::Lights, Finding::Paths] {
        let one = measured(finding);
        let error = both.error.hypot(one.error);
        assert!((both.mean - one.mean).abs() < 3.0 * error, "{both:?}, {finding:?} {one:?}");
        assert!(error < 0.02 * both.mean, "{error} is too large to tell 6 %");
    }
}

#[test]
fn blended_surfaces_let_their_share_through_whichever_way_light_is_found() {
    // A lamp of opacity 0.4 under a white sky, seen from a floor of albedo 1/2 that a pane of opacity 0.25 covers.
    let blend = |mut material: Material, alpha: f32| {
        material.base_colour.w = alpha;
        Material { alpha: AlphaMode::Blend, ..material }
    };
    let lamp = blend(Material { emission: Vec3::splat(5.0), ..lambert(0.0) }, 0.4);
    let pane = blend(lambert(0.0), 0.25);
    let scene = traced(Scene {
        meshes: vec![square(0.0, 1.0, 0), square(0.5, 500.0, 1), square(1.0, 1.0, 2)],
        materials: vec![lambert(0.5), pane, lamp],
        environment: Some(Environment::uniform(Vec3::ONE).into()),
        ..Scene::default()
    });
    // Form factor of two coaxial parallel squares of edge 2 at distance 1, at the middle of one: Lambert's polygon.
    let (a, b) = (0.5f32.sqrt(), 1.0f32);
    let form_factor = 4.0 / PI * a * (b * a).atan() * 1.0;
    let sky = 0.75 * (1.0 - 0.4 * form_factor);
    let by_lamp = 0.75 * 0.4 * form_factor * 5.0;
    let expected = 0.5 * (sky + by_lamp);
    for finding in [Finding::Both, Finding::Lights, Finding::Paths] {
        let transport = Transport::new(&scene).with_finding(finding);
        let down = |stream: &mut Stream| transport.radiance(Vec3::Y * 0.25, Vec3::NEG_Y, stream).x;
        let found = Measured::new(40_000, down);
        assert!(found.is(expected), "{found:?} by {finding:?} is not {expected}");
    }
    // Seen from above, beside the diagonal that two triangles share: the lamp, the pane and the floor, each through
    // those before.
    let transport = Transport::new(&scene);
    let from = Vec3::new(0.003, 2.0, 0.001);
    let found = Measured::new(40_000, |stream| transport.radiance(from, Vec3::NEG_Y, stream).x);
    let seen = 0.4 * 5.0 + 0.6 * 0.75 * expected;
    assert!(found.is(seen), "{found:?} is not {seen}");
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
    let count = points.len() as f64;
    let [x, y] =
        [points.iter().map(|p| p.0).sum::<f64>() / count, points.iter().map(|p| p.1).sum::<f64>() / count];
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>();
    // The variance of 192 values with seven degrees of freedom each is known to 4 % or so.
    assert!((-1.5..-0.48).contains(&slope), "{slope} of {points:?}");
    println!("standard error falls with N^{slope:.3}");
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
