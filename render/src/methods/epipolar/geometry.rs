//! Rectified coordinates (Baran et al. 2010, sections 3 and 9): the half-plane through the line from the eye
//! to the light, `alpha`; the view ray in it, `beta`; the light ray in it, `gamma`.
//!
//! Points of a half-plane are `(along, aside)`: metres from the eye towards the light, and away from that
//! line. `gamma` is the distance of a parallel light ray from the eye, or the angle of another one to the
//! line from the light to the eye. In place of the angle `beta` goes `1 - along / (|along| + aside)`, from 0
//! at the light to 2 opposite to it, which grows with the angle almost evenly and costs one division
//! ([`beta`]).

use super::super::shafts::{LampPosition, ViewRays};
use glam::{DVec2, Vec3};

/// An eye and a light.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    /// World space.
    pub eye: Vec3,
    /// Unit direction from the eye to the light, world space.
    pub axis: Vec3,
    /// How far away the light is, metres; infinite for a distant one.
    pub reach: f32,
}

/// A unit direction from the eye, in its half-plane.
#[derive(Clone, Copy, Debug)]
pub struct ViewDirection {
    /// Cosine of the angle to the light.
    pub along: f32,
    /// Its sine.
    pub aside: f32,
}

/// Lights that are nearer to the eye, metres, are at the eye.
const AT_THE_EYE: f32 = 1e-4;
/// Least share of a direction towards the light that is along the view: epipoles are no farther away.
const LEAST_FORWARD: f64 = 1e-7;

impl Geometry {
    /// Of a light as it is seen from an eye; `None` if it is there.
    pub fn new(eye: Vec3, lamp: LampPosition) -> Option<Self> {
        match lamp {
            LampPosition::Distant(axis) => Some(Self { eye, axis, reach: f32::INFINITY }),
            LampPosition::Local(position) => {
                let reach = position.distance(eye);
                (reach > AT_THE_EYE).then(|| Self { eye, axis: (position - eye) / reach, reach })
            }
        }
    }

    /// Whether light rays are parallel.
    pub const fn is_parallel(&self) -> bool {
        self.reach == f32::INFINITY
    }

    /// A unit direction from the eye.
    #[inline]
    pub fn direction(&self, direction: Vec3) -> ViewDirection {
        let along = direction.dot(self.axis);
        ViewDirection { along, aside: (direction - self.axis * along).length() }
    }

    /// `gamma` of the point so many metres along a view ray.
    #[inline]
    pub fn gamma(&self, view: ViewDirection, distance: f32) -> f32 {
        if self.is_parallel() {
            distance * view.aside
        } else if distance == f32::INFINITY {
            view.aside.atan2(-view.along)
        } else {
            (distance * view.aside).atan2(self.reach - distance * view.along)
        }
    }

    /// The unit vector away from the axis in the half-plane of a direction; any where that is along the axis.
    pub fn outwards(&self, direction: Vec3) -> Vec3 {
        let aside = direction - self.axis * direction.dot(self.axis);
        aside.normalize_or(self.axis.any_orthonormal_vector())
    }

    /// Where the light is in the image, or opposite to it if it is behind the eye: the point through which
    /// all half-planes go, pixels from the top left corner.
    pub fn epipole(&self, rays: &ViewRays) -> DVec2 {
        let axis = rays.direction_to_camera(self.axis).as_dvec3();
        let forward = (-axis.z).abs().max(LEAST_FORWARD).copysign(-axis.z);
        let middle = 0.5 * DVec2::new(rays.width() as f64, rays.height() as f64);
        middle + DVec2::new(axis.x, -axis.y) * (f64::from(rays.focal_length()) / forward)
    }
}

/// What stands for the angle between the direction to the light and that to a point: from 0 to 2.
#[inline(always)]
pub fn beta(along: f32, aside: f32) -> f32 {
    1.0 - along / (along.abs() + aside)
}

/// Cosine and sine of the angle that a value of [`beta`] stands for.
pub fn angle(beta: f64) -> [f64; 2] {
    let (along, aside) = (1.0 - beta, 1.0 - (1.0 - beta).abs());
    let length = along.hypot(aside);
    [along / length, aside / length]
}
