//! A frame of a capture as a pair has it: of another size, and in the project's terms.

use super::{CaptureCamera, CaptureFrame, surface};
use deepshade_render::scene::Camera;
use deepshade_shaders::{GBuffer, Planes};
use glam::{Mat3, Vec3};

/// The largest window of an image's shape in the middle of a capture's images, and the pixels of that image
/// in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Pixels of the capture in one of the image, along either edge; at least 1.
    scale: f32,
    /// Columns and rows to the left of the window and above it.
    corner: [f32; 2],
    /// Rows and columns of the image.
    size: [usize; 2],
}

impl View {
    /// That of an image of so many rows and columns; `None` if the capture has fewer.
    pub fn of(camera: &CaptureCamera, [height, width]: [usize; 2]) -> Option<Self> {
        let [rows, columns] = camera.size.map(|edge| edge as f32);
        let scale = (rows / height as f32).min(columns / width as f32);
        let corner = [0.5 * (columns - scale * width as f32), 0.5 * (rows - scale * height as f32)];
        (scale >= 1.0).then_some(Self { scale, corner, size: [height, width] })
    }

    /// Surfaces and radiance of a frame. Surfaces are those of the pixels in the middle, since a mean would
    /// lie beside both sides of an edge; colours are means.
    pub fn pair(&self, frame: &CaptureFrame, camera: &CaptureCamera) -> (GBuffer, Planes) {
        let whole = surface(&frame.depth, &camera.intrinsics);
        let [height, width] = self.size;
        let middles = Planes::from_fn(whole.planes().channels(), height, width, |channel, y, x| {
            whole.planes().at(channel, self.at(1, y as f32 + 0.5), self.at(0, x as f32 + 0.5))
        });
        let colours = Planes::from_fn(3, height, width, |channel, y, x| {
            let span = |axis: usize, pixel: usize| {
                let first = self.at(axis, pixel as f32);
                first..self.at(axis, pixel as f32 + 1.0).max(first + 1)
            };
            let (rows, columns) = (span(1, y), span(0, x));
            let count = rows.len() * columns.len();
            let values = rows.flat_map(|row| columns.clone().map(move |column| (row, column)));
            values.map(|(row, column)| frame.colour.at(channel, row, column)).sum::<f32>() / count as f32
        });
        (GBuffer::new(whole.attributes().to_vec(), middles), colours)
    }

    /// The camera of the image, as far as one whose axis goes through the middle can be it; without a pose,
    /// at the origin.
    pub fn camera(&self, frame: &CaptureFrame, camera: &CaptureCamera) -> Camera {
        let rows = self.scale * self.size[0] as f32;
        let (position, rotation) =
            frame.pose.map_or((Vec3::ZERO, Mat3::IDENTITY), |pose| (pose.position, pose.rotation));
        Camera {
            position,
            rotation,
            vertical_fov: 2.0 * (0.5 * rows / camera.intrinsics.fy).atan(),
            lens: None,
        }
    }

    /// The capture's column (axis 0) or row (axis 1) at a place of the image, from its left or upper edge.
    fn at(&self, axis: usize, place: f32) -> usize {
        (self.corner[axis] + self.scale * place) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Intrinsics;
    use deepshade_shaders::Attribute;
    use glam::Vec2;

    fn camera() -> CaptureCamera {
        let intrinsics = Intrinsics { fx: 60.0, fy: 60.0, centre: Vec2::new(40.0, 30.0) };
        CaptureCamera { intrinsics, size: [60, 80], depth_scale: 1000.0, y_up: false }
    }

    #[test]
    fn a_square_is_cut_from_the_middle_and_shrunk() {
        let colour = Planes::from_fn(3, 60, 80, |c, y, x| (c * 10_000 + y * 100 + x) as f32);
        let frame = CaptureFrame { colour, depth: Planes::filled(1, 60, 80, 2.0), time: None, pose: None };
        let view = View::of(&camera(), [30, 30]).expect("small enough");
        let (gbuffer, colours) = view.pair(&frame, &camera());
        // Two by two pixels, ten columns from the left.
        assert_eq!(colours.at(0, 0, 0), (10.0 + 11.0 + 110.0 + 111.0) / 4.0);
        assert_eq!(colours.at(2, 29, 29), 20_000.0 + (5868.0 + 5869.0 + 5968.0 + 5969.0) / 4.0);
        let position = gbuffer.select(&[Attribute::Position]).expect("positions");
        assert!((position.at(0, 0, 0) - 2.0 * (11.5 - 40.0) / 60.0).abs() < 1e-5);
        assert!((position.at(1, 29, 29) - 2.0 * (30.0 - 59.5) / 60.0).abs() < 1e-5);
        // Half the height over the focal length.
        assert!((view.camera(&frame, &camera()).vertical_fov - 2.0 * 0.5f32.atan()).abs() < 1e-6);
    }

    #[test]
    fn what_is_larger_than_the_capture_cannot_be_had() {
        assert!(View::of(&camera(), [61, 10]).is_none() && View::of(&camera(), [60, 80]).is_some());
    }
}
