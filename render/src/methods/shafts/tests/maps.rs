//! Shadow maps, against rays.

use super::*;
use crate::methods::shafts::{Lamp, LampPosition, ShadowMap};
use crate::sampler::hash;

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
        let map = ShadowMap::new(&scene, &lamp, 1024);
        let empty = map.emptied();
        let (mut points, mut lit, mut agree) = (0, 0, 0);
        for i in 0..4000u32 {
            let share = |axis: u32| hash(i * 3 + axis) as f32 / u32::MAX as f32;
            let point = Vec3::new(16.0 * share(0) - 8.0, 5.9 * share(1) + 0.05, 16.0 * share(2) - 8.0);
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
