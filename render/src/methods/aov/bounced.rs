//! Ambient occlusion by a bounced z-buffer over facets: what of a white sky a pixel sees past the nearest of them.

use super::facets;
use super::reference;
use crate::bvh::TracedScene;
use crate::methods::{Quality, Surface, blur, bounced_z};
use crate::raster::view::perspective;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use crate::surfels::frame;
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, TILE, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// How high in the tree a node is whose facets are one slice: 16,384, of which each takes no more than two turns of
/// loops.
const SLICE: u32 = 5;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Parameters {
    /// Directions of a pixel, 1 to 16.
    #[schemars(range(min = 1, max = 16))]
    pub directions: u32,
    /// What brings neighbours' samples together.
    pub filter: blur::Parameters,
}

/// The method, compiled for a device.
pub type BouncedVolumes = Compiled<Parameters>;

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes {
    facets: facets::Passes,
    trace: Pass,
    filter: Pass,
}

impl Parameters {
    /// Those of a quality: as many directions as the bounced z-buffer over surfels has.
    pub fn of(quality: Quality) -> Self {
        let bounced_z::Parameters { directions, filter, .. } = bounced_z::Parameters::of(quality);
        Self { directions, filter }
    }

    fn directions(&self) -> u32 {
        self.directions.clamp(1, bounced_z::MOST_DIRECTIONS)
    }

    /// What the rays read.
    pub fn rays(&self, view: &View) -> uniforms::FacetRays {
        uniforms::FacetRays {
            width: view.width as u32,
            height: view.height as u32,
            directions: self.directions(),
            seed: view.seed,
            reach: view.radius,
        }
    }

    /// What the filter reads.
    pub fn window(&self, view: &View) -> uniforms::BounceWindow {
        bounced_z::window(&self.filter, self.directions(), Effect::Ao, view)
    }
}

impl Technique for Parameters {
    const NAME: &'static str = "aov-bounced-z";
    const EFFECT: Effect = Effect::Ao;
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];
    const LOOKS_BEYOND: bool = true;
    type Passes = Passes;

    fn compile(device: &wgpu::Device) -> Result<Passes, GpuError> {
        let [trace, filter] = [&wgsl::AOV_TRACE, &wgsl::BOUNCED_FILTER];
        Ok(Passes {
            facets: facets::Passes::new(device)?,
            trace: Pass::new(device, trace.name, &trace.specialised(&[("SLICE", SLICE)]))?,
            filter: Pass::new(device, filter.name, &filter.source())?,
        })
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = perspective(&view.camera, view.height, view.width, f32::MIN_POSITIVE);
        let (rays, window) = (self.rays(view), self.window(view));
        vec![bytes_of(&camera).to_vec(), bytes_of(&rays).to_vec(), bytes_of(&window).to_vec()]
    }

    fn steps(
        &self,
        passes: &Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let [view, rays, window] = uniforms else {
            unreachable!("camera, rays and filter have a uniform buffer each")
        };
        let (facets, mut steps) = passes.facets.steps(device, frame::scene(inputs.world)?, view)?;
        let gbuffer = inputs.gbuffer;
        let surface = [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|a| gbuffer.buffer(a));
        let (height, width) = (gbuffer.height(), gbuffer.width());
        let samples =
            |label: &str| gpu::empty::<u32>(device, label, self.directions() as usize * height * width);
        let (ways, arrived) = (samples("aov.directions")?, samples("aov.arrived")?);
        let [columns, rows, _] = gpu::groups(height, width, TILE);
        let all = [columns, rows, self.directions()];
        for slice in facets.slices(device, SLICE)? {
            let reads = [&[rays], &surface[..], &[&slice, &facets.facets, &facets.nodes]].concat();
            steps.push(MethodStep::bind(device, &passes.trace, all, &reads, &[&ways, &arrived])?);
        }
        let reads = [&[window], &surface[..], &[&ways, &arrived]].concat();
        steps.push(MethodStep::bind(device, &passes.filter, [columns, rows, 1], &reads, &[output])?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        let shaded = |scene: &TracedScene| {
            let facets = reference::facets(scene.scene(), &view.camera);
            reference::visible_sky(&surface, &facets, self, view).data().to_vec()
        };
        Ok(inputs.scene.map(shaded).into_iter().collect())
    }
}
