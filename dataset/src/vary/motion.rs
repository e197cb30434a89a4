//! Objects that move: "for training, we randomly move objects inside the scene for random distances. Motions
//! are restricted to those which are parallel to the image plane" (thesis 7.4).

use super::draw::{between, purpose};
use crate::random::uniform;
use crate::views;
use deepshade_render::bvh::TracedScene;
use deepshade_render::scene::Camera;
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::TAU;

/// Share of the objects that move.
const MOVING: f32 = 0.75;

/// How far every vertex of every object moves. Objects that move by themselves, in an animated file, keep
/// their ways. Those of others are drawn in pixels, for an object's visible point that is nearest to the
/// camera, of a grid of those; what the camera does not see stands still.
pub(super) fn displacements(
    scene: &TracedScene,
    camera: &Camera,
    size: [usize; 2],
    range: [f32; 2],
    seed: u32,
) -> Vec<Vec<Vec3>> {
    let mut depths: HashMap<u32, f32> = HashMap::new();
    for point in views::seen_points(scene, camera, size) {
        let depth = -camera.to_camera(point.position).z;
        depths.entry(point.mesh).and_modify(|nearest| *nearest = nearest.min(depth)).or_insert(depth);
    }
    let way = |index: usize, vertices: usize| {
        let depth = depths.get(&(index as u32))?;
        let draw = |which: u64| uniform(&[u64::from(seed), purpose::MOTION, index as u64, which]);
        if draw(0) >= MOVING {
            return None;
        }
        let length = between(range, draw(1)) * depth / camera.focal_length(size[0]);
        let across = Vec2::from_angle(TAU * draw(2)) * length;
        Some(vec![camera.rotation * across.extend(0.0); vertices])
    };
    let meshes = scene.scene().meshes.iter().enumerate();
    meshes
        .map(|(index, mesh)| match mesh.displacements.as_slice() {
            [] => way(index, mesh.positions.len()).unwrap_or_default(),
            own => own.to_vec(),
        })
        .collect()
}
