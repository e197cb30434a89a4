//! Shadow maps, against rays.

use super::*;
use crate::methods::shafts::{CASCADES, Cascade, Lamp, LampPosition, Projection, ShadowMap, ViewRays};
use crate::sampler::hash;

/// The view rays of a camera.
fn seen(scene: &TracedScene, camera: &Camera) -> ViewRays {
    let gbuffer = gbuffer::render(scene, camera, 72, 96, &[Attribute::Depth, Attribute::Valid]);
    ViewRays::of(&Frame { scene, camera, gbuffer: &gbuffer, radius: 1.0, seed: 0 })
}

/// A number in [0, 1).
fn share(number: u32) -> f32 {
    (hash(number) >> 8) as f32 / 16_777_216.0
}

/// Points on view rays, within some metres.
fn points_on(rays: &ViewRays, within: f32) -> impl Iterator<Item = Vec3> {
    (0..4000u32).map(move |i| {
        let ray = (share(2 * i) * rays.count() as f32) as usize;
        let [near, far] = rays.spans[ray];
        rays.eye + rays.directions[ray] * (near + (far.min(within) - near) * share(2 * i + 1))
    })
}

#[test]
fn light_gets_as_far_as_rays_say() {
    let above = Vec3::new(0.5, 5.0, -3.0);
    let wide = Light::Spot {
        position: above,
        direction: Vec3::new(0.3, -1.0, 0.1).normalize(),
        intensity: Vec3::ONE,
        range: f32::INFINITY,
        cos_inner: 0.0,
        cos_outer: -0.2,
        slide: None,
    };
    for light in [sun(Vec3::new(0.3, -1.0, 0.4)), lamp(above), spot(above, Vec3::NEG_Y), wide] {
        let scene = scene(pergola(), vec![light], fog(0.0, AROUND));
        let lamp = Lamp::new(scene.scene(), &light);
        let rays = seen(&scene, &Camera::look_at(Vec3::new(1.2, 1.2, 5.0), Vec3::new(0.3, 1.6, -3.0)));
        let map = ShadowMap::new(&scene, &lamp, &rays, [CASCADES, 1024]);
        let empty = map.emptied();
        let (mut points, mut lit, mut agree) = (0, 0, 0);
        for point in points_on(&rays, f32::INFINITY) {
            // Maps of spots show what they light.
            if lamp.tint(point) == Vec3::ZERO {
                continue;
            }
            let (direction, reach) = match lamp.position {
                LampPosition::Distant(towards) => (towards, f32::INFINITY),
                LampPosition::Local(position) => (position - point, 1.0),
            };
            let reaches = !scene.blocked(point, direction, reach);
            points += 1;
            lit += u32::from(reaches);
            agree += u32::from(reaches == map.reaches(point));
            assert!(empty.reaches(point));
        }
        assert!(
            points > 50 && lit > points / 10 && lit < points * 9 / 10,
            "{lit} of {points} points are lit"
        );
        // But for those at edges.
        assert!(f64::from(agree) > 0.99 * f64::from(points), "{agree} of {points} points of {light:?}");
    }
}

/// Of a sun over a wide ground, what is near is in maps of finer texels, and light ends there as rays say.
#[test]
fn a_sun_has_finer_maps_of_what_is_near() {
    let ground = quad(
        [(-200., -200.), (-200., 200.), (200., 200.), (200., -200.)].map(|(x, z)| Vec3::new(x, -0.1, z)),
    );
    let meshes = pergola().into_iter().chain([ground]).collect();
    let scene = scene(meshes, vec![], fog(0.0, [[-200.0, -0.5, -200.0], [200.0, 20.0, 200.0]]));
    let light = sun(Vec3::new(0.3, -1.0, 0.4));
    let rays = seen(&scene, &Camera::look_at(Vec3::new(1.2, 1.2, 3.6), Vec3::new(0.0, 1.3, -1.0)));
    let map = ShadowMap::new(&scene, &Lamp::new(scene.scene(), &light), &rays, [CASCADES, 512]);
    let Projection::Parallel(parallel) = &map.projection else { unreachable!("a sun is far away") };
    let texels_of_a_metre = |cascade: &Cascade| {
        let [from, to] = [[0.0; 2], [1.0; 2]].map(|at| cascade.texels(at));
        [to[0] - from[0], to[1] - from[1]]
    };
    let scales: Vec<[f32; 2]> = parallel.cascades.iter().map(texels_of_a_metre).collect();
    let is_finer = |maps: &[[f32; 2]]| maps[0][0] >= maps[1][0] && maps[0][1] >= maps[1][1];
    assert!(scales.windows(2).all(is_finer) && scales[0][0] > 8.0 * scales[CASCADES - 1][0], "{scales:?}");
    let towards = -Vec3::new(0.3, -1.0, 0.4);
    let [mut wrong, mut by_last] = [0, 0];
    for point in points_on(&rays, 10.0) {
        let blocked = scene.blocked(point, towards, f32::INFINITY);
        let [right, up, depth] = parallel.locate(point);
        let [u, v] = parallel.cascades[CASCADES - 1].texels([right, up]);
        wrong += u32::from(blocked == map.reaches(point));
        by_last += u32::from(blocked == (depth < map.depth(CASCADES - 1, u, v)));
    }
    assert!(wrong < 60 && by_last > 4 * wrong, "{wrong} of 4000 points, by the last map {by_last}");
}
