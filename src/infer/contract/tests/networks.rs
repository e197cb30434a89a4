//! What networks read that read other things than positions and normals.

use super::*;
use glam::Vec3Swizzles;
use std::cell::Cell;

/// All that is looked at.
const ALL: [Attribute; 6] = [
    Attribute::Position,
    Attribute::Normal,
    Attribute::Depth,
    Attribute::Valid,
    Attribute::WorldNormal,
    Attribute::ToCamera,
];

fn rendered_in_full(family: Family) -> GBuffer {
    let scene = TracedScene::new(family.scene(3)).expect("a scene");
    let camera = sample_view(&scene, SIZE, 5, 0, 0).expect("a view");
    deepshade_render::gbuffer::render(&scene, &camera, SIZE[0], SIZE[1], &ALL)
}

fn room() -> GBuffer {
    rendered_in_full(Family::ALL[0])
}

/// The same with other vectors for an attribute where something is seen.
fn with(gbuffer: &GBuffer, attribute: Attribute, change: impl Fn(Vec3) -> Vec3) -> GBuffer {
    let seen = gbuffer.seen().expect("validity");
    let first = gbuffer.first_plane(attribute).expect("there");
    let values = vectors(gbuffer, attribute).expect("there");
    let mut planes = gbuffer.planes().clone();
    for at in (0..seen.len()).filter(|at| seen[*at]) {
        let value = change(values[at]).to_array();
        (0..3).for_each(|c| planes.plane_mut(first + c)[at] = value[c]);
    }
    GBuffer::new(gbuffer.attributes().to_vec(), planes)
}

fn with_depth(gbuffer: &GBuffer, change: impl Fn(f32) -> f32) -> GBuffer {
    let first = gbuffer.first_plane(Attribute::Depth).expect("there");
    let seen = gbuffer.seen().expect("validity");
    let mut planes = gbuffer.planes().clone();
    let depth = planes.plane_mut(first);
    (0..seen.len()).filter(|at| seen[*at]).for_each(|at| depth[at] = change(depth[at]));
    GBuffer::new(gbuffer.attributes().to_vec(), planes)
}

/// What is found where a file has nothing but what the network reads.
fn alone(gbuffer: &GBuffer, read: &[Attribute]) -> Vec<Contradiction> {
    let held = [read, &[Attribute::Valid]].concat();
    let gbuffer = GBuffer::new(held.clone(), gbuffer.select(&held).expect("all there"));
    contradictions(&gbuffer, read).expect("validity")
}

#[test]
fn what_is_right_passes_whichever_of_it_is_read() {
    use Attribute::{Depth, Normal, Position, ToCamera, WorldNormal};
    let networks: [&[Attribute]; 7] = [
        &[Depth],
        &[Normal],
        &[WorldNormal, ToCamera],
        &[WorldNormal, Normal, Position],
        &[Normal, Position],
        &[Normal, Position, Depth],
        &[Position],
    ];
    for family in Family::ALL {
        let gbuffer = rendered_in_full(family);
        for read in networks {
            let found = [alone(&gbuffer, read), contradictions(&gbuffer, read).expect("validity")].concat();
            let grave: Vec<_> = found.iter().filter(|one| one.is_grave(read)).collect();
            assert!(grave.is_empty(), "{}, {read:?}: {grave:?}", family.name());
        }
    }
}

#[test]
fn world_normals_are_told_like_others() {
    let unsigned = with(&room(), Attribute::WorldNormal, |n| 0.5 * n + 0.5);
    for read in [[Attribute::WorldNormal, Attribute::ToCamera], [Attribute::WorldNormal, Attribute::Normal]] {
        assert_eq!(alone(&unsigned, &read), [Contradiction::UnsignedNormals(Attribute::WorldNormal)]);
        let long = alone(&with(&room(), Attribute::WorldNormal, |n| 2.0 * n), &read);
        assert!(matches!(long[..], [Contradiction::NotUnit(Attribute::WorldNormal, ..)]), "{long:?}");
    }
    let ibl = [Attribute::WorldNormal, Attribute::ToCamera];
    let away = alone(&with(&room(), Attribute::WorldNormal, |n| -n), &ibl);
    assert!(matches!(away[..], [one @ Contradiction::FacingAway(_)] if one.is_grave(&ibl)), "{away:?}");
    assert_eq!(alone(&with(&room(), Attribute::ToCamera, |v| -v), &ibl), [Contradiction::FromCamera]);
}

