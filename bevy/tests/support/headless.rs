//! A Bevy app without a window that draws a glTF scene into an image, frame by frame.

use super::{cameras, reading, types};
use bevy::app::{App, PluginGroup};
use bevy::asset::{AssetPlugin, AssetServer, Assets, Handle, RenderAssetUsages};
use bevy::camera::{Projection, RenderTarget, Viewport};
use bevy::image::Image;
use bevy::log::LogPlugin;
use bevy::math::UVec2;
use bevy::pbr::{ScreenSpaceAmbientOcclusion, ScreenSpaceAmbientOcclusionResources};
use bevy::prelude::{Bundle, Camera, DefaultPlugins, Entity, Mesh3d};
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{PipelineCache, TextureFormat, TextureUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::texture::GpuImage;
use bevy::render::view::ViewTarget;
use bevy::render::{RenderApp, RenderPlugin};
use bevy::window::{ExitCondition, WindowPlugin};
use bevy::winit::WinitPlugin;
use bevy::world_serialization::WorldAssetRoot;
use deepshade_bevy::{DeepshadePlugin, LearnedAmbientOcclusion, LearnedFailures, LearnedShading};
use deepshade_render::scene;
use deepshade_shaders::{GBuffer, Planes};
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

/// How long a scene may take to be loaded, and pipelines to be compiled.
const PATIENCE: Duration = Duration::from_secs(300);
/// Frames after which everything that is drawn is there.
const SETTLED: usize = 4;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// The app, with one camera.
pub struct Headless {
    app: App,
    camera: Entity,
    target: Handle<Image>,
    size: [usize; 2],
}

impl Headless {
    /// An app that draws a file of a folder as a camera of deepshade's sees it, `size` rows and columns, lit
    /// by ambient light alone.
    pub fn new(
        models: &Path,
        folder: &Path,
        file: &str,
        camera: &scene::Camera,
        size: [usize; 2],
    ) -> Result<Self> {
        let mut app = App::new();
        let assets = AssetPlugin { file_path: folder.display().to_string(), ..Default::default() };
        let window = WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..Default::default()
        };
        let render = RenderPlugin { synchronous_pipeline_compilation: true, ..Default::default() };
        app.add_plugins((
            DefaultPlugins
                .set(assets)
                .set(window)
                .set(render)
                .disable::<LogPlugin>()
                .disable::<WinitPlugin>()
                .disable::<PipelinedRenderingPlugin>(),
            DeepshadePlugin { models: models.to_owned() },
        ));
        types::register(&mut app);
        app.finish();
        app.cleanup();
        let [height, width] = size;
        let mut image =
            Image::new_target_texture(width as u32, height as u32, TextureFormat::Rgba8UnormSrgb, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        image.asset_usage = RenderAssetUsages::RENDER_WORLD;
        let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let asset = app.world().resource::<AssetServer>().load(format!("{file}#Scene0"));
        app.world_mut().spawn(WorldAssetRoot(asset));
        let camera =
            app.world_mut().spawn((cameras::of(camera), RenderTarget::Image(target.clone().into()))).id();
        let mut headless = Self { app, camera, target, size };
        headless.wait()?;
        Ok(headless)
    }

    /// Draws until all of the scene is there.
    fn wait(&mut self) -> Result<()> {
        let begin = Instant::now();
        loop {
            self.app.update();
            let world = self.app.world_mut();
            let meshes = world.query::<&Mesh3d>().iter(world).count();
            let is_loaded = meshes > 0 && {
                let server = world.resource::<AssetServer>();
                let handles: Vec<_> = world.try_query::<&Mesh3d>().map_or_else(Vec::new, |mut query| {
                    query.iter(world).map(|mesh| mesh.0.clone()).collect()
                });
                handles.iter().all(|mesh| server.is_loaded_with_dependencies(mesh))
            };
            if is_loaded {
                self.draw(SETTLED);
                return Ok(());
            }
            if begin.elapsed() > PATIENCE {
                return Err("the scene is not loaded".into());
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Draws so many frames, and until no pipeline is missing.
    pub fn draw(&mut self, frames: usize) {
        let mut drawn = 0;
        while drawn < frames {
            self.app.update();
            let cache = self.app.sub_app(RenderApp).world().resource::<PipelineCache>();
            drawn = if cache.waiting_pipelines().next().is_some() { 0 } else { drawn + 1 };
        }
    }

    /// Adds something to the scene and draws until it shows.
    pub fn add(&mut self, bundle: impl Bundle) {
        self.app.world_mut().spawn(bundle);
        self.draw(SETTLED);
    }

    /// Puts something on the camera that shows from the next frame on.
    pub fn put(&mut self, bundle: impl Bundle) {
        self.app.world_mut().entity_mut(self.camera).insert(bundle);
    }

    /// Puts something on the camera and draws until it shows.
    pub fn with(&mut self, bundle: impl Bundle) {
        self.put(bundle);
        self.draw(SETTLED);
    }

    /// Takes something off the camera.
    pub fn without<B: Bundle>(&mut self) {
        self.app.world_mut().entity_mut(self.camera).remove::<B>();
        self.draw(SETTLED);
    }

    /// Has the camera draw into a part of the image, its left upper corner and its rows and columns.
    pub fn look_through(&mut self, origin: [u32; 2], [height, width]: [usize; 2]) {
        let mut camera = self.app.world_mut().entity_mut(self.camera);
        if let Some(mut camera) = camera.get_mut::<Camera>() {
            let physical_size = UVec2::new(width as u32, height as u32);
            let physical_position = UVec2::from_array(origin);
            camera.viewport = Some(Viewport { physical_position, physical_size, ..Default::default() });
        }
        self.draw(SETTLED);
    }

    /// The camera's projection.
    pub fn projection(&self) -> Option<Projection> {
        self.app.world().get::<Projection>(self.camera).cloned()
    }

    /// Learned occlusion and none of Bevy's.
    pub fn learned(&mut self, wanted: LearnedAmbientOcclusion) {
        self.without::<ScreenSpaceAmbientOcclusion>();
        self.with(wanted);
    }

    /// Bevy's own occlusion and no other.
    pub fn bevys(&mut self, wanted: ScreenSpaceAmbientOcclusion) {
        self.without::<LearnedAmbientOcclusion>();
        self.with(wanted);
    }

    /// The render world.
    pub fn world(&self) -> &bevy::prelude::World {
        self.app.sub_app(RenderApp).world()
    }

    /// The render world, for queries.
    pub fn world_mut(&mut self) -> &mut bevy::prelude::World {
        self.app.sub_app_mut(RenderApp).world_mut()
    }

    /// Bevy's device and its queue.
    pub fn device(&self) -> (&wgpu::Device, &wgpu::Queue) {
        let queue = self.world().resource::<RenderQueue>();
        (self.world().resource::<RenderDevice>().wgpu_device(), queue)
    }

    /// The texture of openness that Bevy's materials read; none where they read none.
    pub fn openness(&mut self) -> Result<Option<Planes>> {
        let world = self.app.sub_app_mut(RenderApp).world_mut();
        let views: Vec<_> = {
            let mut query = world.query::<&ScreenSpaceAmbientOcclusionResources>();
            let views = query
                .iter(world)
                .map(|made| made.screen_space_ambient_occlusion_texture.default_view.clone());
            views.collect()
        };
        let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
        Ok(views.first().map(|view| reading::texture(device, queue, view, 1)).transpose()?)
    }

    /// What the passes of a component are shown of the camera.
    pub fn gbuffer<E: Send + Sync + 'static>(&mut self) -> Result<GBuffer> {
        let world = self.app.sub_app_mut(RenderApp).world_mut();
        let mut query = world.query::<&LearnedShading<E>>();
        let shading = query.iter(world).next().ok_or("no learned effect")?;
        let [height, width] = shading.size();
        let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
        let (mut attributes, mut values) = (Vec::new(), Vec::new());
        for attribute in shading.gbuffer().attributes() {
            let buffer = shading.gbuffer().buffer(attribute);
            let shape = [attribute.width(), height, width];
            values.extend_from_slice(reading::planes(device.wgpu_device(), queue, buffer, shape)?.data());
            attributes.push(attribute);
        }
        let channels = values.len() / (height * width);
        Ok(GBuffer::new(attributes, Planes::from_data(channels, height, width, values)))
    }

    /// The picture before it is shown, `[3, height, width]`: as the last pass on it has left it, or as that
    /// pass has found it.
    pub fn light(&mut self, is_found: bool) -> Result<Planes> {
        let world = self.app.sub_app_mut(RenderApp).world_mut();
        let mut query = world.query::<&ViewTarget>();
        let target = query.iter(world).next().ok_or("nothing is drawn")?;
        let view = if is_found { target.main_texture_other_view() } else { target.main_texture_view() };
        let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
        Ok(reading::texture(device, queue, view, 3)?)
    }

    /// Why there is not what the camera asks for.
    pub fn failures(&self) -> Vec<String> {
        self.world().resource::<LearnedFailures>().all().map(str::to_owned).collect()
    }

    /// The frame, `[3, height, width]`, from 0 to 1 as a screen shows it.
    pub fn picture(&self) -> Result<Planes> {
        let [height, width] = self.size;
        let (device, queue) = self.device();
        let images = self.world().resource::<RenderAssets<GpuImage>>();
        let image = images.get(&self.target).ok_or("no image")?;
        let row = (4 * width as u32).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test.picture"),
            size: u64::from(row) * height as u64,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout { bytes_per_row: Some(row), ..Default::default() };
        deepshade_shaders::gpu::submit(device, queue, "test.picture", |encoder| {
            let into = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
            encoder.copy_texture_to_buffer(image.texture.as_image_copy(), into, image.texture.size());
        })?;
        let bytes: Vec<u8> = deepshade_shaders::gpu::read(device, queue, &buffer)?;
        let value = |c: usize, y: usize, x: usize| f32::from(bytes[y * row as usize + 4 * x + c]) / 255.0;
        Ok(Planes::from_fn(3, height, width, value))
    }
}
