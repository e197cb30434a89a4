//! Where a capture's camera stood.

use glam::{Mat3, Vec3};

/// A place and an orientation in world space, metres. As everywhere, the camera looks down its -z, with y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where it stood.
    pub position: Vec3,
    /// Columns: the camera's x, y and z axes in world space.
    pub rotation: Mat3,
}

impl Pose {
    /// That of a camera that looks down its +z, from its axes and place in world space. With y down
    /// everything is right-handed, and the world stays as it is. With y up both are left-handed: the world is
    /// mirrored, z for -z.
    pub fn looking_forwards(position: Vec3, rotation: Mat3, y_up: bool) -> Self {
        if y_up {
            let mirror = Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0));
            return Self { position: mirror * position, rotation: mirror * rotation * mirror };
        }
        Self { position, rotation: rotation * Mat3::from_diagonal(Vec3::new(1.0, -1.0, -1.0)) }
    }

    /// A camera-space point in world space.
    pub fn to_world(&self, point: Vec3) -> Vec3 {
        self.position + self.rotation * point
    }

    /// A world-space point in camera space.
    pub fn to_camera(&self, point: Vec3) -> Vec3 {
        self.rotation.transpose() * (point - self.position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_stay_right_handed_and_look_where_they_looked() {
        let turned = Mat3::from_rotation_y(0.4) * Mat3::from_rotation_x(-0.2);
        for y_up in [false, true] {
            let pose = Pose::looking_forwards(Vec3::new(1.0, 2.0, 3.0), turned, y_up);
            assert!((pose.rotation.determinant() - 1.0).abs() < 1e-5);
            let world = if y_up { Vec3::new(1.0, 1.0, -1.0) } else { Vec3::ONE };
            let ahead = world * (turned * Vec3::Z);
            assert!((pose.rotation * Vec3::NEG_Z - ahead).length() < 1e-6);
            // The file's point at (0.1, 0.2, 2) is right, and up or down, of the middle.
            let ours = Vec3::new(0.1, if y_up { 0.2 } else { -0.2 }, -2.0);
            let theirs = world * (Vec3::new(1.0, 2.0, 3.0) + turned * Vec3::new(0.1, 0.2, 2.0));
            assert!((pose.to_world(ours) - theirs).length() < 1e-5);
            assert!((pose.to_camera(pose.to_world(ours)) - ours).length() < 1e-5);
        }
    }
}