#[test]
fn world_normals_are_a_rotation_of_normals() {
    let read = [Attribute::WorldNormal, Attribute::Normal];
    // Another world with y up.
    let turned = with(&room(), Attribute::WorldNormal, |n| Vec3::new(-n.z, n.y, n.x));
    assert_eq!(alone(&turned, &read), []);
    let mirrored = with(&room(), Attribute::WorldNormal, |n| Vec3::new(n.x, n.y, -n.z));
    assert_eq!(alone(&mirrored, &read), [Contradiction::MirroredWorldNormals]);
    let reversed = with(&room(), Attribute::WorldNormal, |n| -n);
    assert_eq!(alone(&reversed, &read), [Contradiction::MirroredWorldNormals]);
    let count = Cell::new(0.0);
    let other = with(&room(), Attribute::WorldNormal, |_| {
        count.set(count.get() + 1.0f32);
        let k = count.get();
        Vec3::new((12.9 * k).sin(), (78.2 * k + 1.0).sin(), (37.7 * k + 2.0).sin()).normalize()
    });
    let ways = alone(&other, &read);
    assert!(matches!(ways[..], [Contradiction::OtherWorldNormals(share)] if share > 0.5), "{ways:?}");
}

#[test]
fn depth_alone_is_told_by_its_sign_and_by_a_buffers_range() {
    let read = [Attribute::Depth];
    let negative = alone(&with_depth(&room(), |depth| -depth), &read);
    assert_eq!(negative, [Contradiction::Depth(-1.0, DepthKind::Negative)]);
    assert!(negative[0].is_grave(&read));
    // Near plane 0.05 m, far plane 500 m.
    let buffer = with_depth(&room(), |depth| (1.0 - 0.05 / depth) * 500.0 / 499.95);
    assert_eq!(alone(&buffer, &read), [Contradiction::Depth(1.0, DepthKind::Buffer)]);
    // A model of a room, ten centimetres deep.
    let small = with_depth(&room(), |depth| 0.02 * depth);
    assert_eq!(alone(&small, &read), []);
}

#[test]
fn positions_that_are_not_read_tell_of_depth_and_do_no_harm() {
    let read = [Attribute::Depth];
    let found = |gbuffer: &GBuffer| contradictions(gbuffer, &read).expect("validity");
    let inverse = found(&with_depth(&room(), |depth| 1.0 / depth));
    assert!(matches!(inverse[..], [Contradiction::Depth(_, DepthKind::Unknown)]), "{inverse:?}");
    let world = |v: Vec3| Vec3::new(v.y + 3.0, v.z + 4.0, v.x + 5.0);
    assert_eq!(found(&with(&room(), Attribute::Position, world)), []);
    // Normals of that space are read.
    let normal = [Attribute::Normal];
    let both = with(&with(&room(), Attribute::Position, world), Attribute::Normal, |n| n.yzx());
    let ways = contradictions(&both, &normal).expect("validity");
    assert!(matches!(ways[..], [Contradiction::OtherSpace(_)]), "{ways:?}");
}

#[test]
fn reversed_axes_of_normals_are_named() {
    let of = |signs: Vec3| of_room(|_, [p, n], d| ([p, signs * n], d));
    for (signs, axes) in [
        (Vec3::new(1.0, 1.0, -1.0), [false, false, true]),
        (Vec3::new(1.0, -1.0, 1.0), [false, true, false]),
        (Vec3::new(1.0, -1.0, -1.0), [false, true, true]),
        (Vec3::new(-1.0, 1.0, 1.0), [true, false, false]),
    ] {
        assert_eq!(of(signs), [Contradiction::Reversed(axes)], "{signs}");
    }
    let told = Contradiction::Reversed([false, true, true]).to_string();
    assert!(told.contains("(--normals reversed-y,reversed-z)") && told.contains("y and z"), "{told}");
    let all = of(-Vec3::ONE);
    assert!(matches!(all[..], [Contradiction::FacingAway(share)] if share > MOST_AWAY), "{all:?}");
}

/// Of a wall that faces the camera nothing tells whether x or y is reversed, and nothing is said.
#[test]
fn a_wall_says_nothing_of_axes_that_it_does_not_show() {
    let attributes = vec![Attribute::Position, Attribute::Normal, Attribute::Valid];
    let wall = |normal: Vec3| {
        GBuffer::new(
            attributes.clone(),
            Planes::from_fn(7, 24, 32, |c, y, x| match c {
                0 => (x as f32 - 15.5) * 0.1,
                1 => (11.5 - y as f32) * 0.1,
                2 => -3.0,
                6 => 1.0,
                _ => normal[c - 3],
            }),
        )
    };
    let read = [Attribute::Position, Attribute::Normal];
    assert_eq!(contradictions(&wall(Vec3::Z), &read), Ok(Vec::new()));
    let away = contradictions(&wall(Vec3::NEG_Z), &read).expect("validity");
    assert!(matches!(away[..], [Contradiction::FacingAway(_)]), "{away:?}");
}
