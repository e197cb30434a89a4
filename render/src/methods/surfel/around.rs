//! What an effect has around the levels on the GPU: what splats read beside surfels, where the sum goes, and what is
//! made of it.

use super::directional::Sky;
use crate::methods::lobe;
use crate::screen::{Inputs, MethodStep};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{Shader, TILE};

/// What the sum of all levels becomes, with the passes that make it: shaders, or these compiled.
#[derive(Clone, Copy, Debug)]
pub enum Ending<P> {
    /// It is the image.
    Sum,
    /// What glossy receivers reflect where it is what they would if they were white.
    Reflected {
        /// What splats read of receivers.
        gloss: P,
        /// The image.
        reflect: P,
    },
    /// What is open where it is what is blocked of the environment's light.
    Open(P),
    /// Scattered light where it is what bodies let through.
    Scattered {
        /// What scatters below each pixel.
        bodies: P,
        /// The image.
        scatter: P,
    },
}

impl Ending<&'static Shader> {
    /// Compiles the passes.
    ///
    /// # Errors
    /// If the device refuses them.
    pub fn compiled(&self, device: &wgpu::Device) -> Result<Ending<Pass>, GpuError> {
        let pass = |shader: &Shader| Pass::new(device, shader.name, &shader.source());
        Ok(match self {
            Self::Sum => Ending::Sum,
            Self::Reflected { gloss, reflect } => {
                Ending::Reflected { gloss: pass(gloss)?, reflect: pass(reflect)? }
            }
            Self::Open(open) => Ending::Open(pass(open)?),
            Self::Scattered { bodies, scatter } => {
                Ending::Scattered { bodies: pass(bodies)?, scatter: pass(scatter)? }
            }
        })
    }
}

/// The passes before and after the levels, and what levels are bound to.
#[derive(Debug)]
pub struct Around {
    /// Passes that run first.
    pub before: Vec<MethodStep>,
    /// What splats read of pixels: position, normal, and validity, gloss or what scatters below.
    pub receivers: [wgpu::Buffer; 3],
    /// What else splats read, besides what surfels send.
    pub more: Vec<wgpu::Buffer>,
    /// What tells apart surfaces that must not be blurred into one another, `[1, height, width]`.
    pub mask: wgpu::Buffer,
    /// Where the sum of all levels goes, `[channels, height, width]`.
    pub total: wgpu::Buffer,
    /// Passes that run last.
    pub after: Vec<MethodStep>,
}

impl Around {
    /// Binds the passes of an ending; `size` holds the image's, `image` is what is wanted.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn new(
        device: &wgpu::Device,
        ending: &Ending<Pass>,
        inputs: &Inputs<'_>,
        [size, view]: [&wgpu::Buffer; 2],
        image: &wgpu::Buffer,
    ) -> Result<Self, GpuError> {
        let seen = |attribute| inputs.gbuffer.buffer(attribute);
        let receivers = [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|a| seen(a).clone());
        let [_, normal, valid] = &receivers;
        let pixels = inputs.gbuffer.height() * inputs.gbuffer.width();
        let whole = gpu::groups(inputs.gbuffer.height(), inputs.gbuffer.width(), TILE);
        let plain = Self {
            before: vec![],
            more: vec![],
            mask: valid.clone(),
            total: image.clone(),
            after: vec![],
            receivers: receivers.clone(),
        };
        Ok(match ending {
            Ending::Sum => plain,
            Ending::Reflected { gloss, reflect } => {
                let (gloss, step) = lobe::step(device, gloss, inputs.gbuffer)?;
                let [position, normal, _] = receivers;
                let reads = [size, &position, &normal, &gloss];
                let after = vec![MethodStep::bind(device, reflect, whole, &reads, &[image])?];
                Self { before: vec![step], receivers: [position, normal, gloss], after, ..plain }
            }
            Ending::Open(pass) => {
                let [blocked, open] = Sky::new(inputs.environment).upload(device)?;
                let reads = [size, view, normal, valid, &open];
                let after = vec![MethodStep::bind(device, pass, whole, &reads, &[image])?];
                Self { more: vec![view.clone(), blocked], after, ..plain }
            }
            Ending::Scattered { bodies, scatter } => {
                let below = gpu::empty::<f32>(device, "surfel.bodies", 4 * pixels)?;
                let mask = gpu::empty::<f32>(device, "surfel.body_mask", pixels)?;
                let total = gpu::empty::<f32>(device, "surfel.given", 12 * pixels)?;
                let [lengths, colour, object, light] = [
                    Attribute::MeanFreePath,
                    Attribute::Diffuse,
                    Attribute::ObjectId,
                    Attribute::DiffuseLight,
                ]
                .map(seen);
                let reads = [size, valid, lengths, colour, object];
                let before = vec![MethodStep::bind(device, bodies, whole, &reads, &[&below, &mask])?];
                let reads = [size, valid, &total, light, colour];
                let after = vec![MethodStep::bind(device, scatter, whole, &reads, &[image])?];
                let [position, normal, _] = receivers;
                Self { before, receivers: [position, normal, below], mask, total, after, ..plain }
            }
        })
    }
}
