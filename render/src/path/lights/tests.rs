mod densities;

use super::*;
use crate::path::proving::{quad, sphere};
use crate::sampler::{PixelSampler, Stream, hash};
use crate::scene::{
    AlphaMode, Encoding, Light, Material, MaterialId, Mesh, Scene, Texture, TextureId, TextureSlot, Wrap,
};
use glam::{Affine2, Vec2};

fn lamp(emission: Vec3) -> Material {
    Material { emission, ..Material::matte("lamp", Vec3::ZERO) }
}

fn traced(scene: Scene) -> TracedScene {
    TracedScene::new(scene).expect("triangles")
}

/// Two triangles at a height above the floor, shining.
const CORNERS: [Vec3; 4] = [
    Vec3::new(-0.7, 1.3, -0.4),
    Vec3::new(-0.7, 1.3, 0.9),
    Vec3::new(1.1, 1.3, 0.9),
    Vec3::new(1.1, 1.3, -0.4),
];

fn rectangle() -> Mesh {
    quad(CORNERS)
}

fn lit_by(meshes: Vec<Mesh>, emission: Vec3) -> Scene {
    Scene { meshes: meshes.into(), materials: vec![lamp(emission)], ..Scene::default() }
}

/// Irradiance at a point of normal `normal` with its standard error, by sampling lights and nothing else.
fn irradiance(scene: &TracedScene, point: Vec3, normal: Vec3, count: u32) -> [f32; 2] {
    let lights = Lights::new(scene);
    let (mut sum, mut squares) = (0.0f64, 0.0f64);
    for i in 0..count {
        let mut stream = Stream::new(PixelSampler::new(i as usize, 7, 1), 0);
        let value = lights.at(point).sample(&mut stream).map_or(0.0, |light| {
            let cosine = light.direction.dot(normal).max(0.0);
            light.radiance.x * cosine * scene.let_through(point, light.direction, light.distance)
        });
        sum += f64::from(value);
        squares += f64::from(value).powi(2);
    }
    let mean = sum / f64::from(count);
    let variance = (squares / f64::from(count) - mean * mean) / f64::from(count);
    [mean as f32, variance.sqrt() as f32]
}

/// Lambert's formula: irradiance from a polygon of radiance 1 above the horizon, seen from the origin.
fn lambert(corners: &[Vec3], normal: Vec3) -> f32 {
    let mut sum = Vec3::ZERO;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let across = a.cross(b);
        sum += across.normalize() * a.angle_between(b);
    }
    0.5 * sum.dot(normal).abs()
}

#[test]
fn a_rectangle_gives_lamberts_irradiance() {
    for normal in [Vec3::Y, Vec3::new(0.2, 0.95, -0.1).normalize()] {
        let expected = 3.0 * lambert(&CORNERS, normal);
        let scene = traced(lit_by(vec![rectangle()], Vec3::splat(3.0)));
        let [mean, error] = irradiance(&scene, Vec3::ZERO, normal, 60_000);
        assert!((mean - expected).abs() < 3.0 * error, "{mean} +- {error} is not {expected}");
        let brighter = traced(lit_by(vec![rectangle()], Vec3::splat(3.06)));
        let [mean, error] = irradiance(&brighter, Vec3::ZERO, normal, 60_000);
        assert!((mean - expected).abs() > 3.0 * error, "2 % more light goes unnoticed");
    }
}

#[test]
fn a_sphere_gives_the_irradiance_of_its_solid_angle() {
    let (radius, distance) = (0.6f32, 2.0f32);
    let scene = traced(lit_by(vec![sphere(Vec3::Y * distance, radius)], Vec3::splat(2.0)));
    // pi L (r / d)^2 times the cosine to the middle, while all of it is above the horizon.
    for cosine in [1.0f32, 0.8] {
        let normal = Vec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
        let expected = PI * 2.0 * (radius / distance).powi(2) * cosine;
        let [mean, error] = irradiance(&scene, Vec3::ZERO, normal, 60_000);
        assert!(error < 0.01 * expected, "{error} is too large to tell 3 %");
        assert!((mean - expected).abs() < 3.0 * error, "{mean} +- {error} is not {expected}");
    }
}

