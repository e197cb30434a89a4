//! Meshes: the primitives that a scene shows, each read once, morphed, skinned or placed by its node, in
//! world space (glTF 2.0, 3.7).

use super::{
    super::{MaterialId, Mesh, SceneError, finish::finish},
    animation::Pose,
    document::File,
    instances::{Instance, instances},
    morph::morphed,
    node::Hierarchy,
    skin::{Influences, joint_matrices, missing_joint, vertex_matrix},
    vertex_transform::{VertexTransform, placed},
};
use glam::{Mat4, Vec3, Vec4};
use gltf::{Semantic, accessor::Dimensions, mesh::Mode};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// All triangle meshes that the scene shows, in world space, in the order of its nodes.
pub(super) fn read(file: &File<'_>, hierarchy: &Hierarchy, pose: &Pose) -> Result<Vec<Mesh>, SceneError> {
    let instances = instances(file, hierarchy)?;
    let unique: BTreeMap<_, _> = instances.iter().map(|instance| (instance.key, instance)).collect();
    let parts: BTreeMap<_, _> = unique
        .into_par_iter()
        .map(|(key, instance)| Ok((key, RestPrimitive::read(file, instance)?)))
        .collect::<Result<_, SceneError>>()?;
    let skins: BTreeMap<_, _> = instances
        .iter()
        .filter_map(|instance| instance.node.skin())
        .map(|skin| (skin.index(), skin))
        .collect();
    let skins: BTreeMap<_, _> = skins
        .into_iter()
        .map(|(index, skin)| Ok((index, joint_matrices(file, &skin, hierarchy)?)))
        .collect::<Result<_, SceneError>>()?;
    instances
        .par_iter()
        .map(|instance| {
            let weights = &pose.weights[instance.node.index()];
            let joints = instance.node.skin().map(|skin| skins[&skin.index()].as_slice());
            parts[&instance.key].place(file, instance, weights, joints)
        })
        .collect()
}

/// A primitive at rest, in the space of its mesh.
pub(super) struct RestPrimitive {
    pub rest: Mesh,
    /// What it follows where it has a skin; one for every four joints a vertex.
    pub influences: Vec<Influences>,
}

impl RestPrimitive {
    pub fn read(file: &File<'_>, instance: &Instance<'_>) -> Result<Self, SceneError> {
        let vertices = instance.primitive.get(&Semantic::Positions).map_or(0, |accessor| accessor.count());
        let attributes = Attributes { file, instance, vertices };
        let positions = vectors(attributes.floats(Semantic::Positions)?);
        let uvs = [
            vectors(attributes.floats::<2>(Semantic::TexCoords(0))?),
            vectors(attributes.floats::<2>(Semantic::TexCoords(1))?),
        ];
        // Spec: tangents without normals mean nothing.
        let normals = vectors::<Vec3, 3>(attributes.floats(Semantic::Normals)?);
        let tangents = if normals.is_empty() { None } else { attributes.floats(Semantic::Tangents)? };
        let material = instance.primitive.material().index().unwrap_or(file.document.materials().len());
        let rest = Mesh {
            name: instance.name.clone(),
            material: MaterialId(material as u32),
            positions,
            normals,
            tangents: vectors(tangents),
            displacements: Vec::new(),
            uvs,
            colours: attributes.colours()?,
            triangles: attributes.triangles()?,
        };
        Ok(Self { rest, influences: attributes.influences()? })
    }

    /// For each vertex the joints that it follows, with their weights.
    pub fn followed(&self) -> Vec<Vec<(u32, f32)>> {
        let of = |vertex: usize| {
            let sets = self.influences.iter();
            let all = sets.flat_map(|set| set.joints[vertex].into_iter().zip(set.weights[vertex]));
            all.filter(|(_, weight)| *weight != 0.0).collect()
        };
        (0..self.rest.positions.len()).map(of).collect()
    }

    /// Whether a skin has all the joints that vertices follow.
    pub fn check_joints(&self, file: &File<'_>, joints: usize) -> Result<(), SceneError> {
        missing_joint(&self.influences, joints).map_or(Ok(()), |joint| {
            let name = &self.rest.name;
            Err(file.invalid(format!("mesh `{name}` follows joint {joint} of a skin with {joints}")))
        })
    }

