//! How far what is animated gets: boxes that hold it at any moment.

use super::rig::{Rig, RigPart};
use crate::scene::Bounds;
use glam::Vec3;

/// Moments of an animation that are looked at. Between two of them it may reach a little farther.
const MOMENTS: u16 = 256;

impl Rig {
    /// The box around all vertices at all moments. No vertex leaves the boxes of those that follow the same
    /// matrix, taken along by each of them, since it goes to a mean of where they take it.
    pub fn reach(&self) -> Bounds {
        let [begin, end] = self.span();
        let boxes: Vec<_> = self.parts.iter().map(|part| (boxes(part), ways(part))).collect();
        let mut reach = Bounds::EMPTY;
        for moment in 0..=MOMENTS {
            let pose = self.pose(begin + (end - begin) * f32::from(moment) / f32::from(MOMENTS));
            let (mut matrices, mut weights) = (pose.matrices.as_slice(), pose.weights.as_slice());
            for (boxes, ways) in &boxes {
                let (of_part, rest) = matrices.split_at(boxes.len());
                let (of_targets, others) = weights.split_at(ways.len());
                (matrices, weights) = (rest, others);
                let [low, high] = morphed(ways, of_targets);
                for (bounds, matrix) in boxes.iter().zip(of_part) {
                    let Some(Bounds { min, max }) = *bounds else { continue };
                    let corners = Bounds { min: min + low, max: max + high }.corners();
                    let corners = corners.map(|corner| matrix.transform_point3(corner));
                    reach = corners.into_iter().fold(reach, Bounds::grow);
                }
            }
        }
        reach
    }
}

/// For each of a part's matrices the box around the vertices that follow it, at rest.
fn boxes(part: &RigPart) -> Vec<Option<Bounds>> {
    let mut boxes = vec![None; part.matrix_count()];
    for (position, influences) in part.rest.positions.iter().zip(&part.influences) {
        for (matrix, _) in influences {
            let bounds: &mut Option<Bounds> = &mut boxes[*matrix as usize];
            *bounds = Some(bounds.unwrap_or(Bounds::EMPTY).grow(*position));
        }
    }
    boxes
}

/// For each of a part's morph targets the lowest and highest that it displaces any vertex at full weight.
fn ways(part: &RigPart) -> Vec<[Vec3; 2]> {
    let ends = |ways: &[Vec3]| [Vec3::min, Vec3::max].map(|end| ways.iter().copied().fold(Vec3::ZERO, end));
    part.targets.iter().map(|target| ends(&target.positions)).collect()
}

/// The lowest and highest that all targets displace any vertex.
fn morphed(ways: &[[Vec3; 2]], weights: &[f32]) -> [Vec3; 2] {
    ways.iter().zip(weights).fold([Vec3::ZERO; 2], |[low, high], (ends, weight)| {
        let [a, b] = ends.map(|end| end * *weight);
        [low + a.min(b), high + a.max(b)]
    })
}
