//! Both sides of a network of depth of field.
//!
//! Networks of light want it exposed alike. Each frame is, on the device: its light is counted by brightness,
//! multiplied before the network, and divided behind it.

use super::{Draw, Inside, Sides, Step, TILE, TexturePasses};
use bevy::render::render_resource::TextureView;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use wgpu::{BindingResource, Buffer, Device, TextureFormat};

/// Half floats above 0, by which light is counted: `BINS` in the shaders.
const BINS: usize = 1 << 15;
/// Invocations of a workgroup, and workgroups in a row, of `expose.wgsl`.
const ROW: usize = 256 * 256;

/// The passes before the network. Cameras share the buffers, as their passes run one after the other.
pub(super) struct LightPasses {
    read: Pass,
    measure: Pass,
    expose: Pass,
    /// How many numbers of the light there are of each half float.
    counts: Buffer,
    /// By what light is multiplied.
    exposure: Buffer,
}

impl LightPasses {
    fn new(device: &Device) -> Result<Self, GpuError> {
        let pass = |name: &str, source| Pass::new(device, &format!("bevy.{name}"), source);
        Ok(Self {
            read: pass("read_light", include_str!("read_light.wgsl"))?,
            measure: pass("measure", include_str!("measure.wgsl"))?,
            expose: pass("expose", include_str!("expose.wgsl"))?,
            counts: gpu::empty::<u32>(device, "bevy.counts", BINS)?,
            exposure: gpu::empty::<f32>(device, "bevy.exposure", 1)?,
        })
    }
}

impl TexturePasses {
    /// From a camera's depth and its picture to exposed light, depth and blurriness; and from exposed light
    /// to another texture of the picture's format.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn around_depth_of_field(
        &mut self,
        inside: &Inside<'_>,
        views: [&TextureView; 3],
        format: TextureFormat,
    ) -> Result<Sides, GpuError> {
        let Inside { device, size: [height, width], seen, image, .. } = *inside;
        let [depths, picture, _] = views.map(|view| BindingResource::TextureView(view));
        let passes = match self.light.take() {
            Some(passes) => passes,
            None => LightPasses::new(device)?,
        };
        let LightPasses { read, measure, expose, counts, exposure } = &*self.light.insert(passes);
        let [counted, exposed, seen, image] =
            [counts, exposure, seen, image].map(|buffer| buffer.as_entire_binding());
        let [light, depth, blurriness, valid] =
            [Attribute::Light, Attribute::Depth, Attribute::Blurriness, Attribute::Valid]
                .map(|of| inside.planes(of));
        let groups = gpu::groups(height, width, TILE);
        let bindings =
            [seen.clone(), depths, picture.clone(), light.clone(), depth, blurriness, valid, counted.clone()];
        let read = read.bind(device, &bindings)?;
        let measure = measure.bind(device, &[counted, exposed.clone()])?;
        let expose = expose.bind(device, &[exposed.clone(), light])?;
        let rows = (3 * height * width).div_ceil(ROW) as u32;
        let before = vec![
            Step::Clear(counts.clone()),
            Step::Dispatch(read, groups),
            Step::Dispatch(measure, [1, 1, 1]),
            Step::Dispatch(expose, [256, rows, 1]),
        ];
        let draw = match self.write_light.take().filter(|(known, _)| *known == format) {
            Some((_, draw)) => draw,
            None => Draw::new(device, "bevy.write_light", include_str!("write_light.wgsl"), format),
        };
        let (_, draw) = self.write_light.insert((format, draw));
        let after = Step::Draw(draw.bind(device, &[seen, picture, image, exposed], views[2]));
        Ok(Sides { before, after })
    }
}
