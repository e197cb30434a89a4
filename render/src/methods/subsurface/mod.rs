//! Subsurface scattering as random walks bring it out ([`Effect::Subsurface`]), by methods of scattering in screen
//! space: [`separable`] and [`gather`], the rivals of surfels, which know only what is seen.
//!
//! In screen space radiance is averaged by Christensen and Burley's profile (2015), whose length is the mean free path.
//! Walks differ in two things. What they bring out is what falls on the surface elsewhere, in the colour of the surface
//! where it comes out: methods are therefore given light as a white surface would reflect it, and what they make of it
//! is multiplied by the colour. And the length is shorter than the mean free path by the paper's equation 6, with the
//! colour where light comes out.
//!
//! Limits: those of each method. Nothing goes through a body that is lit from behind. Bodies give to one another what
//! falls on them. What of a colour falls on a surface that is black in it is not known: it is taken for as much as of the
//! others in the mean, and for nothing where the surface is black in all.

#[cfg(test)]
mod tests;

use super::surface::vector;
use super::surfel::scattering::shape;
use super::{gather, separable};
use crate::raster::groups;
use crate::screen::{Compiled, Inputs, MethodStep, PlainInputs, Technique, View, Written};
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::{self, Shader};
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use glam::{IVec2, Vec3};

/// A method of [`Effect::Sss`], with what can be set.
#[derive(Clone, Copy, Debug)]
pub struct FromScreen<T>(pub T);

impl<T> From<T> for FromScreen<T> {
    fn from(method: T) -> Self {
        Self(method)
    }
}

/// By two blurs, compiled for a device.
pub type SeparableSubsurface = Compiled<FromScreen<separable::Parameters>>;
/// By a gather, compiled for a device.
pub type GatherSubsurface = Compiled<FromScreen<gather::Parameters>>;

/// The compiled passes.
#[derive(Clone, Debug)]
pub struct Passes<P> {
    enter: Pass,
    method: P,
    leave: Pass,
}

impl<T: Technique> Technique for FromScreen<T> {
    const NAME: &'static str = T::NAME;
    const EFFECT: Effect = Effect::Subsurface;
    const ATTRIBUTES: &'static [Attribute] = &[
        Attribute::Position,
        Attribute::MeanFreePath,
        Attribute::Diffuse,
        Attribute::DiffuseLight,
        Attribute::Valid,
    ];
    type Passes = Passes<T::Passes>;

    fn compile(device: &wgpu::Device) -> Result<Self::Passes, GpuError> {
        let pass = |shader: &Shader| Pass::new(device, shader.name, &shader.source());
        Ok(Passes {
            enter: pass(&wgsl::SUBSURFACE_ENTER)?,
            method: T::compile(device)?,
            leave: pass(&wgsl::SUBSURFACE_LEAVE)?,
        })
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.0.uniforms(view)
    }

    fn steps(
        &self,
        passes: &Self::Passes,
        device: &wgpu::Device,
        inputs: &Inputs<'_>,
        uniforms: &[wgpu::Buffer],
        output: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let gbuffer = inputs.gbuffer;
        let values = 3 * gbuffer.height() * gbuffer.width();
        let room = |label: &str| gpu::empty::<f32>(device, label, values);
        let (received, lengths) = (room("subsurface.received")?, room("subsurface.lengths")?);
        let scattered = room("subsurface.scattered")?;
        let [light, colour, paths] =
            [Attribute::DiffuseLight, Attribute::Diffuse, Attribute::MeanFreePath].map(|a| gbuffer.buffer(a));
        let all = groups(values);
        let reads = [light, colour, paths];
        let mut steps = vec![MethodStep::bind(device, &passes.enter, all, &reads, &[&received, &lengths])?];
        let given = gbuffer.with(Attribute::Light, received).with(Attribute::MeanFreePath, lengths);
        let inputs = Inputs { gbuffer: &given, ..*inputs };
        steps.extend(self.0.steps(&passes.method, device, &inputs, uniforms, &scattered)?);
        steps.push(MethodStep::bind(device, &passes.leave, all, &[&scattered, colour], &[output])?);
        Ok(steps)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let (received, lengths) = entering(inputs.gbuffer)?;
        let given = given(inputs.gbuffer, &received, &lengths)?;
        let mut written = vec![received.data().to_vec(), lengths.data().to_vec()];
        written.extend(self.0.reference(&PlainInputs { gbuffer: &given, ..*inputs }, view)?);
        let colours = inputs.gbuffer.select(&[Attribute::Diffuse])?;
        let scattered = written.last().into_iter().flatten();
        written.push(scattered.zip(colours.data()).map(|(light, colour)| light * colour).collect());
        Ok(written)
    }
}

/// The light that falls on what is seen, as a white surface reflects it, and the lengths of profiles, metres:
/// `[3, height, width]` each.
fn entering(gbuffer: &GBuffer) -> Result<(Planes, Planes), MissingAttribute> {
    let seen = |attribute| gbuffer.select(&[attribute]);
    let (light, colours) = (seen(Attribute::DiffuseLight)?, seen(Attribute::Diffuse)?);
    let paths = seen(Attribute::MeanFreePath)?;
    let image = |value: &dyn Fn(IVec2) -> Vec3| {
        Planes::from_fn(3, gbuffer.height(), gbuffer.width(), |c, y, x| {
            value(IVec2::new(x as i32, y as i32))[c]
        })
    };
    let received = image(&|at| {
        let (light, colour) = (vector(&light, at), vector(&colours, at));
        let is_known = colour.cmpgt(Vec3::ZERO);
        let known = Vec3::select(is_known, light / colour, Vec3::ZERO);
        let mean = known.element_sum() / is_known.bitmask().count_ones().max(1) as f32;
        Vec3::select(is_known, known, Vec3::splat(mean))
    });
    let lengths = image(&|at| vector(&paths, at).max(Vec3::ZERO) / shape(vector(&colours, at)));
    Ok((received, lengths))
}

/// The g-buffer that the method in screen space is given.
fn given(gbuffer: &GBuffer, received: &Planes, lengths: &Planes) -> Result<GBuffer, MissingAttribute> {
    let (position, valid) = (gbuffer.select(&[Attribute::Position])?, gbuffer.select(&[Attribute::Valid])?);
    let attributes = vec![Attribute::Position, Attribute::MeanFreePath, Attribute::Light, Attribute::Valid];
    let data = [position.data(), lengths.data(), received.data(), valid.data()].concat();
    Ok(GBuffer::new(attributes, Planes::from_data(10, gbuffer.height(), gbuffer.width(), data)))
}
