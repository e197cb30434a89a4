//! How hands move the camera: around what it looks at, on the spot, and through the scene.

use deepshade_render::scene::Camera;
use glam::{Mat3, Vec2, Vec3};

/// A camera in somebody's hands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraController {
    /// The camera.
    pub camera: Camera,
    /// Distance of what it goes around, straight ahead, metres.
    distance: f32,
}

/// How near to straight up and down the camera looks at most, sine of the angle from the horizon.
const STEEPEST: f32 = 0.995;
/// Nearest that wheels bring the camera to what it goes around, metres.
const NEAREST: f32 = 1e-3;

impl CameraController {
    /// A camera that goes around what is so far ahead.
    pub const fn new(camera: Camera, distance: f32) -> Self {
        Self { camera, distance }
    }

    /// What the camera goes around.
    pub fn pivot(&self) -> Vec3 {
        self.camera.position - self.camera.rotation.z_axis * self.distance
    }

    /// Goes around the pivot: to the right and up by angles, radians.
    pub fn orbit(&mut self, angles: Vec2) {
        let pivot = self.pivot();
        self.turn(angles * Vec2::new(1.0, -1.0));
        self.camera.position = pivot + self.camera.rotation.z_axis * self.distance;
    }

    /// Looks to the right and up by angles, radians, from where it stands.
    pub fn look(&mut self, angles: Vec2) {
        self.turn(angles * Vec2::new(-1.0, 1.0));
    }

    /// Turns about the world's upward axis, and then up, as far as the camera does not tip over.
    fn turn(&mut self, Vec2 { x: yaw, y: pitch }: Vec2) {
        let turned = Mat3::from_rotation_y(yaw) * self.camera.rotation;
        let raised = Mat3::from_axis_angle(turned.x_axis, pitch) * turned;
        let steep = |rotation: Mat3| rotation.z_axis.y.abs();
        let tips = steep(raised) > STEEPEST && steep(raised) >= steep(turned);
        self.camera.rotation = orthonormal(if tips || raised.y_axis.y < 0.0 { turned } else { raised });
    }

    /// Moves to the right, up and back, metres, and what it goes around with it.
    pub fn fly(&mut self, way: Vec3) {
        self.camera.position += self.camera.rotation * way;
    }

    /// Moves by a share of the distance to what it goes around, as one drags that by so many heights of the
    /// image.
    pub fn pan(&mut self, drag: Vec2) {
        let height = 2.0 * (0.5 * self.camera.vertical_fov).tan() * self.distance;
        self.fly(Vec3::new(-drag.x, drag.y, 0.0) * height);
    }

    /// Comes nearer to what it goes around: the distance is multiplied by `factor`.
    pub fn approach(&mut self, factor: f32) {
        let pivot = self.pivot();
        self.distance = (self.distance * factor).max(NEAREST);
        self.camera.position = pivot + self.camera.rotation.z_axis * self.distance;
    }
}

/// A rotation without what many small turns have added to it.
fn orthonormal(rotation: Mat3) -> Mat3 {
    let back = rotation.z_axis.normalize();
    let right = rotation.y_axis.cross(back).normalize();
    Mat3::from_cols(right, back.cross(right), back)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controller() -> CameraController {
        CameraController::new(Camera::look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::new(0.0, 1.0, 0.0)), 3.0)
    }

    #[test]
    fn going_around_keeps_the_pivot_and_the_distance() {
        let mut controller = controller();
        let pivot = controller.pivot();
        for step in 0..1000 {
            controller.orbit(Vec2::new(0.1, if step % 3 == 0 { 0.4 } else { -0.1 }));
            assert!(controller.pivot().distance(pivot) < 1e-3, "step {step}: {}", controller.pivot());
            assert!(controller.camera.rotation.y_axis.y > 0.0, "step {step}: it tipped over");
        }
        let Mat3 { x_axis, y_axis, z_axis } = controller.camera.rotation;
        assert!(x_axis.dot(y_axis).abs() < 1e-5 && y_axis.dot(z_axis).abs() < 1e-5);
        assert!((controller.camera.rotation.determinant() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn hands_and_image_go_the_same_way() {
        let ahead = controller().pivot();
        let seen = |controller: CameraController, point: Vec3| {
            let camera = controller.camera;
            camera.project(camera.to_camera(point), 100, 100).expect("before the camera")
        };
        let mut dragged = controller();
        dragged.pan(Vec2::new(0.1, 0.2));
        let moved = seen(dragged, ahead) - seen(controller(), ahead);
        assert!((moved - Vec2::new(10.0, 20.0)).length() < 0.01, "{moved}");
        let mut right = controller();
        right.look(Vec2::new(0.1, 0.0));
        assert!(seen(right, ahead).x < seen(controller(), ahead).x, "what was ahead is to the left");
        let mut up = controller();
        up.orbit(Vec2::new(0.0, 0.2));
        assert!(up.camera.position.y > controller().camera.position.y, "seen from higher up");
        let mut near = controller();
        near.approach(0.5);
        assert!((near.camera.position.distance(ahead) - 1.5).abs() < 1e-4);
        assert!(near.pivot().distance(ahead) < 1e-4);
    }
}
