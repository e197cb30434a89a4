//! The eight-wide hierarchy against all triangles one by one, on what is awkward: boxes without a volume,
//! rays along axes with zeros of both signs, rays from inside of boxes and from corners.

use super::*;
use crate::bvh::binary_hierarchy;
use crate::sampler::hash;
use glam::{DVec3, Vec3A};
use obvhs::triangle::Triangle;
use std::cell::RefCell;

fn random(i: u32) -> f32 {
    hash(i) as f32 / 4_294_967_296.0
}

fn random_vector(i: u32) -> Vec3 {
    Vec3::new(random(3 * i), random(3 * i + 1), random(3 * i + 2))
}

/// Triangles in a cube of 10 m; of each ten three are flat along an axis, one has no area, one is a point,
/// one is the one before once more.
fn soup(count: u32, size: f32) -> Vec<[Vec3; 3]> {
    let mut soup: Vec<[Vec3; 3]> = Vec::new();
    for i in 0..count {
        let middle = random_vector(7 * i) * 10.0;
        let mut corners = [1, 2, 3].map(|corner| middle + size * random_vector(7 * i + corner));
        match i % 10 {
            axis @ 0..3 => {
                corners.iter_mut().for_each(|corner| corner[axis as usize] = middle[axis as usize])
            }
            3 => corners[2] = corners[0].lerp(corners[1], 0.5),
            4 => corners = [middle; 3],
            5 => corners = soup[i as usize - 1 - 3],
            _ => {}
        }
        soup.push(corners);
    }
    soup
}

fn wide(soup: &[[Vec3; 3]], asked: bool) -> Wide {
    let triangle = |corners: &[Vec3; 3]| {
        let [v0, v1, v2] = corners.map(Vec3A::from);
        Triangle { v0, v1, v2 }
    };
    let triangles: Vec<Triangle> = soup.iter().map(triangle).collect();
    Wide::new(&binary_hierarchy(&triangles), |index| soup[index as usize], |_| asked)
}

/// Every which way, along axes, in planes of axes, with zeros of both signs, from inside and from outside,
/// and from corners of triangles.
fn ray(soup: &[[Vec3; 3]], i: u32) -> Ray {
    let origin = match i % 3 {
        0 => soup[i as usize % soup.len()][0],
        _ => random_vector(2 * i) * 14.0 - 2.0,
    };
    let mut direction = random_vector(2 * i + 1) - 0.5;
    let zero = if i.is_multiple_of(2) { 0.0 } else { -0.0 };
    let axis = i as usize / 4 % 3;
    match i % 4 {
        0 => direction[axis] = zero,
        1 => {
            let along = direction[axis];
            direction = Vec3::splat(zero);
            direction[axis] = along;
        }
        _ => {}
    }
    Ray { origin: origin.into(), direction: direction.into(), reach: f32::INFINITY, time: 0.0 }
}

/// Distance and place of the nearest triangle, each leaf tested by itself, and how many triangles the ray
/// meets.
fn one_by_one(wide: &Wide, ray: &Ray) -> (Option<(f32, u32)>, usize) {
    let asked = RefCell::new(0);
    let of_leaf = |leaf: &Leaf| {
        let mut node = Node::EMPTY;
        let everywhere = Aabb::new(Vec3A::splat(-1e9), Vec3A::splat(1e9));
        node.set(0, &everywhere, Child::leaf(0));
        let leaf = Leaf { corners: leaf.corners, first: leaf.first, asked: u32::MAX };
        let alone = Wide {
            processor: wide.processor,
            nodes: vec![node],
            leaves: vec![leaf],
            ways: vec![],
            order: vec![],
        };
        alone.blocked(ray, |_| {
            *asked.borrow_mut() += 1;
            false
        });
        alone.nearest(ray, |_| true)
    };
    let nearest = wide.leaves.iter().filter_map(of_leaf).min_by(|a, b| a.0.total_cmp(&b.0));
    (nearest, asked.into_inner())
}

fn processors() -> [Processor; 2] {
    [Processor::new(), Processor::Portable]
}

