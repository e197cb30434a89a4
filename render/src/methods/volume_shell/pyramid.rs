//! The blur of a level by a Gaussian pyramid (Burt and Adelson 1983, "The Laplacian Pyramid as a Compact
//! Image Code"): on level l of the framebuffer l halvings, and as many steps back.

use crate::screen::{Device, MethodStep};
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::{Shader, TILE, uniforms};
use glam::Vec4;

/// An image of four channels.
#[derive(Clone, Debug)]
pub struct Image {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Row by row.
    pub texels: Vec<Vec4>,
}

impl Image {
    fn at(&self, x: i32, y: i32) -> Vec4 {
        let [width, height] = self.size;
        let (x, y) = (x.clamp(0, width as i32 - 1), y.clamp(0, height as i32 - 1));
        self.texels[y as usize * width + x as usize]
    }

    fn of(size: [usize; 2], texel: impl Fn(i32, i32) -> Vec4) -> Self {
        let [width, height] = size;
        let texels = (0..width * height).map(|i| texel((i % width) as i32, (i / width) as i32)).collect();
        Self { size, texels }
    }

    /// Half as wide and high: `reduce.wgsl`.
    fn reduced(&self) -> Self {
        let row = |x: i32, y: i32| {
            (self.at(x - 1, y) + self.at(x + 2, y)) + 3.0 * (self.at(x, y) + self.at(x + 1, y))
        };
        Self::of(halved(self.size), |x, y| {
            let (x, y) = (2 * x, 2 * y);
            ((row(x, y - 1) + row(x, y + 2)) + 3.0 * (row(x, y) + row(x, y + 1))) / 64.0
        })
    }

    /// In the size of a finer level: `expand.wgsl`.
    fn expanded(&self, size: [usize; 2]) -> Self {
        Self::of(size, |x, y| {
            let (near_x, near_y) = (x / 2, y / 2);
            let (far_x, far_y) = (near_x + 2 * (x % 2) - 1, near_y + 2 * (y % 2) - 1);
            let rows = 3.0 * self.at(near_x, near_y) + self.at(far_x, near_y);
            let others = 3.0 * self.at(near_x, far_y) + self.at(far_x, far_y);
            (3.0 * rows + others) / 16.0
        })
    }

    /// Blurred by so many halvings.
    #[must_use]
    pub fn smooth(&self, halvings: u32) -> Self {
        match halvings {
            0 => self.clone(),
            _ => self.reduced().smooth(halvings - 1).expanded(self.size),
        }
    }
}

fn halved([width, height]: [usize; 2]) -> [usize; 2] {
    [width.div_ceil(2), height.div_ceil(2)]
}

/// The levels' sizes of an image of a size, and so many halvings, the image first.
fn sizes(size: [usize; 2], halvings: usize) -> Vec<[usize; 2]> {
    std::iter::successors(Some(size), |size| Some(halved(*size))).take(halvings + 1).collect()
}

/// Room for the levels of an image, `[height, width, 4]` f32 each, and for what comes back.
#[derive(Clone, Debug)]
pub struct PyramidBuffers {
    size: [usize; 2],
    levels: Vec<wgpu::Buffer>,
    /// The image once it is smooth.
    pub smooth: wgpu::Buffer,
}

impl PyramidBuffers {
    /// Of an image of columns and rows and so many halvings at most.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(device: &wgpu::Device, size: [usize; 2], halvings: usize) -> Result<Self, GpuError> {
        let buffer = |[width, height]: [usize; 2]| {
            gpu::empty::<[f32; 4]>(device, "volume-shell.pyramid", width * height)
        };
        let levels = sizes(size, halvings).into_iter().skip(1).map(buffer).collect::<Result<_, _>>()?;
        Ok(Self { size, levels, smooth: buffer(size)? })
    }
}

/// The passes that blur an image by so many halvings, at least one, into the room's `smooth`.
///
/// # Errors
/// If the device refuses a pass or a binding.
pub fn steps(
    device: &Device,
    image: &wgpu::Buffer,
    room: &PyramidBuffers,
    halvings: usize,
) -> Result<Vec<MethodStep>, GpuError> {
    let sizes = sizes(room.size, halvings);
    let uniforms = sizes.windows(2).map(|two| {
        let [[fine_width, fine_height], [coarse_width, coarse_height]] =
            [two[0], two[1]].map(|size| size.map(|length| length as u32));
        let sizes = uniforms::Pyramid { fine_width, fine_height, coarse_width, coarse_height };
        gpu::uniform(device, "volume-shell.sizes", &sizes)
    });
    let uniforms = uniforms.collect::<Result<Vec<_>, _>>()?;
    let over = |[width, height]: [usize; 2]| gpu::groups(height, width, TILE);
    let reduce = device.pass(Shader::at("methods/volume-shell/reduce"), &[])?;
    let expand = device.pass(Shader::at("methods/volume-shell/expand"), &[])?;
    let mut steps = Vec::new();
    for (level, uniform) in uniforms.iter().enumerate() {
        let from = if level == 0 { image } else { &room.levels[level - 1] };
        let groups = over(sizes[level + 1]);
        let reads = [uniform, from];
        steps.push(MethodStep::bind(device, &reduce, groups, &reads, &[&room.levels[level]])?);
    }
    for (level, uniform) in uniforms.iter().enumerate().rev() {
        let to = if level == 0 { &room.smooth } else { &room.levels[level - 1] };
        let groups = over(sizes[level]);
        let reads = [uniform, &room.levels[level]];
        steps.push(MethodStep::bind(device, &expand, groups, &reads, &[to])?);
    }
    Ok(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_even_stays_and_a_dot_becomes_round_and_keeps_its_sum() {
        let even = Image::of([37, 21], |_, _| Vec4::new(1.0, 2.0, 3.0, 0.5));
        for halvings in 0..5 {
            let off = |texel: &Vec4| (*texel - even.texels[0]).abs().max_element();
            assert!(even.smooth(halvings).texels.iter().map(off).fold(0.0, f32::max) < 1e-5);
        }
        let dot = Image::of([64, 64], |x, y| if (x, y) == (31, 32) { Vec4::ONE } else { Vec4::ZERO });
        for halvings in 1..4 {
            let smooth = dot.smooth(halvings);
            let sum: Vec4 = smooth.texels.iter().sum();
            assert!((sum - Vec4::ONE).abs().max_element() < 1e-4, "{halvings}: {sum}");
            // Both kernels have a variance of 3/4 of their texels.
            let variance: f32 =
                (0..64 * 64).map(|i| ((i % 64) as f32 - 31.0).powi(2) * smooth.texels[i as usize].x).sum();
            let right = 0.5 * ((1 << (2 * halvings)) - 1) as f32;
            assert!((variance / right - 1.0).abs() < 0.05, "{halvings}: {variance}, not {right}");
        }
    }
}
