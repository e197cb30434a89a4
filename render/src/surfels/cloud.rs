//! The passes that lay surfels out: how many each patch gets, where each begins, where they lie, and the tree
//! over them.

use super::{HEIGHT, LEAF, MOST, Surfel, SurfelLight, vertices};
use crate::raster::patches::Patch;
use crate::raster::{World, groups};
use crate::screen::{Device, MethodStep, Workgroups};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use wgpu::BufferUsages;

/// Numbers that a pass sums up.
const BLOCK: usize = 64;
/// Byte of [`Cloud::totals`] at which the workgroups for one invocation a surfel stand, and for one a leaf.
pub(crate) const SURFEL_GROUPS: u64 = 8;
const LEAF_GROUPS: u64 = 20;

/// Which surfels the tree leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tree {
    /// All.
    All,
    /// Those that send light.
    Lit,
}

/// The surfels of a frame on the GPU.
#[derive(Clone, Debug)]
pub struct Cloud {
    /// The scene's vertices in camera space, `[vertices, 3]` f32.
    vertices: wgpu::Buffer,
    /// The patches of the scene, [`Patch`].
    pub patches: wgpu::Buffer,
    /// How many surfels each gets, `[patches]` f32; the last one is the fraction of one.
    pub amounts: wgpu::Buffer,
    /// The first surfel of each, `[patches]` u32.
    pub starts: wgpu::Buffer,
    /// How many there are, how many there would be with more room, and the workgroups of passes over them.
    pub totals: wgpu::Buffer,
    /// [`Surfel`]s, in the order of patches.
    pub surfels: wgpu::Buffer,
    /// What they send, where they are [lit](SurfelLight), `[surfels, 2]` u32.
    pub sent: Option<wgpu::Buffer>,
    /// Boxes around them, the root first: `[nodes, 8]` f32.
    pub nodes: wgpu::Buffer,
    /// Sums of 64 starts each, and of 64 of those.
    sums: [wgpu::Buffer; 2],
    count: usize,
}

/// What the passes read that changes from frame to frame.
#[derive(Clone, Copy, Debug)]
pub struct Uniforms<'a> {
    /// [`uniforms::Surfels`].
    pub settings: &'a wgpu::Buffer,
    /// [`uniforms::FrameView`] of the camera.
    pub view: &'a wgpu::Buffer,
}

/// Uniforms of the levels of the tree that are made of the ones below.
pub fn tree_levels() -> impl Iterator<Item = uniforms::TreeLevel> {
    (1..=HEIGHT).map(|height| uniforms::TreeLevel { height })
}

impl Cloud {
    /// Room for the surfels of a scene, and for what they send if they are lit.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(device: &wgpu::Device, world: &World, lit: Option<SurfelLight>) -> Result<Self, GpuError> {
        let patches = world.patches(SurfelLight::reflectance(lit));
        // A binding holds at least one, which is nowhere.
        let patches = if patches.is_empty() { &[Patch::NOWHERE] } else { patches };
        let count = patches.len();
        let [in_blocks, in_all] = [count.div_ceil(BLOCK), count.div_ceil(BLOCK * BLOCK)];
        let indirect = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
        Ok(Self {
            vertices: vertices::room(device, &world.geometry.posed)?,
            patches: gpu::storage(device, "surfels.patches", patches)?,
            amounts: gpu::empty::<f32>(device, "surfels.amounts", count)?,
            starts: gpu::empty::<u32>(device, "surfels.starts", count)?,
            totals: gpu::filled(device, "surfels.totals", &[0; 32], indirect)?,
            surfels: gpu::empty::<Surfel>(device, "surfels.surfels", MOST)?,
            sent: lit.map(|_| gpu::empty::<[u32; 2]>(device, "surfels.sent", MOST)).transpose()?,
            nodes: gpu::empty::<[f32; 8]>(device, "surfels.nodes", (4 * MOST / LEAF - 1) / 3)?,
            sums: [
                gpu::empty::<u32>(device, "surfels.blocks", in_blocks)?,
                gpu::empty::<u32>(device, "surfels.sums", in_all)?,
            ],
            count,
        })
    }

    /// The passes that make surfels, in order.
    ///
    /// # Errors
    /// If the device refuses a pass or a binding.
    pub fn surfel_steps(
        &self,
        device: &Device,
        world: &World,
        Uniforms { settings, view }: Uniforms<'_>,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let Self { vertices, patches, amounts, starts, totals, surfels, sums: [blocks, all], count, .. } =
            self;
        let step = |shader, invocations: usize, reads: &[&wgpu::Buffer], writes: &[&wgpu::Buffer]| {
            MethodStep::bind(device, &device.pass(shader, &[])?, groups(invocations), reads, writes)
        };
        let [in_blocks, in_all] = [count.div_ceil(BLOCK), count.div_ceil(BLOCK * BLOCK)];
        let place = [settings, vertices, patches, amounts, starts, totals];
        let counted = Workgroups::Counted(totals.clone(), SURFEL_GROUPS);
        let mut steps = vertices::steps(device, [view, &world.geometry.posed, vertices])?;
        steps.extend([
            step(Shader::at("surfels/measure"), *count, &[settings, vertices, patches], &[amounts, starts])?,
            step(Shader::at("surfels/sum"), in_blocks, &[starts], &[blocks])?,
            step(Shader::at("surfels/sum"), in_all, &[blocks], &[all])?,
            step(Shader::at("surfels/total"), 1, &[], &[all, totals])?,
            step(Shader::at("surfels/begin"), in_all, &[all], &[blocks])?,
            step(Shader::at("surfels/begin"), in_blocks, &[blocks], &[starts])?,
            MethodStep::bind(
                device,
                &device.pass(Shader::at("surfels/place"), &[])?,
                counted,
                &place,
                &[surfels],
            )?,
        ]);
        Ok(steps)
    }

    /// The passes that put a tree over them; `levels` are uniforms of the heights from 1 on.
    ///
    /// # Errors
    /// If the device refuses a pass or a binding.
    pub fn tree_steps(
        &self,
        device: &Device,
        tree: Tree,
        levels: &[wgpu::Buffer],
    ) -> Result<Vec<MethodStep>, GpuError> {
        let Self { totals, surfels, sent, nodes, .. } = self;
        let counted = Workgroups::Counted(totals.clone(), LEAF_GROUPS);
        let light = sent.iter().filter(|_| tree == Tree::Lit).map(|sent| (3, sent));
        let reads: Vec<_> = [(0, totals), (1, surfels)].into_iter().chain(light).collect();
        let leaves = match tree {
            Tree::All => Shader::at("surfels/leaves"),
            Tree::Lit => Shader::at("surfels/lit_leaves"),
        };
        let parents = device.pass(Shader::at("surfels/parents"), &[])?;
        let leaves = device.pass(leaves, &[])?;
        let mut steps = vec![MethodStep::bind_at(device, &leaves, counted, &reads, &[(2, nodes)])?];
        for (height, level) in (1..).zip(levels) {
            let nodes_there = 1 << (2 * (HEIGHT - height));
            let reads = [level, totals];
            steps.push(MethodStep::bind(device, &parents, groups(nodes_there), &reads, &[nodes])?);
        }
        Ok(steps)
    }

    /// How many surfels there are in the last frame, and how many there would be with room for all.
    ///
    /// # Errors
    /// If the device fails.
    pub fn count(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<[u32; 2], GpuError> {
        let totals: Vec<u32> = gpu::read_part(device, queue, &self.totals, 0, 8)?;
        Ok([totals[0], totals[1]])
    }
}
