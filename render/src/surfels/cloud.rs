//! The passes that lay surfels out: how many each patch gets, where each begins, where they lie, and the tree over
//! them.

use super::{HEIGHT, LEAF, Lit, MOST, Surfel, vertices};
use crate::raster::patches::Patch;
use crate::raster::{World, groups};
use crate::screen::{MethodStep, Workgroups};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, Shader, uniforms};
use wgpu::BufferUsages;

/// Numbers that a pass sums up.
const BLOCK: usize = 64;
/// Byte of [`Cloud::totals`] at which the workgroups for one invocation a surfel stand, and for one a leaf.
pub(crate) const SURFEL_GROUPS: u64 = 8;
const LEAF_GROUPS: u64 = 20;

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    vertices: Pass,
    measure: Pass,
    sum: Pass,
    total: Pass,
    begin: Pass,
    place: Pass,
    leaves: Pass,
    tree: Tree,
    parents: Pass,
}

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
    /// What they send, where they are [lit](Lit), `[surfels, 2]` u32.
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

impl Passes {
    /// Compiles them.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn new(device: &wgpu::Device, tree: Tree) -> Result<Self, GpuError> {
        let pass = |shader: &Shader| Pass::new(device, shader.name, &shader.source());
        let leaves = match tree {
            Tree::All => &wgsl::SURFELS_LEAVES,
            Tree::Lit => &wgsl::SURFELS_LIT_LEAVES,
        };
        Ok(Self {
            vertices: vertices::pass(device)?,
            measure: pass(&wgsl::SURFELS_MEASURE)?,
            sum: pass(&wgsl::SURFELS_SUM)?,
            total: pass(&wgsl::SURFELS_TOTAL)?,
            begin: pass(&wgsl::SURFELS_BEGIN)?,
            place: pass(&wgsl::SURFELS_PLACE)?,
            leaves: pass(leaves)?,
            tree,
            parents: pass(&wgsl::SURFELS_PARENTS)?,
        })
    }

    /// The passes that make surfels, in order.
    ///
    /// # Errors
    /// If the device refuses a binding.
    pub fn surfel_steps(
        &self,
        device: &wgpu::Device,
        world: &World,
        cloud: &Cloud,
        Uniforms { settings, view }: Uniforms<'_>,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let Cloud { vertices, patches, amounts, starts, totals, surfels, sums: [blocks, all], count, .. } =
            cloud;
        let step = |pass: &Pass, invocations: usize, reads: &[&wgpu::Buffer], writes: &[&wgpu::Buffer]| {
            MethodStep::bind(device, pass, groups(invocations), reads, writes)
        };
        let [in_blocks, in_all] = [count.div_ceil(BLOCK), count.div_ceil(BLOCK * BLOCK)];
        let place = [settings, vertices, patches, amounts, starts, totals];
        let counted = Workgroups::Counted(totals.clone(), SURFEL_GROUPS);
        let mut steps = vertices::steps(device, &self.vertices, [view, &world.geometry.posed, vertices])?;
        steps.extend([
            step(&self.measure, *count, &[settings, view, vertices, patches], &[amounts, starts])?,
            step(&self.sum, in_blocks, &[starts], &[blocks])?,
            step(&self.sum, in_all, &[blocks], &[all])?,
            step(&self.total, 1, &[], &[all, totals])?,
            step(&self.begin, in_all, &[all], &[blocks])?,
            step(&self.begin, in_blocks, &[blocks], &[starts])?,
            MethodStep::bind(device, &self.place, counted, &place, &[surfels])?,
        ]);
        Ok(steps)
    }

    /// The passes that put a tree over them; `levels` are uniforms of the heights from 1 on.
    ///
    /// # Errors
    /// If the device refuses a binding.
    pub fn tree_steps(
        &self,
        device: &wgpu::Device,
        cloud: &Cloud,
        levels: &[wgpu::Buffer],
    ) -> Result<Vec<MethodStep>, GpuError> {
        let Cloud { totals, surfels, sent, nodes, .. } = cloud;
        let counted = Workgroups::Counted(totals.clone(), LEAF_GROUPS);
        let light = sent.iter().filter(|_| self.tree == Tree::Lit).map(|sent| (3, sent));
        let reads: Vec<_> = [(0, totals), (1, surfels)].into_iter().chain(light).collect();
        let mut steps = vec![MethodStep::bind_at(device, &self.leaves, counted, &reads, &[(2, nodes)])?];
        for (height, level) in (1..).zip(levels) {
            let nodes_there = 1 << (2 * (HEIGHT - height));
            steps.push(MethodStep::bind(
                device,
                &self.parents,
                groups(nodes_there),
                &[level, totals],
                &[nodes],
            )?);
        }
        Ok(steps)
    }
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
    pub fn new(device: &wgpu::Device, world: &World, lit: Option<Lit>) -> Result<Self, GpuError> {
        let patches = world.patches();
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

    /// How many surfels there are in the last frame, and how many there would be with room for all.
    ///
    /// # Errors
    /// If the device fails.
    pub fn count(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<[u32; 2], GpuError> {
        let totals: Vec<u32> = gpu::read_part(device, queue, &self.totals, 0, 8)?;
        Ok([totals[0], totals[1]])
    }
}
