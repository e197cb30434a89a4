//! Meshes of what moves at any moment, on the CPU: for rays, which see what the GPU draws of the same rig.

use super::rig::{Rig, RigPart, RigPose};
use super::vertex_transform::{VertexTransform, placed};
use crate::scene::finish::finish;
use crate::scene::{Mesh, Meshes};
use glam::{Mat4, Vec3};
use std::ops::Range;

impl Rig {
    /// Puts the meshes that move to where they are at `time`, seconds, with the displacements of their
    /// vertices in the `shutter` seconds around that, as [`load`](super::load) does.
    ///
    /// # Errors
    /// If a vertex is no number then; its mesh is named.
    pub(in crate::scene) fn put(&self, meshes: &mut Meshes, time: f32, shutter: f32) -> Result<(), String> {
        let pose = self.pose(time);
        let ends = (shutter > 0.0).then(|| [-0.5, 0.5].map(|share| self.pose(time + share * shutter)));
        for (part, matrices, weights) in self.placed_parts() {
            let at =
                |pose: &RigPose| part.at(&pose.matrices[matrices.clone()], &pose.weights[weights.clone()]);
            let Some(mesh) = meshes.get_mut(part.mesh) else { continue };
            let material = mesh.material;
            *mesh = Mesh { material, ..finish(at(&pose))? };
            if let Some([before, after]) = ends.as_ref().map(|ends| ends.each_ref().map(at))
                && before.positions != after.positions
            {
                let ways = before.positions.iter().zip(&after.positions);
                mesh.displacements = ways.map(|(before, after)| *after - *before).collect();
            }
        }
        Ok(())
    }

    /// The corners of a mesh's triangle where they are at `time`, seconds; none of a mesh that stays.
    pub(in crate::scene) fn corners(&self, mesh: usize, triangle: usize, time: f32) -> Option<[Vec3; 3]> {
        let (part, matrices, weights) = self.placed_parts().find(|(part, ..)| part.mesh == mesh)?;
        let pose = self.pose(time);
        Some(part.at(&pose.matrices[matrices], &pose.weights[weights]).corners(triangle))
    }

    /// All parts, each with the matrices and the morph weights of a pose that are its own.
    fn placed_parts(&self) -> impl Iterator<Item = (&RigPart, Range<usize>, Range<usize>)> {
        self.parts.iter().scan((0, 0), |(matrices, weights), part| {
            let [first, target] = [*matrices, *weights];
            *matrices += part.matrix_count();
            *weights += part.targets.len();
            Some((part, first..*matrices, target..*weights))
        })
    }
}

impl RigPart {
    /// The mesh where its matrices and morph weights take it.
    fn at(&self, matrices: &[Mat4], weights: &[f32]) -> Mesh {
        let mut rest = self.rest.clone();
        for (target, weight) in self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            target.add_to(&mut rest, *weight);
        }
        if let [matrix] = matrices {
            let place = VertexTransform::new(*matrix);
            return placed(&rest, |_| place);
        }
        placed(&rest, |vertex| VertexTransform::new(mean(&self.influences[vertex], matrices)))
    }
}

/// The mean of the matrices that a vertex follows, by their weights.
fn mean(influences: &[(u32, f32)], matrices: &[Mat4]) -> Mat4 {
    let sum = influences
        .iter()
        .fold(Mat4::ZERO, |sum, (matrix, weight)| sum + matrices[*matrix as usize] * *weight);
    sum * (1.0 / influences.iter().map(|(_, weight)| weight).sum::<f32>())
}
