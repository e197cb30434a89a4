//! A camera: a pinhole, or a thin lens.

use glam::{Mat3, Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Vertical field of view of every sampled view, degrees (thesis 7.3.1).
pub const FIELD_OF_VIEW: f32 = 50.0;

/// A lens that focuses one plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    /// Radius of the aperture, metres.
    pub radius: f32,
    /// Depth of the plane in focus, metres.
    pub focus: f32,
}

/// A camera; looks down its -z, x to the right, y up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Where it stands, world space, metres.
    pub position: Vec3,
    /// Columns: the camera's x, y and z axes in world space.
    pub rotation: Mat3,
    /// Full vertical angle of view, radians.
    pub vertical_fov: f32,
    /// Its lens; `None` for a pinhole, which is what every g-buffer is seen through.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lens: Option<Lens>,
}

impl Camera {
    /// A camera at `position` that looks at `target` with [`FIELD_OF_VIEW`]; `y` is up unless the view is along it.
    pub fn look_at(position: Vec3, target: Vec3) -> Self {
        let backward = (position - target).normalize();
        let up = if backward.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
        let right = up.cross(backward).normalize();
        let rotation = Mat3::from_cols(right, backward.cross(right), backward);
        Self { position, rotation, vertical_fov: FIELD_OF_VIEW.to_radians(), lens: None }
    }

    /// The unit direction, in world space, through a point of the image given in pixels from the top left corner
    /// (a pixel's middle is at half-integers).
    pub fn direction(&self, pixel: Vec2, height: usize, width: usize) -> Vec3 {
        let scale = 2.0 * (0.5 * self.vertical_fov).tan() / height as f32;
        let x = (pixel.x - 0.5 * width as f32) * scale;
        let y = (0.5 * height as f32 - pixel.y) * scale;
        (self.rotation * Vec3::new(x, y, -1.0)).normalize()
    }

    /// A world-space point in camera space.
    pub fn to_camera(&self, point: Vec3) -> Vec3 {
        self.rotation.transpose() * (point - self.position)
    }

    /// A world-space direction in camera space.
    pub fn direction_to_camera(&self, direction: Vec3) -> Vec3 {
        self.rotation.transpose() * direction
    }

    /// Distance in pixels, at depth 1, of two points one unit apart: the focal length.
    pub fn focal_length(&self, height: usize) -> f32 {
        0.5 * height as f32 / (0.5 * self.vertical_fov).tan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_looks_down_minus_z_with_y_up() {
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO);
        let middle = camera.direction(Vec2::new(50.0, 25.0), 50, 100);
        assert!((middle - Vec3::NEG_Z).length() < 1e-6);
        let top_right = camera.direction(Vec2::new(100.0, 0.0), 50, 100);
        assert!(top_right.x > 0.0 && top_right.y > 0.0);
        let point = camera.to_camera(Vec3::new(1.0, 2.0, 3.0));
        assert!((point - Vec3::new(1.0, 2.0, -2.0)).length() < 1e-6);
    }

    #[test]
    fn top_of_the_image_is_half_the_field_of_view_away() {
        let camera = Camera::look_at(Vec3::new(3.0, 1.0, 2.0), Vec3::new(-1.0, 0.5, 0.0));
        let middle = camera.direction(Vec2::new(32.0, 32.0), 64, 64);
        let top = camera.direction(Vec2::new(32.0, 0.0), 64, 64);
        assert!((middle.angle_between(top) - 25f32.to_radians()).abs() < 1e-5);
    }
}