    /// The primitive in the world, as a node shows it. A skinned one ignores its node's own place (3.7.3.3).
    fn place(
        &self,
        file: &File<'_>,
        instance: &Instance<'_>,
        weights: &[f32],
        joints: Option<&[Mat4]>,
    ) -> Result<Mesh, SceneError> {
        let morphed = morphed(file, &instance.primitive, &self.rest, weights)?;
        let rest = morphed.as_ref().unwrap_or(&self.rest);
        let mesh = match joints {
            Some(joints) if !self.influences.is_empty() => {
                self.check_joints(file, joints.len())?;
                placed(rest, |vertex| VertexTransform::new(vertex_matrix(&self.influences, joints, vertex)))
            }
            _ => {
                let place = VertexTransform::new(instance.world);
                placed(rest, |_| place)
            }
        };
        finish(mesh).map_err(|what| file.invalid(what))
    }
}

/// The vertex attributes of a primitive.
struct Attributes<'a> {
    file: &'a File<'a>,
    instance: &'a Instance<'a>,
    vertices: usize,
}

impl Attributes<'_> {
    /// The values of an attribute, if the primitive has it.
    fn floats<const N: usize>(&self, semantic: Semantic) -> Result<Option<Vec<[f32; N]>>, SceneError> {
        let Some(accessor) = self.instance.primitive.get(&semantic) else { return Ok(None) };
        let user = self.user(&semantic);
        self.check_count(accessor.count(), &user)?;
        self.file.floats(&accessor, user).map(Some)
    }

    /// Vertex colours, opaque where they have no alpha.
    fn colours(&self) -> Result<Vec<Vec4>, SceneError> {
        let semantic = Semantic::Colors(0);
        match self.instance.primitive.get(&semantic).map(|accessor| accessor.dimensions()) {
            Some(Dimensions::Vec3) => {
                let colours = vectors::<Vec3, 3>(self.floats(semantic)?);
                Ok(colours.into_iter().map(|colour| colour.extend(1.0)).collect())
            }
            _ => Ok(vectors::<Vec4, 4>(self.floats(semantic)?)),
        }
    }

    /// Joints and weights, for as many sets as there are from 0 on.
    fn influences(&self) -> Result<Vec<Influences>, SceneError> {
        let mut sets = Vec::new();
        for set in 0.. {
            let Some(accessor) = self.instance.primitive.get(&Semantic::Joints(set)) else { break };
            let user = self.user(&Semantic::Joints(set));
            self.check_count(accessor.count(), &user)?;
            let weights = self.floats(Semantic::Weights(set))?;
            let weights =
                weights.ok_or_else(|| self.file.invalid(format!("{user}: joints without weights")))?;
            sets.push(Influences { joints: self.file.integers(&accessor, user)?, weights });
        }
        Ok(sets)
    }

    /// Three vertices a triangle, for any of the modes that draw triangles (3.7.2.1).
    fn triangles(&self) -> Result<Vec<[u32; 3]>, SceneError> {
        let name = &self.instance.name;
        let corners: Vec<u32> = match self.instance.primitive.indices() {
            Some(accessor) => {
                self.file.integers::<1>(&accessor, format!("indices of mesh `{name}`"))?.into_flattened()
            }
            None => (0..self.vertices as u32).collect(),
        };
        if let Some(corner) = corners.iter().find(|corner| **corner as usize >= self.vertices) {
            let vertices = self.vertices;
            return Err(self
                .file
                .invalid(format!("mesh `{name}`: index {corner} is out of range of {vertices} vertices")));
        }
        let strip =
            |(index, &[a, b, c]): (usize, &[u32; 3])| if index % 2 == 0 { [a, b, c] } else { [a, c, b] };
        Ok(match self.instance.primitive.mode() {
            Mode::TriangleStrip => corners.array_windows::<3>().enumerate().map(strip).collect(),
            Mode::TriangleFan => match corners.split_first() {
                Some((centre, rim)) => rim.array_windows::<2>().map(|&[a, b]| [a, b, *centre]).collect(),
                None => Vec::new(),
            },
            _ => corners.as_chunks::<3>().0.to_vec(),
        })
    }

    fn check_count(&self, count: usize, user: &str) -> Result<(), SceneError> {
        let vertices = self.vertices;
        let error = || self.file.invalid(format!("{user}: {count} values for {vertices} vertices"));
        (count == vertices).then_some(()).ok_or_else(error)
    }

    fn user(&self, semantic: &Semantic) -> String {
        format!("{} of mesh `{}`", semantic.to_string(), self.instance.name)
    }
}

/// Values as vectors; none where there is no attribute.
fn vectors<V: From<[f32; N]>, const N: usize>(values: Option<Vec<[f32; N]>>) -> Vec<V> {
    values.unwrap_or_default().into_iter().map(V::from).collect()
}
