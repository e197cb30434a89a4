//! A method at half the rows and columns of its image, for light that changes slowly over surfaces: what it
//! makes of every second pixel of every second row is brought to all by the surfaces that these show
//! ([`upsampling`]).
//!
//! Limit: a thing so thin that none of these pixels shows it gets the light of what is beside it, or none.

use super::{
    About, GpuGBuffer, MethodStep, PlainInputs, Resources, Surface, Technique, View, Written, upsampling,
};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE};
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes};

/// A method of which every fourth pixel is made. It reads positions, normals and validity, maybe more.
#[derive(Clone, Copy, Debug)]
pub struct Halved<T>(pub T);

fn halved(size: [usize; 2]) -> [usize; 2] {
    size.map(|edge| edge.div_ceil(2))
}

fn halved_view(view: &View) -> View {
    let [height, width] = halved([view.height, view.width]);
    View { height, width, ..*view }
}

impl<T: Technique> Technique for Halved<T> {
    fn about(&self) -> About {
        self.0.about()
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        self.0.uniforms(&halved_view(view))
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let About { effect, attributes, .. } = self.about();
        let [rows, columns] = halved(to.size());
        let upsampling = upsampling::settings_of_halved(to.size(), effect);
        let settings = gpu::uniform(to.device, "halved", &upsampling)?;
        let few = GpuGBuffer::empty(to.device, rows, columns, attributes)?;
        let image = gpu::empty::<f32>(to.device, "halved.image", effect.channels() * rows * columns)?;
        let halve = |attribute: Attribute| {
            let channels = [("CHANNELS", attribute.width() as u32)];
            let pass = to.device.pass(Shader::at("frame/halve"), &channels)?;
            let (from, into) = (to.gbuffer.buffer(attribute), few.buffer(attribute));
            MethodStep::bind(to.device, &pass, gpu::groups(rows, columns, TILE), &[&settings, from], &[into])
        };
        let mut steps: Vec<MethodStep> =
            attributes.iter().copied().map(halve).collect::<Result<_, GpuError>>()?;
        steps.extend(self.0.steps(&Resources { gbuffer: &few, output: &image, ..*to })?);
        steps.push(upsampling::step(
            to.device,
            (effect, &upsampling),
            (&few, &image),
            (to.gbuffer, to.output),
        )?);
        Ok(steps)
    }

    /// The image alone.
    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let About { effect, attributes, .. } = self.about();
        let size = [view.height, view.width];
        let [rows, columns] = halved(size);
        let all = inputs.gbuffer.select(attributes)?;
        let of_few = Planes::from_fn(all.channels(), rows, columns, |c, y, x| all.at(c, 2 * y, 2 * x));
        let few = GBuffer::new(attributes.to_vec(), of_few);
        let written = self.0.reference(&PlainInputs { gbuffer: &few, ..*inputs }, &halved_view(view))?;
        let Some(image) = written.into_iter().next_back() else { return Ok(Written::new()) };
        let image = Planes::from_data(effect.channels(), rows, columns, image);
        let (few, surface) = (Surface::of(&few)?, Surface::of(inputs.gbuffer)?);
        let settings = upsampling::settings_of_halved(size, effect);
        Ok(vec![upsampling::reference((&few, &image), &surface, &settings).data().to_vec()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::Quality;
    use crate::methods::gtao::GtaoParameters;
    use crate::methods::proving::{Tolerance, agree, mean_difference, on_gpu, still_life, view};
    use crate::screen::ScreenMethod;
    use deepshade_shaders::gpu::Gpu;

    #[test]
    fn passes_make_what_the_plain_version_does_and_nearly_what_all_pixels_would() {
        let gpu = Gpu::new().expect("an adapter; lavapipe will do");
        let gtao = GtaoParameters::of(Quality::Ultra);
        for (height, width) in [(66, 96), (41, 59)] {
            let (gbuffer, view) = (still_life(height, width), view(height, width, 1.0));
            let method = ScreenMethod::new(&gpu, Halved(gtao));
            let image = on_gpu(&method, &gbuffer, None, &view);
            let inputs = PlainInputs { gbuffer: &gbuffer, environment: None, scene: None };
            let right = method.reference(&inputs, &view).expect("attributes").pop().expect("an image");
            let right = Planes::from_data(1, height, width, right);
            assert_eq!(agree(&image, &right, Tolerance { usual: 2e-2, worst: 0.5 }), Ok(()));
            let all = on_gpu(&ScreenMethod::new(&gpu, gtao), &gbuffer, None, &view);
            let off = mean_difference(&image, &all);
            assert!((1e-4..0.03).contains(&off), "{off}");
        }
    }
}
