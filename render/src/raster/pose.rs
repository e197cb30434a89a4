//! Moves the vertices that are animated, on the GPU: morph targets and joints, at the frame's moment and at
//! both ends of the time for which the shutter is open.

use super::geometry::{Geometry, POSED};
use super::groups;
use crate::scene::AnimatedScene;
use crate::scene::gltf::{Rig, RigPart};
use deepshade_shaders::gpu::{self, BoundPass, Gpu, GpuError, Pass};
use deepshade_shaders::wgsl::{Shader, uniforms};
use glam::{Mat4, Vec3};

/// The pass that poses, with what it reads.
#[derive(Debug)]
pub struct Posing {
    pass: BoundPass,
    workgroups: [u32; 3],
    settings: uniforms::Pose,
    uniform: wgpu::Buffer,
    matrices: wgpu::Buffer,
    weights: wgpu::Buffer,
}

/// What vertices are moved by, laid out for the GPU.
#[derive(Default)]
struct Followers {
    rest: Vec<f32>,
    followers: Vec<[u32; 5]>,
    influences: Vec<[u32; 2]>,
    targets: Vec<f32>,
    /// Matrices and morph weights of the parts so far.
    matrices: u32,
    weights: u32,
}

impl Posing {
    /// Prepares the rigs of a scene; `None` where nothing is animated.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(gpu: &Gpu, animated: &AnimatedScene, geometry: &Geometry) -> Result<Option<Self>, GpuError> {
        if geometry.moving == 0 {
            return Ok(None);
        }
        let mut all = Followers::default();
        for part in animated.rigs.iter().flat_map(|rig| &rig.parts) {
            all.add(part);
        }
        let device = &gpu.device;
        let workgroups = groups(geometry.moving as usize);
        let settings = uniforms::Pose {
            vertices: geometry.moving,
            groups: workgroups[0],
            matrices: all.matrices,
            weights: all.weights,
            first: 1,
        };
        let uniform = gpu::uniform(device, "frame.pose", &settings)?;
        let matrices = gpu::empty::<[f32; 12]>(device, "frame.matrices", 3 * all.matrices as usize)?;
        let weights = gpu::empty::<f32>(device, "frame.weights", 3 * all.weights as usize)?;
        let posed = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &geometry.posed,
            offset: 0,
            size: std::num::NonZeroU64::new(u64::from(geometry.moving) * 4 * POSED as u64),
        });
        let rest = gpu::storage(device, "frame.rest", &all.rest)?;
        let followers = gpu::storage(device, "frame.followers", &all.followers)?;
        let influences = gpu::storage(device, "frame.influences", &all.influences)?;
        let targets = gpu::storage(device, "frame.targets", &all.targets)?;
        let read = [&uniform, &rest, &followers, &influences, &matrices, &targets, &weights];
        let resources: Vec<_> = read.iter().map(|buffer| buffer.as_entire_binding()).chain([posed]).collect();
        let pass = Pass::of(device, Shader::at("frame/pose"), &[])?.bind(device, &resources)?;
        Ok(Some(Self { pass, workgroups, settings, uniform, matrices, weights }))
    }

    /// Says what the next frame shows: `time`, with the shutter open for `shutter` seconds around it.
    pub fn set(&mut self, queue: &wgpu::Queue, rigs: &[Rig], time: f32, shutter: f32) {
        let (mut matrices, mut weights) = (Vec::new(), Vec::new());
        for moment in [time, time - 0.5 * shutter, time + 0.5 * shutter] {
            for rig in rigs {
                let pose = rig.pose(moment);
                matrices.extend(pose.matrices.iter().flat_map(rows));
                weights.extend(pose.weights);
            }
        }
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.settings));
        queue.write_buffer(&self.matrices, 0, bytemuck::cast_slice(&matrices));
        queue.write_buffer(&self.weights, 0, bytemuck::cast_slice(&weights));
        self.settings.first = 0;
    }

    /// Records the pass.
    pub fn encode(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.pass.dispatch_in(pass, self.workgroups);
    }
}

/// The upper three rows of a matrix.
fn rows(matrix: &Mat4) -> [f32; 12] {
    let [x, y, z, _] = matrix.transpose().to_cols_array_2d();
    bytemuck::cast([x, y, z])
}

impl Followers {
    fn add(&mut self, part: &RigPart) {
        let targets = part.targets.len() as u32;
        for (vertex, influences) in part.influences.iter().enumerate() {
            let rest = &part.rest;
            let normal = rest.normals.get(vertex).copied().unwrap_or(Vec3::ZERO);
            let tangent = rest.tangents.get(vertex).copied().unwrap_or_default();
            self.rest.extend(rest.positions[vertex].to_array());
            self.rest.extend(normal.to_array());
            self.rest.extend(tangent.to_array());
            let first_target = (self.targets.len() / 9) as u32;
            self.followers.push([
                self.influences.len() as u32,
                influences.len() as u32,
                first_target,
                targets,
                self.weights,
            ]);
            let matrix = |(matrix, weight): &(u32, f32)| [self.matrices + matrix, weight.to_bits()];
            self.influences.extend(influences.iter().map(matrix));
            for target in &part.targets {
                for offsets in [&target.positions, &target.normals, &target.tangents] {
                    self.targets.extend(offsets.get(vertex).copied().unwrap_or(Vec3::ZERO).to_array());
                }
            }
        }
        self.matrices += part.matrix_count() as u32;
        self.weights += targets;
    }
}
