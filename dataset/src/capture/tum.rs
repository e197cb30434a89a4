//! The layout of the TUM RGB-D benchmark (Sturm et al. 2012): `rgb.txt` and `depth.txt` with a time and a
//! file a line, and `groundtruth.txt`, where known, with a time, a place and a quaternion a line. Which depth
//! image belongs to which colour image, time tells.
//!
//! The camera is that of `camera.toml` (`width`, `height`, `fx`, `fy`, `cx`, `cy`, and `depth_scale`, if it
//! is not 5000), else the benchmark's own by the folder's name.

use super::tables::{Line, lines, text};
use super::{Capture, CaptureCamera, CaptureError, FrameFiles, Pose};
use glam::{Mat3, Quat, Vec3};
use std::path::{Component, Path, PathBuf};

/// The farthest in time that images and poses of one moment are apart, seconds.
const SAME_MOMENT: f64 = 0.02;
/// What a metre is in the depth images.
const DEPTH_SCALE: f32 = 5000.0;

/// Whether a folder has this layout.
pub fn is_in(folder: &Path) -> bool {
    folder.join("rgb.txt").is_file() && folder.join("depth.txt").is_file()
}

/// Lists the frames of a folder.
///
/// # Errors
/// If a list is damaged, no two images are of one moment, or nothing says what the camera was.
pub fn open(folder: &Path) -> Result<Capture, CaptureError> {
    let camera = CaptureCamera::of_toml(&folder.join("camera.toml"), DEPTH_SCALE)?
        .or_else(|| CaptureCamera::of_tum(folder, DEPTH_SCALE))
        .ok_or_else(|| CaptureError::Camera {
            folder: folder.to_owned(),
            wanted: "a file `camera.toml` would, or a name of the benchmark (freiburg1, 2 or 3)",
        })?;
    let (colours, depths) = (images(&folder.join("rgb.txt"))?, images(&folder.join("depth.txt"))?);
    let poses = poses(&folder.join("groundtruth.txt"), camera.y_up)?;
    let frame = |(index, (time, colour)): (usize, &(f64, PathBuf))| {
        let depth = nearest(&depths, *time)?;
        // Each image belongs to one frame at most: the two are each other's nearest.
        (nearest(&colours, depths[depth].0) == Some(index)).then(|| FrameFiles {
            colour: folder.join(colour),
            depth: folder.join(&depths[depth].1),
            time: Some(*time),
            pose: nearest(&poses, *time).map(|pose| poses[pose].1),
        })
    };
    let frames: Vec<FrameFiles> = colours.iter().enumerate().filter_map(frame).collect();
    if frames.is_empty() {
        let what = "no colour image has a depth image of the same moment (20 ms)";
        return Err(CaptureError::Empty { folder: folder.to_owned(), what });
    }
    Ok(Capture { camera, frames })
}

/// The entry of the nearest time, if it is of the same moment; times ascend.
fn nearest<T>(entries: &[(f64, T)], time: f64) -> Option<usize> {
    let after = entries.partition_point(|(other, _)| *other < time);
    let near = after.saturating_sub(1)..(after + 1).min(entries.len());
    let distance = |index: &usize| (entries[*index].0 - time).abs();
    let nearest = near.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(&nearest) <= SAME_MOMENT).then_some(nearest)
}

/// Times and files of a list, by time.
fn images(path: &Path) -> Result<Vec<(f64, PathBuf)>, CaptureError> {
    let text = text(path)?;
    let images: Result<Vec<_>, CaptureError> =
        lines(path, &text).iter().map(|line| Ok((line.number(0)?, inside(line)?))).collect();
    Ok(by_time(images?))
}

/// The file that a line names. It must lie in the capture's folder, since a capture may come from anybody.
fn inside(line: &Line<'_>) -> Result<PathBuf, CaptureError> {
    let file = PathBuf::from(line.word(1)?);
    match file.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        true => Ok(file),
        false => Err(line.fault(&format!("`{}` is not in the capture's folder", file.display()))),
    }
}

/// Times and poses of a trajectory, by time; none where there is no such file.
fn poses(path: &Path, y_up: bool) -> Result<Vec<(f64, Pose)>, CaptureError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = text(path)?;
    let pose = |line: &Line<'_>| {
        let rotation = Quat::from_array(line.numbers(4)?);
        if (rotation.length() - 1.0).abs() > 0.01 {
            return Err(line.fault("its quaternion is not of length 1"));
        }
        let rotation = Mat3::from_quat(rotation.normalize());
        Ok((line.number(0)?, Pose::looking_forwards(Vec3::from_array(line.numbers(1)?), rotation, y_up)))
    };
    Ok(by_time(lines(path, &text).iter().map(pose).collect::<Result<Vec<_>, _>>()?))
}

fn by_time<T>(mut entries: Vec<(f64, T)>) -> Vec<(f64, T)> {
    entries.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_of_the_same_moment_is_found() {
        let entries = [0.0, 0.1, 0.115, 0.3].map(|time| (time, ()));
        let found = [-0.01, 0.02, 0.021, 0.104, 0.11, 0.2, 0.31, 0.33].map(|time| nearest(&entries, time));
        assert_eq!(found, [Some(0), Some(0), None, Some(1), Some(2), None, Some(3), None]);
        assert_eq!(nearest::<()>(&[], 0.0), None);
    }
}
