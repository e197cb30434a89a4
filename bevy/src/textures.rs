//! What runs on both sides of a network: passes between Bevy's textures and deepshade's buffers.

mod draw;
mod light;
mod openness;

use bevy::prelude::{Mat4, Resource, UVec2};
use bytemuck::{Pod, Zeroable};
use deepshade_render::screen::GpuGBuffer;
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{BoundPass, Pass};
use draw::{BoundDraw, Draw};
use light::LightPasses;
use wgpu::{BindingResource, Buffer, CommandEncoder, Device, TextureFormat};

/// Edge of a workgroup, pixels, in shaders that run once a pixel.
const TILE: u32 = 8;

/// What shaders are told of a view.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Seen {
    /// From clip space, with Bevy's reversed depth, to camera space.
    pub view_from_clip: Mat4,
    /// From world to camera space.
    pub view_from_world: Mat4,
    /// Columns and rows of the image.
    pub size: UVec2,
    /// Where the viewport begins in Bevy's textures, pixels.
    pub origin: UVec2,
    /// Radius in pixels of the circle of confusion of what is infinitely far away.
    pub blur_at_infinity: f32,
    /// Depth of the plane in focus.
    pub focus: f32,
    /// Uniforms come in sixteens of bytes.
    pub spare: [f32; 2],
}

/// The passes, compiled when they are first wanted.
#[derive(Default, Resource)]
pub(crate) struct TexturePasses {
    read_prepass: Option<Pass>,
    write_openness: Option<(TextureFormat, Pass)>,
    light: Option<LightPasses>,
    write_light: Option<(TextureFormat, Draw)>,
}

/// What a camera's passes between textures and network are bound to.
pub(crate) struct Inside<'a> {
    /// Bevy's device.
    pub device: &'a Device,
    /// Rows and columns.
    pub size: [usize; 2],
    /// [`Seen`].
    pub seen: &'a Buffer,
    /// What the network and its estimates are shown.
    pub gbuffer: &'a GpuGBuffer,
    /// The effect's image.
    pub image: &'a Buffer,
}

/// What runs before and after the network.
pub(crate) struct Sides {
    /// From textures to the g-buffer.
    pub before: Vec<Step>,
    /// From the image to a texture.
    pub after: Step,
}

/// Something to be recorded.
pub(crate) enum Step {
    /// All of a buffer becomes 0.
    Clear(Buffer),
    /// A pass with so many workgroups.
    Dispatch(BoundPass, [u32; 3]),
    /// A pass over the pixels of a texture.
    Draw(BoundDraw),
}

impl Step {
    /// Records it.
    pub fn encode(&self, encoder: &mut CommandEncoder) {
        match self {
            Self::Clear(buffer) => encoder.clear_buffer(buffer, 0, None),
            Self::Dispatch(pass, workgroups) => pass.dispatch(encoder, *workgroups),
            Self::Draw(draw) => draw.encode(encoder),
        }
    }
}

impl Inside<'_> {
    /// The planes of an attribute.
    fn planes(&self, attribute: Attribute) -> BindingResource<'_> {
        self.gbuffer.buffer(attribute).as_entire_binding()
    }
}