#[test]
fn boxes_hide_nothing() {
    let (soup, mut met) = (soup(600, 5.0), 0);
    for processor in processors() {
        let wide = Wide { processor, ..wide(&soup, false) };
        for i in 0..1_500 {
            let ray = ray(&soup, i);
            let (expected, _) = one_by_one(&wide, &ray);
            let nearest = wide.nearest(&ray, |_| true);
            assert_eq!(nearest.map(|hit| hit.0), expected.map(|hit| hit.0), "{ray:?}");
            assert_eq!(wide.blocked(&ray, |_| true), expected.is_some(), "{ray:?}");
            met += usize::from(expected.is_some());
        }
    }
    assert!((1_000..2_900).contains(&met), "{met} of 3,000 rays met something");
}

#[test]
fn every_triangle_on_the_way_is_asked_once() {
    // Triangles as large as the cube, so that almost all boxes are entered and many visits wait.
    let soup = soup(3_000, 10.0);
    let wide = wide(&soup, true);
    let mut most = 0;
    for i in 0..40 {
        let ray = ray(&soup, i);
        let asked = RefCell::new(Vec::new());
        let blocked = wide.blocked(&ray, |place| {
            asked.borrow_mut().push(place);
            false
        });
        assert!(!blocked, "all of them said no");
        let mut asked = asked.into_inner();
        let (_, expected) = one_by_one(&wide, &ray);
        assert_eq!(asked.len(), expected);
        asked.sort_unstable();
        asked.dedup();
        assert_eq!(asked.len(), expected, "none is asked twice");
        most = most.max(expected);
        // The nearest that says yes is met, and what says no is not there.
        if let Some((near, place)) = wide.nearest(&ray, |_| true) {
            let behind = wide.nearest(&ray, |other| other != place);
            assert!(behind.is_none_or(|(far, other)| far >= near && other != place));
        }
    }
    assert!(most > 100, "at most {most} triangles on a ray");
}

#[test]
fn a_reach_ends_before_what_it_touches() {
    let soup = soup(600, 5.0);
    let wide = wide(&soup, false);
    let mut met = 0;
    for i in 0..500 {
        let ray = ray(&soup, i);
        let Some((distance, place)) = wide.nearest(&ray, |_| true) else { continue };
        let short = Ray { reach: distance, ..ray };
        assert!(wide.nearest(&short, |_| true).is_none() && !wide.blocked(&short, |_| true));
        let enough = Ray { reach: distance.next_up(), ..ray };
        let hit = wide.nearest(&enough, |_| true).map(|hit| hit.0);
        assert_eq!(hit, Some(distance), "triangle {place}");
        assert!(wide.blocked(&enough, |_| true));
        met += 1;
    }
    assert!(met > 200, "{met} rays met something");
}

/// Distance along a ray to a triangle by planes, in f64, and whether that is unclear: where the ray passes an
/// edge within `margin` of the triangle's size, or starts so near.
fn in_f64(corners: &[Vec3; 3], ray: &Ray, margin: f64) -> (Option<f64>, bool) {
    let [a, b, c] = corners.map(DVec3::from);
    let (origin, direction) =
        (DVec3::from(Vec3::from(ray.origin)), DVec3::from(Vec3::from(ray.direction)).normalize());
    let normal = (b - a).cross(c - a);
    if normal.length() < 1e-6 {
        return (None, false);
    }
    let distance = (a - origin).dot(normal) / direction.dot(normal);
    let point = origin + direction * distance;
    let weight =
        |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) / normal.length_squared();
    let least = weight(a, b).min(weight(b, c)).min(weight(c, a));
    let unclear = least.abs() < margin || distance.abs() < margin || !least.is_finite();
    ((least > 0.0 && distance > 0.0 && !unclear).then_some(distance), unclear)
}

#[test]
fn distances_are_those_of_f64() {
    let soup = soup(300, 5.0);
    let (mut met, mut clear) = (0, 0);
    for processor in processors() {
        let wide = Wide { processor, ..wide(&soup, false) };
        for i in 0..1_000 {
            let ray = ray(&soup, i);
            let all: Vec<_> = soup.iter().map(|corners| in_f64(corners, &ray, 1e-4)).collect();
            clear += usize::from(all.iter().all(|(_, unclear)| !unclear));
            let expected = all.iter().filter_map(|(distance, _)| *distance).min_by(f64::total_cmp);
            let nearest = wide.nearest(&ray, |_| true);
            let length = f64::from(ray.direction.length());
            let distance = nearest.map(|(distance, _)| f64::from(distance) * length);
            let same = match (expected, distance) {
                (None, None) => true,
                (Some(a), Some(b)) => (a - b).abs() < 1e-4,
                _ => false,
            };
            // What differs is a triangle that the ray passes at its edge.
            let met_unclear = nearest.is_some_and(|(_, place)| all[wide.order()[place as usize] as usize].1);
            assert!(same || met_unclear, "{expected:?} is not {distance:?} for {ray:?}");
            met += usize::from(same && expected.is_some());
        }
    }
    assert!(met > 600 && clear > 600, "{met} rays met something, {clear} passed no edge");
}

