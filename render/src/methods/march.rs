//! Methods that march through the g-buffer from every pixel, in random directions, and blur the noise:
//! [`gtao`](super::gtao), [`hbao`](super::hbao), [`ssdo`](super::ssdo) and [`ssgi`](super::ssgi). Such a
//! method is what [`Marched`] asks for; its passes, its image in plain Rust and its dials follow.

use super::{Surface, blur, images};
use crate::scene::Environment;
use crate::screen::{About, MethodStep, PlainInputs, Resources, Technique, View, Written, host};
use bytemuck::bytes_of;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::host::{Extent, HostBinding, HostBuffer, HostPart, HostPass, HostPasses};
use deepshade_shaders::wgsl::uniforms::Uniform;
use deepshade_shaders::wgsl::{Shader, TILE};
use deepshade_shaders::{Attribute, Effect, MissingAttribute, Planes};
use std::fmt::Debug;

/// A method that marches and blurs. Its parameters implement it.
pub trait Marched: Debug + Send + Sync {
    /// Its name on the command line.
    const NAME: &'static str;
    /// What it computes.
    const EFFECT: Effect;
    /// What it reads of a g-buffer, in the order of the march's bindings.
    const ATTRIBUTES: &'static [Attribute] = &[Attribute::Position, Attribute::Normal, Attribute::Valid];
    /// The march: it reads its uniform buffer, the attributes and [`more`](Self::more), and writes the image.
    const SHADER: Shader;
    /// What the march's uniform buffer holds.
    type March: Uniform;

    /// The march's parameters for a view.
    fn march(&self, view: &View) -> Self::March;

    /// What removes its noise.
    fn blur(&self) -> blur::BlurParameters;

    /// What else the march reads.
    fn more(&self, _environment: Option<&Environment>) -> Option<Vec<[f32; 4]>> {
        None
    }

    /// The march in plain Rust: the image before the blur, `[channels, height, width]`.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    fn noisy(
        &self,
        inputs: &PlainInputs<'_>,
        surface: &Surface,
        march: &Self::March,
    ) -> Result<Planes, MissingAttribute>;

    /// What all passes write, as [`blurred`] has it, by vector instructions of the processor, of methods that
    /// have such a version.
    fn on_processor(&self, _surface: &Surface, _view: &View) -> Option<[Planes; 3]> {
        None
    }
}

/// What the passes write, in plain Rust: the image before the blur, after that along rows, and after both,
/// `[channels, height, width]` each.
pub fn blurred<M: Marched>(method: &M, surface: &Surface, view: &View, noisy: Planes) -> [Planes; 3] {
    let [along_rows, image] = blur::smooth(surface, &method.blur().settings(view, M::EFFECT), &noisy);
    [noisy, along_rows, image]
}

impl<M: Marched> Technique for M {
    fn about(&self) -> About {
        About::on_screen(M::NAME, M::EFFECT, M::ATTRIBUTES)
    }

    fn uniforms(&self, view: &View) -> Vec<Vec<u8>> {
        let [rows, columns] = self.blur().settings(view, M::EFFECT);
        vec![bytes_of(&self.march(view)).to_vec(), bytes_of(&rows).to_vec(), bytes_of(&columns).to_vec()]
    }

    fn steps(&self, to: &Resources<'_>) -> Result<Vec<MethodStep>, GpuError> {
        let Resources { device, gbuffer, output: image, .. } = *to;
        let [march, rows, columns] = to.uniforms else { unreachable!("there are three uniform buffers") };
        let more = self.more(to.environment);
        let more = more.map(|more| gpu::storage(device, &format!("{}.more", M::NAME), &more)).transpose()?;
        let attributes = M::ATTRIBUTES.iter().map(|attribute| gbuffer.buffer(*attribute));
        let reads: Vec<_> = [march].into_iter().chain(attributes).chain(&more).collect();
        let marched = MethodStep::bind(device, &device.pass(M::SHADER, &[])?, to.whole(), &reads, &[image])?;
        let (channels, [height, width]) = (M::EFFECT.channels(), to.size());
        let half_blurred = gpu::empty::<f32>(device, "blur.half_blurred", channels * height * width)?;
        let mask = gbuffer.buffer(Attribute::Valid);
        let blurred = blur::Blurred { image, channels, half_blurred: &half_blurred, mask };
        let blurs = blur::steps(device, gbuffer, blurred, [rows, columns])?;
        Ok([marched].into_iter().chain(blurs).collect())
    }

    fn host_passes(&self, raw: &str, image: &str) -> Option<HostPasses> {
        if self.more(None).is_some() {
            return None;
        }
        let told = host::values(&M::March::LAYOUT, |view| bytes_of(&self.march(view)).to_vec())?;
        let mut march = HostPass::new(M::NAME, M::SHADER.specialised(&[]), Extent::IMAGE, TILE)
            .told(&M::March::LAYOUT, |field| told[field]);
        for (binding, attribute) in (1..).zip(M::ATTRIBUTES) {
            march = march.bind(binding, HostBinding::read(attribute.name()));
        }
        march = march.bind(1 + M::ATTRIBUTES.len() as u32, HostBinding::written(raw));
        let blurs = blur::host_passes(&self.blur(), M::EFFECT, raw, image)?;
        let mut all = HostPasses { passes: [march].into_iter().chain(blurs).collect(), ..Default::default() };
        all.add_attributes(M::ATTRIBUTES);
        for name in [raw, blur::HALF_BLURRED, image] {
            let part = HostPart::floats(Extent::IMAGE, M::EFFECT.channels());
            all.add(name, HostBuffer::Made(vec![part]));
        }
        Some(all)
    }

    fn reference(&self, inputs: &PlainInputs<'_>, view: &View) -> Result<Written, MissingAttribute> {
        let surface = Surface::of(inputs.gbuffer)?;
        let noisy = self.noisy(inputs, &surface, &self.march(view))?;
        Ok(images(blurred(self, &surface, view, noisy)))
    }

    fn on_processor(
        &self,
        inputs: &PlainInputs<'_>,
        view: &View,
    ) -> Option<Result<Written, MissingAttribute>> {
        match Surface::of(inputs.gbuffer) {
            Ok(surface) => Marched::on_processor(self, &surface, view).map(|written| Ok(images(written))),
            Err(missing) => Some(Err(missing)),
        }
    }
}
