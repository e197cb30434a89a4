//! Ambient occlusion volumes: what all facets within reach occlude, added up.

use super::facets::{self, Facets};
use super::reference;
use crate::bvh::TracedScene;
use crate::methods::Surface;
use crate::raster::view::perspective;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use crate::surfels::frame;
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// How high in the tree a node is whose facets are one slice: 4,096, of which each takes five or six turns of loops.
const SLICE: u32 = 4;

/// The method, which has nothing to set: no sample is drawn, so that more time would not make it better.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Volumes;

/// The method, compiled for a device.
pub type OcclusionVolumes = Compiled<Volumes>;

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    facets: facets::Passes,
    occlusion: Pass,
}

impl Passes {
    /// The passes over the image, a slice of the facets after the other.
    fn occlusion_steps(
        &self,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        facets: &Facets,
        image_size: &wgpu::Buffer,
        image: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let gbuffer = inputs.gbuffer;
        let surface = [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|a| gbuffer.buffer(a));
        let groups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE);
        let step = |slice: wgpu::Buffer| {
            let reads = [&[image_size], &surface[..], &[&slice, &facets.facets, &facets.nodes]].concat();
            MethodStep::bind(device, &self.occlusion, groups, &reads, &[image])
        };
        facets.slices(device, SLICE)?.into_iter().map(step).collect()
    }
}

impl Technique for Volumes {
    const NAME: &'static str = "aov";
    const EFFECT: Effect = Effect::Ao;
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];
    const LOOKS_BEYOND: bool = true;
    type Passes = Passes;

    fn compile(device: &wgpu::Device) -> Result<Passes, GpuError> {
        let shader = &wgsl::AOV_OCCLUSION;
        let occlusion = Pass::new(device, shader.name, &shader.specialised(&[("SLICE", SLICE)]))?;
        Ok(Passes { facets: facets::Passes::new(device)?, occlusion })
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = perspective(&view.camera, view.height, view.width, f32::MIN_POSITIVE);
        let sum = uniforms::FacetSum {
            width: view.width as u32,
            height: view.height as u32,
            reach: view.radius,
            background: Self::EFFECT.background().unwrap_or(0.0),
        };
        vec![bytes_of(&camera).to_vec(), bytes_of(&sum).to_vec()]
    }

    fn steps(
        &self,
        passes: &Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let [view, image_size] = uniforms else {
            unreachable!("camera and image have a uniform buffer each")
        };
        let (facets, mut steps) = passes.facets.steps(device, frame::scene(inputs.world)?, view)?;
        steps.extend(passes.occlusion_steps(device, inputs, &facets, image_size, output)?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        let shaded = |scene: &TracedScene| {
            let facets = reference::facets(scene.scene(), &view.camera);
            reference::openness(&surface, &facets, view.radius).data().to_vec()
        };
        Ok(inputs.scene.map(shaded).into_iter().collect())
    }
}
