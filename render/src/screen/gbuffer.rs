//! A g-buffer on the GPU: a storage buffer an attribute.

use crate::method::MethodError;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use thiserror::Error;

/// Attributes of every pixel of a view, each `[attribute.width(), height, width]` f32 in a storage buffer of
/// its own.
#[derive(Clone, Debug)]
pub struct GpuGBuffer {
    height: usize,
    width: usize,
    attributes: Vec<(Attribute, wgpu::Buffer)>,
}

/// Why a g-buffer could not be sent to the GPU.
#[derive(Debug, Error)]
pub enum UploadError {
    /// It lacks an attribute.
    #[error(transparent)]
    Missing(#[from] MissingAttribute),
    /// The GPU has no room.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

impl UploadError {
    /// The error as a method reports it.
    pub fn of_method(self, method: &'static str) -> MethodError {
        match self {
            Self::Missing(source) => MethodError::Missing { method, source },
            Self::Gpu(source) => MethodError::Gpu { method, source },
        }
    }
}

impl GpuGBuffer {
    /// Room for attributes of an image of this size, all zero.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn empty(
        device: &wgpu::Device,
        height: usize,
        width: usize,
        attributes: &[Attribute],
    ) -> Result<Self, GpuError> {
        let room = |attribute: &Attribute| {
            let count = attribute.width() * height * width;
            Ok((*attribute, gpu::empty::<f32>(device, &label(*attribute), count)?))
        };
        let attributes = attributes.iter().map(room).collect::<Result<_, GpuError>>()?;
        Ok(Self { height, width, attributes })
    }

    /// Some attributes of a g-buffer.
    ///
    /// # Errors
    /// If the g-buffer lacks one or the device has no room.
    pub fn upload(
        device: &wgpu::Device,
        gbuffer: &GBuffer,
        attributes: &[Attribute],
    ) -> Result<Self, UploadError> {
        let send = |attribute: &Attribute| {
            let planes = gbuffer.select(&[*attribute])?;
            Ok((*attribute, gpu::storage(device, &label(*attribute), planes.data())?))
        };
        let attributes = attributes.iter().map(send).collect::<Result<_, UploadError>>()?;
        Ok(Self { height: gbuffer.height(), width: gbuffer.width(), attributes })
    }

    /// The same with another buffer for an attribute, held before or not,
    /// `[attribute.width(), height, width]`.
    #[must_use]
    pub fn with(&self, attribute: Attribute, buffer: wgpu::Buffer) -> Self {
        let others = self.attributes.iter().filter(|(other, _)| *other != attribute).cloned();
        Self { attributes: others.chain([(attribute, buffer)]).collect(), ..*self }
    }

    /// Rows.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Columns.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Which attributes it holds.
    pub fn attributes(&self) -> impl Iterator<Item = Attribute> {
        self.attributes.iter().map(|(attribute, _)| *attribute)
    }

    /// The buffer of an attribute.
    ///
    /// # Panics
    /// If it is not held: what a method reads is in
    /// [`ScreenMethod::attributes`](super::ScreenMethod::attributes).
    pub fn buffer(&self, attribute: Attribute) -> &wgpu::Buffer {
        let held = self.attributes.iter().find(|(other, _)| *other == attribute);
        &held.expect("an attribute that the g-buffer was made with").1
    }
}

fn label(attribute: Attribute) -> String {
    format!("gbuffer.{}", attribute.name())
}
