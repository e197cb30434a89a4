//! What maps pixels to directions.

use deepshade_render::scene::Camera;
use glam::{Vec2, Vec3};

/// A pinhole camera without distortion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal length across, pixels.
    pub fx: f32,
    /// Focal length upwards, pixels; positive.
    pub fy: f32,
    /// The principal point, pixels from the top left corner; a pixel's middle is at half-integers.
    pub centre: Vec2,
}

impl Intrinsics {
    /// Those of a rendered image of so many rows and columns.
    pub fn of(camera: &Camera, [height, width]: [usize; 2]) -> Self {
        let focal = camera.focal_length(height);
        Self { fx: focal, fy: focal, centre: 0.5 * Vec2::new(width as f32, height as f32) }
    }

    /// Where in camera space what a pixel sees at a depth along the view's axis is, metres.
    pub fn position(&self, x: usize, y: usize, depth: f32) -> Vec3 {
        let offset = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - self.centre;
        Vec3::new(offset.x / self.fx, -offset.y / self.fy, -1.0) * depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rendered_pixel_is_where_its_ray_goes() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z);
        let intrinsics = Intrinsics::of(&camera, [48, 64]);
        for (x, y) in [(0, 0), (63, 0), (5, 40), (32, 24)] {
            let direction = camera.direction(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), 48, 64);
            let position = intrinsics.position(x, y, 2.0);
            assert!((position.normalize() - direction).length() < 1e-6 && position.z == -2.0, "{x}, {y}");
        }
    }
}
