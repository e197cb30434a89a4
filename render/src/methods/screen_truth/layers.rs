//! What a screen shows: the surfaces that each pixel's ray meets, one behind the other.

use crate::bvh::TracedScene;
use crate::intersection::SurfacePoint;
use crate::scene::Camera;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// A point that is shown.
#[derive(Clone, Copy, Debug)]
pub struct LayerPoint {
    /// Where in the image, pixels from its top left corner; outside of it in the guard band.
    pub at: Vec2,
    /// World space, metres.
    pub position: Vec3,
    /// Unit normal of the triangle, world space, to the camera.
    pub normal: Vec3,
    /// Along the camera's axis, metres.
    pub depth: f32,
}

/// What looks at a scene.
#[derive(Clone, Copy, Debug)]
pub struct Eye<'a> {
    /// The scene.
    pub scene: &'a TracedScene,
    /// A pinhole, whatever its lens.
    pub camera: &'a Camera,
    /// Rows of the image, without a guard band.
    pub height: usize,
    /// Columns.
    pub width: usize,
}

impl Eye<'_> {
    /// Edge of what a pixel covers of a surface that faces the camera, metres.
    pub fn footprint(&self, depth: f32) -> f32 {
        depth / self.camera.focal_length(self.height)
    }

    /// The first surfaces behind a point of the image, the nearest first, as many as there are of `count`.
    /// From one to the next there is a pixel's footprint at least: what is nearer is no second surface at the
    /// screen's resolution.
    pub fn surfaces(&self, at: Vec2, count: usize) -> Vec<LayerPoint> {
        let direction = self.camera.direction(at, self.height, self.width);
        let mut origin = self.camera.position;
        let mut found = Vec::with_capacity(count);
        while found.len() < count {
            let Some(hit) = self.scene.hit(origin, direction, f32::INFINITY) else { break };
            let point = SurfacePoint::new(self.scene, &hit, direction);
            let depth = -self.camera.to_camera(point.position).z;
            found.push(LayerPoint { at, position: point.position, normal: point.geometric_normal, depth });
            origin = point.position + direction * self.footprint(depth);
        }
        found
    }
}

/// All that an image and a guard band around it show.
#[derive(Clone, Debug)]
pub struct Screen {
    /// Rows, with the guard band.
    pub height: usize,
    /// Columns, with the guard band.
    pub width: usize,
    /// Surfaces of a pixel at most.
    pub layers: usize,
    /// Of each pixel, row by row, as many as `layers`.
    points: Vec<Option<LayerPoint>>,
}

impl Screen {
    /// What the middles of pixels show, of so many rows above and below the image and columns beside it, too.
    pub fn new(eye: &Eye<'_>, [rows, columns]: [usize; 2], layers: usize) -> Self {
        let (height, width) = (eye.height + 2 * rows, eye.width + 2 * columns);
        let corner = Vec2::new(columns as f32, rows as f32);
        let pixel = |pixel: usize| {
            let at = Vec2::new((pixel % width) as f32, (pixel / width) as f32) + 0.5 - corner;
            let mut found = eye.surfaces(at, layers).into_iter();
            (0..layers).map(|_| found.next()).collect::<Vec<_>>()
        };
        let points = (0..height * width).into_par_iter().flat_map_iter(pixel).collect();
        Self { height, width, layers, points }
    }

    /// The points of a pixel of the image with its guard band.
    pub fn pixel(&self, x: usize, y: usize) -> &[Option<LayerPoint>] {
        &self.points[self.index(x, y, 0)..][..self.layers]
    }

    /// All points: pixel by pixel, in it layer by layer.
    pub fn points(&self) -> &[Option<LayerPoint>] {
        &self.points
    }

    /// Where in [`Self::points`] a pixel's layer is.
    pub const fn index(&self, x: usize, y: usize, layer: usize) -> usize {
        (y * self.width + x) * self.layers + layer
    }
}
