//! What of a glTF file moves: the tracks of its animation, its nodes, and the vertices that follow them, so
//! that a file can be posed at any moment without being read again.

use super::animation::Tracks;
use super::document::File;
use super::instances::{Instance, instances};
use super::mesh::RestPrimitive;
use super::morph::{MorphTarget, targets};
use super::node::{Hierarchy, worlds};
use super::skin::inverse_bind_matrices;
use crate::scene::{Light, Mesh, SceneError};
use glam::Mat4;

/// A file's animation and all that follows it.
#[derive(Clone, Debug)]
pub struct Rig {
    tracks: Tracks,
    parents: Vec<Option<usize>>,
    order: Vec<usize>,
    /// What moves, by the index of its mesh in the scene.
    pub parts: Vec<RigPart>,
    /// Lights that move, by their index in the scene, with their nodes.
    lights: Vec<(usize, usize)>,
    /// Put before all: where the file stands in a larger scene.
    root: Mat4,
}

/// A mesh whose vertices move.
#[derive(Clone, Debug)]
pub struct RigPart {
    /// Index of the mesh in the file's scene.
    pub mesh: usize,
    /// Positions, normals and tangents before anything moves them.
    pub rest: Mesh,
    /// For each vertex the matrices that it follows, by their index among the part's, with their weights.
    pub influences: Vec<Vec<(u32, f32)>>,
    /// What morph targets add at full weight.
    pub targets: Vec<MorphTarget>,
    /// Node whose morph weights it has.
    node: usize,
    /// For each matrix its node and what comes before it: of a joint the inverse bind matrix. None has the
    /// one of vertices that follow no joint and stay.
    matrices: Vec<(Option<usize>, Mat4)>,
}

/// Where everything that moves is at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct RigPose {
    /// The matrices of all parts one after the other.
    pub matrices: Vec<Mat4>,
    /// The morph weights of all parts one after the other.
    pub weights: Vec<f32>,
}

impl Rig {
    /// The rig of a file; `None` where nothing moves.
    pub(super) fn read(file: &File<'_>) -> Result<Option<Self>, SceneError> {
        let tracks = Tracks::read(file)?;
        let pose = tracks.at(f32::NEG_INFINITY);
        let hierarchy = Hierarchy::new(file, &pose)?;
        let moving = moving(&tracks, &hierarchy);
        let mut parts = Vec::new();
        for (mesh, instance) in instances(file, &hierarchy)?.iter().enumerate() {
            let node = instance.node.index();
            let joints = || instance.node.skin().into_iter().flat_map(|skin| skin.joints());
            let follows = moving[node] || joints().any(|joint| moving[joint.index()]);
            if follows || tracks.weighs(node) {
                parts.push(RigPart::read(file, mesh, instance)?);
            }
        }
        let shining = hierarchy.nodes(file).filter(|(node, _)| node.light().is_some());
        let lights = shining.enumerate().map(|(light, (node, _))| (light, node.index()));
        let lights: Vec<_> = lights.filter(|(_, node)| moving[*node]).collect();
        let Hierarchy { parents, order, .. } = hierarchy;
        let stays = parts.is_empty() && lights.is_empty();
        Ok((!stays).then_some(Self { tracks, parents, order, parts, lights, root: Mat4::IDENTITY }))
    }

    /// The same for a scene whose meshes were numbered anew; what has no place is left out.
    #[must_use]
    pub(in crate::scene) fn renumbered(mut self, places: &[Option<usize>]) -> Self {
        self.parts.retain_mut(|part| {
            let place = places.get(part.mesh).copied().flatten();
            part.mesh = place.unwrap_or(part.mesh);
            place.is_some()
        });
        self
    }

    /// The same for a scene that has so many meshes and lights before these.
    #[must_use]
    pub(in crate::scene) fn after(mut self, meshes: usize, lights: usize) -> Self {
        self.parts.iter_mut().for_each(|part| part.mesh += meshes);
        self.lights.iter_mut().for_each(|(light, _)| *light += lights);
        self
    }

    /// The same, standing elsewhere.
    #[must_use]
    pub fn placed(self, root: Mat4) -> Self {
        Self { root: root * self.root, ..self }
    }

    /// Where everything is at a time, in seconds; the first or last pose outside the animation.
    pub fn pose(&self, time: f32) -> RigPose {
        let pose = self.tracks.at(time);
        let worlds = worlds(&pose.locals, &self.parents, &self.order);
        let matrix = |(node, before): &(Option<usize>, Mat4)| {
            self.root * node.map_or(Mat4::IDENTITY, |node| worlds[node]) * *before
        };
        RigPose {
            matrices: self.parts.iter().flat_map(|part| &part.matrices).map(matrix).collect(),
            weights: self
                .parts
                .iter()
                .flat_map(|part| {
                    (0..part.targets.len()).map(|target| weight(&pose.weights[part.node], target))
                })
                .collect(),
        }
    }

    /// Moves a scene's lights to where they are at a time, in seconds.
    pub(crate) fn light(&self, lights: &mut [Light], time: f32) {
        if self.lights.is_empty() {
            return;
        }
        let worlds = worlds(&self.tracks.at(time).locals, &self.parents, &self.order);
        for (light, node) in &self.lights {
            let Some(light) = lights.get_mut(*light) else { continue };
            let world = self.root * worlds[*node];
            let along = -world.z_axis.truncate();
            *light = light.moved(|_| world.w_axis.truncate(), |direction| along.normalize_or(direction));
        }
    }

    /// When the animation begins and ends, seconds.
    pub fn span(&self) -> [f32; 2] {
        self.tracks.span().unwrap_or([0.0; 2])
    }
}

impl RigPart {
    fn read(file: &File<'_>, mesh: usize, instance: &Instance<'_>) -> Result<Self, SceneError> {
        let part = RestPrimitive::read(file, instance)?;
        let targets = targets(file, &instance.primitive, &part.rest)?;
        let node = instance.node.index();
        let (matrices, influences) = match instance.node.skin() {
            Some(skin) if !part.influences.is_empty() => {
                let inverse = inverse_bind_matrices(file, &skin)?;
                part.check_joints(file, inverse.len())?;
                let joints = skin.joints().map(|joint| joint.index());
                let mut matrices: Vec<_> = joints.map(Some).zip(inverse).collect();
                let mut influences = part.followed();
                let stays = matrices.len() as u32;
                for vertex in &mut influences {
                    if vertex.iter().map(|(_, weight)| weight).sum::<f32>() <= 0.0 {
                        *vertex = vec![(stays, 1.0)];
                    }
                }
                matrices.push((None, Mat4::IDENTITY));
                (matrices, influences)
            }
            // An instance stands beside its node.
            _ => (vec![(Some(node), instance.local)], vec![vec![(0, 1.0)]; part.rest.positions.len()]),
        };
        Ok(Self { mesh, rest: part.rest, influences, targets, node, matrices })
    }

    /// How many matrices it follows.
    pub fn matrix_count(&self) -> usize {
        self.matrices.len()
    }
}

/// A morph target's weight; 0 where the node has none.
fn weight(weights: &[f32], target: usize) -> f32 {
    weights.get(target).copied().unwrap_or(0.0)
}

/// Which nodes an animated node carries along.
fn moving(tracks: &Tracks, hierarchy: &Hierarchy) -> Vec<bool> {
    let mut moving: Vec<bool> = (0..hierarchy.worlds.len()).map(|node| tracks.moves(node)).collect();
    for node in &hierarchy.order {
        moving[*node] |= hierarchy.parents[*node].is_some_and(|parent| moving[parent]);
    }
    moving
}
