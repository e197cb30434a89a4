use super::*;
use deepshade_dataset::views::sample_view;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::procedural::Family;
use deepshade_shaders::Planes;

mod networks;

const SIZE: [usize; 2] = [48, 64];
const ATTRIBUTES: [Attribute; 4] =
    [Attribute::Position, Attribute::Normal, Attribute::Depth, Attribute::Valid];

/// A g-buffer of a family's scene, seen from where a view of a dataset would be.
fn rendered(family: Family) -> GBuffer {
    let scene = TracedScene::new(family.scene(3)).expect("a scene");
    let camera = sample_view(&scene, SIZE, 5, 0, 0).expect("a view");
    deepshade_render::gbuffer::render(&scene, &camera, SIZE[0], SIZE[1], &ATTRIBUTES)
}

/// The same with other positions, normals and depths where something is seen, made of what they were.
fn changed(gbuffer: &GBuffer, change: impl Fn(usize, [Vec3; 2], f32) -> ([Vec3; 2], f32)) -> GBuffer {
    let seen = gbuffer.seen().expect("validity");
    let mut planes: Planes = gbuffer.planes().clone();
    for at in (0..seen.len()).filter(|at| seen[*at]) {
        let vector = |first: usize| Vec3::from_array([0, 1, 2].map(|c| planes.plane(first + c)[at]));
        let ([position, normal], depth) = change(at, [vector(0), vector(3)], planes.plane(6)[at]);
        let values = [position.to_array(), normal.to_array()].concat();
        (0..6).for_each(|c| planes.plane_mut(c)[at] = values[c]);
        planes.plane_mut(6)[at] = depth;
    }
    GBuffer::new(gbuffer.attributes().to_vec(), planes)
}

fn found(gbuffer: &GBuffer) -> Vec<Contradiction> {
    contradictions(gbuffer, &ATTRIBUTES).expect("validity")
}

/// What is found of a room's g-buffer that was changed.
fn of_room(change: impl Fn(usize, [Vec3; 2], f32) -> ([Vec3; 2], f32)) -> Vec<Contradiction> {
    found(&changed(&rendered(Family::ALL[0]), change))
}

#[test]
fn rendered_ones_do_not_contradict() {
    for family in Family::ALL {
        assert_eq!(found(&rendered(family)), [], "{}", family.name());
    }
}

#[test]
fn half_floats_do_not_contradict() {
    let half = |value: f32| {
        // Eleven bits, rounded.
        let step = 2f32.powi(value.abs().max(1e-4).log2().floor() as i32 - 10);
        (value / step).round() * step
    };
    let halved = |v: Vec3| Vec3::new(half(v.x), half(v.y), half(v.z));
    for family in Family::ALL {
        let gbuffer = changed(&rendered(family), |_, [p, n], d| ([halved(p), halved(n)], half(d)));
        assert_eq!(found(&gbuffer), [], "{}", family.name());
    }
}

#[test]
fn cameras_that_look_forward_or_have_y_down_are_told() {
    let forward = Vec3::new(1.0, 1.0, -1.0);
    let ways = of_room(|_, [p, n], d| ([p * forward, n * forward], d));
    assert!(matches!(ways[..], [Contradiction::LooksForward(share)] if share > 0.99), "{ways:?}");
    let down = Vec3::new(1.0, -1.0, 1.0);
    assert_eq!(of_room(|_, [p, n], d| ([p * down, n * down], d)), [Contradiction::UpsideDown]);
    let left = Vec3::new(-1.0, 1.0, 1.0);
    assert_eq!(of_room(|_, [p, n], d| ([p * left, n * left], d)), [Contradiction::Mirrored]);
}

/// A world in which the camera looks nearly along an axis looks like camera space, or one that is turned.
#[test]
fn world_space_is_told_nearly_always() {
    let (mut told, mut all) = (0, 0);
    for family in Family::ALL {
        let scene = TracedScene::new(family.scene(3)).expect("a scene");
        let camera = sample_view(&scene, SIZE, 5, 0, 0).expect("a view");
        // With the origin in the scene, and with all of it before the origin.
        for away in [0.0, -1000.0] {
            let world = changed(&rendered(family), |_, [p, n], d| {
                ([camera.rotation * p + camera.position + away * Vec3::Z, camera.rotation * n], d)
            });
            all += 1;
            told += usize::from(matches!(found(&world)[..], [Contradiction::OtherSpace(_)]));
        }
    }
    assert!(5 * told >= 4 * all, "{told} of {all}");
}

