//! What is known of a capture's camera before an image is read.

use super::{CaptureError, Intrinsics};
use deepshade_shaders::names::with_meant;
use glam::Vec2;
use serde::Deserialize;
use std::path::Path;

/// A capture's camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureCamera {
    /// What maps pixels to directions.
    pub intrinsics: Intrinsics,
    /// Rows and columns of its images.
    pub size: [usize; 2],
    /// What a metre is in the depth images.
    pub depth_scale: f32,
    /// Whether its poses are of a camera whose y goes up and not down: what a negative focal length in the
    /// file means, as ICL-NUIM has it. Such poses are left-handed.
    pub y_up: bool,
}

/// A camera as files state it: the principal point is from the middle of the first pixel.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    width: usize,
    height: usize,
    fx: f32,
    fy: f32,
    cx: f32,
    cy: f32,
    depth_scale: Option<f32>,
}

/// As Open3D writes intrinsics: a matrix, column by column. Recorders add more.
#[derive(Deserialize)]
struct Open3d {
    width: usize,
    height: usize,
    intrinsic_matrix: [f32; 9],
}

/// Edges of images that are read, pixels.
const EDGE: std::ops::RangeInclusive<usize> = 1..=8192;

impl CameraFile {
    /// The camera, or what makes no sense.
    fn camera(self, depth_scale: f32) -> Result<CaptureCamera, &'static str> {
        let depth_scale = self.depth_scale.unwrap_or(depth_scale);
        let focal = |length: f32| length.is_finite() && length != 0.0;
        if !(EDGE.contains(&self.height) && EDGE.contains(&self.width)) {
            return Err("images must be 1 to 8192 pixels high and wide");
        }
        if !(focal(self.fx) && self.fx > 0.0 && focal(self.fy)) {
            return Err("the focal lengths must be finite, that across positive and that upwards not 0");
        }
        if !(self.cx.is_finite() && self.cy.is_finite() && depth_scale.is_finite() && depth_scale > 0.0) {
            return Err("principal point and depth scale must be finite, the latter positive");
        }
        let centre = Vec2::new(self.cx, self.cy) + Vec2::splat(0.5);
        Ok(CaptureCamera {
            intrinsics: Intrinsics { fx: self.fx, fy: self.fy.abs(), centre },
            size: [self.height, self.width],
            depth_scale,
            y_up: self.fy < 0.0,
        })
    }
}

impl CaptureCamera {
    /// That of a `camera.toml`, with the layout's depth scale where the file has none; `None` if there is no
    /// such file.
    ///
    /// # Errors
    /// If the file cannot be read, lacks a key or states what no camera has.
    pub fn of_toml(path: &Path, depth_scale: f32) -> Result<Option<Self>, CaptureError> {
        if !path.exists() {
            return Ok(None);
        }
        let text = std::fs::read_to_string(path).map_err(|source| CaptureError::io(path, source))?;
        let stated: CameraFile = toml::from_str(&text)
            .map_err(|error| CaptureError::invalid(path, with_meant(&error.to_string())))?;
        stated.camera(depth_scale).map(Some).map_err(|what| CaptureError::invalid(path, what))
    }

    /// That of a JSON file with Open3D's intrinsics.
    ///
    /// # Errors
    /// As [`CaptureCamera::of_toml`].
    pub fn of_json(path: &Path, depth_scale: f32) -> Result<Self, CaptureError> {
        let text = std::fs::read_to_string(path).map_err(|source| CaptureError::io(path, source))?;
        let Open3d { width, height, intrinsic_matrix: [fx, _, _, _, fy, _, cx, cy, _] } =
            serde_json::from_str(&text).map_err(|error| CaptureError::invalid(path, error.to_string()))?;
        let stated = CameraFile { width, height, fx, fy, cx, cy, depth_scale: None };
        stated.camera(depth_scale).map_err(|what| CaptureError::invalid(path, what))
    }

    /// That of one of the three Kinects of the TUM benchmark, which the names of its sequences tell
    /// (`..._freiburg1_...`); calibrated colour intrinsics as published with it.
    pub fn of_tum(folder: &Path, depth_scale: f32) -> Option<Self> {
        let known = [
            ("freiburg1", [517.3, 516.5, 318.6, 255.3]),
            ("freiburg2", [520.9, 521.0, 325.1, 249.7]),
            ("freiburg3", [535.4, 539.2, 320.1, 247.6]),
        ];
        let name = folder.file_name()?.to_str()?;
        let (_, [fx, fy, cx, cy]) = known.into_iter().find(|(part, _)| name.contains(part))?;
        let stated = CameraFile { width: 640, height: 480, fx, fy, cx, cy, depth_scale: None };
        stated.camera(depth_scale).ok()
    }
}
