//! Vertices and triangles on the GPU, in world space: what moves first, so that it lies in one piece.

use crate::scene::gltf::Rig;
use crate::scene::{AnimatedScene, Mesh, Scene};
use deepshade_shaders::gpu::{self, GpuError};
use glam::{Vec2, Vec3, Vec4};
use std::collections::BTreeSet;
use wgpu::BufferUsages;

/// Numbers of a vertex that change over time: position, normal, tangent with sign, displacement while the
/// shutter is open, way since the frame before.
pub const POSED: usize = 16;

/// Numbers of a vertex that stay: two sets of texture coordinates, colour with alpha.
const STAYING: usize = 8;

/// A mesh's triangles in the buffers.
#[derive(Clone, Debug)]
pub struct Draw {
    /// Index of the mesh in the scene.
    pub mesh: u32,
    /// Index of its material.
    pub material: u32,
    /// Its first vertex.
    pub first_vertex: u32,
    /// Number of its vertices.
    pub vertices: u32,
    /// Its indices, relative to its first vertex.
    pub indices: std::ops::Range<u32>,
}

/// A scene's triangles on the GPU.
#[derive(Debug)]
pub struct Geometry {
    /// `[vertices, 16]` f32.
    pub posed: wgpu::Buffer,
    /// `[vertices, 8]` f32.
    pub staying: wgpu::Buffer,
    /// `[triangles, 3]` u32.
    pub indices: wgpu::Buffer,
    /// All meshes; those that move come first.
    pub draws: Vec<Draw>,
    /// Vertices that move, from the first on.
    pub moving: u32,
}

impl Geometry {
    /// Sends all meshes of a scene.
    ///
    /// # Errors
    /// If the device has no room; the buffer that is too large is named.
    pub fn new(device: &wgpu::Device, animated: &AnimatedScene) -> Result<Self, GpuError> {
        let Scene { meshes, .. } = &animated.scene;
        let follows: BTreeSet<usize> =
            animated.rigs.iter().flat_map(|rig: &Rig| &rig.parts).map(|part| part.mesh).collect();
        // In the order of the rigs' parts, which is that of their poses.
        let first = animated.rigs.iter().flat_map(|rig| &rig.parts).map(|part| part.mesh);
        let rest = (0..meshes.len()).filter(|mesh| !follows.contains(mesh));
        let order: Vec<usize> = first.chain(rest).collect();

        let draws = draws(&animated.scene, &order);
        let moving = draws
            .iter()
            .filter(|draw| follows.contains(&(draw.mesh as usize)))
            .map(|draw| draw.vertices)
            .sum();
        let all = || order.iter().map(|at| &meshes[*at]);
        let posed: Vec<f32> = all().flat_map(posed).collect();
        let staying: Vec<f32> = all().flat_map(staying).collect();
        let indices: Vec<u32> = all().flat_map(|mesh| mesh.triangles.iter().flatten().copied()).collect();
        let usage = BufferUsages::VERTEX | BufferUsages::COPY_SRC;
        // What is bound of it has to meet the limit of a binding: what moves, and for surfels all.
        let posed_usage = usage | BufferUsages::STORAGE;
        Ok(Self {
            posed: gpu::filled(device, "frame.posed", bytemuck::cast_slice(&posed), posed_usage)?,
            staying: gpu::filled(device, "frame.staying", bytemuck::cast_slice(&staying), usage)?,
            indices: gpu::filled(
                device,
                "frame.indices",
                bytemuck::cast_slice(&indices),
                BufferUsages::INDEX,
            )?,
            draws,
            moving,
        })
    }

    /// Vertex buffers of raster passes: 0 what changes, 1 what stays.
    pub const LAYOUTS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
        Some(wgpu::VertexBufferLayout {
            array_stride: 4 * POSED as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![
                0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x3, 4 => Float32x3
            ],
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: 4 * STAYING as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![5 => Float32x4, 6 => Float32x4],
        }),
    ];
}

/// Where the meshes of a scene lie in the buffers, in this order.
fn draws(scene: &Scene, order: &[usize]) -> Vec<Draw> {
    let (mut vertex, mut index) = (0, 0);
    let draw = |&at: &usize| {
        let mesh = &scene.meshes[at];
        let (vertices, corners) = (mesh.positions.len() as u32, 3 * mesh.triangles.len() as u32);
        let (first_vertex, indices) = (vertex, index..index + corners);
        (vertex, index) = (vertex + vertices, index + corners);
        Draw { mesh: at as u32, material: mesh.material.0, first_vertex, vertices, indices }
    };
    order.iter().map(draw).collect()
}

/// Where the meshes of a scene that stays lie in the buffers.
pub fn draws_of(scene: &Scene) -> Vec<Draw> {
    draws(scene, &(0..scene.meshes.len()).collect::<Vec<_>>())
}

/// The numbers of a mesh's vertices that change. What a mesh has not is 0.
fn posed(mesh: &Mesh) -> impl Iterator<Item = f32> {
    (0..mesh.positions.len()).flat_map(|i| {
        let position = mesh.positions[i].to_array();
        let normal = mesh.normals.get(i).copied().unwrap_or(Vec3::ZERO).to_array();
        let tangent = mesh.tangents.get(i).copied().unwrap_or(Vec4::ZERO).to_array();
        let displacement = mesh.displacements.get(i).copied().unwrap_or(Vec3::ZERO).to_array();
        position.into_iter().chain(normal).chain(tangent).chain(displacement).chain([0.0; 3])
    })
}

fn staying(mesh: &Mesh) -> impl Iterator<Item = f32> {
    (0..mesh.positions.len()).flat_map(|i| {
        let uv = |set: usize| mesh.uvs[set].get(i).copied().unwrap_or(Vec2::ZERO).to_array();
        let colour = mesh.colours.get(i).copied().unwrap_or(Vec4::ONE).to_array();
        uv(0).into_iter().chain(uv(1)).chain(colour)
    })
}