#[test]
fn normals_that_are_none_are_told() {
    let unsigned = of_room(|_, [p, n], d| ([p, 0.5 * n + 0.5], d));
    assert_eq!(unsigned, [Contradiction::UnsignedNormals(Attribute::Normal)]);
    for factor in [3.0, 0.5] {
        let ways = of_room(|_, [p, n], d| ([p, factor * n], d));
        let is_told = matches!(ways[..], [Contradiction::NotUnit(Attribute::Normal, share, length)]
            if share > 0.99 && (length - factor).abs() < 1e-3);
        assert!(is_told, "{ways:?}");
    }
    let away = of_room(|_, [p, n], d| ([p, -n], d));
    assert!(
        matches!(away[..], [one @ Contradiction::FacingAway(_)] if one.is_grave(&ATTRIBUTES)),
        "{away:?}"
    );
    // A camera that is rolled by a quarter has normals of the world on other axes.
    let other = of_room(|_, [p, n], d| ([p, Vec3::new(n.z, n.x, n.y)], d));
    let is_told = matches!(
        other[..],
        [Contradiction::OtherNormals(_) | Contradiction::FacingAway(_) | Contradiction::Reversed(_)]
    );
    assert!(is_told, "{other:?}");
}

#[test]
fn normals_of_the_world_beside_positions_of_the_camera_are_told_nearly_always() {
    let (mut told, mut all) = (0, 0);
    for family in Family::ALL {
        for (axis, degrees) in [(Vec3::Y, 20.0f32), (Vec3::X, 25.0), (Vec3::Y, 75.0)] {
            let turn = glam::Quat::from_axis_angle(axis, degrees.to_radians());
            let ways = found(&changed(&rendered(family), |_, [p, n], d| ([p, turn * n], d)));
            all += 1;
            told += usize::from(ways.iter().any(|way| way.is_grave(&ATTRIBUTES)));
        }
    }
    assert!(5 * told >= 4 * all, "{told} of {all}");
}

#[test]
fn backs_of_leaves_normal_maps_and_soft_edges_are_let_pass() {
    let some = |at: usize, of: usize| at.wrapping_mul(2_654_435_761) % 100 < of;
    let backs = of_room(|at, [p, n], d| ([p, if some(at, 15) { -n } else { n }], d));
    assert_eq!(backs, []);
    let many = of_room(|at, [p, n], d| ([p, if some(at, 45) { -n } else { n }], d));
    assert!(
        matches!(many[..], [one @ Contradiction::FacingAway(_)] if !one.is_grave(&ATTRIBUTES)),
        "{many:?}"
    );
    let mapped = of_room(|at, [p, n], d| {
        let bump = Vec3::new((at as f32).sin(), (at as f32 * 1.3).cos(), (at as f32 * 0.7).sin());
        ([p, (n + 0.5 * bump).normalize()], d)
    });
    assert_eq!(mapped, []);
    let soft = of_room(|at, [p, n], d| ([p, if some(at, 30) { 0.6 * n } else { n }], d));
    assert_eq!(soft, []);
}

#[test]
fn depth_that_is_another_is_told_for_what_it_is() {
    let millimetres = of_room(|_, of, d| (of, 1000.0 * d));
    let is_told = matches!(millimetres[..], [Contradiction::Depth(ratio, DepthKind::OtherUnit)]
        if (ratio - 1000.0).abs() < 1.0);
    assert!(is_told, "{millimetres:?}");
    // A wide angle, so that both differ over much of the image.
    let wide = Vec3::new(3.0, 3.0, 1.0);
    let distance = of_room(|_, [p, n], _| ([p * wide, (n / wide).normalize()], (p * wide).length()));
    assert!(matches!(distance[..], [Contradiction::Depth(_, DepthKind::Distance)]), "{distance:?}");
    let inverse = of_room(|_, of, d| (of, 1.0 / d));
    assert!(matches!(inverse[..], [Contradiction::Depth(_, DepthKind::Unknown)]), "{inverse:?}");
}

#[test]
fn what_shows_too_little_says_nothing() {
    let room = rendered(Family::ALL[0]);
    let wrong = changed(&room, |_, [p, n], d| ([-p, 3.0 * n], -d));
    assert!(!found(&wrong).is_empty());
    let mut planes = wrong.planes().clone();
    planes.plane_mut(7)[15..].fill(0.0);
    assert_eq!(found(&GBuffer::new(ATTRIBUTES.to_vec(), planes)), []);
}
