//! Direct light with shadows: the attributes `L` and `Ldiff` of a g-buffer.

use super::attributes::seen_bindings;
use super::shadow::MapPlan;
use super::surface::SurfaceImage;
use super::world::World;
use crate::path::lights::axes;
use crate::scene::{Encoding, Filter, Light, Scene, TextureId};
use crate::screen::{GpuGBuffer, PassDispatch};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError, Pass};
use deepshade_shaders::wgsl::uniforms::{FrameView, LightRecord};
use deepshade_shaders::wgsl::{Shader, TILE};
use glam::Vec3;
use std::collections::BTreeMap;

/// The lights of a scene on the GPU.
#[derive(Debug)]
pub struct Lights {
    /// `[lights]` records.
    pub records: wgpu::Buffer,
    /// The same, but that lamps which a glowing scene has switched off send nothing: for light that truth has
    /// at one moment. What surfaces keep is of all lamps at other times, too.
    pub shining: wgpu::Buffer,
    /// Texels of the pictures that lights project, a word each.
    pub pictures: wgpu::Buffer,
    /// From where the maps look.
    pub map_views: wgpu::Buffer,
    /// How many there are.
    pub count: usize,
    /// How many there are for what keeps light, with those that stand for the environment: the last.
    pub charging: usize,
    /// Of each its maps and the place of its picture.
    belongings: Vec<LightReferences>,
}

/// A light's first map and how many it has; its picture's first texel, columns, rows, and what its bytes
/// mean.
type LightReferences = (Option<(usize, usize)>, Option<[f32; 4]>);

impl Lights {
    /// Those of a scene, the first of `lights`, with the maps that they have.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(
        device: &wgpu::Device,
        scene: &Scene,
        lights: &[Light],
        plan: &MapPlan,
    ) -> Result<Self, GpuError> {
        let (places, pictures) = pictures(scene);
        let picture = |light: &Light| light.picture().map(|texture| places[&texture.0]);
        let belongings: Vec<LightReferences> =
            lights.iter().zip(&plan.of_lights).map(|(light, maps)| (*maps, picture(light))).collect();
        let mut records = records(lights, &belongings);
        let no_views: Vec<FrameView> = vec![bytemuck::Zeroable::zeroed(); plan.maps.max(1)];
        // A binding holds at least one.
        records.resize(lights.len().max(1), bytemuck::Zeroable::zeroed());
        Ok(Self {
            records: gpu::storage(device, "frame.lights", &records)?,
            shining: gpu::storage(device, "frame.shining", &records)?,
            pictures: gpu::storage(device, "frame.pictures", &pictures)?,
            map_views: gpu::storage(device, "frame.map_views", &no_views)?,
            count: scene.lights.len(),
            charging: lights.len(),
            belongings,
        })
    }

    /// Says where the lights are now, and which of them shine.
    pub fn set(&self, queue: &wgpu::Queue, lights: &[Light], on: &[bool]) {
        let mut records = records(lights, &self.belongings);
        queue.write_buffer(&self.records, 0, bytemuck::cast_slice(&records));
        for (record, _) in records.iter_mut().zip(on).filter(|(_, on)| !**on) {
            let [.., first_map] = record.power;
            record.power = [0.0, 0.0, 0.0, first_map];
        }
        queue.write_buffer(&self.shining, 0, bytemuck::cast_slice(&records));
    }
}

fn records(lights: &[Light], belongings: &[LightReferences]) -> Vec<LightRecord> {
    let of_each = lights.iter().zip(belongings);
    of_each.map(|(light, (maps, picture))| record(light, *maps, *picture)).collect()
}

/// Where each picture's texels begin, its columns and rows, what its bytes mean (1 sRGB, 2 linear; 2 more
/// where the nearest texel is read), and all texels.
fn pictures(scene: &Scene) -> (BTreeMap<u32, [f32; 4]>, Vec<u32>) {
    let (mut places, mut texels) = (BTreeMap::new(), Vec::new());
    for TextureId(index) in scene.lights.iter().filter_map(Light::picture) {
        places.entry(index).or_insert_with(|| {
            let texture = &scene.textures[index as usize];
            let [width, height] = texture.size();
            let first = texels.len();
            texels.extend(texture.texels().iter().map(|texel| u32::from_le_bytes(*texel)));
            let encoding = if texture.encoding() == Encoding::Srgb { 1.0 } else { 2.0 };
            let filter = if texture.filter() == Filter::Nearest { 2.0 } else { 0.0 };
            [first as f32, width as f32, height as f32, encoding + filter]
        });
    }
    (places, texels)
}

fn record(light: &Light, maps: Option<(usize, usize)>, picture: Option<[f32; 4]>) -> LightRecord {
    let (first, count) = maps.map_or((-1.0, 0.0), |(first, count)| (first as f32, count as f32));
    let finite = |range: f32| if range.is_finite() { range } else { 0.0 };
    let (position, kind, axis, range, power, cones, width) = match *light {
        Light::Point { position, intensity, range } => {
            (position, 0.0, Vec3::NEG_Z, finite(range), intensity, [0.0; 2], 0.0)
        }
        Light::Spot { position, direction, intensity, range, cos_inner, cos_outer, .. } => {
            (position, 1.0, direction, finite(range), intensity, [cos_inner, cos_outer], 0.0)
        }
        Light::Directional { direction, irradiance, pattern } => {
            (Vec3::ZERO, 2.0, direction, 0.0, irradiance, [0.0; 2], pattern.map_or(0.0, |(_, width)| width))
        }
    };
    let [right, up] = axes(axis).map(|axis| axis.extend(0.0).to_array());
    LightRecord {
        place: position.extend(kind).to_array(),
        axis: axis.extend(range).to_array(),
        power: power.extend(first).to_array(),
        cone: [cones[0], cones[1], count, width],
        picture: picture.unwrap_or_default(),
        right,
        up,
    }
}

/// How maps are read: the mean of four texels around a point, each lit or not.
pub fn shadow_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("deepshade.frame.shadow"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(wgpu::CompareFunction::GreaterEqual),
        ..Default::default()
    })
}

/// The pass that gathers light into a g-buffer that holds both attributes.
///
/// # Errors
/// If the device refuses.
pub fn step(
    device: &wgpu::Device,
    image: &SurfaceImage,
    world: &World,
    gbuffer: &GpuGBuffer,
) -> Result<PassDispatch, GpuError> {
    let (lights, shadows) = (&world.gpu_lights, &world.shadows);
    let constants = [("LIGHTS", lights.count as u32), ("MEDIUM", world.medium.kind)];
    let pass = Pass::of(device, Shader::at("frame/light"), &constants)?;
    let sampler = shadow_sampler(device);
    let mut resources = seen_bindings(image, &world.materials);
    resources.extend([
        lights.records.as_entire_binding(),
        lights.map_views.as_entire_binding(),
        lights.pictures.as_entire_binding(),
        wgpu::BindingResource::TextureView(&shadows.maps),
        wgpu::BindingResource::Sampler(&sampler),
        world.medium.record.as_entire_binding(),
        wgpu::BindingResource::TextureView(&world.medium.densities),
        gbuffer.buffer(Attribute::Light).as_entire_binding(),
        gbuffer.buffer(Attribute::DiffuseLight).as_entire_binding(),
    ]);
    let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE).into();
    Ok(PassDispatch { pass: pass.bind(device, &resources)?, workgroups })
}
