//! Spreads the raster pass' words over the planes of a g-buffer.

use super::surface::SurfaceImage;
use crate::scene::Scene;
use crate::screen::{GpuGBuffer, PassDispatch};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::TILE;
use deepshade_shaders::wgsl::attributes::{ATTRIBUTES_A_PASS, attributes_source};

/// Which material each mesh has, and the materials, for passes that read the words.
#[derive(Debug)]
pub struct Materials {
    /// `[meshes]` u32.
    pub of_meshes: wgpu::Buffer,
    /// `[materials]` records.
    pub records: wgpu::Buffer,
}

impl Materials {
    /// Those of a scene.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(device: &wgpu::Device, scene: &Scene) -> Result<Self, GpuError> {
        let of_meshes: Vec<u32> = scene.meshes.iter().map(|mesh| mesh.material.0).collect();
        let records: Vec<_> = scene.materials.iter().map(super::material::record).collect();
        Ok(Self {
            of_meshes: gpu::storage(device, "frame.mesh_materials", &of_meshes)?,
            records: gpu::storage(device, "frame.materials", &records)?,
        })
    }
}

/// What every pass that reads the words binds: bindings 0 to 5.
pub fn seen_bindings<'a>(
    image: &'a SurfaceImage,
    materials: &'a Materials,
) -> Vec<wgpu::BindingResource<'a>> {
    let view = |view| wgpu::BindingResource::TextureView(view);
    vec![
        image.view.as_entire_binding(),
        view(&image.words[0]),
        view(&image.words[1]),
        view(&image.depth),
        materials.of_meshes.as_entire_binding(),
        materials.records.as_entire_binding(),
    ]
}

/// The passes that write all attributes of a g-buffer but for light.
///
/// # Errors
/// If the device refuses.
pub fn steps(
    device: &wgpu::Device,
    image: &SurfaceImage,
    materials: &Materials,
    gbuffer: &GpuGBuffer,
) -> Result<Vec<PassDispatch>, GpuError> {
    let is_light = |attribute: &Attribute| matches!(attribute, Attribute::Light | Attribute::DiffuseLight);
    let written: Vec<Attribute> = gbuffer.attributes().filter(|attribute| !is_light(attribute)).collect();
    let step = |attributes: &[Attribute]| {
        let pass = Pass::new(device, "frame.attributes", &attributes_source(attributes))?;
        let outputs = attributes.iter().map(|attribute| gbuffer.buffer(*attribute).as_entire_binding());
        let resources: Vec<_> = seen_bindings(image, materials).into_iter().chain(outputs).collect();
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE).into();
        Ok(PassDispatch { pass: pass.bind(device, &resources)?, workgroups })
    };
    written.chunks(ATTRIBUTES_A_PASS).map(step).collect()
}