/// Lights of all kinds around the origin.
fn everything() -> Scene {
    let far = Mesh {
        positions: CORNERS.map(|corner| corner * 3.0 - Vec3::Y * 9.0).to_vec(),
        material: MaterialId(1),
        ..rectangle()
    };
    Scene {
        meshes: vec![rectangle(), far].into(),
        materials: vec![lamp(Vec3::splat(3.0)), lamp(Vec3::new(0.0, 0.5, 1.0))],
        lights: vec![
            Light::Point { position: Vec3::new(2.0, 1.0, 0.0), intensity: Vec3::ONE, range: 10.0 },
            Light::Directional { direction: Vec3::NEG_X, irradiance: Vec3::splat(0.7), pattern: None },
        ],
        environment: Some(Environment::uniform(Vec3::splat(0.3)).into()),
        ..Scene::default()
    }
}

#[test]
fn what_is_sampled_is_found_with_the_same_density() {
    let scene = traced(everything());
    let lights = Lights::new(&scene);
    let mut kinds = [0; 3];
    for i in 0..2_000 {
        let point = Vec3::new(0.1, 0.2, 0.3) * (hash(i) % 5) as f32;
        let Some(light) = lights.at(point).sample(&mut Stream::new(PixelSampler::new(i as usize, 0, 2), 0))
        else {
            continue;
        };
        let Some(density) = light.density else {
            kinds[0] += 1;
            continue;
        };
        let found = if light.distance.is_finite() {
            kinds[1] += 1;
            assert_eq!(scene.let_through(point, light.direction, light.distance), 1.0);
            let hit = scene.hit(point, light.direction, f32::INFINITY).expect("the lamp");
            assert!((hit.distance - light.distance).abs() < 1e-4 * light.distance);
            lights.at(point).density_of_hit(light.direction, &hit)
        } else {
            kinds[2] += 1;
            lights.at(point).density_of_environment(light.direction)
        };
        // At grazing angles, the little that samples are off the triangle turns the direction a little.
        assert!((found / density - 1.0).abs() < 1e-2, "{found} is not {density}");
    }
    assert!(kinds.iter().all(|count| *count > 50), "{kinds:?}");
}

#[test]
fn lights_without_an_extent_add_up_and_dark_ones_are_not_chosen() {
    let spot = |direction: Vec3| Light::Spot {
        position: Vec3::Y * 2.0,
        direction,
        intensity: Vec3::splat(8.0),
        range: f32::INFINITY,
        cos_inner: 0.9,
        cos_outer: 0.8,
        slide: None,
    };
    let floor = quad(CORNERS.map(|corner| corner - Vec3::Y * 9.0));
    let lights = vec![
        Light::Point { position: Vec3::Y * 3.0, intensity: Vec3::splat(9.0), range: f32::INFINITY },
        spot(Vec3::Y),
        spot(Vec3::NEG_Y),
    ];
    let scene = traced(Scene {
        meshes: vec![floor].into(),
        materials: vec![Material::default()],
        lights,
        ..Scene::default()
    });
    // They give 9 / 3^2 and 8 / 2^2. A fifth of the choice is even, the rest by that.
    let sampled = Lights::new(&scene);
    let mut both = [0; 2];
    for i in 0..200 {
        let mut stream = Stream::new(PixelSampler::new(i, 0, 0), 0);
        let light = sampled.at(Vec3::ZERO).sample(&mut stream).expect("a light");
        let near = light.distance < 2.5;
        let [given, probability] = if near { [2.0, 0.1 + 0.8 * 2.0 / 3.0] } else { [1.0, 0.1 + 0.8 / 3.0] };
        assert!(
            (light.radiance.x * probability - given).abs() < 1e-5 && light.density.is_none(),
            "{light:?}"
        );
        both[usize::from(near)] += 1;
    }
    assert!(both[0] > 40 && both[1] > 100, "{both:?}");
    let in_the_dark = traced(Scene { lights: vec![spot(Vec3::Y)], ..scene.scene().clone() });
    let mut stream = Stream::new(PixelSampler::new(0, 0, 0), 0);
    assert!(Lights::new(&in_the_dark).at(Vec3::ZERO).sample(&mut stream).is_none());
}