#[test]
fn no_ray_slips_through_an_edge() {
    // A closed double cone around the origin, seen from inside: along all its edges and at its corners.
    let rim = |i: u32| {
        let (sin, cos) = (std::f32::consts::TAU * (i % 7) as f32 / 7.0).sin_cos();
        Vec3::new(1.3 * cos, 0.1, 1.1 * sin)
    };
    let (top, bottom) = (Vec3::new(0.2, 0.9, -0.1), Vec3::new(0.1, -1.0, 0.2));
    let cone = |i: u32| [[top, rim(i), rim(i + 1)], [bottom, rim(i + 1), rim(i)]];
    let hat: Vec<[Vec3; 3]> = (0..7).flat_map(cone).collect();
    for processor in processors() {
        let wide = Wide { processor, ..wide(&hat, false) };
        for step in 0..=500 {
            for [a, b, _] in &hat {
                let direction = a.lerp(*b, step as f32 / 500.0).normalize();
                for origin in [Vec3::ZERO, -0.1 * direction, Vec3::new(0.01, 0.02, 0.03)] {
                    let ray = Ray {
                        origin: origin.into(),
                        direction: direction.into(),
                        reach: f32::INFINITY,
                        time: 0.0,
                    };
                    assert!(wide.blocked(&ray, |_| true), "{ray:?}");
                }
            }
        }
    }
}

#[test]
fn each_triangle_is_in_one_leaf_and_in_all_boxes_above() {
    for count in [1, 2, 7, 8, 9, 100, 3_000] {
        let soup = soup(count, 0.5);
        let wide = wide(&soup, false);
        let mut order = wide.order().to_vec();
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..count));
        let everywhere = [Vec3::splat(f32::NEG_INFINITY), Vec3::splat(f32::INFINITY)];
        let (mut stack, mut leaves) = (vec![(Child::node(0), everywhere)], 0);
        while let Some((child, [low, high])) = stack.pop() {
            if child.0 & Child::LEAF == 0 {
                let Node { bounds, children } = &wide.nodes[child.0 as usize];
                for (slot, child) in children.iter().enumerate() {
                    let side = |i: usize| Vec3::from([0, 1, 2].map(|axis: usize| bounds[axis][i][slot]));
                    if side(0).x <= side(1).x {
                        stack.push((*child, [low.max(side(0)), high.min(side(1))]));
                    }
                }
                continue;
            }
            let index = (child.0 ^ Child::LEAF) as usize;
            let end = wide.leaves.get(index + 1).map_or(count, |next| next.first);
            for place in wide.leaves[index].first..end {
                let corners = soup[wide.order()[place as usize] as usize];
                assert!(corners.iter().all(|corner| corner.cmpge(low).all() && corner.cmple(high).all()));
            }
            leaves += 1;
        }
        assert_eq!(leaves, wide.leaves.len());
    }
}

/// Such a ray meets nothing, and its walk ends.
#[test]
fn a_ray_without_a_direction_meets_nothing() {
    let soup = soup(300, 0.5);
    let wide = wide(&soup, false);
    for direction in [Vec3A::NAN, Vec3A::new(f32::NAN, 0.0, 1.0), Vec3A::new(1.0, f32::NAN, -0.3)] {
        let ray = Ray { origin: Vec3A::splat(5.0), direction, reach: f32::INFINITY, time: 0.0 };
        assert!(wide.nearest(&ray, |_| true).is_none() && !wide.blocked(&ray, |_| true));
        let fan = Fan { origin: Vec3::splat(5.0), directions: &[direction.into(); 3], reach: 10.0 };
        assert_eq!(wide.all_blocked(fan, |_, _| true), 0);
    }
}
