//! The camera that brings world space to camera space: a scene's, a matrix in a file, or one that the
//! g-buffer brings.

use anyhow::{Context, Result, bail, ensure};
use deepshade_render::scene::{Camera, SceneSource};
use glam::{Mat3, Mat4, Vec3};
use std::path::{Path, PathBuf};

/// A scene file, maybe with a camera's name behind a colon, or a text file with a matrix.
#[derive(Clone, Debug)]
pub struct CameraSource {
    path: PathBuf,
    name: Option<String>,
}

/// World space seen from a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Rows: the camera's axes, which are x to the right, y up and z backwards.
    pub rotation: Mat3,
    /// Where it stands.
    pub eye: Vec3,
}

/// A pose that may be meant, and what it takes the world for.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// In words.
    pub name: String,
    /// World to camera.
    pub pose: Pose,
    /// Whether it is in the unit of the positions as the file has them, and not in metres.
    pub in_file_units: bool,
}

impl std::str::FromStr for CameraSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole = Self { path: text.into(), name: None };
        Ok(match text.rsplit_once(':') {
            Some((path, name)) if !whole.path.is_file() && Path::new(path).is_file() => {
                Self { path: path.into(), name: Some(name.to_owned()) }
            }
            _ => whole,
        })
    }
}

impl Pose {
    fn of(camera: &Camera) -> Self {
        Self { rotation: camera.rotation.transpose(), eye: camera.position }
    }

    /// Of a matrix that brings camera space to world space. Its axes may be of any length.
    fn from_world(matrix: Mat4) -> Option<Self> {
        let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate().try_normalize());
        let [Some(x), Some(y), Some(z)] = axes else { return None };
        let eye = matrix.w_axis.truncate();
        let rotation = Mat3::from_cols(x, y, z);
        (eye.is_finite() && rotation.determinant().abs() > 0.99)
            .then(|| Self { rotation: rotation.transpose(), eye })
    }

    /// The same camera in a world whose z is up, as seen by one that says where it is with y up.
    fn of_world_with_z_up(self) -> Self {
        // Columns: what the axes of a world with z up are with y up.
        let y_up = Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y);
        Self { rotation: self.rotation * y_up, eye: y_up.transpose() * self.eye }
    }

    /// The same place, for a camera that looks down its z and has been taken for one that looks down -z.
    fn turned_forward(self) -> Self {
        Self { rotation: Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0)) * self.rotation, ..self }
    }

    /// A point of the world in camera space.
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.rotation * (point - self.eye)
    }

    /// A direction of the world in camera space.
    pub fn direction(&self, direction: Vec3) -> Vec3 {
        self.rotation * direction
    }
}

/// The poses that a scene's camera or a file's matrix may mean.
///
/// # Errors
/// If the file cannot be read, holds no camera, or several of which none is named.
pub fn of_source(source: &CameraSource) -> Result<Vec<Candidate>> {
    let file = source.path.display().to_string();
    if let Ok(scene) = file.parse::<SceneSource>() {
        let pose = Pose::of(&chosen(&scene.scene(0.0)?.cameras, source)?);
        let candidate = |up: &str, pose| Candidate {
            name: format!("the camera of {file} in a world whose {up} is up"),
            pose,
            in_file_units: false,
        };
        return Ok(vec![candidate("y", pose), candidate("z", pose.of_world_with_z_up())]);
    }
    let text = std::fs::read_to_string(&source.path).with_context(|| file.clone())?;
    let name = format!("the matrix in {file}");
    let pose = matrix(&text).and_then(Pose::from_world);
    let pose = pose.with_context(|| {
        format!(
            "{file}: no scene file, and no 16 numbers of a matrix that brings camera space to world space"
        )
    })?;
    Ok(vec![Candidate { name, pose, in_file_units: true }])
}

/// The poses that a file's attribute `worldToCamera` may mean. OpenEXR has it bring the world to a camera
/// that looks down +z, and multiply row vectors; some renderers look down -z, or write it column by column.
pub fn of_attribute(attribute: [f32; 16]) -> Vec<Candidate> {
    let given = Mat4::from_cols_array(&attribute);
    let poses =
        [given, given.transpose()].into_iter().filter_map(|matrix| Pose::from_world(matrix.inverse()));
    let both = poses.flat_map(|pose| [pose.turned_forward(), pose]);
    both.map(|pose| Candidate { name: "its attribute `worldToCamera`".to_owned(), pose, in_file_units: true })
        .collect()
}

