//! A camera: a pinhole, or a thin lens.

use crate::sampler::concentric_disk;
use glam::{Mat3, Vec2, Vec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Vertical field of view of every sampled view, degrees (thesis 7.3.1).
pub const FIELD_OF_VIEW: f32 = 50.0;

/// A thin lens that focuses one plane; of radius 0, a pinhole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Lens {
    /// Radius of the aperture, metres.
    pub radius: f32,
    /// Depth of the plane in focus, metres.
    pub focus: f32,
}

/// A lens that cannot be.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum LensError {
    /// The radius is negative or not finite.
    #[error("a lens cannot have a radius of {0} m")]
    Radius(f32),
    /// The depth of the plane in focus is not positive or not finite.
    #[error("a lens cannot focus at a depth of {0} m")]
    Focus(f32),
}

/// What a file says of a lens.
#[derive(Deserialize)]
struct Unchecked {
    radius: f32,
    focus: f32,
}

impl TryFrom<Unchecked> for Lens {
    type Error = LensError;

    fn try_from(Unchecked { radius, focus }: Unchecked) -> Result<Self, LensError> {
        Self::new(radius, focus)
    }
}

impl Lens {
    /// A lens with an aperture of some radius, 0 or more, that focuses a plane at some depth, both in metres.
    ///
    /// # Errors
    /// If the radius is negative, the depth is not positive, or one of them is not finite.
    pub fn new(radius: f32, focus: f32) -> Result<Self, LensError> {
        if !(radius.is_finite() && radius >= 0.0) {
            return Err(LensError::Radius(radius));
        }
        if !(focus.is_finite() && focus > 0.0) {
            return Err(LensError::Focus(focus));
        }
        Ok(Self { radius, focus })
    }
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
    /// A camera at `position` that looks at `target` with [`FIELD_OF_VIEW`]; `y` is up unless the view is
    /// along it.
    pub fn look_at(position: Vec3, target: Vec3) -> Self {
        let backward = (position - target).normalize();
        let up = if backward.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
        let right = up.cross(backward).normalize();
        let rotation = Mat3::from_cols(right, backward.cross(right), backward);
        Self { position, rotation, vertical_fov: FIELD_OF_VIEW.to_radians(), lens: None }
    }

    /// The unit direction, in world space, through a point of the image given in pixels from the top left
    /// corner (a pixel's middle is at half-integers).
    pub fn direction(&self, pixel: Vec2, height: usize, width: usize) -> Vec3 {
        let scale = 2.0 * (0.5 * self.vertical_fov).tan() / height as f32;
        let x = (pixel.x - 0.5 * width as f32) * scale;
        let y = (0.5 * height as f32 - pixel.y) * scale;
        (self.rotation * Vec3::new(x, y, -1.0)).normalize()
    }

    /// Origin and unit direction, in world space, of the ray through a point of the image and a point of the
    /// lens. Points of the unit square are spread evenly over the aperture; every one of them sees the plane
    /// in focus alike, so that it stays sharp. Without a lens, that of [`Camera::direction`].
    pub fn ray(&self, at: Vec2, height: usize, width: usize, on_lens: Vec2) -> (Vec3, Vec3) {
        let direction = self.direction(at, height, width);
        let Some(lens) = self.lens.filter(|lens| lens.radius > 0.0) else {
            return (self.position, direction);
        };
        let offset = concentric_disk(on_lens.x, on_lens.y) * lens.radius;
        let aside = self.rotation * offset.extend(0.0);
        let along = -self.direction_to_camera(direction).z;
        (self.position + aside, (direction * (lens.focus / along) - aside).normalize())
    }

    /// Radius in pixels of the circle of confusion of what is infinitely far away: `B`, the parameter of a
    /// lens that blurs an image (thesis 7.3.1). 0 without a lens.
    pub fn blur_at_infinity(&self, height: usize) -> f32 {
        self.lens.map_or(0.0, |lens| self.focal_length(height) * lens.radius / lens.focus)
    }

    /// Signed distance of a depth to the plane in focus, metres, positive beyond it: `Dfocal`. 0 without a
    /// lens, which has everything in focus.
    pub fn focal_distance(&self, depth: f32) -> f32 {
        self.lens.map_or(0.0, |lens| depth - lens.focus)
    }

    /// Radius in pixels of the disc that a point at a depth becomes: the circle of confusion of a thin lens,
    /// `A f |d - df| / (d (df - f))` (Potmesil and Chakravarty 1981), in terms of the image of a pinhole of
    /// the same angle of view, whose focal length takes in the lens' magnification: `B |Dfocal| / d`.
    pub fn circle_of_confusion(&self, depth: f32, height: usize) -> f32 {
        self.blur_at_infinity(height) * self.focal_distance(depth).abs() / depth
    }

    /// Where a camera-space point is in the image of the pinhole, in pixels from the top left corner; `None`
    /// for points that are not in front of the camera.
    pub fn project(&self, point: Vec3, height: usize, width: usize) -> Option<Vec2> {
        let depth = -point.z;
        let middle = 0.5 * Vec2::new(width as f32, height as f32);
        let scale = self.focal_length(height) / depth;
        (depth > 0.0 && scale.is_finite()).then(|| middle + Vec2::new(point.x, -point.y) * scale)
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
mod tests;