/// A floor and a ceiling that keeps the sun off, and a lamp between them that is two hundred times as weak.
fn sunny_room() -> Scene {
    let lamp = Light::Point { position: Vec3::X, intensity: Vec3::splat(5.0), range: f32::INFINITY };
    let sun = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(1_000.0), pattern: None };
    Scene {
        meshes: vec![rectangle(), quad(CORNERS.map(|corner| corner - Vec3::Y * 2.6))].into(),
        materials: vec![Material::default()],
        lights: vec![sun, lamp],
        ..Scene::default()
    }
}

#[test]
fn a_blocked_light_that_is_much_stronger_leaves_the_noise_bounded() {
    let count = 20_000;
    let [mean, error] = irradiance(&traced(sunny_room()), Vec3::ZERO, Vec3::X, count);
    assert!((mean - 5.0).abs() < 3.0 * error, "{mean} +- {error} is not 5");
    // Of two lights each is taken at least a tenth of the time: the second moment is at most ten squared
    // means.
    let variance = count as f32 * error * error / (mean * mean);
    assert!(variance < 9.5, "a sample's variance is {variance} squared means");
}

#[test]
fn lights_below_the_horizon_are_never_taken() {
    let scene = traced(Scene {
        lights: vec![
            Light::Directional { direction: Vec3::Y, irradiance: Vec3::splat(1e6), pattern: None },
            Light::Point { position: Vec3::Y, intensity: Vec3::ONE, range: f32::INFINITY },
        ],
        ..sunny_room()
    });
    let hit = scene.hit(Vec3::ZERO, Vec3::NEG_Y, f32::INFINITY).expect("the floor");
    let floor = SurfacePoint::new(&scene, &hit, Vec3::NEG_Y);
    let lights = Lights::new(&scene);
    let expected = 1.0 / floor.ray_origin().distance_squared(Vec3::Y);
    for i in 0..100 {
        let light = lights.at_surface(&floor).sample(&mut Stream::new(PixelSampler::new(i, 3, 0), 0));
        let light = light.expect("the one above");
        assert!((light.radiance.x / expected - 1.0).abs() < 1e-5 && light.direction.y > 0.0, "{light:?}");
    }
}

#[test]
fn triangles_are_chosen_by_power_and_those_without_area_never() {
    let mut mesh = rectangle();
    mesh.positions.push(CORNERS[1]);
    // The third triangle has no area.
    mesh.triangles.push([0, 1, 4]);
    let mut small = Mesh { material: MaterialId(1), ..rectangle() };
    for position in &mut small.positions {
        *position = *position * 0.5 + Vec3::Z * 20.0;
    }
    let materials = vec![lamp(Vec3::splat(3.0)), lamp(Vec3::splat(24.0))];
    let scene = traced(Scene { meshes: vec![mesh, small].into(), materials, ..Scene::default() });
    let lights = Lights::new(&scene);
    // A quarter of the area, eight times the radiance: two thirds of the power.
    let count = 20_000;
    let mut far = 0;
    for i in 0..count {
        let light =
            lights.at(Vec3::ZERO).sample(&mut Stream::new(PixelSampler::new(i, 1, 0), 0)).expect("a lamp");
        assert!(light.radiance.is_finite() && light.density.is_some_and(f32::is_finite));
        far += usize::from(light.distance > 10.0);
    }
    // Three standard deviations of a binomial with p = 2/3 are 200.
    assert!((far as i32 - 13_333).abs() < 200, "{far} of {count}");
}

