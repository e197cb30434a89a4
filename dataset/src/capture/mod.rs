//! Captures: aligned colour and depth images of a real camera, with what the camera was and, where known,
//! where it stood.

mod camera;
pub mod error;
pub mod intrinsics;
mod open3d;
mod pictures;
pub mod pose;
pub mod surface;
mod tables;
mod tum;
pub mod view;

pub use camera::CaptureCamera;
pub use error::CaptureError;
pub use intrinsics::Intrinsics;
pub use pose::Pose;
pub use surface::surface;
pub use view::View;

use deepshade_shaders::Planes;
use std::path::{Path, PathBuf};

/// A capture on disk. Its images are read when asked for.
#[derive(Clone, Debug)]
pub struct Capture {
    camera: CaptureCamera,
    frames: Vec<FrameFiles>,
}

/// Where a frame's images are, and what is known besides.
#[derive(Clone, Debug)]
struct FrameFiles {
    colour: PathBuf,
    depth: PathBuf,
    time: Option<f64>,
    pose: Option<Pose>,
}

/// What was captured at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureFrame {
    /// Radiance, `[3, height, width]`, of which 1 is white.
    pub colour: Planes,
    /// Depth along the view's axis, `[1, height, width]`, metres; 0 where there is none. Its pixels are those
    /// of `colour`.
    pub depth: Planes,
    /// When, seconds, by the camera's clock.
    pub time: Option<f64>,
    /// Where the camera stood.
    pub pose: Option<Pose>,
}

impl Capture {
    /// Lists the frames of a folder that is laid out as the TUM benchmark's or as Open3D's.
    ///
    /// # Errors
    /// If it is laid out otherwise, holds no frame, a list in it is damaged, or nothing says what the camera
    /// was.
    pub fn open(folder: &Path) -> Result<Self, CaptureError> {
        if tum::is_in(folder) {
            tum::open(folder)
        } else if open3d::is_in(folder) {
            open3d::open(folder)
        } else {
            Err(CaptureError::Layout { folder: folder.to_owned() })
        }
    }

    /// The camera of all frames.
    pub const fn camera(&self) -> &CaptureCamera {
        &self.camera
    }

    /// Number of frames; at least one.
    pub const fn count(&self) -> usize {
        self.frames.len()
    }

    /// BLAKE3 hash, in hexadecimal, of the camera and of the images of some frames: what tells a capture from
    /// others.
    ///
    /// # Errors
    /// If an image cannot be read.
    ///
    /// # Panics
    /// If there is no frame of an index.
    pub fn hash(&self, frames: &[usize]) -> Result<String, CaptureError> {
        let mut hasher = blake3::Hasher::new();
        hasher.update(format!("{:?}", self.camera).as_bytes());
        for FrameFiles { colour, depth, .. } in frames.iter().map(|index| &self.frames[*index]) {
            for path in [colour, depth] {
                let file = std::fs::File::open(path).and_then(|file| hasher.update_reader(file).map(drop));
                file.map_err(|source| CaptureError::io(path, source))?;
            }
        }
        Ok(hasher.finalize().to_hex().to_string())
    }

    /// Reads a frame.
    ///
    /// # Errors
    /// If one of its images is missing, damaged or not of the camera's size.
    ///
    /// # Panics
    /// If there is no frame of that index.
    pub fn frame(&self, index: usize) -> Result<CaptureFrame, CaptureError> {
        let FrameFiles { colour, depth, time, pose } = &self.frames[index];
        Ok(CaptureFrame {
            colour: pictures::colour(colour, &self.camera)?,
            depth: pictures::depth(depth, &self.camera)?,
            time: *time,
            pose: *pose,
        })
    }
}

#[cfg(test)]
mod tests;
