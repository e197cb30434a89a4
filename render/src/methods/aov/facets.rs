//! Facets: a scene's triangles as they are posed, in camera space on the GPU, large ones cut, and a tree over
//! them.
//!
//! They lie along a curve through space, as surfels do, and the tree is of the same form.

use crate::raster::World;
use crate::raster::groups;
use crate::raster::patches::{self, Patch};
use crate::scene::Scene;
use crate::screen::{Device, MethodStep};
use crate::surfels::{LEAF, vertices};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};

/// Levels of the tree above its leaves: `HEIGHT` of the shaders.
const HEIGHT: u32 = 10;
/// Most facets of a scene, which is what the tree holds: 16.8 million.
pub const MOST: usize = LEAF << (2 * HEIGHT);
/// A scene's surface is cut into about so many facets, beside triangles that are smaller than one: boxes
/// around large triangles hold much that is far away.
const PARTS: f32 = (1 << 13) as f32;

/// The patches that facets are made of, in their order.
pub fn patches_of_scene(scene: &Scene) -> Vec<Patch> {
    patches::cut_scene(scene, PARTS)
}

/// The facets of a frame on the GPU.
#[derive(Clone, Debug)]
pub struct Facets {
    /// `[facets, 10]` f32.
    pub facets: wgpu::Buffer,
    /// Boxes around them, the root first: `[nodes, 8]` f32.
    pub nodes: wgpu::Buffer,
    /// How many there are; one without an area where a scene has none.
    pub count: usize,
}

impl Facets {
    /// What runs over the image are told, each of those facets that are below one node of a height of the
    /// tree: `SLICE` of the shaders. In one run for all there would be more turns of loops than lavapipe has,
    /// which ends them after 65,535.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn slices(&self, device: &wgpu::Device, height: u32) -> Result<Vec<wgpu::Buffer>, GpuError> {
        let slices = self.count.div_ceil(LEAF << (2 * height));
        let slice = |index: usize| {
            let last = u32::from(index + 1 == slices);
            gpu::uniform(device, "aov.slice", &uniforms::FacetSlice { index: index as u32, last })
        };
        (0..slices).map(slice).collect()
    }
}

/// The facets of a scene, and the passes that make them and their tree; `view` is that of the camera.
///
/// # Errors
/// If the scene has more than [`MOST`] facets, or the device has no room.
pub fn steps(
    device: &Device,
    world: &World,
    view: &wgpu::Buffer,
) -> Result<(Facets, Vec<MethodStep>), GpuError> {
    let patches = world.cut(PARTS);
    if patches.len() > MOST {
        let what = format!("the scene has {} facets; there may be {MOST}", patches.len());
        return Err(GpuError::Refused { label: "deepshade.aov.facets".to_owned(), what });
    }
    let patches = if patches.is_empty() { vec![Patch::NOWHERE] } else { patches };
    let count = patches.len();
    let posed = &world.geometry.posed;
    let places = vertices::room(device, posed)?;
    let mut steps = vertices::steps(device, [view, posed, &places])?;
    let patches = gpu::storage(device, "aov.patches", &patches)?;
    let facets = gpu::empty::<[f32; 10]>(device, "aov.facets", count)?;
    let nodes = gpu::empty::<[f32; 8]>(device, "aov.nodes", first_leaf() + count.div_ceil(LEAF))?;
    let leaves = groups(count.div_ceil(LEAF));
    let reads = [&places, &patches];
    let cut = device.pass(Shader::at("methods/aov/facets"), &[])?;
    let parents = device.pass(Shader::at("methods/aov/parents"), &[])?;
    steps.push(MethodStep::bind(device, &cut, leaves, &reads, &[&facets, &nodes])?);
    // The beginning of what passes over surfels are told: how many there are.
    let totals = gpu::storage(device, "aov.totals", &[count as u32; 8])?;
    for height in 1..=HEIGHT {
        let level = gpu::uniform(device, "aov.level", &uniforms::TreeLevel { height })?;
        let nodes_there = groups(count.div_ceil(LEAF << (2 * height)));
        steps.push(MethodStep::bind(device, &parents, nodes_there, &[&level, &totals], &[&nodes])?);
    }
    Ok((Facets { facets, nodes, count }, steps))
}

/// How many nodes are above the leaves.
const fn first_leaf() -> usize {
    ((1 << (2 * HEIGHT)) - 1) / 3
}