#[test]
fn a_textured_lamp_is_weighed_by_its_mean_and_shines_by_its_texels() {
    // Black on the left, white on the right, and a lamp beside it as bright as a quarter of the white.
    let texture = Texture::new(2, 1, vec![[0, 0, 0, 255], [255; 4]], Encoding::Linear, [Wrap::Clamp; 2]);
    let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
    let uvs = [vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X], vec![]];
    let textured = Mesh { uvs, ..rectangle() };
    let material = Material { emission_texture: Some(slot), ..lamp(Vec3::splat(4.0)) };
    let scene = traced(Scene {
        meshes: vec![textured].into(),
        materials: vec![material],
        textures: vec![texture.into()],
        ..Scene::default()
    });
    let [mean, error] = irradiance(&scene, Vec3::ZERO, Vec3::Y, 60_000);
    // The same by the rule of midpoints over the rectangle.
    let count = 400;
    let mut expected = 0.0;
    for i in 0..count * count {
        let at = Vec2::new((i % count) as f32 + 0.5, (i / count) as f32 + 0.5) / count as f32;
        let point = CORNERS[0] + (CORNERS[3] - CORNERS[0]) * at.x + (CORNERS[1] - CORNERS[0]) * at.y;
        let squared = point.length_squared();
        let emission = 4.0 * (2.0 * at.x - 0.5).clamp(0.0, 1.0);
        expected += emission * (point.y * point.y / squared) / squared;
    }
    expected *= 1.8 * 1.3 / (count * count) as f32;
    assert!((mean - expected).abs() < 3.0 * error, "{mean} +- {error} is not {expected}");
    assert!(error < 0.01 * expected);
}

#[test]
fn a_lamp_with_holes_is_weighed_by_what_is_left() {
    // The left half shines: three quarters of the first triangle, whose centroid is there, a quarter of the
    // second, whose centroid is a hole.
    let texture = Texture::new(2, 1, vec![[255; 4], [0; 4]], Encoding::Linear, [Wrap::Clamp; 2]);
    let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
    let uvs = [vec![Vec2::ZERO, Vec2::Y, Vec2::ONE, Vec2::X], vec![]];
    let holes = Material { base_colour_texture: Some(slot), alpha: AlphaMode::Mask(0.5), ..lamp(Vec3::ONE) };
    let scene = traced(Scene {
        meshes: vec![Mesh { uvs, ..rectangle() }].into(),
        materials: vec![holes],
        textures: vec![texture.into()],
        ..Scene::default()
    });
    let lights = Lights::new(&scene);
    let mut first_and_second = [0; 2];
    for i in 0..10_000 {
        let light = lights.at(Vec3::ZERO).sample(&mut Stream::new(PixelSampler::new(i, 2, 0), 0));
        let Some(light) = light else { continue };
        let hit = scene.hit(Vec3::ZERO, light.direction, f32::INFINITY).expect("the lamp");
        first_and_second[hit.triangle as usize] += 1;
    }
    let [first, second] = first_and_second;
    // 0.75 of 0.75 and 0.25 of 0.25.
    assert!((4_500..7_000).contains(&first) && (300..1_000).contains(&second), "{first} and {second}");
}

#[test]
fn where_nothing_shines_nothing_is_sampled() {
    let scene = traced(lit_by(vec![rectangle()], Vec3::ZERO));
    let lights = Lights::new(&scene);
    assert!(lights.at(Vec3::ZERO).sample(&mut Stream::new(PixelSampler::new(0, 0, 0), 0)).is_none());
    let hit = scene.hit(Vec3::ZERO, Vec3::Y, f32::INFINITY).expect("the rectangle");
    assert_eq!(lights.at(Vec3::ZERO).density_of_hit(Vec3::Y, &hit), 0.0);
    assert_eq!(lights.at(Vec3::ZERO).density_of_environment(Vec3::X), 0.0);
    let black = Environment::uniform(Vec3::ZERO);
    let scene = traced(Scene { environment: Some(black.into()), ..scene.scene().clone() });
    let lights = Lights::new(&scene);
    assert!(lights.at(Vec3::ZERO).sample(&mut Stream::new(PixelSampler::new(0, 0, 0), 0)).is_none());
    assert_eq!(lights.environment(Vec3::X), Vec3::ZERO);
}
