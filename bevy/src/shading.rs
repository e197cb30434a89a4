//! All of a camera's passes, bound to buffers of its image's size.

mod estimate;

use crate::networks::{DeviceNetwork, SHOWN};
use crate::textures::{Seen, TILE, TexturePasses};
use crate::{LearnedError, Quality};
use bevy::prelude::{Component, Mat4};
use bevy::render::render_resource::{TextureView, TextureViewId};
use deepshade_infer::forward::{FrameRecording, FrameScale, ImageBuffers, InputSource, Runner};
use deepshade_render::scene::Camera;
use deepshade_render::screen::{GpuGBuffer, View};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, BoundPass, GpuError};
use estimate::EstimatePasses;
use std::sync::Arc;
use wgpu::{BindingResource, Buffer, BufferUsages, CommandEncoder};

/// Chooses the random numbers of what methods estimate: the same in every frame, so that their noise stands
/// still, and the same as in deepshade's program.
const SEED: u32 = 1;

/// In the render world, on a camera with learned ambient occlusion: its passes and what they write, for
/// whoever wants to read that in passes of their own.
#[derive(Component)]
pub struct LearnedShading {
    pub(crate) quality: Quality,
    /// Rows and columns.
    pub(crate) size: [usize; 2],
    pub(crate) network: Arc<DeviceNetwork>,
    seen: Buffer,
    /// The passes on both sides, on the textures of these views.
    textures: Option<([TextureViewId; 3], [BoundPass; 2])>,
    gbuffer: GpuGBuffer,
    estimates: Vec<EstimatePasses>,
    input: FrameRecording,
    runner: Runner,
    image_pass: FrameRecording,
    image: Buffer,
}

impl LearnedShading {
    /// Makes room for an image of `[height, width]` and binds the passes.
    ///
    /// # Errors
    /// If the device has no room or refuses something.
    pub(crate) fn new(
        network: Arc<DeviceNetwork>,
        quality: Quality,
        [height, width]: [usize; 2],
    ) -> Result<Self, LearnedError> {
        let device = &network.gpu.device;
        let size = [height, width];
        // Any radius and focal length: each frame tells its own.
        let (view, frame) = (view(size, 1.0, 1.0), scale(&network, 1.0, 1.0));
        let gbuffer = GpuGBuffer::empty(device, height, width, &SHOWN)?;
        let estimates = network.estimates.iter();
        let estimates = estimates.map(|(_, method)| EstimatePasses::new(method, &gbuffer, &view));
        let estimates: Vec<EstimatePasses> = estimates.collect::<Result<_, _>>()?;
        let runner = network.network.runner(height, width)?;
        let mut attributes: Vec<(Attribute, &Buffer)> =
            SHOWN.iter().map(|attribute| (*attribute, gbuffer.buffer(*attribute))).collect();
        for ((estimator, _), made) in network.estimates.iter().zip(&estimates) {
            attributes.extend(estimator.makes().iter().copied().zip(made.images()));
        }
        let source = InputSource { size, attributes: &attributes, run: 0, frame };
        let input = network.input.bind(&source, runner.input())?;
        let image = gpu::empty::<f32>(device, "bevy.openness", height * width)?;
        let (valid, made) = (gbuffer.buffer(Attribute::Valid), runner.output());
        let buffers = ImageBuffers { size, valid, made, image: &image, run: 0 };
        let image_pass = network.image.bind(&buffers, frame)?;
        let seen = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("deepshade.bevy.seen"),
            size: size_of::<Seen>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let textures = None;
        Ok(Self {
            quality,
            size,
            network,
            seen,
            textures,
            gbuffer,
            estimates,
            input,
            runner,
            image_pass,
            image,
        })
    }

    /// Tells the passes of a frame: what its camera sees, how far occlusion reaches.
    pub(crate) fn tell(&self, seen: &Seen, clip_from_view: &Mat4, radius: f32) {
        let queue = &self.network.gpu.queue;
        queue.write_buffer(&self.seen, 0, bytemuck::bytes_of(seen));
        let focal_length = 0.5 * self.size[0] as f32 * clip_from_view.y_axis.y;
        let view = view(self.size, focal_length, radius);
        for ((_, method), estimate) in self.network.estimates.iter().zip(&self.estimates) {
            estimate.look(queue, method, &view);
        }
        let frame = scale(&self.network, focal_length, radius);
        self.input.set(queue, frame);
        self.image_pass.set(queue, frame);
    }

    /// Binds the passes on both sides to Bevy's textures: depth, normals, and where openness goes.
    ///
    /// # Errors
    /// If the device refuses it.
    pub(crate) fn bind(
        &mut self,
        passes: &mut TexturePasses,
        views: [&TextureView; 3],
    ) -> Result<(), GpuError> {
        let ids = views.map(TextureView::id);
        if self.textures.as_ref().is_some_and(|(bound, _)| *bound == ids) {
            return Ok(());
        }
        let [depth, normals, openness] = views.map(|view| BindingResource::TextureView(view));
        let device = &self.network.gpu.device;
        let of = |attribute| self.gbuffer.buffer(attribute).as_entire_binding();
        let [position, normal, valid] = SHOWN.map(of);
        let seen = self.seen.as_entire_binding();
        let read = passes.read(device)?;
        let read = read.bind(device, &[seen, depth, normals, position, normal, valid])?;
        let write = passes.write(device, views[2].texture().format())?;
        let write = write.bind(device, &[self.image.as_entire_binding(), openness])?;
        self.textures = Some((ids, [read, write]));
        Ok(())
    }

    /// Records all passes, from the prepass' textures to that of openness, on those of the last frame.
    /// Nothing is made anew.
    pub fn encode(&self, encoder: &mut CommandEncoder) {
        let Some((_, [read, write])) = &self.textures else { return };
        let groups = gpu::groups(self.size[0], self.size[1], TILE);
        read.dispatch(encoder, groups);
        self.estimates.iter().for_each(|estimate| estimate.encode(encoder));
        self.input.encode(encoder);
        self.runner.encode(encoder);
        self.image_pass.encode(encoder);
        write.dispatch(encoder, groups);
    }

    /// Rows and columns of the image.
    pub const fn size(&self) -> [usize; 2] {
        self.size
    }

    /// What the camera sees, in camera space: `position` and `normal`, three planes each, and `valid`, which
    /// is 1 where a surface is seen.
    pub const fn gbuffer(&self) -> &GpuGBuffer {
        &self.gbuffer
    }

    /// Openness, a plane of the image's size: 1 where nothing occludes.
    pub const fn image(&self) -> &Buffer {
        &self.image
    }
}

/// The view of a frame as methods see it, of which they want to know the angle of view alone.
fn view([height, width]: [usize; 2], focal_length: f32, radius: f32) -> View {
    let vertical_fov = 2.0 * (0.5 * height as f32 / focal_length).atan();
    let ahead = [0.0, 0.0, -1.0].into();
    let camera = Camera { vertical_fov, ..Camera::look_at(Default::default(), ahead) };
    View { height, width, camera, radius, seed: SEED }
}

fn scale(network: &DeviceNetwork, focal_length: f32, radius: f32) -> FrameScale {
    FrameScale { focal_length, radius, scaling: network.spec.scaling_of_lengths(radius) }
}
