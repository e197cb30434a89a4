//! Veach's plates (1997, figure 9.2): four plates from smooth to rough that reflect four lamps from small to
//! large. Small lamps in rough plates are found by sampling lights, large ones in smooth plates by sampling
//! reflectances, and both together must not be much worse than the better of the two in any of the sixteen.

use super::*;
use crate::path::proving::Comparison;
use glam::Vec2;

/// Roughness of the plates, from the far one to the near one.
const ROUGHNESS: [f32; 4] = [0.08, 0.2, 0.35, 0.6];

/// Half edges of the square lamps, whose power is the same.
const HALF_EDGES: [f32; 4] = [0.02, 0.08, 0.25, 0.7];

/// The variance of both together may be that many times the better one's, and
const RELATIVELY_WORSE: f64 = 1.1;
/// that many squared means more. Veach (theorem 9.2) proves 1 and 1/2 for one sample each and the balance
/// heuristic.
const SQUARED_MEANS: f64 = 0.05;

const EYE: Vec3 = Vec3::new(0.0, 2.0, 12.0);

fn lamp_middle(lamp: usize) -> Vec3 {
    Vec3::new(-3.6 + 2.4 * lamp as f32, 4.0, -2.0)
}

/// A square that faces `normal`.
fn facing(middle: Vec3, normal: Vec3, half: Vec2, material: usize) -> Mesh {
    let right = Vec3::X * half.x;
    let up = normal.cross(Vec3::X).normalize() * half.y;
    let corners = [-right - up, right - up, right + up, up - right].map(|corner| middle + corner);
    Mesh { material: MaterialId(material as u32), ..quad(corners) }
}

/// A plate tilted so that the eye sees the lamps in its middle.
fn plate(index: usize) -> (Vec3, Vec3) {
    let middle = Vec3::new(0.0, -0.6 * index as f32, 1.5 * index as f32);
    let lamps = Vec3::new(0.0, 4.0, -2.0);
    (middle, ((EYE - middle).normalize() + (lamps - middle).normalize()).normalize())
}

fn plates() -> TracedScene {
    let mut scene = Scene::default();
    for (index, roughness) in ROUGHNESS.into_iter().enumerate() {
        let (middle, normal) = plate(index);
        scene.meshes.push(facing(middle, normal, Vec2::new(5.0, 0.6), index));
        scene.materials.push(Material {
            metallic: 1.0,
            roughness,
            ..Material::matte("plate", Vec3::splat(0.9))
        });
    }
    for (index, half) in HALF_EDGES.into_iter().enumerate() {
        scene.meshes.push(facing(lamp_middle(index), Vec3::NEG_Y, Vec2::splat(half), 4 + index));
        let emission = Vec3::splat(1.0 / (half * half));
        scene.materials.push(Material { emission, ..lambert(0.0) });
    }
    traced(scene)
}

/// Mean and variance of a sample of direct light where a plate mirrors the middle of a lamp, or a little
/// beside.
fn reflection(scene: &TracedScene, finding: Finding, plate_index: usize, lamp: usize) -> (f64, f64) {
    let (middle, normal) = plate(plate_index);
    // The mirror image of the lamp, seen from the eye, through the plate.
    let image = lamp_middle(lamp) - normal * (2.0 * (lamp_middle(lamp) - middle).dot(normal));
    let transport = Transport::new(scene).with_bounces(1).with_finding(finding);
    let count = 3_000;
    let (mut sum, mut squares) = (0.0f64, 0.0f64);
    for i in 0..count {
        let mut stream = Stream::new(PixelSampler::new(i, plate_index, lamp as u32), 0);
        let beside = (stream.next_2d() - 0.5) * 0.6;
        let direction = (image + Vec3::new(beside.x, beside.y, 0.0) - EYE).normalize();
        let value = f64::from(transport.split(EYE, direction, &mut stream).direct.x);
        sum += value;
        squares += value * value;
    }
    let mean = sum / count as f64;
    (mean, squares / count as f64 - mean * mean)
}

#[test]
fn both_ways_together_are_not_much_worse_than_the_better_one() {
    let scene = plates();
    let mut better = [0; 2];
    let mut worst = [0.0f64; 3];
    let mut total = [0.0; 3];
    for plate in 0..4 {
        for lamp in 0..4 {
            let of = |finding| reflection(&scene, finding, plate, lamp);
            let [both, lights, paths] = [Finding::Both, Finding::Lights, Finding::Paths].map(of);
            // A way that missed most of the light says nothing of its variance, which is the larger.
            let known =
                |(mean, variance): (f64, f64)| if mean > 0.5 * both.0 { variance } else { f64::INFINITY };
            let least = known(lights).min(known(paths));
            better[usize::from(known(paths) < known(lights))] += 1;
            for (total, (_, variance)) in total.iter_mut().zip([both, lights, paths]) {
                *total += variance;
            }
            assert!(both.0 > 0.0, "plate {plate} shows lamp {lamp}");
            let over_best = |(_, variance): (f64, f64)| (variance - SQUARED_MEANS * both.0 * both.0) / least;
            for (worst, way) in worst.iter_mut().zip([both, lights, paths]) {
                *worst = worst.max(over_best(way));
            }
        }
    }
    for (way, value) in worst.into_iter().enumerate() {
        let comparison = Comparison {
            name: "veach/mis_over_best",
            value,
            expected: RELATIVELY_WORSE,
            standard_error: None,
            within: value <= RELATIVELY_WORSE,
            // Each way alone.
            control: way > 0,
        };
        comparison.record_and_assert();
    }
    assert!(better.iter().all(|count| *count >= 4), "each is the better one somewhere: {better:?}");
    assert!(total[0] < 0.5 * total[1].min(total[2]), "and together they beat each alone: {total:?}");
}
