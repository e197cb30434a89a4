//! Cameras of deepshade's as Bevy has them.

use bevy::camera::{
    Camera3d, CameraProjection, ClearColorConfig, PerspectiveProjection, Projection, SubCameraView,
};
use bevy::color::Color;
use bevy::core_pipeline::tonemapping::{DebandDither, Tonemapping};
use bevy::light::AmbientLight;
use bevy::math::{Mat3, Mat4, Quat, Vec2, Vec3, Vec3A};
use bevy::prelude::{Bundle, Camera, Transform};
use bevy::render::view::Msaa;
use deepshade_render::scene;

/// A camera, in white light from everywhere.
pub fn of(camera: &scene::Camera) -> impl Bundle {
    (
        Camera3d::default(),
        Camera { clear_color: ClearColorConfig::Custom(Color::BLACK), ..Default::default() },
        pinhole(camera),
        Msaa::Off,
        Tonemapping::None,
        DebandDither::Disabled,
        AmbientLight { color: Color::WHITE, brightness: 1000.0, affects_lightmapped_meshes: true },
    )
}

/// Where it is and what it sees.
pub fn pinhole(camera: &scene::Camera) -> (Transform, Projection) {
    (place(camera), Projection::Perspective(projection(camera)))
}

/// Its projection, whose aspect ratio Bevy finds.
fn projection(camera: &scene::Camera) -> PerspectiveProjection {
    PerspectiveProjection { fov: camera.vertical_fov, near: 0.01, ..Default::default() }
}

/// Where it stands and looks.
fn place(camera: &scene::Camera) -> Transform {
    let rotation = Mat3::from_cols_array(&camera.rotation.to_cols_array());
    Transform {
        translation: Vec3::from_array(camera.position.to_array()),
        rotation: Quat::from_mat3(&rotation),
        ..Default::default()
    }
}

/// The camera from a point of its lens, in the world's unit from the middle, to the right and up: a pinhole
/// there that shows the plane in focus, `focus` away, where the lens does.
pub fn on_lens(camera: &scene::Camera, focus: f32, [x, y]: [f32; 2]) -> (Transform, Projection) {
    let mut place = place(camera);
    place.translation += place.rotation * Vec3::new(x, y, 0.0);
    let slope = -Vec2::new(x, y) / focus;
    (place, Projection::custom(Sheared { straight: projection(camera), slope }))
}

/// A perspective projection in a direction that does not stand on the image.
#[derive(Clone, Debug)]
struct Sheared {
    straight: PerspectiveProjection,
    /// How far points are moved in the image, as x and y over depth.
    slope: Vec2,
}

impl CameraProjection for Sheared {
    fn get_clip_from_view(&self) -> Mat4 {
        let mut clip_from_view = self.straight.get_clip_from_view();
        clip_from_view.z_axis.x += clip_from_view.x_axis.x * self.slope.x;
        clip_from_view.z_axis.y += clip_from_view.y_axis.y * self.slope.y;
        clip_from_view
    }

    fn get_clip_from_view_for_sub(&self, sub_view: &SubCameraView) -> Mat4 {
        self.straight.get_clip_from_view_for_sub(sub_view)
    }

    fn update(&mut self, width: f32, height: f32) {
        self.straight.update(width, height);
    }

    fn far(&self) -> f32 {
        self.straight.far()
    }

    fn get_frustum_corners(&self, z_near: f32, z_far: f32) -> [Vec3A; 8] {
        self.straight.get_frustum_corners(z_near, z_far)
    }
}
