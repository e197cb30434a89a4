//! Light that surfaces throw into a medium, by a bounced z-buffer: the effect `fog-indirect`.
//!
//! A pixel has a few rays. Each starts at a place on the view ray that is drawn in intervals of equal loss of
//! transmittance, those of [`volume_shell`](crate::methods::volume_shell), and goes into a direction that is
//! drawn by the phase function. What it brings is the light of the nearest surfel, dimmed by the medium up to
//! there: visibility and attenuation together. Neighbouring pixels have other places and directions, and a
//! filter brings together what they see, each sample weighed by the density with which the pixel would have
//! drawn its place, over that with which the neighbour has. In a medium that is the same throughout the two
//! densities are alike but for a factor, up to where the pixel's ray ends. So nothing else guides the filter:
//! what starts behind the pixel's surface does not count.
//!
//! Places and directions of the pixels of a square fill space evenly, so that few rays are enough where much
//! of a scene is lit.
//!
//! Limits. As of [`bounced_z`](super): holes, and noise that the filter turns into blur. A small bright spot
//! is found by few rays, and disks enlarge it. Surfels send as much to all sides. They reflect lamps' light
//! with the share that they reflect of even light. Truth's rough dielectrics reflect more of light from
//! straight ahead, and more of it straight ahead. So closed rooms are up to a tenth too dark. In a grid the
//! filter takes the smoke of neighbours for the pixel's own, but for how much of it there is. Lamps light
//! surfels, nothing else does.

mod reference;

use super::MOST_DIRECTIONS;
use crate::methods::Quality;
use crate::methods::volume_shell::intervals::Division;
use crate::methods::volume_shell::map::{self, IntervalMap};
use crate::raster::medium::MediumOnGpu;
use crate::screen::{About, MethodStep, PassDispatch, PlainInputs, Resources, Technique, View, Written};
use crate::surfels::{self, SurfelLight, Tree, frame};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, uniforms};
use deepshade_shaders::{Attribute, Effect, MissingAttribute};

/// What surfels send: what they reflect of lamps, all of it, dimmed by the medium.
const LIGHT: SurfelLight = SurfelLight::Dimmed { is_grey: false };
/// Distances of a view ray between which places are drawn.
const SAMPLES: usize = 16;

/// What can be set.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct FogRaysParameters {
    /// How finely the scene is laid out.
    pub surfels: surfels::SurfelDensity,
    /// Rays of a pixel, 1 to 16.
    #[schemars(range(min = 1, max = 16))]
    pub directions: u32,
    /// Pixels on either side whose rays are brought together.
    #[schemars(range(min = 0, max = 32), extend("unit" = "pixels"))]
    pub radius: u32,
    /// How much larger than its own is the radius of a surfel that rays meet.
    #[schemars(range(min = 1.0, max = 4.0))]
    pub cover: f32,
    /// Points of a view ray's way through the medium at which density is looked up.
    #[schemars(range(min = 1, max = 2048))]
    pub steps: u32,
    /// Points of the way from a surfel at which a grid's density is looked up.
    #[schemars(range(min = 1, max = 32))]
    pub points: u32,
}

impl FogRaysParameters {
    /// Those of a quality. Larger surfels, and a larger cover, are darker.
    pub fn of(quality: Quality) -> Self {
        let (scale, directions, radius, steps, points) = match quality {
            Quality::Low => (0.040, 4, 12, 64, 2),
            Quality::Medium => (0.030, 8, 12, 128, 2),
            Quality::High => (0.020, 16, 12, 200, 4),
            Quality::Ultra => (0.014, 16, 10, 400, 4),
        };
        let surfels = surfels::SurfelDensity { scale, near: 0.25 };
        Self { surfels, directions, radius, cover: 1.75, steps, points }
    }

    /// How view rays are divided.
    fn division(&self, seed: u32) -> Division {
        Division { steps: self.steps.max(1), samples: SAMPLES, is_wide: true, seed }
    }

