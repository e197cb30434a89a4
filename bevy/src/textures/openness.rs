//! Both sides of a network of ambient occlusion.

use super::{Inside, Sides, Step, TILE, TexturePasses};
use bevy::render::render_resource::TextureView;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use wgpu::{BindingResource, Device, TextureFormat};

impl TexturePasses {
    /// From a prepass' depth and normals to positions, normals and what is seen; and from openness to a
    /// texture as Bevy's ambient occlusion has it.
    ///
    /// # Errors
    /// If the device refuses it.
    pub fn around_occlusion(
        &mut self,
        inside: &Inside<'_>,
        views: [&TextureView; 3],
    ) -> Result<Sides, GpuError> {
        let Inside { device, size, seen, image, .. } = *inside;
        let [depth, normals, openness] = views.map(|view| BindingResource::TextureView(view));
        let [position, normal, valid] =
            [Attribute::Position, Attribute::Normal, Attribute::Valid].map(|of| inside.planes(of));
        let read = self.read_prepass(device)?;
        let read = read.bind(device, &[seen.as_entire_binding(), depth, normals, position, normal, valid])?;
        let write = self.write_openness(device, views[2].texture().format())?;
        let write = write.bind(device, &[image.as_entire_binding(), openness])?;
        let groups = gpu::groups(size[0], size[1], TILE);
        Ok(Sides { before: vec![Step::Dispatch(read, groups)], after: Step::Dispatch(write, groups) })
    }

    fn read_prepass(&mut self, device: &Device) -> Result<Pass, GpuError> {
        if let Some(pass) = &self.read_prepass {
            return Ok(pass.clone());
        }
        let pass = Pass::new(device, "bevy.read_prepass", include_str!("read_prepass.wgsl"))?;
        Ok(self.read_prepass.insert(pass).clone())
    }

    /// Of a format that Bevy has for it, `R16Float` or `R32Float`.
    fn write_openness(&mut self, device: &Device, format: TextureFormat) -> Result<Pass, GpuError> {
        if let Some((known, pass)) = &self.write_openness
            && *known == format
        {
            return Ok(pass.clone());
        }
        let source = include_str!("write_openness.wgsl");
        let source = match format {
            TextureFormat::R16Float => source.replace("r32float", "r16float"),
            _ => source.to_owned(),
        };
        let pass = Pass::new(device, "bevy.write_openness", &source)?;
        self.write_openness = Some((format, pass.clone()));
        Ok(pass)
    }
}
