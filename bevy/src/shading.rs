//! All of a camera's passes, bound to buffers of its image's size.

mod estimate;

use crate::effect::Reach;
use crate::networks::DeviceNetwork;
use crate::textures::{Inside, Seen, Sides};
use crate::{LearnedAmbientOcclusion, LearnedError};
use bevy::prelude::Component;
use bevy::render::render_resource::{TextureView, TextureViewId};
use deepshade_infer::forward::{FrameRecording, FrameScale, ImageBuffers, InputSource, Runner};
use deepshade_render::scene::Camera;
use deepshade_render::screen::{GpuGBuffer, View};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError};
use estimate::EstimatePasses;
use std::marker::PhantomData;
use std::sync::Arc;
use wgpu::{Buffer, BufferUsages, CommandEncoder};

/// Chooses the random numbers of what methods estimate: the same in every frame, so that their noise stands
/// still, and the same as in deepshade's program.
const SEED: u32 = 1;
/// For so many pictures at once passes stay bound.
const KEPT: usize = 2;

/// In the render world, on a camera with a learned effect: its passes and what they write, for whoever wants
/// to read that in passes of their own. `E` is the component that asks for it.
#[derive(Component)]
pub struct LearnedShading<E = LearnedAmbientOcclusion> {
    /// Of which of [`DeepshadePlugin::models`](crate::DeepshadePlugin::models) its network is.
    pub(crate) folder: &'static str,
    /// Rows and columns.
    pub(crate) size: [usize; 2],
    network: Arc<DeviceNetwork>,
    seen: Buffer,
    /// The passes on both sides, on the textures of these views, those of the last frame last. Bevy's
    /// pictures may change places from frame to frame.
    sides: Vec<([TextureViewId; 3], Sides)>,
    gbuffer: GpuGBuffer,
    estimates: Vec<EstimatePasses>,
    input: FrameRecording,
    runner: Runner,
    image_pass: FrameRecording,
    image: Buffer,
    of: PhantomData<fn() -> E>,
}

impl<E> LearnedShading<E> {
    /// Makes room for an image of `[height, width]` and binds the passes, which are shown some attributes.
    ///
    /// # Errors
    /// If the device has no room or refuses something.
    pub(crate) fn new(
        network: Arc<DeviceNetwork>,
        folder: &'static str,
        shown: &[Attribute],
        [height, width]: [usize; 2],
    ) -> Result<Self, LearnedError> {
        let device = &network.gpu.device;
        let size = [height, width];
        // Any reach and focal length: each frame tells its own.
        let any = Reach { radius: 1.0, lens: None };
        let (view, frame) = (view(size, 1.0, any), scale(&network, 1.0, any));
        let gbuffer = GpuGBuffer::empty(device, height, width, shown)?;
        let estimates = network.estimates.iter();
        let estimates = estimates.map(|(makes, method)| EstimatePasses::new(makes, method, &gbuffer, &view));
        let estimates: Vec<EstimatePasses> = estimates.collect::<Result<_, _>>()?;
        let runner = network.network.runner(height, width)?;
        let mut attributes: Vec<(Attribute, &Buffer)> =
            shown.iter().map(|attribute| (*attribute, gbuffer.buffer(*attribute))).collect();
        for ((estimator, _), made) in network.estimates.iter().zip(&estimates) {
            attributes.extend(estimator.makes().iter().copied().zip(made.images()));
        }
        let source = InputSource { size, attributes: &attributes, run: 0, frame };
        let input = network.input.bind(&source, runner.input())?;
        let channels = network.spec.effect.channels();
        let image = gpu::empty::<f32>(device, "bevy.image", channels * height * width)?;
        let (valid, made) = (gbuffer.buffer(Attribute::Valid), runner.output());
        let buffers = ImageBuffers { size, valid, made, image: &image, run: 0 };
        let image_pass = network.image.bind(&buffers, frame)?;
        let seen = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("deepshade.bevy.seen"),
            size: size_of::<Seen>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let (sides, of) = (Vec::new(), PhantomData);
        Ok(Self {
            folder,
            size,
            network,
            seen,
            sides,
            gbuffer,
            estimates,
            input,
            runner,
            image_pass,
            image,
            of,
        })
    }

