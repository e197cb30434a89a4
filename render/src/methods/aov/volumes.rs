//! Ambient occlusion volumes: what all facets within reach occlude, added up.

use super::facets;
use super::reference;
use crate::methods::Surface;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::GpuError;
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// How high in the tree a node is whose facets are one slice: 4,096, of which each takes five or six turns of
/// loops.
const SLICE: u32 = 4;

/// The method, which has nothing to set: no sample is drawn, so that more time would not make it better.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct Volumes;

impl Technique for Volumes {
    fn about(&self) -> About {
        About::beyond_screen("aov", Effect::Ao, &[Attribute::Position, Attribute::Normal, Attribute::Valid])
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let camera = view.perspective();
        let sum = uniforms::FacetSum {
            width: view.width as u32,
            height: view.height as u32,
            reach: view.radius,
            background: Effect::Ao.background().unwrap_or(0.0),
        };
        vec![bytes_of(&camera).to_vec(), bytes_of(&sum).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let [view, image_size] = to.uniforms else {
            unreachable!("camera and image have a uniform buffer each")
        };
        let device = to.device;
        let (facets, mut steps) = facets::steps(device, to.scene()?, view)?;
        let pass = device.pass(Shader::at("methods/aov/occlusion"), &[("SLICE", SLICE)])?;
        let surface = to.seen([Attribute::Position, Attribute::Normal, Attribute::Valid]);
        // A slice of the facets after the other.
        for slice in facets.slices(device, SLICE)? {
            let reads = [&[image_size], &surface[..], &[&slice, &facets.facets, &facets.nodes]].concat();
            steps.push(MethodStep::bind(device, &pass, to.whole(), &reads, &[to.output])?);
        }
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        inputs.image_of_scene(|scene| {
            let facets = reference::facets(scene.scene(), &view.camera);
            Ok(reference::openness(&surface, &facets, view.radius))
        })
    }
}