fn chosen(cameras: &[(String, Camera)], source: &CameraSource) -> Result<Camera> {
    let file = source.path.display();
    let names: Vec<&str> = cameras.iter().map(|(name, _)| name.as_str()).collect();
    ensure!(!cameras.is_empty(), "{file}: the scene brings no camera");
    match &source.name {
        None if cameras.len() == 1 => Ok(cameras[0].1),
        None => {
            bail!("{file}: the scene brings several cameras; name one of {} as {file}:NAME", names.join(", "))
        }
        Some(name) => {
            let found = cameras.iter().find(|(other, _)| other == name).map(|(_, camera)| *camera);
            found
                .with_context(|| format!("{file}: no camera `{name}`; the scene brings {}", names.join(", ")))
        }
    }
}

/// The matrix that sixteen numbers make, row by row, with whatever brackets and commas between them; or
/// column by column, where the last row is none of a movement.
fn matrix(text: &str) -> Option<Mat4> {
    let is_between = |c: char| c.is_whitespace() || "[](){},;".contains(c);
    let words = text.split(is_between).filter(|word| !word.is_empty());
    let numbers: Vec<f32> = words.map(str::parse).collect::<Result<_, _>>().ok()?;
    let columns = Mat4::from_cols_array(&numbers.try_into().ok()?);
    let is_movement = |matrix: &Mat4| matrix.row(3) == glam::Vec4::W;
    [columns.transpose(), columns].into_iter().find(is_movement)
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: Vec3 = Vec3::new(3.0, 2.0, 5.0);

    fn camera() -> Camera {
        Camera::look_at(EYE, Vec3::new(0.5, 1.0, -1.0))
    }

    fn is_near(a: Vec3, b: Vec3) -> bool {
        (a - b).length() < 1e-4
    }

    #[test]
    fn a_matrix_is_read_row_by_row_and_may_have_axes_of_any_length() {
        let camera = camera();
        let Camera { rotation, position, .. } = camera;
        let to_world =
            Mat4::from_translation(position) * Mat4::from_mat3(rotation) * Mat4::from_scale(Vec3::splat(2.0));
        let rows: Vec<String> = (0..4).map(|row| format!("{:?}", to_world.row(row).to_array())).collect();
        let point = Vec3::new(-1.0, 0.25, 2.0);
        for text in [rows.join(",\n"), format!("{:?}", to_world.to_cols_array())] {
            let pose = matrix(&text).and_then(Pose::from_world).expect("a matrix");
            assert!(is_near(pose.point(point), camera.to_camera(point)));
            assert!(is_near(pose.direction(Vec3::Y), camera.direction_to_camera(Vec3::Y)));
        }
        for wrong in ["1 2 3", "camera", "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1"] {
            assert!(matrix(wrong).and_then(Pose::from_world).is_none(), "{wrong}");
        }
    }

    #[test]
    fn a_world_with_z_up_is_the_same_world() {
        let camera = camera();
        let point = Vec3::new(-1.0, 0.25, 2.0);
        let z_up = Vec3::new(point.x, -point.z, point.y);
        assert!(is_near(Pose::of(&camera).of_world_with_z_up().point(z_up), camera.to_camera(point)));
    }

    #[test]
    fn the_attribute_is_taken_both_ways() {
        let camera = camera();
        let to_camera =
            Mat4::from_mat3(camera.rotation.transpose()) * Mat4::from_translation(-camera.position);
        let forward = Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0)) * to_camera;
        let point = Vec3::new(-1.0, 0.25, 2.0);
        // Row vectors times a matrix written row by row are columns of the transposed one.
        for written in [to_camera, forward, forward.transpose()] {
            let found = of_attribute(written.to_cols_array());
            assert!(
                found.iter().any(|one| is_near(one.pose.point(point), camera.to_camera(point))),
                "{written}"
            );
        }
    }
}
