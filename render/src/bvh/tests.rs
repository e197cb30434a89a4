use super::*;
use crate::path::{Sampling, Shot, render};
use crate::scene::{Camera, Encoding, Environment, Material, Mesh, Texture, TextureId, TextureSlot, Wrap};
use deepshade_shaders::{Effect, Planes};
use glam::{Affine2, Vec4};

fn square_at(z: f32) -> Mesh {
    Mesh {
        positions: [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(|(x, y)| Vec3::new(x, y, z)).to_vec(),
        uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], vec![]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn scene(meshes: Vec<Mesh>, material: Material) -> Scene {
    Scene { meshes: meshes.into(), materials: vec![material], ..Scene::default() }
}

#[test]
fn nearest_of_two_squares_with_its_barycentrics() {
    let meshes = vec![square_at(0.0), square_at(-1.0)];
    let traced = TracedScene::new(scene(meshes, Material::default())).expect("two squares");
    let hit = traced.hit(Vec3::new(0.75, 0.25, 2.0), Vec3::NEG_Z, f32::INFINITY).expect("a hit");
    assert_eq!((hit.mesh, hit.triangle, hit.distance), (0, 0, 2.0));
    let corners = traced.scene().meshes[0].corners(0);
    let weights = corner_weights(hit.barycentric);
    let point = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
    assert!((point - Vec3::new(0.75, 0.25, 0.0)).length() < 1e-6);
    assert!(traced.hit(Vec3::new(0.75, 0.25, 2.0), Vec3::NEG_Z, 1.9).is_none());
    assert!(traced.blocked(Vec3::new(0.3, 0.3, 2.0), Vec3::NEG_Z, 2.1));
    assert!(!traced.blocked(Vec3::new(0.3, 0.3, 2.0), Vec3::Z, 9.0));
}

#[test]
fn negative_zero_is_a_direction_like_zero() {
    let traced = TracedScene::new(scene(vec![square_at(0.0)], Material::default())).expect("a square");
    let origin = Vec3::new(0.3, 0.6, -1.0);
    assert!(traced.blocked(origin, -Vec3::NEG_Z, f32::INFINITY));
    assert!(traced.hit(origin, -Vec3::NEG_Z, f32::INFINITY).is_some());
}

pub(in crate::bvh) fn random(i: u32) -> f32 {
    hash(i) as f32 / 4_294_967_296.0
}

/// Opaque triangles every which way in a cube of 10 m, and two panes of glass.
pub(in crate::bvh) fn clutter() -> TracedScene {
    let glass = Material {
        base_colour: Vec4::new(1.0, 1.0, 1.0, 0.5),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    let mut clutter = Mesh::default();
    for i in 0..3_000 {
        let middle = Vec3::new(random(9 * i), random(9 * i + 1), random(9 * i + 2)) * 10.0;
        for corner in 0..3 {
            let at = 9 * (i + 5_000 * corner);
            clutter.positions.push(middle + Vec3::new(random(at + 3), random(at + 4), random(at + 5)));
        }
        clutter.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let panes = Mesh { material: crate::scene::MaterialId(1), ..square_at(3.0) };
    let materials = vec![Material::default(), glass];
    TracedScene::new(Scene { meshes: vec![clutter, panes].into(), materials, ..Scene::default() })
        .expect("triangles")
}

#[test]
fn a_bundle_meets_what_its_rays_meet() {
    let traced = clutter();
    let mut met = 0;
    for i in 0..200 {
        let origin = Vec3::new(random(7 * i), random(7 * i + 1), random(7 * i + 2)) * 14.0 - 2.0;
        let towards = Vec3::splat(5.0) - origin;
        let spread = |ray: u32| {
            let at = 3 * (64 * i + ray);
            Vec3::new(random(at) - 0.5, random(at + 1) - 0.5, random(at + 2) - 0.5)
        };
        let directions: Vec<Vec3> =
            (0..1 + i % 64).map(|ray| (towards.normalize() + 0.7 * spread(ray)).normalize()).collect();
        let hits = traced.hit_bundle(origin, &directions);
        assert_eq!(hits.len(), directions.len());
        for (direction, hit) in directions.iter().zip(hits) {
            let alone = traced.hit(origin, *direction, f32::INFINITY);
            let what = |hit: Option<Hit>| hit.map(|hit| (hit.mesh, hit.triangle, hit.barycentric));
            assert_eq!(what(hit), what(alone), "bundle {i}");
            met += usize::from(hit.is_some());
            let Some((hit, alone)) = hit.zip(alone) else { continue };
            let [a, b, c] = traced.scene().meshes[hit.mesh as usize].corners(hit.triangle as usize);
            // A distance is as exact as coordinates of 10 m, and less the more its triangle is seen edge-on.
            let slope = (b - a).cross(c - a).normalize().dot(*direction).abs();
            let difference = (hit.distance - alone.distance).abs();
            assert!(difference * slope < 2e-5, "{} and {}", hit.distance, alone.distance);
        }
    }
    assert!(met > 3_000, "{met} rays met something");
}

#[test]
fn a_bundle_is_blocked_where_its_rays_are() {
    use crate::path::ao::hemisphere;
    use crate::sampler::{PixelSampler, frame};
    let traced = clutter();
    let mut share = 0.0;
    for i in 0..300 {
        let origin = Vec3::new(random(7 * i), random(7 * i + 1), random(7 * i + 2)) * 10.0;
        let above = frame(Vec3::new(random(i) - 0.5, random(i + 400), 0.3).normalize()).z_axis;
        let reach = 0.5 + 4.0 * random(i + 900);
        let rays = 1 + i % 64;
        let directions = hemisphere(&PixelSampler::new(i as usize, 0, 0), rays, above);
        let blocked = traced.blocked_bundle(origin, &directions, reach);
        for (ray, direction) in directions.iter().enumerate() {
            let alone = traced.blocked(origin, *direction, reach);
            assert_eq!(blocked >> ray & 1 == 1, alone, "ray {ray} of bundle {i}");
        }
        assert_eq!(blocked.checked_shr(rays).unwrap_or(0), 0, "no rays, no bits");
        share += f64::from(blocked.count_ones()) / f64::from(rays) / 300.0;
    }
    assert!((0.2..0.8).contains(&share), "{share} of the rays are blocked");
}

#[test]
fn no_ray_slips_through_an_edge() {
    // A closed icosahedron-like fan around the origin, traced from inside: every ray must be blocked.
    let rim = |i: u32| {
        let (sin, cos) = (std::f32::consts::TAU * (i % 7) as f32 / 7.0).sin_cos();
        Vec3::new(1.3 * cos, 0.1, 1.1 * sin)
    };
    let mut hat =
        Mesh { positions: vec![Vec3::new(0.2, 0.9, -0.1), Vec3::new(0.1, -1.0, 0.2)], ..Mesh::default() };
    for i in 0..7 {
        hat.positions.push(rim(i));
        let (a, b) = (2 + i, 2 + (i + 1) % 7);
        hat.triangles.extend([[0, a, b], [1, b, a]]);
    }
    let traced = TracedScene::new(scene(vec![hat], Material::default())).expect("triangles");
    // Straight at the edges and corners, and at points all along them.
    let corners: Vec<Vec3> = traced.scene().meshes[0].positions.clone();
    for step in 0..=500 {
        for triangle in &traced.scene().meshes[0].triangles {
            let [a, b, _] = triangle.map(|corner| corners[corner as usize]);
            let direction = a.lerp(b, step as f32 / 500.0).normalize();
            assert_eq!(traced.blocked_bundle(Vec3::ZERO, &[direction], 9.0), 1, "towards {direction}");
            assert!(traced.hit_bundle(Vec3::ZERO, &[direction])[0].is_some(), "towards {direction}");
        }
    }
}

#[test]
fn a_mask_leaves_holes() {
    let texels = vec![[255, 255, 255, 255], [255, 255, 255, 0]];
    let texture = Texture::new(2, 1, texels, Encoding::Srgb, [Wrap::Clamp; 2]);
    let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
    let material =
        Material { base_colour_texture: Some(slot), alpha: AlphaMode::Mask(0.5), ..Material::default() };
    let scene = Scene { textures: vec![texture.into()], ..scene(vec![square_at(0.0)], material) };
    let traced = TracedScene::new(scene).expect("a square");
    assert!(traced.blocked(Vec3::new(0.2, 0.5, 1.0), Vec3::NEG_Z, 9.0));
    assert!(!traced.blocked(Vec3::new(0.8, 0.5, 1.0), Vec3::NEG_Z, 9.0));
    assert!(traced.hit(Vec3::new(0.8, 0.5, 1.0), Vec3::NEG_Z, 9.0).is_none());
}

#[test]
fn a_blended_surface_stops_its_share_of_rays() {
    let material = Material {
        base_colour: Vec4::new(1.0, 1.0, 1.0, 0.3),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    let traced = TracedScene::new(scene(vec![square_at(0.0)], material)).expect("a square");
    let blocked = (0..10_000)
        .filter(|i| {
            let origin = Vec3::new((i % 100) as f32 / 101.0, (i / 100) as f32 / 101.0, 1.0);
            traced.blocked(origin, Vec3::NEG_Z, 9.0)
        })
        .count();
    // Three standard deviations of a binomial with p = 0.3 are 137.
    assert!((blocked as i32 - 3_000).abs() < 140, "{blocked} of 10,000 stopped");
}

#[test]
fn vertices_that_are_not_finite_are_refused_by_name() {
    let mut mesh = Mesh { name: "broken".to_owned(), ..square_at(0.0) };
    mesh.positions[1].x = f32::NAN;
    let error = TracedScene::new(scene(vec![mesh], Material::default())).expect_err("a NaN");
    assert!(error.to_string().contains("mesh `broken`"), "{error}");
    let empty = TracedScene::new(Scene { materials: vec![Material::default()], ..Scene::default() });
    assert!(matches!(empty, Err(SceneError::Empty { .. })));
}

#[test]
fn scenes_too_large_to_trace_are_refused_by_name() {
    let reaching = |far: f32| {
        let positions = vec![Vec3::ZERO, Vec3::new(far, far, 0.0), Vec3::X, Vec3::Z];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 1, 3]], ..Mesh::default() };
        let scene = scene(vec![mesh], Material::default());
        TracedScene::new(Scene { name: "far".to_owned(), ..scene })
    };
    assert!(reaching(7e8).is_ok());
    for far in [7.1e8, 1e20, f32::MAX] {
        let error = reaching(far).expect_err("too large").to_string();
        assert!(error.starts_with("far: is ") && error.contains("more than 1e9 m"), "{error}");
    }
}

/// An image of a scene of panes by paths, and one by occlusion rays.
fn pictures(scene: &TracedScene) -> [Planes; 2] {
    let camera = Camera::look_at(Vec3::new(0.4, 0.6, 4.0), Vec3::new(0.5, 0.5, 0.0));
    let shot = Shot::new(scene, &camera, [24, 24], 2.0);
    [Effect::Path, Effect::Ao].map(|effect| render(effect, &shot, Sampling::one(8, 3)).mean)
}

/// Panes in front of each other, `count` of them, under a white sky.
fn panes(count: u32) -> Scene {
    let glass = Material {
        base_colour: Vec4::new(0.7, 0.8, 0.9, 0.4),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    Scene {
        environment: Some(Environment::uniform(Vec3::ONE).into()),
        ..scene((0..count).map(|i| square_at(-0.2 * i as f32)).collect(), glass)
    }
}

#[test]
fn chance_does_not_ask_where_a_triangle_is_in_the_hierarchy() {
    // Squares to both sides of the panes, later in the list, give the panes' triangles other places.
    let mut more = panes(4);
    for i in 0..50 {
        let aside = Vec3::new(2.0 + 9.0 * random(i), random(i + 60), random(i + 120) - 0.5);
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        let mut square = square_at(0.0);
        square.positions.iter_mut().for_each(|p| *p = *p * 0.5 + aside * Vec3::new(sign, 1.0, 1.0));
        more.meshes.push(square);
    }
    let [few, many] = [panes(4), more].map(|scene| TracedScene::new(scene).expect("panes"));
    let places = |scene: &TracedScene| -> Vec<usize> {
        let origins = scene.origins.iter().enumerate();
        origins.filter(|(_, origin)| origin.mesh < 4).map(|(place, _)| place).collect()
    };
    assert_ne!(places(&few), places(&many), "the hierarchies are alike");
    let mut met = [0; 2];
    for i in 0..2_000 {
        let (origin, chance) = (Vec3::new(random(i), random(i + 5_000), 1.0), random(i + 9_000));
        let hit = |scene: &TracedScene| scene.hit_by_chance(origin, Vec3::NEG_Z, 9.0, || chance);
        assert_eq!(hit(&few), hit(&many), "ray {i}");
        assert_eq!(few.blocked(origin, Vec3::NEG_Z, 1.3), many.blocked(origin, Vec3::NEG_Z, 1.3), "ray {i}");
        met[usize::from(hit(&few).is_some())] += 1;
    }
    assert!(met[0] > 100 && met[1] > 1_000, "{met:?}");
}

#[test]
fn images_do_not_depend_on_the_threads_that_build_the_hierarchies() {
    // The builder works on several threads from half a million triangles on.
    let mut scene = panes(2);
    let mut dust = Mesh::default();
    for i in 0..520_000 {
        let middle = Vec3::new(random(3 * i), random(3 * i + 1), -1.0 - random(3 * i + 2));
        dust.positions.extend([0.0, 0.01, 0.02].map(|by: f32| middle + Vec3::new(by, by * by * 50.0, -by)));
        dust.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    scene.meshes.push(dust);
    let built = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| TracedScene::new(scene.clone()).expect("triangles"))
    };
    let (one, four) = (pictures(&built(1)), pictures(&built(4)));
    assert!(one == four, "images differ");
    assert!(one[0].data().iter().any(|value| *value < 0.9), "nothing is seen");
}
