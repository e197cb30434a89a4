//! What an effect has around the levels on the GPU: what splats read beside surfels, where the sum goes, and
//! what is made of it.

use super::directional::Sky;
use crate::methods::lobe;
use crate::screen::{MethodStep, Resources};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;

/// What the sum of all levels becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It is the image.
    Sum,
    /// What glossy receivers reflect where it is what they would if they were white.
    Reflected,
    /// What is open where it is what is blocked of the environment's light.
    Open,
    /// Scattered light where it is what bodies let through.
    Scattered,
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
    /// Binds the passes of an ending; `size` holds the image's.
    ///
    /// # Errors
    /// If the device has no room for what lies between them.
    pub fn new(
        ending: Ending,
        to: &Resources<'_>,
        [size, view]: [&wgpu::Buffer; 2],
    ) -> Result<Self, GpuError> {
        let (device, image, whole) = (to.device, to.output, to.whole());
        let pass = |file| device.pass(file, &[]);
        let receivers = to.seen([Attribute::Position, Attribute::Normal, Attribute::Valid]).map(Clone::clone);
        let [_, normal, valid] = &receivers;
        let pixels = to.size().iter().product::<usize>();
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
            Ending::Reflected => {
                let (gloss, step) = lobe::step(device, to.gbuffer)?;
                let reflect = &pass(Shader::at("methods/surfel/reflect"))?;
                let [position, normal, _] = receivers;
                let reads = [size, &position, &normal, &gloss];
                let after = vec![MethodStep::bind(device, reflect, whole, &reads, &[image])?];
                Self { before: vec![step], receivers: [position, normal, gloss], after, ..plain }
            }
            Ending::Open => {
                let [blocked, open] = Sky::new(to.environment).upload(device)?;
                let pass = &pass(Shader::at("methods/surfel/open"))?;
                let reads = [size, view, normal, valid, &open];
                let after = vec![MethodStep::bind(device, pass, whole, &reads, &[image])?];
                Self { more: vec![view.clone(), blocked], after, ..plain }
            }
            Ending::Scattered => {
                let bodies = &pass(Shader::at("methods/surfel/bodies"))?;
                let scatter = &pass(Shader::at("methods/surfel/scatter"))?;
                let below = gpu::empty::<f32>(device, "surfel.bodies", 4 * pixels)?;
                let mask = gpu::empty::<f32>(device, "surfel.body_mask", pixels)?;
                let total = gpu::empty::<f32>(device, "surfel.given", 12 * pixels)?;
                let [lengths, colour, object, light] = to.seen([
                    Attribute::MeanFreePath,
                    Attribute::Diffuse,
                    Attribute::ObjectId,
                    Attribute::DiffuseLight,
                ]);
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