    /// Tells the passes of a frame: what its camera sees, its focal length in pixels, how far the effect
    /// reaches.
    pub(crate) fn tell(&self, seen: &Seen, focal_length: f32, reach: Reach) {
        let queue = &self.network.gpu.queue;
        queue.write_buffer(&self.seen, 0, bytemuck::bytes_of(seen));
        let view = view(self.size, focal_length, reach);
        for ((_, method), estimate) in self.network.estimates.iter().zip(&self.estimates) {
            estimate.look(queue, method, &view);
        }
        let frame = scale(&self.network, focal_length, reach);
        self.input.set(queue, frame);
        self.image_pass.set(queue, frame);
    }

    /// Binds the passes on both sides, which `make` makes, to Bevy's textures, unless they are.
    ///
    /// # Errors
    /// If the device refuses it.
    pub(crate) fn bind(
        &mut self,
        views: [&TextureView; 3],
        make: impl FnOnce(&Inside<'_>, [&TextureView; 3]) -> Result<Sides, GpuError>,
    ) -> Result<(), GpuError> {
        let ids = views.map(TextureView::id);
        if let Some(at) = self.sides.iter().position(|(bound, _)| *bound == ids) {
            self.sides[at..].rotate_left(1);
            return Ok(());
        }
        let Self { network, seen, gbuffer, image, size, .. } = &*self;
        let inside = Inside { device: &network.gpu.device, size: *size, seen, gbuffer, image };
        let made = make(&inside, views)?;
        if self.sides.len() == KEPT {
            self.sides.remove(0);
        }
        self.sides.push((ids, made));
        Ok(())
    }

    /// Records all passes, from Bevy's textures to the one that the effect is written to, on those of the
    /// last frame. Nothing is made anew.
    pub fn encode(&self, encoder: &mut CommandEncoder) {
        let Some((_, sides)) = self.sides.last() else { return };
        sides.before.iter().for_each(|step| step.encode(encoder));
        self.estimates.iter().for_each(|estimate| estimate.encode(encoder));
        self.input.encode(encoder);
        self.runner.encode(encoder);
        self.image_pass.encode(encoder);
        sides.after.encode(encoder);
    }

    /// Rows and columns of the image.
    pub const fn size(&self) -> [usize; 2] {
        self.size
    }

    /// What the camera sees, in planes, `valid` among them, which is 1 where something is seen. Occlusion has
    /// `position` and `normal` in camera space. Depth of field has `light`, `depth` and `blurriness`; its
    /// light is exposed, so that 99 % of what is not black is at most 1, and a sky is a surface far away.
    pub const fn gbuffer(&self) -> &GpuGBuffer {
        &self.gbuffer
    }

    /// The effect's image. Of occlusion openness, a plane: 1 where nothing occludes. Of depth of field
    /// exposed light, three planes.
    pub const fn image(&self) -> &Buffer {
        &self.image
    }
}

/// The view of a frame as methods see it, of which they want to know the angle of view and the lens alone.
fn view([height, width]: [usize; 2], focal_length: f32, reach: Reach) -> View {
    let Reach { radius, lens } = reach;
    let vertical_fov = 2.0 * (0.5 * height as f32 / focal_length).atan();
    let ahead = [0.0, 0.0, -1.0].into();
    let camera = Camera { vertical_fov, lens, ..Camera::look_at(Default::default(), ahead) };
    View { height, width, camera, radius, seed: SEED }
}

/// Light is 1 to networks as it is: what they read of it is exposed before.
fn scale(network: &DeviceNetwork, focal_length: f32, reach: Reach) -> FrameScale {
    let radius = reach.radius;
    FrameScale { focal_length, radius, scaling: network.spec.scaling_of_lengths(radius) }
}
