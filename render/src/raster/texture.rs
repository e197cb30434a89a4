//! A scene's textures on the GPU, as their files hold them: reads decode sRGB.

use crate::scene::{Encoding, Filter, Texture, Wrap};
use deepshade_shaders::gpu::{self, Gpu, GpuError};
use std::collections::BTreeMap;
use std::sync::Arc;

/// All textures of a scene, and a white one.
#[derive(Debug)]
pub struct Textures {
    views: Vec<wgpu::TextureView>,
    samplers: BTreeMap<[u8; 3], wgpu::Sampler>,
    /// How each texture is read, by the key of its sampler.
    keys: Vec<[u8; 3]>,
    white: wgpu::TextureView,
    /// Textures that the device cannot hold in their size and that were halved, with the size they have now.
    pub reduced: Vec<[usize; 2]>,
}

impl Textures {
    /// Sends all textures. Those beyond the device's size are halved until they fit.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(gpu: &Gpu, textures: &[Arc<Texture>]) -> Result<Self, GpuError> {
        let most = gpu.device.limits().max_texture_dimension_2d as usize;
        let (mut views, mut reduced) = (Vec::new(), Vec::new());
        for texture in textures {
            let fitting = fitting(texture, most);
            if fitting.size() != texture.size() {
                reduced.push(fitting.size());
            }
            views.push(send(gpu, &fitting)?);
        }
        let white = Texture::new(1, 1, vec![[255; 4]], Encoding::Linear, [Wrap::Repeat; 2]);
        let readings = || textures.iter().map(Arc::as_ref).chain([&white]);
        let samplers = readings().map(|texture| (key(texture), sampler(&gpu.device, texture))).collect();
        let keys = readings().map(key).collect();
        Ok(Self { views, samplers, keys, white: send(gpu, &white)?, reduced })
    }

    /// A texture with how it is read; white where there is none.
    pub fn get(&self, texture: Option<usize>) -> (&wgpu::TextureView, &wgpu::Sampler) {
        // The white one's key is the last.
        let view = texture.map_or(&self.white, |index| &self.views[index]);
        (view, &self.samplers[&self.keys[texture.unwrap_or(self.views.len())]])
    }
}

/// Orders ways to read textures.
fn key(texture: &Texture) -> [u8; 3] {
    let [u, v] = texture.wrap().map(|wrap| wrap as u8);
    [u, v, texture.filter() as u8]
}

fn sampler(device: &wgpu::Device, texture: &Texture) -> wgpu::Sampler {
    let mode = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let filter = match texture.filter() {
        Filter::Linear => wgpu::FilterMode::Linear,
        Filter::Nearest => wgpu::FilterMode::Nearest,
    };
    let [u, v] = texture.wrap();
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("deepshade.texture"),
        address_mode_u: mode(u),
        address_mode_v: mode(v),
        mag_filter: filter,
        min_filter: filter,
        ..Default::default()
    })
}

/// A texture, halved until no edge is longer than `most`.
fn fitting(texture: &Arc<Texture>, most: usize) -> Arc<Texture> {
    let mut fitting = Arc::clone(texture);
    while fitting.size().into_iter().max().is_some_and(|edge| edge > most) {
        fitting = fitting.halved().into();
    }
    fitting
}

fn send(gpu: &Gpu, texture: &Texture) -> Result<wgpu::TextureView, GpuError> {
    let format = match texture.encoding() {
        Encoding::Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
        Encoding::Linear => wgpu::TextureFormat::Rgba8Unorm,
    };
    let [width, height] = texture.size();
    let texels = bytemuck::cast_slice(texture.texels());
    let texture = gpu::sent_texture(&gpu.device, &gpu.queue, "texture", format, [height, width], texels)?;
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_large_is_halved_until_it_fits() {
        let texels = (0..5).map(|x| [x * 10; 4]).collect();
        let texture = Arc::new(Texture::new(5, 1, texels, Encoding::Linear, [Wrap::Clamp; 2]));
        assert_eq!(fitting(&texture, 2).texels(), [[15; 4], [40; 4]]);
        assert!(Arc::ptr_eq(&fitting(&texture, 5), &texture));
    }
}