    /// What rays read.
    fn bounces(&self, view: &View) -> uniforms::Bounces {
        uniforms::Bounces {
            width: view.width as u32,
            height: view.height as u32,
            directions: self.directions.clamp(1, MOST_DIRECTIONS),
            seed: view.seed,
            cover: self.cover,
            reach: far_reaching(view).radius,
        }
    }

    /// What the filter reads.
    fn window(&self, view: &View) -> uniforms::FogWindow {
        // A paraboloid's square, round and without an edge: a Gaussian's square edges would be seen.
        uniforms::FogWindow {
            width: view.width as u32,
            height: view.height as u32,
            directions: self.bounces(view).directions,
            radius: self.radius as i32,
            falloff: (self.radius as f32 + 1.0).powi(-2),
        }
    }

    /// How finely a view that reaches everywhere is laid out, near meaning what it does for this one.
    fn density(&self, view: &View) -> surfels::SurfelDensity {
        let near = self.surfels.near * view.radius / far_reaching(view).radius;
        surfels::SurfelDensity { near, ..self.surfels }
    }
}

/// A view from which surfels matter wherever they are.
fn far_reaching(view: &View) -> View {
    View { radius: f32::MAX.sqrt(), ..*view }
}

impl Technique for FogRaysParameters {
    fn about(&self) -> About {
        About::beyond_screen("bounced-z", Effect::FogIndirect, &[Attribute::Position, Attribute::Valid])
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let own = [
            bytes_of(&self.division(view.seed).marching(view)).to_vec(),
            bytes_of(&self.bounces(view)).to_vec(),
            bytes_of(&self.window(view)).to_vec(),
        ];
        frame::uniforms(&self.density(view), &far_reaching(view)).chain(own).collect()
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (of_surfels, [march, bounces, window]) = to.uniforms.split_at(frame::UNIFORMS) else {
            unreachable!("march, rays and filter have a uniform buffer each")
        };
        let (device, world, view) = (to.device, to.scene()?, &of_surfels[1]);
        let (cloud, mut steps) = frame::steps(device, world, of_surfels, Tree::All, Some(LIGHT))?;
        let (map, step) = IntervalMap::step(&self.division(0), to, map::Uniforms { march, view })?;
        steps.push(step);
        let directions = self.directions.clamp(1, MOST_DIRECTIONS);
        let count = directions as usize * to.size().iter().product::<usize>();
        let arrived = gpu::empty::<[u32; 2]>(device, "bounced-z.in_fog", count)?;
        let MediumOnGpu { kind, record, densities } = &world.medium;
        let constants = [("LOOKUPS", self.points.max(1)), ("MEDIUM", *kind), ("SAMPLES", SAMPLES as u32)];
        let trace = device.pass(Shader::at("methods/bounced-z/fog_trace"), &constants)?;
        let first = [(0, bounces), (1, view), (2, record), (4, &cloud.totals), (5, &cloud.surfels)];
        let rest = [(6, &cloud.nodes), (8, &map.rays), (9, &map.samples), (10, &arrived)];
        let sent = cloud.sent.iter().map(|sent| (7, sent));
        let buffers = first.into_iter().chain(rest).chain(sent);
        let buffers = buffers.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
        let densities = (3, wgpu::BindingResource::TextureView(densities));
        let pass = trace.bind_at(device, buffers.chain([densities]))?;
        let [columns, rows, _] = to.whole();
        let step = PassDispatch { pass, workgroups: [columns, rows, directions].into() };
        steps.push(MethodStep { step, writes: vec![arrived.clone()] });
        let filter = device.pass(Shader::at("methods/bounced-z/fog_filter"), &[])?;
        let reads = [window, record, &map.rays, &arrived];
        steps.push(MethodStep::bind(device, &filter, to.whole(), &reads, &[to.output])?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        inputs.image_of_scene(|scene| reference::shade(inputs.gbuffer, scene, self, view))
    }
}
