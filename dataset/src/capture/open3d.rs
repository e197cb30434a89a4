//! The layout of Open3D's recordings and of its data: the folders `color` and `depth` with images of the same
//! names, the intrinsics in a JSON file, and `trajectory.log`, where known, with a 4 x 4 matrix a frame.

use super::tables::{lines, text};
use super::{Capture, CaptureCamera, CaptureError, FrameFiles, Pose};
use glam::{Mat3, Vec3};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// Names of the file with the intrinsics: of a recording, and of the sample data.
const CAMERAS: [&str; 3] = ["camera_intrinsic.json", "camera_primesense.json", "intrinsic.json"];
/// What a metre is in the depth images.
const DEPTH_SCALE: f32 = 1000.0;

/// Whether a folder has this layout.
pub fn is_in(folder: &Path) -> bool {
    folder.join("color").is_dir() && folder.join("depth").is_dir()
}

/// Lists the frames of a folder.
///
/// # Errors
/// If there are none, one lacks its colour or its depth image, the trajectory is damaged, or nothing says
/// what the camera was.
pub fn open(folder: &Path) -> Result<Capture, CaptureError> {
    let file = CAMERAS.iter().map(|name| folder.join(name)).find(|path| path.is_file());
    let wanted = "camera_intrinsic.json, camera_primesense.json or intrinsic.json would";
    let file = file.ok_or_else(|| CaptureError::Camera { folder: folder.to_owned(), wanted })?;
    let camera = CaptureCamera::of_json(&file, DEPTH_SCALE)?;
    let (colours, mut depths) = (images(&folder.join("color"))?, images(&folder.join("depth"))?);
    let mut poses = poses(&folder.join("trajectory.log"))?;
    let mut frames = Vec::new();
    for (index, (name, colour)) in colours.into_iter().enumerate() {
        let lonely = || CaptureError::invalid(&colour, "has no depth image of the same name");
        let depth = depths.remove(&name).ok_or_else(lonely)?;
        frames.push(FrameFiles { colour, depth, time: None, pose: poses.remove(&index) });
    }
    if let Some(path) = depths.values().next() {
        return Err(CaptureError::invalid(path, "has no colour image of the same name"));
    }
    if frames.is_empty() {
        return Err(CaptureError::Empty {
            folder: folder.to_owned(),
            what: "the folder `color` holds no image",
        });
    }
    Ok(Capture { camera, frames })
}

/// The PNG and JPEG images of a folder by their names without ending, in the order of these.
fn images(folder: &Path) -> Result<BTreeMap<String, PathBuf>, CaptureError> {
    let io = |source| CaptureError::io(folder, source);
    let mut images = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        if let Some(stem) = path.file_stem().and_then(|stem| stem.to_str())
            && (ending == "png" || ending == "jpg" || ending == "jpeg")
        {
            images.insert(stem.to_owned(), path.clone());
        }
    }
    Ok(images)
}

/// The poses of a trajectory by the index of their frame; none where there is no such file.
fn poses(path: &Path) -> Result<HashMap<usize, Pose>, CaptureError> {
    if !path.exists() {
        return Ok(HashMap::new());
    }
    let text = text(path)?;
    let mut poses = HashMap::new();
    for record in lines(path, &text).chunks(5) {
        let index = record[0].number(0)? as usize;
        let [_, a, b, c, _] = record else {
            return Err(record[0].fault("its matrix has fewer than four lines"));
        };
        let rows = [a.numbers::<4>(0)?, b.numbers::<4>(0)?, c.numbers::<4>(0)?];
        let row = |row: usize| Vec3::from_slice(&rows[row]);
        let rotation = Mat3::from_cols(row(0), row(1), row(2)).transpose();
        if (rotation.determinant() - 1.0).abs() > 0.01 {
            return Err(record[0].fault("its matrix is no rotation"));
        }
        let position = Vec3::new(rows[0][3], rows[1][3], rows[2][3]);
        poses.insert(index, Pose::looking_forwards(position, rotation, false));
    }
    Ok(poses)
}
