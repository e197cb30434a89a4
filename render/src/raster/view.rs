//! From where a raster pass looks, as the GPU reads it.

use crate::scene::Camera;
use deepshade_shaders::wgsl::uniforms::FrameView;
use glam::{Mat3, Vec3};

/// What a camera sees of an image of this size. What is nearer than `near`, metres, is cut off.
pub fn perspective(camera: &Camera, height: usize, width: usize, near: f32) -> FrameView {
    let focal_length = camera.focal_length(height);
    FrameView {
        scale_x: 2.0 * focal_length / width as f32,
        scale_y: 2.0 * focal_length / height as f32,
        near,
        perspective: 1,
        focal_length,
        focus: camera.lens.map_or(0.0, |lens| lens.focus),
        blur: camera.blur_at_infinity(height),
        ..placed(camera.position, camera.rotation, height, width)
    }
}

/// A square map of `size` texels that sees, from `eye` along the third axis' opposite, what is within `half`
/// metres to each side and `far` metres deep.
pub fn parallel(eye: Vec3, axes: Mat3, half: f32, far: f32, size: usize) -> FrameView {
    FrameView { scale_x: 1.0 / half, scale_y: 1.0 / half, far, ..placed(eye, axes, size, size) }
}

/// A square map of `size` texels that sees so far to each side: the tangent of half its angle.
pub fn square(eye: Vec3, axes: Mat3, tangent: f32, near: f32, size: usize) -> FrameView {
    let focal_length = 0.5 * size as f32 / tangent;
    FrameView {
        scale_x: 1.0 / tangent,
        scale_y: 1.0 / tangent,
        near,
        perspective: 1,
        focal_length,
        ..placed(eye, axes, size, size)
    }
}

fn placed(eye: Vec3, axes: Mat3, height: usize, width: usize) -> FrameView {
    FrameView {
        eye: eye.extend(0.0).to_array(),
        right: axes.x_axis.extend(0.0).to_array(),
        up: axes.y_axis.extend(0.0).to_array(),
        back: axes.z_axis.extend(0.0).to_array(),
        height: height as u32,
        width: width as u32,
        ..bytemuck::Zeroable::zeroed()
    }
}
