//! Subsurface scattering as random walks bring it out ([`Effect::Subsurface`]), by methods of scattering in
//! screen space: [`separable`](super::separable) and [`gather`](super::gather), the rivals of surfels, which
//! know only what is seen.
//!
//! In screen space radiance is averaged by Christensen and Burley's profile (2015), whose length is the mean
//! free path. Walks differ in two things. What they bring out is what falls on the surface elsewhere, in the
//! colour of the surface where it comes out: methods are therefore given light as a white surface would
//! reflect it, and what they make of it is multiplied by the colour. And the length is shorter than the mean
//! free path by the paper's equation 6, with the colour where light comes out.
//!
//! Limits: those of each method. Nothing goes through a body that is lit from behind. Bodies give to one
//! another what falls on them. What of a colour falls on a surface that is black in it is not known: it is
//! taken for as much as of the others in the mean, and for nothing where the surface is black in all.

#[cfg(test)]
mod tests;

use super::surface::vector;
use super::surfel::scattering::shape;
use crate::raster::groups;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute, Planes};
use glam::{IVec2, Vec3};

/// A method of [`Effect::Sss`], with what can be set.
#[derive(Clone, Copy, Debug)]
pub struct FromScreen<T>(pub T);

impl<T: Technique> Technique for FromScreen<T> {
    fn about(&self) -> About {
        About::on_screen(
            self.0.about().name,
            Effect::Subsurface,
            &[
                Attribute::Position,
                Attribute::MeanFreePath,
                Attribute::Diffuse,
                Attribute::DiffuseLight,
                Attribute::Valid,
            ],
        )
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.0.uniforms(view)
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let (device, gbuffer) = (to.device, to.gbuffer);
        let values = 3 * gbuffer.height() * gbuffer.width();
        let room = |label: &str| gpu::empty::<f32>(device, label, values);
        let (received, lengths) = (room("subsurface.received")?, room("subsurface.lengths")?);
        let scattered = room("subsurface.scattered")?;
        let reads = to.seen([Attribute::DiffuseLight, Attribute::Diffuse, Attribute::MeanFreePath]);
        let [_, colour, _] = reads;
        let all = groups(values);
        let enter = device.pass(Shader::at("methods/subsurface/enter"), &[])?;
        let leave = device.pass(Shader::at("methods/subsurface/leave"), &[])?;
        let mut steps = vec![MethodStep::bind(device, &enter, all, &reads, &[&received, &lengths])?];
        let given = gbuffer.with(Attribute::Light, received).with(Attribute::MeanFreePath, lengths);
        steps.extend(self.0.steps(&Resources { gbuffer: &given, output: &scattered, ..*to })?);
        steps.push(MethodStep::bind(device, &leave, all, &[&scattered, colour], &[to.output])?);
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
