//! Ambient occlusion by a bounced z-buffer over facets: what of a white sky a pixel sees past the nearest of
//! them.

use super::facets;
use super::reference;
use crate::methods::{Quality, Surface, blur, bounced_z};
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// How high in the tree a node is whose facets are one slice: 16,384, of which each takes no more than two
/// turns of loops.
const SLICE: u32 = 5;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct AovBouncedZParameters {
    /// Directions of a pixel, 1 to 16.
    #[schemars(range(min = 1, max = 16))]
    pub directions: u32,
    /// What brings neighbours' samples together.
    pub filter: blur::BlurParameters,
}

impl AovBouncedZParameters {
    /// Those of a quality: as many directions as the bounced z-buffer over surfels has.
    pub fn of(quality: Quality) -> Self {
        let bounced_z::BouncedZParameters { directions, filter, .. } =
            bounced_z::BouncedZParameters::of(quality);
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

impl Technique for AovBouncedZParameters {
    fn about(&self) -> About {
        About::beyond_screen(
            "aov-bounced-z",
            Effect::Ao,
            &[Attribute::Position, Attribute::Normal, Attribute::Valid],
        )
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = view.perspective();
        let (rays, window) = (self.rays(view), self.window(view));
        vec![bytes_of(&camera).to_vec(), bytes_of(&rays).to_vec(), bytes_of(&window).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let [view, rays, window] = to.uniforms else {
            unreachable!("camera, rays and filter have a uniform buffer each")
        };
        let device = to.device;
        let (facets, mut steps) = facets::steps(device, to.scene()?, view)?;
        let trace = device.pass(Shader::at("methods/aov/trace"), &[("SLICE", SLICE)])?;
        let filter = device.pass(Shader::at("methods/bounced-z/filter"), &[])?;
        let surface = to.seen([Attribute::Position, Attribute::Normal, Attribute::Valid]);
        let [height, width] = to.size();
        let samples =
            |label: &str| gpu::empty::<u32>(device, label, self.directions() as usize * height * width);
        let (ways, arrived) = (samples("aov.directions")?, samples("aov.arrived")?);
        let [columns, rows, _] = to.whole();
        let all = [columns, rows, self.directions()];
        for slice in facets.slices(device, SLICE)? {
            let reads = [&[rays], &surface[..], &[&slice, &facets.facets, &facets.nodes]].concat();
            steps.push(MethodStep::bind(device, &trace, all, &reads, &[&ways, &arrived])?);
        }
        let reads = [&[window], &surface[..], &[&ways, &arrived]].concat();
        steps.push(MethodStep::bind(device, &filter, to.whole(), &reads, &[to.output])?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        inputs.image_of_scene(|scene| {
            let facets = reference::facets(scene.scene(), &view.camera);
            Ok(reference::visible_sky(&surface, &facets, self, view))
        })
    }
}
